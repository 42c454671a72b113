// N·A_j, N⁻¹ and the standardised pose vector γ. network.md §1. Twin: crate/core/src/cpu/network/body_frame.rs
// In f32: the hip is taken off before anything is multiplied, so that far from the origin no digits are lost.

struct Params {
    joints: u32,
    root: u32,
    // 1 where the heading is taken out too.
    yaw: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
// Rows of G_j [3 J].
@group(0) @binding(1) var<storage, read> world: array<vec4<f32>>;
// Rows of B_j⁻¹ [3 J].
@group(0) @binding(2) var<storage, read> inverse_bind: array<vec4<f32>>;
// Mean of γ, its standard deviation, the least and the greatest seen in training [4, 3 J]; where the joints are [J].
@group(0) @binding(3) var<storage, read> standard: array<vec4<f32>>;
// Rows of N·A_j, then of N⁻¹ [3 (J + 1)].
@group(0) @binding(4) var<storage, read_write> transforms: array<vec4<f32>>;
// γ [3 J].
@group(0) @binding(5) var<storage, read_write> vector: array<vec4<f32>>;

// A row of a 3×4 transform times B_j⁻¹.
fn times_bind(row: vec4<f32>, j: u32) -> vec4<f32> {
    let at = 3u * j;
    return row.x * inverse_bind[at] + row.y * inverse_bind[at + 1u] + row.z * inverse_bind[at + 2u]
        + vec4(0.0, 0.0, 0.0, row.w);
}

// Cosine and sine of the heading of A_r: its twist about +Y.
fn heading() -> vec2<f32> {
    let a0 = times_bind(world[3u * params.root], params.root);
    let a2 = times_bind(world[3u * params.root + 2u], params.root);
    let twist = vec2(a0.x + a2.z, a0.z - a2.x);
    let size = max(abs(twist.x), abs(twist.y));
    if (params.yaw == 0u || size == 0.0) {
        return vec2(1.0, 0.0);
    }
    return normalize(twist / size);
}

// Row `at` of the transforms, or the nearest one seen: by its linear part and the joint's position.
fn seen(row: vec4<f32>, at: u32, j: u32) -> vec4<f32> {
    let step = 3u * params.joints;
    let origin = standard[4u * step + j].xyz;
    let placed = vec4(row.xyz, row.w + dot(row.xyz, origin));
    let near = clamp(placed, standard[2u * step + at], standard[3u * step + at]);
    // Among the poses seen the row itself: rounded the other way round it would not come back.
    return select(vec4(near.xyz, near.w - dot(near.xyz, origin)), row, all(near == placed));
}

@compute @workgroup_size(64)
fn body_frame(@builtin(global_invocation_id) id: vec3<u32>) {
    let j = id.x;
    if (j > params.joints) {
        return;
    }
    let turn = heading();
    let root = 3u * params.root;
    let hip = vec3(world[root].w, world[root + 1u].w, world[root + 2u].w);
    let at = 3u * j;
    let step = 3u * params.joints;
    if (j == params.joints) {
        transforms[at] = vec4(turn.x, 0.0, turn.y, hip.x);
        transforms[at + 1u] = vec4(0.0, 1.0, 0.0, hip.y);
        transforms[at + 2u] = vec4(-turn.y, 0.0, turn.x, hip.z);
        return;
    }
    let g0 = world[at] - vec4(0.0, 0.0, 0.0, hip.x);
    let g1 = world[at + 1u] - vec4(0.0, 0.0, 0.0, hip.y);
    let g2 = world[at + 2u] - vec4(0.0, 0.0, 0.0, hip.z);
    let rows = array(turn.x * g0 - turn.y * g2, g1, turn.y * g0 + turn.x * g2);
    for (var r = 0u; r < 3u; r++) {
        let row = times_bind(rows[r], j);
        transforms[at + r] = row;
        vector[at + r] = (seen(row, at + r, j) - standard[at + r]) / standard[step + at + r];
    }
}
