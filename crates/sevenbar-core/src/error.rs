//! The caller's mistakes, each with its numbers.

use std::fmt;

/// Why a linkage or a request cannot be taken.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// A number that is not finite where one is needed.
    NotFinite {
        /// What the number is.
        what: &'static str,
        /// Its place in the array, from 0.
        index: usize,
        /// The number.
        value: f64,
    },
    /// A link whose ends coincide: a ball on the axis it should turn about, or two balls in one place.
    NoLength {
        /// The link, counted from 1.
        link: usize,
    },
    /// Arrays that belong together have different lengths.
    Lengths {
        /// The array that differs.
        what: &'static str,
        /// Its length.
        got: usize,
        /// The length it should have.
        want: usize,
    },
    /// A derivative order that is not offered.
    Order {
        /// The order asked for.
        got: usize,
        /// The highest order.
        highest: usize,
    },
    /// A link, circuit or sample count outside its range.
    Range {
        /// What was counted.
        what: &'static str,
        /// The value.
        got: usize,
        /// The least allowed.
        least: usize,
        /// The greatest allowed.
        greatest: usize,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite { what, index, value } => {
                write!(f, "{what}[{index}]: {value} is not a finite number")
            }
            Self::NoLength { link } => write!(f, "link {link}: its two joints coincide, so it has no length"),
            Self::Lengths { what, got, want } => write!(f, "{what}: {got} values where {want} are needed"),
            Self::Order { got, highest } => write!(f, "order: {got} is not offered; give 0 to {highest}"),
            Self::Range { what, got, least, greatest } => {
                write!(f, "{what}: {got} is outside {least} to {greatest}")
            }
        }
    }
}

impl std::error::Error for Error {}
