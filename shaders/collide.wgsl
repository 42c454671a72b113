// How far cloth vertices must move to lie outside the posed body. The closest body point is searched by walking over
// the body's surface from a few seeds. Twin: crate/core/src/cpu/repair/collide.rs

// [n, 3]
@group(0) @binding(6) var<storage, read> positions: array<f32>;
@group(0) @binding(7) var<storage, read_write> push: array<f32>;

// The nearest vertex downhill from the nearest landmark, or from the other seed if that is nearer.
fn from_landmarks(point: vec3<f32>, other: u32) -> Place {
    var best = other;
    var least = squared(point - position(other));
    for (var vertex = 0u; vertex < params.landmarks; vertex++) {
        let found = squared(point - position(vertex));
        best = select(best, vertex, found < least);
        least = min(least, found);
    }
    return downhill(point, best, least);
}

@compute @workgroup_size(64)
fn collide(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if (i >= params.vertices) {
        return;
    }
    let point = vec3(positions[3u * i], positions[3u * i + 1u], positions[3u * i + 2u]);
    let own = max(params.seeds - 1u, 1u);
    var by = push_from(point, from_seeds(i, point, 0u, own));
    let other = other_seed(i);
    // Where the cloth comes near another part of the body than its own, the nearer part decides. So it does where cloth
    // hangs free.
    let free = by.w > params.free * params.free;
    if (!free && other != seeds_of[i] && !is_elsewhere(squared(point - position(other)), by.w)) {
        let second = push_from(point, from_seeds(i, point, own, params.seeds));
        by = select(by, second, second.w < by.w);
    }
    if (free) {
        let second = push_from(point, from_landmarks(point, other));
        by = select(by, second, second.w < by.w);
    }
    push[3u * i] = by.x;
    push[3u * i + 1u] = by.y;
    push[3u * i + 2u] = by.z;
}
