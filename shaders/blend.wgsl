// Δ[i] = Σ_j w_j B_j[i], T = rest + s·Δ. network.md §2, §3, §4. Twin: crate/core/src/cpu/network/blend.rs
// One invocation per number: consecutive ones read consecutive vec4 of the basis.

struct Params {
    // 3 · n
    numbers: u32,
    // Matrices in vec4, padded with zeros.
    count: u32,
    // vec4 from one vertex's weights to the next; 0 where all share one row.
    stride: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// [count] or [n, stride]
@group(0) @binding(1) var<storage, read> weights: array<vec4<f32>>;
// [count, numbers]
@group(0) @binding(2) var<storage, read> basis: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> rest: array<f32>;
// What the residual counts in this prediction.
@group(0) @binding(4) var<storage, read> share: array<f32>;
@group(0) @binding(5) var<storage, read_write> residual: array<f32>;
@group(0) @binding(6) var<storage, read_write> result: array<f32>;

@compute @workgroup_size(64)
fn blend(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.numbers) {
        return;
    }
    let row = id.x / 3u * params.stride;
    var sum = 0.0;
    for (var j = 0u; j < params.count; j++) {
        sum += dot(weights[row + j], basis[j * params.numbers + id.x]);
    }
    residual[id.x] = sum;
    result[id.x] = rest[id.x] + share[0] * sum;
}
