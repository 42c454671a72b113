//! Poses that nobody simulated: they teach, and are the same ones whenever they are asked for.

use super::*;
use crate::body::body;
use crate::loss::{Known, Losses, Scene};
use crate::synthetic;
use ctsn_core::network::skin;

/// A trunk of two joints with two limbs of two, and cloth whose truth is inside the body, so that only the loss of
/// penetration says otherwise.
pub(super) fn scene() -> (HostModel, Setup, Vec<Sample>) {
    let (mut setup, mut samples) = synthetic::dataset(120, 6, 16);
    setup.description.parents = vec![None, Some(0), Some(1), Some(2), Some(1), Some(4)];
    let architecture = Architecture { embedding: 8, basis: 4, layers: 1, heads: 1, features: 4 };
    let mut model = initial(&setup, &samples.iter().collect::<Vec<_>>(), architecture, 1).unwrap();
    model.body = Some(body(&setup, &samples.iter().collect::<Vec<_>>(), &[]).unwrap());
    for sample in &mut samples {
        sample.truth = narrow(&model, &Item::posed(&model, &sample.joints).unwrap());
    }
    (model, setup, samples)
}

/// The cloth in a pose, narrower than the body: 0.85 times as wide as at rest, the body 0.9 times.
fn narrow(model: &HostModel, item: &Item) -> Vec<f32> {
    let rest: Vec<f32> = model.rest.as_chunks::<3>().0.iter().flat_map(|[x, y, z]| [0.85 * x, *y, 0.85 * z]).collect();
    let (transforms, mut posed) = (&item.body_frame.transforms, vec![0.0; rest.len()]);
    skin(&mut Cpu::new(), &rest, &model.skinning, transforms, Space::Body, &mut posed);
    posed
}

#[test]
fn poses_without_truth_teach_to_stay_outside_the_body() {
    let (model, setup, samples) = scene();
    // Few of them: many simulated poses teach it by themselves.
    let samples: Vec<&Sample> = samples.iter().take(3).collect();
    let settings = Settings { epochs: Some(30), batch: 4, ..Settings::default() };
    let (losses, outside) = (named(&["coarse", "fine", "penetration"]), named(&["penetration"]));
    let train = |unsimulated: bool| {
        let mut trainer = Trainer::with(model.clone(), None, &losses, &setup, &samples, settings).unwrap();
        if !unsimulated {
            trainer.unsimulated = None;
        }
        (0..settings.epochs()).for_each(|_| _ = trainer.round(&samples).unwrap());
        trainer.model()
    };
    let poses = Unsimulated::new(&model, &outside, &setup, &samples, &settings).unwrap().expect("limbs to mix");
    let mut unseen = poses.draw(&model, 1_000_000).unwrap();
    // Read as simulated ones are: both streams.
    unseen.iter_mut().for_each(|item| (item.known, item.targets) = (Known::Truth, vec![Vec::new()]));
    let inside = |trained: &HostModel| {
        let (recording, shared, _) = Recording::new(trained, settings.variant, Streams::Both);
        let mut lane = recording.lane(&shared).unwrap();
        let scene = Scene { model: &model, setup: &setup, variant: settings.variant };
        let mut losses = Losses::new(&outside, &scene).unwrap();
        let mut loss = |item: &Item| item.learn(&recording, &shared, &mut lane, &mut losses, 1)[0];
        unseen.iter().map(&mut loss).sum::<f32>() / unseen.len() as f32
    };
    let [without, with] = [false, true].map(|unsimulated| inside(&train(unsimulated)));
    assert!(without > 2e-3 && with < 0.7 * without, "{without} m without them, {with} m with them");
}

#[test]
fn the_same_poses_are_drawn_after_an_interruption_and_by_any_number_of_threads() {
    let (model, setup, samples) = scene();
    let samples: Vec<&Sample> = samples.iter().collect();
    let settings = Settings { epochs: Some(4), batch: 3, ..Settings::default() };
    let start = || Trainer::new(model.clone(), &setup, &samples, settings).unwrap();
    let drawn = |step: usize| {
        let items = start().unsimulated.expect("limbs to mix").draw(&model, step).unwrap();
        items.into_iter().map(|item| item.body_frame.vector).collect::<Vec<_>>()
    };
    assert!(drawn(7) == drawn(7) && drawn(7) != drawn(8));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("checkpoint");
    assert_same_after_interruption(start, &samples, settings, &path);
}
