//! `e(q) = 0` at each input along a circuit, with its rates: rows, dead centres, extremes, and the whole motion of a loop.

pub(crate) mod circuit;
mod extremes;
pub(crate) mod measures;
mod met_twice;
pub(crate) mod motion;
pub(crate) mod passes;
pub(crate) mod row;
mod row_lanes;
pub(crate) mod row_store;
pub(crate) mod rows;
pub(crate) mod through;
