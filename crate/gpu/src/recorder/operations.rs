//! The operations of the network as dispatches: which shader, on which buffers, laid out how.

use super::{Id, IndexId, Recorder, Slot};
use crate::pack::{self, whole};
use ctsn_core::cpu::{bury, closest, collide, eight, settle, spread};
use ctsn_core::device::{Activation, Device, Space};
use ctsn_core::model::{Body, Layer, Linear, Reference, Sizes, Skin};
use ctsn_core::network::Drawn;
use ctsn_core::pose::{Frame, Rig};
use ctsn_core::topology::Graph;
use ctsn_shaders::{self as shaders, Shader};
use std::borrow::Cow;

/// Operations of a walk over the body, from four seeds.
const WALK: usize = 8 * (4 + 12);

/// The largest power of two that is not above `number`.
fn power_of_two_below(number: usize) -> usize {
    1 << number.ilog2()
}

impl Device for Recorder<'_> {
    type Buffer = Id;
    type Indices = IndexId;

    fn buffer(&mut self, values: &[f32]) -> Id {
        self.slots.push(Slot::Constant(Cow::Owned(values.to_vec())));
        Id(self.slots.len() - 1)
    }

    fn indices(&mut self, indices: &[u32]) -> IndexId {
        self.indices.push(Cow::Owned(indices.to_vec()));
        IndexId(self.indices.len() - 1)
    }

    fn write(&mut self, buffer: &mut Id, values: &[f32]) {
        self.slots[buffer.0] = Slot::Constant(Cow::Owned(values.to_vec()));
    }

    fn body_frame(&mut self, rig: &Rig, joints: &Id, transforms: &mut Id, vector: &mut Id) {
        let count = rig.joints.len();
        let operands = [
            self.output(*joints, 12, 12),
            self.pack(("inverse bind", 0), |_| rig.inverse_bind.as_flattened().to_vec()),
            self.pack(("standard", 0), |_| pack::standard(rig)),
            self.output(*transforms, 12, 12),
            self.output(*vector, 12 * count, 12 * count),
        ];
        let yaw = u32::from(rig.frame == Frame::HipYaw);
        let params = shaders::BodyFrame { joints: count as u32, root: rig.root as u32, yaw };
        self.dispatch(&shaders::BODY_FRAME, params, &operands, [count + 1, 1], *transforms, count * 110);
    }

    fn linear(&mut self, x: &Id, layer: &Linear<Id>, activation: Activation, y: &mut Id) {
        let Linear { weight, bias, inputs, outputs } = *layer;
        let rows = self.length(*y) / outputs;
        let operands = [
            self.input(*x),
            self.pack(("weight", weight.0), |this| pack::rows(this.values(weight), outputs, whole(inputs))),
            self.pack(("bias", bias.0), |this| pack::rows(this.values(bias), outputs, 1)),
            self.output(*y, outputs, whole(outputs)),
        ];
        let [inputs4, outputs4] = [inputs, outputs].map(|numbers| whole(numbers) / 4);
        let params = shaders::Linear {
            rows: rows as u32,
            inputs: inputs4 as u32,
            outputs: outputs4 as u32,
            relu: u32::from(activation == Activation::Relu),
        };
        let shader = if rows == 1 { &shaders::LINEAR_ROW } else { &shaders::LINEAR };
        self.dispatch(shader, params, &operands, [outputs4, rows], *y, 2 * rows * inputs * outputs);
    }

    fn blend(&mut self, weights: &Id, basis: &Id, rest: &Id, confidence: &Id, residual: &mut Id, template: &mut Id) {
        let numbers = self.length(*residual);
        let count = self.length(*basis) / numbers;
        let shared = self.length(*weights) == count;
        let operands = [
            self.input(*weights),
            self.pack(("basis", basis.0), |this| pack::basis(this.values(*basis), count)),
            self.plain(*rest),
            self.output(*confidence, 1, 4),
            self.output(*residual, 3, 3),
            self.output(*template, 3, 3),
        ];
        let count4 = (whole(count) / 4) as u32;
        let stride = if shared { 0 } else { count4 };
        let params = shaders::Blend { numbers: numbers as u32, count: count4, stride };
        self.dispatch(&shaders::BLEND, params, &operands, [numbers, 1], *residual, numbers * (2 * count + 1));
    }

    fn skin(&mut self, rest: &Id, skin: &Skin<Id, IndexId>, transforms: &Id, space: Space, positions: &mut Id) {
        let (joints, weights, width) = (skin.joints, skin.weights, skin.width);
        let n = self.length(*positions) / 3;
        let operands = [
            self.plain(*rest),
            self.pack(("skin joints", joints.0), |this| pack::slots(&this.indices[joints.0], width)),
            self.pack(("skin weights", weights.0), |this| pack::slots(this.values(weights), width)),
            self.input(*transforms),
            self.output(*positions, 3, 3),
        ];
        let back = self.length(*transforms) / 4 - 3;
        let world = u32::from(space == Space::World);
        let params = shaders::Skin { vertices: n as u32, width: width as u32, back: back as u32, world };
        self.dispatch(&shaders::SKIN, params, &operands, [n, 1], *positions, n * (24 * width + 42));
    }

    fn features(&mut self, v: &Id, rest: &Id, reference: &Reference<Id, IndexId>, nodes: &mut Id, potentials: &mut Id) {
        let n = self.length(*v) / 3;
        let operands = [self.input(*v), self.plain(*rest), self.output(*nodes, 3, 4), self.output(*potentials, 6, 8)];
        let params = shaders::Features {
            mean: reference.mean,
            edge_scale: reference.edge_scale,
            deviation: reference.std,
            vertices: n as u32,
        };
        self.dispatch(&shaders::FEATURES, params, &operands, [n, 1], *nodes, 12 * n);
    }

    fn attend(
        &mut self,
        graph: &Graph<IndexId>,
        sizes: Sizes,
        projected: &mut Id,
        potentials: &Id,
        layer: &Layer<Id>,
        attended: &mut Id,
        output: &mut Id,
    ) {
        let Sizes { vertices: n, features, heads, .. } = sizes;
        let Layer { edge, gate, norm_weight, norm_bias, .. } = *layer;
        if features > shaders::MAX_FEATURES {
            self.fail("features of a graph layer".to_owned(), features as u64, shaders::MAX_FEATURES as u64);
        }
        let mut operands = vec![
            self.pack(("offsets", graph.offsets.0), |this| this.indices[graph.offsets.0].to_vec()),
            self.pack(("neighbours", graph.neighbours.0), |this| this.indices[graph.neighbours.0].to_vec()),
            self.input(*projected),
            self.input(*potentials),
            self.pack(("layer", edge.0), |this| {
                let [edge, gate, weight, bias] = [edge, gate, norm_weight, norm_bias].map(|id| this.values(id));
                pack::layer(edge, gate, weight, bias)
            }),
            self.output(*output, features, whole(features)),
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
        let flops = self.indices[graph.neighbours.0].len() * features * 28 + n * features * 19;
        if self.gpu.is_software() {
            operands.push(self.output(*attended, features, features));
            return self.dispatch(&shaders::ATTEND_VERTEX, params, &operands, [n, 1], *output, flops);
        }
        let limit = self.gpu.device().limits().max_compute_workgroups_per_dimension as usize;
        self.dispatch(&shaders::ATTEND, params, &operands, [n.min(limit), n.div_ceil(limit)], *output, flops);
        self.give_room(features);
    }

    fn normals(&mut self, positions: &Id, triangles: &[u32], normals: &mut Id) {
        let n = self.length(*positions) / 3;
        let (offsets, corners) = pack::corners(n, triangles);
        let operands = [
            self.input(*positions),
            self.pack(("normal offsets", positions.0), |_| offsets),
            self.pack(("normal corners", positions.0), |_| corners),
            self.output(*normals, 3, 3),
        ];
        let params = shaders::Normals { vertices: n as u32 };
        self.dispatch(&shaders::NORMALS, params, &operands, [n, 1], *normals, 18 * triangles.len() + 9 * n);
    }

    fn bury(&mut self, body: &Body<Id, IndexId>, posed: &Id, normals: &Id, exposed: &mut Id) {
        let operands = [self.input(*posed), self.input(*normals), self.plain(body.areas), self.output(*exposed, 3, 3)];
        let range = bury::buriable(body.vertices);
        let params = shaders::Bury {
            vertices: body.vertices as u32,
            first: range.start as u32,
            end: range.end as u32,
            above: bury::ABOVE,
            least: bury::least(),
            away: bury::AWAY,
        };
        let flops = range.len() * body.vertices * 18;
        self.dispatch(&shaders::BURY, params, &operands, [range.len().max(1), 1], *exposed, flops);
    }

    fn collide(&mut self, body: &Body<Id, IndexId>, exposed: &Id, normals: &Id, positions: &Id, push: &mut Id) {
        // A walk of about two steps of six neighbours, six triangles around its end.
        self.search(&shaders::COLLIDE, body, [*exposed, *normals, *positions], *push, WALK + 6 * 60);
    }

    fn spread(&mut self, graph: &Graph<IndexId>, push: &Id, before: &Id, after: &mut Id) {
        let n = self.length(*push) / 3;
        let operands = [
            self.pack(("offsets", graph.offsets.0), |this| this.indices[graph.offsets.0].to_vec()),
            self.pack(("neighbours", graph.neighbours.0), |this| this.indices[graph.neighbours.0].to_vec()),
            self.input(*push),
            self.input(*before),
            self.output(*after, 3, 3),
        ];
        let flops = 3 * self.indices[graph.neighbours.0].len() + 20 * n;
        let params = shaders::Spread { vertices: n as u32, follow: spread::FOLLOW };
        self.dispatch(&shaders::SPREAD, params, &operands, [n, 1], *after, flops);
    }

    fn settle(&mut self, body: &Body<Id, IndexId>, exposed: &Id, normals: &Id, displacement: &Id, positions: &mut Id) {
        // One vertex in twenty or so is looked at again, from its neighbours' neighbours, too.
        self.search(
            &shaders::SETTLE,
            body,
            [*exposed, *normals, *displacement],
            *positions,
            (WALK + 8 * 36 + 6 * 60) / 20,
        );
    }

    fn surface(&mut self, vertex: &[u32], positions: &Id, normals: &Id, drawn: &mut Drawn<Id>) {
        let operands = [
            self.pack(("surface vertex", 0), |_| vertex.to_vec()),
            self.input(*positions),
            self.input(*normals),
            self.output(drawn.positions, 3, 3),
            self.output(drawn.normals, 3, 3),
        ];
        let params = shaders::Surface { drawn: vertex.len() as u32 };
        self.dispatch(&shaders::SURFACE, params, &operands, [vertex.len(), 1], drawn.positions, 0);
    }
}

