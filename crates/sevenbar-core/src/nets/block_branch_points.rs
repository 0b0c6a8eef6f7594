//! The functions by which branch points of a net of one block are counted: inputs at which two of its solutions meet.
//!
//! A member of a family is a polynomial in `e^(i t)` and `e^(-i t)` of an input that turns, in one that slides, so it is known at complex inputs,
//! too. There all of its solutions are carried on from those at another one.
//!
//! Source: docs/theory_nets.md, (27).

use super::body_family::BodyFamily;
use super::branch_ranges::{Counted, Functions, Inputs, Values, turned};
use super::modes::{Part, at_first};
use super::monodromy::{Family, Starts, carried};
use super::net::Net;
use super::planar_family::PlanarFamily;
use crate::loops::equation::closure::Solution;
use crate::loops::equation::lanes::Lanes;
use crate::loops::modes::continuation::Homotopy;
use crate::loops::modes::starts::{distinct, same};
use crate::vectors::{LANES, Plain, Reals, Vector};
use num_complex::Complex64;
use std::array::from_fn;
use std::cell::RefCell;
use std::f64::consts::TAU;
use std::sync::Arc;

/// How many members are read, one for each power of `e^(i t)` from -2 to 2, or of a slide up to 4; and where others are compared, as parts of all
/// inputs.
const READ: usize = 5;
const COMPARED: [f64; 2] = [0.068, 0.464];

/// A number of a member that differs by less is the same, relative to the size.
const SAME: f64 = 1e-10;

/// Solutions that are nearer are one, to which two paths led.
const MET: f64 = 1e-8;

/// Solutions that are farther apart do not meet within a millionth of a radian.
const NEAR: f64 = 0.03;

/// A complex input at which solutions are found first.
const FIRST: Complex64 = Complex64::new(0.713, 0.31);

/// A member of a family.
type Member<const D: usize> = Vec<[Complex64; D]>;

/// A member and its solutions.
type Solved<const N: usize, const D: usize> = (Member<D>, Vec<Solution<N>>);

/// A block at complex inputs.
struct Block<F, const N: usize, const D: usize> {
    family: F,
    starts: Arc<Starts<N, D>>,
    inputs: Inputs,
    /// What was read.
    read: Vec<Member<D>>,
    /// Where solutions were found last.
    last: RefCell<Solved<N, D>>,
}

/// The account of the branch points of an input of a net; `None` where it is not of one block all of whose modes are known.
pub(super) fn counted(net: &Net, parts: &[Part], driven: usize, inputs: Inputs) -> Option<Counted> {
    match parts {
        [Part::Planar(block)] => {
            let member = |value: f64| at_first(net, driven, value, |before| block.member(before));
            Some(Counted::of(
                &Block::of(&member, inputs, PlanarFamily::starts)?,
                inputs,
            ))
        }
        [Part::Body(block)] => {
            let member = |value: f64| at_first(net, driven, value, |before| block.member(net, before));
            Some(Counted::of(
                &Block::of(&member, inputs, BodyFamily::starts)?,
                inputs,
            ))
        }
        _ => None,
    }
}

/// A family and the member that a block is with the input at a value.
type AtInput<'a, F, const D: usize> = &'a dyn Fn(f64) -> Option<(F, Member<D>)>;

