//! What can be wrong with a model file or a pose.

/// Errors of the core. Every message names the thing, what was wanted and what was found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// The bytes are not a safetensors file.
    #[error("not a safetensors file: {0}")]
    NotSafetensors(String),
    /// The header promises bytes that are not there.
    #[error("truncated file: {tensor} ends at byte {wanted}, the file has {found}")]
    Truncated {
        /// Tensor name.
        tensor: String,
        /// Where it should end.
        wanted: usize,
        /// Size of the file.
        found: usize,
    },
    /// A safetensors file that is not a ctsn model.
    #[error("not a ctsn model: {0}")]
    NotModel(String),
    /// A tensor the model needs is missing.
    #[error("tensor {0} is missing")]
    MissingTensor(String),
    /// A tensor has the wrong shape or type.
    #[error("tensor {tensor}: wanted {wanted}, found {found}")]
    Shape {
        /// Tensor name.
        tensor: String,
        /// Wanted shape or type.
        wanted: String,
        /// Found shape or type.
        found: String,
    },
    /// An index points outside what it indexes.
    #[error("tensor {tensor}: index {found} at element {element} is not below {limit}")]
    Index {
        /// Tensor name.
        tensor: String,
        /// Element of the tensor.
        element: usize,
        /// The index found.
        found: u32,
        /// How many there are.
        limit: usize,
    },
    /// A tensor, a pose or a prediction holds NaN or infinity.
    #[error("{what}: value {found} at element {element} is not finite")]
    NotFinite {
        /// Tensor name, "pose" or "positions".
        what: String,
        /// Element.
        element: usize,
        /// The value.
        found: f32,
    },
    /// A standard deviation or scale is not positive.
    #[error("{what}: value {found} at element {element} is not positive")]
    NotPositive {
        /// Tensor or key.
        what: String,
        /// Element.
        element: usize,
        /// The value.
        found: f32,
    },
    /// A pose of the wrong length.
    #[error("pose: wanted {wanted} numbers ({joints} joints), found {found}")]
    JointCount {
        /// Numbers wanted.
        wanted: usize,
        /// Joints of the model.
        joints: usize,
        /// Numbers found.
        found: usize,
    },
}

impl Error {
    /// A stable word for programs to match on.
    pub fn kind(&self) -> &'static str {
        match self {
            Error::NotSafetensors(_) => "not_safetensors",
            Error::Truncated { .. } => "truncated",
            Error::NotModel(_) => "not_model",
            Error::MissingTensor(_) => "missing_tensor",
            Error::Shape { .. } => "shape",
            Error::Index { .. } => "index",
            Error::NotFinite { .. } => "not_finite",
            Error::NotPositive { .. } => "not_positive",
            Error::JointCount { .. } => "joint_count",
        }
    }
}

/// Result of the core.
pub type Result<T> = std::result::Result<T, Error>;
