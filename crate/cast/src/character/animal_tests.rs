//! Animals and props have the right number of closed surfaces and the right size, and face forward.

use super::tests::cast;
use glam::DVec3;

#[test]
fn animals_are_as_large_as_they_claim() {
    // Name, height and length in metres, closed surfaces: body, nose and two eyes, or obstacle and rail.
    let wanted = [
        ("cat", 0.37, 0.66, 4),
        ("fox", 0.56, 0.98, 4),
        ("dolphin", 0.62, 2.2, 3),
        ("sphere", 0.758, 0.498, 2),
        ("box", 0.708, 0.448, 2),
    ];
    for (name, height, length, surfaces) in wanted {
        let body = &cast(name).body.mesh;
        let bounds = |axis: DVec3| {
            let along = body.positions.iter().map(|p| p.dot(axis));
            along.fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)))
        };
        let ((low, high), (back, front)) = (bounds(DVec3::Y), bounds(DVec3::Z));
        assert!((0.93..1.07).contains(&((high - low) / height)), "{name}: {} m high", high - low);
        assert!((0.93..1.07).contains(&((front - back) / length)), "{name}: {} m long", front - back);
        // Each closed surface without a handle has V - E + F = 2, and E = 3/2 F.
        assert_eq!(body.positions.len() - body.triangles.len() / 2, 2 * surfaces, "{name}");
    }
}

#[test]
fn animals_stand_on_the_floor_and_face_forward() {
    for name in ["cat", "fox"] {
        let low = cast(name).body.mesh.positions.iter().map(|p| p.y).fold(f64::MAX, f64::min);
        assert!(low.abs() < 2e-3, "{name} stands at {low} m");
    }
    for name in ["cat", "fox", "dolphin"] {
        let character = cast(name);
        let head = character.joint("Head").map(|head| character.canonical_pose()[head].translation);
        assert!(head.is_some_and(|head| head.z > 0.1 && head.x == 0.0), "{name}: head at {head:?}");
    }
}
