//! The skin that cloth is kept out of does not stretch simulated cloth.

use super::scene::{rigid, sphere};
use crate::simulate::fitted;
use glam::{DAffine3, DVec3};

#[test]
fn skin_is_lowered_under_cloth_that_lies_in_it_and_nowhere_else() {
    const GAP: f64 = 0.002;
    // Cloth all around a ball of 204 mm: above where the gap is kept over a ball of 200, below 40 mm off.
    let skin = rigid(sphere(0.204, 3)).body;
    let place = |i: usize| {
        let (y, angle) = (1.0 - 2.0 * (i as f64 + 0.5) / 4000.0, 2.4 * i as f64);
        let ring = (1.0 - y * y).sqrt();
        DVec3::new(ring * angle.cos(), y, ring * angle.sin()) * if y < 0.0 { 0.24 } else { 0.202 }
    };
    let cloth: Vec<DVec3> = (0..4000).map(place).collect();
    // Turned, cloth and skin alike.
    let worn = [0.0, 1.0].map(|angle| {
        let turn = DAffine3::from_rotation_z(angle);
        (vec![turn], cloth.iter().map(|place| turn.transform_point3(*place)).collect::<Vec<_>>())
    });
    let after = fitted(skin.clone(), GAP, &worn);
    assert_eq!((after.mesh.triangles.len(), &after.weights), (skin.mesh.triangles.len(), &skin.weights));
    let heights = |keep: fn(&&DVec3) -> bool| -> Vec<f64> {
        after.mesh.positions.iter().filter(keep).map(|place| 0.204 - place.length()).collect()
    };
    let [under, beside] = [heights(|place| place.y > 0.05), heights(|place| place.y < -0.05)];
    assert!(under.len() > 50 && under.iter().all(|by| (0.001..0.0035).contains(by)), "lowered by {under:?}");
    assert!(beside.len() > 50 && beside.iter().all(|by| by.abs() < 1e-9), "lowered by {beside:?}");
}
