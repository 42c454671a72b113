//! A square metre of cloth on a sphere: sorted heights against the figures of a published solver. simulation.md §1.1.
//! Heights, not lobes: where the folds fall is a bifurcation.

use std::sync::Arc;

use super::scene::{down, rigid, sheet, sphere};
use crate::simulate::cloth::Cloth;
use crate::simulate::collider::Collider;
use crate::simulate::material::Material;
use crate::simulate::newton::{Layout, Solver};
use crate::simulate::settings::Settings;

#[test]
fn sheet_on_a_sphere_hangs_as_it_should() {
    let radius = 0.3;
    let body = rigid(sphere(radius, 5));
    let mesh = sheet(40, radius + 0.004);
    let material = Material { friction: 0.3, ..Material::isotropic(0.2, 1000.0, 0.3, 2.29e-5) };
    let settings = Settings { thickness: 0.003, reach: 10.0, ..Settings::default() };
    let cloth = Cloth::new(&mesh, &down(&mesh), &material, 0.0).unwrap();
    let layout = Arc::new(Layout::new(&cloth, &[]).unwrap());
    let collider = Collider::new(&body, &body.body, &mesh, settings.reach).unwrap();
    let posed = collider.pose(&[glam::DAffine3::IDENTITY]);
    let mut solver = Solver::new(&cloth, &layout, &settings, mesh.positions.clone());
    let probe = solver.relax(Some(&posed), 600);
    let mut heights: Vec<f64> = solver.positions.iter().map(|p| 1e3 * p.y).collect();
    heights.sort_by(f64::total_cmp);
    let at = |share: f64| heights[((heights.len() - 1) as f64 * share) as usize];
    let wanted = [(0.0, -232.0), (0.1, -88.0), (0.25, -2.0), (0.5, 96.0), (0.75, 188.0), (0.9, 256.0), (1.0, 302.0)];
    let error = (wanted.iter().map(|(s, y)| (at(*s) - y).powi(2)).sum::<f64>() / wanted.len() as f64).sqrt();
    let found: Vec<i64> = wanted.iter().map(|(s, _)| at(*s).round() as i64).collect();
    let mean = heights.iter().sum::<f64>() / heights.len() as f64;
    let edge = |[a, b]: [u32; 2]| {
        let length = |x: &[glam::DVec3]| x[a as usize].distance(x[b as usize]);
        length(&solver.positions) / length(&mesh.positions) - 1.0
    };
    let edges = mesh.triangles.iter().flat_map(|[a, b, c]| [[*a, *b], [*b, *c], [*c, *a]]);
    let strain = 100.0 * edges.map(edge).fold(0.0, f64::max);
    let lowest = heights[0];
    eprintln!(
        "sphere: lowest {lowest:.1} mm, wanted -232; greatest edge strain {strain:.2} %, wanted at most 1.2; residual {:.4}, least {:.2} mm, {} iterations, heights {found:?} mm, mean {mean:.1}, RMS {error:.1} mm",
        probe.residual,
        1e3 * probe.least_distance,
        solver.iterations
    );
    assert!(probe.residual < settings.residual && probe.least_distance > 0.0);
    assert!((lowest + 232.0).abs() <= 5.0, "lowest point {lowest} mm");
    assert!(strain <= 1.2, "greatest edge strain {strain} %");
    assert!(error <= 8.0 && (mean - 90.0).abs() < 8.0, "RMS {error} mm, mean {mean} mm");
}
