//! What a dataset knows of its source; how poses are shared among shards; twins and mixed poses.

use super::*;
use crate::dataset::Setup;
use ctsn_cloth::simulate::{Material, Settings};
use ctsn_rig::{Character, Clip, Garment, Joint, Mesh, SkinnedMesh, Surface};
use glam::DAffine3;

/// A square body with weights written strongest first, and a square of cloth over it.
fn scene() -> (Character, Garment) {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE];
    let mesh = |lift: f64| Mesh {
        positions: corners.map(|corner| corner * 0.37 + DVec3::Z * lift).to_vec(),
        triangles: vec![[0, 1, 2], [1, 3, 2]],
    };
    let joint = |name: &str, height: f64| Joint {
        name: name.to_owned(),
        parent: None,
        inverse_bind: DAffine3::from_rotation_translation(glam::DQuat::from_rotation_x(0.3), DVec3::Y * height),
    };
    let mut character = Character {
        joints: vec![joint("Hips", 0.1), joint("Spine", 0.7)],
        root: 0,
        body: SkinnedMesh { mesh: mesh(0.0), weights: vec![vec![(1, 0.7), (0, 0.3)]; 4] },
        surface: Surface::default(),
        clips: Vec::new(),
        metres_per_unit: 1.0,
        parts: Default::default(),
    };
    let poses = vec![character.canonical_pose(); 2];
    character.clips.push(Clip { name: "still".to_owned(), rate: 7.3, poses });
    (character, Garment { mesh: mesh(0.01), ..Garment::default() })
}

#[test]
fn a_dataset_knows_what_it_was_made_from() {
    let (character, garment) = scene();
    let folder = tempfile::tempdir().unwrap();
    let made = |garment: &Garment| request(&character, garment).setup();
    made(&garment).write(folder.path()).unwrap();
    let found = Setup::read(folder.path()).unwrap().unwrap();
    found.check_same(&made(&garment), folder.path()).unwrap();
    let mut other = garment.clone();
    other.mesh.positions[2].y += 1e-3;
    let refused = |wanted: &Setup| found.check_same(wanted, folder.path()).unwrap_err().to_string();
    let garment_refused = refused(&made(&other));
    assert!(garment_refused.contains("another character or garment"), "{garment_refused}");
    let settings = Settings { path_steps: 25, ..Settings::default() };
    let settings_refused = refused(&Request { settings, ..request(&character, &garment) }.setup());
    assert!(settings_refused.contains("settings") && settings_refused.contains("path_steps: 25"), "{settings_refused}");
    let material = ("lead", Material { density: 9.0, ..Material::default() });
    let material_refused = refused(&Request { material, ..request(&character, &garment) }.setup());
    assert!(material_refused.contains("another material") && material_refused.contains("lead"), "{material_refused}");
}

#[test]
fn a_dataset_that_kept_its_fabric_as_text_says_what_to_do() {
    let (character, garment) = scene();
    let folder = tempfile::tempdir().unwrap();
    request(&character, &garment).setup().write(folder.path()).unwrap();
    let path = folder.path().join("setup.safetensors");
    let bytes = std::fs::read(&path).unwrap();
    let mut file = ctsn_core::file::Tensors::parse(&bytes).unwrap();
    let mut description: serde_json::Value = serde_json::from_str(&file.metadata["setup"]).unwrap();
    assert_eq!(description["material"]["name"], "cotton");
    description["material"] = "cotton: Material { density: 0.2 }".into();
    file.metadata.insert("setup".to_owned(), description.to_string());
    std::fs::write(&path, file.to_bytes()).unwrap();
    let refused = Setup::read(folder.path()).unwrap_err().to_string();
    assert!(refused.contains("setup.safetensors") && refused.contains("older version"), "{refused}");
}

