//! Any single closed loop as one equation `e(q, p) = 0`, q its joints and p its numbers, `A = de/dq`: a folder for each question to it.
//!
//! From below: `equation`, `rates`, `mobility`, `numbers`, `forces`, `description`, `modes`, `branch_points`, `circuits`, `motions`.

// indices of columns and rows run as in the formulas
#![allow(clippy::needless_range_loop)]

mod branch_points;
pub(crate) mod circuits;
pub(crate) mod description;
pub(crate) mod equation;
mod forces;
pub(crate) mod mobility;
pub(crate) mod modes;
pub(crate) mod motions;
mod numbers;
pub(crate) mod rates;
#[cfg(test)]
mod tests;

pub use branch_points::counting::{Count, Open, Uncounted};
pub use circuits::found::{Bound, Found, Search};
pub use description::described_loop::{Loop, NO_SIZE};
pub use description::joint_values::drawn_at;
pub use equation::chain::AGREE;
pub(crate) use equation::dense::{least_squares, singular_values};
pub use equation::kinds::Kind;
pub use forces::acting::{Acting, Body, JointSpring, Load, Place, PointSpring};
pub use forces::reactions::{Reactions, Seat, reactions};
pub use mobility::at_rest::Still;
pub use mobility::idle::Idle;
pub use modes::assembly::{Modes, modes};
pub use modes::finder::Completeness;
pub use motions::circuit::{Circuit, Course, Followed};
pub use motions::measures::{Driven, Measures, measures};
pub use motions::motion::{ChangePoint, Motion, mobility, motion};
pub use motions::rows::{ROW_NUMBERS, Rows, Tally, joint_table, point};
pub use motions::through::{Through, circuit_again, circuit_through};
pub use numbers::factors::{Axis, DrawnFrame, Factor, Held, Product, Three};
pub use numbers::numbered_loop::NumberedLoop;
pub use numbers::slopes::slopes;
pub use numbers::word::{Carried, Word};
