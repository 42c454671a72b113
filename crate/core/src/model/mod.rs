//! The model: every weight of the network, on any storage `B` (f32) and `I` (u32). network.md §8.
//! The files of this folder are the only place that knows tensor names and shapes.

mod body;
mod cut;
pub mod pack;
mod read;
mod ride;
mod skinning;
pub mod surroundings;
mod write;

use crate::pose::Rig;
use crate::topology::Graph;
pub use body::{Body, Fans};
pub use cut::{Cut, MOST_STEPS, STEPS};
pub use ride::Ride;
use std::sync::Arc;
pub use write::{Storage, file_bytes};

/// Name of the skin weights `W_C`, in the file and among [`Model::parameters`].
pub const CLOTH_WEIGHTS: &str = "cloth.weights";
/// Name of the skeleton stream's basis `B`.
pub const SKELETON_BASIS: &str = "skeleton.basis";
/// Name of the mesh stream's basis `M`.
pub const MESH_BASIS: &str = "mesh.basis";

/// Whether a name among [`Model::parameters`] is that of a matrix of Φ.
pub fn is_embedding_weight(name: &str) -> bool {
    name.starts_with("embedding.") && name.ends_with(".weight")
}

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
pub struct Skinning<B, I> {
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
    pub skinning: Skinning<B, I>,
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
pub struct Surface<I = Vec<u32>> {
    /// Drawn vertex -> vertex of what rides on the cloth where the model has a [`Ride`], cloth vertex otherwise [d].
    pub vertex: I,
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
    pub rig: Arc<Rig>,
    /// Cloth triangles [t, 3].
    pub triangles: I,
    /// Neighbours by the cloth's edges.
    pub graph: Graph<I>,
    /// `T_C` [n, 3].
    pub rest: B,
    /// `W_C`.
    pub skinning: Skinning<B, I>,
    /// What the mesh stream sees of the body.
    pub reference: Reference<B, I>,
    /// Vertices around each, which it sees of the coarse cloth instead [n, 16].
    pub surroundings: Option<I>,
    /// Φ.
    pub embedding: Vec<Linear<B>>,
    /// `B`, vertex-major [n, 3, m].
    pub skeleton_basis: B,
    /// Graph layers.
    pub layers: Vec<Layer<B>>,
    /// Vertex-level MLP.
    pub vertex_mlp: Vec<Linear<B>>,
    /// `M`, vertex-major [n, 3, k].
    pub mesh_basis: B,
    /// Whether M has anything to add. Where all of it is zero, the mesh stream is not computed.
    pub mesh_stream: bool,
    /// What is drawn, when it differs from the cloth mesh.
    pub surface: Option<Surface<I>>,
    /// How another mesh than the cloth's rides on it to be drawn.
    pub ride: Option<Ride<B, I>>,
    /// How the cloth was cut.
    pub cut: Option<Cut<B>>,
    /// What the cloth is kept out of.
    pub body: Option<Body<B, I>>,
    /// What the model was trained on: a JSON object, free in form.
    pub training: Option<String>,
}

impl<B> Linear<B> {
    fn parameters(&self, name: &str) -> [(String, &B); 2] {
        [(format!("{name}.weight"), &self.weight), (format!("{name}.bias"), &self.bias)]
    }

