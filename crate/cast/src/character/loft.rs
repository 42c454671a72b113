//! Lofts: q(p) = |(x/a(t), y/b(t))|_e with half-axes a, b splined along a chord; body = smooth union of lofts.
//! Parallel sections keep the field smooth over a whole limb: abutting cones left lumps at elbows and knees.

use crate::motion::curve::smoothstep;
use glam::{DMat3, DVec3};

/// One cross-section of a loft, all in metres. `side`, `front` and `back` are half-axes about the section's centre.
#[derive(Clone, Copy, Debug)]
pub struct Section {
    /// Distance from the chord's start along the chord.
    pub at: f64,
    /// Centre's offset from the chord along the front axis.
    pub centre: f64,
    /// Half width along the side axis.
    pub side: f64,
    /// Half depth along the front axis.
    pub front: f64,
    /// Half depth against the front axis.
    pub back: f64,
}

/// What a loft does to the lofts before it in its shell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Role {
    /// Smooth union.
    Join,
    /// Smooth difference: eye sockets, the line between lips.
    Carve,
    /// Leaves the shape and colours what lies within.
    Paint,
}

/// One primitive of a body: elliptic sections lofted along a straight chord, closed by rounded caps.
#[derive(Clone, Debug)]
pub struct Loft {
    /// Where the chord starts, metres.
    pub start: DVec3,
    /// Columns: side, front, along the chord. Orthonormal, right-handed.
    pub axes: DMat3,
    /// Sections in order along the chord.
    pub sections: Vec<Section>,
    /// Slopes of `side, front, back, centre` per section: the clamped C² cubic spline.
    slopes: Vec<[f64; 4]>,
    /// Corners of a box that holds the loft, metres.
    pub bounds: [DVec3; 2],
    /// Length of the cap before the first and beyond the last section, metres.
    pub caps: [f64; 2],
    /// Superellipse exponent of the sections: 2 is an ellipse, more is squarer.
    pub exponent: f64,
    /// What it does to what comes before it in the table.
    pub role: Role,
    /// Radius of the smooth union with what comes before it in the table, metres.
    pub blend: f64,
    /// Number of the closed mesh it belongs to, 0 the body.
    pub shell: usize,
    /// Linear RGB.
    pub colour: [f32; 3],
    /// Wanted edge length of the mesh on it, metres.
    pub edge: f64,
    /// Joints along it: (joint, where its influence begins along the chord, half width of that transition), metres.
    pub joints: Vec<(usize, f64, f64)>,
}

impl Loft {
    /// A loft from `start` along `direction` whose front axis is as near `front` as the direction allows.
    pub fn new(start: DVec3, direction: DVec3, front: DVec3, sections: Vec<Section>, caps: [f64; 2]) -> Loft {
        let along = direction.normalize();
        let front = front.reject_from_normalized(along).normalize();
        let slopes = clamped_slopes(&sections);
        let axes = DMat3::from_cols(front.cross(along), front, along);
        Loft {
            start,
            axes,
            sections,
            slopes,
            bounds: [start; 2],
            caps,
            exponent: 2.0,
            role: Role::Join,
            blend: 0.03,
            shell: 0,
            colour: [1.0; 3],
            edge: 0.02,
            joints: vec![],
        }
        .enclose()
    }

    /// First-order estimate of the signed distance of `p`, metres, negative inside.
    pub fn distance(&self, p: DVec3) -> f64 {
        let local = self.axes.transpose() * (p - self.start);
        let (s, excess, cap) = self.along(local.z);
        let [side, front, back, centre] = self.half_axes(s);
        let y = local.y - centre;
        let (x, depth, y) = (local.x.abs(), if y > 0.0 { front } else { back }, y.abs());
        let n = self.exponent;
        let (u, v) = (x / side, y / depth);
        let q = if n == 2.0 { u.hypot(v) } else { (u.powf(n) + v.powf(n)).powf(1.0 / n) };
        let w = excess / cap;
        let power = |share: f64| if n == 2.0 { share } else { share.powf(n - 1.0) };
        let radial = if q > 1e-9 { (power(u / q) / side).hypot(power(v / q) / depth) } else { 0.0 };
        let total = q.hypot(w);
        if total < 1e-9 {
            return -side.min(depth);
        }
        let slope = (q * radial).hypot(w / cap) / total;
        (total - 1.0) / slope.max(0.5 / side.max(depth))
    }

    /// Chord coordinate of the nearest section, distance beyond the ends, and that end's cap length.
    fn along(&self, z: f64) -> (f64, f64, f64) {
        let (first, last) = (self.sections[0].at, self.sections[self.sections.len() - 1].at);
        let s = z.clamp(first, last);
        (s, (z - s).abs(), if z < s { self.caps[0] } else { self.caps[1] })
    }

    /// `side, front, back, centre` at chord coordinate `s` within the sections.
    fn half_axes(&self, s: f64) -> [f64; 4] {
        let next = self.sections.partition_point(|section| section.at <= s).clamp(1, self.sections.len() - 1);
        let (a, b) = (&self.sections[next - 1], &self.sections[next]);
        let length = b.at - a.at;
        let t = (s - a.at) / length;
        let (h00, h10) = ((1.0 + 2.0 * t) * (1.0 - t) * (1.0 - t), t * (1.0 - t) * (1.0 - t) * length);
        let (h01, h11) = (t * t * (3.0 - 2.0 * t), t * t * (t - 1.0) * length);
        let (va, vb, ma, mb) = (a.values(), b.values(), self.slopes[next - 1], self.slopes[next]);
        std::array::from_fn(|i| h00 * va[i] + h10 * ma[i] + h01 * vb[i] + h11 * mb[i])
    }

