//! A few vertices of a fine cloth relaxed by themselves: the forces on them are those of the whole, and the rest stays.

use std::sync::Arc;

use glam::DVec3;

use super::scene::{down, sheet};
use crate::simulate::cloth::Cloth;
use crate::simulate::contact::Pin;
use crate::simulate::material::Material;
use crate::simulate::newton::{Layout, Solver};
use crate::simulate::settings::Settings;

const SIDE: usize = 51;
const MIDDLE: usize = SIDE * SIDE / 2;

/// A level sheet of 2,601 vertices, held by its corners, one vertex of it drawn up by 5 mm.
fn dented() -> (Cloth, Vec<DVec3>, Vec<Pin>) {
    let mesh = sheet(SIDE, 1.0);
    let cloth = Cloth::new(&mesh, &down(&mesh), &Material::default(), 0.0).unwrap();
    assert!(cloth.is_fine());
    let corners = [0, SIDE - 1, SIDE * (SIDE - 1), SIDE * SIDE - 1];
    let pins = corners.map(|vertex| Pin { vertex, target: mesh.positions[vertex], stiffness: 1000.0 });
    let mut x = mesh.positions;
    x[MIDDLE].y += 0.005;
    (cloth, x, pins.to_vec())
}

#[test]
fn forces_on_a_part_are_those_of_the_whole() {
    let (cloth, x, _) = dented();
    let mut free = vec![false; x.len()];
    free[MIDDLE] = true;
    cloth.spread(&mut free);
    let part = cloth.part_around(&free, vec![false; x.len()]);
    // Triangles reach one ring further, hinges two but for the corners of the second.
    assert_eq!((part.free, part.vertices.len()), (7, 7 + 12 + 12));
    let (alone, at) = (cloth.part(&part), part.vertices.iter().map(|&v| x[v]).collect::<Vec<_>>());
    let [mut whole, mut own] = [vec![DVec3::ZERO; x.len()], vec![DVec3::ZERO; at.len()]];
    cloth.elastic.stretch(&x, &mut whole);
    cloth.elastic.bend(&x, &mut whole);
    alone.elastic.stretch(&at, &mut own);
    alone.elastic.bend(&at, &mut own);
    for (&v, own) in part.vertices[..part.free].iter().zip(&own) {
        assert!(own.distance(whole[v]) < 1e-12, "vertex {v}: wanted {} N, found {own}", whole[v]);
        assert!(own.length() > 0.0);
    }
}

#[test]
fn what_snaps_is_relaxed_and_the_rest_stays() {
    let (cloth, x, pins) = dented();
    let (layout, settings) = (Arc::new(Layout::new(&cloth, &[]).unwrap()), Settings::default());
    let mut solver = Solver::new(&cloth, &layout, &settings, x.clone());
    solver.pins = pins;
    let before = solver.probe(None, 1.0).residual;
    assert!(!solver.relax_locally(None, 0.5), "the cloth is still on its way");
    assert!(solver.relax_locally(None, 1.0));
    let after = solver.probe(None, 1.0).residual;
    assert!(after < 0.1 * before, "wanted a tenth of {before}, found {after}");
    let moved = |v: usize| solver.positions[v] != x[v];
    assert!(moved(MIDDLE) && moved(MIDDLE + 1));
    assert!((0..x.len()).filter(|&v| moved(v)).count() < 100);
}
