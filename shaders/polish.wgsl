// A step in which predicted cloth takes back the lengths it was cut to. Twin: crate/core/src/cpu/network/polish.rs

struct Params {
    vertices: u32,
    rate: f32,
    momentum: f32,
}

@group(0) @binding(0) var<uniform> params: Params;
// First neighbour of each vertex [n + 1], the neighbours, and the squared length of the edge to each.
@group(0) @binding(1) var<storage, read> offsets: array<u32>;
@group(0) @binding(2) var<storage, read> neighbours: array<u32>;
@group(0) @binding(3) var<storage, read> squares: array<f32>;
// [1]
@group(0) @binding(4) var<storage, read> share: array<f32>;
// [n, 3]
@group(0) @binding(5) var<storage, read> current: array<f32>;
// Before the step before [n, 3]; written.
@group(0) @binding(6) var<storage, read_write> other: array<f32>;

fn position(i: u32) -> vec3<f32> {
    return vec3(current[3u * i], current[3u * i + 1u], current[3u * i + 2u]);
}

@compute @workgroup_size(64)
fn polish(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if (i >= params.vertices) {
        return;
    }
    let at = position(i);
    var sum = vec3(0.0);
    for (var k = offsets[i]; k < offsets[i + 1u]; k++) {
        let along = position(neighbours[k]) - at;
        sum += along * (0.5 - squares[k] / (dot(along, along) + squares[k]));
    }
    // What was there before the first step, which has no momentum, may be anything.
    let before = vec3(other[3u * i], other[3u * i + 1u], other[3u * i + 2u]);
    let on = select(vec3(0.0), (at - before) * params.momentum, params.momentum > 0.0);
    let mean = sum * (params.rate / f32(max(offsets[i + 1u] - offsets[i], 1u)));
    let moved = at + (mean + on) * share[0];
    other[3u * i] = moved.x;
    other[3u * i + 1u] = moved.y;
    other[3u * i + 2u] = moved.z;
}
