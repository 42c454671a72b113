//! Tight trousers on bent knees, where calf and thigh pass into each other: cloth that is let go there must not end
//! deep inside.

use glam::DVec3;

use super::pose::{simulator, stride};
use super::scene::legs;
use ctsn_rig::Mesh;

/// A trouser leg around the left leg of [`legs`], 6 mm off it: `rows` + 1 rings of `around` vertices from the top.
fn trouser_leg(around: u32, rows: u32) -> Mesh {
    let (top, knee, foot) = (0.88, 0.53, 0.15);
    let mut mesh = Mesh::default();
    for row in 0..=rows {
        let y = top + (foot - top) * f64::from(row) / f64::from(rows);
        let skin = if y > knee { 0.057 + 0.075 * (y - knee) } else { 0.043 + 0.037 * (y - foot) };
        for i in 0..around {
            let turn = (f64::from(i) + 0.5 * f64::from(row % 2)) / f64::from(around) * std::f64::consts::TAU;
            mesh.positions.push(DVec3::new(0.085, y, 0.0) + (skin + 0.006) * DVec3::new(turn.cos(), 0.0, turn.sin()));
        }
    }
    for row in 0..rows {
        for i in 0..around {
            let next = (i + 1) % around;
            let at = |row: u32, i: u32| row * around + i;
            let (a, b, c, d) = (at(row, i), at(row, next), at(row + 1, i), at(row + 1, next));
            mesh.triangles.extend(if row % 2 == 0 { [[a, b, c], [b, d, c]] } else { [[a, d, c], [a, b, d]] });
        }
    }
    mesh
}

#[test]
fn tight_cloth_stays_outside_of_bent_knees() {
    let character = legs();
    let simulator = simulator(&character, trouser_leg(12, 22), 12).unwrap();
    let template = simulator.drape().unwrap();
    let mut rescued = 0;
    for knee in [95.0, 110.0, 120.0, 130.0, 140.0] {
        let outcome = simulator.simulate(&template, &stride(&character, 60.0, knee, 10.0));
        eprintln!("knee {knee}: {} iterations, {:?}", outcome.iterations, outcome.status);
        assert!(outcome.converged(), "knee bent by {knee}°: {:?}", outcome.status);
        // A path and one relaxation take no more: what took more would have been left out.
        let settings = &simulator.settings;
        let once = 3 * settings.path_steps * settings.path_iterations + settings.relax_iterations;
        rescued += usize::from(outcome.iterations > once);
    }
    assert!(rescued > 0, "none of these poses needs a rescue: the test shows nothing");
}
