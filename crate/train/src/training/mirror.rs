//! Simulated poses seen in a mirror. Where skeleton, body and garment are their own mirror images, as those of people
//! and animals are, the image of an equilibrium is one, too: twice as many poses to learn from, for nothing. Gravity
//! and the network's body frame are upright, and so is the mirror.

use crate::Result;
use crate::dataset::{Sample, Setup};
use ctsn_cloth::simulate::Embedding;
use ctsn_rig::path::body_frame;
use ctsn_rig::statistics::Sorted;
use ctsn_rig::{Character, Mesh, Pose, joints, numbers, pose, vertices};
use glam::{DAffine3, DMat3, DVec3};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use rayon::prelude::*;

/// How far from where it should be an image of a joint or, for 95 of 100, of a body vertex may be, in body extents.
const ASKEW: f64 = 0.015;
/// How far from the garment its image may lie on average, in mean edges.
const APART: f64 = 0.5;

/// The images of `samples`; none where something is not symmetric about the plane through the root joint along the
/// canonical pose's y and z.
pub fn mirrored(setup: &Setup, samples: &[&Sample]) -> Result<Vec<Sample>> {
    let character = setup.character()?;
    let bind: Vec<DAffine3> = character.joints.iter().map(|joint| joint.inverse_bind.inverse()).collect();
    let mirror = DAffine3 {
        matrix3: DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0)),
        translation: DVec3::new(2.0 * bind[character.root].translation.x, 0.0, 0.0),
    };
    let image = |points: &[DVec3]| points.iter().map(|p| mirror.transform_point3(*p)).collect::<Vec<_>>();
    let cloth = setup.cloth();
    let points = image(&cloth.positions);
    let Some(counterparts) = counterparts(&character, &bind, mirror) else { return Ok(Vec::new()) };
    if !is_even(&character.body.mesh, &image(&character.body.mesh.positions)) {
        return Ok(Vec::new());
    }
    let turned = cloth.triangles.iter().map(|[a, b, c]| [*a, *c, *b]).collect();
    let embedding = Embedding::new(cloth.clone(), &Mesh { positions: points.clone(), triangles: turned });
    if embedding.distance(&points) > APART {
        return Ok(Vec::new());
    }
    let one = |sample: &&Sample| {
        let (seen, truth) = (pose(&sample.joints), vertices(&sample.truth));
        let mut other: Pose = bind.clone();
        for (joint, &counterpart) in counterparts.iter().enumerate() {
            let moved = seen[joint] * character.joints[joint].inverse_bind;
            other[counterpart] = mirror * moved * mirror * bind[counterpart];
        }
        // From where the simulation is kept to the world, through the mirror, and back.
        let into = body_frame(&character, &other) * mirror * body_frame(&character, &seen).inverse();
        let laid = embedding.lay([&points, &cloth.positions], &truth);
        let truth: Vec<DVec3> = laid.into_iter().map(|p| into.transform_point3(p)).collect();
        Sample { record: sample.record.clone(), joints: joints(&other), truth: numbers(&truth) }
    };
    Ok(samples.par_iter().map(one).collect())
}

/// Which joint each is the image of: itself in the plane, else the nearest one with the same ancestors, in the mirror.
fn counterparts(character: &Character, bind: &[DAffine3], mirror: DAffine3) -> Option<Vec<usize>> {
    let place: Vec<DVec3> = bind.iter().map(|bind| bind.translation).collect();
    let furthest = ASKEW * character.body.mesh.extent();
    let mut found: Vec<usize> = Vec::new();
    for (joint, at) in place.iter().map(|place| mirror.transform_point3(*place)).enumerate() {
        let parent = character.joints[joint].parent.map(|parent| found[parent]);
        let alike = |other: &usize| character.joints[*other].parent == parent && !found.contains(other);
        let own = Some(joint).filter(|_| at.distance(place[joint]) < furthest && alike(&joint));
        let distance = |other: &usize| at.distance(place[*other]);
        let nearest = || (0..place.len()).filter(alike).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        found.push(own.or_else(nearest).filter(|other| distance(other) < furthest)?);
    }
    let there_and_back = (0..found.len()).all(|joint| found[found[joint]] == joint);
    (there_and_back && (0..found.len()).all(|joint| !character.is_obstacle(joint))).then_some(found)
}

