//! `N·A_j`, `N⁻¹` and the standardised pose vector γ. network.md §1. In f64: J matrices cost nothing. Twin:
//! shaders/body_frame.wgsl.

use crate::cpu::{Cpu, Kernel};
use crate::operation::BodyFrame;
use crate::pose::{Frame, Rig};

impl Kernel for BodyFrame<&[f32], &mut [f32]> {
    fn run(self, _: &mut Cpu) {
        body_frame(&self.rig, self.joints, self.transforms, self.vector);
    }
}

/// joints `G_j` [J, 3, 4] -> transforms [J + 1, 3, 4], vector [12J].
pub fn body_frame(rig: &Rig, joints: &[f32], transforms: &mut [f32], vector: &mut [f32]) {
    let joint = |j: usize| -> [f64; 12] { std::array::from_fn(|e| f64::from(joints[12 * j + e])) };
    let skinning = |j: usize| multiply(&joint(j), &rig.inverse_bind[j].map(f64::from));
    let (hip, a) = (joint(rig.root), skinning(rig.root));
    let [sin, cos] = match rig.frame {
        Frame::HipYaw => unit([a[2] - a[8], a[0] + a[10]]),
        Frame::Hip => [0.0, 1.0],
    };
    let [x, y, z] = [hip[3], hip[7], hip[11]];
    // N: translate by -p, then rotate by -ψ about +Y.
    let into = [cos, 0.0, -sin, sin * z - cos * x, 0.0, 1.0, 0.0, -y, sin, 0.0, cos, -sin * x - cos * z];
    let back = [cos, 0.0, sin, x, 0.0, 1.0, 0.0, y, -sin, 0.0, cos, z];
    let (transforms, last) = transforms.split_at_mut(12 * rig.joints.len());
    for (j, transform) in transforms.as_chunks_mut::<12>().0.iter_mut().enumerate() {
        *transform = multiply(&into, &skinning(j)).map(|value| value as f32);
    }
    last.copy_from_slice(&back.map(|value| value as f32));
    for (row, (vector, numbers)) in
        vector.as_chunks_mut::<4>().0.iter_mut().zip(transforms.as_chunks::<4>().0).enumerate()
    {
        let seen = rig.range.as_ref().map_or(*numbers, |range| range.nearest(row, *numbers));
        *vector = std::array::from_fn(|e| (seen[e] - rig.mean[4 * row + e]) / rig.std[4 * row + e]);
    }
}

/// Sine and cosine of an angle from any multiple of them; of nothing, those of zero. Without trigonometry, which would
/// add 3 kB to what a page downloads.
fn unit([sin, cos]: [f64; 2]) -> [f64; 2] {
    let length = (sin * sin + cos * cos).sqrt();
    if length > 0.0 { [sin / length, cos / length] } else { [0.0, 1.0] }
}

/// Product of two 3×4 transforms.
fn multiply(a: &[f64; 12], b: &[f64; 12]) -> [f64; 12] {
    std::array::from_fn(|e| {
        let (row, column) = (e / 4, e % 4);
        let offset = if column == 3 { a[4 * row + 3] } else { 0.0 };
        (0..3).map(|i| a[4 * row + i] * b[4 * i + column]).sum::<f64>() + offset
    })
}

#[cfg(feature = "suite")]
impl crate::suite::Suite for BodyFrame<Vec<f32>, Vec<f32>> {
    /// Products of three transforms whose places are within three metres, in f32 on the GPU.
    const TOLERANCE: f64 = 5e-6;

    fn operands(rng: &mut fastrand::Rng) -> Vec<Self> {
        let mut operand = |(count, ranged): (usize, bool)| {
            let joints = (0..count).flat_map(|_| crate::suite::transform(rng)).collect();
            let rig = std::sync::Arc::new(rig(rng, count, ranged));
            Self { rig, joints, transforms: vec![0.0; 12 * (count + 1)], vector: vec![0.0; 12 * count] }
        };
        let counts = [1, 2, 5, 65].into_iter().flat_map(|count| [(count, true), (count, false)]);
        counts.map(&mut operand).collect()
    }

