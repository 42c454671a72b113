//! Longer than 300 lines: one list of all operations of the network and of the repair.
//! What each reads and writes, by name. This list is their one description. The CPU runs an operation, the GPU records
//! it, the tape of the training keeps it and runs it backwards, and its arithmetic is counted from it. An operation is
//! the unit of fusion. Its kernel is in `cpu/network` or `cpu/repair`, its twin in `shaders/`, both under its name.
//!
//! Operands are read (`R`), written (`W`) or constant indices (`I`): slices on the CPU, numbers of buffers on the GPU
//! and the tape, lengths where arithmetic is counted. f32 and u32, row-major; `n` vertices, `F` features, `C` heads,
//! `b` vertices of the body.

#[macro_use]
mod list;

use crate::pose::Rig;
use std::sync::Arc;

/// What follows a linear layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Activation {
    /// Nothing.
    None,
    /// max(0, y).
    Relu,
}

/// The space in which skinned positions are wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Space {
    /// As the network works: heading and position of the hip removed.
    Body,
    /// World: `N⁻¹` applied last.
    World,
}

/// A number for each axis.
pub type Axes = [f32; 3];

operations! { $
    /// World joint transforms `G_j` -> `N·A_j` and `N⁻¹`, and the pose vector γ. network.md §1.
    BodyFrame<R, W> {
        /// The joints' constants.
        rig: Arc<Rig>,
        /// `G_j` [J, 3, 4].
        joints: R,
        /// `N·A_j`, then `N⁻¹` [J + 1, 3, 4].
        transforms: W,
        /// γ [12J].
        vector: W,
    }

    /// `y = act(W x + b)`, row by row. network.md §2, §3.
    Linear<R, W> {
        /// [rows, inputs].
        x: R,
        /// `Wᵀ` [inputs, outputs].
        weight: R,
        /// [outputs].
        bias: R,
        /// What follows.
        activation: Activation,
        /// [rows, outputs].
        y: W,
    }

    /// `Δ[i] = Σ_j w_j B_j[i]`, `T = rest + s·Δ`. network.md §2, §3, §4.
    Blend<R, W> {
        /// w [count], one row for all vertices, or [n, count].
        weights: R,
        /// B, vertex-major [n, 3, count].
        basis: R,
        /// [n, 3].
        rest: R,
        /// s: what the residual counts in this prediction [1].
        share: R,
        /// Δ [n, 3].
        residual: W,
        /// T [n, 3].
        template: W,
    }

    /// Linear blend skinning `x_i = Σ_j W[i,j] A_j T_i`, then `N⁻¹` where the world is wanted. network.md §4.
    Skin<R, W, I> {
        /// T [n, 3].
        rest: R,
        /// Joint per slot [n, width].
        joints: I,
        /// W per slot [n, width].
        weights: R,
        /// A, then `N⁻¹` [J + 1, 3, 4].
        transforms: R,
        /// Where x is wanted.
        space: Space,
        /// x [n, 3].
        positions: W,
    }

    /// h⁰ and the edge potentials, whose differences are the edge features `e_ij`. network.md §3.
    Features<R, W> {
        /// V, or X [n, 3].
        v: R,
        /// `T_C` [n, 3].
        rest: R,
        /// Mean of V.
        mean: Axes,
        /// Its standard deviation.
        deviation: Axes,
        /// Mean rest edge length, metres.
        edge_scale: f32,
        /// h⁰ [n, 3].
        nodes: W,
        /// [V ; T_C] / edge_scale [n, 6].
        potentials: W,
    }

    /// What the mesh stream sees around each vertex of the coarse cloth, turned as its skinning turns it: h⁰ of a model
    /// with surroundings. network.md §3.
    Surround<R, W, I> {
        /// [X ; T_C] / edge_scale [n, 6].
        potentials: R,
        /// X, standardised [n, 3].
        places: R,
        /// Joint per slot [n, width].
        joints: I,
        /// W per slot [n, width].
        weights: R,
        /// A, then `N⁻¹` [J + 1, 3, 4].
        transforms: R,
        /// Vertices around each [n, 16].
        around: I,
        /// h⁰ [n, 54].
        nodes: W,
    }

    /// Attention over the neighbours, gate and LayerNorm. network.md §3.
    Attend<R, W, I> {
        /// Where the neighbours of each vertex start [n + 1].
        offsets: I,
        /// Neighbours [edges].
        neighbours: I,
        /// C.
        heads: usize,
        /// q | k | v | r [n, 4F]; read, and a device may leave the edge term in it.
        projected: W,
        /// [n, 6].
        potentials: R,
        /// `W_eᵀ` [6, F].
        edge: R,
        /// `w_g` [3F], order ĥ ; r ; ĥ - r.
        gate: R,
        /// LayerNorm's weight [F].
        norm_weight: R,
        /// LayerNorm's bias [F].
        norm_bias: R,
        /// ĥ [n, F]; a device may leave it unwritten.
        attended: W,
        /// h [n, F].
        output: W,
    }

    /// How far each vertex is pulled by its edges towards the lengths they were cut to. network.md §5.
    Pull<R, W, I> {
        /// Where the neighbours of each vertex start [n + 1].
        offsets: I,
        /// Neighbours [edges].
        neighbours: I,
        /// Squared length that each edge was cut to, square metres [edges].
        squares: R,
        /// x [n, 3].
        positions: R,
        /// What each vertex lacks to where the body is no longer met, 0 where it is not [n, 3].
        near: R,
        /// [n, 3].
        pulls: W,
    }

    /// One round in which every pull is shared with the neighbours. network.md §5.
    Diffuse<R, W, I> {
        /// Where the neighbours of each vertex start [n + 1].
        offsets: I,
        /// Neighbours [edges].
        neighbours: I,
        /// [n, 3].
        pulls: R,
        /// [n, 3].
        diffused: W,
    }

    /// One step in which the cloth follows its edges' pulls, each vertex with its neighbours, and stays out of the
    /// body. network.md §5.
    Polish<R, W, I> {
        /// Where the neighbours of each vertex start [n + 1].
        offsets: I,
        /// Neighbours [edges].
        neighbours: I,
        /// What the step counts in this prediction, 0 to 1 [1].
        share: R,
        /// Whether it is the first step, which has no momentum and leans `near` to the normals.
        first: bool,
        /// Unit normals of the cloth before that step [n, 3].
        facing: R,
        /// [n, 3].
        pulls: R,
        /// How far the last step went, and then this one [n, 3].
        moves: W,
        /// What each vertex lacks to `REACH` above the body before the step, and then after it [n, 3].
        near: W,
        /// x [n, 3]; read and moved.
        positions: W,
    }

    /// Area-weighted unit vertex normals; +Y where a vertex has no area around it.
    Normals<R, W, I> {
        /// [n, 3].
        positions: R,
        /// [t, 3].
        triangles: I,
        /// [n, 3].
        normals: W,
    }

    /// Each vertex of a drawn mesh goes where its triangle of the cloth takes it. network.md §5.
    Ride<R, W, I> {
        /// Cloth vertices under each [w, 3].
        corners: I,
        /// Barycentric coordinates, then the offset along the normal, metres [w, 4].
        coordinates: R,
        /// Cloth [n, 3].
        positions: R,
        /// Its unit normals [n, 3].
        normals: R,
        /// [w, 3].
        riders: W,
    }

    /// Each drawn vertex takes position and normal of its cloth vertex.
    Surface<R, W, I> {
        /// Drawn vertex -> cloth vertex [d].
        vertex: I,
        /// [n, 3].
        positions: R,
        /// [n, 3].
        normals: R,
        /// [d, 3].
        drawn_positions: W,
        /// [d, 3].
        drawn_normals: W,
    }

    /// How far each cloth vertex must move to lie so far above the body; zero where there is room.
    Collide<R, W, I> {
        /// How far, metres.
        reach: f32,
        /// Posed body [b, 3].
        posed: R,
        /// Its unit normals [b, 3].
        normals: R,
        /// Where the triangles around each body vertex start [b + 1].
        offsets: I,
        /// The other two corners of each of them [3t, 2].
        corners: I,
        /// Body vertices from which each cloth vertex searches [n, s].
        seeds: I,
        /// Cloth [n, 3].
        positions: R,
        /// [n, 3].
        push: W,
    }

    /// One round in which displaced vertices take their neighbours along, and still reach what they need themselves.
    Spread<R, W, I> {
        /// Where the neighbours of each vertex start [n + 1].
        offsets: I,
        /// Neighbours [edges].
        neighbours: I,
        /// What each vertex needs at least [n, 3].
        push: R,
        /// Displacement before the round [n, 3].
        before: R,
        /// After it [n, 3].
        after: W,
    }

    /// One round in which displaced cloth takes back the lengths it was cut to, and what must move still reaches what
    /// it needs.
    Slide<R, W, I> {
        /// Where the neighbours of each vertex start [n + 1].
        offsets: I,
        /// Neighbours [edges].
        neighbours: I,
        /// Squared length of the edge to each of them [edges].
        squares: R,
        /// Share of the mesh stream [1].
        share: R,
        /// Cloth before it is displaced [n, 3].
        positions: R,
        /// What each vertex needs at least [n, 3].
        push: R,
        /// Displacement before the round [n, 3].
        before: R,
        /// After it [n, 3].
        after: W,
    }

    /// Displaces the cloth, and brings to its gap what that carried into another part of the body.
    Settle<R, W, I> {
        /// Posed body [b, 3].
        posed: R,
        /// Its unit normals [b, 3].
        normals: R,
        /// Where the triangles around each body vertex start [b + 1].
        offsets: I,
        /// The other two corners of each of them [3t, 2].
        corners: I,
        /// Body vertices from which each cloth vertex searches [n, s].
        seeds: I,
        /// [n, 3].
        displacement: R,
        /// Cloth [n, 3]; read and moved.
        positions: W,
    }
}

