//! Garments on bodies made in code: overlapping capsules, one shell per bone, as awkward as a real file's.

use super::*;
use ctsn_rig::mesh::triangle::{closest_point, solid_angle};
use ctsn_rig::{Joint, Mesh, Surface};
use glam::{DAffine3, DVec2};

/// Adds a capsule from `a` to `b` weighted to one joint.
pub(super) fn capsule(character: &mut Character, joint: usize, a: DVec3, b: DVec3, radius: f64) {
    let axis = (b - a).normalize_or(DVec3::Y);
    let (u, v) = axis.any_orthonormal_pair();
    let (rings, segments) = (12, 20);
    let first = character.body.mesh.positions.len() as u32;
    for ring in 0..=rings {
        let angle = std::f64::consts::PI * ring as f64 / rings as f64;
        let centre = if 2 * ring < rings { a } else { b };
        for segment in 0..segments {
            let (sin, cos) = (std::f64::consts::TAU * segment as f64 / segments as f64).sin_cos();
            let out = (u * cos + v * sin) * angle.sin() - axis * angle.cos();
            character.body.mesh.positions.push(centre + out * radius);
            character.body.weights.push(vec![(joint, 1.0)]);
        }
    }
    for ring in 0..rings {
        for segment in 0..segments {
            let at = |r: u32, s: u32| first + r * segments + s % segments;
            let (p, q) = (at(ring, segment), at(ring, segment + 1));
            let (r, s) = (at(ring + 1, segment), at(ring + 1, segment + 1));
            character.body.mesh.triangles.extend([[p, q, s], [p, s, r]]);
        }
    }
}

/// Name, parent, joint, end of the capsule, radius.
pub(super) type Bone = (&'static str, Option<usize>, [f64; 3], [f64; 3], f64);

/// A character of bones.
pub(super) fn character(bones: &[Bone]) -> Character {
    let joint = |bone: &Bone| Joint {
        name: bone.0.into(),
        parent: bone.1,
        inverse_bind: DAffine3::from_translation(-DVec3::from(bone.2)),
    };
    let mut character = Character {
        joints: bones.iter().map(joint).collect(),
        root: 0,
        body: SkinnedMesh::default(),
        surface: Surface::default(),
        clips: Vec::new(),
        metres_per_unit: 1.0,
        parts: Default::default(),
    };
    for (index, &(_, _, from, to, radius)) in bones.iter().enumerate() {
        capsule(&mut character, index, from.into(), to.into(), radius);
    }
    character
}

pub(super) fn person() -> Character {
    character(&[
        ("hip", None, [0.0, 0.95, 0.0], [0.0, 1.1, 0.0], 0.15),
        ("chest", Some(0), [0.0, 1.2, 0.0], [0.0, 1.32, 0.0], 0.16),
        ("neck", Some(1), [0.0, 1.45, 0.0], [0.0, 1.56, 0.0], 0.06),
        ("head", Some(2), [0.0, 1.58, 0.0], [0.0, 1.68, 0.02], 0.1),
        ("arm.l", Some(1), [0.18, 1.4, 0.0], [0.42, 1.25, 0.0], 0.055),
        ("forearm.l", Some(4), [0.42, 1.25, 0.0], [0.62, 1.1, 0.0], 0.045),
        ("arm.r", Some(1), [-0.18, 1.4, 0.0], [-0.42, 1.25, 0.0], 0.055),
        ("forearm.r", Some(6), [-0.42, 1.25, 0.0], [-0.62, 1.1, 0.0], 0.045),
        ("thigh.l", Some(0), [0.1, 0.9, 0.0], [0.11, 0.5, 0.0], 0.085),
        ("shin.l", Some(8), [0.11, 0.5, 0.0], [0.11, 0.08, 0.0], 0.06),
        ("thigh.r", Some(0), [-0.1, 0.9, 0.0], [-0.11, 0.5, 0.0], 0.085),
        ("shin.r", Some(10), [-0.11, 0.5, 0.0], [-0.11, 0.08, 0.0], 0.06),
    ])
}

pub(super) fn quadruped() -> Character {
    character(&[
        ("b0", None, [0.0, 0.6, -0.35], [0.0, 0.6, 0.0], 0.14),
        ("b1", Some(0), [0.0, 0.6, 0.05], [0.0, 0.62, 0.35], 0.15),
        ("b2", Some(1), [0.0, 0.7, 0.45], [0.0, 0.85, 0.6], 0.08),
        ("b3", Some(0), [0.0, 0.65, -0.48], [0.0, 0.6, -0.9], 0.04),
        ("b4", Some(0), [0.09, 0.5, -0.35], [0.09, 0.05, -0.35], 0.05),
        ("b5", Some(0), [-0.09, 0.5, -0.35], [-0.09, 0.05, -0.35], 0.05),
        ("b6", Some(1), [0.09, 0.5, 0.33], [0.09, 0.05, 0.33], 0.05),
        ("b7", Some(1), [-0.09, 0.5, 0.33], [-0.09, 0.05, 0.33], 0.05),
    ])
}

/// Least distance of a garment's vertices from the body, and its largest winding number (1 inside a closed shell).
fn clearance(character: &Character, mesh: &Mesh) -> (f64, f64) {
    let corners = |t: &[u32; 3]| t.map(|v| character.body.mesh.positions[v as usize]);
    let body: Vec<[DVec3; 3]> = character.body.mesh.triangles.iter().map(corners).collect();
    let measure = |p: &DVec3| {
        let distance = |t: &[DVec3; 3]| closest_point(*p, *t).distance(*p);
        let least = body.iter().map(distance).fold(f64::INFINITY, f64::min);
        (least, body.iter().map(|corners| solid_angle(*p, *corners)).sum::<f64>() / (2.0 * std::f64::consts::TAU))
    };
    mesh.positions.iter().map(measure).fold((f64::INFINITY, 0.0), |all, one| (all.0.min(one.0), all.1.max(one.1)))
}

/// What every garment must be.
pub(super) fn assert_wearable(character: &Character, garment: &Garment, loops: usize, looseness: f64) {
    let quality = quality(&garment.mesh);
    assert!(quality.manifold && quality.components == 1, "{quality:?}");
    assert_eq!((quality.loops, quality.euler), (loops, 2 - loops as i64), "{quality:?}");
    assert!(quality.spread[1] > 0.6 && quality.spread[2] < 1.5, "{quality:?}");
    assert!(quality.angles[2] > 35.0 && quality.angles[0] > 10.0, "{quality:?}");
    let (distance, winding) = clearance(character, &garment.mesh);
    assert!(distance > 0.5 * looseness && winding < 0.5, "{distance} m of {looseness}, winding {winding}");
    let volume = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| garment.mesh.positions[v as usize] - garment.mesh.positions[0]);
        a.dot(b.cross(c))
    };
    assert!(garment.mesh.triangles.iter().map(volume).sum::<f64>() > 0.0, "faces inwards");
}

