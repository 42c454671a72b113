//! What the polish starts from learns from two sides: from its own loss, and from those behind the polish.

use super::*;
use ctsn_core::model::Cut;

/// Gradients of all parameters by `losses`, of one pose of a model that is polished.
fn gradients(losses: &[&str]) -> Vec<(String, Vec<f32>)> {
    let (mut model, setup, samples) = tiny();
    model.cut = Some(Cut::new(model.rest.clone(), &model.graph, 3).unwrap());
    let settings = Settings::default();
    let mut trainer = Trainer::with(model, None, &named(losses), &setup, &[&samples[0]], settings).unwrap();
    let Trainer { recording, workers, items, parameters, .. } = &mut trainer;
    let Worker { lane, losses, .. } = &mut workers[0];
    items[0].learn(recording, &parameters.shared, lane, losses, 1);
    let names: Vec<String> = parameters.each().map(|(name, _)| name.to_owned()).collect();
    let values = parameters.ids().into_iter().map(|id| lane.gradient(id).to_vec());
    names.into_iter().zip(values).collect()
}

#[test]
fn its_gradients_are_added_up() {
    let [start, fine, both] = [&["start"][..], &["fine"], &["start", "fine"]].map(gradients);
    let mut taught = 0;
    for (((name, both), (_, start)), (_, fine)) in both.iter().zip(&start).zip(&fine) {
        let size = |values: &[f32]| product(values, values).sqrt();
        let wrong: Vec<f32> = both.iter().zip(start.iter().zip(fine)).map(|(both, (a, b))| both - a - b).collect();
        assert!(size(&wrong) <= 1e-4 * size(both), "{name}: {} of {}", size(&wrong), size(both));
        taught += usize::from(size(start) > 0.0 && size(fine) > 0.0);
    }
    assert!(taught > 5, "{taught} arrays learn from both");
}

/// Nothing is polished where it is not known how the garment was cut, and there is one loss of the prediction.
#[test]
fn without_a_cut_there_is_no_such_loss() {
    let (model, setup, samples) = tiny();
    let trainer = Trainer::new(model, &setup, &[&samples[0]], Settings::default()).unwrap();
    assert!(trainer.terms.iter().all(|term| term.name != "start"), "{:?}", trainer.terms);
}
