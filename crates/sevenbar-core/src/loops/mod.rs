//! Any single closed loop: mobility, every assembly mode, whole circuits, rates.

// indices of columns and rows run as in the formulas
#![allow(clippy::needless_range_loop)]

mod afar;
mod all_curves;
mod arcs;
mod around;
mod chain;
mod change_points;
mod circuits;
mod counting;
mod curve;
mod dense;
mod extremes;
mod geometry;
mod idle;
mod lanes;
mod locating;
mod many;
mod measures;
mod meetings;
mod modes;
mod motion;
mod numbers;
mod paths;
mod phases;
mod pieces;
mod poles;
mod polish;
mod rates;
mod reduce;
mod rows;
mod spun;
mod starts;
mod survey;
#[cfg(test)]
mod tests;
mod turnings;
mod walk;

pub use all_curves::Found;
pub use counting::{Count, Open, Uncounted};
pub use extremes::Ends;
pub use idle::Idle;
pub use measures::{CircuitMeasures, Driven, Measures};
pub use modes::Completeness;
pub use motion::{ChangePoint, Circuit, Motion, Through};
pub use numbers::{Advance, Design, Move, NumberedLoop, NumberedPoint};
pub use polish::AGREE;
pub use reduce::Kind;
pub use rows::{ROW_NUMBERS, Rows};

use crate::rigid::{Pose, norm};
use reduce::{Reduced, Source, reduce};

/// A closed loop of joints: `base Z1 G1 Z2 .. Zn = ground`.
#[derive(Clone, Debug)]
pub struct Loop {
    reduced: Reduced,
    /// The sum of the links' lengths; inside, lengths are parts of it.
    size: f64,
    /// The first column of each joint.
    first: Vec<usize>,
    columns: usize,
}

/// All assembly modes at one input.
#[derive(Clone, Debug)]
pub struct Modes {
    /// The joint values of each, and its closure error in parts of the size or radians.
    pub modes: Vec<(Vec<f64>, f64)>,
    /// How complete they are.
    pub completeness: Completeness,
    /// By how much redundant constraints keep other poses open, least first [rad, or parts of the size].
    pub misfits: Vec<f64>,
}

impl Loop {
    /// From the kinds of the joints, the frames of the first joint and of the ground's side of the last, and the transforms of the
    /// moving links, one fewer than joints.
    pub fn new(kinds: &[Kind], base: Pose, ground: Pose, links: &[Pose]) -> Self {
        let closing = ground.inverse().then(&base);
        let pitches = kinds
            .iter()
            .map(|k| if let Kind::Screw(a) = k { a.abs() } else { 0.0 });
        let size: f64 = links
            .iter()
            .chain([&closing])
            .map(|l| norm(l.translation))
            .chain(pitches)
            .sum();
        // a spherical linkage has no lengths
        let size = if size > 0.0 { size } else { 1.0 };
        let small = |p: &Pose| Pose { rotation: p.rotation, translation: p.translation.map(|x| x / size) };
        let kinds: Vec<Kind> = kinds
            .iter()
            .map(|k| {
                if let Kind::Screw(a) = k {
                    Kind::Screw(a / size)
                } else {
                    *k
                }
            })
            .collect();
        let links: Vec<Pose> = links.iter().map(small).collect();
        let mut first = Vec::with_capacity(kinds.len());
        let mut columns = 0;
        for kind in &kinds {
            first.push(columns);
            columns += kind.columns();
        }
        Self {
            reduced: reduce(&kinds, &small(&base), &small(&ground), &links),
            size,
            first,
            columns,
        }
    }

    /// The size of which residuals are parts.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// How many columns of joint values there are.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Freedoms that no joint elsewhere takes part in.
    pub fn idle(&self) -> &[Idle] {
        &self.reduced.idle
    }

    /// Freedoms of the joints less the idle ones.
    pub fn freedoms(&self) -> usize {
        self.reduced.freedoms
    }

    /// Whether no more than one freedom can remain, and every idle one is held, so that one input may drive it.
    pub fn can_be_driven(&self) -> bool {
        self.reduced.chain.is_some()
    }

    /// The joint of a column.
    fn joint_of(&self, column: usize) -> usize {
        self.first.partition_point(|&f| f <= column).saturating_sub(1)
    }

    /// The chain's column of a column of the description; `None` for a ball's turn or a held joint.
    fn chain_column(&self, column: usize) -> Option<usize> {
        let joint = self.joint_of(column);
        let chain = self.reduced.chain.as_ref()?;
        match (self.reduced.parts[joint].source, self.reduced.parts[joint].kind) {
            (Source::Joint(_), Kind::Ball) => None,
            (Source::Joint(j), _) => Some(chain.first[j]),
            _ => None,
        }
    }

    /// Whether a column is a length.
    fn is_slide(&self, column: usize) -> bool {
        self.reduced.parts[self.joint_of(column)].kind == Kind::Slide
    }

    /// A value of a column as the chain has it.
    fn inward(&self, column: usize) -> f64 {
        if self.is_slide(column) {
            1.0 / self.size
        } else {
            1.0
        }
    }

    /// Every assembly mode at one value of a column [rad, or length]; `None` where that column is no input.
    pub fn modes(&self, column: usize, value: f64) -> Option<Modes> {
        let chain = self.reduced.chain.as_ref()?;
        let input = self.chain_column(column)?;
        let finder = modes::ModeFinder::new(chain, input);
        let value = value * self.inward(column);
        let mut found = finder.once(value);
        let mut completeness = finder.completeness();
        if found.modes.is_empty() && finder.is_degenerate() {
            found.modes.extend(finder.one_by_search(value));
            completeness = Completeness::Searched;
        }
        found.misfits.sort_by(f64::total_cmp);
        let closed = |at| (self.joint_values(at), chain.residual(&chain.place(at)));
        Some(Modes {
            modes: found.modes.iter().map(closed).collect(),
            completeness,
            misfits: found.misfits,
        })
    }
}
