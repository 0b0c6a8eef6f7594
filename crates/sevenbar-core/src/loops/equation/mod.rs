//! The equation `e(q) = 0` of a chain: the closed product of its joints and links, with the screws `A = de/dq`; over the reals and over C.

pub(crate) mod chain;
pub(crate) mod closed;
pub(crate) mod closure;
pub(crate) mod complex_frame;
pub(crate) mod dense;
pub(crate) mod flat;
pub(crate) mod free_direction;
pub(crate) mod kinds;
pub(crate) mod lanes;
pub(crate) mod rotations;
pub(crate) mod screws;
