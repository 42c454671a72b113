//! Spheres for bodies.

/// Radius of [`sphere`], metres.
pub const RADIUS: f32 = 0.05;
/// Its vertices around.
pub const AROUND: u32 = 24;
/// Its rings from pole to pole.
pub const RINGS: u32 = 13;

/// A sphere as a closed mesh: positions [b, 3], triangles.
pub fn sphere() -> (Vec<f32>, Vec<u32>) {
    sphere_of(RADIUS, AROUND, RINGS)
}

/// The same of this radius, with so many vertices around and rings from pole to pole.
pub fn sphere_of(radius: f32, around: u32, rings: u32) -> (Vec<f32>, Vec<u32>) {
    let ring = |row: u32| {
        let polar = std::f32::consts::PI * row as f32 / rings as f32;
        (0..around).flat_map(move |i| {
            let angle = std::f32::consts::TAU * i as f32 / around as f32;
            [polar.sin() * angle.cos(), polar.cos(), polar.sin() * angle.sin()].map(|c| c * radius)
        })
    };
    let mut positions = vec![0.0, radius, 0.0, 0.0, -radius, 0.0];
    positions.extend((1..rings).flat_map(ring));
    let at = |row: u32, i: u32| 2 + (row - 1) * around + i % around;
    let mut triangles = Vec::new();
    for i in 0..around {
        triangles.extend([0, at(1, i + 1), at(1, i), 1, at(rings - 1, i), at(rings - 1, i + 1)]);
        for row in 1..rings - 1 {
            let [a, b, c, d] = [at(row, i), at(row, i + 1), at(row + 1, i), at(row + 1, i + 1)];
            triangles.extend([a, b, c, b, d, c]);
        }
    }
    (positions, triangles)
}
