//! The network's operations as dispatches: which shader, on which buffers, laid out how.

use super::{Id, IndexId, Record, Recorder};
use crate::pack::{self, whole};
use ctsn_core::cpu::network::{polish, ride, surround};
use ctsn_core::cpu::repair::closest::GAP;
use ctsn_core::model::surroundings::INPUTS;
use ctsn_core::operation::{
    Activation, Attend, Blend, BodyFrame, Diffuse, Features, Linear, Normals, Polish, Pull, Ride, Skin, Space, Surface,
    Surround,
};
use ctsn_core::pose::Frame;
use ctsn_shaders as shaders;

/// The largest power of two that is not above `number`.
fn power_of_two_below(number: usize) -> usize {
    1 << number.ilog2()
}

impl Record for BodyFrame<Id, Id> {
    fn record(self, recorder: &mut Recorder) {
        let Self { rig, joints, transforms, vector } = self;
        let count = rig.joints.len();
        let operands = [
            recorder.rows(joints, 12, 12),
            recorder.pack(("inverse bind", 0), |_| rig.inverse_bind.as_flattened().to_vec()),
            recorder.pack(("standard", 0), |_| pack::standard(&rig)),
            recorder.rows(transforms, 12, 12),
            recorder.rows(vector, 12 * count, 12 * count),
        ];
        let yaw = u32::from(rig.frame == Frame::HipYaw);
        let params = shaders::BodyFrame { joints: count as u32, root: rig.root as u32, yaw };
        recorder.dispatch(&shaders::BODY_FRAME, params, &operands, [count + 1, 1], transforms);
    }
}

impl Record for Linear<Id, Id> {
    fn record(self, recorder: &mut Recorder) {
        let Self { x, weight, bias, activation, y } = self;
        let outputs = recorder.length(bias);
        let (inputs, rows) = (recorder.length(weight) / outputs, recorder.length(y) / outputs);
        let operands = [
            recorder.rows(x, inputs, whole(inputs)),
            recorder.pack(("weight", weight.0), |it| pack::rows(it.values(weight), outputs, whole(inputs))),
            recorder.pack(("bias", bias.0), |it| pack::rows(it.values(bias), outputs, 1)),
            recorder.rows(y, outputs, whole(outputs)),
        ];
        let [inputs4, outputs4] = [inputs, outputs].map(|numbers| whole(numbers) / 4);
        let params = shaders::Linear {
            rows: rows as u32,
            inputs: inputs4 as u32,
            outputs: outputs4 as u32,
            relu: u32::from(activation == Activation::Relu),
        };
        let shader = if rows == 1 { &shaders::LINEAR_ROW } else { &shaders::LINEAR };
        recorder.dispatch(shader, params, &operands, [outputs4, rows], y);
    }
}

impl Record for Blend<Id, Id> {
    fn record(self, recorder: &mut Recorder) {
        let Self { weights, basis, rest, share, residual, template } = self;
        let numbers = recorder.length(residual);
        let count = recorder.length(basis) / numbers;
        let shared = recorder.length(weights) == count;
        let operands = [
            recorder.rows(weights, count, whole(count)),
            recorder.pack(("basis", basis.0), |it| pack::basis(it.values(basis), count)),
            recorder.rows(rest, 3, 3),
            recorder.rows(share, 1, 4),
            recorder.rows(residual, 3, 3),
            recorder.rows(template, 3, 3),
        ];
        let count4 = (whole(count) / 4) as u32;
        let stride = if shared { 0 } else { count4 };
        let params = shaders::Blend { numbers: numbers as u32, count: count4, stride };
        recorder.dispatch(&shaders::BLEND, params, &operands, [numbers, 1], residual);
    }
}

impl Record for Skin<Id, Id, IndexId> {
    fn record(self, recorder: &mut Recorder) {
        let Self { rest, joints, weights, transforms, space, positions } = self;
        let n = recorder.length(positions) / 3;
        let width = recorder.length(weights) / n;
        let operands = [
            recorder.rows(rest, 3, 3),
            recorder.pack(("skin joints", joints.0), |it| pack::slots(it.indices(joints), width)),
            recorder.pack(("skin weights", weights.0), |it| pack::slots(it.values(weights), width)),
            recorder.rows(transforms, 12, 12),
            recorder.rows(positions, 3, 3),
        ];
        let back = recorder.length(transforms) / 4 - 3;
        let world = u32::from(space == Space::World);
        let params = shaders::Skin { vertices: n as u32, width: width as u32, back: back as u32, world };
        recorder.dispatch(&shaders::SKIN, params, &operands, [n, 1], positions);
    }
}

