//! Training from beginning to end: the same seed and an interruption give the same bytes; the best epoch is kept;
//! reasons to stop.

use super::*;
use crate::dataset::Split;
use crate::synthetic;
use crate::training::adam::schedule;
use ctsn_core::model::Storage;
use tempfile::TempDir;

fn files(folder: &TempDir) -> Files {
    Files { checkpoint: folder.path().join("checkpoint"), curve: folder.path().join("curve.csv") }
}

/// A trainer of [`tiny`] and the samples it is validated on.
fn trainer(settings: Settings) -> (Trainer, Vec<Sample>) {
    let (_, setup, mut samples) = tiny();
    let validation = samples.split_off(3);
    let train: Vec<&Sample> = samples.iter().collect();
    let architecture = Architecture { embedding: 8, basis: 16, layers: 2, heads: 2, features: 8 };
    let model = initial(&setup, &train, architecture, settings.seed).unwrap();
    (Trainer::new(model, &setup, &train, settings).unwrap(), validation)
}

fn bytes(trainer: &Trainer) -> Vec<u8> {
    trainer.best().unwrap().1.to_bytes(Storage::F32)
}

#[test]
fn a_dead_mesh_stream_is_noticed() {
    let (_, setup, samples) = tiny();
    let samples: Vec<&Sample> = samples.iter().collect();
    let architecture = Architecture { embedding: 8, basis: 16, layers: 2, heads: 2, features: 8 };
    let mut model = initial(&setup, &samples, architecture, 1).unwrap();
    assert!(!is_mesh_silent(&model, &samples).unwrap());
    model.vertex_mlp.last_mut().unwrap().bias.fill(-1e3);
    assert!(is_mesh_silent(&model, &samples).unwrap());
    Variant::without(&[Part::Mesh]).silence(&mut model);
    assert!(!is_mesh_silent(&model, &samples).unwrap(), "left out is not dead");
}

#[test]
fn an_interruption_and_a_second_run_give_the_same_bytes() {
    let settings = Settings { epochs: Some(8), batch: 2, ..Settings::default() };
    let folder = tempfile::tempdir().unwrap();
    let files = files(&folder);
    let whole = || {
        let (mut trainer, validation) = trainer(settings);
        let validation: Vec<&Sample> = validation.iter().collect();
        assert!(matches!(trainer.fit(&validation, &files, |_, _| {}).unwrap(), End::Done));
        trainer
    };
    let first = whole();
    let curve = std::fs::read_to_string(&files.curve).unwrap();
    assert_eq!(curve.lines().count(), 1 + 8, "{curve}");
    assert_eq!(bytes(&first), bytes(&whole()), "the same seed gives another model");
    let (mut half, validation) = trainer(settings);
    let validation: Vec<&Sample> = validation.iter().collect();
    (0..5).for_each(|_| _ = half.round(&validation).unwrap());
    half.save(&files.checkpoint).unwrap();
    let (mut resumed, _) = trainer(settings);
    resumed.resume(&files.checkpoint).unwrap();
    assert_eq!(resumed.epoch, 5);
    resumed.fit(&validation, &files, |_, _| {}).unwrap();
    assert_eq!(first.model(), resumed.model(), "the interruption changed the last epoch");
    assert_eq!(bytes(&first), bytes(&resumed), "the interruption changed the best epoch");
    let (mut other, _) = trainer(Settings { seed: 2, ..settings });
    let refused = other.resume(&files.checkpoint).unwrap_err().to_string();
    assert!(refused.contains("another training"), "{refused}");
    // Of a version that kept another epoch.
    let mut older = ctsn_rig::file::tensors(&files.checkpoint).unwrap();
    older.metadata.remove("kept").unwrap();
    std::fs::write(&files.checkpoint, older.to_bytes()).unwrap();
    let refused = resumed.resume(&files.checkpoint).unwrap_err().to_string();
    assert!(refused.contains("another training"), "{refused}");
}

#[test]
fn the_best_epoch_is_kept_and_no_gain_ends_the_training() {
    let (mut trainer, validation) =
        trainer(Settings { epochs: Some(5000), patience: 3, batch: 2, ..Settings::default() });
    let validation: Vec<&Sample> = validation.iter().collect();
    let folder = tempfile::tempdir().unwrap();
    // What is unseen is drawn at random, so it is not learned from the rest: its error rises before long.
    assert!(matches!(trainer.fit(&validation, &files(&folder), |_, _| {}).unwrap(), End::NoGain));
    let (row, model) = trainer.best().unwrap();
    assert_eq!(row.epoch + 3, trainer.epoch);
    assert_ne!(model, trainer.model());
    assert!(trainer.curve.iter().all(|other| 1.02 * other.distance >= row.distance));
    let best = trainer.best.clone();
    for (name, values) in model.parameters().into_iter().map(|(name, _)| name).zip(best) {
        *trainer.parameters.get_mut(&name).unwrap() = values;
    }
    let watched = trainer.validate(&validation).unwrap();
    assert_eq!((watched.distance, watched.normal, watched.bending), (row.distance, row.normal, row.bending));
}

