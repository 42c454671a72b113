// h⁰ = (V - mean) / std and the edge potentials [V ; T_C] / edge_scale. network.md §3. Twin:
// crate/core/src/cpu/network/features.rs

struct Params {
    mean: vec3<f32>,
    edge_scale: f32,
    deviation: vec3<f32>,
    vertices: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// [n, 3]
@group(0) @binding(1) var<storage, read> v: array<f32>;
// [n, 3]
@group(0) @binding(2) var<storage, read> rest: array<f32>;
// [n], the last number 0
@group(0) @binding(3) var<storage, read_write> nodes: array<vec4<f32>>;
// [n, 2]: V, T_C, the last number of each 0
@group(0) @binding(4) var<storage, read_write> potentials: array<vec4<f32>>;

@compute @workgroup_size(64)
fn features(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if (i >= params.vertices) {
        return;
    }
    let reference = vec3(v[3u * i], v[3u * i + 1u], v[3u * i + 2u]);
    let canonical = vec3(rest[3u * i], rest[3u * i + 1u], rest[3u * i + 2u]);
    nodes[i] = vec4((reference - params.mean) / params.deviation, 0.0);
    potentials[2u * i] = vec4(reference / params.edge_scale, 0.0);
    potentials[2u * i + 1u] = vec4(canonical / params.edge_scale, 0.0);
}
