//! Which data may go on in a folder.

use super::{Description, Setup};
use crate::{Error, Result};
use serde::Serialize;
use std::path::Path;

impl Setup {
    /// Takes the draped garment of what is in `folder` already, and nothing else; whether there was anything.
    ///
    /// # Errors
    /// As of [`check_same`](Self::check_same).
    pub fn take_drape(&mut self, folder: &Path) -> Result<bool> {
        let Some(found) = Self::read(folder)? else { return Ok(false) };
        found.check_same(self, folder)?;
        self.template = found.template;
        Ok(true)
    }

    /// Refuses to go on with a dataset made from something else than `wanted`, and says what differs.
    pub fn check_same(&self, wanted: &Self, folder: &Path) -> Result<()> {
        let mut same = wanted.clone();
        same.template.clone_from(&self.template);
        same.description = as_stored(&wanted.description)?;
        if *self == same {
            return Ok(());
        }
        let (found, wanted) = (&self.description, &same.description);
        let reason = if found.material != wanted.material {
            format!("another material: {}", difference(&found.material, &wanted.material)?)
        } else if found.settings != wanted.settings {
            format!("other settings of the simulator: {}", difference(&found.settings, &wanted.settings)?)
        } else if found.teacher != wanted.teacher {
            let told = |of: &Description| match &of.teacher {
                Some(digest) => format!("relaxed from the predictions of the model {digest}"),
                None => "simulated along a path".to_owned(),
            };
            format!("its poses are {}, not {}", told(found), told(wanted))
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

/// As the file gives it back: JSON keeps all but the last bit of a number.
fn as_stored(description: &Description) -> Result<Description> {
    serde_json::from_str(&super::to_json(description)?).map_err(|error| Error::Dataset(error.to_string()))
}

/// The fields that differ between two values of one structure.
fn difference(found: &impl Serialize, wanted: &impl Serialize) -> Result<String> {
    let value = |text: String| serde_json::from_str::<serde_json::Value>(&text);
    let wrong = |error: serde_json::Error| Error::Dataset(error.to_string());
    let [found, wanted] = [super::to_json(found)?, super::to_json(wanted)?].map(|text| value(text).map_err(wrong));
    let (found, wanted) = (found?, wanted?);
    let names = wanted.as_object().into_iter().flat_map(|fields| fields.keys());
    let names: Vec<&String> = names.filter(|name| found[*name] != wanted[*name]).collect();
    let told = |of: &serde_json::Value| {
        names.iter().map(|name| format!("{name}: {}", of[*name])).collect::<Vec<_>>().join(", ")
    };
    Ok(format!("wanted {}, found {}", told(&wanted), told(&found)))
}
