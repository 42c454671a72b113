//! A step in which predicted cloth takes back the lengths it was cut to. A network that learns from cloth which buckles
//! now this way and now that answers the mean of both: the folds are there, as compression, and come out when every
//! edge asks for its length. network.md §5. Twin: shaders/polish.wgsl.
//!
//! `x_i += s (w (a p_i + (1 - a) mean_j p_j) + μ v_i)`, `p` the [`Pull`](crate::operation::Pull)s, shared once before
//! ([`Diffuse`](crate::operation::Diffuse)), `v` the last step; then, where that brought it nearer to the body than its
//! gap, back to the gap, along the direction in which the body was found before the first step.
//! Cloth that is too short grows waves, the shorter the faster, so of pulls alone it crinkles at the scale of its mesh.
//! Shared with the neighbours they grow the long ones. A T-shirt of 6,000 vertices whose folds were smoothed away (20
//! rounds), 16 steps: normals 7.6° from the truth's in place of 9.0, curvature correlates by 0.56 in place of 0.30,
//! strain 2.8 % in place of 3.6. Four times and more is worse.
//!
//! Unseen frames of a dress of 6,016 vertices, 16 steps, after the repair; its network had learned through the first:
//! shared once, w = 5.5, without the body 10.26 mm, 10.3°, strain 1.24 %, energy 2.3 times the simulation's; with the
//! body 10.19 mm, 1.25 %, 2.1; shared twice, w = 11, without it 10.18 mm, 10.4°, 1.03 %, 2.3; **with it 10.07 mm,
//! 10.3°, 1.04 %, 1.8**; shared three times, w = 14, 10.03 mm, 10.3°, 1.03 %, 1.8. Twice and w = 8: 1.17 %, 2.0, and
//! with μ = 0.85 1.33 %, 2.3, with 0.92 1.9 %, 3.7. More steps: 32 9.93 mm, 10.4°, 0.78 %, 1.45.
//!
//! Since then w = 18. Clips of the page, models that learned through w = 11, E_dist, E_norm, strain, energy: a robe
//! 12.49 mm, 10.37°, 0.90 %, 11.4 with 11; 12.34 mm, 10.21°, 0.74 %, 8.4 with 18; 12.24 mm, 10.14°, 0.67 %, 7.2 with
//! 24; 12.14 mm, 10.13°, 0.62 %, 6.3 with 32; with 45 it runs away. A dress of 2,996 vertices 10.65 mm, 8.17°, 0.96
//! %, 4.4; 10.52 mm, 8.12°, 0.83 %, 4.2; 10.47 mm, 8.12°, 0.80 %, 4.5; 10.44 mm, 8.21°, 0.79 %, 5.3, and slow motion
//! trembles by 0.08, 0.09, 0.11 and 0.16 m/s². 24 steps: 10.42 mm, 8.04°, 0.72 %, 4.3, trembling 0.12. The body
//! asked once more after 16 of those: 10.43 mm, 8.04°, 0.73 %, 3.5. Without the body, long waves are no quicker by
//! exact solutions (projective dynamics, 4 to 16 of them): 8.7 to 11 mm, where 16 of these steps have 8.5 and 32
//! 8.4.
//!
//! Tried on 14 unseen poses of a T-shirt with steps of pulls that are not shared, 16 each: the membrane of triangles
//! in place of edges, by the nearest rotation of each (bending ratio 0.945 in place of 0.930, strain 1.36 % in place
//! of 1.45, E_dist the same, at some four times the cost); edges weighted by the area beside them (no difference to
//! two digits); bending stiffness, of 16 times the fabric's (0.73) and more (flat), because at this length of edges
//! the fabric's own is next to nothing; the repair of penetration after every second step (strain 1.45 in place of
//! 1.49 % in the end, for twice the cost). Moving along the surface alone in the first steps (strain 1.1 % and more in
//! place of 0.9).
//!
//! Cloth is slow on the body, not in the air: every third frame of the page's clip in Anna's T-shirt ends 3.83 mm and
//! 5.43° off after 16 steps, 3.37 mm and 4.68° after 64; without the body 3.95 mm, 5.73° and 3.98 mm, 5.67°
//! (2026-11-28, in Python, before the repair). Tried to quicken it, 16 steps: momentum shared like the pulls, 0.9 of it
//! 4.19 mm, 5.56°; μ = 0.9 of a dress, 8.12 mm, 7.53° in place of 7.86 mm, 6.71°, growing as Nesterov's 7.93 mm, 6.78°;
//! in four of the steps pulls between vertices two to four edges apart, for a distance that grows as the strain around
//! them asks, 3.86 to 4.64 mm, 5.5 to 5.9°; the first way out of the body spread over 2 to 16 rounds before the first
//! step (a dress: 8.07 mm, 6.8° as without); twice the pull along the normal 3.76 mm, 5.32°, four times 3.94 mm, 5.93°,
//! six times runs away.

