//! Where a shell stops: regions of space, half-spaces joined with rounded corners. simulation.md §4.2.

use glam::DVec3;

/// A plane; the side its normal points to is past it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane {
    /// A point of it, metres.
    pub point: DVec3,
    /// Unit normal.
    pub normal: DVec3,
}

/// A shell stops where its region begins.
#[derive(Clone, Debug)]
pub(crate) struct Region {
    /// Past all planes of any group.
    pub groups: Vec<Vec<Plane>>,
    /// Radius of the corners, metres.
    pub rounding: f64,
    /// A point near the part of the shell that falls away, metres.
    pub end: DVec3,
}

impl Plane {
    /// Signed distance past the plane, metres.
    pub fn past(&self, point: DVec3) -> f64 {
        (point - self.point).dot(self.normal)
    }

    /// The plane moved along its normal, metres.
    pub fn moved(self, by: f64) -> Plane {
        Plane { point: self.point + self.normal * by, ..self }
    }
}

impl Region {
    /// Signed distance into the region, metres.
    pub fn past(&self, point: DVec3) -> f64 {
        let least = |group: &Vec<Plane>| -smooth_max(group.iter().map(|plane| -plane.past(point)), self.rounding);
        smooth_max(self.groups.iter().map(least), self.rounding)
    }

    /// The point moved onto the region's border by one Newton step.
    pub fn project(&self, point: DVec3) -> DVec3 {
        const STEP: f64 = 1e-6;
        let slope = |axis: DVec3| (self.past(point + axis * STEP) - self.past(point - axis * STEP)) / (2.0 * STEP);
        let gradient = DVec3::from_array(DVec3::AXES.map(slope));
        point - gradient * (self.past(point) / gradient.length_squared().max(0.1))
    }
}

/// Maximum with corners rounded over the given radius. Quilez, polynomial smooth minimum.
fn smooth_max(values: impl Iterator<Item = f64>, radius: f64) -> f64 {
    let join = |a: f64, b: f64| {
        let h = (radius - (a - b).abs()).max(0.0);
        a.max(b) + h * h / (4.0 * radius)
    };
    values.reduce(join).unwrap_or(f64::NEG_INFINITY)
}
