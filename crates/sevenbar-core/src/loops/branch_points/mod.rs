//! `e(q) = 0` and `det J = 0` over C, J the screws without the input's: branch points of the input, located and counted.

mod afar;
pub(super) mod counting;
mod locating;
mod other_input;
pub(super) mod sectors;
pub(super) mod survey;
