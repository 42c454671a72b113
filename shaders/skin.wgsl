// Linear blend skinning x_i = Σ_j W[i,j] A_j T_i, then N⁻¹ where the world is wanted. network.md §4.
// Twin: crate/core/src/cpu/network/skin.rs

struct Params {
    vertices: u32,
    // Slots per vertex.
    width: u32,
    // First row of N⁻¹ in transforms: 3 J.
    back: u32,
    world: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// [n, 3]
@group(0) @binding(1) var<storage, read> rest: array<f32>;
// [width, n]
@group(0) @binding(2) var<storage, read> joints: array<u32>;
// [width, n]
@group(0) @binding(3) var<storage, read> weights: array<f32>;
// Rows of 3×4 transforms [3 (J + 1)].
@group(0) @binding(4) var<storage, read> transforms: array<vec4<f32>>;
// [n, 3]
@group(0) @binding(5) var<storage, read_write> positions: array<f32>;

@compute @workgroup_size(64)
fn skin(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if (i >= params.vertices) {
        return;
    }
    var rows = array(vec4(0.0), vec4(0.0), vec4(0.0));
    for (var s = 0u; s < params.width; s++) {
        let at = s * params.vertices + i;
        let weight = weights[at];
        let joint = 3u * joints[at];
        for (var r = 0u; r < 3u; r++) {
            rows[r] += weight * transforms[joint + r];
        }
    }
    var point = vec4(rest[3u * i], rest[3u * i + 1u], rest[3u * i + 2u], 1.0);
    point = vec4(dot(rows[0], point), dot(rows[1], point), dot(rows[2], point), 1.0);
    for (var r = 0u; r < 3u; r++) {
        positions[3u * i + r] = select(point[r], dot(transforms[params.back + r], point), params.world == 1u);
    }
}
