//! Simulates every frame of a character's clips into a dataset folder: poses in parallel, each written as soon as it is done,
//! those already there skipped. The result does not depend on order or threads.

use crate::dataset::{Description, Record, Sample, Setup, pose_path};
use crate::rig::{Character, Garment, Pose, SkinWeights};
use crate::simulate::{Material, Settings, Simulator, Status};
use crate::{Error, Result};
use ctsn_core::model::Surface;
use glam::{DAffine3, DVec3};
use rayon::prelude::*;
use std::path::Path;
use std::time::Instant;

/// How many poses a run simulated, found done, and left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Count {
    /// Simulated now.
    pub simulated: usize,
    /// Already there.
    pub found: usize,
    /// Left out, now or before.
    pub rejected: usize,
}

/// A row-major 3×4 transform in f32, as model files and datasets keep it.
pub fn row_major(transform: &DAffine3) -> [f32; 12] {
    let (matrix, t) = (transform.matrix3, transform.translation);
    std::array::from_fn(|e| if e % 4 == 3 { t[e / 4] } else { matrix.col(e % 4)[e / 4] } as f32)
}

/// The inverse of [`row_major`].
pub fn affine(numbers: &[f32]) -> DAffine3 {
    let column = |c: usize| DVec3::new(numbers[c].into(), numbers[4 + c].into(), numbers[8 + c].into());
    DAffine3::from_cols(column(0), column(1), column(2), column(3))
}

/// Joint transforms [J, 3, 4] of a pose.
pub fn joints(pose: &Pose) -> Vec<f32> {
    pose.iter().flat_map(row_major).collect()
}

/// Vertices as numbers [n, 3].
pub fn numbers(vertices: &[DVec3]) -> Vec<f32> {
    vertices.iter().flat_map(|vertex| vertex.to_array().map(|value| value as f32)).collect()
}

/// The inverse of [`numbers`].
pub fn vertices(numbers: &[f32]) -> Vec<DVec3> {
    numbers.as_chunks::<3>().0.iter().map(|vertex| DVec3::from_array(vertex.map(f64::from))).collect()
}

/// The setup of a dataset, its template not yet draped.
fn setup(character: &Character, garment: &Garment, names: [&str; 2], material: &Material) -> Setup {
    let rest = numbers(&garment.mesh.positions);
    let uv = garment.surface.uv.iter().flat_map(|uv| uv.to_array().map(|value| value as f32)).collect();
    let surface = Surface {
        vertex: garment.surface.vertex.clone(),
        uv,
        triangles: garment.surface.triangles.as_flattened().to_vec(),
    };
    Setup {
        description: Description {
            character: names[0].to_owned(),
            garment: names[1].to_owned(),
            rate: character.clips.first().map_or(0.0, |clip| clip.rate),
            clips: character.clips.iter().map(|clip| clip.name.clone()).collect(),
            joints: character.joints.iter().map(|joint| joint.name.clone()).collect(),
            root: character.root,
            inverse_bind: character.joints.iter().map(|joint| row_major(&joint.inverse_bind).to_vec()).collect(),
            // Other pins are another truth.
            material: match garment.pins.is_empty() {
                true => format!("{material:?}"),
                false => format!("{material:?}, pins {:?}", garment.pins),
            },
        },
        garment: rest.clone(),
        template: rest,
        triangles: garment.mesh.triangles.as_flattened().to_vec(),
        // A garment without texture coordinates is drawn as its cloth mesh.
        surface: if garment.surface.uv.is_empty() { Surface::default() } else { surface },
        body: numbers(&character.body.positions),
        body_triangles: character.body.triangles.as_flattened().to_vec(),
        body_weights: character.weights.iter().map(stored).collect(),
    }
}

/// A row of skin weights as a dataset gives it back: in f32, by joint. Without this a dataset would never look like its source.
fn stored(row: &SkinWeights) -> SkinWeights {
    let mut row: SkinWeights = row.iter().map(|(joint, weight)| (*joint, f64::from(*weight as f32))).collect();
    row.retain(|(_, weight)| *weight != 0.0);
    row.sort_by_key(|(joint, _)| *joint);
    row
}

