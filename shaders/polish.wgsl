// A step in which predicted cloth takes back the lengths it was cut to. Twin: crate/core/src/cpu/network/polish.rs

struct Params {
    vertices: u32,
    // Of a vertex's own pull, and of its neighbours' mean.
    own: f32,
    others: f32,
    rate: f32,
    momentum: f32,
    // How far above the body a vertex meets it, and is kept.
    reach: f32,
    gap: f32,
}

@group(0) @binding(0) var<uniform> params: Params;
// [1]
@group(0) @binding(3) var<storage, read> share: array<f32>;
// Unit normals of the cloth before the first step [n, 3].
@group(0) @binding(4) var<storage, read> facing: array<f32>;
// [n, 3]
@group(0) @binding(5) var<storage, read> pulls: array<f32>;
// How far the last step went, and then this one [n, 3].
@group(0) @binding(6) var<storage, read_write> moves: array<f32>;
// What each vertex lacks to where the body is no longer met, before the step, and then after it [n, 3].
@group(0) @binding(7) var<storage, read_write> near: array<f32>;
// [n, 3]
@group(0) @binding(8) var<storage, read_write> positions: array<f32>;

@compute @workgroup_size(64)
fn polish(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if (i >= params.vertices) {
        return;
    }
    let first = params.momentum == 0.0;
    // What was there before the first step may be anything.
    let last = vec3(moves[3u * i], moves[3u * i + 1u], moves[3u * i + 2u]);
    let on = select(last * params.momentum, vec3(0.0), first);
    var by = (diffused_pull(i) * params.rate + on) * share[0];
    var lacks = vec3(near[3u * i], near[3u * i + 1u], near[3u * i + 2u]);
    let lack = length(lacks);
    if (first && lack > params.reach) {
        // The deeper inside the body, the more along the cloth's own normal.
        let normal = vec3(facing[3u * i], facing[3u * i + 1u], facing[3u * i + 2u]);
        let leant = lacks / lack + normal * (lack / params.reach - 1.0);
        lacks = leant * (lack / max(length(leant), 1e-30));
    }
    if (lack > 0.0) {
        let up = lacks / lack;
        let after = lack - dot(by, up);
        let too_near = max(after - (params.reach - params.gap), 0.0);
        by += up * too_near;
        lacks = up * max(after - too_near, 0.0);
    }
    near[3u * i] = lacks.x;
    near[3u * i + 1u] = lacks.y;
    near[3u * i + 2u] = lacks.z;
    moves[3u * i] = by.x;
    moves[3u * i + 1u] = by.y;
    moves[3u * i + 2u] = by.z;
    positions[3u * i] += by.x;
    positions[3u * i + 1u] += by.y;
    positions[3u * i + 2u] += by.z;
}
