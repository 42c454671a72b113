//! Poses of one dataset that begin another, of the same character and garment.

use crate::dataset::Setup;
use crate::{Error, Result};
use ctsn_rig::file::{read, write};
use std::path::Path;

/// Copies the poses in `from`, with what their simulation logged, to where `into` is about to be simulated: there they
/// count as done. A dataset that was begun is left as it is.
///
/// # Errors
/// A file that cannot be read or written.
pub fn adopt(from: &Path, into: &Path) -> Result<()> {
    if Setup::read(into)?.is_some() {
        return Ok(());
    }
    for part in ["poses", "timing"] {
        let folder = from.join(part);
        let io = |source| Error::Io { path: folder.clone(), source };
        for entry in std::fs::read_dir(&folder).map_err(io)? {
            let path = entry.map_err(io)?.path();
            // What a killed process left half written has none.
            if let (Some(name), Some(_)) = (path.file_name(), path.extension()) {
                write(&into.join(part).join(name), &read(&path)?)?;
            }
        }
    }
    Ok(())
}
