//! The model from whose predictions poses are relaxed. Its cloth may be another mesh of the same garment: so what a
//! coarse model has learned chooses the folds of fine truth.

use crate::dataset::Setup;
use crate::judging::is_same_cloth;
use crate::{Error, Result};
use ctsn_cloth::simulate::Embedding;
use ctsn_core::cpu::Level;
use ctsn_core::model::HostModel;
use ctsn_core::{Predictor, Streams};
use ctsn_rig::path::body_frame;
use ctsn_rig::{Character, Mesh, Pose, joints, vertices};
use glam::DVec3;

/// How far from the model's cloth that of the dataset may lie on average, in mean edges of the former.
const FURTHEST: f64 = 0.5;

/// A model and how the cloth lies on its own.
pub(super) struct Teacher<'a> {
    model: &'a HostModel,
    /// Its template, canonical space [n of the model].
    template: Vec<DVec3>,
    /// None where the mesh is the same.
    embedding: Option<Embedding>,
}

impl<'a> Teacher<'a> {
    /// For a dataset of the same joints, its template draped.
    ///
    /// # Errors
    /// The model is of another garment.
    pub fn new(model: &'a HostModel, setup: &Setup) -> Result<Self> {
        let (own, fine) = (vertices(&model.rest), vertices(&setup.template));
        let mesh = |positions: &[DVec3], triangles: &[u32]| Mesh {
            positions: positions.to_vec(),
            triangles: triangles.as_chunks().0.to_vec(),
        };
        let lay = || Embedding::new(mesh(&own, &model.triangles), &mesh(&fine, &setup.triangles));
        let embedding = (!is_same_cloth(model, setup)).then(lay);
        let apart = embedding.as_ref().map_or(0.0, |embedding| embedding.distance(&fine));
        if apart > FURTHEST {
            return Err(Error::Dataset(format!(
                "its cloth is not the model's, nor another mesh of it: wanted vertices at most {FURTHEST} edges of the \
                 model's cloth away from that on average, found {apart:.1}"
            )));
        }
        Ok(Self { model, template: own, embedding })
    }

    /// What it predicts for `pose`, body frame [n]; `template`: of the dataset.
    pub fn predict(&self, character: &Character, pose: &Pose, template: &[DVec3]) -> Result<Vec<DVec3>> {
        let mut predictor = Predictor::from_model(self.model.clone(), Level::new());
        predictor.predict_row_major(&joints(pose), Streams::Both)?;
        let into = body_frame(character, pose);
        let predicted = vertices(predictor.positions());
        let predicted: Vec<DVec3> = predicted.into_iter().map(|position| into.transform_point3(position)).collect();
        let laid = self.embedding.as_ref().map(|embedding| embedding.lay([template, &self.template], &predicted));
        Ok(laid.unwrap_or(predicted))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic;
    use crate::training::{Architecture, initial};

    #[test]
    fn a_model_teaches_another_mesh_of_its_garment_and_no_other_garment() {
        let architecture = Architecture { embedding: 2, basis: 2, layers: 1, heads: 1, features: 4 };
        let (setup, samples) = synthetic::dataset(200, 3, 4);
        let model = initial(&setup, &samples.iter().collect::<Vec<_>>(), architecture, 1).unwrap();
        assert!(Teacher::new(&model, &setup).unwrap().embedding.is_none());
        let (mut fine, _) = synthetic::dataset(900, 3, 4);
        let teacher = Teacher::new(&model, &fine).unwrap();
        let template = vertices(&fine.template);
        let laid = teacher.embedding.expect("another mesh").lay([&template, &teacher.template], &teacher.template);
        let furthest = laid.iter().zip(&template).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
        assert!(furthest < 1e-9, "{furthest} m from its own drape on the model's");
        fine.template.iter_mut().for_each(|coordinate| *coordinate *= 1.5);
        let refused = Teacher::new(&model, &fine).err().expect("refused").to_string();
        assert!(refused.contains("nor another mesh of it: wanted"), "{refused}");
    }
}