    fn map<'a, C>(&'a self, values: &mut impl FnMut(&'a B) -> C) -> Linear<C> {
        Linear { weight: values(&self.weight), bias: values(&self.bias), inputs: self.inputs, outputs: self.outputs }
    }
}

impl<B, I> Skinning<B, I> {
    fn map<'a, C, J>(
        &'a self,
        values: &mut impl FnMut(&'a B) -> C,
        indices: &mut impl FnMut(&'a I) -> J,
    ) -> Skinning<C, J> {
        Skinning { joints: indices(&self.joints), weights: values(&self.weights), width: self.width }
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
    /// Has the cloth polished by another number of steps, where the model knows how it was cut.
    pub fn polish(mut self, steps: Option<usize>) -> Self {
        if let (Some(cut), Some(steps)) = (&mut self.cut, steps) {
            cut.steps = steps;
        }
        self
    }

    /// The same model on other storage: `values` and `indices` move one array each, in a fixed order.
    pub fn map<'a, C, J>(
        &'a self,
        mut values: impl FnMut(&'a B) -> C,
        mut indices: impl FnMut(&'a I) -> J,
    ) -> Model<C, J> {
        let (values, indices) = (&mut values, &mut indices);
        Model {
            sizes: self.sizes,
            rig: Arc::clone(&self.rig),
            triangles: indices(&self.triangles),
            graph: self.graph.map(indices),
            rest: values(&self.rest),
            skinning: self.skinning.map(values, indices),
            reference: Reference {
                rest: values(&self.reference.rest),
                skinning: self.reference.skinning.map(values, indices),
                mean: self.reference.mean,
                std: self.reference.std,
                edge_scale: self.reference.edge_scale,
            },
            surroundings: self.surroundings.as_ref().map(&mut *indices),
            embedding: self.embedding.iter().map(|layer| layer.map(values)).collect(),
            skeleton_basis: values(&self.skeleton_basis),
            layers: self.layers.iter().map(|layer| layer.map(values)).collect(),
            vertex_mlp: self.vertex_mlp.iter().map(|layer| layer.map(values)).collect(),
            mesh_basis: values(&self.mesh_basis),
            mesh_stream: self.mesh_stream,
            surface: self.surface.as_ref().map(|surface| Surface {
                vertex: indices(&surface.vertex),
                uv: surface.uv.clone(),
                triangles: surface.triangles.clone(),
            }),
            ride: self.ride.as_ref().map(|ride| ride.map(values, indices)),
            cut: self.cut.as_ref().map(|cut| cut.map(values)),
            body: self.body.as_ref().map(|body| body.map(values, indices)),
            training: self.training.clone(),
        }
    }

    /// The trainable arrays by name, in a fixed order: W_C, B, M, Φ, vertex MLP, graph layers. network.md §6. Names are
    /// those of the file, where the four products stacked in `graph.L.project` stand apart.
    pub fn parameters(&self) -> Vec<(String, &B)> {
        let mut list = vec![
            (CLOTH_WEIGHTS.to_owned(), &self.skinning.weights),
            (SKELETON_BASIS.to_owned(), &self.skeleton_basis),
            (MESH_BASIS.to_owned(), &self.mesh_basis),
        ];
        for (name, layers) in [("embedding", &self.embedding), ("vertex", &self.vertex_mlp)] {
            list.extend(layers.iter().enumerate().flat_map(|(i, layer)| layer.parameters(&format!("{name}.{i}"))));
        }
        for (l, layer) in self.layers.iter().enumerate() {
            list.extend(layer.project.parameters(&format!("graph.{l}.project")));
        }
        for (l, Layer { edge, gate, norm_weight, norm_bias, .. }) in self.layers.iter().enumerate() {
            let parts =
                [("edge.weight", edge), ("gate.weight", gate), ("norm.weight", norm_weight), ("norm.bias", norm_bias)];
            list.extend(parts.map(|(part, values)| (format!("graph.{l}.{part}"), values)));
        }
        list
    }

    /// [`Self::parameters`], to be changed.
    pub fn parameters_mut(&mut self) -> Vec<(String, &mut B)> {
        let names: Vec<String> = self.parameters().into_iter().map(|(name, _)| name).collect();
        let mut list = vec![&mut self.skinning.weights, &mut self.skeleton_basis, &mut self.mesh_basis];
        for layer in self.embedding.iter_mut().chain(&mut self.vertex_mlp) {
            list.extend([&mut layer.weight, &mut layer.bias]);
        }
        let mut rest = Vec::new();
        for layer in &mut self.layers {
            list.extend([&mut layer.project.weight, &mut layer.project.bias]);
            rest.extend([&mut layer.edge, &mut layer.gate, &mut layer.norm_weight, &mut layer.norm_bias]);
        }
        list.extend(rest);
        names.into_iter().zip(list).collect()
    }
}