impl Record for Features<Id, Id> {
    fn record(self, recorder: &mut Recorder) {
        let Self { v, rest, mean, deviation, edge_scale, nodes, potentials } = self;
        let n = recorder.length(v) / 3;
        let operands = [
            recorder.rows(v, 3, 3),
            recorder.rows(rest, 3, 3),
            recorder.rows(nodes, 3, 4),
            recorder.rows(potentials, 3, 4),
        ];
        let params = shaders::Features { mean, edge_scale, deviation, vertices: n as u32 };
        recorder.dispatch(&shaders::FEATURES, params, &operands, [n, 1], nodes);
    }
}

impl Record for Surround<Id, Id, IndexId> {
    fn record(self, recorder: &mut Recorder) {
        let Self { potentials, places, joints, weights, transforms, around, nodes } = self;
        let n = recorder.length(places) / 3;
        let width = recorder.length(weights) / n;
        let operands = [
            recorder.rows(potentials, 3, 4),
            recorder.rows(places, 3, 4),
            recorder.pack(("skin joints", joints.0), |it| pack::slots(it.indices(joints), width)),
            recorder.pack(("skin weights", weights.0), |it| pack::slots(it.values(weights), width)),
            recorder.rows(transforms, 12, 12),
            recorder.indexed(around),
            recorder.rows(nodes, INPUTS, whole(INPUTS)),
        ];
        let params = shaders::Surround { vertices: n as u32, width: width as u32, strain: surround::STRAIN };
        recorder.dispatch(&shaders::SURROUND, params, &operands, [n, 1], nodes);
    }
}

impl Record for Attend<Id, Id, IndexId> {
    fn record(self, recorder: &mut Recorder) {
        let Self { offsets, neighbours, heads, projected, potentials, edge, gate, attended, output, .. } = self;
        let (n, features) = (recorder.indices(offsets).len() - 1, recorder.length(self.norm_bias));
        let mut operands = vec![
            recorder.indexed(offsets),
            recorder.indexed(neighbours),
            recorder.rows(projected, 4 * features, 4 * features),
            recorder.rows(potentials, 3, 4),
            recorder.pack(("layer", edge.0), |it| {
                let [edge, gate, weight, bias] = [edge, gate, self.norm_weight, self.norm_bias].map(|id| it.values(id));
                pack::layer(edge, gate, weight, bias)
            }),
            recorder.rows(output, features, whole(features)),
        ];
        let d = features / heads;
        let params = shaders::Attend {
            vertices: n as u32,
            features: features as u32,
            stride: whole(features) as u32,
            heads: heads as u32,
            lanes: d.next_power_of_two().min(power_of_two_below(shaders::LANES / heads.min(shaders::LANES))) as u32,
            scale: 1.0 / (d as f32).sqrt(),
        };
        if recorder.gpu.is_software() {
            operands.push(recorder.rows(attended, features, features));
            return recorder.dispatch(&shaders::ATTEND_VERTEX, params, &operands, [n, 1], output);
        }
        if features > shaders::MAX_FEATURES {
            recorder.fail("features of a graph layer".to_owned(), features as u64, shaders::MAX_FEATURES as u64);
        }
        let limit = recorder.gpu.device().limits().max_compute_workgroups_per_dimension as usize;
        recorder.dispatch(&shaders::ATTEND, params, &operands, [n.min(limit), n.div_ceil(limit)], output);
        recorder.give_room(features);
    }
}

