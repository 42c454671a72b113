//! A made-up dataset of any size, for benchmarks and tests: a tube of cloth around a tubular body on a chain of joints.

use crate::dataset::{Description, Record, Sample, Setup};
use ctsn_rig::row_major;
use glam::{DAffine3, DQuat, DVec3};

/// Length of the tube, metres.
const LENGTH: f64 = 1.5;
/// Radius of the cloth, metres; that of the body is a tenth smaller.
const RADIUS: f64 = 0.2;

/// A tube of about `vertices` vertices along a chain of `joints` joints, in `poses` seeded random poses.
pub fn dataset(vertices: usize, joints: usize, poses: usize) -> (Setup, Vec<Sample>) {
    let joints = joints.max(1);
    let around = ((vertices as f64 * std::f64::consts::TAU * RADIUS / LENGTH).sqrt() as usize).max(3);
    let along = vertices.div_ceil(around).max(2);
    let bone = LENGTH / joints as f64;
    let place = |radius: f64| -> Vec<f32> {
        let ring = |row: usize| {
            (0..around).map(move |i| {
                let angle = (i as f64 + 0.5 * (row % 2) as f64) / around as f64 * std::f64::consts::TAU;
                let height = LENGTH * row as f64 / (along - 1) as f64;
                [radius * angle.cos(), height, radius * angle.sin()].map(|value| value as f32)
            })
        };
        (0..along).flat_map(ring).flatten().collect()
    };
    let cloth = place(RADIUS);
    let weights = cloth.as_chunks::<3>().0.iter().map(|vertex| {
        let at = (f64::from(vertex[1]) / bone).clamp(0.0, joints as f64 - 1.0);
        let (low, share) = (at.floor() as usize, at.fract());
        let pair = [(low, 1.0 - share), ((low + 1).min(joints - 1), share)];
        pair.into_iter().filter(|entry| entry.1 > 0.0).collect()
    });
    let setup = Setup {
        description: Description {
            character: "synthetic".to_owned(),
            garment: "tube".to_owned(),
            rate: 1.0,
            clips: vec!["random".to_owned()],
            joints: (0..joints).map(|j| format!("joint{j}")).collect(),
            parents: (0..joints).map(|j| j.checked_sub(1)).collect(),
            root: 0,
            inverse_bind: (0..joints)
                .map(|j| row_major(&DAffine3::from_translation(DVec3::NEG_Y * bone * j as f64)).to_vec())
                .collect(),
            ..Description::default()
        },
        garment: cloth.clone(),
        template: cloth.clone(),
        triangles: triangles(around, along),
        surface: Default::default(),
        drawn: None,
        body: place(RADIUS * 0.9),
        body_triangles: triangles(around, along),
        body_weights: weights.collect(),
    };
    let mut rng = fastrand::Rng::with_seed(1);
    let samples = (0..poses).map(|frame| sample(&mut rng, joints, bone, frame, &cloth)).collect();
    (setup, samples)
}

fn triangles(around: usize, along: usize) -> Vec<u32> {
    let at = |row: usize, i: usize| (row * around + i % around) as u32;
    let quad = |row: usize, i: usize| {
        let [a, b, c, d] = [at(row, i), at(row, i + 1), at(row + 1, i), at(row + 1, i + 1)];
        if row.is_multiple_of(2) { [a, c, b, b, c, d] } else { [a, c, d, a, d, b] }
    };
    (0..along - 1).flat_map(|row| (0..around).flat_map(move |i| quad(row, i))).collect()
}

fn sample(rng: &mut fastrand::Rng, joints: usize, bone: f64, frame: usize, cloth: &[f32]) -> Sample {
    let mut pose = Vec::new();
    let mut world = DAffine3::IDENTITY;
    for joint in 0..joints {
        let axis = DVec3::new(rng.f64() - 0.5, rng.f64() - 0.5, rng.f64() - 0.5).normalize_or(DVec3::X);
        let offset = if joint == 0 { DVec3::ZERO } else { DVec3::Y * bone };
        world *= DAffine3::from_rotation_translation(DQuat::from_axis_angle(axis, 0.1 * rng.f64()), offset);
        pose.extend(row_major(&world));
    }
    let record = Record { frame, ..Record::default() };
    Sample { record, joints: pose, truth: cloth.iter().map(|x| x + 0.02 * (rng.f32() - 0.5)).collect() }
}
