// What the mesh stream sees around each vertex of the coarse cloth: the places of 16 vertices from its own, turned back
// by its skinning, less where they are at rest. network.md §3. Twin: crate/core/src/cpu/network/surround.rs

struct Params {
    vertices: u32,
    // Slots per vertex.
    width: u32,
    // An edge that is longer or shorter by so much counts 1.
    strain: f32,
}

// Steps of the walks to the vertices around, four for each.
const STEPS = vec4(1.0, 3.0, 8.0, 20.0);
// Numbers from one vertex to the next: 54 and two of 0.
const STRIDE = 56u;

@group(0) @binding(0) var<uniform> params: Params;
// [n, 2]: X, T_C, in edges, the last number of each 0
@group(0) @binding(1) var<storage, read> potentials: array<vec4<f32>>;
// [n], the last number 0
@group(0) @binding(2) var<storage, read> places: array<vec4<f32>>;
// [width, n]
@group(0) @binding(3) var<storage, read> joints: array<u32>;
// [width, n]
@group(0) @binding(4) var<storage, read> weights: array<f32>;
// Rows of 3×4 transforms [3 (J + 1)].
@group(0) @binding(5) var<storage, read> transforms: array<vec4<f32>>;
// [n, 16]
@group(0) @binding(6) var<storage, read> around: array<u32>;
// [n, 56]
@group(0) @binding(7) var<storage, read_write> nodes: array<f32>;

@compute @workgroup_size(64)
fn surround(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if (i >= params.vertices) {
        return;
    }
    // The transposed linear part of the vertex's skinning, whose columns are rows of transforms.
    var back = mat3x3<f32>();
    for (var s = 0u; s < params.width; s++) {
        let at = s * params.vertices + i;
        let joint = 3u * joints[at];
        back += weights[at] * mat3x3(transforms[joint].xyz, transforms[joint + 1u].xyz, transforms[joint + 2u].xyz);
    }
    let node = STRIDE * i;
    for (var c = 0u; c < 3u; c++) {
        nodes[node + c] = places[i][c];
        nodes[node + 3u + c] = back[1][c];
    }
    let at = potentials[2u * i].xyz;
    let at_rest = potentials[2u * i + 1u].xyz;
    for (var a = 0u; a < 16u; a++) {
        let j = around[16u * i + a];
        let strain = back * (potentials[2u * j].xyz - at) - (potentials[2u * j + 1u].xyz - at_rest);
        let seen = strain / (params.strain * STEPS[a / 4u]);
        for (var c = 0u; c < 3u; c++) {
            nodes[node + 6u + 3u * a + c] = seen[c];
        }
    }
    nodes[node + 54u] = 0.0;
    nodes[node + 55u] = 0.0;
}
