//! `x_i += δ_i`. Twin: shaders/lift.wgsl.

/// displacement [n, 3] is added to positions [n, 3].
pub fn lift(displacement: &[f32], positions: &mut [f32]) {
    positions.iter_mut().zip(displacement).for_each(|(position, by)| *position += by);
}
