//! A patch of cloth on an inclined plane: sticks below `atan μ`, without creep, and slides above. simulation.md §3.4.

use std::sync::Arc;

use glam::{DMat3, DVec3};

use super::scene::{down, rigid, strip};
use crate::simulate::cloth::Cloth;
use crate::simulate::collider::Collider;
use crate::simulate::material::Material;
use crate::simulate::newton::{Layout, Solver};
use crate::simulate::settings::Settings;
use ctsn_rig::Mesh;

/// Distance in metres that a patch moves on a plane tilted by `degrees` in `iterations` of h = 0.1 s, after settling.
fn slide(degrees: f64, iterations: usize) -> f64 {
    let turn = DMat3::from_rotation_z(-f64::to_radians(degrees));
    let corner = |x: f64, z: f64| turn * DVec3::new(x, 0.0, z);
    let positions = vec![corner(-3.0, -3.0), corner(-3.0, 3.0), corner(3.0, 3.0), corner(3.0, -3.0)];
    let plane = rigid(Mesh { positions, triangles: vec![[0, 1, 2], [0, 2, 3]] });
    let mut mesh = strip(6, 6, 0.02);
    mesh.positions.iter_mut().for_each(|p| *p = turn * (*p + DVec3::Y * 0.0039));
    let material = Material { friction: 0.3, ..Material::default() };
    let settings = Settings { reach: 10.0, ..Settings::default() };
    let cloth = Cloth::new(&mesh, &down(&mesh), &material, 0.0).unwrap();
    let layout = Arc::new(Layout::new(&cloth, &[]).unwrap());
    let collider = Collider::new(&plane, &plane.body, &mesh, settings.reach).unwrap();
    let body = collider.pose(&[glam::DAffine3::IDENTITY]);
    let mut solver = Solver::new(&cloth, &layout, &settings, mesh.positions.clone());
    let mut settled = Vec::new();
    for iteration in 0..iterations + 50 {
        if iteration == 50 {
            settled = solver.positions.clone();
        }
        solver.probe(Some(&body), 0.1);
        solver.advance(0.1);
    }
    let n = settled.len() as f64;
    settled.iter().zip(&solver.positions).map(|(a, b)| a.distance(*b)).sum::<f64>() / n
}

#[test]
fn sticks_below_the_critical_angle_and_slides_above() {
    let critical = 0.3f64.atan().to_degrees();
    let (below, above) = (slide(critical - 1.0, 1000), slide(critical + 1.0, 100));
    eprintln!(
        "friction, critical angle {critical:.2}°: {:.4} mm in 1000 steps 1° below, {:.1} mm in 100 steps 1° above",
        1e3 * below,
        1e3 * above
    );
    assert!(below < 1e-4, "creeps {below} m");
    assert!(above > 5e-3, "moves only {above} m");
}
