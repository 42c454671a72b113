// The closest point of a triangle, for collide.wgsl and settle.wgsl. Twin: crate/core/src/cpu/repair/eight.rs

fn squared(way: vec3<f32>) -> f32 {
    return dot(way, way);
}

// Share of the way along an edge to where a point is closest.
fn along(way: f32, length_squared: f32) -> f32 {
    return select(0.0, clamp(way / length_squared, 0.0, 1.0), length_squared > 0.0);
}

// The point of triangle abc closest to p, from the ways from a to p, b and c: squared distance from it less that from
// a, and its shares of b and c. Above the triangle, else on the nearest edge.
fn closest(ap: vec3<f32>, ab: vec3<f32>, ac: vec3<f32>) -> vec3<f32> {
    let bb = dot(ab, ab);
    let bc = dot(ab, ac);
    let cc = dot(ac, ac);
    let bp = dot(ab, ap);
    let cp = dot(ac, ap);
    let area = bb * cc - bc * bc;
    let b = cc * bp - bc * cp;
    let c = bb * cp - bc * bp;
    if (area > params.sliver * bb * cc && b >= 0.0 && c >= 0.0 && b + c <= area) {
        let v = b / area;
        let w = c / area;
        return vec3(v * (v * bb + 2.0 * (w * bc - bp)) + w * (w * cc - 2.0 * cp), v, w);
    }
    let s = along(bp, bb);
    let t = along(cp, cc);
    let u = along(cp - bp - bc + bb, bb - 2.0 * bc + cc);
    let r = 1.0 - u;
    let on_ab = vec3(s * (s * bb - 2.0 * bp), s, 0.0);
    let on_ac = vec3(t * (t * cc - 2.0 * cp), 0.0, t);
    let on_bc = vec3(r * (r * bb + 2.0 * (u * bc - bp)) + u * (u * cc - 2.0 * cp), r, u);
    let at_a = select(on_ab, on_ac, on_ac.x < on_ab.x);
    return select(at_a, on_bc, on_bc.x < at_a.x);
}
