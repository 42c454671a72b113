//! Garments of scenes with an obstacle: the sheet before it, and what is not dressed.

use super::test::{capsule, character, person};
use super::*;
use ctsn_rig::Joint;
use glam::DAffine3;

#[test]
fn a_sheet_hangs_from_a_rail_by_its_upper_edge() {
    for axis in [DVec3::X, DVec3::Z] {
        let rail = ("rail", None, (axis * -0.5).to_array(), (axis * 0.5).to_array(), 0.02);
        let scene = character(&[rail, ("obstacle", Some(0), [0.0, -0.5, 0.0], [0.1, -0.5, 0.0], 0.1)]);
        assert_eq!(default_kind(&scene).unwrap(), Kind::Sheet);
        for wanted in [500, 1234, 5000] {
            let Garment { mesh, pins, .. } = shell(&scene, &Cut { vertices: Some(wanted), ..Cut::default() }).unwrap();
            let Quality { vertices, manifold, loops, euler, .. } = quality(&mesh);
            assert!(manifold && (loops, euler) == (1, 1), "{wanted}: {loops} loops, Euler characteristic {euler}");
            assert!((0.95..1.05).contains(&(vertices as f64 / wanted as f64)), "{vertices} vertices, wanted {wanted}");
            let front = if axis == DVec3::X { DVec3::Z } else { DVec3::X };
            assert!(mesh.normals(&mesh.positions).iter().all(|normal| normal.distance(front) < 1e-9), "{axis}");
            let top = mesh.positions.iter().map(|p| p.y).fold(f64::MIN, f64::max);
            let upper = (0..vertices as u32).filter(|v| mesh.positions[*v as usize].y > top - 1e-9);
            assert_eq!(pins, upper.collect::<Vec<_>>());
            assert!(mesh.positions.iter().all(|p| p.dot(front) > 0.02), "cloth inside the rail");
        }
    }
}

#[test]
fn an_obstacle_is_not_dressed() {
    let mut person = person();
    let cut = Cut { vertices: Some(600), ..Cut::default() };
    let bare = shell(&person, &cut).unwrap();
    let chair = Joint { name: "Obstacle chair".into(), parent: Some(0), inverse_bind: DAffine3::IDENTITY };
    person.joints.push(chair);
    let joint = person.joints.len() - 1;
    capsule(&mut person, joint, DVec3::new(0.0, 0.9, -0.3), DVec3::new(0.0, 0.3, -0.3), 0.2);
    assert!(shell(&person, &cut).unwrap() == bare);
}
