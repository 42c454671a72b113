// y = act(W x + b), rows independent. network.md §2, §3. Twin: crate/core/src/cpu/network/linear.rs
// A register tile of 8 rows × 4 columns per invocation. A tile in workgroup memory was 6 times slower on software
// adapters.

struct Params {
    rows: u32,
    // Lengths in vec4: both are padded with zeros.
    inputs: u32,
    outputs: u32,
    relu: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// [rows, inputs]
@group(0) @binding(1) var<storage, read> x: array<vec4<f32>>;
// Wᵀ [4 · inputs, outputs]
@group(0) @binding(2) var<storage, read> weight: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> bias: array<vec4<f32>>;
// [rows, outputs]
@group(0) @binding(4) var<storage, read_write> y: array<vec4<f32>>;

const ROWS = 8u;

@compute @workgroup_size(16, 4)
fn linear(@builtin(global_invocation_id) id: vec3<u32>) {
    let column = id.x;
    let first = id.y * ROWS;
    if (column >= params.outputs || first >= params.rows) {
        return;
    }
    var sums: array<vec4<f32>, ROWS>;
    for (var r = 0u; r < ROWS; r++) {
        sums[r] = bias[column];
    }
    for (var i = 0u; i < params.inputs; i++) {
        let at = 4u * i * params.outputs + column;
        let w0 = weight[at];
        let w1 = weight[at + params.outputs];
        let w2 = weight[at + 2u * params.outputs];
        let w3 = weight[at + 3u * params.outputs];
        for (var r = 0u; r < ROWS; r++) {
            let v = x[min(first + r, params.rows - 1u) * params.inputs + i];
            sums[r] = fma(vec4(v.w), w3, fma(vec4(v.z), w2, fma(vec4(v.y), w1, fma(vec4(v.x), w0, sums[r]))));
        }
    }
    for (var r = 0u; r < ROWS; r++) {
        if (first + r < params.rows) {
            let sum = select(sums[r], max(sums[r], vec4(0.0)), params.relu == 1u);
            y[(first + r) * params.outputs + column] = sum;
        }
    }
}
