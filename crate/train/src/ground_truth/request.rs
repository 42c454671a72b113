//! What to simulate, and the setup of the dataset that comes of it.

use super::Shard;
use crate::dataset::digest;
use crate::dataset::{Description, Drawn, Setup, stored_surface};
use crate::{Error, Result};
use ctsn_cloth::simulate::{Fabric, Material, Settings};
use ctsn_core::model::{HostModel, Storage, Surface};
use ctsn_rig::{Character, Garment, SkinWeights, numbers, row_major};

/// What to simulate.
pub struct Request<'a> {
    /// Who wears the garment, with the clips to simulate.
    pub character: &'a Character,
    /// What is worn.
    pub garment: &'a Garment,
    /// File names of character and garment.
    pub names: [&'a str; 2],
    /// The material and its name.
    pub material: (&'a str, Material),
    /// Settings of the simulator.
    pub settings: Settings,
    /// A model of the same garment on the same character, from whose predictions the poses are relaxed.
    pub teacher: Option<&'a HostModel>,
    /// The part of the poses to simulate.
    pub shard: Shard,
    /// How many frames of the clips to simulate, evenly spread; `None` for all. More extend fewer.
    pub poses: Option<usize>,
    /// How many mixed poses to simulate as well, for training.
    pub mixed: usize,
    /// How many poses to simulate coarsely as well, for training, from the teacher's predictions; none of a garment
    /// that is not fine.
    pub coarse: usize,
    /// Poses to simulate a second time, a little changed, for the noise floor.
    pub twins: usize,
}

impl Request<'_> {
    /// How many frames the clips have; refuses a character without any.
    pub(super) fn frames(&self) -> Result<usize> {
        match self.character.clips.iter().map(|clip| clip.poses.len()).sum() {
            0 => {
                let reason =
                    format!("{} has no clip, wanted at least one: there is no pose to simulate", self.names[0]);
                Err(Error::Simulation(reason))
            }
            frames => Ok(frames),
        }
    }

    /// The setup of the dataset, its template not yet draped.
    pub(super) fn setup(&self) -> Setup {
        let (character, garment) = (self.character, self.garment);
        let rest = numbers(&garment.mesh.positions);
        Setup {
            description: self.description(),
            garment: rest.clone(),
            template: rest,
            triangles: garment.mesh.triangles.as_flattened().to_vec(),
            // A garment without texture coordinates is drawn as its cloth mesh.
            surface: if garment.surface.uv.is_empty() { Surface::default() } else { stored_surface(&garment.surface) },
            drawn: garment.drawn.as_ref().map(Drawn::new),
            body: numbers(&character.body.mesh.positions),
            body_triangles: character.body.mesh.triangles.as_flattened().to_vec(),
            body_weights: character.body.weights.iter().map(stored).collect(),
        }
    }

    fn description(&self) -> Description {
        let (clips, joints) = (&self.character.clips, &self.character.joints);
        Description {
            character: self.names[0].to_owned(),
            garment: self.names[1].to_owned(),
            rate: clips.first().map_or(0.0, |clip| clip.rate),
            clips: clips.iter().map(|clip| clip.name.clone()).collect(),
            frames: clips.iter().map(|clip| clip.poses.len()).collect(),
            joints: joints.iter().map(|joint| joint.name.clone()).collect(),
            parents: joints.iter().map(|joint| joint.parent).collect(),
            root: self.character.root,
            inverse_bind: joints.iter().map(|joint| row_major(&joint.inverse_bind).to_vec()).collect(),
            material: Fabric { name: self.material.0.to_owned(), material: self.material.1 },
            settings: self.settings.clone(),
            teacher: self.teacher.map(|model| format!("{:016x}", digest(&model.to_bytes(Storage::F32)))),
        }
    }
}

/// A row of skin weights as a dataset gives it back: rounded to f32, ordered by joint. Otherwise no dataset would equal
/// its source.
fn stored(row: &SkinWeights) -> SkinWeights {
    let mut row: SkinWeights = row.iter().map(|(joint, weight)| (*joint, f64::from(*weight as f32))).collect();
    row.retain(|(_, weight)| *weight != 0.0);
    row.sort_by_key(|(joint, _)| *joint);
    row
}