impl Record for Pull<Id, Id, IndexId> {
    fn record(self, recorder: &mut Recorder) {
        let Self { offsets, neighbours, squares, positions, near, pulls } = self;
        let n = recorder.length(positions) / 3;
        let operands = [
            recorder.indexed(offsets),
            recorder.indexed(neighbours),
            recorder.pack(("squares", squares.0), |it| it.values(squares).to_vec()),
            recorder.rows(positions, 3, 3),
            recorder.rows(near, 3, 3),
            recorder.rows(pulls, 3, 3),
        ];
        let params = shaders::Pull { vertices: n as u32, rate: polish::RATE, reach: polish::REACH, gap: GAP };
        recorder.dispatch(&shaders::PULL, params, &operands, [n, 1], pulls);
    }
}

impl Record for Diffuse<Id, Id, IndexId> {
    fn record(self, recorder: &mut Recorder) {
        let Self { offsets, neighbours, pulls, diffused } = self;
        let n = recorder.length(pulls) / 3;
        let operands = [
            recorder.indexed(offsets),
            recorder.indexed(neighbours),
            recorder.rows(pulls, 3, 3),
            recorder.rows(diffused, 3, 3),
        ];
        let params = shaders::Diffuse { vertices: n as u32, own: polish::OWN, others: 1.0 - polish::OWN };
        recorder.dispatch(&shaders::DIFFUSE, params, &operands, [n, 1], diffused);
    }
}

impl Record for Polish<Id, Id, IndexId> {
    fn record(self, recorder: &mut Recorder) {
        let Self { offsets, neighbours, share, first, facing, pulls, moves, near, positions } = self;
        let n = recorder.length(positions) / 3;
        let operands = [
            recorder.indexed(offsets),
            recorder.indexed(neighbours),
            recorder.rows(share, 1, 4),
            recorder.rows(facing, 3, 3),
            recorder.rows(pulls, 3, 3),
            recorder.rows(moves, 3, 3),
            recorder.rows(near, 3, 3),
            recorder.rows(positions, 3, 3),
        ];
        let (own, others, rate) = (polish::OWN, 1.0 - polish::OWN, polish::RATE);
        let momentum = if first { 0.0 } else { polish::MOMENTUM };
        let (vertices, reach) = (n as u32, polish::REACH);
        let params = shaders::Polish { vertices, own, others, rate, momentum, reach, gap: GAP };
        recorder.dispatch(&shaders::POLISH, params, &operands, [n, 1], moves);
    }
}

impl Record for Normals<Id, Id, IndexId> {
    fn record(self, recorder: &mut Recorder) {
        let Self { positions, triangles, normals } = self;
        let n = recorder.length(positions) / 3;
        let operands = [
            recorder.rows(positions, 3, 3),
            recorder.pack(("normal offsets", triangles.0), |recorder| pack::corners(n, recorder.indices(triangles)).0),
            recorder.pack(("normal corners", triangles.0), |recorder| pack::corners(n, recorder.indices(triangles)).1),
            recorder.rows(normals, 3, 3),
        ];
        let params = shaders::Normals { vertices: n as u32 };
        recorder.dispatch(&shaders::NORMALS, params, &operands, [n, 1], normals);
    }
}

impl Record for Ride<Id, Id, IndexId> {
    fn record(self, recorder: &mut Recorder) {
        let Self { corners, coordinates, positions, normals, riders } = self;
        let operands = [
            recorder.indexed(corners),
            recorder.rows(coordinates, 4, 4),
            recorder.rows(positions, 3, 3),
            recorder.rows(normals, 3, 3),
            recorder.rows(riders, 3, 3),
        ];
        let count = recorder.length(riders) / 3;
        let params = shaders::Ride { riders: count as u32, least: ride::LEAST };
        recorder.dispatch(&shaders::RIDE, params, &operands, [count, 1], riders);
    }
}

impl Record for Surface<Id, Id, IndexId> {
    fn record(self, recorder: &mut Recorder) {
        let Self { vertex, positions, normals, drawn_positions, drawn_normals } = self;
        let operands = [
            recorder.indexed(vertex),
            recorder.rows(positions, 3, 3),
            recorder.rows(normals, 3, 3),
            recorder.rows(drawn_positions, 3, 3),
            recorder.rows(drawn_normals, 3, 3),
        ];
        let drawn = recorder.indices(vertex).len();
        let params = shaders::Surface { drawn: drawn as u32 };
        recorder.dispatch(&shaders::SURFACE, params, &operands, [drawn, 1], drawn_positions);
    }
}
