//! A member of a family whose known links have complex poses, and all of its solutions, carried on from those where it was before.
//!
//! Its numbers are polynomials in the poses of these links, and in `e^(i t)` and `e^(-i t)` of an input that turns, in one that slides; so those
//! at some real poses or inputs give them at complex ones.
//!
//! Source: docs/theory_nets.md, (27) and (29).

use super::branch_ranges::{Inputs, turned};
use super::monodromy::{FAR, Family, Starts, carried};
use super::steps::ComplexPose;
use crate::loops::equation::closure::Solution;
use crate::loops::modes::continuation::determinants;
use crate::loops::modes::starts::distinct;
use crate::rigid::Pose;
use num_complex::Complex64;
use std::array::from_fn;
use std::cell::{Cell, RefCell};
use std::f64::consts::TAU;
use std::sync::Arc;

/// The numbers of a member.
pub(super) type Member<const D: usize> = Vec<[Complex64; D]>;

/// How many members are read, one for each power of `e^(i t)` from -2 to 2, or of a slide up to 4; and where others are compared, as parts of all
/// inputs.
const READ: usize = 5;
const COMPARED: [f64; 2] = [0.068, 0.464];

/// How far along the imaginary part of poses a member is compared with what those nearer say.
const ALONG: f64 = 2.0;

/// A number of a member that differs by less is the same, relative to the size.
const SAME: f64 = 1e-10;

/// Solutions that are nearer are one, to which two paths led.
const MET: f64 = 1e-8;

/// Members at real inputs.
pub(super) struct ReadByInput<const D: usize> {
    inputs: Inputs,
    read: Vec<Member<D>>,
}

impl<const D: usize> ReadByInput<D> {
    /// Reads the members that a block is with the input at values; `None` where it is no polynomial in the input.
    pub fn of(inputs: Inputs, at: impl Fn(f64) -> Option<Member<D>>) -> Option<Self> {
        let read: Option<Vec<Member<D>>> = (0..READ)
            .map(|k| at(inputs.part(k as f64 / READ as f64)))
            .collect();
        let members = Self { inputs, read: read? };
        let agrees = |part: f64| {
            let value = inputs.part(part);
            at(value).is_some_and(|read| are_same(&read, &members.at(value.into())))
        };
        COMPARED.into_iter().all(agrees).then_some(members)
    }

    /// The member at a complex input.
    pub fn at(&self, at: Complex64) -> Member<D> {
        let weights = self.inputs.weights(at);
        let number = |n: usize, d: usize| {
            self.read
                .iter()
                .zip(&weights)
                .map(|(own, by)| own[n][d] * by)
                .sum()
        };
        (0..self.read[0].len())
            .map(|n| from_fn(|d| number(n, d)))
            .collect()
    }
}

fn are_same<const D: usize>(a: &Member<D>, b: &Member<D>) -> bool {
    let same = |(a, b): (&Complex64, &Complex64)| (a - b).norm() < SAME * (1.0 + a.norm());
    a.len() == b.len() && a.as_flattened().iter().zip(b.as_flattened()).all(same)
}

/// Numbers that are quadrics in the entries of poses, at complex poses `P + i Q`, from those at P, P + Q and P - Q.
pub(super) fn at_poses<const D: usize>(
    poses: &[ComplexPose],
    at: impl Fn(&[Pose]) -> Option<Member<D>>,
) -> Option<Member<D>> {
    let [here, ahead, behind] = [0.0, 1.0, -1.0].map(|t| at(&along(poses, t)));
    let (here, ahead, behind) = (here?, ahead?, behind?);
    let number = |n: usize, d: usize| {
        let (line, square) = parts(here[n][d], ahead[n][d], behind[n][d]);
        here[n][d] + Complex64::I * line - square
    };
    Some((0..here.len()).map(|n| from_fn(|d| number(n, d))).collect())
}

/// Whether numbers are quadrics in the entries of poses.
pub(super) fn are_quadrics<const D: usize>(
    poses: &[ComplexPose],
    at: impl Fn(&[Pose]) -> Option<Member<D>>,
) -> bool {
    let [here, ahead, behind, far] = [0.0, 1.0, -1.0, ALONG].map(|t| at(&along(poses, t)));
    let (Some(here), Some(ahead), Some(behind), Some(far)) = (here, ahead, behind, far) else {
        return false;
    };
    let number = |n: usize, d: usize| {
        let (line, square) = parts(here[n][d], ahead[n][d], behind[n][d]);
        here[n][d] + line * ALONG + square * (ALONG * ALONG)
    };
    let made = (0..here.len()).map(|n| from_fn(|d| number(n, d))).collect();
    are_same(&far, &made)
}

