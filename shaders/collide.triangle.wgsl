// The closest point of a triangle, for collide.wgsl. Twin: crate/core/src/cpu/collide.rs

fn squared(way: vec3<f32>) -> f32 {
    return dot(way, way);
}

// Share of the way from a point along an edge to where it is closest.
fn along(offset: vec3<f32>, way: vec3<f32>) -> f32 {
    return select(0.0, clamp(dot(offset, way) / squared(way), 0.0, 1.0), squared(way) > 0.0);
}

// Barycentric coordinates of the point of triangle abc closest to the point: by areas inside, else on the nearest edge.
fn closest(point: vec3<f32>, a: vec3<f32>, b: vec3<f32>, c: vec3<f32>) -> vec3<f32> {
    let across = cross(b - a, c - a);
    if (squared(across) > 0.0) {
        let v = dot(cross(point - a, c - a), across) / squared(across);
        let w = dot(cross(b - a, point - a), across) / squared(across);
        if (v >= 0.0 && w >= 0.0 && v + w <= 1.0) {
            return vec3(1.0 - v - w, v, w);
        }
    }
    let s = along(point - a, b - a);
    let t = along(point - a, c - a);
    let u = along(point - b, c - b);
    let on = vec3(squared(point - mix(a, b, s)), squared(point - mix(a, c, t)), squared(point - mix(b, c, u)));
    let ab_or_ac = select(vec3(1.0 - s, s, 0.0), vec3(1.0 - t, 0.0, t), on.y < on.x);
    return select(ab_or_ac, vec3(0.0, 1.0 - u, u), on.z < min(on.x, on.y));
}
