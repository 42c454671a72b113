// How far cloth vertices must move to lie outside the posed body. The closest body point is searched by walking over the body's
// surface from a few seeds. Twin: crate/core/src/cpu/collide.rs

// [n, 3]
@group(0) @binding(6) var<storage, read> positions: array<f32>;
@group(0) @binding(7) var<storage, read_write> push: array<f32>;

// The nearest landmark and its squared distance.
fn nearest_landmark(point: vec3<f32>) -> Place {
    var best = Place(0u, 3.4e38);
    for (var vertex = 0u; vertex < params.landmarks; vertex++) {
        best = closer(best, vertex, point);
    }
    return best;
}

@compute @workgroup_size(64)
fn collide(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if (i >= params.vertices) {
        return;
    }
    let point = vec3(positions[3u * i], positions[3u * i + 1u], positions[3u * i + 2u]);
    var by = around(point, walk(point, nearest_own(i, point)));
    let other = other_seed(i);
    var start = closer(Place(other, 3.4e38), other, point);
    // Where the cloth comes near another part of the body than its own, the nearer part decides. So it does where cloth hangs free.
    let free = by.w > params.free * params.free;
    if (free) {
        let landmark = nearest_landmark(point);
        if (landmark.squared < start.squared) {
            start = landmark;
        }
    }
    if (free || (other != seeds_of[i] && !is_elsewhere(start.squared, by.w))) {
        let second = around(point, walk(point, start));
        by = select(by, second, second.w < by.w);
    }
    push[3u * i] = by.x;
    push[3u * i + 1u] = by.y;
    push[3u * i + 2u] = by.z;
}
