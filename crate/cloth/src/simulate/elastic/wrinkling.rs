//! A membrane that wrinkles below the size of its mesh: along a principal direction that is compressed it hardly
//! pushes back (tension field theory: Reissner, On tension field theory, 1938; Pipkin, The relaxed energy density for
//! isotropic elastic membranes, 1986). A thinned garment, whose edges of 3 cm cannot fold, otherwise props itself up
//! where the cloth it stands for bunches.

use super::membrane::Principal;
use crate::simulate::material::Material;

/// Share of the stiffness that is left under compression. Chosen with [`YIELD`] by how far garments of 3,000 to 6,000
/// vertices, relaxed as 700, lie from themselves relaxed whole: docs/decisions/poses.md.
const SHARE: f64 = 0.05;
/// Strain over which the stiffness falls to that, compressed. Wrinkling at once makes the slope jump, and is no nearer.
const YIELD: f64 = 0.001;

/// An isotropic membrane without Poisson's effect, `ψ = Σ ψ(λ)` over the principal Green strains `λ`.
#[derive(Clone, Copy, Debug)]
pub struct Wrinkling {
    /// Stiffness under tension, N/m.
    stiffness: f64,
}

/// Energy, stress and slope at one principal strain.
struct Response {
    strain: f64,
    energy: f64,
    stress: f64,
    slope: f64,
}

impl Wrinkling {
    /// As stiff as warp and weft in the geometric mean.
    pub fn new(material: &Material) -> Self {
        Self { stiffness: (material.warp * material.weft).sqrt() }
    }

    fn along(&self, strain: f64) -> Response {
        let k = self.stiffness;
        if strain >= 0.0 {
            return Response { strain, energy: 0.5 * k * strain * strain, stress: k * strain, slope: k };
        }
        let (fallen, lost) = ((strain / YIELD).exp(), (1.0 - SHARE) * YIELD);
        Response {
            strain,
            energy: k * (0.5 * SHARE * strain * strain - lost * (strain + YIELD * (1.0 - fallen))),
            stress: k * (SHARE * strain - lost * (1.0 - fallen)),
            slope: k * (SHARE + (1.0 - SHARE) * fallen),
        }
    }

    /// What there is along both principal directions at the strain (G11, G22, G12), and of the first direction `v`
    /// (v₁², v₂², v₁v₂).
    fn principal(&self, strain: [f64; 3]) -> ([Response; 2], [f64; 3]) {
        let Principal { values, axis } = Principal::of(strain);
        (values.map(|value| self.along(value)), [axis.x * axis.x, axis.y * axis.y, axis.x * axis.y])
    }

    /// Energy per area and stress (s11, s22, s12) at the strain (G11, G22, G12).
    pub(super) fn response(&self, strain: [f64; 3]) -> (f64, [f64; 3]) {
        let ([first, second], [xx, yy, xy]) = self.principal(strain);
        let (s1, s2) = (first.stress, second.stress);
        (first.energy + second.energy, [s1 * xx + s2 * yy, s1 * yy + s2 * xx, (s1 - s2) * xy])
    }

    /// Derivatives of the stress by (G11, G22, 2 G12), positive definite: slopes along the principal directions, and
    /// between them what turns the stress with the strain.
    pub(super) fn tangent(&self, strain: [f64; 3]) -> [[f64; 3]; 3] {
        let ([first, second], [xx, yy, xy]) = self.principal(strain);
        let apart = first.strain - second.strain;
        let turn =
            if apart > 1e-9 { (first.stress - second.stress) / apart } else { 0.5 * (first.slope + second.slope) };
        let (along, across, between) = ([xx, yy, xy], [yy, xx, -xy], [-2.0 * xy, 2.0 * xy, xx - yy]);
        let entry = |i: usize, j: usize| {
            first.slope * along[i] * along[j]
                + second.slope * across[i] * across[j]
                + 0.5 * turn * between[i] * between[j]
        };
        std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Stretched along any direction it pulls with its stiffness; compressed by a tenth, with a sixteenth of it.
    #[test]
    fn it_resists_tension_and_hardly_compression() {
        let law = Wrinkling::new(&Material::default());
        for turn in [0.0f64, 0.4, 1.1, 2.0] {
            let (s, c) = turn.sin_cos();
            let along = |strain: f64| {
                let (_, [s11, s22, s12]) = law.response([strain * c * c, strain * s * s, strain * s * c]);
                s11 * c * c + s22 * s * s + 2.0 * s12 * s * c
            };
            assert!((along(0.1) - 0.1 * law.stiffness).abs() < 1e-9 * law.stiffness);
            let pushed = -along(-0.1) / (0.1 * law.stiffness);
            assert!((SHARE..SHARE + 0.0125).contains(&pushed), "{pushed}");
        }
    }
}
