//! Fabric constants: what a cantilever test, a tensile test and a scale would measure. simulation.md §2.2.

use crate::{Error, Result};

/// Acceleration of gravity along -Y, m/s².
pub const GRAVITY: f64 = 9.81;

/// A homogeneous, isotropic fabric.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Mass per area, kg/m².
    pub density: f64,
    /// Membrane stiffness `E·h`, N/m: force per width at unit strain.
    pub stretch: f64,
    /// Poisson's ratio, in 0..0.5.
    pub poisson: f64,
    /// Bending stiffness `D`, N·m.
    pub bending: f64,
    /// Coulomb friction coefficient against the body.
    pub friction: f64,
}

impl Default for Material {
    /// A firm cotton: bending length 3.1 cm, so that a mesh edge of 2 cm still resolves its folds.
    fn default() -> Self {
        Self { density: 0.2, stretch: 1000.0, poisson: 0.3, bending: 6e-5, friction: 0.1 }
    }
}

impl Material {
    /// `(D / ρg)^(1/3)` in metres: how far the cloth stands out before its weight bends it.
    pub fn bending_length(&self) -> f64 {
        (self.bending / (self.density * GRAVITY)).cbrt()
    }

    /// In-plane Lamé constants (μ, λ), N/m.
    pub(super) fn lame(&self) -> (f64, f64) {
        let Self { stretch, poisson, .. } = *self;
        (stretch / (2.0 * (1.0 + poisson)), stretch * poisson / (1.0 - poisson * poisson))
    }

    /// Checks that every constant is finite and in its range.
    pub(super) fn check(&self) -> Result<()> {
        let fields = [
            ("density", self.density, 1e-4, 100.0),
            ("stretch", self.stretch, 1e-3, 1e9),
            ("poisson", self.poisson, 0.0, 0.499),
            ("bending", self.bending, 0.0, 1e3),
            ("friction", self.friction, 0.0, 10.0),
        ];
        for (name, value, low, high) in fields {
            if !(low..=high).contains(&value) {
                return Err(Error::Simulation(format!("material {name}: wanted {low}..{high}, found {value}")));
            }
        }
        Ok(())
    }
}
