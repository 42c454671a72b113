//! What can be wrong with a model file or a pose.

use std::fmt;

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
    #[error("{what}: value {} at element {element} is not finite", Decimal(*found))]
    NotFinite {
        /// Tensor name, "pose" or "positions".
        what: String,
        /// Element.
        element: usize,
        /// The value.
        found: f32,
    },
    /// A standard deviation or scale is not positive.
    #[error("{what}: value {} at element {element} is not positive", Decimal(*found))]
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

/// A number in a message, to six decimals. `Display` of `f32` itself, exact for every number and format, would add 7 kB
/// to what a page downloads.
pub(crate) struct Decimal(pub f32);

impl fmt::Display for Decimal {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        if self.0.is_nan() {
            return f.write_str("NaN");
        }
        f.write_str(if self.0 < 0.0 { "-" } else { "" })?;
        let (mut size, mut exponent) = (f64::from(self.0.abs()), 0);
        if size.is_infinite() {
            return f.write_str("inf");
        }
        let plain = size == 0.0 || (1e-2..1e7).contains(&size);
        while !plain && size >= 10.0 {
            (size, exponent) = (size / 10.0, exponent + 1);
        }
        while !plain && size < 1.0 {
            (size, exponent) = (size * 10.0, exponent - 1);
        }
        let millionths = (size * 1e6 + 0.5) as u64;
        write!(f, "{}", millionths / 1_000_000)?;
        let (mut decimals, mut width) = (millionths % 1_000_000, 6);
        while width > 0 && decimals % 10 == 0 {
            (decimals, width) = (decimals / 10, width - 1);
        }
        if width > 0 {
            write!(f, ".{decimals:0width$}")?;
        }
        if exponent == 0 { Ok(()) } else { write!(f, "e{exponent}") }
    }
}

/// Result of the core.
pub type Result<T> = std::result::Result<T, Error>;

#[cfg(test)]
mod tests {
    use super::Decimal;

    #[test]
    fn numbers_in_messages_read_as_they_are() {
        let plain = [0.0, -0.5, 0.1, 1234.5, -7.0, 0.015625, 9_999_999.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
        for number in plain {
            assert_eq!(Decimal(number).to_string(), number.to_string());
        }
        for number in [1e7, -1.5e-20, 3.25e38, 2e-3, 1e-45] {
            let text = Decimal(number).to_string();
            let read: f32 = text.parse().expect("a number");
            assert!(text.len() <= 14 && (read - number).abs() <= 1e-6 * number.abs(), "{number}: {text}");
        }
    }
}
