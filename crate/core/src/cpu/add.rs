//! `T = rest + Δ`. network.md §4.

/// rest [n, 3] + residual [n, 3] -> template [n, 3].
pub fn add(rest: &[f32], residual: &[f32], template: &mut [f32]) {
    for ((template, rest), residual) in template.iter_mut().zip(rest).zip(residual) {
        *template = rest + residual;
    }
}
