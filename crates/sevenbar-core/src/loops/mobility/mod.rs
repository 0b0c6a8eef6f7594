//! `A u = 0` and `A^T w = 0`: the rank of A, freedoms that are idle, wrenches that no joint yields to, poses at which A loses rank.

pub(super) mod at_rest;
pub(super) mod idle;
pub(super) mod rank;
pub(super) mod singular_place;
