//! Cloth that was pulled into the body is put out of it before a pose is given up.

use glam::DAffine3;

use super::scene::{legs, skirt};
use crate::simulate::{Material, Settings, Simulator};
use ctsn_rig::Garment;

#[test]
fn cloth_in_the_body_is_put_outside_and_the_rest_stays() {
    let character = legs();
    let garment = Garment { mesh: skirt(30, 9), ..Garment::default() };
    let settings = Settings { attached: (0..30).collect(), ..Settings::default() };
    let simulator = Simulator::new(&character, &garment, Material::default(), settings).unwrap();
    let pose = character.canonical_pose();
    let rest = simulator.simulate(&simulator.drape().unwrap(), &pose).positions;
    let distances = simulator.body.signed(&pose, &rest);
    // Three vertices before the thighs, below the hips, are pushed 20 mm into them.
    let mut low: Vec<usize> = (90..rest.len()).collect();
    low.sort_by(|a, b| distances[*a].total_cmp(&distances[*b]));
    let pushed = &low[..3];
    let mut start = rest.clone();
    for &vertex in pushed {
        let place = &mut start[vertex];
        let axis = place.with_z(0.0).with_x(0.085 * place.x.signum());
        *place += (axis - *place).normalize() * (distances[vertex] + 0.02);
    }
    let mut inside = simulator.inside(&pose, &start).free;
    inside.sort_unstable();
    let mut wanted = pushed.to_vec();
    wanted.sort_unstable();
    assert_eq!(inside, wanted);

    let solver = simulator.level.solver(&simulator.settings, start.clone());
    let (positions, _) = simulator.put_out(&solver, &pose, DAffine3::IDENTITY).unwrap();
    assert!(simulator.inside(&pose, &positions).free.is_empty());
    for (vertex, (place, before)) in positions.iter().zip(&start).enumerate() {
        assert_eq!(pushed.contains(&vertex), place.distance(*before) > 0.01, "vertex {vertex}");
    }
    // Relaxed from there it is a drape again, none of it inside.
    let outcome = simulator.relax(&simulator.drape().unwrap(), &pose, &start);
    assert!(outcome.converged(), "{:?}", outcome.status);
    assert!(simulator.inside(&pose, &outcome.positions).free.is_empty());
}
