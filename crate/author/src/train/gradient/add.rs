//! `T = rest + Δ`: the gradient goes to the residual alone. The template's rest is constant, and where the rest is the coarse
//! template, the skeleton stream learns from its own target only: network.md §6.

/// g [n, 3] -> dresidual [n, 3], overwritten.
pub fn add(g: &[f32], dresidual: &mut [f32]) {
    dresidual.copy_from_slice(g);
}
