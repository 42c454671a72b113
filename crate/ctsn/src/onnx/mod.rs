//! The network as an ONNX file. network.md §1–4, all of it, and nothing of polish and repair: what
//! `network::forward` computes for both streams, from the same joints to the same positions.
//!
//! It is not written as a `Device`, one operation after the other: what makes it fast in onnxruntime, such as edge
//! terms from which products start, spans operations. Tests in `tests/onnx/` hold the two together.
//!
//! Inside, points are kept by axes [3, n], so that rows are long, and vertices stand in an order of their own
//! (`order.rs`), which is undone at the end.

mod graph;
mod mesh;
mod message;
mod order;
mod pose;
mod surround;

use ctsn_core::model::{HostModel, Skinning};
use graph::{Graph, Value};
use order::Order;
use pose::Pose;
use prost::Message;

/// Version of the operators: what Unity reads in all its versions, too. Later ones make nothing faster (measured).
const OPSET: i64 = 15;
/// Version of the format that came with it.
const FORMAT: i64 = 8;

/// Model -> bytes of an ONNX file: `joints` [J, 3, 4] in, `positions` [n, 3] out.
pub fn onnx(model: &HostModel) -> Vec<u8> {
    let (n, joints) = (model.sizes.vertices, model.sizes.joints);
    let mut graph = Graph::new("ctsn");
    let meaning = "World transforms of the joints, 3x4 and row-major, in metres; their order is in the metadata";
    let input = graph.input("joints", &[joints, 3, 4], meaning);
    let positions = network(&mut graph, model, &input);
    graph.output(
        "positions",
        &[n, 3],
        "Cloth vertices in the world, metres; neither polished nor repaired",
        &positions,
    );
    let entry = |key: &str, value: String| message::Entry { key: key.to_owned(), value };
    let file = message::Model {
        ir_version: FORMAT,
        producer_name: "ctsn".to_owned(),
        producer_version: env!("CARGO_PKG_VERSION").to_owned(),
        graph: Some(graph.finish()),
        opset_import: vec![message::OperatorSet { version: OPSET }],
        metadata_props: vec![entry("joints", serde_json::json!(model.rig.joints).to_string())],
    };
    file.encode_to_vec()
}

/// Joints [J, 3, 4] -> positions in the world [n, 3].
fn network(graph: &mut Graph, model: &HostModel, joints: &Value) -> Value {
    let (n, order) = (model.sizes.vertices, Order::by_degree(&model.graph));
    let pose = Pose::new(graph, model, joints);
    let rest = graph.floats(&[3, n], &order.columns(&model.rest, 3));
    // `at` and as much of a residual as the pose's confidence lets through.
    let moved = |graph: &mut Graph, at: &Value, residual: Value| {
        let residual = match &pose.confidence {
            Some(confidence) => graph.node("Mul", &[confidence, &residual]),
            None => residual,
        };
        graph.node("Add", &[at, &residual])
    };
    let residual = skeleton(graph, model, &order, &pose);
    let mut template = moved(graph, &rest, residual);
    let blended = blend(graph, model, &order, &pose.transforms, &model.skinning);
    if model.mesh_stream {
        graph.stage("reference");
        let seen = if model.surroundings.is_some() {
            skin(graph, &template, &blended, n)
        } else {
            let body = graph.floats(&[3, n], &order.columns(&model.reference.rest, 3));
            let under = blend(graph, model, &order, &pose.transforms, &model.reference.skinning);
            skin(graph, &body, &under, n)
        };
        let residual = mesh::mesh(graph, model, &order, [&seen, &blended]);
        template = moved(graph, &template, residual);
    }
    graph.stage("template");
    graph.stage("positions");
    let positions = skin(graph, &template, &blended, n);
    let positions = pose.back(graph, &positions);
    let positions = graph.transpose(&positions, &[1, 0]);
    let places = graph.indices(&[n], order.places.iter().copied());
    graph.gather(&positions, &places)
}

/// γ -> Δ_S [3, n]. network.md §2.
fn skeleton(graph: &mut Graph, model: &HostModel, order: &Order, pose: &Pose) -> Value {
    graph.stage("embedding");
    let mut x = pose.vector.clone();
    for (i, layer) in model.embedding.iter().enumerate() {
        x = mesh::linear(graph, layer, &x);
        if i + 1 < model.embedding.len() {
            x = graph.node("Relu", &[&x]);
        }
    }
    graph.stage("skeleton");
    let (n, m) = (model.sizes.vertices, model.sizes.embedding);
    // From [n, 3, m] to [m, 3, n].
    let by_axis = order.columns(&model.skeleton_basis, 3 * m);
    let basis: Vec<f32> = (0..m)
        .flat_map(|j| (0..3).flat_map(move |axis| (axis * m + j) * n..(axis * m + j + 1) * n))
        .map(|e| by_axis[e])
        .collect();
    let basis = graph.floats(&[m, 3 * n], &basis);
    let residual = graph.node("MatMul", &[&x, &basis]);
    graph.reshape(&residual, &[3, n])
}

/// Transforms [12, J] -> those of the vertices [3, 4, n]. network.md §4.
fn blend(
    graph: &mut Graph,
    model: &HostModel,
    order: &Order,
    transforms: &Value,
    skinning: &Skinning<Vec<f32>, Vec<u32>>,
) -> Value {
    let (n, joints) = (model.sizes.vertices, model.sizes.joints);
    let weights = graph.floats(&[joints, n], &order.columns(&skinning.to_dense(joints), joints));
    let blended = graph.node("MatMul", &[transforms, &weights]);
    graph.reshape(&blended, &[3, 4, n])
}

/// Points at rest [3, n], transforms of the vertices [3, 4, n] -> posed [3, n], in the body frame.
fn skin(graph: &mut Graph, rest: &Value, blended: &Value, n: usize) -> Value {
    let ones = graph.floats(&[1, n], &vec![1.0; n]);
    let rest = graph.concat(&[rest, &ones], 0);
    let moved = graph.node("Mul", &[blended, &rest]);
    graph.sum(&moved, 1)
}
