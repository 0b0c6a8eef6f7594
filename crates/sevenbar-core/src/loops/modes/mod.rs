//! `e(q) = 0` with the input held, solved over C: every assembly mode, and how complete they are.

pub(crate) mod assembly;
mod chain_closure;
pub(crate) mod circle;
pub(crate) mod completeness;
pub(crate) mod complex_links;
pub(crate) mod continuation;
pub(crate) mod curves_at_input;
pub(crate) mod finder;
mod geometry;
pub(crate) mod many_starts;
pub(crate) mod phases;
mod poles;
pub(crate) mod polish;
pub(crate) mod starts;
mod straight;
