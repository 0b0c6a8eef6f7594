//! Several loops as one equation `e(q) = 0`: a tree of links closed by the rows of chords, `A = de/dq`, and the order in which blocks are solved.
//!
//! From below: `order`, `tree`, `rows`, `freedoms`.

mod freedoms;
mod order;
mod rows;
mod tree;

pub use freedoms::{Freedoms, freedoms};
pub use order::{Block, Edge, Unbalanced, biconnected_parts, blocks};
pub use rows::Row;
pub use tree::{Move, Net, Step};