    fn truth(&self) -> Vec<Option<Vec<f64>>> {
        use glam::{DMat4, DVec3};
        let matrix = |rows: &[f32]| {
            let [x, y, z] = [0, 4, 8].map(|r| glam::Vec4::from_slice(&rows[r..]).as_dvec4());
            DMat4::from_cols(x, y, z, glam::DVec4::W).transpose()
        };
        let rig = &self.rig;
        let pairs: Vec<(DMat4, DMat4)> =
            self.joints.chunks(12).zip(&rig.inverse_bind).map(|(g, b)| (matrix(g), matrix(b))).collect();
        let a = pairs[rig.root].0 * pairs[rig.root].1;
        let twist = |row: usize, column: usize| a.col(column)[row];
        let yaw =
            if rig.frame == Frame::HipYaw { (twist(0, 2) - twist(2, 0)).atan2(twist(0, 0) + twist(2, 2)) } else { 0.0 };
        let hip = pairs[rig.root].0.w_axis.truncate();
        let into = DMat4::from_rotation_y(-yaw) * DMat4::from_translation(-hip);
        let rows = |matrix: DMat4| (0..3).flat_map(|r| matrix.row(r).to_array()).collect::<Vec<f64>>();
        let mut transforms: Vec<f64> = pairs.iter().flat_map(|(g, bind)| rows(into * *g * *bind)).collect();
        let numbers = transforms.clone();
        transforms.extend(rows(DMat4::from_translation(hip) * DMat4::from_rotation_y(yaw)));
        // Among the poses seen: linear part and the joint's place, each on its own.
        let seen = |(row, numbers): (usize, &[f64; 4])| {
            let (linear, range) = (DVec3::from_slice(numbers), rig.range.as_ref());
            let Some(range) = range else { return *numbers };
            let origin = range.origins[row / 3].as_dvec3();
            let bound =
                |e: usize, x: f64| x.max(f64::from(range.min[4 * row + e])).min(f64::from(range.max[4 * row + e]));
            let near = DVec3::from_array(std::array::from_fn(|e| bound(e, linear[e])));
            let place = bound(3, numbers[3] + linear.dot(origin));
            [near.x, near.y, near.z, place - near.dot(origin)]
        };
        let standard = |(e, x): (usize, f64)| (x - f64::from(rig.mean[e])) / f64::from(rig.std[e]);
        let seen = numbers.as_chunks::<4>().0.iter().enumerate().flat_map(seen);
        vec![Some(transforms), Some(seen.enumerate().map(standard).collect())]
    }
}

/// A rig whose range leaves some numbers of a random pose outside, or that has none.
#[cfg(feature = "suite")]
pub fn rig(rng: &mut fastrand::Rng, joints: usize, ranged: bool) -> Rig {
    let numbers = |rng: &mut fastrand::Rng, scale: f32, add: f32| -> Vec<f32> {
        crate::suite::numbers(rng, 12 * joints, scale).iter().map(|value| value + add).collect()
    };
    let (min, max) = (numbers(rng, 0.5, -1.5), numbers(rng, 0.5, 1.5));
    let inverse_bind: Vec<_> = (0..joints).map(|_| crate::suite::transform(rng)).collect();
    Rig {
        frame: if joints.is_multiple_of(2) { Frame::Hip } else { Frame::HipYaw },
        root: joints / 2,
        joints: (0..joints).map(|j| format!("joint {j}")).collect(),
        range: ranged.then(|| crate::pose::Range::new(&inverse_bind, min, max)),
        inverse_bind,
        mean: numbers(rng, 0.1, 0.0),
        std: numbers(rng, 0.2, 1.0),
    }
}
