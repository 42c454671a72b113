//! A dataset that nobody simulated, for a training without truth: the drape, and poses in which plain skinning stands
//! for the cloth.

use super::Request;
use crate::Result;
use crate::dataset::{Dataset, Record, Sample, Split};
use ctsn_cloth::simulate::Simulator;
use ctsn_rig::mesh::Mesh;
use ctsn_rig::path::{body_frame, is_sound};
use ctsn_rig::{SkinnedMesh, joints, numbers, vertices};

/// The frames to learn from. Of the request, what it says of poses does not count.
///
/// # Errors
/// As of [`Run::new`](super::Run::new): no pose, or the garment cannot be draped.
pub fn unsimulated(request: &Request) -> Result<Dataset> {
    request.frames()?;
    let mut setup = request.setup();
    let simulator = Simulator::new(request.character, request.garment, request.material.1, request.settings.clone())?;
    setup.template = numbers(&simulator.drape()?);
    let weights = setup.nearest()?.iter().map(|body| setup.body_weights[*body].clone()).collect();
    let mesh = Mesh { positions: vertices(&setup.template), triangles: setup.triangles.as_chunks().0.to_vec() };
    let (cloth, character) = (SkinnedMesh { mesh, weights }, request.character);
    let mut samples = Vec::new();
    for (clip, sampled) in character.clips.iter().enumerate() {
        for (frame, pose) in sampled.poses.iter().enumerate() {
            let split = Split::of(character.clips.len(), clip, frame, sampled.poses.len());
            if split == Split::Train && is_sound(character, pose) {
                let into = body_frame(character, pose);
                let skinned = cloth.pose(&character.skinning(pose));
                let truth = skinned.into_iter().map(|position| into.transform_point3(position)).collect::<Vec<_>>();
                let record = Record { clip, frame, ..Record::default() };
                samples.push(Sample { record, joints: joints(pose), truth: numbers(&truth) });
            }
        }
    }
    Ok(Dataset::new(setup, samples))
}