/// Simulates every frame of `character`'s clips into `folder`. `progress(record)` follows every pose, those found done included.
/// `names`: of the character's and the garment's file.
pub fn simulate(
    character: &Character,
    garment: &Garment,
    names: [&str; 2],
    folder: &Path,
    progress: impl Fn(&Record) + Sync,
) -> Result<Count> {
    if character.clips.iter().all(|clip| clip.poses.is_empty()) {
        return Err(Error::Simulation(format!(
            "{} has no clip, wanted at least one: there is no pose to simulate",
            names[0]
        )));
    }
    let material = Material::default();
    let settings = Settings { attached: garment.pins.clone(), ..Settings::default() };
    let simulator = Simulator::new(character, garment, material, settings)?;
    let mut wanted = setup(character, garment, names, &material);
    let setup = match Setup::read(folder)? {
        Some(found) => {
            found.check_same(&wanted, folder)?;
            found
        }
        None => {
            wanted.template = numbers(&simulator.drape()?);
            wanted.write(folder)?;
            wanted
        }
    };
    let template = vertices(&setup.template);
    let poses = character
        .clips
        .iter()
        .enumerate()
        .flat_map(|(clip, sampled)| sampled.poses.iter().enumerate().map(move |(frame, pose)| (clip, frame, pose)));
    let poses: Vec<(usize, usize, &Pose)> = poses.collect();
    let sizes = (character.joints.len(), template.len());
    let run = |&(clip, frame, pose): &(usize, usize, &Pose)| -> Result<Count> {
        let path = pose_path(folder, clip, frame);
        let found = path.exists().then(|| Sample::read(&path, sizes.0, sizes.1)).transpose()?;
        let sample = match &found {
            Some(sample) => sample,
            None => &one(&simulator, &template, clip, frame, pose, folder)?,
        };
        progress(&sample.record);
        let (found, rejected) = (usize::from(found.is_some()), usize::from(sample.record.rejected.is_some()));
        Ok(Count { simulated: 1 - found, found, rejected })
    };
    let add = |a: Count, b: Count| Count {
        simulated: a.simulated + b.simulated,
        found: a.found + b.found,
        rejected: a.rejected + b.rejected,
    };
    poses.par_iter().with_max_len(1).map(run).try_reduce(Count::default, |a, b| Ok(add(a, b)))
}

fn one(
    simulator: &Simulator,
    template: &[DVec3],
    clip: usize,
    frame: usize,
    pose: &Pose,
    folder: &Path,
) -> Result<Sample> {
    let start = Instant::now();
    let outcome = simulator.simulate(template, pose);
    let rejected = match outcome.status {
        Status::Converged => None,
        Status::Rejected { reason } => Some(reason),
    };
    // JSON has no infinity; a refused pose carries a large number instead.
    let finite = |value: f64| value.clamp(-1e9, 1e9);
    let record = Record {
        clip,
        frame,
        rejected,
        residual: finite(outcome.residual),
        stretch: finite(outcome.stretch_max),
        distance: finite(outcome.least_distance),
        seconds: start.elapsed().as_secs_f64(),
    };
    let sample = Sample { record, joints: joints(pose), truth: numbers(&outcome.positions) };
    sample.write(folder)?;
    Ok(sample)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rig::{Clip, Joint, Mesh, Surface as Drawn};

    /// A square body with weights written strongest first, and a square of cloth over it.
    fn scene() -> (Character, Garment) {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE];
        let mesh = |lift: f64| Mesh {
            positions: corners.map(|corner| corner * 0.37 + DVec3::Z * lift).to_vec(),
            triangles: vec![[0, 1, 2], [1, 3, 2]],
        };
        let joint = |name: &str, height: f64| Joint {
            name: name.to_owned(),
            parent: None,
            inverse_bind: DAffine3::from_rotation_translation(glam::DQuat::from_rotation_x(0.3), DVec3::Y * height),
        };
        let mut character = Character {
            joints: vec![joint("Hips", 0.1), joint("Spine", 0.7)],
            root: 0,
            body: mesh(0.0),
            weights: vec![vec![(1, 0.7), (0, 0.3)]; 4],
            surface: Drawn::default(),
            clips: Vec::new(),
            metres_per_unit: 1.0,
        };
        let poses = vec![character.canonical_pose(); 2];
        character.clips.push(Clip { name: "still".to_owned(), rate: 7.3, poses });
        (character, Garment { mesh: mesh(0.01), ..Garment::default() })
    }

    #[test]
    fn a_dataset_knows_what_it_was_made_from() {
        let (character, garment) = scene();
        let folder = tempfile::tempdir().unwrap();
        let made = |garment: &Garment| setup(&character, garment, ["a.glb", "b.glb"], &Material::default());
        made(&garment).write(folder.path()).unwrap();
        let found = Setup::read(folder.path()).unwrap().unwrap();
        found.check_same(&made(&garment), folder.path()).unwrap();
        let mut other = garment.clone();
        other.mesh.positions[2].y += 1e-3;
        assert!(found.check_same(&made(&other), folder.path()).is_err(), "another garment must be refused");
    }

    #[test]
    fn transforms_survive_their_row_major_form() {
        let (character, _) = scene();
        let there = character.joints[1].inverse_bind;
        let back = affine(&row_major(&there));
        assert!((back.matrix3 - there.matrix3).to_cols_array().iter().all(|error| error.abs() < 1e-7));
        assert!((back.translation - there.translation).length() < 1e-7);
    }
}