/// Bounding box of a garment.
pub(super) fn bounds_of(garment: &Garment) -> (DVec3, DVec3) {
    let positions = &garment.mesh.positions;
    let low = positions.iter().fold(DVec3::INFINITY, |low, p| low.min(*p));
    (low, positions.iter().fold(DVec3::NEG_INFINITY, |high, p| high.max(*p)))
}

#[test]
fn a_person_gets_a_shirt_with_neck_two_sleeves_and_one_hem() {
    let person = person();
    let cut = Cut::default();
    let garment = shell(&person, &cut).unwrap();
    assert_wearable(&person, &garment, 4, 1.78 / 150.0);
    assert!((2850..=3150).contains(&garment.mesh.positions.len()), "{}", garment.mesh.positions.len());
    assert_eq!(garment, shell(&person, &cut).unwrap(), "the same twice");
    // Covers the chest, leaves head, hands and feet bare.
    let (low, high) = bounds_of(&garment);
    assert!(low.y < 0.95 && low.y > 0.7 && high.y > 1.4 && high.y < 1.6, "{low} {high}");
    assert!(high.x > 0.25 && high.x < 0.5 && low.x < -0.25 && low.x > -0.5, "{low} {high}");
}

#[test]
fn a_quadruped_without_names_gets_a_coat_with_neck_tail_and_four_leg_holes() {
    let quadruped = quadruped();
    let garment = shell(&quadruped, &Cut::default()).unwrap();
    assert_wearable(&quadruped, &garment, 6, 1.6 / 150.0);
}

#[test]
fn vertex_count_looseness_and_lengths_are_followed() {
    let person = person();
    let cut = Cut { vertices: Some(800), looseness: Some(0.03), sleeve: Some(0.6), hem: Some(0.5), ..Cut::default() };
    let garment = shell(&person, &cut).unwrap();
    assert_wearable(&person, &garment, 4, 0.03);
    assert!((720..=880).contains(&garment.mesh.positions.len()), "{}", garment.mesh.positions.len());
    let (low, high) = bounds_of(&garment);
    assert!(low.y < 0.6 && high.x > 0.42, "{low} {high}");
}

