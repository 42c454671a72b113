// y = act(W x + b) of a single row: the inputs are dealt to 32 slices, whose sums meet in workgroup memory.
// network.md §2. Twin: crate/core/src/cpu/network/linear.rs

struct Params {
    rows: u32,
    // Lengths in vec4: both are padded with zeros.
    inputs: u32,
    outputs: u32,
    relu: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// [inputs]
@group(0) @binding(1) var<storage, read> x: array<vec4<f32>>;
// Wᵀ [4 · inputs, outputs]
@group(0) @binding(2) var<storage, read> weight: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> bias: array<vec4<f32>>;
// [outputs]
@group(0) @binding(4) var<storage, read_write> y: array<vec4<f32>>;

const COLUMNS = 8u;
const SLICES = 32u;

var<workgroup> sums: array<vec4<f32>, COLUMNS * SLICES>;

@compute @workgroup_size(COLUMNS, SLICES)
fn linear(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_id) local: vec3<u32>) {
    let column = group.x * COLUMNS + local.x;
    let own = local.y * COLUMNS + local.x;
    var sum = vec4(0.0);
    if (column < params.outputs) {
        for (var i = local.y; i < params.inputs; i += SLICES) {
            let at = 4u * i * params.outputs + column;
            let v = x[i];
            sum = fma(vec4(v.x), weight[at], sum);
            sum = fma(vec4(v.y), weight[at + params.outputs], sum);
            sum = fma(vec4(v.z), weight[at + 2u * params.outputs], sum);
            sum = fma(vec4(v.w), weight[at + 3u * params.outputs], sum);
        }
    }
    sums[own] = sum;
    for (var half = SLICES / 2u; half > 0u; half /= 2u) {
        workgroupBarrier();
        if (local.y < half) {
            sums[own] += sums[own + half * COLUMNS];
        }
    }
    if (local.y == 0u && column < params.outputs) {
        let total = sums[own] + bias[column];
        y[column] = select(total, max(total, vec4(0.0)), params.relu == 1u);
    }
}
