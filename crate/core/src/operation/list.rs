//! What is made of the list of operations: a structure of each, one type of all of them, and ways to go over them.

/// An operand, moved as its kind demands; what is no operand stays as it is.
macro_rules! moved {
    (R, $value:expr, $read:ident, $write:ident, $indices:ident) => {
        $read($value)
    };
    (W, $value:expr, $read:ident, $write:ident, $indices:ident) => {
        $write($value)
    };
    (I, $value:expr, $read:ident, $write:ident, $indices:ident) => {
        $indices($value)
    };
    ($other:ident, $value:expr, $read:ident, $write:ident, $indices:ident) => {
        $value
    };
}

/// An operand, lent; a copy of what is no operand.
macro_rules! lent {
    (R, $value:expr) => {
        &*$value
    };
    (W, $value:expr) => {
        $value
    };
    (I, $value:expr) => {
        &*$value
    };
    ($other:ident, $value:expr) => {
        $value.clone()
    };
}

/// Makes a structure of each operation, [`Operation`] of all of them, and [`each!`](crate::each). `$d` is a dollar
/// sign.
macro_rules! operations {
    ($d:tt $(
        $(#[$doc:meta])*
        $name:ident<$($operand:ident),*> {
            $($(#[$field_doc:meta])* $field:ident: $kind:ident $(<$inner:ident>)?,)*
        }
    )*) => {
        $(
            $(#[$doc])*
            #[derive(Clone, Debug)]
            pub struct $name<$($operand),*> {
                $($(#[$field_doc])* pub $field: $kind $(<$inner>)?),*
            }

            impl<R, W, I> From<$name<$($operand),*>> for Operation<R, W, I> {
                fn from(operation: $name<$($operand),*>) -> Self {
                    Self::$name(operation)
                }
            }
        )*

        /// Any operation.
        #[derive(Clone, Debug)]
        pub enum Operation<R, W, I> {
            $($(#[$doc])* $name($name<$($operand),*>)),*
        }

        impl<R, W, I> Operation<R, W, I> {
            /// The same operation on other operands: each is moved once, in the order of the list.
            pub fn map<S, X, J>(
                self,
                mut read: impl FnMut(R) -> S,
                mut write: impl FnMut(W) -> X,
                mut indices: impl FnMut(I) -> J,
            ) -> Operation<S, X, J> {
                match self {
                    $(Self::$name($name { $($field),* }) => Operation::$name($name {
                        $($field: moved!($kind, $field, read, write, indices)),*
                    })),*
                }
            }

            /// Lends the operands: what is written may be changed.
            pub fn lend(&mut self) -> Operation<&R, &mut W, &I> {
                match self {
                    $(Self::$name($name { $($field),* }) => Operation::$name($name {
                        $($field: lent!($kind, $field)),*
                    })),*
                }
            }

            /// Its name in the list.
            pub fn name(&self) -> &'static str {
                match self {
                    $(Self::$name(_) => stringify!($name)),*
                }
            }
        }

        /// All trials of all operations.
        #[cfg(feature = "suite")]
        pub(crate) fn cases() -> Vec<crate::suite::Case> {
            type R = Vec<f32>;
            type W = Vec<f32>;
            type I = Vec<u32>;
            [$(crate::suite::of::<$name<$($operand),*>>(stringify!($name))),*].into_iter().flatten().collect()
        }

        /// `each!(operation, it => what)`: does `what` with the structure in an [`Operation`], whichever it is.
        #[macro_export]
        macro_rules! each {
            ($d operation:expr, $d it:ident => $d what:expr) => {
                match $d operation {
                    $($crate::operation::Operation::$name($d it) => $d what),*
                }
            };
        }
    };
}
