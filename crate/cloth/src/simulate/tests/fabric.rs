//! Cantilever (heavy elastica), catenary and tension against their exact solutions. simulation.md §3.1–3.

use std::sync::Arc;

use glam::DVec3;

use super::scene::{down, strip};
use crate::simulate::cloth::Cloth;
use crate::simulate::contact::Pin;
use crate::simulate::material::{GRAVITY, Material};
use crate::simulate::newton::{Layout, Solver};
use crate::simulate::settings::Settings;
use ctsn_rig::Mesh;

/// Relaxes `start` with the vertices in `held` pinned where they are.
fn hang(cloth: &Cloth, start: &[DVec3], held: impl Fn(usize) -> bool) -> Vec<DVec3> {
    let settings = Settings { residual: 1e-4, ..Settings::default() };
    let layout = Arc::new(Layout::new(cloth, &[]).unwrap());
    let mut solver = Solver::new(cloth, &layout, &settings, start.to_vec());
    let pin = |vertex: usize| Pin { vertex, target: start[vertex], stiffness: 1e5 };
    solver.pins = (0..start.len()).filter(|&i| held(i)).map(pin).collect();
    let probe = solver.relax(None, 2000);
    assert!(probe.residual < 1e-4, "residual {}", probe.residual);
    solver.positions
}

/// Tip drop over length of a clamped strip with `β = ρ g L³ / D`.
fn tip_drop(beta: f64, elements: usize) -> f64 {
    let (length, density) = (0.1, 0.2);
    let edge = length / elements as f64;
    let mesh = strip(elements + 1, (0.3 * elements as f64).round() as usize, edge);
    let bending = density * GRAVITY * length.powi(3) / beta;
    let material = Material { friction: 0.0, ..Material::isotropic(density, 20_000.0, 0.3, bending) };
    let cloth = Cloth::new(&mesh, &down(&mesh), &material, 0.0).unwrap();
    // Two columns are clamped, so that the slope vanishes at x = edge.
    let clamp = edge;
    let x = hang(&cloth, &mesh.positions, |i| mesh.positions[i].x <= 1.51 * edge);
    let tip = |i: &usize| mesh.positions[*i].x > clamp + length - 0.51 * edge;
    let tips: Vec<usize> = (0..x.len()).filter(tip).collect();
    -tips.iter().map(|&i| x[i].y).sum::<f64>() / tips.len() as f64 / length
}

#[test]
fn cantilever_droops_like_the_heavy_elastica() {
    for (beta, wanted) in [(3.0, 0.3396), (8.0, 0.6406), (20.0, 0.8299)] {
        for elements in [20, 40] {
            let drop = tip_drop(beta, elements);
            eprintln!("cantilever beta {beta}, {elements} elements: drop {drop:.4}, exact {wanted}");
            assert!((drop / wanted - 1.0).abs() < 0.05, "beta {beta}: drop {drop}, wanted {wanted}");
        }
    }
}

#[test]
fn rope_of_cloth_hangs_in_a_catenary() {
    for (span, wanted) in [(0.8, 0.2654), (0.6, 0.3628)] {
        let columns = 60;
        let mesh = straight(columns, 2, 1.0 / columns as f64);
        let material = Material::isotropic(0.2, 20_000.0, 0.0, 1e-9);
        let cloth = Cloth::new(&mesh, &down(&mesh), &material, 0.0).unwrap();
        let bow = |p: &DVec3| DVec3::new(p.x * span, -4.0 * wanted * p.x * (1.0 - p.x), p.z);
        let start: Vec<DVec3> = mesh.positions.iter().map(bow).collect();
        let end = |i: usize| mesh.positions[i].x < 1e-9 || mesh.positions[i].x > 1.0 - 1e-9;
        let sag = -hang(&cloth, &start, end).iter().map(|p| p.y).fold(0.0, f64::min);
        eprintln!("catenary span {span}: sag {sag:.4}, exact {wanted}");
        assert!((sag / wanted - 1.0).abs() < 0.01, "span {span}: sag {sag}, wanted {wanted}");
    }
}

/// A strip whose ends are straight lines: odd rows shifted only inside.
fn straight(columns: usize, rows: usize, edge: f64) -> Mesh {
    let mut mesh = strip(columns, rows, edge);
    let length = columns as f64 * edge;
    for (i, p) in mesh.positions.iter_mut().enumerate() {
        let column = i % (columns + 1);
        p.x = if column == 0 { 0.0 } else { p.x };
        p.x = if column == columns { length } else { p.x };
    }
    mesh
}

#[test]
fn tension_stretches_by_the_membrane_law() {
    // Hung by its top edge with a weight T per width at the bottom: T = Eh λ(λ² - 1)/2.
    let (columns, rows, edge) = (40, 10, 0.01);
    let mut mesh = straight(columns, rows, edge);
    mesh.positions.iter_mut().for_each(|p| *p = DVec3::new(p.z, -p.x, 0.0));
    let width = mesh.positions.last().unwrap().x;
    let length = columns as f64 * edge;
    for (pull, wanted) in [(5.0, 0.004963), (10.0, 0.009854), (50.0, 0.046681)] {
        let material = Material { density: 1e-3, ..Material::default() };
        let mut cloth = Cloth::new(&mesh, &down(&mesh), &material, 0.0).unwrap();
        for row in 0..=rows {
            let share = if row == 0 || row == rows { 0.5 } else { 1.0 };
            cloth.elastic.masses[row * (columns + 1) + columns] += pull * width * share / rows as f64 / GRAVITY;
        }
        let x = hang(&cloth, &mesh.positions, |i| i % (columns + 1) == 0);
        let at =
            |column: usize| (0..=rows).map(|row| x[row * (columns + 1) + column].y).sum::<f64>() / (rows + 1) as f64;
        // Away from both ends, where the held edge cannot contract.
        let (upper, lower) = (columns / 4, 3 * columns / 4);
        let strain = (at(upper) - at(lower)) / (0.5 * length) - 1.0;
        eprintln!("tension {pull} N/m: strain {strain:.6}, exact {wanted}");
        assert!((strain / wanted - 1.0).abs() < 0.01, "{pull} N/m: strain {strain}, wanted {wanted}");
    }
}

#[test]
fn own_weight_stretches_a_hanging_strip() {
    let (columns, rows) = (50, 4);
    let mut mesh = straight(columns, rows, 0.02);
    mesh.positions.iter_mut().for_each(|p| *p = DVec3::new(p.z, -p.x, 0.0));
    let material = Material::isotropic(0.2, 1000.0, 0.0, 6e-5);
    let cloth = Cloth::new(&mesh, &down(&mesh), &material, 0.0).unwrap();
    let x = hang(&cloth, &mesh.positions, |i| i % (columns + 1) == 0);
    let tip = -x.iter().map(|p| p.y).fold(0.0, f64::min) - 1.0;
    eprintln!("self weight: tip {:.4} mm, exact 0.981", 1e3 * tip);
    assert!((tip / 0.981e-3 - 1.0).abs() < 0.01, "tip elongation {tip}");
}
