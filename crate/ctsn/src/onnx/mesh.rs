//! The mesh stream: graph layers, MLP of each vertex, its basis. network.md §3.

use super::graph::{Graph, Value, integer};
use super::order::{Batch, Order};
use super::surround::surround;
use ctsn_core::model::{HostModel, Layer, Linear};

/// LayerNorm's eps.
const EPSILON: f32 = ctsn_core::cpu::network::gate::EPSILON;

/// Body vertices under the cloth V, or the coarse cloth X [3, n], and transforms of the vertices [3, 4, n] -> Δ_M
/// [3, n].
pub fn mesh(graph: &mut Graph, model: &HostModel, order: &Order, [reference, blended]: [&Value; 2]) -> Value {
    let (n, k) = (model.sizes.vertices, model.sizes.basis);
    let (mut h, potentials) = features(graph, model, order, reference);
    if let Some(around) = &model.surroundings {
        h = surround(graph, order, around, [&h, &potentials, blended]);
    }
    let batches = order.batches(&model.graph);
    for (l, layer) in model.layers.iter().enumerate() {
        graph.stage(&format!("layer.{l}"));
        h = graph_layer(graph, (&batches, model.sizes.heads), layer, [&h, &potentials]);
    }
    graph.stage("mesh");
    for layer in &model.vertex_mlp {
        let y = linear(graph, layer, &h);
        h = graph.node("Relu", &[&y]);
    }
    // [3, n, k]: along with w [n, k], rows as long as they can be.
    let basis = order.rows(&model.mesh_basis, 3 * k);
    let axis = |axis: usize| basis.chunks_exact(3 * k).flat_map(move |vertex| &vertex[axis * k..][..k]);
    let basis: Vec<f32> = (0..3).flat_map(axis).copied().collect();
    let basis = graph.floats(&[3, n, k], &basis);
    let blended = graph.node("Mul", &[&basis, &h]);
    graph.sum(&blended, 2)
}

/// V or X, standardised [n, 3], and the edge potentials [n, 6].
fn features(graph: &mut Graph, model: &HostModel, order: &Order, reference: &Value) -> (Value, Value) {
    let v = graph.transpose(reference, &[1, 0]);
    let [mean, std] = [model.reference.mean, model.reference.std].map(|axes| graph.floats(&[1, 3], &axes));
    let centred = graph.node("Sub", &[&v, &mean]);
    let nodes = graph.node("Div", &[&centred, &std]);
    let scale = model.reference.edge_scale;
    let rest: Vec<f32> = order.rows(&model.rest, 3).iter().map(|number| number / scale).collect();
    let rest = graph.floats(&[model.sizes.vertices, 3], &rest);
    let scale = graph.floats(&[], &[scale]);
    let v = graph.node("Div", &[&v, &scale]);
    let potentials = graph.concat(&[&v, &rest], 1);
    (nodes, potentials)
}

/// `y = W x + b` of rows x [rows, inputs].
pub fn linear(graph: &mut Graph, layer: &Linear<Vec<f32>>, x: &Value) -> Value {
    let weight = graph.floats(&[layer.inputs, layer.outputs], &layer.weight);
    let bias = graph.floats(&[layer.outputs], &layer.bias);
    graph.node("Gemm", &[x, &weight, &bias])
}

/// One layer: h [n, inputs], potentials [n, 6] -> h [n, F]. The edge term moves into the nodes, `ε_ij = U_j - U_i`, as
/// in the CPU's `attend`: it is where the products of keys and values start from. The keys' bias and U_i add the same
/// to all scores of a vertex, which softmax does not see.
fn graph_layer(
    graph: &mut Graph,
    (batches, heads): (&[Batch], usize),
    layer: &Layer<Vec<f32>>,
    [h, potentials]: [&Value; 2],
) -> Value {
    let (inputs, features) = (layer.project.inputs, layer.norm_bias.len());
    let part = |rows: &[f32], part: usize| -> Vec<f32> {
        rows.chunks_exact(4 * features).flat_map(|row| &row[part * features..][..features]).copied().collect()
    };
    let weight = |graph: &mut Graph, at: usize| graph.floats(&[inputs, features], &part(&layer.project.weight, at));
    let bias = |graph: &mut Graph, at: usize| graph.floats(&[features], &part(&layer.project.bias, at));
    let edge = graph.floats(&[6, features], &layer.edge);
    let u = graph.node("MatMul", &[potentials, &edge]);
    let [query_weight, key_weight, value_weight, skip_weight] = [0, 1, 2, 3].map(|at| weight(graph, at));
    let [query_bias, value_bias, skip_bias] = [0, 2, 3].map(|at| bias(graph, at));
    let query = graph.node("Gemm", &[h, &query_weight, &query_bias]);
    let key = graph.node("Gemm", &[h, &key_weight, &u]);
    let start = graph.node("Gemm", &[potentials, &edge, &value_bias]);
    let value = graph.node("Gemm", &[h, &value_weight, &start]);
    let skip = graph.node("Gemm", &[h, &skip_weight, &skip_bias]);
    let batches: Vec<Value> =
        batches.iter().map(|batch| attend(graph, batch, [features, heads], [&query, &key, &value, &u])).collect();
    let attended = graph.concat(&batches.iter().collect::<Vec<_>>(), 0);
    let attended = graph.node("Sub", &[&attended, &u]);
    let gated = gate(graph, &layer.gate, &attended, &skip);
    normalise(graph, layer, &gated)
}