#[test]
fn texture_coordinates_are_metres_without_folds() {
    let garment = shell(&person(), &Cut::default()).unwrap();
    let surface = &garment.surface;
    assert_eq!((surface.uv.len(), surface.triangles.len()), (surface.vertex.len(), garment.mesh.triangles.len()));
    let (mut ratios, mut folded) = (Vec::new(), 0);
    for triangle in &surface.triangles {
        let uv: [DVec2; 3] = triangle.map(|v| surface.uv[v as usize]);
        let at = triangle.map(|v| garment.mesh.positions[surface.vertex[v as usize] as usize]);
        folded += ((uv[1] - uv[0]).perp_dot(uv[2] - uv[0]) <= 0.0) as usize;
        (0..3).for_each(|k| ratios.push(uv[k].distance(uv[(k + 1) % 3]) / at[k].distance(at[(k + 1) % 3])));
    }
    ratios.sort_by(f64::total_cmp);
    let (low, high) = (ratios[ratios.len() / 20], ratios[ratios.len() * 19 / 20]);
    assert!(low > 0.8 && high < 1.2 && folded * 200 < surface.triangles.len(), "{low} {high} {folded}");
}

#[test]
fn odd_characters_are_dressed_or_refused_without_panic() {
    // One joint: a tube round the middle.
    let one = character(&[("root", None, [0.0, 0.0, 0.0], [0.0, 1.0, 0.0], 0.2)]);
    assert_wearable(&one, &shell(&one, &Cut::default()).unwrap(), 2, 1.4 / 150.0);
    // All weights on one joint of a full skeleton.
    let mut numb = person();
    numb.body.weights.iter_mut().for_each(|weights| *weights = vec![(0, 1.0)]);
    let quality = quality(&shell(&numb, &Cut::default()).unwrap().mesh);
    assert!(quality.manifold && quality.loops >= 2, "{quality:?}");
    // A fish: one chain.
    let fish = character(&[
        ("a", None, [0.0, 0.0, 0.0], [0.0, 0.0, 0.3], 0.1),
        ("b", Some(0), [0.0, 0.0, 0.35], [0.0, 0.0, 0.6], 0.08),
        ("c", Some(1), [0.0, 0.0, 0.65], [0.0, 0.0, 0.9], 0.05),
    ]);
    assert_wearable(&fish, &shell(&fish, &Cut::default()).unwrap(), 2, 1.1 / 150.0);
    // A sheet without thickness.
    let mut flat = character(&[("root", None, [0.0; 3], [0.0; 3], 0.1)]);
    flat.body.mesh.positions = vec![DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
    flat.body.mesh.triangles = vec![[0, 1, 2], [0, 2, 3]];
    flat.body.weights.truncate(4);
    assert!(super::quality(&shell(&flat, &Cut::default()).unwrap().mesh).manifold);
    // No area at all.
    flat.body.mesh.positions = vec![DVec3::ZERO; 4];
    assert!(shell(&flat, &Cut::default()).is_err());
}

#[test]
fn bad_cuts_say_what_was_wanted() {
    let person = person();
    let message = |cut: Cut| shell(&person, &cut).unwrap_err().to_string();
    let count = message(Cut { vertices: Some(10), ..Cut::default() });
    assert!(count.contains("500 to 10000") && count.contains("10"), "{count}");
    let loose = message(Cut { looseness: Some(f64::NAN), ..Cut::default() });
    assert!(loose.contains("looseness") && loose.contains("NaN"), "{loose}");
    let flare = message(Cut { flare: Some(7.0), ..Cut::default() });
    assert!(flare.contains("flare") && flare.contains("7"), "{flare}");
    let mut broken = person.clone();
    broken.body.mesh.positions[7].x = f64::NAN;
    assert!(shell(&broken, &Cut::default()).unwrap_err().to_string().contains("vertex 7"));
}

#[test]
#[ignore = "needs the characters of ../shared/assets beside the repository"]
fn the_shared_characters_get_wearable_garments() {
    let crate_folder = std::env::var("CARGO_MANIFEST_DIR").unwrap();
    let assets = std::path::Path::new(&crate_folder).join("../../../shared/assets");
    for (file, loops) in [("xbot.glb", 4), ("fox.glb", 6)] {
        let character = ctsn_rig::gltf::read_character(&assets.join(file), 30.0).unwrap();
        let garment = shell(&character, &Cut::default()).unwrap();
        let low = character.body.mesh.positions.iter().fold(DVec3::INFINITY, |low, p| low.min(*p));
        let high = character.body.mesh.positions.iter().fold(DVec3::NEG_INFINITY, |high, p| high.max(*p));
        assert!(garment.mesh.positions.len() >= 2000);
        assert_wearable(&character, &garment, loops, (high - low).max_element() / 150.0);
    }
}
