// x_i += δ_i. Twin: crate/core/src/cpu/lift.rs

struct Params {
    numbers: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// [3n]
@group(0) @binding(1) var<storage, read> displacement: array<f32>;
@group(0) @binding(2) var<storage, read_write> positions: array<f32>;

@compute @workgroup_size(64)
fn lift(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x < params.numbers) {
        positions[id.x] += displacement[id.x];
    }
}