#[test]
fn a_dataset_knows_whose_predictions_its_poses_were_relaxed_from() {
    let (character, garment) = scene();
    let (setup, samples) = crate::synthetic::dataset(100, 3, 4);
    let samples: Vec<&Sample> = samples.iter().collect();
    let architecture = crate::training::Architecture { embedding: 2, basis: 2, layers: 1, heads: 1, features: 4 };
    let [first, second] = [1, 2].map(|seed| crate::training::initial(&setup, &samples, architecture, seed).unwrap());
    let by = |teacher| Request { teacher, ..request(&character, &garment) }.setup();
    assert_eq!(by(None).description.teacher, None);
    assert_eq!(by(Some(&first)), by(Some(&first)));
    let folder = tempfile::tempdir().unwrap();
    by(Some(&first)).write(folder.path()).unwrap();
    let found = Setup::read(folder.path()).unwrap().expect("a setup");
    found.check_same(&by(Some(&first)), folder.path()).unwrap();
    for other in [Some(&second), None] {
        let refused = found.check_same(&by(other), folder.path()).unwrap_err().to_string();
        assert!(refused.contains("predictions"), "{refused}");
    }
    // The model is of other joints.
    let run = Run::new(Request { teacher: Some(&first), ..request(&character, &garment) }, &folder.path().join("data"));
    let refused = run.err().expect("refused").to_string();
    assert!(refused.contains("its joints are not the model's"), "{refused}");
}

fn request<'a>(character: &'a Character, garment: &'a Garment) -> Request<'a> {
    Request {
        character,
        garment,
        names: ["a.glb", "b.glb"],
        material: ("cotton", Material::default()),
        settings: Settings::default(),
        teacher: None,
        shard: Shard::WHOLE,
        poses: None,
        mixed: 0,
        coarse: 0,
        twins: 0,
    }
}

#[test]
fn a_run_that_is_cut_off_has_done_some_of_every_clip() {
    let (mut character, garment) = scene();
    let poses = vec![character.canonical_pose(); 12];
    character.clips = (0..10).map(|i| Clip { name: format!("clip {i}"), rate: 7.3, poses: poses.clone() }).collect();
    let all = tasks(&request(&character, &garment), 120, Path::new(""));
    assert_eq!(all.iter().map(|task| (task.clip, task.frame)).collect::<std::collections::BTreeSet<_>>().len(), 120);
    for part in all.chunks(all.len() / 4) {
        let clips: std::collections::BTreeSet<usize> = part.iter().map(|task| task.clip).collect();
        assert_eq!(clips.len(), 10, "a quarter of the poses is of {clips:?}");
    }
}

#[test]
fn shards_share_the_poses_evenly() {
    let shards: Vec<Shard> = (0..3).map(|i| format!("{i}/3").parse().unwrap()).collect();
    for pose in 0..100 {
        assert_eq!(shards.iter().filter(|shard| shard.holds(pose)).count(), 1, "pose {pose}");
    }
    let sizes = shards.iter().map(|shard| (0..10).filter(|pose| shard.holds(*pose)).count());
    assert_eq!(sizes.collect::<Vec<_>>(), [4, 3, 3]);
    for wrong in ["", "1", "3/3", "-1/3", "0/0", "1/x"] {
        assert!(wrong.parse::<Shard>().is_err(), "{wrong:?} is no shard");
    }
}

#[test]
fn more_poses_add_to_fewer_and_any_number_is_evenly_spread() {
    for (count, wanted) in [(2615, 8), (2615, 80), (2615, 1300), (120, 7)] {
        let mut chosen = order(count)[..wanted].to_vec();
        chosen.sort_unstable();
        let gap = chosen.windows(2).map(|pair| pair[1] - pair[0]).max().unwrap();
        assert!(gap * wanted < 3 * count, "{wanted} of {count}: gaps of up to {gap}");
    }
    let (mut character, garment) = scene();
    character.clips[0].poses = vec![character.canonical_pose(); 60];
    let request = |poses| Request { poses: Some(poses), twins: 4, ..request(&character, &garment) };
    let [fewer, more] = [20, 50].map(|poses| tasks(&request(poses), 60, Path::new("")));
    assert_eq!([fewer.len(), more.len()], [24, 54]);
    assert!(fewer.iter().zip(&more).all(|(a, b)| (a.frame, a.kind) == (b.frame, b.kind)));
}

#[test]
fn a_twin_turns_every_joint_by_half_a_degree() {
    let (mut character, _) = scene();
    character.joints[1].parent = Some(0);
    let pose = character.canonical_pose();
    let twin = noise::turned(&character, &pose, 3, 14);
    let local = |pose: &Pose| [pose[0], pose[0].inverse() * pose[1]];
    for (joint, (a, b)) in local(&pose).iter().zip(local(&twin)).enumerate() {
        let turn = glam::DQuat::from_mat3(&(a.matrix3.inverse() * b.matrix3)).to_axis_angle().1.to_degrees();
        assert!((turn - noise::DEGREES).abs() < 1e-6, "joint {joint} turns by {turn} degrees");
        assert!(a.translation.distance(b.translation) < 1e-12, "joint {joint} moves in its parent");
    }
    assert_eq!(twin, noise::turned(&character, &pose, 3, 14));
    assert_ne!(twin, noise::turned(&character, &pose, 3, 15));
}

