//! `T = rest + Δ`: the gradient goes to the residual alone. The template's rest is constant, and where the rest is the coarse
//! template, the skeleton stream learns from its own target only: network.md §6.

/// g [n, 3] is added to dresidual [n, 3].
pub fn add(g: &[f32], dresidual: &mut [f32]) {
    dresidual.iter_mut().zip(g).for_each(|(dresidual, g)| *dresidual += g);
}