use super::diffuse::diffused;
use crate::cpu::repair::closest::GAP;
use crate::cpu::threads::of;
use crate::cpu::{Cpu, Kernel};
use crate::operation::Polish;
use crate::topology::Graph;
use glam::Vec3;

/// w. Steps are stable, to first order and on any mesh, below `2 (1 + μ) / (⅝ · 0.247) = 22`: ⅝ of an edge is the most
/// by which its pull can change along it, `0.247` the most of `(1 - m) (a + (1 - a) m)²` for the mean over neighbours,
/// `m` from -1 to 1.
pub const RATE: f32 = 18.0;
/// a: below ⅓ sharing would turn some pulls around.
pub const OWN: f32 = 0.4;
/// μ of every step but the first.
pub const MOMENTUM: f32 = 0.7;
/// Cloth further above the body than this does not meet it on its way, metres. (With 30 mm the dress is as good; with 6
/// its energy is 2.0 in place of 1.8, and no time is saved.)
pub const REACH: f32 = 0.01;

impl Kernel for Polish<&[f32], &mut [f32], &[u32]> {
    fn run(self, cpu: &mut Cpu) {
        let Self { offsets, neighbours, share, first, facing, pulls, moves, near, positions } = self;
        let (graph, pulls) = (Graph { offsets, neighbours }, pulls.as_chunks::<3>().0);
        let (rate, momentum) = (share[0] * RATE, share[0] * MOMENTUM);
        let outputs = [moves, near, positions];
        cpu.threads.share(pulls.len(), outputs, &mut cpu.scratch, |rows, [moves, near, positions], _| {
            let facing = of(facing, &rows, 3).as_chunks::<3>().0;
            let moves = moves.as_chunks_mut::<3>().0.iter_mut().zip(near.as_chunks_mut::<3>().0);
            let cloth = positions.as_chunks_mut::<3>().0.iter_mut().zip(facing);
            for (i, ((by, near), (position, facing))) in rows.zip(moves.zip(cloth)) {
                // What was there before the first step may be anything.
                let on = if first { Vec3::ZERO } else { Vec3::from_array(*by) * momentum };
                let step = diffused(graph, pulls, i) * rate + on;
                let lack = Vec3::from_array(*near);
                let lack = if first { leant(lack, Vec3::from_array(*facing)) } else { lack };
                let (step, lack) = kept_out(step, lack);
                *by = step.to_array();
                *near = lack.to_array();
                *position = (Vec3::from_array(*position) + step).to_array();
            }
        });
    }
}

/// What a vertex lacks to [`REACH`], the more along its own normal the deeper it is inside the body: there the nearest
/// skin does not tell on which side of a limb the cloth belongs. Where a kick passed through a skirt, some of it came
/// out behind the leg, and edges grew to six times their length. 38 frames of that dress had 85 times the energy of the
/// simulation; without a plane where the normals are opposed 5.2 times, with this 4.2, and slow motion trembles by 0.08
/// in place of 0.10 m/s². (Twice as steep: the same. At most twice the normal: 4.4. The same in the search of the
/// repair: nothing more.)
#[inline(always)]
fn leant(lack: Vec3, facing: Vec3) -> Vec3 {
    let length = lack.length();
    if length <= REACH {
        return lack;
    }
    (lack / length + facing * (length / REACH - 1.0)).normalize_or_zero() * length
}