impl Recorder<'_> {
    /// A search over the posed body: its exposed positions, normals and a number per coordinate of the cloth -> such numbers. `flops` of each vertex.
    fn search(&mut self, shader: &'static Shader, body: &Body<Id, IndexId>, inputs: [Id; 3], output: Id, flops: usize) {
        let [exposed, normals, cloth] = inputs;
        let n = self.length(cloth) / 3;
        let (offsets, corners, seeds) = (body.fans.offsets.0, body.fans.corners.0, body.seeds.0);
        let width = self.indices[seeds].len() / n;
        let operands = [
            self.input(exposed),
            self.input(normals),
            self.pack(("fan offsets", offsets), |this| this.indices[offsets].to_vec()),
            self.pack(("fan corners", corners), |this| this.indices[corners].to_vec()),
            self.pack(("seeds", seeds), |this| pack::slots(&this.indices[seeds], width)),
            self.input(cloth),
            self.output(output, 3, 3),
        ];
        let params = shaders::Collide {
            vertices: n as u32,
            seeds: width as u32,
            steps: closest::STEPS as u32,
            gap: closest::GAP,
            depth: closest::DEPTH,
            steepest: closest::STEEPEST,
            sliver: eight::SLIVER,
            folded: closest::FOLDED,
            away: bury::AWAY,
            landmarks: collide::LANDMARKS.min(body.vertices) as u32,
            free: collide::FREE,
            elsewhere: collide::ELSEWHERE,
            again: settle::AGAIN,
        };
        self.dispatch(shader, params, &operands, [n, 1], exposed, n * flops);
    }
}