impl<F: Family<N, D> + PartialEq, const N: usize, const D: usize> Block<F, N, D> {
    fn of(at: AtInput<F, D>, inputs: Inputs, starts: impl Fn(&F) -> Arc<Starts<N, D>>) -> Option<Self> {
        let (family, _) = at(0.0)?;
        let read = |value: f64| {
            at(value)
                .filter(|(own, _)| *own == family)
                .map(|(_, member)| member)
        };
        let members: Option<Vec<Member<D>>> = (0..READ)
            .map(|k| read(inputs.part(k as f64 / READ as f64)))
            .collect();
        let members = members?;
        for part in COMPARED {
            let value = inputs.part(part);
            let differs = |(a, b): (&[Complex64; D], &[Complex64; D])| {
                a.iter()
                    .zip(b)
                    .any(|(a, b)| (a - b).norm() > SAME * (1.0 + a.norm()))
            };
            let made = member(inputs, &members, value.into());
            if read(value)?.iter().zip(&made).any(differs) {
                return None;
            }
        }
        let starts = starts(&family);
        let first = member(inputs, &members, FIRST);
        let ends = starts.ends(&family, &first);
        let all = starts.certified && ends.left_over == 0;
        all.then(|| Self {
            family,
            starts,
            inputs,
            read: members,
            last: RefCell::new((first, ends.regular)),
        })
    }
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

/// The member at a complex input, from those that were read.
fn member<const D: usize>(inputs: Inputs, read: &[Member<D>], at: Complex64) -> Member<D> {
    let weights = inputs.weights(at);
    let count = read[0].len();
    let number = |n: usize, d: usize| read.iter().zip(&weights).map(|(own, by)| own[n][d] * by).sum();
    (0..count).map(|n| from_fn(|d| number(n, d))).collect()
}

impl<F: Family<N, D>, const N: usize, const D: usize> Block<F, N, D> {
    /// The member at a complex input and all of its solutions; `None` where some are lost.
    fn solved(&self, at: Complex64) -> Option<Solved<N, D>> {
        let member = member(self.inputs, &self.read, at);
        let mut last = self.last.borrow_mut();
        let (slides, count) = (self.family.slides(), last.1.len());
        let carried = carried(&self.family, (&last.0, &last.1), &member);
        let mut solutions = distinct(&slides, carried.into_iter(), MET);
        if solutions.len() < count {
            solutions = self.starts.ends(&self.family, &member).regular;
        }
        if solutions.len() != count {
            return None;
        }
        *last = (member, solutions);
        Some(last.clone())
    }
}

impl<F: Family<N, D>, const N: usize, const D: usize> Functions for Block<F, N, D> {
    /// The product of one measure over all solutions, and the sums of the others.
    fn values(&self, at: Complex64) -> Option<Values> {
        let (member, solutions) = self.solved(at)?;
        let here = self.family.between(&member, &member);
        let mut values = Values::NONE;
        for some in solutions.chunks(LANES) {
            let lanes: [Lanes<Plain>; N] = from_fn(|i| {
                let part = |part: fn(&Complex64) -> f64| -> Reals {
                    from_fn(|k| part(&some.get(k).unwrap_or(&some[0])[i]))
                };
                Lanes::load(&part(|z| z.re), &part(|z| z.im))
            });
            let (.., determinant) = here.linearise::<Plain, false>(&lanes, Lanes::one()).solve();
            let [re, im] = [determinant.re, determinant.im].map(|v| v.store());
            for (k, x) in some.iter().enumerate() {
                let (meets, far) = self.family.measures(x, Complex64::new(re[k], im[k]));
                values.phases[0] = turned(values.phases[0], meets);
                for (sum, far) in values.sums.iter_mut().zip(far) {
                    *sum += far;
                }
            }
        }
        Some(values)
    }

    /// Whether no two solutions are near to each other that might be real.
    fn is_clear(&self, input: f64) -> bool {
        let Some((_, solutions)) = self.solved(input.into()) else {
            return false;
        };
        let slides = self.family.slides();
        let near = |a: &Solution<N>, b: &Solution<N>| same(&slides, a, b, NEAR);
        let may_meet = |(k, one): (usize, &Solution<N>)| {
            let mirrored = self.family.mirrored(one);
            let mut others = solutions[k + 1..].iter().filter(|other| near(one, other));
            others.any(|other| near(&mirrored, one) || near(&mirrored, other))
        };
        !solutions.iter().enumerate().any(may_meet)
    }
}