    fn enclose(mut self) -> Loft {
        let reach = |s: &Section| s.side.max(s.front.max(s.back) + s.centre.abs()) * 1.1;
        let radius = self.sections.iter().map(reach).fold(0.0, f64::max);
        let (first, last) =
            (self.sections[0].at - self.caps[0], self.sections[self.sections.len() - 1].at + self.caps[1]);
        let (a, b) = (self.start + self.axes.z_axis * first, self.start + self.axes.z_axis * last);
        self.bounds = [a.min(b) - radius, a.max(b) + radius];
        self
    }

    /// Whether the smooth union near the surface can feel the loft at `p`.
    pub fn near(&self, p: DVec3) -> bool {
        let [low, high] = self.bounds;
        let band = self.blend + 0.01;
        p.cmpge(low - band).all() && p.cmple(high + band).all()
    }

    /// Influence of each of its joints at `p`: a partition of unity along the chord.
    pub fn influence(&self, p: DVec3) -> impl Iterator<Item = (usize, f64)> {
        let s = self.axes.z_axis.dot(p - self.start);
        let begun = move |&(_, at, half): &(usize, f64, f64)| smoothstep((s - at + half) / (2.0 * half));
        self.joints.iter().enumerate().map(move |(i, entry)| {
            let from = if i == 0 { 1.0 } else { begun(entry) };
            (entry.0, from * (1.0 - self.joints.get(i + 1).map_or(0.0, begun)))
        })
    }

    /// The same loft on the other side of the plane x = 0. `other` maps each joint to its mirror image.
    pub fn mirrored(&self, other: impl Fn(usize) -> usize) -> Loft {
        let flip = |v: DVec3| DVec3::new(-v.x, v.y, v.z);
        let [side, front, along] = [self.axes.x_axis, self.axes.y_axis, self.axes.z_axis].map(flip);
        // Sections are symmetric about their front axis, so turning the side axis keeps the shape and the handedness.
        Loft {
            start: flip(self.start),
            axes: DMat3::from_cols(-side, front, along),
            joints: self.joints.iter().map(|&(joint, at, half)| (other(joint), at, half)).collect(),
            ..self.clone()
        }
        .enclose()
    }
}

impl Section {
    fn values(&self) -> [f64; 4] {
        [self.side, self.front, self.back, self.centre]
    }
}

/// Slopes of the C² cubic spline through the sections with zero slope at both ends (Thomas algorithm).
fn clamped_slopes(sections: &[Section]) -> Vec<[f64; 4]> {
    let n = sections.len();
    let mut slopes = vec![[0.0; 4]; n];
    let mut carried = vec![0.0; n];
    for i in 1..n.saturating_sub(1) {
        let (h0, h1) = (sections[i].at - sections[i - 1].at, sections[i + 1].at - sections[i].at);
        let (a, b, c) = (sections[i - 1].values(), sections[i].values(), sections[i + 1].values());
        let (lower, upper) = (1.0 / h0, 1.0 / h1);
        let pivot = 2.0 * (lower + upper) - lower * carried[i - 1];
        carried[i] = upper / pivot;
        for j in 0..4 {
            let right = 3.0 * ((b[j] - a[j]) / (h0 * h0) + (c[j] - b[j]) / (h1 * h1));
            slopes[i][j] = (right - lower * slopes[i - 1][j]) / pivot;
        }
    }
    for i in (1..n.saturating_sub(1)).rev() {
        for j in 0..4 {
            slopes[i][j] -= carried[i] * slopes[i + 1][j];
        }
    }
    slopes
}

/// Smooth minimum with blend radius `k`, metres: equal to min where |a - b| ≥ k.
pub fn smooth_min(a: f64, b: f64, k: f64) -> f64 {
    let h = (k - (a - b).abs()).max(0.0) / k;
    a.min(b) - h * h * h * k / 6.0
}

/// Signed distance estimate of the smooth union and difference of `lofts` at `p`, metres, negative inside;
/// infinite where no loft is near.
pub fn distance(lofts: &[Loft], p: DVec3) -> f64 {
    lofts.iter().filter(|loft| loft.near(p)).fold(f64::INFINITY, |union, loft| join(union, loft, p))
}

/// `union` with one more loft.
pub fn join(union: f64, loft: &Loft, p: DVec3) -> f64 {
    match loft.role {
        Role::Join if union == f64::INFINITY => loft.distance(p),
        Role::Join => smooth_min(union, loft.distance(p), loft.blend),
        Role::Carve if union != f64::INFINITY => -smooth_min(-union, loft.distance(p), loft.blend),
        Role::Carve | Role::Paint => union,
    }
}

/// Gradient of [`distance`] by central differences of step 0.1 mm.
pub fn gradient(lofts: &[Loft], p: DVec3) -> DVec3 {
    const STEP: f64 = 1e-4;
    let along = |axis: DVec3| distance(lofts, p + axis * STEP) - distance(lofts, p - axis * STEP);
    DVec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z)) / (2.0 * STEP)
}

/// The nearest surface point in a few Newton steps along the gradient, each at most 10 mm.
pub fn project(lofts: &[Loft], start: DVec3) -> DVec3 {
    let mut p = start;
    for _ in 0..4 {
        let (value, slope) = (distance(lofts, p), gradient(lofts, p));
        let length = slope.length_squared();
        if !value.is_finite() || !length.is_finite() || length < 1e-6 || value.abs() < 1e-7 {
            break;
        }
        p -= (slope * (value / length)).clamp_length_max(0.01);
    }
    p
}
