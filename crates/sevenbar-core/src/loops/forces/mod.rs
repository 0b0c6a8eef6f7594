//! `A^T lambda = load`: the input's torque and the wrench that runs round the loop, by the transpose of the matrix of the rates.

pub(super) mod acting;
pub(super) mod reactions;
mod stations;
