//! Triangles by their corners.

use glam::DVec3;

/// The normal, twice as long as the area is large: counter-clockwise seen from its tip.
pub fn cross([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

/// Area, square metres.
pub fn area(corners: [DVec3; 3]) -> f64 {
    0.5 * cross(corners).length()
}

/// Smallest angle, degrees.
pub fn least_angle(corners: [DVec3; 3]) -> f64 {
    let angle = |k: usize| {
        let [a, b, c] = [0, 1, 2].map(|turn| corners[(k + turn) % 3]);
        (b - a).angle_between(c - a).to_degrees()
    };
    angle(0).min(angle(1)).min(angle(2))
}

/// Signed volume of the tetrahedron under it, apex at the origin: over a closed surface that faces outwards, what it
/// encloses.
pub fn volume([a, b, c]: [DVec3; 3]) -> f64 {
    a.dot(b.cross(c)) / 6.0
}

/// The point with these barycentric coordinates.
pub fn point([a, b, c]: [DVec3; 3], [u, v, w]: [f64; 3]) -> DVec3 {
    a * u + b * v + c * w
}

/// The point closest to `p`.
pub fn closest_point(p: DVec3, corners: [DVec3; 3]) -> DVec3 {
    point(corners, closest(p, corners))
}

/// Barycentric coordinates of the closest point; exact zeros on edges and corners (Ericson, Real-Time Collision
/// Detection §5.1.5).
pub fn closest(p: DVec3, [a, b, c]: [DVec3; 3]) -> [f64; 3] {
    let (ab, ac) = (b - a, c - a);
    let ap = p - a;
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let v = d1 / (d1 - d3);
        return [1.0 - v, v, 0.0];
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let w = d2 / (d2 - d6);
        return [1.0 - w, 0.0, w];
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        let w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return [0.0, 1.0 - w, w];
    }
    let scale = 1.0 / (va + vb + vc);
    let (v, w) = (vb * scale, vc * scale);
    [1.0 - v - w, v, w]
}

/// Where a line meets the plane of a triangle.
#[derive(Clone, Copy, Debug)]
pub struct Meeting {
    /// How far along the line, in its direction vector.
    pub along: f64,
    /// Barycentric coordinate of the second corner.
    pub u: f64,
    /// Of the third.
    pub v: f64,
    /// Whether the line leaves through the front.
    pub leaves: bool,
}

/// Where the line from `origin` along `direction` meets the triangle's plane; `None` where it runs along it (Möller &
/// Trumbore 1997).
pub fn meet(origin: DVec3, direction: DVec3, [a, b, c]: [DVec3; 3]) -> Option<Meeting> {
    let (ab, ac) = (b - a, c - a);
    let across = direction.cross(ac);
    let determinant = ab.dot(across);
    let from = origin - a;
    let perpendicular = from.cross(ab);
    // The determinant is minus the direction along the normal.
    (determinant != 0.0).then(|| Meeting {
        along: ac.dot(perpendicular) / determinant,
        u: from.dot(across) / determinant,
        v: direction.dot(perpendicular) / determinant,
        leaves: determinant < 0.0,
    })
}

/// Solid angle seen from `p`, steradians, positive from behind: over a closed surface 4π inside and 0 outside (van
/// Oosterom & Strackee 1983).
pub fn solid_angle(p: DVec3, corners: [DVec3; 3]) -> f64 {
    solid_angle_between(corners.map(|corner| (corner - p).normalize_or_zero()))
}

/// The same of the unit vectors towards the corners.
pub fn solid_angle_between([a, b, c]: [DVec3; 3]) -> f64 {
    2.0 * a.dot(b.cross(c)).atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a))
}
