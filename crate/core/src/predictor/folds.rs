//! The mesh stream is the dear part of the network, and what it adds changes slowly. So a cloth may have it computed in
//! some frames only, and go from one residual to the next in between. This costs it a lag of as many frames. Measured
//! on an unseen clip in docs/results/speed.md.

/// What one cloth shows of the mesh stream between two frames that compute it. Made once for each cloth.
#[derive(Clone, Debug)]
pub struct Folds {
    /// Residual at the last frame that set an aim [n, 3].
    from: Vec<f32>,
    /// Residual that is aimed at [n, 3].
    to: Vec<f32>,
    /// How much of the way is done, 0 to 1.
    done: f32,
}

impl Folds {
    /// None yet, of a cloth of `n` vertices.
    pub fn new(n: usize) -> Self {
        Self { from: vec![0.0; n * 3], to: vec![0.0; n * 3], done: 1.0 }
    }

    /// Aims at `residual` [n, 3] from what is shown now.
    pub(super) fn aim(&mut self, residual: &[f32]) {
        for ((from, to), residual) in self.from.iter_mut().zip(&mut self.to).zip(residual) {
            *from += self.done * (*to - *from);
            *to = *residual;
        }
        self.done = 0.0;
    }

    /// Goes on by a `step` of the way, up to its end; template = coarse + share · what is shown [n, 3].
    pub(super) fn show(&mut self, step: f32, coarse: &[f32], share: f32, template: &mut [f32]) {
        self.done = (self.done + step).clamp(0.0, 1.0);
        let way = self.from.iter().zip(&self.to);
        for ((template, coarse), (from, to)) in template.iter_mut().zip(coarse).zip(way) {
            *template = coarse + share * (from + self.done * (to - from));
        }
    }
}
