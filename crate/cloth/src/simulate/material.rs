//! Fabric constants: what a tensile test, a bias extension test, a cantilever test and a scale would measure.
//! simulation.md §2.2.

use crate::{Error, Result};

/// Acceleration of gravity along -Y, m/s².
pub const GRAVITY: f64 = 9.81;

/// A homogeneous woven or knitted fabric.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Material {
    /// Mass per area, kg/m².
    pub density: f64,
    /// Membrane stiffness `E·h` along the warp (down the garment), N/m: force per width at unit strain.
    pub warp: f64,
    /// Membrane stiffness along the weft (around the garment), N/m.
    pub weft: f64,
    /// Shear stiffness `G·h`, N/m; `E·h / 2(1 + ν)` in an isotropic sheet.
    pub shear: f64,
    /// Poisson's ratio, the geometric mean of both directions', in 0..0.5.
    pub poisson: f64,
    /// Bending stiffness `D`, N·m.
    pub bending: f64,
    /// Coulomb friction coefficient against the body.
    pub friction: f64,
}

/// A material and what it is called.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Fabric {
    /// Name.
    pub name: String,
    /// Constants.
    #[serde(flatten)]
    pub material: Material,
}

impl std::fmt::Display for Fabric {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Material { density, warp, weft, shear, poisson, bending, friction } = self.material;
        write!(f, "{}: {density} kg/m², warp {warp:.0} N/m, weft {weft:.0}, shear {shear:.0}, ", self.name)?;
        write!(f, "Poisson {poisson}, bending {bending:e} N·m, friction {friction}")
    }
}

/// Fabrics by name. Densities and bending stiffnesses are typical of the fabric; tensile stiffnesses lie at the upper
/// end of what is measured at small strain, so that cloth stays within two per cent on a moving body. Bending lengths
/// are 2 cm or more: what a mesh of 2,000 to 5,000 vertices resolves. Friction is 0.1 in all: more leaves the history
/// of the path in the truth.
const FABRICS: &[(&str, Material)] = &[
    ("cotton", Material::isotropic(0.20, 1000.0, 0.3, 6e-5)),
    ("jersey", Material::woven(0.18, [800.0, 600.0], 250.0, 2.4e-5)),
    ("denim", Material::woven(0.40, [2500.0, 2000.0], 700.0, 3e-4)),
    ("silk", Material::woven(0.08, [1200.0, 1000.0], 200.0, 8e-6)),
    ("felt", Material::isotropic(0.30, 1500.0, 0.2, 1.6e-4)),
];

impl Default for Material {
    /// Cotton.
    fn default() -> Self {
        FABRICS[0].1
    }
}

impl Material {
    /// The same along both threads: membrane stiffness `stretch` N/m, bending stiffness N·m.
    pub const fn isotropic(density: f64, stretch: f64, poisson: f64, bending: f64) -> Self {
        let shear = stretch / (2.0 * (1.0 + poisson));
        Self { density, warp: stretch, weft: stretch, shear, poisson, bending, friction: 0.1 }
    }

    const fn woven(density: f64, [warp, weft]: [f64; 2], shear: f64, bending: f64) -> Self {
        Self { density, warp, weft, shear, poisson: 0.2, bending, friction: 0.1 }
    }

    /// The fabric of that name.
    pub fn named(name: &str) -> Result<Self> {
        let found = FABRICS.iter().find(|(known, _)| *known == name).map(|(_, material)| *material);
        found.ok_or_else(|| Error::Simulation(format!("material: wanted one of {}, found {name}", Self::names())))
    }

    /// The names, for help and errors.
    pub fn names() -> String {
        FABRICS.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ")
    }

    /// Checks that every constant is finite and in its range.
    pub(super) fn check(&self) -> Result<()> {
        let fields = [
            ("density", self.density, 1e-4, 100.0),
            ("warp", self.warp, 1e-3, 1e9),
            ("weft", self.weft, 1e-3, 1e9),
            ("shear", self.shear, 1e-3, 1e9),
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
