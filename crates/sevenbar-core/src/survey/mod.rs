//! Many RSSRs drawn from a sequence, each judged by what is wanted of it, and none stored but the best.
//!
//! The axes have any angle: the crank turns about z and carries its ball round (0, 0, N); the rocker turns about
//! `(sin, 0, cos)` of the angle, M along it from (0, D, 0). At a right angle this is the paper's layout.
//!
//! Source: docs/theory_many.md, (21) to (23).

mod cascade;
mod cone;
mod draw;
mod figures;
mod judge;
mod kind;
mod pose;
mod readings;
mod swing;
mod tally;
mod transmission;
mod wish;

pub use cascade::{figures, survey};
pub use draw::{Draw, NUMBERS};
pub use figures::Figures;
pub use tally::{BINS, Entry, Histogram, Tally, VERDICTS, Verdict};
pub use wish::{Rank, Readings, Want, Wish};
