// One round in which every pull is shared with the neighbours. Twin: crate/core/src/cpu/network/diffuse.rs

struct Params {
    vertices: u32,
    // Of a vertex's own pull, and of its neighbours' mean.
    own: f32,
    others: f32,
}

@group(0) @binding(0) var<uniform> params: Params;
// First neighbour of each vertex [n + 1], and the neighbours.
@group(0) @binding(1) var<storage, read> offsets: array<u32>;
@group(0) @binding(2) var<storage, read> neighbours: array<u32>;
// [n, 3]
@group(0) @binding(3) var<storage, read> pulls: array<f32>;
// [n, 3]
@group(0) @binding(4) var<storage, read_write> diffused: array<f32>;

fn pull(i: u32) -> vec3<f32> {
    return vec3(pulls[3u * i], pulls[3u * i + 1u], pulls[3u * i + 2u]);
}

@compute @workgroup_size(64)
fn diffuse(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if (i >= params.vertices) {
        return;
    }
    var sum = vec3(0.0);
    for (var k = offsets[i]; k < offsets[i + 1u]; k++) {
        sum += pull(neighbours[k]);
    }
    let mean = sum / f32(max(offsets[i + 1u] - offsets[i], 1u));
    let by = pull(i) * params.own + mean * params.others;
    diffused[3u * i] = by.x;
    diffused[3u * i + 1u] = by.y;
    diffused[3u * i + 2u] = by.z;
}
