//! What of the posed body comes out through its posed skin. The skin encloses the canonical body, but each follows the
//! joints in its own way: the rim of a rigid shell that is hidden at rest comes out where a limb bends, and a large
//! triangle stays flat where the skin over it curves. There the skin is raised, so that cloth lies on what is seen.

use glam::DAffine3;

use super::collider::Collider;
use super::posed::PosedBody;

/// Distance between the points of the body that are looked at, metres.
const SPACING: f64 = 0.015;
/// Points deeper under the canonical skin than this never come out, metres.
const DEEPEST: f64 = 0.05;
/// How far points may be followed outside of the skin, metres.
const FURTHEST: f64 = 0.04;
/// Cosine of the greatest angle between the way from the skin to a point and the skin's normal: the skin does not end
/// there.
const UPRIGHT: f64 = 0.9;
/// What may stay outside of a fine skin, metres, well below the 4 mm that cloth keeps from it: tight cloth is pressed
/// in, and its triangles are chords. (With 4 mm a T-shirt's sleeves were slit, and skin showed.) From there to twice as
/// far out the skin is raised more and more, without a jump, until it covers the point.
pub(super) const SLACK: f64 = 0.001;
/// Rounds of raising: corners move along their own normals, which covers a point between them only in part.
const ROUNDS: usize = 2;
/// So little above a face what lies over it is looked for, metres.
const ABOVE: f64 = 0.001;

/// The points of the body that its skin must cover.
pub(super) struct Cover {
    points: Vec<Point>,
    /// What may stay outside of the skin, metres.
    slack: f64,
}

/// A point of the body, and the face of the skin above it in the canonical pose.
struct Point {
    face: u32,
    barycentric: [f64; 3],
    skin: u32,
}

impl Cover {
    /// The points of `body` under what cloth touches of `skin`, of which `slack` may stay outside, metres.
    pub fn new(body: &Collider, skin: &Collider, slack: f64) -> Self {
        let [posed, above] = [body, skin].map(|of| PosedBody::new(of, of.body.mesh.positions.clone()));
        let faces = (0..body.touched.len() as u32).filter(|face| body.touched[*face as usize]);
        let lattice = faces.flat_map(|face| {
            let [a, b, c] = body.face(face).map(|i| body.body.mesh.positions[i as usize]);
            let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
            points_of(((longest / SPACING).ceil() as usize).max(1)).map(move |barycentric| (face, barycentric))
        });
        let bind = |(face, barycentric)| {
            let hit = above.closest(posed.point(face, barycentric), None, DEEPEST)?;
            Some(Point { face, barycentric, skin: hit.face })
        };
        Self { points: lattice.filter_map(bind).collect(), slack }
    }

    /// How far each vertex of the skin is to be raised along its normal so that the posed body is covered, metres.
    pub fn heights(&self, body: &PosedBody, skin: &Collider, skinning: &[DAffine3]) -> Vec<f64> {
        let mut heights = vec![0.0f64; skin.body.weights.len()];
        for _ in 0..ROUNDS {
            let out = self.out(body, &skin.raised(skinning, &heights, 1.0));
            if out.is_empty() {
                break;
            }
            let before = heights.clone();
            for (face, height) in out {
                for corner in skin.face(face).map(|corner| corner as usize) {
                    heights[corner] = heights[corner].max(before[corner] + height);
                }
            }
        }
        heights
    }

    /// Faces of the `skin`, and how far what is seen of the body comes out through each, metres. What lies inside of
    /// the body is no part of what is seen: an arm in the chest drew the chest's skin into itself, by up to 80 mm.
    fn out(&self, body: &PosedBody, skin: &PosedBody) -> Vec<(u32, f64)> {
        let out = |point: &Point| {
            let place = body.point(point.face, point.barycentric);
            let hit = skin.closest_around(place, point.skin, FURTHEST)?;
            let out = hit.distance > self.slack && hit.normal.dot(skin.normal(hit.face)) > UPRIGHT;
            (out && !body.is_within(point.face, ABOVE))
                .then_some((hit.face, hit.distance.min(2.0 * (hit.distance - self.slack))))
        };
        self.points.iter().filter_map(out).collect()
    }
}

/// Barycentric coordinates of a lattice over a triangle, `steps` to an edge, without two of its edges: the neighbours
/// have those.
fn points_of(steps: usize) -> impl Iterator<Item = [f64; 3]> {
    (0..steps).flat_map(move |i| {
        (0..=(steps - 1 - i)).map(move |j| {
            let (a, b) = (i as f64 / steps as f64, j as f64 / steps as f64);
            [1.0 - a - b, a, b]
        })
    })
}
