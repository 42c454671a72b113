//! Simulated frames made small, for a page to show beside a prediction.

use anyhow::{Result, ensure};
use ctsn_core::file::{Tensor, Tensors};
use ctsn_rig::path::root_frame;
use ctsn_rig::{affine, numbers, vertices};
use ctsn_train::dataset::{Dataset, Sample, Setup};
use glam::DAffine3;
use serde::Serialize;

/// Steps in which places are kept, metres; longer where cloth reaches further than 65,535 of them.
const STEP: f32 = 1e-4;
const MOST: f32 = 65_535.0;

/// When a frame is, and of what.
#[derive(Serialize)]
struct Frame<'a> {
    clip: &'a str,
    seconds: f64,
}

/// The kept frames of a dataset: `truth.positions` [F, w, 3], the drawn vertices before `A_root` as whole steps from the
/// least place of all; in the metadata `frames` (clip and seconds, in order), `step` and `least`. docs/format.md.
pub fn truth(data: &Dataset) -> Result<Tensors<'static>> {
    let description = &data.setup.description;
    ensure!(!data.samples.is_empty(), "no pose of this dataset was kept; its report.json has the reasons");
    let shown: Vec<Vec<f32>> = data.samples.iter().map(|sample| before_root(&data.setup, sample)).collect();
    let (mut least, mut greatest) = ([f32::MAX; 3], [f32::MIN; 3]);
    for place in shown.iter().flat_map(|positions| positions.as_chunks::<3>().0) {
        least = std::array::from_fn(|c| least[c].min(place[c]));
        greatest = std::array::from_fn(|c| greatest[c].max(place[c]));
    }
    let reach = (0..3).map(|c| greatest[c] - least[c]).fold(0.0, f32::max);
    let step = STEP.max(reach / MOST);
    let steps = shown.iter().flat_map(|positions| positions.as_chunks::<3>().0).flatten().enumerate();
    let steps: Vec<u32> = steps.map(|(i, value)| ((value - least[i % 3]) / step).round().min(MOST) as u32).collect();
    let frame = |sample: &Sample| Frame {
        clip: &description.clips[sample.record.clip],
        seconds: sample.record.frame as f64 / description.rate,
    };
    let frames: Vec<Frame> = data.samples.iter().map(frame).collect();
    let mut file = Tensors::default();
    file.metadata.extend([
        ("frames".to_owned(), serde_json::to_string(&frames)?),
        ("step".to_owned(), serde_json::to_string(&step)?),
        ("least".to_owned(), serde_json::to_string(&least)?),
    ]);
    let shape = [shown.len(), shown[0].len() / 3, 3];
    file.tensors.insert("truth.positions".to_owned(), Tensor::narrow(&shape, &steps));
    Ok(file)
}

/// What is drawn of a pose's cloth as it would be if the hip stood where it was bound: a page has `A_root` at hand, not
/// the body frame.
fn before_root(setup: &Setup, Sample { joints, truth, .. }: &Sample) -> Vec<f32> {
    let root = setup.description.root;
    let of = |numbers: &[f32]| numbers.first_chunk().map_or(DAffine3::IDENTITY, affine);
    let (joint, bind) = (of(&joints[12 * root..]), of(&setup.description.inverse_bind[root]));
    let back = (joint * bind).inverse() * root_frame(&joint, &bind).inverse();
    let places: Vec<_> = vertices(&setup.shown(truth)).into_iter().map(|place| back.transform_point3(place)).collect();
    numbers(&places)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ctsn_train::synthetic;

    #[test]
    fn frames_come_back_within_half_a_step_wherever_the_hip_stands() {
        let (setup, samples) = synthetic::dataset(120, 3, 5);
        let data = Dataset::new(setup, samples);
        let file = truth(&data).unwrap();
        let read = |key: &str| serde_json::from_str::<serde_json::Value>(&file.metadata[key]).unwrap();
        let (step, least) = (read("step").as_f64().unwrap(), read("least"));
        let steps = file.tensors["truth.positions"].to_u32().unwrap();
        let vertices = data.setup.template.len() / 3;
        assert_eq!(file.tensors["truth.positions"].shape, [5, vertices, 3]);
        assert_eq!(read("frames").as_array().unwrap().len(), 5);
        for (sample, steps) in data.samples.iter().zip(steps.chunks(3 * vertices)) {
            let root = data.setup.description.root;
            let of = |numbers: &[f32]| affine(numbers.first_chunk().unwrap());
            let (joint, bind) = (of(&sample.joints[12 * root..]), of(&data.setup.description.inverse_bind[root]));
            let into = root_frame(&joint, &bind) * joint * bind;
            for (steps, place) in steps.as_chunks::<3>().0.iter().zip(super::vertices(&sample.truth)) {
                let value = |c: usize| least[c].as_f64().unwrap() + step * f64::from(steps[c]);
                let found = into.transform_point3([value(0), value(1), value(2)].into());
                assert!(found.distance(place) < step, "{found} for {place}");
            }
        }
    }
}
