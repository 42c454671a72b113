//! The model: every weight of the network, on any storage `B` (f32) and `I` (u32). network.md §8.
//! The files of this folder are the only place that knows tensor names and shapes.

mod body;
mod read;
mod write;

use crate::pose::Rig;
use crate::topology::Graph;
pub use body::{Body, Fans, areas};
pub use write::Storage;

/// A model on the host, as a file holds it.
pub type HostModel = Model<Vec<f32>, Vec<u32>>;

/// Sizes that every operation of the network needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sizes {
    /// `n`: vertices of the template cloth mesh.
    pub vertices: usize,
    /// `J`: joints.
    pub joints: usize,
    /// `m`: pose embedding, skeleton basis matrices.
    pub embedding: usize,
    /// `k`: mesh basis matrices.
    pub basis: usize,
    /// `F = C·d`: features of a graph layer.
    pub features: usize,
    /// `C`: attention heads.
    pub heads: usize,
}

/// `y = W x + b`. The weight is kept transposed, `[inputs, outputs]`, so that lanes run over outputs.
#[derive(Clone, Debug, PartialEq)]
pub struct Linear<B> {
    /// `Wᵀ` [inputs, outputs].
    pub weight: B,
    /// `b` [outputs].
    pub bias: B,
    /// Length of x.
    pub inputs: usize,
    /// Length of y.
    pub outputs: usize,
}

/// Sparse skin weights in rows of equal width: vertex `i` follows joint `joints[i, s]` by `weights[i, s]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Skin<B, I> {
    /// Joint per slot [n, width]; unused slots name joint 0 with weight 0.
    pub joints: I,
    /// Weight per slot [n, width].
    pub weights: B,
    /// Slots per vertex.
    pub width: usize,
}

/// The body vertex under each cloth vertex, gathered: rest position and skin weights by cloth vertex. network.md §3.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference<B, I> {
    /// `T_B[I_C]` [n, 3].
    pub rest: B,
    /// `W_B[I_C]`, which is also `W_C^I`.
    pub skin: Skin<B, I>,
    /// Mean of V [3].
    pub mean: [f32; 3],
    /// Standard deviation of V [3].
    pub std: [f32; 3],
    /// Mean rest edge length, metres.
    pub edge_scale: f32,
}

/// One graph transformer layer. network.md §3.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer<B> {
    /// Query, key, value and skip stacked: `[inputs, 4F]`, columns q | k | v | r.
    pub project: Linear<B>,
    /// `W_eᵀ` [6, F], without bias.
    pub edge: B,
    /// `w_g` [3F], order ĥ ; r ; ĥ - r.
    pub gate: B,
    /// LayerNorm weight [F].
    pub norm_weight: B,
    /// LayerNorm bias [F].
    pub norm_bias: B,
}

/// Seams kept for drawing: several drawn vertices may share one cloth vertex.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Surface {
    /// Drawn vertex -> cloth vertex [d].
    pub vertex: Vec<u32>,
    /// Texture coordinates [d, 2].
    pub uv: Vec<f32>,
    /// Drawn-vertex indices [t, 3].
    pub triangles: Vec<u32>,
}

/// The whole model.
#[derive(Clone, Debug, PartialEq)]
pub struct Model<B, I> {
    /// Sizes.
    pub sizes: Sizes,
    /// Joints and body frame.
    pub rig: Rig,
    /// Cloth triangles [t, 3].
    pub triangles: Vec<u32>,
    /// Neighbours by the cloth's edges.
    pub graph: Graph<I>,
    /// `T_C` [n, 3].
    pub rest: B,
    /// `W_C`.
    pub skin: Skin<B, I>,
    /// What the mesh stream sees of the body.
    pub reference: Reference<B, I>,
    /// Φ.
    pub embedding: Vec<Linear<B>>,
    /// `B`, vertex-major [n, 3, m].
    pub skeleton: B,
    /// Graph layers.
    pub layers: Vec<Layer<B>>,
    /// Vertex-level MLP.
    pub vertex: Vec<Linear<B>>,
    /// `M`, vertex-major [n, 3, k].
    pub mesh: B,
    /// Whether M has anything to add. Where all of it is zero, the mesh stream is not computed.
    pub mesh_stream: bool,
    /// What is drawn, when it differs from the cloth mesh.
    pub surface: Option<Surface>,
    /// What the cloth is kept out of.
    pub body: Option<Body<B, I>>,
    /// What the model was trained on: a JSON object, free in form.
    pub training: Option<String>,
}

