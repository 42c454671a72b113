// One round in which every pull is shared with the neighbours. Twin: crate/core/src/cpu/network/diffuse.rs

struct Params {
    vertices: u32,
    // Of a vertex's own pull, and of its neighbours' mean.
    own: f32,
    others: f32,
}

@group(0) @binding(0) var<uniform> params: Params;
// [n, 3]
@group(0) @binding(3) var<storage, read> pulls: array<f32>;
// [n, 3]
@group(0) @binding(4) var<storage, read_write> diffused: array<f32>;

@compute @workgroup_size(64)
fn diffuse(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if (i >= params.vertices) {
        return;
    }
    let by = diffused_pull(i);
    diffused[3u * i] = by.x;
    diffused[3u * i + 1u] = by.y;
    diffused[3u * i + 2u] = by.z;
}
