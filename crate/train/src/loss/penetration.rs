//! What the loss adds for cloth inside the body: the paper's `E_B` (§ Penetration Handling) of the prediction before
//! its repair, so that less is left to repair. It needs no truth, so poses that nobody simulated teach it as well. (Of
//! a skirt, 1.5 % of the vertices are inside the body in unseen poses without this loss, 1.2 where it is of the
//! simulated poses alone, 0.9 with others, all with a weight of 1.)

use super::{Loss, Prediction, Term};
use ctsn_core::cpu::Cpu;
use ctsn_core::cpu::repair::closest::GAP;
use ctsn_core::model::{Body, HostModel};
use ctsn_core::network::{pose_body, push};
use ctsn_core::operation::Space;
use ctsn_core::pose::BodyFrame;

/// A metre inside the body beside a metre from the truth. (With a weight of 1 a repaired cape's slow motion trembled by
/// 4.8 and 5.4 % more in two trainings, with 2 by 2.8 in one; 0.3 and 0.4 % of its vertices were inside before the
/// repair, then 0.2.)
///
/// Of unsimulated poses the skeleton stream learns alone: most of what is inside the body is so by its prediction, and
/// a pass of both streams takes some twenty times as long.
pub(super) const PENETRATION: Term = Term {
    name: "penetration",
    title: "inside the body",
    unit: "m",
    weight: 2.0,
    constants: &[],
    simulated: &[Prediction::Coarse, Prediction::Whole],
    unsimulated: &[Prediction::Coarse],
    new: |scene| Ok(Penetration::of(scene.model).map(|body| Box::new(body) as Box<dyn Loss>)),
};

/// The body of one pose after the other; one per thread.
pub(super) struct Penetration {
    body: Body<Vec<f32>, Vec<u32>>,
    cpu: Cpu,
    posed: Vec<f32>,
    normals: Vec<f32>,
    cloth: Vec<f32>,
    push: Vec<f32>,
}

impl Penetration {
    /// Of a model's body and cloth; none where it has no body.
    pub fn of(model: &HostModel) -> Option<Self> {
        model.body.as_ref().map(|body| Self::new(body, model.sizes.vertices))
    }

    /// Room for a body and its cloth.
    fn new(body: &Body<Vec<f32>, Vec<u32>>, n: usize) -> Self {
        let room = |vertices: usize| vec![0.0; vertices * 3];
        let [posed, normals] = std::array::from_fn(|_| room(body.vertices));
        Self { body: body.clone(), cpu: Cpu::new(), posed, normals, cloth: room(n), push: room(n) }
    }

    /// What each vertex of `predicted` [n, 3] lacks to the gap around the body posed last [n, 3].
    pub fn lacks(&mut self, predicted: &[f32]) -> &[f32] {
        let Self { body, cpu, posed, normals, cloth, push: lacks } = self;
        cloth.copy_from_slice(predicted);
        push(cpu, body, GAP, [posed, normals, cloth], lacks);
        lacks
    }
}

impl Loss for Penetration {
    /// Poses the body.
    fn pose(&mut self, body_frame: &BodyFrame) {
        let Self { body, cpu, posed, normals, .. } = self;
        pose_body(cpu, body, &body_frame.transforms, Space::Body, [posed, normals]);
    }

    /// Mean over the vertices of what `predicted` lacks to the gap around the body.
    fn value(&mut self, predicted: &[f32], _: &[f32], scale: f32, gradient: &mut [f32]) -> f32 {
        let count = predicted.len() as f32 / 3.0;
        let lacks = self.lacks(predicted);
        let mut total = 0.0_f64;
        for (push, g) in lacks.as_chunks::<3>().0.iter().zip(gradient.as_chunks_mut::<3>().0) {
            let length = push.iter().map(|d| d * d).sum::<f32>().sqrt();
            total += f64::from(length);
            if length > 0.0 {
                (0..3).for_each(|c| g[c] -= scale * push[c] / (length * count));
            }
        }
        (total / f64::from(count)) as f32
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use ctsn_core::model::Skinning;
    use glam::Vec3;

    /// An octahedron with its edges halved, all on the unit sphere, on one joint that stays where it is, and its
    /// vertices times a radius as cloth.
    pub fn ball() -> (Penetration, impl Fn(f32) -> Vec<f32>) {
        let axes = [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z];
        let faces: [[usize; 3]; 8] =
            [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
        let mut points = axes.to_vec();
        let mut triangles = Vec::new();
        for [a, b, c] in faces {
            let mut middle = |a: usize, b: usize| {
                let point = (points[a] + points[b]).normalize();
                points.iter().position(|other| other.abs_diff_eq(point, 1e-6)).unwrap_or_else(|| {
                    points.push(point);
                    points.len() - 1
                })
            };
            let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
            triangles.extend([a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca].map(|corner| corner as u32));
        }
        let n = points.len();
        let at = move |radius: f32| points.iter().flat_map(|point| (radius * point).to_array()).collect::<Vec<f32>>();
        let skin = Skinning { joints: vec![0; n], weights: vec![1.0; n], width: 1 };
        let body = Body::new(at(1.0), skin, triangles, (0..n as u32).collect());
        let mut body_frame = BodyFrame::new(1);
        (0..3).for_each(|axis| body_frame.transforms[5 * axis] = 1.0);
        let mut penetration = Penetration::new(&body, n);
        penetration.pose(&body_frame);
        (penetration, at)
    }

    #[test]
    fn cloth_inside_the_body_is_told_the_way_out() {
        let (mut penetration, at) = ball();
        let n = at(1.0).len();
        let mut learn = |radius: f32| {
            let mut g = vec![5.0; n];
            (penetration.value(&at(radius), &[], 0.5, &mut g), g)
        };
        assert_eq!(learn(1.01), (0.0, vec![5.0; n]), "outside, nothing is added");
        let ((deep, g), (deeper, _)) = (learn(0.95), learn(0.94));
        assert!((0.03..0.06).contains(&deep) && deeper > deep, "{deep} m, {deeper} m");
        let slope: f32 = g.iter().zip(at(0.94).iter().zip(at(0.95))).map(|(g, (b, a))| (g - 5.0) * (b - a)).sum();
        // Corners are lifted along their own normals: the faces beside them are inclined by up to 30°, and as much
        // further.
        let share = 0.5 * (deeper - deep) / slope;
        assert!((0.7..1.01).contains(&share), "{slope} against {}", deeper - deep);
    }
}
