//! World joint transforms -> body frame, pose vector and confidence. network.md §1. In f32, where the CPU takes f64: so
//! what is large, the place in the world, is taken off before anything is multiplied.

use super::graph::{Graph, Value};
use ctsn_core::confidence::{Confidence, DOUBT, TRUST};
use ctsn_core::model::HostModel;
use ctsn_core::pose::{Frame, Range, Rig};

/// A pose inside the graph.
pub struct Pose {
    /// `N·A_j`, by columns of numbers [12, J].
    pub transforms: Value,
    /// γ [1, 12J].
    pub vector: Value,
    /// c [1, 1], where it is not always 1.
    pub confidence: Option<Value>,
    /// Rotation of `N⁻¹` [3, 3].
    rotation: Option<Value>,
    /// p [3, 1].
    hip: Value,
}

impl Pose {
    /// Joints `G_j` [J, 3, 4] -> the pose.
    pub fn new(graph: &mut Graph, model: &HostModel, joints: &Value) -> Self {
        graph.stage("body_frame");
        let (rig, count) = (&*model.rig, model.sizes.joints);
        let (linear, place) = (graph.slice(joints, 2, 0..3), graph.slice(joints, 2, 3..4));
        let hip = graph.slice(&place, 0, rig.root..rig.root + 1);
        let place = graph.node("Sub", &[&place, &hip]);
        let seen = graph.concat(&[&linear, &place], 2);
        let binds: Vec<f32> = rig.inverse_bind.iter().flat_map(square).collect();
        let binds = graph.floats(&[count, 4, 4], &binds);
        let mut transforms = graph.node("MatMul", &[&seen, &binds]);
        let into = (rig.frame == Frame::HipYaw).then(|| turn(graph, rig, &transforms));
        if let Some(into) = &into {
            transforms = graph.node("MatMul", &[into, &transforms]);
        }
        let rotation = into.map(|into| graph.transpose(&into, &[1, 0]));
        let hip = graph.reshape(&hip, &[3, 1]);
        let (mut heard, mut confidence) = (transforms.clone(), None);
        if let (Some(range), Some(of)) = (&rig.range, Confidence::new(model)) {
            let beyond = beyond(graph, range, &transforms);
            heard = graph.node("Sub", &[&transforms, &beyond]);
            confidence = Some(trust(graph, &of, count, &beyond));
        }
        let [mean, std] = [&rig.mean, &rig.std].map(|values| graph.floats(&[count, 3, 4], values));
        let vector = graph.node("Sub", &[&heard, &mean]);
        let vector = graph.node("Div", &[&vector, &std]);
        let vector = graph.reshape(&vector, &[1, 12 * count]);
        let transforms = graph.reshape(&transforms, &[count, 12]);
        let transforms = graph.transpose(&transforms, &[1, 0]);
        Self { transforms, vector, confidence, rotation, hip }
    }

    /// `N⁻¹`: positions in the body frame [3, n] -> in the world.
    pub fn back(&self, graph: &mut Graph, positions: &Value) -> Value {
        let turned = self.rotation.as_ref().map(|rotation| graph.node("MatMul", &[rotation, positions]));
        graph.node("Add", &[turned.as_ref().unwrap_or(positions), &self.hip])
    }
}