#[test]
fn a_diverging_training_stops_and_keeps_the_best_epoch() {
    let settings = Settings { epochs: Some(50), batch: 2, ..Settings::default() };
    let (mut trainer, validation) = trainer(settings);
    let validation: Vec<&Sample> = validation.iter().collect();
    let folder = tempfile::tempdir().unwrap();
    (0..3).for_each(|_| _ = trainer.round(&validation).unwrap());
    let best = bytes(&trainer);
    // From here on every step throws the parameters far away.
    trainer.settings.rate = 1e4;
    let End::Diverged(error) = trainer.fit(&validation, &files(&folder), |_, _| {}).unwrap() else {
        panic!("did not diverge: {:?}", trainer.curve);
    };
    assert!(error.to_string().contains("diverged at epoch 4"), "{error}");
    assert_eq!(bytes(&trainer), best);
}

#[test]
fn the_learning_rate_has_fallen_when_the_time_is_up() {
    let budget = Duration::from_millis(300);
    let (mut trainer, validation) =
        trainer(Settings { budget: Some(budget), patience: 100_000, batch: 2, ..Settings::default() });
    let validation: Vec<&Sample> = validation.iter().collect();
    let folder = tempfile::tempdir().unwrap();
    assert!(matches!(trainer.fit(&validation, &files(&folder), |_, _| {}).unwrap(), End::Done));
    assert!(trainer.seconds() > 0.9 * budget.as_secs_f64());
    // The clock goes on between the rate and the seconds of a row, longer on a busy machine: the rate is never ahead of
    // the time.
    let due = |row: &Row| schedule(trainer.settings.rate, (row.seconds / budget.as_secs_f64()) as f32);
    let peak =
        (0..trainer.curve.len()).max_by(|a, b| trainer.curve[*a].rate.total_cmp(&trainer.curve[*b].rate)).unwrap();
    let (rising, falling) = trainer.curve.split_at(peak + 1);
    assert!(rising.windows(2).all(|pair| pair[1].rate > pair[0].rate), "{rising:?}");
    assert!(falling.iter().all(|row| row.rate >= due(row)), "{falling:?}");
    assert!(falling.windows(2).all(|pair| pair[1].rate < pair[0].rate), "{falling:?}");
    let last = trainer.curve.last().unwrap().rate;
    assert!(last < 0.5 * trainer.settings.rate, "the last rate is {last}");
}

#[test]
fn an_ablation_learns_what_is_left() {
    let (_, _, samples) = tiny();
    let train: Vec<&Sample> = samples.iter().take(3).collect();
    for part in [Part::Skeleton, Part::Mesh, Part::Weights] {
        let (mut trainer, _) =
            trainer(Settings { variant: Variant::without(&[part]), epochs: Some(100), ..Settings::default() });
        let before = trainer.model();
        let first = fine(&mut trainer);
        let last = (0..60).fold(first, |_, _| fine(&mut trainer));
        assert!(last < 0.8 * first, "without {part:?}: from {first} to {last}");
        let after = trainer.model();
        let silent = |basis: &[f32]| basis.iter().all(|value| *value == 0.0);
        assert_eq!(silent(&after.skeleton_basis), part == Part::Skeleton);
        assert_eq!(silent(&after.mesh_basis), part == Part::Mesh);
        assert_eq!(after.skinning == before.skinning, part == Part::Weights);
        // The trained loss is what the predictor makes of the file.
        let read = HostModel::parse(&after.to_bytes(Storage::F32)).unwrap();
        assert_eq!(read.mesh_stream, part != Part::Mesh);
        let distance = trainer.validate(&train).unwrap().distance;
        let mut predictor = ctsn_core::Predictor::from_model(read, ctsn_core::cpu::Level::new());
        let mut total = 0.0;
        for sample in &train {
            predictor.predict_row_major(&sample.joints, Streams::Both).unwrap();
            let into = ctsn_rig::pose(&predictor.activations().body_frame).last().unwrap().inverse();
            let positions = ctsn_rig::vertices(predictor.positions());
            let truth = ctsn_rig::vertices(&sample.truth);
            let pairs = positions.iter().zip(&truth);
            total += pairs.map(|(a, b)| into.transform_point3(*a).distance(*b)).sum::<f64>() / truth.len() as f64;
        }
        let mean = total / train.len() as f64;
        assert!((mean - f64::from(distance)).abs() < 1e-6, "without {part:?}: {mean} and {distance}");
    }
    assert!(trainer(Settings::default()).0.parameters.ids().len() > 10);
}

