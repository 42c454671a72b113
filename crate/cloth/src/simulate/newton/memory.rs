//! What the last steps say of the curvature that the factor does not know (L-BFGS, Liu & Nocedal 1989, with the factor
//! as its first inverse; Liu, Bouaziz & Kavan 2017). A step with it costs a quarter of a factorisation.

use glam::DVec3;

use crate::simulate::matrix::Matrix;

/// The steps since the last factorisation.
pub(super) struct Memory {
    x: Vec<DVec3>,
    gradient: Vec<DVec3>,
    pairs: Vec<Pair>,
}

/// A step, how the gradient changed over it, and the inverse of their product.
struct Pair {
    step: Vec<DVec3>,
    change: Vec<DVec3>,
    inverse: f64,
}

impl Memory {
    /// Starts where the factorised Hessian was taken: `x` [n] and the gradient there [n].
    pub fn new(x: &[DVec3], gradient: &[DVec3]) -> Self {
        Self { x: x.to_vec(), gradient: gradient.to_vec(), pairs: Vec::new() }
    }

    /// The step from `x`, where the gradient is this.
    pub fn step(&mut self, matrix: &mut Matrix, x: &[DVec3], gradient: Vec<DVec3>) -> Vec<DVec3> {
        self.learn(x, &gradient);
        let mut rest = gradient;
        let mut shares = vec![0.0; self.pairs.len()];
        for (share, pair) in shares.iter_mut().zip(&self.pairs).rev() {
            *share = pair.inverse * dot(&pair.step, &rest);
            rest.iter_mut().zip(&pair.change).for_each(|(rest, change)| *rest -= *change * *share);
        }
        let mut step = matrix.step(&rest);
        for (share, pair) in shares.iter().zip(&self.pairs) {
            let excess = share + pair.inverse * dot(&pair.change, &step);
            step.iter_mut().zip(&pair.step).for_each(|(step, old)| *step -= *old * excess);
        }
        step
    }

    fn learn(&mut self, x: &[DVec3], gradient: &[DVec3]) {
        let step = minus(x, &self.x);
        let change = minus(gradient, &self.gradient);
        let product = dot(&step, &change);
        if product > 1e-12 * (dot(&step, &step) * dot(&change, &change)).sqrt() {
            self.pairs.push(Pair { step, change, inverse: product.recip() });
        }
        (self.x, self.gradient) = (x.to_vec(), gradient.to_vec());
    }
}

fn dot(a: &[DVec3], b: &[DVec3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum()
}

fn minus(a: &[DVec3], b: &[DVec3]) -> Vec<DVec3> {
    a.iter().zip(b).map(|(a, b)| *a - *b).collect()
}
