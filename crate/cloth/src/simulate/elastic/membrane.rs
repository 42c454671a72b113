//! Membrane elements: `A ψ(F)` of the Green strain `G = (FᵀF - I)/2` along weft (1) and warp (2). simulation.md §2.2.
//! The Hessian is `BᵀCB`, `C = ∂²ψ/∂G²`, plus the geometric part; with the stress clamped to tension it is never
//! indefinite.

use glam::{DMat3, DVec2, DVec3};

use super::wrinkling::Wrinkling;
use crate::simulate::material::Material;
use crate::simulate::matrix::outer;

/// What in-plane strain costs.
#[derive(Clone, Copy, Debug)]
pub enum Membrane {
    /// Saint Venant–Kirchhoff, `ψ = ½ G:C:G`, in N/m: `S₁₁ = C₁₁G₁₁ + C₁₂G₂₂`, `S₂₂ = C₁₂G₁₁ + C₂₂G₂₂`,
    /// `S₁₂ = 2 C₃₃G₁₂`.
    Orthotropic {
        /// `C₁₁`, of the weft.
        c11: f64,
        /// `C₂₂`, of the warp.
        c22: f64,
        /// `C₁₂`, between the two.
        c12: f64,
        /// `C₃₃`, shear.
        c33: f64,
    },
    /// Of a mesh too coarse to fold as its cloth does.
    Wrinkling(Wrinkling),
}

impl Membrane {
    /// Of an orthotropic sheet in plane stress.
    pub fn new(material: &Material) -> Self {
        let Material { warp, weft, shear, poisson, .. } = *material;
        let free = 1.0 - poisson * poisson;
        let c12 = poisson * (warp * weft).sqrt() / free;
        Self::Orthotropic { c11: weft / free, c22: warp / free, c12, c33: shear }
    }

    /// Energy per area, J/m², and second Piola stress (s11, s22, s12), N/m, at the strain (G11, G22, G12).
    fn response(&self, strain @ [g11, g22, g12]: [f64; 3]) -> (f64, [f64; 3]) {
        match *self {
            Self::Orthotropic { c11, c22, c12, c33 } => {
                let stress @ [s11, s22, s12] = [c11 * g11 + c12 * g22, c12 * g11 + c22 * g22, 2.0 * c33 * g12];
                (0.5 * (s11 * g11 + s22 * g22) + s12 * g12, stress)
            }
            Self::Wrinkling(law) => law.response(strain),
        }
    }

    /// Derivatives of the stress (s11, s22, s12) by (G11, G22, 2 G12), N/m.
    fn tangent(&self, strain: [f64; 3]) -> [[f64; 3]; 3] {
        match *self {
            Self::Orthotropic { c11, c22, c12, c33 } => [[c11, c12, 0.0], [c12, c22, 0.0], [0.0, 0.0, c33]],
            Self::Wrinkling(law) => law.tangent(strain),
        }
    }
}

/// A membrane triangle at rest.
#[derive(Clone, Debug)]
pub struct Triangle {
    /// Cloth vertices.
    pub vertices: [usize; 3],
    /// Gradients of the three shape functions along weft and warp, 1/m.
    pub gradients: [DVec2; 3],
    /// Rest area, m².
    pub area: f64,
}

impl Triangle {
    /// From the rest positions of its corners and the direction of the warp, which need not lie in its plane; `None`
    /// when the triangle has no area to speak of.
    pub fn new(vertices: [usize; 3], [a, b, c]: [DVec3; 3], warp: DVec3) -> Option<Self> {
        let (e1, e2) = (b - a, c - a);
        let normal = e1.cross(e2);
        let area = 0.5 * normal.length();
        let longest = e1.length_squared().max(e2.length_squared()).max((c - b).length_squared());
        if !area.is_finite() || area <= 1e-4 * longest {
            return None;
        }
        let normal = normal.normalize();
        let along = warp.reject_from_normalized(normal);
        // A triangle across the warp has no direction of it.
        let v = if along.length_squared() > 1e-6 { along.normalize() } else { e1.normalize() };
        let u = v.cross(normal);
        let (p, q) = (DVec2::new(e1.dot(u), e1.dot(v)), DVec2::new(e2.dot(u), e2.dot(v)));
        let determinant = p.perp_dot(q);
        let g1 = DVec2::new(q.y, -q.x) / determinant;
        let g2 = DVec2::new(-p.y, p.x) / determinant;
        Some(Self { vertices, gradients: [-(g1 + g2), g1, g2], area })
    }