#[test]
fn parts_of_the_embedding_stay_deaf_to_each_other() {
    let (mut setup, samples) = synthetic::dataset(60, 6, 8);
    // A trunk of two joints with two limbs of two.
    setup.description.parents = vec![None, Some(0), Some(1), Some(2), Some(1), Some(4)];
    let samples: Vec<&Sample> = samples.iter().collect();
    let architecture = Architecture { embedding: 8, basis: 16, layers: 2, heads: 2, features: 8 };
    let model = initial(&setup, &samples, architecture, 1).unwrap();
    let zeros = |model: &HostModel| -> Vec<bool> {
        model.embedding.iter().flat_map(|layer| &layer.weight).map(|weight| *weight == 0.0).collect()
    };
    let before = zeros(&model);
    assert!(before.iter().filter(|zero| **zero).count() > before.len() / 3, "three parts");
    let mut trainer = Trainer::new(model, &setup, &samples, Settings::default()).unwrap();
    trainer.epoch(|_, _, _| {}).unwrap();
    assert_eq!(zeros(&trainer.model()), before);
}

/// Poses of `clips` clips of `frames` frames each.
fn dataset(clips: usize, frames: usize) -> Dataset {
    let (mut setup, samples) = synthetic::dataset(60, 3, clips * frames);
    setup.description.clips = (0..clips).map(|clip| clip.to_string()).collect();
    let place = |(i, mut sample): (usize, Sample)| {
        (sample.record.clip, sample.record.frame) = (i / frames, i % frames);
        sample
    };
    let samples = samples.into_iter().enumerate().map(place).collect();
    Dataset::new(setup, samples)
}

#[test]
fn validation_is_a_tenth_of_the_training_clips() {
    let many = dataset(20, 3);
    let Slices { train, validation, .. } = slices(&many).unwrap();
    let clips =
        |list: &[&Sample]| list.iter().map(|sample| sample.record.clip).collect::<std::collections::BTreeSet<_>>();
    assert_eq!(clips(&validation), [4, 14].into());
    assert_eq!(clips(&train).len(), 16, "20 clips, 2 unseen, 2 to validate");
    assert!(clips(&train).iter().all(|clip| *clip < 18));
    let few = dataset(2, 50);
    let Slices { train, validation, .. } = slices(&few).unwrap();
    assert_eq!((train.len(), validation.len()), (82, 8));
    assert!(validation.iter().all(|sample| (41..45).contains(&sample.record.frame)));
    let mut mixed = dataset(2, 50);
    mixed.mixed = mixed.samples[..3].to_vec();
    mixed.coarse = mixed.samples[..2].to_vec();
    let whole = slices(&mixed).unwrap();
    assert_eq!((whole.coarse.len(), whole.learned().len()), (2, 87), "coarse poses stand apart");
    let Slices { train, mixed: count, validation, .. } = whole;
    assert_eq!(
        (train.len(), count, validation.len(), mixed.split(Split::Test).len()),
        (85, 3, 8, 10),
        "mixed poses are learned from"
    );
    // By the length of a clip, not by what was kept of it.
    mixed.setup.description.frames = vec![100; 2];
    assert_eq!([Split::Train, Split::Validation, Split::Test].map(|split| mixed.split(split).len()), [100, 0, 0]);
}

#[test]
fn short_clips_have_frames_of_every_kind() {
    let short = dataset(9, 6);
    let count = |split: Split| short.split(split).len();
    assert_eq!([Split::Train, Split::Validation, Split::Test].map(count), [36, 9, 9]);
}

#[test]
fn sizes_of_nothing_are_refused() {
    let (setup, samples) = synthetic::dataset(60, 3, 8);
    let samples: Vec<&Sample> = samples.iter().collect();
    for (features, heads) in [(0, 2), (8, 0), (9, 2)] {
        let architecture = Architecture { embedding: 8, basis: 16, layers: 1, heads, features };
        let message = initial(&setup, &samples, architecture, 1).unwrap_err().to_string();
        assert!(message.contains("all sizes be positive") && message.contains(&format!("heads: {heads}")), "{message}");
    }
}

#[test]
fn clips_to_watch_that_were_left_out_are_replaced() {
    let mut left = dataset(12, 5);
    left.samples.retain(|sample| sample.record.clip != 4);
    let Slices { train, validation, .. } = slices(&left).unwrap();
    let watched: Vec<_> = validation.iter().map(|sample| (sample.record.clip, sample.record.frame)).collect();
    // Of twelve clips the last two are unseen.
    assert_eq!((train.len(), watched), (40, vec![(9, 0), (9, 1), (9, 2), (9, 3), (9, 4)]));
}

#[test]
fn too_few_poses_and_nothing_to_learn_from_are_refused() {
    let refused = |dataset: &Dataset| slices(dataset).unwrap_err().to_string();
    let mut unseen = dataset(20, 30);
    unseen.samples.retain(|sample| sample.record.clip >= 18);
    let message = refused(&unseen);
    assert!(message.contains("the training split is empty: 60 poses of 20 clips"), "{message}");
    unseen.samples.truncate(49);
    let message = refused(&unseen);
    assert!(message.contains("wanted at least 50 poses, found 49"), "{message}");
}