/// `Σ_j α_ij (v_j + U_j)` of the vertices of a batch [places, F]; U_i where there is no neighbour, of which nothing is
/// left then. In onnxruntime the fastest of nine forms or as fast, natively and as wasm, for 16 and 64 features a head
/// (measured). Tables padded to the greatest number of neighbours, with a mask, took 1.2 to 2 times as long; small
/// matrix products for each vertex and head 1.7 times for 16 features; a list of edges with ScatterElements 4 times.
fn attend(
    graph: &mut Graph,
    batch: &Batch,
    [features, heads]: [usize; 2],
    [query, key, value, u]: [&Value; 4],
) -> Value {
    let (count, degree, d) = (batch.places.len(), batch.degree, features / heads);
    if degree == 0 {
        return graph.slice(u, 0, batch.places.clone());
    }
    let neighbours = graph.indices(&[count, degree], batch.neighbours.iter().copied());
    let query = graph.slice(query, 0, batch.places.clone());
    let query = graph.reshape(&query, &[count, 1, features]);
    let key = graph.gather(key, &neighbours);
    let products = graph.node("Mul", &[&query, &key]);
    let products = graph.reshape(&products, &[count, degree, heads, d]);
    let scores = graph.sum(&products, 3);
    let scale = graph.floats(&[], &[1.0 / (d as f32).sqrt()]);
    let scores = graph.node("Mul", &[&scores, &scale]);
    let weights = graph.node_with("Softmax", &[&scores], vec![integer("axis", 1)]);
    // Each head's weight for all of its features, by a product: broadcasting goes in steps of a head's few features.
    let spread: Vec<f32> =
        (0..heads * features).map(|e| f32::from(u8::from(e % features / d == e / features))).collect();
    let spread = graph.floats(&[heads, features], &spread);
    let weights = graph.node("MatMul", &[&weights, &spread]);
    let value = graph.gather(value, &neighbours);
    let weighted = graph.node("Mul", &[&weights, &value]);
    graph.sum(&weighted, 1)
}

/// `(1-β) ĥ + β r`, `β = sigmoid(w_g · [ĥ ; r ; ĥ - r])`, of ĥ and r [n, F].
fn gate(graph: &mut Graph, weights: &[f32], attended: &Value, skip: &Value) -> Value {
    let features = weights.len() / 3;
    let combined = |at: usize, sign: f32| -> Vec<f32> {
        (0..features).map(|f| weights[at * features + f] + sign * weights[2 * features + f]).collect()
    };
    let [to_attended, to_skip] =
        [(0, 1.0), (1, -1.0)].map(|(at, sign)| graph.floats(&[features, 1], &combined(at, sign)));
    let of_attended = graph.node("MatMul", &[attended, &to_attended]);
    let of_skip = graph.node("MatMul", &[skip, &to_skip]);
    let logit = graph.node("Add", &[&of_attended, &of_skip]);
    let beta = graph.node("Sigmoid", &[&logit]);
    let difference = graph.node("Sub", &[skip, attended]);
    let part = graph.node("Mul", &[&beta, &difference]);
    graph.node("Add", &[attended, &part])
}

/// `ReLU(LayerNorm(x))` of x [n, F], in the steps that onnxruntime knows as one: the operator of that name came after
/// this opset.
fn normalise(graph: &mut Graph, layer: &Layer<Vec<f32>>, x: &Value) -> Value {
    let mean = graph.mean(x, -1);
    let centred = graph.node("Sub", &[x, &mean]);
    let two = graph.floats(&[], &[2.0]);
    let squares = graph.node("Pow", &[&centred, &two]);
    let variance = graph.mean(&squares, -1);
    let epsilon = graph.floats(&[], &[EPSILON]);
    let variance = graph.node("Add", &[&variance, &epsilon]);
    let deviation = graph.node("Sqrt", &[&variance]);
    let normal = graph.node("Div", &[&centred, &deviation]);
    let [weight, bias] = [&layer.norm_weight, &layer.norm_bias].map(|values| graph.floats(&[values.len()], values));
    let scaled = graph.node("Mul", &[&normal, &weight]);
    let shifted = graph.node("Add", &[&scaled, &bias]);
    graph.node("Relu", &[&shifted])
}
