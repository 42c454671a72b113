// x_i += δ_i, and a second look where that moved the cloth: it may have come into another part of the body, or to a
// place that the first look missed. Twin: crate/core/src/cpu/repair/settle.rs

// [n, 3]
@group(0) @binding(6) var<storage, read> displacement: array<f32>;
@group(0) @binding(7) var<storage, read_write> positions: array<f32>;

// The same walk again from the nearest neighbour of a neighbour: over a ridge, into the crease behind it.
fn leap(point: vec3<f32>, start: Place) -> Place {
    var best = start.vertex;
    var least = start.squared;
    for (var j = offsets[start.vertex]; j < offsets[start.vertex + 1u]; j++) {
        for (var k = offsets[fans[j].x]; k < offsets[fans[j].x + 1u]; k++) {
            let found = squared(point - position(fans[k].x));
            best = select(best, fans[k].x, found < least);
            least = min(least, found);
        }
    }
    return downhill(point, best, least);
}

// The closest of the triangles around a vertex; where the point is beside them, of those around its neighbours.
fn widely(point: vec3<f32>, vertex: u32) -> vec4<f32> {
    // Without a highest corner, the triangles are looked at.
    var found = push_from(point, Place(vertex, 0.0, 3.4e38));
    if (found.w == 3.4e38) {
        for (var k = offsets[vertex]; k < offsets[vertex + 1u]; k++) {
            let next = push_from(point, Place(fans[k].x, 0.0, 3.4e38));
            found = select(found, next, next.w < found.w);
        }
    }
    return found;
}

// The displacement that brings a point to the gap, and the squared distance to the body.
fn look(i: u32, point: vec3<f32>) -> vec4<f32> {
    let own = max(params.seeds - 1u, 1u);
    let place = leap(point, from_seeds(i, point, 0u, own));
    let found = widely(point, place.vertex);
    let other = other_seed(i);
    if (other == seeds_of[i] || is_elsewhere(squared(point - position(other)), place.squared)) {
        return found;
    }
    let second = widely(point, leap(point, from_seeds(i, point, own, params.seeds)).vertex);
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