/// A walk over the body: four seeds, about two steps of six neighbours, 8 for each of these.
const WALK: usize = 8 * (4 + 12);

impl Operation<usize, usize, usize> {
    /// Floating-point operations of an operation whose operands are lengths. A multiplication and an addition count one
    /// each, and so does every exponential, division and root.
    pub fn flops(&self) -> usize {
        match self {
            Self::BodyFrame(it) => it.rig.joints.len() * 110,
            Self::Linear(it) => it.y * (2 * (it.weight / it.bias) + 1),
            Self::Blend(it) => 2 * it.basis + 2 * it.rest,
            // Matrices blended, then applied; once more for N⁻¹.
            Self::Skin(it) => 24 * it.weights + if it.space == Space::World { 12 } else { 6 } * it.rest,
            Self::Features(it) => 2 * it.nodes + it.potentials,
            // Matrices blended; per vertex around two differences, one of them turned, and their difference scaled.
            Self::Surround(it) => 18 * it.weights + 27 * it.around,
            Self::Attend(it) => {
                let (vertices, edges, features) = (it.offsets - 1, it.neighbours, it.norm_bias);
                // The edge term U and its two additions; per edge the logits, their softmax and the weighted sum; U
                // taken off again.
                let attention = vertices * features * (2 * 6 + 2 + 1) + edges * (4 * features + 4 * it.heads);
                // The gate: difference, three dot products, blend; LayerNorm: mean, variance, scale and shift.
                attention + it.output * (1 + 6 + 2 + 7)
            }
            // An edge: difference, square, pull, sum.
            Self::Pull(it) => 18 * it.neighbours + it.positions + 12 * (it.positions / 3),
            // A sum over the neighbours, two shares.
            Self::Diffuse(it) => 3 * it.neighbours + 3 * it.pulls,
            // The same; a vertex: momentum, the move, and how near it is to the body.
            Self::Polish(it) => 3 * it.neighbours + 6 * it.positions + 20 * (it.positions / 3),
            Self::Normals(it) => 18 * it.triangles + 3 * it.positions,
            // Two sums of three vectors, the length of one, and the offset.
            Self::Ride(it) => 15 * it.riders,
            Self::Surface(_) => 0,
            // A walk, and six triangles around its end.
            Self::Collide(it) => it.positions / 3 * (WALK + 6 * 60),
            Self::Spread(it) => 3 * it.neighbours + 20 * (it.push / 3),
            Self::Slide(it) => 21 * it.neighbours + 24 * (it.push / 3),
            // One vertex in twenty or so is looked at again, from its neighbours' neighbours, too.
            Self::Settle(it) => it.positions / 3 * ((WALK + 8 * 36 + 6 * 60) / 20),
        }
    }
}
