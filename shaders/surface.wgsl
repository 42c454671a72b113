// The drawn surface: every drawn vertex has the position and normal of its cloth vertex. Twin:
// crate/core/src/cpu/network/surface.rs

struct Params {
    // d
    drawn: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// Drawn vertex -> cloth vertex [d].
@group(0) @binding(1) var<storage, read> vertex: array<u32>;
// [n, 3]
@group(0) @binding(2) var<storage, read> positions: array<f32>;
// [n, 3]
@group(0) @binding(3) var<storage, read> normals: array<f32>;
// [d, 3]
@group(0) @binding(4) var<storage, read_write> drawn_positions: array<f32>;
// [d, 3]
@group(0) @binding(5) var<storage, read_write> drawn_normals: array<f32>;

@compute @workgroup_size(64)
fn surface(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.drawn) {
        return;
    }
    let i = 3u * vertex[id.x];
    for (var c = 0u; c < 3u; c++) {
        drawn_positions[3u * id.x + c] = positions[i + c];
        drawn_normals[3u * id.x + c] = normals[i + c];
    }
}
