//! `A u = 0` and `A^T w = 0`: the rank of A, freedoms that are idle, wrenches that no joint yields to, poses at which A loses rank.

pub(crate) mod at_rest;
pub(crate) mod idle;
pub(crate) mod rank;
pub(crate) mod singular_place;
