//! Several loops as one equation `e(q) = 0`: a tree of links closed by the rows of chords, `A = de/dq`, and the order in which blocks are solved.
//!
//! From below: `order`, `series`, `square`, `steps`, `rows`, `net`, `freedoms`, `joints`, `before`, `unfolded`, `dyads`, `in_plane`, `monodromy`, `planar_family`, `planar_block`, `dual_quaternions`, `body_family`, `hinged`, `two_turns`, `body_block`, `loop_block`, `modes`, `dyad_sides`, `pin_rows`, `dyad_rows`, `branch_ranges`, `dyad_branch_points`, `dyad_quads`, `sized`, `net_rows`, `plane_points`, `described`, `search`, `complex_known`, `complex_members`, `complex_legs`, `complex_loops`, `complex_pieces`, `piece_branch_points`, `account`, `seeds`, `motion`.

// indices of columns and rows run as in the formulas
#![allow(clippy::needless_range_loop)]

mod account;
mod before;
mod body_block;
mod body_family;
mod branch_ranges;
mod complex_known;
mod complex_legs;
mod complex_loops;
mod complex_members;
mod complex_pieces;
mod described;
mod dual_quaternions;
mod dyad_branch_points;
mod dyad_quads;
mod dyad_rows;
mod dyad_sides;
mod dyads;
mod freedoms;
mod hinged;
mod in_plane;
mod joints;
mod loop_block;
mod modes;
mod monodromy;
mod motion;
mod net;
mod net_rows;
mod order;
mod piece_branch_points;
mod pin_rows;
mod planar_block;
mod planar_family;
mod plane_points;
mod rows;
mod search;
mod seeds;
mod series;
mod sized;
mod square;
mod steps;
#[cfg(test)]
mod tests;
mod two_turns;
mod unfolded;

pub use body_block::{BodyBlock, Leg};
pub use described::DescribedNet;
pub use dyads::{Dyad, Pair};
pub use freedoms::Freedoms;
pub use joints::{NetJoint, Reading};
pub use loop_block::{LoopBlock, LoopLink, LoopStep};
pub use modes::{Mode, NetModes, Part, Stage, modes};
pub use motion::{
    FoundMode, NetChangePoint, NetCircuit, NetFollowed, NetMotion, NetThrough, NotFollowed, Over,
    net_circuit_again, net_circuit_through, net_motion, ratio_at_rest, searched_modes,
};
pub use net::{Facing, Net};
pub use net_rows::{NetRow, NetRows};
pub use order::{Block, Edge, Unbalanced, biconnected_parts, blocks};
pub use planar_block::{BlockJoint, PlanarBlock};
pub use rows::Row;
pub use search::Standing;
pub use steps::{Move, Step};