/// Whether the images of a body's vertices lie where it has vertices.
fn is_even(body: &Mesh, images: &[DVec3]) -> bool {
    let places: Vec<[f64; 3]> = body.positions.iter().map(DVec3::to_array).collect();
    let Ok(tree) = ImmutableKdTree::<f64, 3>::new_from_slice(&places) else { return false };
    let gap = |p: &DVec3| tree.query(&p.to_array()).nearest_one::<SquaredEuclidean<f64>>().execute().distance.sqrt();
    Sorted::new(images.iter().map(gap)).percentile(95) < ASKEW * body.extent()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic;
    use ctsn_rig::row_major;

    /// A tube on a spine of three joints, with a pair of joints beside the middle one.
    fn scene() -> (Setup, Vec<Sample>) {
        let (mut setup, samples) = synthetic::dataset(2500, 3, 4);
        let aside = |x: f64| row_major(&DAffine3::from_translation(-DVec3::new(x, 0.7, 0.1))).to_vec();
        let description = &mut setup.description;
        description.joints.extend(["left", "right"].map(str::to_owned));
        description.inverse_bind.extend([aside(0.3), aside(-0.3)]);
        description.parents = vec![None, Some(0), Some(1), Some(1), Some(1)];
        // Bent smoothly: noise would be lost between the vertices of its image.
        let bent = |p: &[f32; 3]| [p[0] + 0.02 * (4.0 * p[1]).sin(), p[1], p[2] + 0.01 * (5.0 * p[1] + p[0]).cos()];
        let truth: Vec<f32> = setup.template.as_chunks::<3>().0.iter().flat_map(bent).collect();
        let more = |(i, sample): (usize, Sample)| {
            let turn = DAffine3::from_rotation_x(0.2 * i as f64 + 0.1);
            let beside = [turn, DAffine3::from_rotation_z(0.3)].iter().flat_map(row_major).collect::<Vec<_>>();
            Sample { joints: [sample.joints.clone(), beside].concat(), truth: truth.clone(), ..sample }
        };
        (setup, samples.into_iter().enumerate().map(more).collect())
    }

    fn furthest(a: &[f32], b: &[f32]) -> f32 {
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
    }

    #[test]
    fn an_image_of_an_image_is_the_pose_itself() {
        let (setup, samples) = scene();
        let refer = |samples: &[Sample]| mirrored(&setup, &samples.iter().collect::<Vec<_>>()).unwrap();
        let images = refer(&samples);
        let again = refer(&images);
        assert_eq!(images.len(), samples.len());
        for ((sample, image), again) in samples.iter().zip(&images).zip(&again) {
            assert!(furthest(&sample.joints, &again.joints) < 1e-5);
            // Twice between vertices of a mesh with edges of 30 mm.
            assert!(furthest(&sample.truth, &again.truth) < 2e-3, "{}", furthest(&sample.truth, &again.truth));
            assert!(furthest(&sample.joints, &image.joints) > 0.01, "another pose");
            // Right has moved as left had.
            let moved = |sample: &Sample, joint: usize| {
                let bind = ctsn_rig::affine(setup.description.inverse_bind[joint].as_slice().try_into().unwrap());
                (pose(&sample.joints)[joint] * bind).translation
            };
            let (left, right) = (moved(sample, 3), moved(image, 4));
            assert!(right.distance(left * DVec3::new(-1.0, 1.0, 1.0)) < 1e-5, "{left}, {right}");
        }
    }

    #[test]
    fn what_is_not_symmetric_has_no_image() {
        let (setup, samples) = scene();
        let count = |change: &dyn Fn(&mut Setup)| {
            let mut setup = setup.clone();
            change(&mut setup);
            mirrored(&setup, &samples.iter().collect::<Vec<_>>()).unwrap().len()
        };
        assert_eq!(count(&|_| ()), samples.len());
        assert_eq!(count(&|setup| setup.description.inverse_bind[3][3] += 0.1), 0, "a joint without a counterpart");
        assert_eq!(count(&|setup| setup.description.joints[4] = "obstacle".into()), 0, "an obstacle");
        let half = |x: &mut f32| *x *= if *x > 0.0 { 1.4 } else { 1.0 };
        let widen = |numbers: &mut Vec<f32>| numbers.iter_mut().step_by(3).for_each(half);
        assert_eq!(count(&|setup| widen(&mut setup.body)), 0, "a body");
        assert_eq!(count(&|setup| widen(&mut setup.template)), 0, "a garment");
    }
}
