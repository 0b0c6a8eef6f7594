//! `e(q) = 0` followed over the reals along `A t = 0`, `|t| = 1`: every curve of a chain, and the change points at which curves meet.

mod arcs;
mod change_points;
pub(super) mod curve;
pub(super) mod follow;
pub(super) mod found;
pub(super) mod join;
pub(super) mod known_curves;
mod meetings;
pub(super) mod on_curve;
pub(super) mod search;
mod sphere;
#[cfg(test)]
mod tests;
pub(super) mod turnings;
pub(super) mod walked_again;
