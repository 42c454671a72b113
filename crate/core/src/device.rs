//! What a device must be able to do: the operations of the network, and storage for their operands.
//! An operation is the unit of fusion: each has a file of its name on every device, and a gradient of its name for training.

use crate::model::{Body, Layer, Linear, Reference, Sizes, Skin};
use crate::network::Drawn;
use crate::pose::Rig;
use crate::topology::Graph;

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

/// A place where the network runs. All buffers hold f32, row-major; `n` vertices, `F` features, `C` heads.
pub trait Device {
    /// f32 storage.
    type Buffer;
    /// u32 storage, never changed.
    type Indices;

    /// New storage holding `values`.
    fn buffer(&mut self, values: &[f32]) -> Self::Buffer;
    /// New constant storage holding `indices`.
    fn indices(&mut self, indices: &[u32]) -> Self::Indices;
    /// Replaces the content of `buffer` by `values` of the same length.
    fn write(&mut self, buffer: &mut Self::Buffer, values: &[f32]);

    /// World joint transforms `G_j` [J, 3, 4] -> transforms `N·A_j`, then `N⁻¹` [J + 1, 3, 4], and pose vector γ [12J].
    fn body_frame(
        &mut self,
        rig: &Rig,
        joints: &Self::Buffer,
        transforms: &mut Self::Buffer,
        vector: &mut Self::Buffer,
    );
    /// x [rows, inputs] -> y [rows, outputs], `y = act(W x + b)` row by row.
    fn linear(&mut self, x: &Self::Buffer, layer: &Linear<Self::Buffer>, activation: Activation, y: &mut Self::Buffer);
    /// weights [count] (one for all) or [n, count], basis [n, 3, count], confidence [1] -> residual [n, 3] = `Σ_j w_j B_j`,
    /// template [n, 3] = rest + confidence · residual.
    fn blend(
        &mut self,
        weights: &Self::Buffer,
        basis: &Self::Buffer,
        rest: &Self::Buffer,
        confidence: &Self::Buffer,
        residual: &mut Self::Buffer,
        template: &mut Self::Buffer,
    );
    /// Linear blend skinning: rest [n, 3], transforms [J + 1, 3, 4] -> positions [n, 3].
    fn skin(
        &mut self,
        rest: &Self::Buffer,
        skin: &Skin<Self::Buffer, Self::Indices>,
        transforms: &Self::Buffer,
        space: Space,
        positions: &mut Self::Buffer,
    );
    /// V [n, 3], T_C [n, 3] -> h⁰ [n, 3] and edge potentials [n, 6] = [V ; T_C] / edge_scale, whose differences are `e_ij`.
    fn features(
        &mut self,
        v: &Self::Buffer,
        rest: &Self::Buffer,
        reference: &Reference<Self::Buffer, Self::Indices>,
        nodes: &mut Self::Buffer,
        potentials: &mut Self::Buffer,
    );
    /// projected [n, 4F] = q | k | v | r, potentials [n, 6] -> ĥ [n, F]: attention over the neighbours; then
    /// h [n, F] = ReLU(LayerNorm((1-β) ĥ + β r)). A device may leave the edge term in projected, or ĥ unwritten.
    #[expect(clippy::too_many_arguments, reason = "an operation takes its operands plainly")]
    fn attend(
        &mut self,
        graph: &Graph<Self::Indices>,
        sizes: Sizes,
        projected: &mut Self::Buffer,
        potentials: &Self::Buffer,
        layer: &Layer<Self::Buffer>,
        attended: &mut Self::Buffer,
        output: &mut Self::Buffer,
    );
    /// positions [n, 3], triangles [t, 3] -> area-weighted unit normals [n, 3].
    fn normals(&mut self, positions: &Self::Buffer, triangles: &[u32], normals: &mut Self::Buffer);
    /// The body's posed positions and normals [b, 3] -> exposed [b, 3]: the positions, those inside another part of the body far away.
    fn bury(
        &mut self,
        body: &Body<Self::Buffer, Self::Indices>,
        posed: &Self::Buffer,
        normals: &Self::Buffer,
        exposed: &mut Self::Buffer,
    );
    /// The body's exposed positions and normals [b, 3], cloth positions [n, 3] -> push [n, 3], the displacement that brings each cloth
    /// vertex to the gap above the body; zero where there is room.
    fn collide(
        &mut self,
        body: &Body<Self::Buffer, Self::Indices>,
        exposed: &Self::Buffer,
        normals: &Self::Buffer,
        positions: &Self::Buffer,
        push: &mut Self::Buffer,
    );
    /// push [n, 3], displacement before [n, 3] -> after [n, 3]: follows the neighbours, and reaches at least the push.
    fn spread(
        &mut self,
        graph: &Graph<Self::Indices>,
        push: &Self::Buffer,
        before: &Self::Buffer,
        after: &mut Self::Buffer,
    );
    /// The body's exposed positions and normals [b, 3]; displacement [n, 3] is added to positions [n, 3], and what it carried into another
    /// part of the body is brought to the gap.
    fn settle(
        &mut self,
        body: &Body<Self::Buffer, Self::Indices>,
        exposed: &Self::Buffer,
        normals: &Self::Buffer,
        displacement: &Self::Buffer,
        positions: &mut Self::Buffer,
    );
    /// Drawn vertex -> cloth vertex [d], positions and normals [n, 3] -> those of the drawn vertices [d, 3].
    fn surface(
        &mut self,
        vertex: &[u32],
        positions: &Self::Buffer,
        normals: &Self::Buffer,
        drawn: &mut Drawn<Self::Buffer>,
    );
}
