//! What is known of a net while its input is held at a complex value: where links are, and all solutions of a piece.
//!
//! Source: docs/theory_nets.md, (29).

use super::before::{Ahead, Before, ahead};
use super::branch_ranges::Inputs;
use super::modes::at_first;
use super::monodromy::FAR;
use super::net::Net;
use super::rows::On;
use super::steps::{ComplexPose, Placement};
use crate::rigid::Pose;
use num_complex::Complex64;

/// A net whose input is held at complex values.
#[derive(Clone, Copy)]
pub(super) struct Held<'a> {
    pub net: &'a Net,
    pub driven: usize,
    pub inputs: Inputs,
}

/// What is known before a piece is solved: the input, what it moves, and where links are.
#[derive(Clone)]
pub(super) struct Known {
    pub input: Complex64,
    pub moved: ComplexPose,
    pub poses: Vec<ComplexPose>,
}

/// Where the steps of a piece lead.
pub(super) type Own = Vec<(usize, ComplexPose)>;

/// All solutions of a piece.
pub(super) struct Solved {
    pub solutions: Vec<Own>,
    /// What vanishes where two of them meet, and where what hangs at one is infinite; of many factors only their phase.
    pub meets: Complex64,
    pub finite: Complex64,
    /// Sums over them of what is infinite where one of them is, or where what `meets` has a pole.
    pub sums: [Complex64; FAR],
}

/// A root of less, as a part of its greatest, is zero.
const NOTHING: f64 = 1e-20;

impl<'a> Held<'a> {
    /// From which step the held one leads.
    pub fn from(&self) -> On {
        self.net.steps[self.driven].parent
    }

    /// What is known before the first piece is solved.
    pub fn known(&self, input: Complex64) -> Known {
        let unit = if self.net.slides(self.driven) {
            self.net.size
        } else {
            1.0
        };
        let moved = self.net.steps[self.driven].moved(input * unit);
        let mut poses = vec![Placement::still(); self.net.steps.len()];
        if self.from().is_none() {
            poses[self.driven] = moved;
        }
        Known { input, moved, poses }
    }

    /// What is known before one where others are, their poses being of any numbers.
    pub fn before<'b>(&self, poses: &'b [Pose]) -> Before<'b> {
        Before {
            poses,
            held: self.driven,
            from: self.from(),
            moved: Pose::STILL,
            size: self.net.size,
        }
    }

    /// What goes for a block with the input at a value, before any other is placed.
    pub fn at_first<T>(&self, value: f64, work: impl Fn(&Before) -> T) -> T {
        at_first(self.net, self.driven, value, work)
    }

    /// Whether a link is where the held step moves it from the ground.
    pub fn is_driven(&self, link: usize) -> bool {
        link == self.driven && self.from().is_none()
    }

    /// Whether a pose has imaginary parts of less than this [relative to the size].
    pub fn is_nearly_real(&self, pose: &ComplexPose, part: f64) -> bool {
        let turned = pose.rotation.iter().flatten().all(|x| x.im.abs() < part);
        turned && pose.translation.iter().all(|x| x.im.abs() < part * self.net.size)
    }

    /// Whether no link of two solutions is farther off than this [relative to the size, or to itself].
    pub fn are_near(&self, a: &Own, b: &Own, part: f64) -> bool {
        let near = |a: Complex64, b: Complex64, unit: f64| (a - b).norm() < part * (unit + a.norm());
        a.iter().zip(b).all(|((_, a), (_, b))| {
            let mut turned = a.rotation.iter().flatten().zip(b.rotation.iter().flatten());
            let mut moved = a.translation.iter().zip(&b.translation);
            turned.all(|(a, b)| near(*a, *b, 1.0)) && moved.all(|(a, b)| near(*a, *b, self.net.size))
        })
    }

    /// The pose of a link against another that is the same one, or that the held step welds to it; `None` of any other.
    pub fn offset(&self, known: &Known, on: On, link: usize) -> Option<ComplexPose> {
        Some(match ahead(on, link, self.driven, self.from())? {
            Ahead::Not => Placement::still(),
            Ahead::ByHeld => known.moved,
            Ahead::BehindHeld => known.moved.inverse(),
        })
    }

    /// The link that the held step welds to one of these, with that one.
    pub fn welded(&self, links: &[usize]) -> Option<[usize; 2]> {
        let from = self.from()?;
        let both = [[from, self.driven], [self.driven, from]];
        let is_one = |[one, other]: &[usize; 2]| links.contains(one) && !links.contains(other);
        both.into_iter().find(is_one)
    }

    /// Adds the link that the held step welds to one that is placed.
    pub fn weld(&self, known: &Known, own: &mut Own) {
        let links: Vec<usize> = own.iter().map(|(link, _)| *link).collect();
        let Some([one, other]) = self.welded(&links) else {
            return;
        };
        let by = if other == self.driven {
            known.moved
        } else {
            known.moved.inverse()
        };
        let placed = own.iter().find(|(link, _)| *link == one);
        if let Some(pose) = placed.map(|(_, pose)| pose.then(&by)) {
            own.push((other, pose));
        }
    }
}

impl Solved {
    /// Whether there are solutions, of which no two are one, nor any at infinity.
    pub fn is_regular(&self) -> bool {
        !self.solutions.is_empty()
            && [self.meets, self.finite]
                .iter()
                .all(|x| x.is_finite() && x.norm() > NOTHING)
    }

    /// In closed form: by a root that vanishes where two meet, as a part of its greatest.
    pub fn in_closed_form(solutions: Vec<Own>, root: Complex64, finite: Complex64) -> Self {
        Self { solutions, meets: root, finite, sums: [Complex64::ZERO; FAR] }
    }
}
