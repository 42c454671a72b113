// One round in which displaced cloth takes back the lengths it was cut to, and what must move still reaches its gap.
// Twin: crate/core/src/cpu/repair/slide.rs

struct Params {
    vertices: u32,
    rate: f32,
}

@group(0) @binding(0) var<uniform> params: Params;
// First neighbour of each vertex [n + 1], the neighbours, and the squared length of the edge to each.
@group(0) @binding(1) var<storage, read> offsets: array<u32>;
@group(0) @binding(2) var<storage, read> neighbours: array<u32>;
@group(0) @binding(3) var<storage, read> squares: array<f32>;
// [1]
@group(0) @binding(4) var<storage, read> share: array<f32>;
// [n, 3]
@group(0) @binding(5) var<storage, read> positions: array<f32>;
// What each vertex needs at least [n, 3].
@group(0) @binding(6) var<storage, read> push: array<f32>;
// [n, 3]
@group(0) @binding(7) var<storage, read> before: array<f32>;
@group(0) @binding(8) var<storage, read_write> after: array<f32>;

fn displacement(i: u32) -> vec3<f32> {
    return vec3(before[3u * i], before[3u * i + 1u], before[3u * i + 2u]);
}

fn displaced(i: u32) -> vec3<f32> {
    return vec3(positions[3u * i], positions[3u * i + 1u], positions[3u * i + 2u]) + displacement(i);
}

@compute @workgroup_size(64)
fn slide(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if (i >= params.vertices) {
        return;
    }
    let at = displaced(i);
    var sum = vec3(0.0);
    for (var k = offsets[i]; k < offsets[i + 1u]; k++) {
        let along = displaced(neighbours[k]) - at;
        sum += along * (0.5 - squares[k] / (dot(along, along) + squares[k]));
    }
    let mean = sum * (params.rate * share[0] / f32(max(offsets[i + 1u] - offsets[i], 1u)));
    let by = displacement(i) + mean;
    let needed = vec3(push[3u * i], push[3u * i + 1u], push[3u * i + 2u]);
    let squared = dot(needed, needed);
    let missing = select(0.0, max(1.0 - dot(by, needed) / squared, 0.0), squared > 0.0);
    let moved = by + needed * missing;
    after[3u * i] = moved.x;
    after[3u * i + 1u] = moved.y;
    after[3u * i + 2u] = moved.z;
}
