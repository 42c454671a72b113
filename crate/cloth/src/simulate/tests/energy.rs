//! Every energy term against central differences.

use glam::{DMat3, DVec3};

use super::scene::{down, strip};
use crate::simulate::cloth::Cloth;
use crate::simulate::contact::{Contact, Pin, SLIP};
use crate::simulate::elastic::{Membrane, Wrinkling};
use crate::simulate::material::Material;

/// Largest difference of `gradient` from central differences of `energy`, over the largest entry.
fn error(x: &[DVec3], step: f64, energy: impl Fn(&[DVec3]) -> f64, gradient: &[DVec3]) -> f64 {
    let (mut worst, mut largest) = (0.0f64, 0.0f64);
    for i in 0..x.len() {
        for axis in 0..3 {
            let shifted = |by: f64| {
                let mut moved = x.to_vec();
                moved[i][axis] += by;
                energy(&moved)
            };
            let numeric = (shifted(step) - shifted(-step)) / (2.0 * step);
            worst = worst.max((numeric - gradient[i][axis]).abs());
            largest = largest.max(numeric.abs());
        }
    }
    worst / largest
}

/// Deterministic displacement of up to `size` metres per coordinate.
fn shaken(x: &[DVec3], size: f64) -> Vec<DVec3> {
    let wave = |i: usize, k: f64| ((i as f64 + 1.0) * k).sin() * size;
    x.iter().enumerate().map(|(i, p)| *p + DVec3::new(wave(i, 12.9), wave(i, 7.3), wave(i, 4.1))).collect()
}

/// Of cotton, and of cotton that wrinkles below its mesh.
fn membranes() -> [Membrane; 2] {
    let cotton = Material::default();
    [Membrane::new(&cotton), Membrane::Wrinkling(Wrinkling::new(&cotton))]
}

#[test]
fn membrane_and_bending_gradients() {
    let mesh = strip(3, 2, 0.02);
    let cloth = Cloth::new(&mesh, &down(&mesh), &Material::default(), 0.5).unwrap();
    let x = shaken(&mesh.positions, 0.004);
    for (membrane, triangle) in membranes().iter().flat_map(|m| cloth.elastic.triangles.iter().map(move |t| (m, t))) {
        let mut gradient = vec![DVec3::ZERO; x.len()];
        let forces = triangle.derivatives(membrane, &x, false, |_, _, _| {});
        (0..3).for_each(|a| gradient[triangle.vertices[a]] += forces[a]);
        assert!(error(&x, 1e-7, |x| triangle.energy(membrane, x), &gradient) < 1e-6);
    }
    for hinge in &cloth.elastic.hinges {
        let mut gradient = vec![DVec3::ZERO; x.len()];
        let forces = hinge.derivatives(&x, false, |_, _, _| {});
        (0..4).for_each(|a| gradient[hinge.vertices[a]] += forces[a]);
        assert!(error(&x, 1e-7, |x| hinge.energy(x), &gradient) < 1e-6);
    }
}

#[test]
fn contact_friction_and_pin_gradients() {
    let normal = DVec3::new(0.2, 0.9, -0.3).normalize();
    for slip in [0.3 * SLIP, 0.9 * SLIP, 4.0 * SLIP] {
        let x = [DVec3::new(0.01, 0.002, -0.01)];
        let tangent = normal.any_orthonormal_vector();
        let anchor = x[0] + tangent * slip + normal * 0.002;
        let plane = normal.dot(x[0]) - 0.001;
        let contact = Contact { vertex: 0, normal, plane, offset: 0.004, stiffness: 6.0, grip: 0.004, anchor };
        let (gradient, _) = contact.derivatives(x[0]);
        assert!(error(&x, 1e-8, |x| contact.energy(x[0]), &[gradient]) < 1e-5);
        let pin = Pin { vertex: 0, target: anchor, stiffness: 3.0 };
        assert!(error(&x, 1e-6, |x| pin.energy(x[0]), &[pin.derivatives(x[0]).0]) < 1e-6);
    }
}

/// Largest error of the Hessian's columns against differences of `force(x, vertex)`, over the largest entry.
fn hessian_error(
    x: &[DVec3],
    vertices: &[usize],
    blocks: &[(usize, usize, DMat3)],
    force: impl Fn(&[DVec3], usize) -> DVec3,
) -> f64 {
    let (mut worst, mut largest) = (0.0f64, 0.0f64);
    for a in 0..vertices.len() {
        for b in 0..=a {
            let block: DMat3 = blocks.iter().filter(|k| (k.0, k.1) == (a, b)).map(|k| k.2).sum();
            for axis in 0..3 {
                let shifted = |by: f64| {
                    let mut moved = x.to_vec();
                    moved[vertices[b]][axis] += by;
                    force(&moved, a)
                };
                let numeric = (shifted(1e-7) - shifted(-1e-7)) / 2e-7;
                worst = worst.max((numeric - block.col(axis)).length());
                largest = largest.max(numeric.length());
            }
        }
    }
    worst / largest
}

#[test]
fn exact_hessians_match_differences_of_gradients() {
    let mesh = strip(3, 2, 0.02);
    let cloth = Cloth::new(&mesh, &down(&mesh), &Material::default(), 0.5).unwrap();
    let x = shaken(&mesh.positions, 0.004);
    for (membrane, triangle) in membranes().iter().flat_map(|m| cloth.elastic.triangles.iter().map(move |t| (m, t))) {
        let mut blocks = Vec::new();
        triangle.derivatives(membrane, &x, true, |a, b, block| blocks.push((a, b, block)));
        let force = |x: &[DVec3], a: usize| triangle.derivatives(membrane, x, true, |_, _, _| {})[a];
        assert!(hessian_error(&x, &triangle.vertices, &blocks, force) < 1e-5);
    }
    for hinge in &cloth.elastic.hinges {
        let mut blocks = Vec::new();
        hinge.derivatives(&x, true, |a, b, block| blocks.push((a, b, block)));
        let force = |x: &[DVec3], a: usize| hinge.derivatives(x, true, |_, _, _| {})[a];
        let error = hessian_error(&x, &hinge.vertices, &blocks, force);
        assert!(error < 1e-5, "{error}");
    }
}

#[test]
fn internal_energy_ignores_rigid_motion() {
    let mesh = strip(3, 2, 0.02);
    let cloth = Cloth::new(&mesh, &down(&mesh), &Material::default(), 0.5).unwrap();
    let x = shaken(&mesh.positions, 0.004);
    let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.4, -1.1, 2.0);
    let moved: Vec<DVec3> = x.iter().map(|p| turn * *p + DVec3::new(1.0, -2.0, 0.5)).collect();
    let energy = |x: &[DVec3]| -> f64 {
        let membrane: f64 = cloth.elastic.triangles.iter().map(|t| t.energy(&cloth.elastic.membrane, x)).sum();
        membrane + cloth.elastic.hinges.iter().map(|h| h.energy(x)).sum::<f64>()
    };
    assert!((energy(&x) - energy(&moved)).abs() < 1e-10 * energy(&x));
}
