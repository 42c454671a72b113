//! The metrics on states whose errors are known beforehand; datasets that cannot be judged.

use super::*;
use crate::dataset::Record;
use crate::synthetic;
use crate::training::{Architecture, initial};

const POSES: usize = 30;

fn dataset() -> Dataset {
    let (setup, samples) = synthetic::dataset(200, 3, POSES);
    Dataset::new(setup, samples)
}

fn model(dataset: &Dataset) -> HostModel {
    let architecture = Architecture { embedding: 2, basis: 2, layers: 1, heads: 1, features: 4 };
    initial(&dataset.setup, &dataset.split(Split::Train), architecture, 1).expect("a model")
}

#[test]
fn a_moved_and_a_stretched_cloth_have_the_errors_that_were_given_to_them() {
    let dataset = dataset();
    let judge = Judge::new(&dataset.setup).expect("a judge");
    assert!((judge.size - 1.5).abs() < 1e-6, "the tube is 1.5 m long: {}", judge.size);
    let samples = unseen(&dataset, Split::Test).expect("unseen poses");
    assert_eq!(samples.len(), 3, "the last tenth of one clip");
    let change = |by: &dyn Fn(usize, DVec3) -> DVec3| {
        let state = |(frame, sample): (usize, &&Sample)| -> Vec<DVec3> {
            vertices(&sample.truth).into_iter().map(|position| by(frame, position)).collect()
        };
        let run = judge.run(&samples, samples.iter().enumerate().map(state).collect());
        judge.errors(&samples, &run, 0..samples.len())
    };
    let moved = change(&|frame, position| position + DVec3::X * 0.01 * (frame + 1) as f64);
    // 10, 20 and 30 mm.
    let close = |found: f64, wanted: f64| assert!((found - wanted).abs() < 1e-9, "wanted {wanted}, found {found}");
    close(moved.distance.mean, 0.02);
    close(moved.distance.std, 0.01 * (2.0_f64 / 3.0).sqrt());
    close(moved.distance.p95, 0.03);
    close(moved.scaled, 20.0 / judge.size);
    assert!(moved.normal.p95 < 0.1 && moved.stretch < 1e-9, "moving neither turns nor stretches: {moved:?}");
    let turned = change(&|_, p| DVec3::new(p.z, p.y, -p.x));
    assert!(turned.normal.mean > 30.0, "a quarter turn about the tube's axis: {}", turned.normal.mean);
    let larger = change(&|_, position| position * 1.1);
    // The truth is rest and 10 mm of noise a coordinate: its edges are about as long as at rest.
    assert!((0.09..0.14).contains(&larger.stretch), "{}", larger.stretch);
    // The cloth's radius is 200 mm, the body's 180, the noise 10.
    let inside = change(&|_, position| DVec3::new(0.8 * position.x, position.y, 0.8 * position.z));
    let outside = change(&|_, position| DVec3::new(2.0 * position.x, position.y, 2.0 * position.z));
    assert!(inside.penetrating > 0.4 && (0.02..0.051).contains(&inside.depth), "{inside:?}");
    assert!(outside.penetrating < 0.1, "{outside:?}");
    // From half of its length on the tube is beside the body, in the last two of three frames.
    let beside = change(&|frame, p| p + if frame > 0 { 5.0 * (p.y - 0.75).clamp(0.0, 0.1) } else { 0.0 } * DVec3::X);
    assert_eq!([moved.out, inside.out, outside.out, beside.out], [0.0, 0.0, 0.0, 2.0 / 3.0]);
}

#[test]
fn jitter_is_the_acceleration_of_frames_that_follow_each_other() {
    let at = |clip: usize, frame: usize| Sample {
        record: Record { clip, frame, ..Record::default() },
        joints: Vec::new(),
        truth: Vec::new(),
    };
    let samples = [at(0, 3), at(0, 4), at(0, 5), at(1, 6), at(1, 7), at(1, 9)];
    let samples: Vec<&Sample> = samples.iter().collect();
    // x = t² of seconds at 10 frames a second: an acceleration of 2 m/s².
    let positions: Vec<_> =
        samples.iter().map(|sample| vec![DVec3::X * (sample.record.frame as f64 / 10.0).powi(2)]).collect();
    let found = jitter(&samples, &positions, 10.0).expect("three frames in a row");
    assert!((found - 2.0).abs() < 1e-9, "{found}");
    assert_eq!(jitter(&samples[1..], &positions[1..], 10.0), None, "the clip changes, a frame is missing");
}

