//! The CTSN network.

/// Errors.
#[derive(Debug, thiserror::Error)]
pub enum Error {}
