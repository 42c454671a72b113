//! Which pairs of cloth elements can come near each other during a move: every vertex stays within `slack` of
//! `x + s·motion`, `s` common to all, so pairs further apart than their approach and twice the slack need no look.

use ctsn_rig::mesh::{Components, Edges, around, ordered};
use glam::DVec3;
use parry3d_f64::bounding_volume::{Aabb, BoundingVolume};
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};

use super::proximity::Pair;
use crate::wrap::bounds;

/// How far a vertex may leave the straight way before the pairs are found anew, metres. 1 mm took 1.3 times the
/// searches of a relaxation, 4 mm twice the pairs.
const SLACK: f64 = 0.002;

/// The cloth's elements, each vertex and edge owned by one triangle (Curtis et al. 2008, representative triangles): a
/// search for close triangles then finds each close pair of elements once.
#[derive(Clone, Debug)]
pub(crate) struct Elements {
    pub triangles: Vec<[u32; 3]>,
    /// Vertices owned by a triangle [t].
    vertices: Vec<Vec<u32>>,
    /// Edges owned by a triangle [t].
    edges: Vec<Vec<[u32; 2]>>,
}

impl Elements {
    /// Deals vertices and edges to triangles, first come.
    pub fn new(triangles: &[[u32; 3]], vertices: usize) -> Self {
        let all = Edges::new(triangles);
        let mut taken = vec![false; vertices];
        let (mut vertices, mut edges) = (vec![Vec::new(); triangles.len()], vec![Vec::new(); triangles.len()]);
        for (index, triangle) in triangles.iter().enumerate() {
            vertices[index].extend(triangle.iter().filter(|v| !std::mem::replace(&mut taken[**v as usize], true)));
            let own = around(*triangle).into_iter().filter(|edge| all.at(*edge)[0].triangle == index);
            edges[index].extend(own.map(ordered));
        }
        Self { triangles: triangles.to_vec(), vertices, edges }
    }

    /// Calls `visit` with every pair of elements of two triangles that has no vertex in common.
    fn pairs(&self, first: u32, second: u32, mut visit: impl FnMut(Pair)) {
        for (a, b) in [(first as usize, second as usize), (second as usize, first as usize)] {
            let [p, q, r] = self.triangles[b];
            for &v in self.vertices[a].iter().filter(|v| !self.triangles[b].contains(v)) {
                visit(Pair::VertexTriangle([v, p, q, r]));
            }
        }
        for &[a, b] in &self.edges[first as usize] {
            for &[c, d] in &self.edges[second as usize] {
                if a != c && a != d && b != c && b != d {
                    visit(Pair::EdgeEdge([a, b, c, d]));
                }
            }
        }
    }
}

/// Pairs that can come near each other, and the moves for which that holds.
pub(super) struct Neighbourhood {
    tree: Bvh,
    start: Vec<DVec3>,
    motion: Vec<DVec3>,
    /// Pairs that can come nearer than the offset.
    pub pairs: Vec<Pair>,
}

impl Neighbourhood {
    /// Of nothing: to be searched before use.
    pub fn new(elements: &Elements) -> Self {
        let boxes = vec![bounds([DVec3::ZERO; 3]); elements.triangles.len()];
        let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
        Self { tree, start: Vec::new(), motion: Vec::new(), pairs: Vec::new() }
    }

    /// Finds the pairs that can come nearer than `offset` metres while the vertices go from `x` along `motion`.
    pub fn search(&mut self, elements: &Elements, x: &[DVec3], motion: &[DVec3], offset: f64) {
        let margin = DVec3::splat(SLACK + 0.5 * offset).to_array();
        let swept = |triangle: &[u32; 3]| {
            let from = bounds(triangle.map(|i| x[i as usize]));
            let swept = from.merged(&bounds(triangle.map(|i| x[i as usize] + motion[i as usize])));
            Aabb::new(swept.mins - Vector::from_array(margin), swept.maxs + Vector::from_array(margin))
        };
        if self.start.is_empty() {
            let boxes: Vec<Aabb> = elements.triangles.iter().map(swept).collect();
            self.tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
        } else {
            for (index, triangle) in elements.triangles.iter().enumerate() {
                self.tree.update_partially_if_present(swept(triangle), index as u32, 0.0);
            }
            self.tree.refit_without_opt();
        }
        (self.start, self.motion) = (x.to_vec(), motion.to_vec());
        let pairs = &mut self.pairs;
        pairs.clear();
        let mut consider = |pair: Pair| {
            let reach = offset + 2.0 * SLACK + pair.approach(motion);
            if pair.gap(x) < reach && pair.distance(x) < reach {
                pairs.push(pair);
            }
        };
        let mut both = |a: u32, b: u32| elements.pairs(a, b, &mut consider);
        self.tree.traverse_bvtt_single_tree::<false>(&mut BvhWorkspace::default(), &mut both);
    }

    /// Whether the pairs hold for vertices at `x`, reached after `share` of the motion searched with.
    pub fn covers(&self, x: &[DVec3], share: f64) -> bool {
        let near = |(x, (start, motion)): (&DVec3, (&DVec3, &DVec3))| {
            x.distance_squared(*start + *motion * share) <= SLACK * SLACK
        };
        x.len() == self.start.len() && x.iter().zip(self.start.iter().zip(&self.motion)).all(near)
    }

    /// Takes note that `share` of the motion searched with was made, and no more will be.
    pub fn follow(&mut self, share: f64) {
        self.start.iter_mut().zip(&mut self.motion).for_each(|(start, motion)| {
            *start += *motion * share;
            *motion = DVec3::ZERO;
        });
    }

    /// Joins the vertices of every pair that `motion` [n] would bring nearer than `nearest` metres: they move by the
    /// mean of all they are joined with (impact zones, Provot 1997). Whether there were any.
    pub fn join(&self, x: &[DVec3], motion: &mut [DVec3], nearest: f64) -> bool {
        let end: Vec<DVec3> = x.iter().zip(motion.iter()).map(|(x, d)| *x + *d).collect();
        let mut zones = Components::new(x.len());
        let mut any = false;
        for pair in &self.pairs {
            let close = pair.distance(&end) < nearest.min(0.9 * pair.distance(x));
            if close || pair.time_of_impact(x, motion, 1.0) < 1.0 {
                any = true;
                zones.join(pair.vertices());
            }
        }
        let mut sums = vec![(DVec3::ZERO, 0.0); x.len()];
        for (i, motion) in motion.iter().enumerate() {
            let sum = &mut sums[zones.of(i)];
            *sum = (sum.0 + *motion, sum.1 + 1.0);
        }
        for (i, motion) in motion.iter_mut().enumerate() {
            let (sum, count) = sums[zones.of(i)];
            *motion = sum / count;
        }
        any
    }

    /// The share of `motion` from `x` that no pair objects to.
    pub fn clear_way(&self, x: &[DVec3], motion: &[DVec3]) -> f64 {
        self.pairs.iter().fold(1.0, |limit, pair| pair.time_of_impact(x, motion, limit))
    }
}
