// How far each vertex is pulled by its edges towards the lengths they were cut to.
// Twin: crate/core/src/cpu/network/pull.rs

struct Params {
    vertices: u32,
    // By how much of a shared pull a vertex moves.
    rate: f32,
    // How far above the body a vertex meets it, and is kept.
    reach: f32,
    gap: f32,
}

@group(0) @binding(0) var<uniform> params: Params;
// First neighbour of each vertex [n + 1], the neighbours, and the squared length of the edge to each.
@group(0) @binding(1) var<storage, read> offsets: array<u32>;
@group(0) @binding(2) var<storage, read> neighbours: array<u32>;
@group(0) @binding(3) var<storage, read> squares: array<f32>;
// [n, 3]
@group(0) @binding(4) var<storage, read> positions: array<f32>;
// What each vertex lacks to where the body is no longer met [n, 3].
@group(0) @binding(5) var<storage, read> near: array<f32>;
// [n, 3]
@group(0) @binding(6) var<storage, read_write> pulls: array<f32>;

fn position(i: u32) -> vec3<f32> {
    return vec3(positions[3u * i], positions[3u * i + 1u], positions[3u * i + 2u]);
}

@compute @workgroup_size(64)
fn pull(@builtin(global_invocation_id) id: vec3<u32>) {
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
    var mean = sum / f32(max(offsets[i + 1u] - offsets[i], 1u));
    let lacks = vec3(near[3u * i], near[3u * i + 1u], near[3u * i + 2u]);
    let lack = length(lacks);
    if (lack > 0.0) {
        // As much of it as the vertex can follow.
        let up = lacks / lack;
        let room = max(params.reach - params.gap - lack, 0.0);
        mean += up * max(-room / params.rate - dot(mean, up), 0.0);
    }
    pulls[3u * i] = mean.x;
    pulls[3u * i + 1u] = mean.y;
    pulls[3u * i + 2u] = mean.z;
}
