//! Any single closed loop: mobility, every assembly mode, whole circuits, rates.

// indices of columns and rows run as in the formulas
#![allow(clippy::needless_range_loop)]

mod afar;
mod arcs;
mod assembly;
mod chain;
mod chain_closure;
mod change_points;
mod circle;
mod circuit;
mod closure;
mod complex_frame;
mod continuation;
mod counting;
mod curve;
mod dense;
mod description;
mod extremes;
mod flat;
mod follow;
mod found;
mod geometry;
mod idle;
mod join;
mod kinds;
mod known_curves;
mod lanes;
mod locating;
mod many_starts;
mod measures;
mod meetings;
mod modes;
mod motion;
mod motions;
mod number_slopes;
mod numbers;
mod on_curve;
mod other_input;
mod passes;
mod phases;
mod poles;
mod polish;
mod rates;
mod reduce;
mod rotations;
mod row;
mod row_lanes;
mod rows;
mod screws;
mod search;
mod sectors;
mod singular_place;
mod spin_axis;
mod spun;
mod starts;
mod straight;
mod survey;
#[cfg(test)]
mod tests;
mod turnings;

pub use assembly::{Modes, modes};
pub use chain::AGREE;
pub use circuit::Circuit;
pub use counting::{Count, Open, Uncounted};
pub use description::Loop;
pub use found::{Found, Search};
pub use idle::Idle;
pub use kinds::Kind;
pub use measures::{Driven, Measures, measures};
pub use modes::Completeness;
pub use motion::{ChangePoint, Motion, Through, circuit_through, mobility, motion};
pub use number_slopes::slopes;
pub use numbers::{Advance, Design, Move, NumberedLoop, NumberedPoint};
pub use rows::{ROW_NUMBERS, Rows, joint_table, point};
