// ĥ_i = concat_c Σ_j α_ij (v_c + ε_c), α = softmax_j(q_c · (k_c + ε_c) / √d), then gate.wgsl. network.md §3.
// Twin: crate/core/src/cpu/network/attend.rs
// One workgroup per vertex, `lanes` invocations per head; neighbours in blocks, with a running softmax, of any degree.

struct Params {
    vertices: u32,
    features: u32,
    // Numbers from one row of output to the next: features, padded to whole vec4.
    stride: u32,
    heads: u32,
    // Invocations per head: a power of two, at most SIZE.
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

const SIZE = 64u;
const BLOCK = 8u;
// Features of a vertex: the less room, the more vertices at a time.
override room: u32 = 2048;
var<workgroup> sums: array<f32, SIZE * BLOCK>;
var<workgroup> attended: array<f32, room>;

// Sums over groups of `lanes` invocations, left in the group's first place.
fn reduce(t: u32, lanes: u32, blocks: u32) {
    for (var half = lanes / 2u; half > 0u; half /= 2u) {
        workgroupBarrier();
        if (t % lanes < half) {
            for (var e = 0u; e < blocks; e++) {
                sums[e * SIZE + t] += sums[e * SIZE + t + half];
            }
        }
    }
    workgroupBarrier();
}

// The sum of `value` over the workgroup.
fn total(t: u32, value: f32) -> f32 {
    workgroupBarrier();
    sums[t] = value;
    reduce(t, SIZE, 1u);
    return sums[0];
}

// One head's attention for vertex i: features `first`, and every `lanes`th after it, below `end`.
fn attention(i: u32, t: u32, first: u32, end: u32) {
    let group = t / params.lanes * params.lanes;
    for (var f = first; f < end; f += params.lanes) {
        attended[f] = 0.0;
    }
    var largest = -1e30;
    var sum = 0.0;
    for (var start = offsets[i]; start < offsets[i + 1u]; start += BLOCK) {
        let count = min(BLOCK, offsets[i + 1u] - start);
        for (var e = 0u; e < count; e++) {
            let j = neighbours[start + e];
            let edge = edge_of(i, j);
            var product = 0.0;
            for (var f = first; f < end; f += params.lanes) {
                product += projected[4u * i * params.features + f] * with_edge(1u, j, f, edge);
            }
            sums[e * SIZE + t] = product * params.scale;
        }
        reduce(t, params.lanes, count);
        let before = largest;
        for (var e = 0u; e < count; e++) {
            largest = max(largest, sums[e * SIZE + group]);
        }
        let shrink = exp(before - largest);
        sum *= shrink;
        for (var f = first; f < end; f += params.lanes) {
            attended[f] *= shrink;
        }
        for (var e = 0u; e < count; e++) {
            let j = neighbours[start + e];
            let edge = edge_of(i, j);
            let weight = exp(sums[e * SIZE + group] - largest);
            sum += weight;
            for (var f = first; f < end; f += params.lanes) {
                attended[f] += weight * with_edge(2u, j, f, edge);
            }
        }
        workgroupBarrier();
    }
    for (var f = first; f < end && sum > 0.0; f += params.lanes) {
        attended[f] /= sum;
    }
}

@compute @workgroup_size(SIZE)
fn attend(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) t: u32,
) {
    let i = group.y * groups.x + group.x;
    if (i >= params.vertices) {
        return;
    }
    let d = params.features / params.heads;
    for (var before = 0u; before < params.heads; before += SIZE / params.lanes) {
        let head = before + t / params.lanes;
        let first = select(params.features, head * d + t % params.lanes, head < params.heads);
        attention(i, t, first, min((head + 1u) * d, params.features));
    }
    workgroupBarrier();
    gate(i, t, 0u);
}
