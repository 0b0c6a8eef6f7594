//! The functions by which branch points of a net of one block are counted: inputs at which two of its solutions meet.
//!
//! A member of a family is a polynomial in `e^(i t)` and `e^(-i t)` of the input, so it is known at complex inputs, too. There all of its solutions
//! are carried on from those at another one.
//!
//! Source: docs/theory_nets.md, (27).

use super::body_family::BodyFamily;
use super::branch_ranges::{Counted, FUNCTIONS, Functions, Values};
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

/// Inputs at which members are read, one for each power of `e^(i t)` from -2 to 2, and at which they are compared [rad].
const READ: usize = 5;
const COMPARED: [f64; 2] = [0.427, 2.913];

/// A number of a member that differs by less is the same, relative to the size.
const SAME: f64 = 1e-10;

/// Solutions that are nearer are one, to which two paths led.
const MET: f64 = 1e-8;

/// Solutions that are farther apart do not meet within a millionth of a radian.
const NEAR: f64 = 0.03;

/// A complex input at which solutions are found first.
const FIRST: Complex64 = Complex64::new(0.713, 0.31);

/// The numbers of a member at an input: of each the factors of the powers.
type Waves<const D: usize> = Vec<[[Complex64; READ]; D]>;

/// A member and its solutions.
type Solved<const N: usize, const D: usize> = (Vec<[Complex64; D]>, Vec<Solution<N>>);

/// A block at complex inputs.
struct Block<F, const N: usize, const D: usize> {
    family: F,
    starts: Arc<Starts<N, D>>,
    waves: Waves<D>,
    /// Where solutions were found last.
    last: RefCell<Solved<N, D>>,
}

/// The account of the branch points of a turning input of a net; `None` where it is not of one block all of whose modes are known.
pub(super) fn counted(net: &Net, parts: &[Part], driven: usize) -> Option<Counted> {
    match parts {
        [Part::Planar(block)] => {
            let member = |value: f64| at_first(net, driven, value, |before| block.member(before));
            Some(Counted::of(&Block::of(&member, PlanarFamily::starts)?))
        }
        [Part::Body(block)] => {
            let member = |value: f64| at_first(net, driven, value, |before| block.member(net, before));
            Some(Counted::of(&Block::of(&member, BodyFamily::starts)?))
        }
        _ => None,
    }
}

/// A family and the member that a block is with the input at a value.
type AtInput<'a, F, const D: usize> = &'a dyn Fn(f64) -> Option<(F, Vec<[Complex64; D]>)>;

impl<F: Family<N, D> + PartialEq, const N: usize, const D: usize> Block<F, N, D> {
    fn of(at: AtInput<F, D>, starts: impl Fn(&F) -> Arc<Starts<N, D>>) -> Option<Self> {
        let (family, _) = at(0.0)?;
        let read = |value: f64| {
            at(value)
                .filter(|(own, _)| *own == family)
                .map(|(_, member)| member)
        };
        let step = TAU / READ as f64;
        let members: Vec<Vec<[Complex64; D]>> =
            (0..READ).map(|k| read(k as f64 * step)).collect::<Option<_>>()?;
        let factor = |number: usize, part: usize, power: usize| -> Complex64 {
            let terms = members.iter().enumerate().map(|(k, member)| {
                let by = (power as f64 - 2.0) * k as f64 * step;
                member[number][part] * Complex64::cis(-by)
            });
            terms.sum::<Complex64>() / READ as f64
        };
        let count = members[0].len();
        let waves: Waves<D> = (0..count)
            .map(|n| from_fn(|d| from_fn(|power| factor(n, d, power))))
            .collect();
        for value in COMPARED {
            let differs = |(a, b): (&[Complex64; D], &[Complex64; D])| {
                a.iter()
                    .zip(b)
                    .any(|(a, b)| (a - b).norm() > SAME * (1.0 + a.norm()))
            };
            if read(value)?
                .iter()
                .zip(&member(&waves, value.into()))
                .any(differs)
            {
                return None;
            }
        }
        let starts = starts(&family);
        let first = member(&waves, FIRST);
        let ends = starts.ends(&family, &first);
        let all = starts.certified && ends.left_over == 0;
        all.then(|| Self { family, starts, waves, last: RefCell::new((first, ends.regular)) })
    }
}

/// The member at a complex input.
fn member<const D: usize>(waves: &Waves<D>, at: Complex64) -> Vec<[Complex64; D]> {
    let powers: [Complex64; READ] = from_fn(|power| (Complex64::I * at * (power as f64 - 2.0)).exp());
    let number = |factors: &[Complex64; READ]| factors.iter().zip(&powers).map(|(f, p)| f * p).sum();
    waves.iter().map(|parts| from_fn(|d| number(&parts[d]))).collect()
}

impl<F: Family<N, D>, const N: usize, const D: usize> Block<F, N, D> {
    /// The member at a complex input and all of its solutions; `None` where some are lost.
    fn solved(&self, at: Complex64) -> Option<Solved<N, D>> {
        let member = member(&self.waves, at);
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
    /// The products of both measures over all solutions.
    fn values(&self, at: Complex64) -> Option<Values> {
        let (member, solutions) = self.solved(at)?;
        let here = self.family.between(&member, &member);
        let mut values = [Complex64::ONE; FUNCTIONS];
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
                let [meets, far] = self.family.measures(x, Complex64::new(re[k], im[k]));
                values[0] *= meets;
                values[1] *= far;
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
