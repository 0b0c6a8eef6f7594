//! `e(q) = 0` at each input along a circuit, with its rates: rows, dead centres, extremes, and the whole motion of a loop.

pub(super) mod circuit;
mod extremes;
pub(super) mod measures;
mod met_twice;
pub(super) mod motion;
pub(super) mod passes;
mod row;
mod row_lanes;
pub(super) mod rows;
