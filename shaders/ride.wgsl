// The drawn mesh on the cloth: x = Σ_k b_k p_k + o n, n the unit normal between those of the three corners.
// network.md §5. Twin: crate/core/src/cpu/network/ride.rs

struct Params {
    // w
    riders: u32,
    // Normals that nearly cancel out have no direction between them.
    least: f32,
}

@group(0) @binding(0) var<uniform> params: Params;
// [w, 3]
@group(0) @binding(1) var<storage, read> corners: array<u32>;
// Barycentric coordinates, then the offset [w, 4].
@group(0) @binding(2) var<storage, read> coordinates: array<vec4<f32>>;
// [n, 3]
@group(0) @binding(3) var<storage, read> positions: array<f32>;
// [n, 3]
@group(0) @binding(4) var<storage, read> normals: array<f32>;
// [w, 3]
@group(0) @binding(5) var<storage, read_write> riders: array<f32>;

@compute @workgroup_size(64)
fn ride(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.riders) {
        return;
    }
    let place = coordinates[id.x];
    var foot = vec3(0.0);
    var normal = vec3(0.0);
    for (var k = 0u; k < 3u; k++) {
        let i = 3u * corners[3u * id.x + k];
        foot += place[k] * vec3(positions[i], positions[i + 1u], positions[i + 2u]);
        normal += place[k] * vec3(normals[i], normals[i + 1u], normals[i + 2u]);
    }
    let size = length(normal);
    let along = select(0.0, place.w / size, size > params.least);
    let rider = foot + along * normal;
    for (var c = 0u; c < 3u; c++) {
        riders[3u * id.x + c] = rider[c];
    }
}
