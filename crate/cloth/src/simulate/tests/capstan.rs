//! A loaded strip over half a turn of a cylinder: friction holds a ratio of weights up to `e^(μπ)`. simulation.md §3.4.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use glam::DVec3;

use super::scene::{down, rigid, strip};
use crate::simulate::cloth::Cloth;
use crate::simulate::collider::Collider;
use crate::simulate::material::{GRAVITY, Material};
use crate::simulate::newton::{Layout, Solver};
use crate::simulate::settings::Settings;
use ctsn_rig::Mesh;

const FRICTION: f64 = 0.3;
/// Radius of the cylinder, and length of the strip that hangs down on either side, metres.
const RADIUS: f64 = 0.1;
const HANGING: f64 = 0.15;

/// Closed cylinder of [`RADIUS`] along z, from -0.1 to 0.2 m.
fn cylinder() -> Mesh {
    let around = 180;
    let at = |i: u32, z: f64| {
        let (sine, cosine) = (f64::from(i) * TAU / f64::from(around)).sin_cos();
        DVec3::new(RADIUS * cosine, RADIUS * sine, z)
    };
    let ends = [-0.1, 0.2];
    let mut positions: Vec<DVec3> = ends.iter().flat_map(|z| (0..around).map(move |i| at(i, *z))).collect();
    positions.extend(ends.map(|z| DVec3::Z * z));
    let [near, far] = [2 * around, 2 * around + 1];
    let side = |i: u32| {
        let [a, b] = [i, (i + 1) % around];
        [[a, b, a + around], [b, b + around, a + around], [near, b, a], [far, a + around, b + around]]
    };
    Mesh { positions, triangles: (0..around).flat_map(side).collect() }
}

/// Metres that the strip slips in 40 iterations of h = 0.1 s, after settling, with weights of that ratio at its ends.
fn slip(ratio: f64) -> f64 {
    let (edge, rows, pull) = (0.01, 3, 10.0);
    let half = PI / 2.0 * RADIUS + HANGING;
    let columns = (2.0 * half / edge) as usize;
    let mut mesh = strip(columns, rows, edge);
    let width = rows as f64 * edge * 3f64.sqrt() / 2.0;
    // Almost weightless between its ends, for the formula knows no weight there; as stiff against contact as cloth.
    let material = Material { friction: FRICTION, ..Material::isotropic(0.005, 20_000.0, 0.0, 1e-9) };
    let settings = Settings { reach: 10.0, contact_stiffness: 4e7, ..Settings::default() };
    let mut cloth = Cloth::new(&mesh, &down(&mesh), &material, 0.0).unwrap();
    for row in 0..=rows {
        let share = if row == 0 || row == rows { 0.5 } else { 1.0 } / rows as f64;
        let first = row * (columns + 1);
        cloth.elastic.masses[first] += share * pull * width / GRAVITY;
        cloth.elastic.masses[first + columns] += share * ratio * pull * width / GRAVITY;
    }
    let radius = RADIUS + settings.thickness;
    let wrap = |p: &DVec3| {
        let along = p.x - half;
        let angle = (along / radius).clamp(-PI / 2.0, PI / 2.0);
        let hanging = along.abs() - angle.abs() * radius;
        DVec3::new(radius * angle.sin(), radius * angle.cos() - hanging, p.z)
    };
    let start: Vec<DVec3> = mesh.positions.iter().map(wrap).collect();
    mesh.positions.clone_from(&start);
    let post = rigid(cylinder());
    let collider = Collider::new(&post, &post.body, &mesh, settings.reach).unwrap();
    let body = collider.pose(&[glam::DAffine3::IDENTITY]);
    let layout = Arc::new(Layout::new(&cloth, &[]).unwrap());
    let mut solver = Solver::new(&cloth, &layout, &settings, start);
    let mut settled = Vec::new();
    for iteration in 0..140 {
        if iteration == 100 {
            settled = solver.positions.clone();
        }
        solver.probe(Some(&body), 0.1);
        solver.advance(0.1);
    }
    settled.iter().zip(&solver.positions).map(|(a, b)| a.distance(*b)).sum::<f64>() / settled.len() as f64
}

#[test]
fn friction_on_a_cylinder_holds_the_ratio_of_the_capstan() {
    let critical = (FRICTION * PI).exp();
    let (below, above) = (slip(0.95 * critical), slip(1.05 * critical));
    eprintln!(
        "capstan, ratio {critical:.3}: {:.3} mm at {:.3}, {:.1} mm at {:.3}",
        1e3 * below,
        0.95 * critical,
        1e3 * above,
        1.05 * critical
    );
    assert!(below < 1e-4, "slips {below} m below the critical ratio");
    assert!(above > 5e-3, "moves only {above} m above the critical ratio");
}
