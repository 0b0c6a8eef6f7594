//! What a survey keeps: why linkages were refused, how their measures are spread, the best of each part of the cube.

use super::draw::CELLS;
use std::f64::consts::PI;

/// Why a linkage was refused, in the order of the questions; or that it does what is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Verdict {
    /// It does what is wanted.
    Found = 0,
    /// The longest length is too many times the shortest link.
    Size = 1,
    /// No input closes it.
    Assembly = 2,
    /// Two limits meet, or nearly do.
    ChangePoint = 3,
    /// It is of another motion type.
    MotionType = 4,
    /// No start of the readings has all of them on one pass.
    Reach = 5,
    /// It transmits too little where it is near enough.
    Transmission = 6,
    /// It is too far off.
    Error = 7,
    /// A ball turns too far in its seat.
    Cone = 8,
}

/// How many verdicts there are.
pub const VERDICTS: usize = 9;

/// Cells of a histogram.
pub const BINS: usize = 36;

/// A linkage worth keeping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// By what it is ranked: less is better.
    pub figure: f64,
    /// Its index.
    pub index: u64,
    /// The branch.
    pub branch: usize,
    /// 1, or -1 where the output is read against its angle.
    pub sense: f64,
    /// The input's angle at its first reading, or at the low end of the swing.
    pub start: f64,
    /// The error [rad].
    pub error: f64,
    /// The least transmission angle.
    pub transmission: f64,
    /// The greatest angle of each ball from its seat; NaN where it was not measured.
    pub cones: [f64; 2],
}

impl Entry {
    /// Better, or as good and earlier: an order in which no two are equal.
    fn is_before(&self, other: &Self) -> bool {
        self.figure < other.figure || (self.figure == other.figure && self.index < other.index)
    }
}

/// Counts by equal steps of a measure from 0 up; the last cell holds what is beyond.
#[derive(Clone, Debug)]
pub struct Histogram {
    /// The width of a cell.
    pub step: f64,
    /// How many fell into each.
    pub counts: [u64; BINS],
}

impl Histogram {
    const fn new(step: f64) -> Self {
        Self { step, counts: [0; BINS] }
    }

    pub(super) fn add(&mut self, value: f64) {
        if value >= 0.0 {
            self.counts[((value / self.step) as usize).min(BINS - 1)] += 1;
        }
    }
}

/// The tally of the linkages of some indices.
#[derive(Clone, Debug)]
pub struct Tally {
    /// How many had each verdict.
    pub verdicts: [u64; VERDICTS],
    /// How many were of each motion type, by its number.
    pub types: [u64; 6],
    /// How many inputs have no, two, or four limits.
    pub limits: [u64; 3],
    /// Swings of outputs that rock.
    pub swing: Histogram,
    /// The turn of the input on the slower stroke, less half a turn.
    pub slow: Histogram,
    /// The least transmission angle over a whole turn.
    pub transmission: Histogram,
    /// Errors from what is wanted.
    pub error: Histogram,
    /// The greatest ball angle of those that were near enough.
    pub cone: Histogram,
    /// Of each verdict the linkage that came nearest to pass.
    pub nearest: [Option<Entry>; VERDICTS],
    cells: Vec<Option<Entry>>,
}

impl Tally {
    pub(super) fn new() -> Self {
        let degree = PI / 180.0;
        Self {
            verdicts: [0; VERDICTS],
            types: [0; 6],
            limits: [0; 3],
            swing: Histogram::new(10.0 * degree),
            slow: Histogram::new(5.0 * degree),
            transmission: Histogram::new(2.5 * degree),
            error: Histogram::new(degree),
            cone: Histogram::new(2.5 * degree),
            nearest: [None; VERDICTS],
            cells: vec![None; 2 * CELLS],
        }
    }

    pub(super) fn count(&mut self, verdict: Verdict) {
        self.verdicts[verdict as usize] += 1;
    }

    /// Counts one that came near, and keeps it if none of its verdict came nearer.
    pub(super) fn near(&mut self, verdict: Verdict, entry: Entry) {
        self.count(verdict);
        keep(&mut self.nearest[verdict as usize], entry);
    }

    /// Counts one that does what is wanted, and keeps the best of each part of the cube.
    pub(super) fn found(&mut self, cell: usize, entry: Entry) {
        self.count(Verdict::Found);
        keep(&mut self.cells[2 * cell + entry.branch], entry);
    }

    /// The best of the parts of the cube with their parts, best first.
    ///
    /// A part among the first so many of all linkages is among the first so many of those indices at which its best is: what is
    /// left out here cannot be missed when tallies are put together.
    pub fn best(&self, count: usize) -> Vec<(usize, Entry)> {
        let mut best: Vec<(usize, Entry)> = self
            .cells
            .iter()
            .enumerate()
            .filter_map(|(cell, entry)| entry.map(|entry| (cell, entry)))
            .collect();
        best.sort_by(|(_, a), (_, b)| a.figure.total_cmp(&b.figure).then(a.index.cmp(&b.index)));
        best.truncate(count);
        best
    }
}

fn keep(place: &mut Option<Entry>, entry: Entry) {
    if place.is_none_or(|known| entry.is_before(&known)) {
        *place = Some(entry);
    }
}
