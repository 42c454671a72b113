//! What can be wrong with a GPU.

/// Errors of the GPU device. Every message names the thing, what was wanted and what was found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// No adapter: no driver, or none that is allowed.
    #[error("no GPU adapter: {0}")]
    NoAdapter(String),
    /// The adapter gives no device.
    #[error("{adapter} gives no device: {reason}")]
    NoDevice {
        /// Name of the adapter.
        adapter: String,
        /// What it says.
        reason: String,
    },
    /// The model is larger than the device allows.
    #[error("{what}: wanted {wanted}, the device allows {allowed}")]
    Limit {
        /// What is too large.
        what: String,
        /// Its size.
        wanted: u64,
        /// The device's limit.
        allowed: u64,
    },
    /// The device has no memory left.
    #[error("out of GPU memory: {0}")]
    OutOfMemory(String),
    /// The device refused a command: a fault of ours or of the driver.
    #[error("the GPU refused: {0}")]
    Refused(String),
    /// The device is gone.
    #[error("the GPU device is lost: {0}")]
    Lost(String),
    /// A feature that was asked for is not there.
    #[error("the device lacks {0}")]
    Missing(&'static str),
    /// A pose that is none, or a prediction that is not finite.
    #[error(transparent)]
    Core(#[from] ctsn_core::Error),
}

impl Error {
    /// A stable word for programs to match on.
    pub fn kind(&self) -> &'static str {
        match self {
            Error::NoAdapter(_) => "no_adapter",
            Error::NoDevice { .. } => "no_device",
            Error::Limit { .. } => "limit",
            Error::OutOfMemory(_) => "out_of_memory",
            Error::Refused(_) => "refused",
            Error::Lost(_) => "lost",
            Error::Missing(_) => "missing",
            Error::Core(error) => error.kind(),
        }
    }
}

impl From<wgpu::Error> for Error {
    fn from(error: wgpu::Error) -> Self {
        match error {
            wgpu::Error::OutOfMemory { source } => Error::OutOfMemory(source.to_string()),
            wgpu::Error::Validation { description, .. } | wgpu::Error::Internal { description, .. } => {
                Error::Refused(description)
            }
        }
    }
}

/// Result of this crate.
pub type Result<T> = std::result::Result<T, Error>;
