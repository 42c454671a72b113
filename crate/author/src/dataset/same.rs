//! Which data is the same: what may go on in a folder, what may go on training.

use super::{Description, Sample, Setup};
use crate::{Error, Result};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::Path;

/// Tells these bytes from any others.
pub fn digest(bytes: &[u8]) -> u64 {
    let mut hasher = DefaultHasher::new();
    hasher.write(bytes);
    hasher.finish()
}

/// Tells these poses of this setup from any other data.
pub fn fingerprint(setup: &Setup, samples: &[&Sample]) -> u64 {
    let mut hasher = DefaultHasher::new();
    format!("{:?}", setup.description).hash(&mut hasher);
    (&setup.triangles, &setup.body_triangles, &setup.surface.vertex, &setup.surface.triangles).hash(&mut hasher);
    for (joint, weight) in setup.body_weights.iter().flatten() {
        (joint, weight.to_bits()).hash(&mut hasher);
    }
    let poses = samples.iter().flat_map(|sample| [&sample.joints, &sample.truth]);
    for values in [&setup.template, &setup.body, &setup.surface.uv].into_iter().chain(poses) {
        values.iter().for_each(|value| hasher.write_u32(value.to_bits()));
    }
    hasher.finish()
}

impl Setup {
    /// Refuses to go on with a dataset made from something else than `wanted`, and says what differs.
    pub fn check_same(&self, wanted: &Self, folder: &Path) -> Result<()> {
        let mut same = wanted.clone();
        same.template.clone_from(&self.template);
        // An older version wrote none.
        if self.description.parents.is_empty() {
            same.description.parents.clear();
        }
        if *self == same {
            return Ok(());
        }
        let (found, wanted) = (&self.description, &wanted.description);
        let texts = |found: &str, wanted: &str| {
            let parts = found.split(", ").zip(wanted.split(", ")).find(|(found, wanted)| found != wanted);
            let (found, wanted) = parts.unwrap_or((found, wanted));
            format!("wanted {wanted:?}, found {found:?}")
        };
        let reason = if found.material != wanted.material {
            format!("another material: {}", texts(&found.material, &wanted.material))
        } else if found.settings != wanted.settings {
            format!("other settings of the simulator: {}", texts(&found.settings, &wanted.settings))
        } else if (found.rate, &found.clips, &found.frames) != (wanted.rate, &wanted.clips, &wanted.frames) {
            let clips = |of: &Description| of.clips.iter().cloned().zip(of.frames.iter().copied()).collect::<Vec<_>>();
            let (ours, theirs) = (clips(found), clips(wanted));
            let other = (0..).find(|i| ours.get(*i) != theirs.get(*i) || *i >= ours.len()).unwrap_or_default();
            let motion = |of: &Description, clips: &[(String, usize)]| {
                let clip =
                    clips.get(other).map_or(String::new(), |(name, frames)| format!(", {frames} frames of {name}"));
                format!("{} clips at {} poses a second{clip}", of.clips.len(), of.rate)
            };
            format!("other motion: wanted {}, found {}", motion(wanted, &theirs), motion(found, &ours))
        } else {
            let pair = |of: &Setup| {
                let Description { garment, character, .. } = &of.description;
                let [cloth, body] = [&of.garment, &of.body].map(|positions| positions.len() / 3);
                format!("{garment} ({cloth} vertices) on {character} ({body} vertices)")
            };
            let (found, wanted) = (pair(self), pair(&same));
            let same = if found == wanted { ", of other shape, skin weights or joints" } else { "" };
            format!("another character or garment: wanted {wanted}, found {found}{same}")
        };
        let reason = format!("holds poses of {reason}; name another folder, or delete this one");
        Err(Error::File { path: folder.to_owned(), reason })
    }
}
