//! The result of a search for a loop's circuits.

use crate::loops::branch_points::counting::{Count, Uncounted};
use crate::loops::modes::finder::Completeness;

/// How freely a loop moves, as found in its poses.
#[derive(Clone, Debug)]
pub struct Found {
    /// Rank of the joints' screws, idle freedoms aside.
    pub rank: usize,
    /// What the redundant constraints bear, a basis, a number for each row of the closure: moment and force in the frame of the first joint.
    pub redundant: Vec<Vec<f64>>,
    /// Freedoms of the motion as found.
    pub finite: usize,
}

/// A bound of work at which a search stops short.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bound {
    /// Curves followed over the most steps without an end.
    LongCurves,
    /// Places searched for ways out as change points are.
    ChangePoints,
    /// Nodes kept of curves between change points.
    Memory,
}

impl Bound {
    /// The word for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::LongCurves => "long-curves",
            Self::ChangePoints => "change-points",
            Self::Memory => "memory",
        }
    }
}

/// Where modes were looked for, and what was found out about them.
#[derive(Clone, Debug)]
pub struct Search {
    /// How freely the loop moves; `None` where it was not found in any pose.
    pub found: Option<Found>,
    /// How completely the modes at the values looked at are known.
    pub completeness: Completeness,
    /// Columns at whose values all modes were found.
    pub columns: Vec<usize>,
    /// How many values of each.
    pub values: usize,
    /// Modes there that run into a place where the motion is not smooth, or do not move.
    pub unfollowed: usize,
    /// The bound of work at which the search stopped short, if it did.
    pub bound: Option<Bound>,
    /// By how much redundant constraints keep other poses there open, least first [rad, or relative to the size].
    pub open_by: Vec<f64>,
    /// The account of the branch points of the first column, or why there is none.
    pub count: Result<Count, Uncounted>,
}

impl Search {
    /// Before anything was looked at.
    pub(crate) fn new(completeness: Completeness) -> Self {
        Self {
            found: None,
            completeness,
            columns: Vec::new(),
            values: 0,
            unfollowed: 0,
            bound: None,
            open_by: Vec::new(),
            count: Err(Uncounted::Searched),
        }
    }

    /// Whether all branch points of the first column are accounted for.
    pub fn is_counted(&self) -> bool {
        self.count.as_ref().is_ok_and(|c| c.open.is_empty())
    }
}
