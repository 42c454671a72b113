//! What can go wrong in authoring. Every message names the thing, what was wanted and what was found.

use std::path::PathBuf;

/// Errors of the authoring stages.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A file could not be read or written.
    #[error("{path}: {source}")]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A file was read but is not what it should be.
    #[error("{path}: {reason}")]
    File {
        /// The file.
        path: PathBuf,
        /// What was wanted and what was found.
        reason: String,
    },
    /// A character that lacks what was asked of it.
    #[error("character: {0}")]
    Character(String),
    /// A garment that cannot be used.
    #[error("garment: {0}")]
    Garment(String),
    /// A simulation that cannot start or go on.
    #[error("simulation: {0}")]
    Simulation(String),
    /// Data that cannot be trained on or evaluated.
    #[error("dataset: {0}")]
    Dataset(String),
    /// A training whose loss is no number any more, or has exploded.
    #[error("training diverged at {0}; try a lower learning rate")]
    Diverged(String),
    /// Training that cannot go on.
    #[error("training: {0}")]
    Training(String),
    /// An error of the model file or the network.
    #[error(transparent)]
    Core(#[from] ctsn_core::Error),
}

/// Result of the authoring stages.
pub type Result<T> = std::result::Result<T, Error>;