impl<B> Linear<B> {
    fn map<'a, C>(&'a self, values: &mut impl FnMut(&'a B) -> C) -> Linear<C> {
        Linear { weight: values(&self.weight), bias: values(&self.bias), inputs: self.inputs, outputs: self.outputs }
    }
}

impl<B, I> Skin<B, I> {
    fn map<'a, C, J>(
        &'a self,
        values: &mut impl FnMut(&'a B) -> C,
        indices: &mut impl FnMut(&'a I) -> J,
    ) -> Skin<C, J> {
        Skin { joints: indices(&self.joints), weights: values(&self.weights), width: self.width }
    }
}

impl<B> Layer<B> {
    fn map<'a, C>(&'a self, values: &mut impl FnMut(&'a B) -> C) -> Layer<C> {
        Layer {
            project: self.project.map(values),
            edge: values(&self.edge),
            gate: values(&self.gate),
            norm_weight: values(&self.norm_weight),
            norm_bias: values(&self.norm_bias),
        }
    }
}

impl<B, I> Model<B, I> {
    /// The same model on other storage: `values` and `indices` move one array each, in a fixed order.
    pub fn map<'a, C, J>(
        &'a self,
        mut values: impl FnMut(&'a B) -> C,
        mut indices: impl FnMut(&'a I) -> J,
    ) -> Model<C, J> {
        let (values, indices) = (&mut values, &mut indices);
        Model {
            sizes: self.sizes,
            rig: self.rig.clone(),
            triangles: self.triangles.clone(),
            graph: self.graph.map(indices),
            rest: values(&self.rest),
            skin: self.skin.map(values, indices),
            reference: Reference {
                rest: values(&self.reference.rest),
                skin: self.reference.skin.map(values, indices),
                mean: self.reference.mean,
                std: self.reference.std,
                edge_scale: self.reference.edge_scale,
            },
            embedding: self.embedding.iter().map(|layer| layer.map(values)).collect(),
            skeleton: values(&self.skeleton),
            layers: self.layers.iter().map(|layer| layer.map(values)).collect(),
            vertex: self.vertex.iter().map(|layer| layer.map(values)).collect(),
            mesh: values(&self.mesh),
            mesh_stream: self.mesh_stream,
            surface: self.surface.clone(),
            body: self.body.as_ref().map(|body| body.map(values, indices)),
            training: self.training.clone(),
        }
    }

    /// The trainable arrays, in a fixed order: W_C, B, M, Φ, vertex MLP, graph layers. network.md §6.
    pub fn parameters(&self) -> Vec<&B> {
        let mut list = vec![&self.skin.weights, &self.skeleton, &self.mesh];
        for layer in self.embedding.iter().chain(&self.vertex).chain(self.layers.iter().map(|layer| &layer.project)) {
            list.extend([&layer.weight, &layer.bias]);
        }
        for layer in &self.layers {
            list.extend([&layer.edge, &layer.gate, &layer.norm_weight, &layer.norm_bias]);
        }
        list
    }

    /// [`Self::parameters`], to be changed.
    pub fn parameters_mut(&mut self) -> Vec<&mut B> {
        let mut list = vec![&mut self.skin.weights, &mut self.skeleton, &mut self.mesh];
        for layer in self.embedding.iter_mut().chain(&mut self.vertex) {
            list.extend([&mut layer.weight, &mut layer.bias]);
        }
        let mut rest = Vec::new();
        for layer in &mut self.layers {
            list.extend([&mut layer.project.weight, &mut layer.project.bias]);
            rest.extend([&mut layer.edge, &mut layer.gate, &mut layer.norm_weight, &mut layer.norm_bias]);
        }
        list.extend(rest);
        list
    }
}
