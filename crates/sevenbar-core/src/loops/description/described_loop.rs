//! A loop as it is described, with the chain that is followed for it.

use super::reduce::{Reduced, Source, reduce};
use crate::loops::equation::kinds::Kind;
use crate::loops::mobility::idle::Idle;
use crate::outcome::Role;
use crate::rigid::{Pose, norm};
use std::f64::consts::TAU;

/// Links whose lengths together are below this share of the distance from the origin to the loop have no length: such
/// differences of coordinates are rounding, of three products for each of seven links.
pub const NO_SIZE: f64 = 64.0 * f64::EPSILON;

/// A range [rad] that exceeds a turn by less is one turn, between ends that are exact to rounding: a joint that rocks from -pi to pi.
const ONE_TURN: f64 = 1e-9;

/// A column of joint values, in the description and in the chain.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Column {
    pub outer: usize,
    pub inner: usize,
}

/// A closed loop of joints: `base Z1 G1 Z2 .. Zn = ground`.
#[derive(Clone, Debug)]
pub struct Loop {
    pub(crate) reduced: Reduced,
    /// The sum of the links' lengths and of the pitches per radian. Inside the core, lengths are relative to it.
    pub(crate) size: f64,
    /// The first column of each joint.
    pub(super) first: Vec<usize>,
    pub(crate) columns: usize,
}

/// What is known of the columns of a description by those that are followed for them.
pub(crate) trait Described {
    /// The size [length] of which lengths are parts where it is followed.
    fn size(&self) -> f64;

    /// How many columns it has.
    fn columns(&self) -> usize;

    /// The column that is followed for one of the description; `None` where its value is another thing.
    fn followed_column(&self, column: usize) -> Option<usize>;

    /// Whether a column is a length.
    fn is_slide(&self, column: usize) -> bool;

    /// The factor from a value of a column to the value that is followed: lengths are relative to the size there.
    fn inward(&self, column: usize) -> f64 {
        if self.is_slide(column) {
            1.0 / self.size()
        } else {
            1.0
        }
    }

    /// What a column does on a circuit. `endless`: the circuit has no ends, and was followed until a joint was far out.
    fn role(&self, column: Column, range: Option<[f64; 2]>, endless: bool) -> Role {
        match range {
            _ if self.is_slide(column.outer) => Role::Slider,
            Some([low, high]) if endless && high - low > TAU + ONE_TURN => Role::Spindle,
            Some(_) => Role::Rocker,
            None => Role::Crank,
        }
    }
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
        // a spherical linkage that is drawn in one point has no lengths
        let reach = norm(base.translation).max(norm(ground.translation));
        let size = if size > NO_SIZE * reach { size } else { 1.0 };
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

    /// The same with redundant constraints that agree up to a closure error [rad, or relative to the size]; [`super::AGREE`] by default.
    pub fn agreeing(mut self, agree: f64) -> Self {
        if let Some(chain) = &mut self.reduced.chain {
            chain.agree = agree;
        }
        self
    }

    /// The size [length] to which closure errors are relative.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// How many columns of joint values there are.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Freedoms that move no other part of the loop.
    pub fn idle(&self) -> &[Idle] {
        &self.reduced.idle
    }

    /// Balls that hold an idle spin: the joint, and an axis in the frame before it. A direction of the link stays at right angles to it.
    pub fn spin_axes(&self) -> Vec<(usize, [f64; 3])> {
        let parts = self.reduced.parts.iter().enumerate();
        parts
            .filter_map(|(joint, part)| match part.source {
                Source::Universal(_, frame) => Some((joint, frame.map(|row| row[2]))),
                _ => None,
            })
            .collect()
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
    pub(crate) fn joint_of(&self, column: usize) -> usize {
        self.first.partition_point(|&f| f <= column).saturating_sub(1)
    }

    /// The chain's column of a column of the description; `None` for a ball's turn or a held joint.
    pub(crate) fn chain_column(&self, column: usize) -> Option<usize> {
        let joint = self.joint_of(column);
        let chain = self.reduced.chain.as_ref()?;
        match (self.reduced.parts[joint].source, self.reduced.parts[joint].kind) {
            (Source::Joint(_), Kind::Ball) => None,
            (Source::Joint(j), _) => Some(chain.first[j]),
            _ => None,
        }
    }

    /// A column that can be input or output; `None` unless it is a moving joint of one freedom.
    pub(crate) fn inner(&self, outer: usize) -> Option<Column> {
        Some(Column { outer, inner: self.chain_column(outer)? })
    }
}

impl Described for Loop {
    fn size(&self) -> f64 {
        self.size
    }

    fn columns(&self) -> usize {
        self.columns
    }

    fn followed_column(&self, column: usize) -> Option<usize> {
        self.chain_column(column)
    }

    fn is_slide(&self, column: usize) -> bool {
        self.reduced.parts[self.joint_of(column)].kind == Kind::Slide
    }
}
