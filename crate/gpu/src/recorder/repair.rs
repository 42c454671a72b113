//! The operations of the repair of penetration as dispatches.

use super::{Id, IndexId, Record, Recorder};
use crate::pack;
use crate::recording::Operand;
use ctsn_core::cpu::repair::{closest, collide, eight, settle, slide, spread};
use ctsn_core::operation::{Collide, Settle, Slide, Spread};
use ctsn_shaders as shaders;

impl Record for Collide<Id, Id, IndexId> {
    fn record(self, recorder: &mut Recorder) {
        let Self { reach, posed, normals, offsets, corners, seeds, positions, push } = self;
        let (operands, params) = search(recorder, reach, [posed, normals, positions, push], [offsets, corners, seeds]);
        let n = params.vertices as usize;
        recorder.dispatch(&shaders::COLLIDE, params, &operands, [n, 1], posed);
    }
}

impl Record for Spread<Id, Id, IndexId> {
    fn record(self, recorder: &mut Recorder) {
        let Self { offsets, neighbours, push, before, after } = self;
        let n = recorder.length(push) / 3;
        let operands = [
            recorder.indexed(offsets),
            recorder.indexed(neighbours),
            recorder.rows(push, 3, 3),
            recorder.rows(before, 3, 3),
            recorder.rows(after, 3, 3),
        ];
        let params = shaders::Spread { vertices: n as u32, follow: spread::FOLLOW };
        recorder.dispatch(&shaders::SPREAD, params, &operands, [n, 1], after);
    }
}

impl Record for Slide<Id, Id, IndexId> {
    fn record(self, recorder: &mut Recorder) {
        let Self { offsets, neighbours, squares, share, positions, push, before, after } = self;
        let n = recorder.length(push) / 3;
        let operands = [
            recorder.indexed(offsets),
            recorder.indexed(neighbours),
            recorder.pack(("squares", squares.0), |it| it.values(squares).to_vec()),
            recorder.rows(share, 1, 4),
            recorder.rows(positions, 3, 3),
            recorder.rows(push, 3, 3),
            recorder.rows(before, 3, 3),
            recorder.rows(after, 3, 3),
        ];
        recorder.dispatch(
            &shaders::SLIDE,
            shaders::Slide { vertices: n as u32, rate: slide::RATE },
            &operands,
            [n, 1],
            after,
        );
    }
}

impl Record for Settle<Id, Id, IndexId> {
    fn record(self, recorder: &mut Recorder) {
        let Self { posed, normals, offsets, corners, seeds, displacement, positions } = self;
        let buffers = [posed, normals, displacement, positions];
        let (operands, params) = search(recorder, closest::GAP, buffers, [offsets, corners, seeds]);
        let n = params.vertices as usize;
        recorder.dispatch(&shaders::SETTLE, params, &operands, [n, 1], posed);
    }
}

/// A search over the posed body: its positions and normals, a number per coordinate of the cloth, and such numbers
/// that are written.
fn search(
    recorder: &mut Recorder,
    reach: f32,
    [posed, normals, cloth, output]: [Id; 4],
    [offsets, corners, seeds]: [IndexId; 3],
) -> ([Operand; 7], shaders::Collide) {
    let n = recorder.length(cloth) / 3;
    let width = recorder.indices(seeds).len() / n;
    let operands = [
        recorder.rows(posed, 3, 3),
        recorder.rows(normals, 3, 3),
        recorder.indexed(offsets),
        recorder.indexed(corners),
        recorder.pack(("seeds", seeds.0), |it| pack::slots(it.indices(seeds), width)),
        recorder.rows(cloth, 3, 3),
        recorder.rows(output, 3, 3),
    ];
    let params = shaders::Collide {
        vertices: n as u32,
        seeds: width as u32,
        steps: closest::STEPS as u32,
        gap: closest::GAP,
        reach,
        depth: closest::DEPTH,
        steepest: closest::STEEPEST,
        sliver: eight::SLIVER,
        folded: closest::FOLDED,
        landmarks: collide::LANDMARKS.min(recorder.length(posed) / 3) as u32,
        free: collide::FREE,
        elsewhere: collide::ELSEWHERE,
        again: settle::AGAIN,
    };
    (operands, params)
}
