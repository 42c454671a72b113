// One round of spreading a displacement over the cloth: every vertex follows its neighbours, and those that must move
// still reach their gap. Twin: crate/core/src/cpu/repair/spread.rs

struct Params {
    vertices: u32,
    follow: f32,
}

@group(0) @binding(0) var<uniform> params: Params;
// First neighbour of each vertex [n + 1], and the neighbours.
@group(0) @binding(1) var<storage, read> offsets: array<u32>;
@group(0) @binding(2) var<storage, read> neighbours: array<u32>;
// What each vertex needs at least [n, 3].
@group(0) @binding(3) var<storage, read> push: array<f32>;
// [n, 3]
@group(0) @binding(4) var<storage, read> before: array<f32>;
@group(0) @binding(5) var<storage, read_write> after: array<f32>;

@compute @workgroup_size(64)
fn spread(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if (i >= params.vertices) {
        return;
    }
    var sum = vec3(0.0);
    for (var k = offsets[i]; k < offsets[i + 1u]; k++) {
        let j = 3u * neighbours[k];
        sum += vec3(before[j], before[j + 1u], before[j + 2u]);
    }
    let mean = sum * (params.follow / f32(max(offsets[i + 1u] - offsets[i], 1u)));
    let needed = vec3(push[3u * i], push[3u * i + 1u], push[3u * i + 2u]);
    let squared = dot(needed, needed);
    let missing = select(0.0, max(1.0 - dot(mean, needed) / squared, 0.0), squared > 0.0);
    let by = mean + needed * missing;
    after[3u * i] = by.x;
    after[3u * i + 1u] = by.y;
    after[3u * i + 2u] = by.z;
}