#[test]
fn the_parts_of_the_report_agree_with_the_whole() {
    let mut dataset = dataset();
    dataset.setup.description.clips.push("other".to_owned());
    dataset.samples[15..].iter_mut().for_each(|sample| {
        sample.record = Record { clip: 1, frame: sample.record.frame - 15, ..Record::default() };
    });
    let report = evaluate(&model(&dataset), &dataset, Split::Test).expect("a report");
    assert_eq!((report.clips.len(), report.frames.len()), (2, 2));
    let mean = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / 2.0;
    let by_clip = mean(&mut report.clips.iter().map(|clip| clip.network.distance.mean));
    let by_frame = mean(&mut report.frames.iter().map(|frame| frame.network.distance));
    let weight = |joint: &JointErrors| joint.vertices as f64;
    let all: f64 = report.joints.iter().map(weight).sum();
    let by_joint: f64 = report.joints.iter().map(|joint| weight(joint) * joint.distance).sum::<f64>() / all;
    assert_eq!(all as usize, report.vertices);
    for found in [by_clip, by_frame, by_joint] {
        assert!((found - report.network.distance.mean).abs() < 1e-9, "{found} against {:?}", report.network.distance);
    }
    assert!(report.frames[0].network.distance >= report.frames[1].network.distance, "worst first");
    assert_eq!((report.truth.distance.mean, report.truth.stretch), (0.0, 0.0));
    let text = report.to_string();
    assert!(text.contains("plain skinning") && text.contains("2 unseen frames of 2 clips"), "{text}");
}

#[test]
fn what_cannot_be_judged_is_named() {
    let dataset = dataset();
    let model = model(&dataset);
    let refused = |model: &HostModel, dataset: &Dataset, split, parts: &[&str]| {
        let message = evaluate(model, dataset, split).expect_err("an error").to_string();
        parts.iter().for_each(|part| assert!(message.contains(part), "wanted {part:?} in {message:?}"));
    };
    let mut few = dataset.clone();
    few.samples.truncate(5);
    few.setup.description.frames = vec![POSES];
    refused(&model, &few, Split::Test, &["unseen poses", "last tenth", "found none", "5 poses of 1 clips"]);
    few.samples.clear();
    refused(&model, &few, Split::Train, &["poses to learn from", "found none"]);
    let (setup, samples) = synthetic::dataset(100, 3, POSES);
    let other = Dataset::new(setup, samples);
    let (n, found) = (model.sizes.vertices.to_string(), other.setup.template.len() / 3);
    refused(&model, &other, Split::Test, &["not the model's", &n, &format!("found {found} vertices")]);
    let mut turned = dataset.clone();
    turned.setup.triangles.swap(0, 1);
    refused(&model, &turned, Split::Test, &["not the model's", "of other vertices"]);
    let mut named = dataset.clone();
    named.setup.description.joints[1] = "knee".to_owned();
    refused(&model, &named, Split::Test, &["joints", "\"joint1\"", "\"knee\""]);
}

#[test]
fn data_that_nothing_was_learned_from_is_judged_whole() {
    let dataset = dataset();
    let report = evaluate(&model(&dataset), &dataset, Split::All).expect("a report");
    let parts = [Split::Train, Split::Validation, Split::Test].map(|split| dataset.split(split).len());
    assert!(parts.iter().all(|&part| part > 0), "{parts:?}");
    assert_eq!(report.frames.len(), parts.iter().sum::<usize>());
    assert_eq!(report.frames.len(), dataset.samples.len());
}

#[test]
fn folds_are_measured_against_those_of_the_truth() {
    let dataset = dataset();
    let judge = Judge::new(&dataset.setup).expect("a judge");
    let samples = unseen(&dataset, Split::Test).expect("unseen poses");
    let folds = |by: &dyn Fn(usize, DVec3) -> DVec3| {
        let state = |sample: &&Sample| -> Vec<DVec3> {
            vertices(&sample.truth).into_iter().enumerate().map(|(i, position)| by(i, position)).collect()
        };
        let run = judge.run(&samples, samples.iter().map(state).collect());
        judge.errors(&samples, &run, 0..samples.len()).folds
    };
    let close = |found: f64, wanted: f64, by: f64| assert!((found - wanted).abs() < by, "{found}, wanted {wanted}");
    let same = folds(&|_, position| position);
    for ratio in [same.bending, same.curvature, same.fine, same.correlation, same.energy] {
        close(ratio, 1.0, 1e-6);
    }
    assert_eq!(same.bands, [0.0; 3]);
    // Cloth that hangs higher differs in the coarse band alone, and in weight.
    let moved = folds(&|_, position| position + DVec3::Y * 0.1);
    [moved.bands[0] - 0.1, moved.bands[1], moved.bands[2]].iter().for_each(|band| close(*band, 0.0, 1e-5));
    close(moved.strain, same.strain, 1e-6);
    close(moved.bending, 1.0, 1e-6);
    assert!(moved.energy > 1.0, "{moved:?}");
    let turned = folds(&|_, p| DVec3::new(p.z, p.y, -p.x));
    close(turned.curvature, 1.0, 1e-4);
    close(turned.energy, 1.0, 1e-2);
    // The garment as it was cut has no angle and no strain beside itself; the truth is it, and noise.
    let cut = vertices(&dataset.setup.garment);
    let smooth = folds(&|i, _| cut[i]);
    close(smooth.bending, 0.0, 1e-6);
    close(smooth.strain, 0.0, 1e-6);
    // A tube of few edges around is itself most of what is fine.
    assert!(smooth.fine < 1.0 && smooth.curvature < 0.95, "{smooth:?}");
    // Twice as far along every axis: each edge is as long again as it was cut.
    let large = folds(&|i, _| 2.0 * cut[i]);
    close(large.strain, 1.0, 1e-6);
    close(large.stretch, 1.0, 1e-6);
    assert!(large.energy > 10.0, "{large:?}");
}
