//! Every assembly mode of a described loop.

use super::curves_at_input::pose_on_curve;
use super::finder::{Completeness, ModeFinder};
use crate::loops::description::described_loop::{Described, Loop};
use crate::loops::description::joint_values::joint_values;
use crate::loops::equation::closed::Closed;
use crate::one_pose::each_once;

/// All assembly modes at one input.
#[derive(Clone, Debug)]
pub struct Modes {
    /// The joint values of each, and its closure error relative to the size or radians.
    pub modes: Vec<(Vec<f64>, f64)>,
    /// How complete they are.
    pub completeness: Completeness,
    /// Closure errors of further poses that redundant constraints keep from closing, least first [rad, or relative to the size].
    pub open_by: Vec<f64>,
    /// The joint values of a pose on a curve of poses that all close at this input, if one was found.
    pub on_curve: Option<Vec<f64>>,
}

/// Every assembly mode at one value of a column [rad, or length]; `None` where that column is no input.
pub fn modes(linkage: &Loop, column: usize, value: f64) -> Option<Modes> {
    let chain = linkage.reduced.chain.as_ref()?;
    let input = linkage.chain_column(column)?;
    let mut finder = ModeFinder::new(chain, input);
    let value = value * linkage.inward(column);
    let (mut found, mut fewer) = finder.once(value);
    if fewer && let Some(better) = finder.better_placed() {
        finder = better;
        (found, fewer) = finder.once(value);
    }
    let mut completeness = finder.completeness();
    if found.modes.is_empty() && finder.is_degenerate() {
        found.modes.extend(finder.one_by_search(value));
        completeness = Completeness::Searched;
    }
    found.open_by.sort_by(f64::total_cmp);
    let on_curve = fewer.then(|| pose_on_curve(chain, input, value)).flatten();
    let closed = |at| (joint_values(linkage, at), chain.residual(&chain.place(at)));
    Some(Modes {
        modes: each_once(found.modes.iter().map(closed).collect(), |column| {
            linkage.is_slide(column).then(|| linkage.size())
        }),
        completeness,
        open_by: found.open_by,
        on_curve: on_curve.map(|at| joint_values(linkage, &at)),
    })
}
