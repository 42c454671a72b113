//! The skin that cloth is kept out of does not stretch simulated cloth.

use super::scene::{rigid, sphere};
use crate::simulate::fitted;
use glam::{DAffine3, DVec3};

#[test]
fn skin_is_lowered_under_cloth_that_lies_in_it_and_nowhere_else() {
    const GAP: f64 = 0.002;
    // Cloth all around a ball of 204 mm: on one side where the gap is kept above a ball of 200, on the other 40 mm off.
    let skin = rigid(sphere(0.204, 3)).body;
    let mut cloth = sphere(0.202, 4).positions;
    cloth.iter_mut().filter(|place| place.y < 0.0).for_each(|place| *place *= 1.2);
    // Turned, cloth and skin alike.
    let worn = [0.0, 1.0].map(|angle| {
        let turn = DAffine3::from_rotation_z(angle);
        (vec![turn], cloth.iter().map(|place| turn.transform_point3(*place)).collect::<Vec<_>>())
    });
    let after = fitted(skin.clone(), GAP, &worn);
    assert_eq!((after.mesh.triangles.len(), after.weights), (skin.mesh.triangles.len(), skin.weights));
    let heights = |keep: fn(&DVec3) -> bool| -> Vec<f64> {
        let here = after.mesh.positions.iter().zip(&skin.mesh.positions).filter(|(_, before)| keep(before));
        here.map(|(after, before)| before.length() - after.length()).collect()
    };
    let [under, beside] = [heights(|place| place.y > 0.05), heights(|place| place.y < -0.05)];
    assert!(under.len() > 50 && under.iter().all(|by| (0.002..0.0045).contains(by)), "lowered by {under:?}");
    assert!(beside.len() > 50 && beside.iter().all(|by| by.abs() < 1e-9), "lowered by {beside:?}");
}
