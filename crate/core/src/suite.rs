//! The suite of the operations, for any device: made-up operands, what each operation writes by its naive definition in
//! f64, and how far from that a device may be. Every kernel's file holds the suite of its operation; a device runs them
//! all, one after the other: `cases().iter().for_each(|case| case.check(|operation| device.run(operation.lend())))`.

use crate::operation::{self, Operation};
use fastrand::Rng;

/// An operation with operands of its own.
pub type Held = Operation<Vec<f32>, Vec<f32>, Vec<u32>>;

/// What the file of each kernel says of its operation.
pub trait Suite: Into<Held> + Sized {
    /// Largest difference allowed to any number written. Beside it stands why.
    const TOLERANCE: f64;

    /// Operands at the sizes and in the situations that matter.
    fn operands(rng: &mut Rng) -> Vec<Self>;

    /// What the operation writes, by its definition, in the order of its operands; `None` of one that a device may
    /// leave as it likes.
    fn truth(&self) -> Vec<Option<Vec<f64>>>;
}

/// One trial of an operation.
pub struct Case {
    /// Operation and number of the trial.
    pub name: String,
    /// The operation, before it has run.
    pub operation: Held,
    truth: Vec<Option<Vec<f64>>>,
    tolerance: f64,
}

/// All trials of all operations, the same ones each time.
pub fn cases() -> Vec<Case> {
    operation::cases()
}

/// The trials of one operation.
pub(crate) fn of<S: Suite>(operation: &str) -> Vec<Case> {
    let case = |(i, held): (usize, S)| {
        let (name, truth) = (format!("{operation} {i}"), held.truth());
        Case { name, operation: held.into(), truth, tolerance: S::TOLERANCE }
    };
    S::operands(&mut Rng::with_seed(1)).into_iter().enumerate().map(case).collect()
}

impl Case {
    /// Runs the operation by `run` and compares all that it wrote.
    ///
    /// # Panics
    /// Names the operand that is further off than allowed. A NaN is.
    pub fn check(&self, run: impl FnOnce(&mut Held)) {
        let mut operation = self.operation.clone();
        run(&mut operation);
        let mut written = Vec::new();
        operation.map(drop, |values| written.push(values), drop);
        assert_eq!(written.len(), self.truth.len(), "{}: results", self.name);
        for (i, (found, truth)) in written.iter().zip(&self.truth).enumerate() {
            let Some(truth) = truth else { continue };
            assert_eq!(found.len(), truth.len(), "{}: numbers of result {i}", self.name);
            for (place, (found, truth)) in found.iter().zip(truth).enumerate() {
                let off = (f64::from(*found) - truth).abs();
                let (name, allowed) = (&self.name, self.tolerance);
                assert!(
                    off <= allowed,
                    "{name}: result {i}, number {place}: {found}, not {truth}: {off:e} > {allowed:e}"
                );
            }
        }
    }
}

/// Numbers uniform in ±scale.
pub fn numbers(rng: &mut Rng, count: usize, scale: f32) -> Vec<f32> {
    (0..count).map(|_| (rng.f32() * 2.0 - 1.0) * scale).collect()
}

/// The same numbers in f64.
pub fn wide(values: &[f32]) -> Vec<f64> {
    values.iter().map(|value| f64::from(*value)).collect()
}

/// Points [n, 3] in f64.
pub fn points(values: &[f32]) -> Vec<glam::DVec3> {
    wide(values).as_chunks::<3>().0.iter().map(|point| glam::DVec3::from_array(*point)).collect()
}

/// A rotation about a random axis and a place within a metre: a row-major 3×4 transform.
pub fn transform(rng: &mut Rng) -> [f32; 12] {
    let [w, x, y, z] = std::array::from_fn(|_| rng.f32() * 2.0 - 1.0 + 1e-3);
    let rows = glam::Mat3::from_quat(glam::Quat::from_xyzw(x, y, z, w).normalize()).transpose();
    let place: [f32; 3] = std::array::from_fn(|_| rng.f32() * 2.0 - 1.0);
    let [x, y, z] = [rows.x_axis, rows.y_axis, rows.z_axis];
    [x.x, x.y, x.z, place[0], y.x, y.y, y.z, place[1], z.x, z.y, z.z, place[2]]
}

/// Triangles over `n` vertices: the last has no neighbour, the one before it one, the first up to 40, the others two or
/// more.
pub fn triangles(rng: &mut Rng, n: usize) -> Vec<u32> {
    let inner = n.saturating_sub(2) as u32;
    let mut triangles: Vec<u32> = (1..inner.min(40)).flat_map(|i| [0, i, i + 1]).filter(|i| *i < inner).collect();
    triangles.truncate(triangles.len() / 3 * 3);
    (40..inner).for_each(|i| triangles.extend([i, 1 + rng.u32(..i - 1), 1 + rng.u32(..i - 1)]));
    if inner > 1 {
        triangles.extend([inner, 1, 1]);
    }
    triangles
}

/// A closed sphere around the origin, with so many vertices around and rings from pole to pole: positions [b, 3],
/// triangles.
pub fn sphere(radius: f32, around: u32, rings: u32) -> (Vec<f32>, Vec<u32>) {
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
