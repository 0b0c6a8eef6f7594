//! `e(q) = 0` followed over the reals along `A t = 0`, `|t| = 1`: every curve of a chain, and the change points at which curves meet.

mod arcs;
pub(crate) mod change_points;
pub(crate) mod curve;
pub(crate) mod follow;
pub(crate) mod found;
pub(crate) mod join;
pub(crate) mod known_curves;
mod meetings;
pub(crate) mod on_curve;
pub(crate) mod search;
mod sphere;
#[cfg(test)]
mod tests;
pub(crate) mod turnings;
pub(crate) mod walked_again;
