// What attend.wgsl computes, by one invocation per vertex without any barrier: for software adapters. network.md §3.
// Twin: crate/core/src/cpu/network/attend.rs

struct Params {
    vertices: u32,
    features: u32,
    // Numbers from one row of output to the next: features, padded to whole vec4.
    stride: u32,
    heads: u32,
    // Of no use here.
    lanes: u32,
    // 1 / √d
    scale: f32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> offsets: array<u32>;
@group(0) @binding(2) var<storage, read> neighbours: array<u32>;
// q | k | v | r [n, 4F]
@group(0) @binding(3) var<storage, read> projected: array<f32>;
// [n, 2]
@group(0) @binding(4) var<storage, read> potentials: array<vec4<f32>>;
// Per feature: W_e of V and LayerNorm's weight; W_e of T_C and LayerNorm's bias; w_g of ĥ, r and ĥ - r.
@group(0) @binding(5) var<storage, read> weights: array<vec4<f32>>;
// h [n, stride]
@group(0) @binding(6) var<storage, read_write> output: array<f32>;
// ĥ [n, F]
@group(0) @binding(7) var<storage, read_write> attended: array<f32>;

const SIZE = 1u;

// The sum of `value` over the one invocation there is.
fn total(t: u32, value: f32) -> f32 {
    return value;
}

// One head's attention for vertex i: features from `first` to below `end`.
fn attention(i: u32, first: u32, end: u32) {
    let own = i * params.features;
    var largest = -1e30;
    var sum = 0.0;
    for (var f = first; f < end; f++) {
        attended[own + f] = 0.0;
    }
    for (var at = offsets[i]; at < offsets[i + 1u]; at++) {
        let j = neighbours[at];
        let edge = edge_of(i, j);
        var score = 0.0;
        for (var f = first; f < end; f++) {
            score += projected[4u * own + f] * with_edge(1u, j, f, edge);
        }
        score *= params.scale;
        let highest = max(largest, score);
        let shrink = exp(largest - highest);
        let weight = exp(score - highest);
        largest = highest;
        sum = sum * shrink + weight;
        for (var f = first; f < end; f++) {
            attended[own + f] = attended[own + f] * shrink + weight * with_edge(2u, j, f, edge);
        }
    }
    for (var f = first; f < end && sum > 0.0; f++) {
        attended[own + f] /= sum;
    }
}

@compute @workgroup_size(64)
fn attend(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.vertices) {
        return;
    }
    let d = params.features / params.heads;
    for (var head = 0u; head < params.heads; head++) {
        attention(id.x, head * d, (head + 1u) * d);
    }
    gate(id.x, 0u, id.x * params.features);
}
