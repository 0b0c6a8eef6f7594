//! The equation `e(q) = 0` of a chain: the closed product of its joints and links, with the screws `A = de/dq`; over the reals and over C.

pub(super) mod chain;
pub(super) mod closed;
pub(super) mod closure;
pub(super) mod complex_frame;
pub(super) mod dense;
pub(super) mod flat;
pub(super) mod kinds;
pub(super) mod lanes;
pub(super) mod rotations;
pub(super) mod screws;
