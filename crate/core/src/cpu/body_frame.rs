//! `N·A_j`, `N⁻¹` and the standardised pose vector γ. network.md §1. In f64: J matrices cost nothing. Twin: shaders/body_frame.wgsl.

use crate::pose::{Frame, Rig};

/// joints `G_j` [J, 3, 4] -> transforms [J + 1, 3, 4], vector [12J].
pub fn body_frame(rig: &Rig, joints: &[f32], transforms: &mut [f32], vector: &mut [f32]) {
    let joint = |j: usize| -> [f64; 12] { std::array::from_fn(|e| f64::from(joints[12 * j + e])) };
    let skinning = |j: usize| multiply(&joint(j), &rig.inverse_bind[j].map(f64::from));
    let (hip, a) = (joint(rig.root), skinning(rig.root));
    let heading = match rig.frame {
        Frame::HipYaw => (a[2] - a[8]).atan2(a[0] + a[10]),
        Frame::Hip => 0.0,
    };
    let (sin, cos) = heading.sin_cos();
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

/// Product of two 3×4 transforms.
fn multiply(a: &[f64; 12], b: &[f64; 12]) -> [f64; 12] {
    std::array::from_fn(|e| {
        let (row, column) = (e / 4, e % 4);
        let offset = if column == 3 { a[4 * row + 3] } else { 0.0 };
        (0..3).map(|i| a[4 * row + i] * b[4 * i + column]).sum::<f64>() + offset
    })
}