/// The factors of t and of its square of a quadric, by its values at 0, 1 and -1.
fn parts(here: Complex64, ahead: Complex64, behind: Complex64) -> (Complex64, Complex64) {
    (0.5 * (ahead - behind), 0.5 * (ahead + behind) - here)
}

/// `P + t Q` of poses `P + i Q`.
fn along(poses: &[ComplexPose], t: f64) -> Vec<Pose> {
    let number = |z: Complex64| z.re + t * z.im;
    let pose = |pose: &ComplexPose| Pose {
        rotation: pose.rotation.map(|row| row.map(number)),
        translation: pose.translation.map(number),
    };
    poses.iter().map(pose).collect()
}

impl Inputs {
    /// An input by its part of all.
    fn part(self, part: f64) -> f64 {
        match self {
            Self::Turn => TAU * part,
            Self::Slide([from, to]) => from + part * (to - from),
        }
    }

    /// What those that were read count at a complex input.
    fn weights(self, at: Complex64) -> [Complex64; READ] {
        let read: [f64; READ] = from_fn(|k| self.part(k as f64 / READ as f64));
        match self {
            Self::Turn => read.map(|own| {
                let step = (Complex64::I * (at - own)).exp();
                (1.0 + step + step.inv() + step * step + (step * step).inv()) / READ as f64
            }),
            Self::Slide(_) => from_fn(|k| {
                let others = (0..READ).filter(|other| *other != k);
                others
                    .map(|other| (at - read[other]) / (read[k] - read[other]))
                    .product()
            }),
        }
    }
}

/// A member and its solutions.
type Solved<const N: usize, const D: usize> = (Member<D>, Vec<Solution<N>>);

/// Members of a family, one for each way of what they hang at, with all solutions of each.
pub(super) struct CarriedMembers<F, const N: usize, const D: usize> {
    family: F,
    starts: Arc<Starts<N, D>>,
    /// Where solutions were found last.
    last: RefCell<Vec<Solved<N, D>>>,
    /// How often they were found anew, in another order.
    restarts: Cell<usize>,
}

impl<F: Family<N, D>, const N: usize, const D: usize> CarriedMembers<F, N, D> {
    /// Of a family; `None` where not all solutions of a general member are known.
    pub fn of(family: F, starts: Arc<Starts<N, D>>) -> Option<Self> {
        starts
            .certified
            .then(|| Self { family, starts, last: RefCell::default(), restarts: Cell::default() })
    }

    /// How often solutions were found anew: each time they may be in another order.
    pub fn restarts(&self) -> usize {
        self.restarts.get()
    }

    /// All solutions of a member for one way: found at first, then carried from where it was; `None` where some are lost.
    pub fn solved(&self, way: usize, member: &[[Complex64; D]]) -> Option<Vec<Solution<N>>> {
        let mut last = self.last.borrow_mut();
        let count = last.first().map(|(_, solutions)| solutions.len());
        let solutions = match last.get(way) {
            Some((from, solutions)) => {
                let carried = carried(&self.family, (from, solutions), member);
                distinct(&self.family.slides(), carried.into_iter(), MET)
            }
            None => Vec::new(),
        };
        let solutions = if solutions.is_empty() || count.is_some_and(|count| solutions.len() < count) {
            self.restarts.set(self.restarts.get() + 1);
            let ends = self.starts.ends(&self.family, member);
            if ends.left_over > 0 && count.is_none() {
                return None;
            }
            ends.regular
        } else {
            solutions
        };
        if count.is_some_and(|count| count != solutions.len()) {
            return None;
        }
        let next = (member.to_vec(), solutions.clone());
        match last.get_mut(way) {
            Some(last) => *last = next,
            None => last.push(next),
        }
        Some(solutions)
    }

    /// The phase of the product over all solutions of what vanishes where two meet, and the sums of what is infinite where one is.
    pub fn measured(
        &self,
        member: &[[Complex64; D]],
        solutions: &[Solution<N>],
    ) -> (Complex64, [Complex64; FAR]) {
        let here = self.family.between(member, member);
        let (mut phase, mut sums) = (Complex64::ONE, [Complex64::ZERO; FAR]);
        for (x, determinant) in solutions.iter().zip(determinants(&here, solutions)) {
            let (meets, far) = self.family.measures(x, determinant);
            phase = turned(phase, meets);
            for (sum, far) in sums.iter_mut().zip(far) {
                *sum += far;
            }
        }
        (phase, sums)
    }
}
