//! `e(q) = 0` with the input held, solved over C: every assembly mode, and how complete they are.

pub(super) mod assembly;
mod chain_closure;
pub(super) mod circle;
mod completeness;
pub(super) mod continuation;
mod curves_at_input;
pub(super) mod finder;
mod geometry;
pub(super) mod many_starts;
pub(super) mod phases;
mod poles;
pub(super) mod polish;
pub(super) mod starts;
mod straight;
