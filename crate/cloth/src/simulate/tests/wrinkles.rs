//! A stretched sheet in a rim too narrow for it wrinkles along the pull: `λ = 2√π (D/T)^¼ L^½` (Cerda & Mahadevan,
//! Geometry and Physics of Wrinkling, 2003). simulation.md §3.8.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::DVec3;

use super::scene::{down, strip};
use crate::simulate::cloth::Cloth;
use crate::simulate::contact::Pin;
use crate::simulate::material::Material;
use crate::simulate::newton::{Layout, Solver};
use crate::simulate::settings::Settings;

const LENGTH: f64 = 0.25;
const WIDTH: f64 = 0.1;
const STRETCH: f64 = 1.1;
/// What the rim leaves of the width: the rest must go into wrinkles.
const NARROWED: f64 = 0.98;
const STIFFNESS: f64 = 1000.0;

/// Wavelength in the middle of a sheet pulled by its two short ends, and what the theory says, metres.
fn wavelengths(bending: f64, edge: f64) -> [f64; 2] {
    let (columns, rows) = ((LENGTH / edge).round() as usize, (WIDTH / edge / 0.75f64.sqrt()).round() as usize);
    let mesh = strip(columns, rows, edge);
    let material = Material::isotropic(1e-3, STIFFNESS, 0.0, bending);
    let cloth = Cloth::new(&mesh, &down(&mesh), &material, 0.0).unwrap();
    // No two waves alike to begin with, none of them the answer.
    let noise = |z: f64| (1..40).map(|k| (f64::from(k) * (z / WIDTH * PI + 0.7 * f64::from(k))).sin()).sum::<f64>();
    let pulled = |p: &DVec3| DVec3::new(p.x * STRETCH, 2e-6 * noise(p.z) * (p.x / LENGTH * PI).sin(), p.z * NARROWED);
    let start: Vec<DVec3> = mesh.positions.iter().map(pulled).collect();
    let settings = Settings { residual: 1e-3, ..Settings::default() };
    let layout = Arc::new(Layout::new(&cloth, &[]).unwrap());
    let mut solver = Solver::new(&cloth, &layout, &settings, start.clone());
    let on_rim = |i: &usize| [0, columns].contains(&(i % (columns + 1))) || [0, rows].contains(&(i / (columns + 1)));
    solver.pins =
        (0..start.len()).filter(on_rim).map(|vertex| Pin { vertex, target: start[vertex], stiffness: 1e5 }).collect();
    solver.relax(None, 100);
    let x = solver.positions;
    let middle: Vec<f64> = (0..=rows).map(|row| x[row * (columns + 1) + columns / 2].y).collect();
    let across = (x[rows * (columns + 1) + columns / 2].z - x[columns / 2].z) / rows as f64;
    let tension = STIFFNESS * STRETCH * (STRETCH * STRETCH - 1.0) / 2.0;
    let wanted = 2.0 * PI.sqrt() * (bending / tension).powf(0.25) * (STRETCH * LENGTH).sqrt();
    [spacing(&middle) * across, wanted]
}

/// Mean period of a profile about its middle, in samples: twice the mean distance between zeros of its curvature.
fn spacing(profile: &[f64]) -> f64 {
    let curvature: Vec<f64> = profile.windows(3).map(|w| w[0] - 2.0 * w[1] + w[2]).collect();
    let inner = curvature.len() / 6..curvature.len() * 5 / 6;
    let turns = curvature.windows(2).enumerate().filter(|(i, w)| inner.contains(i) && w[0] * w[1] < 0.0);
    let zeros: Vec<f64> = turns.map(|(i, w)| i as f64 + w[0] / (w[0] - w[1])).collect();
    match &zeros[..] {
        [first, .., last] => 2.0 * (last - first) / (zeros.len() - 1) as f64,
        _ => f64::INFINITY,
    }
}

/// The waves are up to a quarter shorter than the theory's, which is for low and many ones: these are 1 mm high, and
/// four to five fit. With edges of 2.5 mm instead of 4 (8.6 vertices a wave instead of 5.4) they differ by 1 %.
#[test]
fn a_stretched_sheet_wrinkles_as_theory_says() {
    for (bending, edge) in [(4e-6, 0.004), (1.6e-5, 0.004)] {
        let [found, wanted] = wavelengths(bending, edge);
        eprintln!("wrinkles, bending {bending:e}, edges {edge}: {:.1} mm, theory {:.1}", 1e3 * found, 1e3 * wanted);
        assert!((0.75..1.05).contains(&(found / wanted)), "bending {bending}: {found} m, theory {wanted}");
    }
}
