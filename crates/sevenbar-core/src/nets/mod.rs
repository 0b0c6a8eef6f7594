//! Several loops as one equation `e(q) = 0`: a tree of links closed by the rows of chords, `A = de/dq`, and the order in which blocks are solved.
//!
//! From below: `order`, `steps`, `rows`, `net`, `freedoms`, `dyads`, `modes`.

mod dyads;
mod freedoms;
mod modes;
mod net;
mod order;
mod rows;
mod steps;

pub use dyads::{Dyad, Pair};
pub use freedoms::{Freedoms, freedoms};
pub use modes::{Mode, Stage, modes};
pub use net::Net;
pub use order::{Block, Edge, Unbalanced, biconnected_parts, blocks};
pub use rows::Row;
pub use steps::{Move, Step};