/// Rotation of N [3, 3] from the hip's A, before it is turned: by -ψ about +Y, without the angle itself.
fn turn(graph: &mut Graph, rig: &Rig, transforms: &Value) -> Value {
    let hip = graph.slice(transforms, 0, rig.root..rig.root + 1);
    let hip = graph.reshape(&hip, &[1, 12]);
    // Columns cos, sin of A[0,0] + A[2,2], A[0,2] - A[2,0]; not yet of length one.
    let mut pick = [0.0; 24];
    [pick[0], pick[20]] = [1.0, 1.0];
    [pick[5], pick[17]] = [1.0, -1.0];
    let pick = graph.floats(&[12, 2], &pick);
    let twist = graph.node("MatMul", &[&hip, &pick]);
    let squares = graph.node("Mul", &[&twist, &twist]);
    let length = graph.sum(&squares, 1);
    let length = graph.node("Sqrt", &[&length]);
    let length = graph.reshape(&length, &[1, 1]);
    // atan2(0, 0) = 0: a hip that has no heading keeps that of the world.
    let (zero, ahead) = (graph.floats(&[1, 1], &[0.0]), graph.floats(&[1, 2], &[1.0, 0.0]));
    let none = graph.node("Equal", &[&length, &zero]);
    let twist = graph.node("Div", &[&twist, &length]);
    let twist = graph.node("Where", &[&none, &ahead, &twist]);
    let parts = [[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], [0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0]];
    let parts = graph.floats(&[2, 9], parts.as_flattened());
    let upright = graph.floats(&[1, 9], &[0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
    let rotation = graph.node("Gemm", &[&twist, &parts, &upright]);
    graph.reshape(&rotation, &[3, 3])
}

/// What the transforms [J, 3, 4] lie beyond the nearest ones seen in training; exactly zero within them. The joint's
/// own position stands in the place of the translation while they are compared, and both steps are linear.
fn beyond(graph: &mut Graph, range: &Range, transforms: &Value) -> Value {
    let count = range.origins.len();
    let moved = |sign: f32| -> Vec<f32> {
        let by = |origin: &glam::Vec3| {
            let [x, y, z] = (sign * *origin).to_array();
            [1.0, 0.0, 0.0, x, 0.0, 1.0, 0.0, y, 0.0, 0.0, 1.0, z, 0.0, 0.0, 0.0, 1.0]
        };
        range.origins.iter().flat_map(by).collect()
    };
    let [there, back] = [1.0, -1.0].map(|sign| graph.floats(&[count, 4, 4], &moved(sign)));
    let [min, max] = [&range.min, &range.max].map(|values| graph.floats(&[count, 3, 4], values));
    let placed = graph.node("MatMul", &[transforms, &there]);
    let near = graph.node("Max", &[&placed, &min]);
    let near = graph.node("Min", &[&near, &max]);
    let beyond = graph.node("Sub", &[&placed, &near]);
    graph.node("MatMul", &[&beyond, &back])
}

/// c [1, 1] of what the transforms lie beyond those seen [J, 3, 4].
fn trust(graph: &mut Graph, confidence: &Confidence, joints: usize, beyond: &Value) -> Value {
    let (mut centres, mut shares) = (vec![0.0; 4 * joints], vec![0.0; 3 * joints]);
    for lever in &confidence.levers {
        centres[4 * lever.joint..][..4].copy_from_slice(&lever.centre.extend(1.0).to_array());
        shares[3 * lever.joint..][..3].fill(lever.share / (confidence.size * confidence.size));
    }
    let centres = graph.floats(&[joints, 4, 1], &centres);
    let way = graph.node("MatMul", &[beyond, &centres]);
    let way = graph.reshape(&way, &[1, 3 * joints]);
    let squares = graph.node("Mul", &[&way, &way]);
    let shares = graph.floats(&[3 * joints, 1], &shares);
    let excess = graph.node("MatMul", &[&squares, &shares]);
    let excess = graph.node("Sqrt", &[&excess]);
    let scalar = |graph: &mut Graph, value: f32| graph.floats(&[], &[value]);
    let [from, width, zero, one, two, three] =
        [TRUST, DOUBT - TRUST, 0.0, 1.0, 2.0, 3.0].map(|value| scalar(graph, value));
    let x = graph.node("Sub", &[&excess, &from]);
    let x = graph.node("Div", &[&x, &width]);
    let x = graph.node("Clip", &[&x, &zero, &one]);
    // 1 - x² (3 - 2x).
    let doubled = graph.node("Mul", &[&x, &two]);
    let rest = graph.node("Sub", &[&three, &doubled]);
    let squared = graph.node("Mul", &[&x, &x]);
    let doubt = graph.node("Mul", &[&squared, &rest]);
    graph.node("Sub", &[&one, &doubt])
}

/// A 3×4 transform as 4×4.
fn square(rows: &[f32; 12]) -> [f32; 16] {
    std::array::from_fn(|e| if e < 12 { rows[e] } else { f32::from(u8::from(e == 15)) })
}