    /// Columns of `F = Σ x_a ⊗ g_a` at the positions `x` [n]: what became of a metre of weft, and of warp.
    pub fn deformation(&self, x: &[DVec3]) -> [DVec3; 2] {
        let [a, b, c] = self.vertices.map(|i| x[i]);
        let [_, g1, g2] = self.gradients;
        let (d1, d2) = (b - a, c - a);
        [d1 * g1.x + d2 * g2.x, d1 * g1.y + d2 * g2.y]
    }

    /// At the positions `x` [n], singular values of `F`, largest first: the principal stretches.
    pub fn stretches(&self, x: &[DVec3]) -> [f64; 2] {
        let [f1, f2] = self.deformation(x);
        Principal::of([f1.length_squared(), f2.length_squared(), f1.dot(f2)]).values.map(|value| value.max(0.0).sqrt())
    }

    /// Energy at the positions `x` [n], joules.
    pub fn energy(&self, membrane: &Membrane, x: &[DVec3]) -> f64 {
        self.area * membrane.response(strain(self.deformation(x))).0
    }

    /// Gradient of the energy at `x` [n] per corner, newtons: the forces are its negative.
    pub fn gradient(&self, membrane: &Membrane, x: &[DVec3]) -> [DVec3; 3] {
        self.derivatives(membrane, x, false, |_, _, _| {})
    }

    /// Gradient per corner in newtons, and the Hessian through `block(a, b, H_ab)` for the pairs `a >= b`: exact, or
    /// with compression left out.
    pub(in crate::simulate) fn derivatives(
        &self,
        membrane: &Membrane,
        x: &[DVec3],
        exact: bool,
        mut block: impl FnMut(usize, usize, DMat3),
    ) -> [DVec3; 3] {
        let columns @ [f1, f2] = self.deformation(x);
        let strain = strain(columns);
        let stress @ [s11, s22, s12] = membrane.response(strain).1;
        let (p1, p2) = ((f1 * s11 + f2 * s12) * self.area, (f1 * s12 + f2 * s22) * self.area);
        let tangent = membrane.tangent(strain);
        let [t11, t22, t12] = if exact { stress } else { tension(stress) };
        let g = self.gradients;
        let b = g.map(|g| [f1 * g.x, f2 * g.y, f1 * g.y + f2 * g.x]);
        for i in 0..3 {
            for j in 0..=i {
                let geometric = g[i].x * (t11 * g[j].x + t12 * g[j].y) + g[i].y * (t12 * g[j].x + t22 * g[j].y);
                let [c1, c2, c3] = tangent.map(|row| b[j][0] * row[0] + b[j][1] * row[1] + b[j][2] * row[2]);
                let material = outer(b[i][0], c1) + outer(b[i][1], c2) + outer(b[i][2], c3);
                block(i, j, (material + DMat3::from_diagonal(DVec3::splat(geometric))) * self.area);
            }
        }
        g.map(|g| p1 * g.x + p2 * g.y)
    }
}

/// Green strain (G11, G22, G12) of the columns of `F`.
fn strain([f1, f2]: [DVec3; 2]) -> [f64; 3] {
    [0.5 * (f1.length_squared() - 1.0), 0.5 * (f2.length_squared() - 1.0), 0.5 * f1.dot(f2)]
}

/// The tensile part of a symmetric 2×2 stress (s11, s22, s12): negative eigenvalues set to zero.
fn tension(stress: [f64; 3]) -> [f64; 3] {
    let Principal { values: [high, low], axis: v } = Principal::of(stress);
    if low >= 0.0 {
        return stress;
    }
    if high <= 0.0 {
        return [0.0; 3];
    }
    [high * v.x * v.x, high * v.y * v.y, high * v.x * v.y]
}

/// Eigenvalues of a symmetric 2×2 matrix, the greater first, and the unit eigenvector of that one.
pub(super) struct Principal {
    pub values: [f64; 2],
    pub axis: DVec2,
}

impl Principal {
    /// Of the entries 11, 22, 12.
    pub fn of([a, b, c]: [f64; 3]) -> Self {
        let (mean, half) = (0.5 * (a + b), 0.5 * (a - b));
        let radius = (half * half + c * c).sqrt();
        // The better conditioned of the two rows.
        let v = if half >= 0.0 { DVec2::new(half + radius, c) } else { DVec2::new(c, radius - half) };
        Self { values: [mean + radius, mean - radius], axis: v.normalize_or(DVec2::X) }
    }
}
