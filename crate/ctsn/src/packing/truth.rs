//! Simulated frames made small, for a page to show beside a prediction.

use anyhow::{Result, ensure};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
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

/// Frames as a page reads them.
#[derive(Serialize)]
pub struct Truth<'a> {
    frames: Vec<Frame<'a>>,
    vertices: usize,
    step: f32,
    least: [f32; 3],
    /// Drawn vertices before `A_root`, as whole steps from the least place of all [F, w, 3]: 16 bits each,
    /// the lower half first, in base64.
    positions: String,
}

/// The kept frames of a dataset. docs/format.md.
pub fn truth(data: &Dataset) -> Result<Truth<'_>> {
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
    let steps = steps.map(|(i, value)| ((value - least[i % 3]) / step).round().min(MOST) as u16);
    let bytes: Vec<u8> = steps.flat_map(u16::to_le_bytes).collect();
    let frame = |sample: &Sample| Frame {
        clip: &description.clips[sample.record.clip],
        seconds: sample.record.frame as f64 / description.rate,
    };
    let frames = data.samples.iter().map(frame).collect();
    Ok(Truth { frames, vertices: shown[0].len() / 3, step, least, positions: STANDARD.encode(bytes) })
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
        let Truth { frames, vertices, step, least, positions } = truth(&data).unwrap();
        let bytes = STANDARD.decode(positions).unwrap();
        let steps: Vec<u16> = bytes.as_chunks().0.iter().map(|pair| u16::from_le_bytes(*pair)).collect();
        assert_eq!((frames.len(), vertices), (5, data.setup.template.len() / 3));
        assert_eq!(steps.len(), 5 * 3 * vertices);
        let step = f64::from(step);
        for (sample, steps) in data.samples.iter().zip(steps.chunks(3 * vertices)) {
            let root = data.setup.description.root;
            let of = |numbers: &[f32]| affine(numbers.first_chunk().unwrap());
            let (joint, bind) = (of(&sample.joints[12 * root..]), of(&data.setup.description.inverse_bind[root]));
            let into = root_frame(&joint, &bind) * joint * bind;
            for (steps, place) in steps.as_chunks::<3>().0.iter().zip(super::vertices(&sample.truth)) {
                let value = |c: usize| f64::from(least[c]) + step * f64::from(steps[c]);
                let found = into.transform_point3([value(0), value(1), value(2)].into());
                assert!(found.distance(place) < step, "{found} for {place}");
            }
        }
    }
}