/// A step of a vertex that lacks so much to [`REACH`], such that it comes no nearer than the gap; and what it lacks
/// then.
#[inline(always)]
fn kept_out(step: Vec3, near: Vec3) -> (Vec3, Vec3) {
    let lack = near.length();
    if lack == 0.0 {
        return (step, near);
    }
    let up = near / lack;
    let after = lack - step.dot(up);
    let too_near = (after - (REACH - GAP)).max(0.0);
    (step + up * too_near, up * (after - too_near).max(0.0))
}

#[cfg(feature = "suite")]
impl crate::suite::Suite for Polish<Vec<f32>, Vec<f32>, Vec<u32>> {
    /// Of places within a metre, and moves as long.
    const TOLERANCE: f64 = 5e-6;

    fn operands(rng: &mut fastrand::Rng) -> Vec<Self> {
        let mut operand = |(n, share, first): (usize, f32, bool)| {
            let Graph { offsets, neighbours } = Graph::new(n, &crate::suite::triangles(rng, n));
            let [facing, pulls, mut moves, mut near, positions] =
                [0; 5].map(|_| crate::suite::numbers(rng, 3 * n, 1.0));
            if first {
                moves.fill(f32::NAN);
            }
            // Every third vertex is far from the body.
            near.as_chunks_mut::<3>().0.iter_mut().step_by(3).for_each(|near| *near = [0.0; 3]);
            Self { offsets, neighbours, share: vec![share], first, facing, pulls, moves, near, positions }
        };
        [(1, 1.0, true), (2, 1.0, false), (67, 0.3, false), (67, 0.0, false), (257, 1.0, true), (257, 1.0, false)]
            .map(&mut operand)
            .into()
    }

    fn truth(&self) -> Vec<Option<Vec<f64>>> {
        let [facing, pulls, moves, mut near, positions] =
            [&self.facing, &self.pulls, &self.moves, &self.near, &self.positions].map(|it| crate::suite::points(it));
        for (near, facing) in near.iter_mut().zip(facing).filter(|_| self.first) {
            let (up, deep) = (near.normalize_or_zero(), near.length() / f64::from(REACH) - 1.0);
            *near = (up + facing * deep.max(0.0)).normalize_or_zero() * near.length();
        }
        let graph = Graph { offsets: &self.offsets[..], neighbours: &self.neighbours };
        let free = |i: usize| {
            let pull = super::diffuse::wide(graph, &pulls, i);
            let on = if self.first { glam::DVec3::ZERO } else { f64::from(MOMENTUM) * moves[i] };
            f64::from(self.share[0]) * (f64::from(RATE) * pull + on)
        };
        let most = f64::from(REACH) - f64::from(GAP);
        let step = |i: usize| match near[i].try_normalize() {
            Some(up) => free(i) + up * (near[i].length() - free(i).dot(up) - most).max(0.0),
            None => free(i),
        };
        let steps: Vec<glam::DVec3> = (0..positions.len()).map(step).collect();
        let lacks = near.iter().zip(&steps).map(|(near, step)| {
            let up = near.normalize_or_zero();
            up * (near.length() - step.dot(up)).max(0.0)
        });
        let moved = positions.iter().zip(&steps).flat_map(|(at, by)| (at + by).to_array());
        let [moves, near] = [steps.clone(), lacks.collect()];
        let flat = |points: Vec<glam::DVec3>| Some(points.iter().flat_map(|it| it.to_array()).collect());
        vec![flat(moves), flat(near), Some(moved.collect())]
    }
}
