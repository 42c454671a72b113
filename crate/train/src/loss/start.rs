//! What the polish starts from against the truth. Where nothing asks for it, a network that learns through the polish
//! hands over whatever becomes cloth by it: a stranger's T-shirt, blown up by 12 mm and strained by 15 %, which the
//! polish drew back to 3.7 mm of the simulation in the air, but not over a body.

use super::fine::Fine;
use super::{Loss, Prediction, Term};

/// Of a model that is polished. (No other weight was tried.)
pub(super) const START: Term = Term {
    name: "start",
    title: "what the polish starts from, poses learned from",
    unit: "m",
    weight: 0.5,
    constants: &[],
    simulated: &[Prediction::Start],
    unsimulated: &[],
    new: |scene| Ok((scene.model.cut.is_some() && scene.variant.mesh).then(|| Box::new(Fine) as Box<dyn Loss>)),
};
