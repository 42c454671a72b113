//! Animations sampled at a fixed rate: STEP, LINEAR (slerp for rotations), CUBICSPLINE (Hermite). glTF 2.0 §3.11,
//! appendix C.

use super::Read;
use super::file::File;
use super::nodes::{Nodes, unit_rotation};
use ::gltf::Animation;
use ::gltf::accessor::Dimensions;
use ::gltf::animation::{Channel, Interpolation, Property};
use glam::{DAffine3, DVec3};

/// Most poses of one sampled clip: over an hour at 60 per second.
const MOST_POSES: f64 = 300_000.0;
/// Least share of a node's own scale that an animation scales it to.
const LEAST_SCALE: f64 = 1e-3;

/// One animated property of one node.
struct Track {
    node: usize,
    property: Property,
    interpolation: Interpolation,
    /// Key times, seconds, not decreasing, at least one.
    times: Vec<f64>,
    /// Per key `width` numbers; three times as many (in-tangent, value, out-tangent) for a cubic spline.
    values: Vec<f64>,
}

/// World transforms of all nodes at each frame, file units: [frames][nodes]. Frames stand `1 / rate` seconds apart,
/// from the first key to the last. `None` when no channel moves a node that `moves` marks.
pub(super) fn sample(
    file: &File,
    nodes: &Nodes,
    animation: &Animation,
    moves: &[bool],
    rate: f64,
) -> Read<Option<Vec<Vec<DAffine3>>>> {
    let channels = animation.channels().filter(|channel| moves[channel.target().node().index()]);
    let channels = channels.filter(|channel| channel.target().property() != Property::MorphTargetWeights);
    let tracks: Vec<Track> = channels.map(|channel| Track::read(file, &channel)).collect::<Read<_>>()?;
    if tracks.is_empty() {
        return Ok(None);
    }
    let start = tracks.iter().fold(f64::INFINITY, |time, track| time.min(track.times[0]));
    let end = tracks.iter().fold(start, |time, track| time.max(track.times[track.times.len() - 1]));
    // The tolerance is for key times stored as f32, which may end just before the last frame.
    let last = ((end - start) * rate + 1e-3).floor();
    if last >= MOST_POSES {
        return Err(format!("{} s at {rate} poses per second are more than {MOST_POSES} poses", end - start));
    }
    let frames = (0..=last as usize).map(|frame| {
        let (mut local, mut matrices) = (nodes.local.clone(), nodes.rest.clone());
        for track in &tracks {
            let value = track.at(start + frame as f64 / rate);
            let xyz = DVec3::new(value[0], value[1], value[2]);
            match track.property {
                Property::Translation => local[track.node].translation = xyz,
                Property::Scale => local[track.node].scale = invertible(xyz, nodes.local[track.node].scale),
                _ => local[track.node].rotation = unit_rotation(value),
            }
            matrices[track.node] = local[track.node].affine();
        }
        nodes.worlds(&matrices)
    });
    Ok(Some(frames.collect()))
}

/// A scale without its noughts, each with its sign. To scale a joint to nothing is how clips hide what is in a hand or
/// on a head. Nobody could undo such a transform, and the pose would be of no use for all the other joints either.
fn invertible(scale: DVec3, own: DVec3) -> DVec3 {
    let least = LEAST_SCALE * DVec3::select(own.cmpeq(DVec3::ZERO), DVec3::ONE, own.abs());
    scale.abs().max(least).copysign(scale)
}

impl Track {
    fn read(file: &File, channel: &Channel) -> Read<Track> {
        let (sampler, property) = (channel.sampler(), channel.target().property());
        let shape = if property == Property::Rotation { Dimensions::Vec4 } else { Dimensions::Vec3 };
        let times = file.components(&sampler.input(), Dimensions::Scalar, "key times")?;
        let values = file.components(&sampler.output(), shape, "key values")?;
        let interpolation = sampler.interpolation();
        let per_key = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        let (keys, found) = (times.len(), values.len() / shape.multiplicity());
        if keys == 0 || found != keys * per_key {
            return Err(format!("{keys} key times want {} key values, found {found}", keys * per_key));
        }
        if times.windows(2).any(|pair| pair[1] < pair[0]) {
            return Err("key times must not decrease".to_string());
        }
        let node = channel.target().node().index();
        Ok(Track { node, property, interpolation, times, values })
    }

