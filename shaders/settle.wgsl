// x_i += δ_i, and a second look where that moved the cloth: it may have come into another part of the body, or to a place that the first
// look missed. Twin: crate/core/src/cpu/settle.rs

// [n, 3]
@group(0) @binding(6) var<storage, read> displacement: array<f32>;
@group(0) @binding(7) var<storage, read_write> positions: array<f32>;

// The displacement that brings a point to the gap, and the squared distance to the body.
fn look(i: u32, point: vec3<f32>) -> vec4<f32> {
    let place = leap(point, walk(point, nearest_own(i, point)));
    let found = widely(point, place.vertex);
    let other = other_seed(i);
    let start = closer(Place(other, 3.4e38), other, point);
    if (other == seeds_of[i] || is_elsewhere(start.squared, place.squared)) {
        return found;
    }
    let second = widely(point, leap(point, walk(point, start)).vertex);
    return select(found, second, second.w < found.w);
}

@compute @workgroup_size(64)
fn settle(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if (i >= params.vertices) {
        return;
    }
    let by = vec3(displacement[3u * i], displacement[3u * i + 1u], displacement[3u * i + 2u]);
    var moved = vec3(positions[3u * i], positions[3u * i + 1u], positions[3u * i + 2u]) + by;
    if (squared(by) > params.again * params.again) {
        moved += look(i, moved).xyz;
    }
    positions[3u * i] = moved.x;
    positions[3u * i + 1u] = moved.y;
    positions[3u * i + 2u] = moved.z;
}
