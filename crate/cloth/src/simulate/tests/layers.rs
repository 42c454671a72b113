//! Cloth on cloth: the barrier's derivatives, the time of impact, and two folded layers that never cross.

use std::sync::Arc;

use glam::DVec3;

use super::scene::{down, rigid, sheet, strip};
use crate::simulate::cloth::Cloth;
use crate::simulate::collider::Collider;
use crate::simulate::contact::Pin;
use crate::simulate::material::Material;
use crate::simulate::newton::{Layout, Solver};
use crate::simulate::proximity::{Pair, barrier};
use crate::simulate::settings::Settings;
use crate::simulate::untangle::untangle;
use ctsn_rig::Mesh;

#[test]
fn barrier_derivatives_match_differences() {
    let offset = 0.003;
    for d in [0.0002, 0.001, 0.0029] {
        let step = 1e-8;
        let [low, high] = [barrier(d - step, offset), barrier(d + step, offset)];
        let [_, slope, curvature] = barrier(d, offset);
        assert!(((high[0] - low[0]) / (2.0 * step) / slope - 1.0).abs() < 1e-5, "slope at {d}");
        assert!(((high[1] - low[1]) / (2.0 * step) / curvature - 1.0).abs() < 1e-5, "curvature at {d}");
    }
    assert_eq!(barrier(offset, offset), [0.0; 3]);
}

#[test]
fn time_of_impact_stops_short_of_it() {
    let x = [DVec3::new(0.2, 1.0, 0.2), DVec3::ZERO, DVec3::X, DVec3::Z];
    let fall = [DVec3::NEG_Y * 4.0, DVec3::ZERO, DVec3::ZERO, DVec3::ZERO];
    let pair = Pair::VertexTriangle([0, 1, 2, 3]);
    let time = pair.time_of_impact(&x, &fall, 1.0);
    assert!((0.18..0.25).contains(&time), "wanted just below 0.2 to 0.25, found {time}");
    // Edges that meet at right angles; the same moves for all four never meet.
    let crossed = [DVec3::NEG_X, DVec3::X, DVec3::new(0.0, 0.5, -1.0), DVec3::new(0.0, 0.5, 1.0)];
    let edges = Pair::EdgeEdge([0, 1, 2, 3]);
    let drop = [DVec3::ZERO, DVec3::ZERO, DVec3::NEG_Y, DVec3::NEG_Y];
    let time = edges.time_of_impact(&crossed, &drop, 1.0);
    assert!((0.36..0.5).contains(&time), "wanted 0.36 to 0.5, found {time}");
    assert_eq!(edges.time_of_impact(&crossed, &[DVec3::new(3.0, -7.0, 2.0); 4], 1.0), 1.0);
}

#[test]
fn crossed_sheets_are_found() {
    let mut mesh = strip(2, 2, 0.1);
    let first = mesh.positions.len() as u32;
    let other: Vec<DVec3> = mesh.positions.iter().map(|p| DVec3::new(p.x, p.z - 0.08, 0.07)).collect();
    mesh.positions.extend(other);
    let copy: Vec<[u32; 3]> = mesh.triangles.iter().map(|t| t.map(|i| i + first)).collect();
    mesh.triangles.extend(copy);
    let cloth = Cloth::new(&mesh, &down(&mesh), &Material::default(), 0.0).unwrap();
    assert!(!cloth.elements.crossings(&mesh.positions).is_empty(), "an upright sheet stands in a level one");
    let mut apart = mesh.positions.clone();
    untangle(&cloth.elements, &mesh.rings(), &mut apart);
    assert_eq!(cloth.elements.crossings(&apart), Vec::<[u32; 2]>::new(), "smoothed apart");
    mesh.positions[first as usize..].iter_mut().for_each(|p| p.y += 1.0);
    assert_eq!(cloth.elements.crossings(&mesh.positions), Vec::<[u32; 2]>::new());
}

/// A sheet hung by one edge and let down on a table, where it folds over itself again and again.
#[test]
fn layers_that_fold_on_a_table_never_cross() {
    let mut mesh = sheet(25, 0.0);
    // Upright, a little crooked, so that it knows where to fold.
    mesh.positions
        .iter_mut()
        .for_each(|p| *p = DVec3::new(0.5 * p.x, 0.5 * (p.z + 0.5) + 0.01, 0.02 * (9.0 * p.z).sin()));
    let table = [[-2.0, -2.0], [-2.0, 2.0], [2.0, 2.0], [2.0, -2.0]].map(|[x, z]| DVec3::new(x, 0.0, z)).to_vec();
    let table = rigid(Mesh { positions: table, triangles: vec![[0, 1, 2], [0, 2, 3]] });
    let cloth = Cloth::new(&mesh, &down(&mesh), &Material::default(), 0.0).unwrap();
    let settings = Settings { reach: 10.0, ..Settings::default() };
    let layout = Arc::new(Layout::new(&cloth, &[]).unwrap());
    let collider = Collider::new(&table, &table.body, &mesh, settings.reach).unwrap();
    let body = collider.pose(&[glam::DAffine3::IDENTITY]);
    let mut solver = Solver::new(&cloth, &layout, &settings, mesh.positions.clone());
    let top: Vec<usize> = (0..mesh.positions.len()).filter(|&i| mesh.positions[i].y > 0.505).collect();
    let (mut crossings, mut nearest) = (0, f64::INFINITY);
    for step in 0..120 {
        let lowered = (0.5 * f64::from(step) / 100.0).min(0.47);
        let pin =
            |&vertex: &usize| Pin { vertex, target: mesh.positions[vertex] - DVec3::Y * lowered, stiffness: 50.0 };
        solver.pins = top.iter().map(pin).collect();
        for _ in 0..3 {
            solver.probe(Some(&body), 0.03);
            solver.advance(0.03);
            crossings += cloth.elements.crossings(&solver.positions).len();
            nearest = nearest.min(solver.nearest_layers());
        }
    }
    let height = solver.positions.iter().map(|p| p.y).fold(0.0, f64::max);
    eprintln!(
        "folded layers: {crossings} crossings wanted 0; least distance {:.2} mm wanted above 0; height {:.0} mm, {} pairs in touch",
        1e3 * nearest,
        1e3 * height,
        solver.touching
    );
    assert_eq!(crossings, 0);
    assert!(nearest > 0.0 && solver.touching > 100, "wanted layers in touch, found {}", solver.touching);
    assert!(height < 0.2, "wanted a heap, found {height} m high");
}