    /// The value at a time, constant before the first key and after the last. Only a rotation uses the fourth number.
    fn at(&self, time: f64) -> [f64; 4] {
        let next = self.times.partition_point(|&key| key <= time);
        let key = next.saturating_sub(1);
        let next = next.clamp(key, self.times.len() - 1);
        let span = self.times[next] - self.times[key];
        if span <= 0.0 || time <= self.times[key] {
            return self.value(key);
        }
        let share = (time - self.times[key]) / span;
        match self.interpolation {
            Interpolation::Step => self.value(key),
            Interpolation::Linear if self.property == Property::Rotation => {
                unit_rotation(self.value(key)).slerp(unit_rotation(self.value(next)), share).to_array()
            }
            Interpolation::Linear => {
                let (from, to) = (self.value(key), self.value(next));
                std::array::from_fn(|i| from[i] + (to[i] - from[i]) * share)
            }
            Interpolation::CubicSpline => {
                let (from, to, t) = (self.value(key), self.value(next), share);
                let (leaving, arriving) = (self.element(3 * key + 2), self.element(3 * next));
                let (t2, t3) = (t * t, t * t * t);
                std::array::from_fn(|i| {
                    (2.0 * t3 - 3.0 * t2 + 1.0) * from[i]
                        + span * (t3 - 2.0 * t2 + t) * leaving[i]
                        + (3.0 * t2 - 2.0 * t3) * to[i]
                        + span * (t3 - t2) * arriving[i]
                })
            }
        }
    }

    fn value(&self, key: usize) -> [f64; 4] {
        self.element(if self.interpolation == Interpolation::CubicSpline { 3 * key + 1 } else { key })
    }

    fn element(&self, index: usize) -> [f64; 4] {
        let width = if self.property == Property::Rotation { 4 } else { 3 };
        std::array::from_fn(|i| if i < width { self.values[index * width + i] } else { 0.0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_1_SQRT_2;

    fn track(interpolation: Interpolation, times: &[f64], values: &[f64]) -> Track {
        let (times, values) = (times.to_vec(), values.to_vec());
        Track { node: 0, property: Property::Translation, interpolation, times, values }
    }

    #[test]
    fn steps_hold_and_lines_interpolate() {
        let values = [1.0, 2.0, 3.0, 3.0, 6.0, 9.0];
        let step = track(Interpolation::Step, &[1.0, 3.0], &values);
        let line = track(Interpolation::Linear, &[1.0, 3.0], &values);
        assert_eq!(step.at(2.99)[..3], [1.0, 2.0, 3.0]);
        assert_eq!(line.at(1.5)[..3], [1.5, 3.0, 4.5]);
        for track in [step, line] {
            assert_eq!(track.at(-7.0)[..3], [1.0, 2.0, 3.0]);
            assert_eq!(track.at(3.0)[..3], [3.0, 6.0, 9.0]);
            assert_eq!(track.at(7.0)[..3], [3.0, 6.0, 9.0]);
        }
    }

    #[test]
    fn cubic_splines_reproduce_a_cubic() {
        let curve = |t: f64| t * t * t - 2.0 * t;
        let slope = |t: f64| 3.0 * t * t - 2.0;
        let times = [0.5, 1.5, 4.0];
        let values: Vec<f64> =
            times.iter().flat_map(|&t| [slope(t), curve(t), slope(t)]).flat_map(|x| [x; 3]).collect();
        let spline = track(Interpolation::CubicSpline, &times, &values);
        for time in [0.5, 0.7, 1.5, 2.0, 3.9, 4.0] {
            assert!((spline.at(time)[1] - curve(time)).abs() < 1e-12, "at {time}");
        }
    }

    #[test]
    fn rotations_take_the_shorter_way_at_constant_speed() {
        // A quarter turn about Y; the second key has the opposite sign.
        let values = [0.0, 0.0, 0.0, 1.0, 0.0, -FRAC_1_SQRT_2, 0.0, -FRAC_1_SQRT_2];
        let mut turn = track(Interpolation::Linear, &[0.0, 1.0], &values);
        turn.property = Property::Rotation;
        let third = unit_rotation(turn.at(1.0 / 3.0));
        let wanted = glam::DQuat::from_rotation_y(std::f64::consts::FRAC_PI_2 / 3.0);
        assert!(third.dot(wanted).abs() > 1.0 - 1e-12, "{third}");
    }

    #[test]
    fn scales_do_not_vanish() {
        let (own, scale) = (DVec3::new(1.0, -0.01, 0.0), DVec3::new(-1e-9, 0.0, 0.5));
        assert_eq!(invertible(scale, own), DVec3::new(-1e-3, 1e-5, 0.5));
        assert_eq!(invertible(DVec3::ZERO, DVec3::ZERO), DVec3::splat(1e-3));
    }

    #[test]
    fn keys_at_the_same_time_do_not_divide_by_zero() {
        let jump = track(Interpolation::Linear, &[0.0, 1.0, 1.0, 2.0], &[0.0, 1.0, 5.0, 6.0].map(|x| [x; 3]).concat());
        assert_eq!([0.5, 1.0, 1.5].map(|time| jump.at(time)[0]), [0.5, 5.0, 5.5]);
    }
}