#[test]
fn mixed_poses_are_made_of_what_is_learned_from() {
    let (mut character, garment) = scene();
    let place = |clip: usize, frame: usize| DAffine3::from_translation(DVec3::new(clip as f64, frame as f64, 0.0));
    let clip = |clip: usize, frames: usize| {
        let poses = (0..frames).map(|frame| vec![place(clip, frame); 2]).collect();
        Clip { name: format!("clip {clip}"), rate: 7.3, poses }
    };
    character.clips = (0..12).map(|i| clip(i, 3)).collect();
    let places = |character: &Character| -> Vec<(usize, usize)> {
        let hips = learned(character).into_iter().map(|pose| pose[0].translation);
        hips.map(|hip| (hip.x as usize, hip.y as usize)).collect()
    };
    let all = places(&character);
    assert_eq!(all.len(), 27, "12 clips of three frames, two unseen, one to validate");
    assert!(all.iter().all(|(clip, _)| *clip < 10 && *clip != 4), "{all:?}");
    character.clips = vec![clip(0, 100)];
    let all = places(&character);
    assert_eq!((all.len(), all.last()), (81, Some(&(0, 80))), "of few clips, the first frames");
    let request = |mixed| Request { mixed, shard: "1/2".parse().unwrap(), ..request(&character, &garment) };
    let mixed = |tasks: Vec<Task>| tasks.into_iter().filter(|task| task.kind == Kind::Mixed).map(|task| task.frame);
    assert_eq!(mixed(tasks(&request(6), 100, Path::new(""))).collect::<Vec<_>>(), [1, 3, 5]);
}

#[test]
fn coarse_poses_are_mixtures_or_frames_and_want_a_model() {
    let (mut character, garment) = scene();
    let place = |frame: usize| vec![DAffine3::from_translation(DVec3::new(0.0, frame as f64, 0.0)); 2];
    character.clips = vec![Clip { name: "only".to_owned(), rate: 7.3, poses: (0..100).map(place).collect() }];
    let hips = |poses: &CoarsePoses, mixer: Option<&Mixer>, numbers: &[usize]| -> Vec<Option<usize>> {
        numbers.iter().map(|number| poses.pose(*number, mixer).map(|pose| pose[0].translation.y as usize)).collect()
    };
    let still = CoarsePoses::new(&learned(&character));
    let all = hips(&still, None, &(0..82).collect::<Vec<_>>());
    assert_eq!(still.count(None), 81);
    assert_eq!(all.last(), Some(&None), "81 frames are learned from");
    let mut sorted: Vec<usize> = all.iter().copied().flatten().collect();
    assert_eq!(sorted[80], 0, "the frame that is simulated finely first comes last");
    sorted.sort_unstable();
    assert_eq!(sorted, (0..81).collect::<Vec<_>>());
    for side in ["Left", "Right"] {
        character.joints.push(Joint { name: side.to_owned(), parent: Some(0), inverse_bind: DAffine3::IDENTITY });
        character.joints.push(Joint { parent: Some(character.joints.len() - 1), ..character.joints[2].clone() });
    }
    character.clips[0].poses.iter_mut().for_each(|pose| *pose = [&pose[..1]; 6].concat());
    let mixer = Mixer::new(&character, learned(&character), FURTHER);
    assert!(mixer.is_some());
    let (mixed, mixer) = (CoarsePoses::new(&learned(&character)), mixer.as_ref());
    assert_eq!(mixed.count(mixer), usize::MAX);
    assert!(mixed.pose(163, mixer).is_some() && mixed.pose(0, mixer) != mixed.pose(1, mixer), "made up");
    let tasks = tasks(&Request { coarse: 6, ..request(&character, &garment) }, 2, Path::new(""));
    assert_eq!(tasks.iter().filter(|task| task.kind == Kind::Coarse).count(), 6);
    let folder = tempfile::tempdir().unwrap();
    let refused = Run::new(Request { coarse: 6, ..request(&character, &garment) }, folder.path()).err().unwrap();
    assert!(refused.to_string().contains("6 coarse poses: wanted a model"), "{refused}");
}
