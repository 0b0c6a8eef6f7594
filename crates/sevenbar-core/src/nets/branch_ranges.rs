//! The branch points of an input, counted by the phases of functions that vanish there.
//!
//! Such a function is one of the input alone, and real at real inputs. Its phase round a range counts its zeros there. In a range with at most one
//! branch point every mode leads to one at an end of the range; so ranges are halved until they have no more.
//!
//! Source: docs/theory_nets.md, (24) to (26) and (28).

use super::monodromy::FAR;
use crate::loops::Open;
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};

/// Most functions: in turn one that vanishes at branch points, and one that vanishes, or is infinite, where solutions run to infinity.
pub(super) const FUNCTIONS: usize = 16;

/// Most sums: those of four blocks.
pub(super) const SUMS: usize = 4 * FAR;

/// The values of the functions, as far as their phases go; 1 of those that are not in use. And sums over all solutions of numbers that are
/// infinite where one of these functions has a pole.
#[derive(Clone, Copy, Debug)]
pub(super) struct Values {
    pub phases: [Complex64; FUNCTIONS],
    pub sums: [Complex64; SUMS],
}

impl Values {
    /// Of no function.
    pub const NONE: Self = Self { phases: [Complex64::ONE; FUNCTIONS], sums: [Complex64::ZERO; SUMS] };
}

/// The phase of a product with one more factor: products of many are too great or too small for a number.
pub(super) fn turned(product: Complex64, by: Complex64) -> Complex64 {
    product * by / by.norm()
}

/// The inputs over which branch points are counted.
#[derive(Clone, Copy, Debug)]
pub(super) enum Inputs {
    /// A whole turn [rad].
    Turn,
    /// Of a slide, outside of which no mode closes [relative to the size].
    Slide([f64; 2]),
}

/// What is counted.
pub(super) trait Functions {
    /// The functions at a complex input; `None` where not all solutions are known.
    fn values(&self, at: Complex64) -> Option<Values>;
    /// How many pairs of modes become one in the smallest range between two inputs, each at one branch point of these functions; `None` where it
    /// is not known, or a pair might do so twice.
    fn meeting(&self, ends: [f64; 2], of: &[bool; FUNCTIONS]) -> Option<usize>;
    /// Which of them vanish where nothing else depends on what meets there.
    fn last(&self) -> &[usize] {
        &[]
    }
    /// The factors of these, and whether each is of a real way, in the order of the last call near by; `None` where it is lost.
    fn factors(&self, _at: Complex64) -> Option<Vec<(Complex64, bool)>> {
        None
    }
}

/// Ranges to begin with, how high up in the complex inputs they reach, as a part of their width, and where the first one begins, as a part of
/// it: not where people draw.
const RANGES: usize = 24;
const HEIGHT: f64 = 0.191;
const BEGINS: [f64; 3] = [0.381_966, 0.723_607, 0.145_898];

/// Where a range is parted.
const PARTS: f64 = 0.478;

/// How often a range is halved: to a millionth of a radian, to rounding where its branch points are of several dyads, as these come near to
/// each other with the square of a length, and fewer times where it has no whole count.
const MOST_HALVINGS: usize = 18;
const MOST_HALVINGS_OF_SEVERAL: usize = 34;
const MOST_HALVINGS_LOST: usize = 3;

/// A range that is halved so often is narrower [rad].
const SMALL: f64 = 4e-6;

/// How far from the smallest ranges modes are sought [rad].
const AWAY: f64 = 1e-4;

/// Ranges that are searched, all together.
const MOST_RANGES: usize = 2_000;

/// A range is searched up to this height, as part of its width.
const FLAT: f64 = 0.4;

/// Pieces of an arc and of a way up, the greatest change of a phase on half of one [rad], and how often a piece is halved.
const ARC: usize = 8;
const UP: usize = 3;
const STEADY: f64 = 0.5;
const MOST_PARTS: usize = 30;

/// How far from a whole number a count may be.
const WHOLE: f64 = 0.05;

/// The integral of a sum round a range is zero, where it has no pole there, to this part.
const NO_POLE: f64 = 2e-5;

/// The account of the branch points of an input.
#[derive(Clone, Debug, Default)]
pub(super) struct Counted {
    /// Inputs [rad, or relative to the size] between which there is at most one branch point; those about the smallest ranges lie a little away.
    pub ends: Vec<f64>,
    /// Real branch points.
    pub real: usize,
    /// Complex ones that ranges were halved to leave out.
    pub complex: usize,
    /// The same of turns that become infinite.
    pub poles: usize,
    /// Ranges with more than one, or with none that is known.
    pub open: Vec<Open>,
}

impl Counted {
    /// The account of functions over inputs.
    pub fn of(functions: &dyn Functions, inputs: Inputs) -> Self {
        let ranges = Ranges(functions);
        let mut first = Vec::new();
        // an input to begin with may be a branch point
        for begins in BEGINS {
            first = ranges.first(inputs, begins);
            if first.iter().all(|(_, numbers)| numbers.is_some()) {
                break;
            }
        }
        ranges.account(&first)
    }

    /// Leaves a range open, as one with the open range that it goes on from.
    fn leave_open(&mut self, [from, to]: [f64; 2], missing: Option<i64>) {
        match self.open.last_mut().filter(|last| last.to == from) {
            Some(last) => {
                let both = last.missing.zip(missing);
                *last = Open { from: last.from, to, missing: both.map(|(a, b)| a + b) };
            }
            None => self.open.push(Open { from, to, missing }),
        }
    }
}

/// The change of each function's phase [rad] on a way, and the integral of each sum and of its size.
#[derive(Clone, Copy)]
struct Change {
    phases: [f64; FUNCTIONS],
    sums: [Complex64; SUMS],
    sizes: [f64; SUMS],
}

/// How many zeros less poles each function has in a range, and whether a sum has a pole there.
#[derive(Clone, Copy)]
struct Numbers {
    of: [i64; FUNCTIONS],
    poles: bool,
}

/// A range of the input, up to a height [rad, or relative to the size].
#[derive(Clone, Copy)]
struct Range {
    ends: [f64; 2],
    height: f64,
}

/// The ranges of functions.
struct Ranges<'a>(&'a dyn Functions);

impl Ranges<'_> {
    /// The change of all phases [rad] on the straight line between two inputs; `None` where they do not settle.
    fn change(&self, from: Complex64, to: Complex64, pieces: usize) -> Option<Change> {
        let mut sum = Change {
            phases: [0.0; FUNCTIONS],
            sums: [Complex64::ZERO; SUMS],
            sizes: [0.0; SUMS],
        };
        let at = |k: usize| from + (to - from) * (k as f64 / pieces as f64);
        let mut first = self.0.values(from)?;
        for k in 0..pieces {
            let last = self.0.values(at(k + 1))?;
            self.piece([at(k), at(k + 1)], [&first, &last], MOST_PARTS, &mut sum)?;
            first = last;
        }
        Some(sum)
    }

    fn piece(
        &self,
        [from, to]: [Complex64; 2],
        [first, last]: [&Values; 2],
        parts: usize,
        sum: &mut Change,
    ) -> Option<()> {
        let middle = 0.5 * (from + to);
        let between = self.0.values(middle)?;
        let phase = |a: &Values, b: &Values, k: usize| (b.phases[k] / a.phases[k]).arg();
        let halves: [[f64; 2]; FUNCTIONS] =
            std::array::from_fn(|k| [phase(first, &between, k), phase(&between, last, k)]);
        if halves.as_flattened().iter().all(|x| x.abs() < STEADY) {
            for (sum, [a, b]) in sum.phases.iter_mut().zip(halves) {
                *sum += a + b;
            }
            // Simpson's rule
            for k in 0..SUMS {
                let mean = (first.sums[k] + 4.0 * between.sums[k] + last.sums[k]) / 6.0;
                sum.sums[k] += (to - from) * mean;
                sum.sizes[k] += (to - from).norm() * between.sums[k].norm();
            }
            return Some(());
        }
        if parts == 0 || !halves.as_flattened().iter().all(|x| x.is_finite()) {
            return None;
        }
        self.piece([from, middle], [first, &between], parts - 1, sum)?;
        self.piece([middle, to], [&between, last], parts - 1, sum)
    }

    /// The change of all phases [rad] from a real input straight up.
    fn up(&self, input: f64, height: f64) -> Option<Change> {
        let from = Complex64::from(input);
        self.change(from, from + Complex64::new(0.0, height), UP)
    }

    /// How many zeros less poles each function has in a range, on both sides of the real inputs, with the ways up at its ends.
    fn numbers(&self, range: &Range, ups: [&Option<Change>; 2]) -> Option<Numbers> {
        let up = Complex64::new(0.0, range.height);
        let (first, last) = (ups[0].as_ref()?, ups[1].as_ref()?);
        let [a, b] = range.ends.map(Complex64::from);
        let arc = self.change(a + up, b + up, ARC)?;
        let mut of = [0; FUNCTIONS];
        for (k, of) in of.iter_mut().enumerate() {
            let turns = (last.phases[k] - first.phases[k] - arc.phases[k]) / PI;
            if (turns - turns.round()).abs() > WHOLE {
                return None;
            }
            *of = turns.round() as i64;
        }
        // below the real inputs all is mirrored
        let has_pole = |k: usize| {
            let round = (first.sums[k] + arc.sums[k] - last.sums[k]).im;
            round.abs() > NO_POLE * (first.sizes[k] + arc.sizes[k] + last.sizes[k])
        };
        Some(Numbers { of, poles: (0..SUMS).any(has_pole) })
    }

    /// How many zeros a range has on real ways of the functions on which nothing depends, where the others have so many: with at most one the ways
    /// that are real at either end are exchanged with each other alone, so that other factors need not be counted. `None` where it is not known.
    fn on_real_ways(&self, range: &Range, others: i64) -> Option<i64> {
        if others > 1 || self.0.last().is_empty() {
            return None;
        }
        let up = Complex64::new(0.0, range.height);
        let [a, b] = range.ends.map(Complex64::from);
        let mut turned: Vec<f64> = Vec::new();
        let mut real = Vec::new();
        // the order of a call far off may be lost
        self.0.factors(a);
        let mut last = self.0.factors(a)?;
        for (from, to, pieces) in [(a, a + up, UP), (a + up, b + up, ARC), (b + up, b, UP)] {
            let at = |k: usize| from + (to - from) * (k as f64 / pieces as f64);
            for k in 0..pieces {
                turned.resize(last.len(), 0.0);
                real.resize(last.len(), false);
                for (real, (_, is_real)) in real.iter_mut().zip(&last) {
                    *real |= from == a && k == 0 && *is_real;
                }
                last = self.along([at(k), at(k + 1)], &last, MOST_PARTS, &mut turned)?;
            }
        }
        let own = turned.iter().zip(real).zip(&last);
        let own = own.filter(|((_, at_first), (_, at_last))| *at_first || *at_last);
        let turns = -own.map(|((turned, _), _)| turned).sum::<f64>() / PI;
        ((turns - turns.round()).abs() < WHOLE).then_some(turns.round() as i64)
    }

    /// Adds the change of each factor's phase [rad] on a piece; gives the factors at its end.
    fn along(
        &self,
        [from, to]: [Complex64; 2],
        first: &[(Complex64, bool)],
        parts: usize,
        turned: &mut [f64],
    ) -> Option<Vec<(Complex64, bool)>> {
        let middle = 0.5 * (from + to);
        let between = self.0.factors(middle)?;
        let last = self.0.factors(to)?;
        let turn = |a: &[(Complex64, bool)], b: &[(Complex64, bool)]| -> Vec<f64> {
            a.iter().zip(b).map(|(a, b)| (b.0 / a.0).arg()).collect()
        };
        let halves = [turn(first, &between), turn(&between, &last)];
        if halves.iter().flatten().all(|x| x.abs() < STEADY) {
            for half in halves {
                for (sum, by) in turned.iter_mut().zip(half) {
                    *sum += by;
                }
            }
            return Some(last);
        }
        if parts == 0 || !halves.iter().flatten().all(|x| x.is_finite()) {
            return None;
        }
        let between = self.along([from, middle], first, parts - 1, turned)?;
        self.along([middle, to], &between, parts - 1, turned)
    }

    /// The ranges to begin with from a part of one on, each with its numbers.
    fn first(&self, inputs: Inputs, begins: f64) -> Vec<(Range, Option<Numbers>)> {
        let (from, wide, count) = match inputs {
            Inputs::Turn => (begins * TAU / RANGES as f64, TAU, RANGES),
            // one more, so that both ends lie within
            Inputs::Slide([from, to]) => {
                let wide = to - from;
                (from - begins * wide / RANGES as f64, wide, RANGES + 1)
            }
        };
        let step = wide / RANGES as f64;
        let height = HEIGHT * step;
        let end = |k: usize| from + k as f64 * step;
        let ups: Vec<Option<Change>> = (0..=count).map(|k| self.up(end(k), height)).collect();
        let ranges = (0..count).map(|k| {
            let range = Range { ends: [end(k), end(k + 1)], height };
            (range, self.numbers(&range, [&ups[k], &ups[k + 1]]))
        });
        ranges.collect()
    }

    /// The account of ranges to begin with.
    fn account(&self, first: &[(Range, Option<Numbers>)]) -> Counted {
        let (mut searched, mut account) = (RANGES, Counted::default());
        for (range, numbers) in first {
            self.settle(range, *numbers, 0, &mut searched, &mut account);
        }
        account
    }

    /// Halves a range until at most one branch point is in each.
    fn settle(
        &self,
        range: &Range,
        numbers: Option<Numbers>,
        halved: usize,
        searched: &mut usize,
        account: &mut Counted,
    ) {
        let pairs = numbers.map(|n| n.of.as_chunks::<2>().0.to_vec());
        // where a turn becomes infinite the functions after it have poles
        let infinite =
            numbers.is_none_or(|n| n.poles) || pairs.iter().flatten().any(|p| p[1] != 0 || p[0] < 0);
        let mut zeros: i64 = pairs.iter().flatten().map(|p| p[0]).sum();
        if !infinite && zeros > 1 {
            let of = numbers.map_or([0; FUNCTIONS], |n| n.of);
            let others = zeros - self.0.last().iter().map(|&k| of[k]).sum::<i64>();
            if let Some(real) = self.on_real_ways(range, others) {
                account.complex += (zeros - others - real).max(0) as usize;
                zeros = others + real;
            }
        }
        if !infinite && zeros <= 1 {
            account.real += zeros as usize;
            if zeros == 1 {
                account.ends.extend(range.ends);
            }
            return;
        }
        let single = !infinite && pairs.iter().flatten().all(|p| p[0] <= 1);
        let most = match numbers {
            Some(_) if single => MOST_HALVINGS_OF_SEVERAL,
            Some(_) => MOST_HALVINGS,
            None => MOST_HALVINGS_LOST,
        };
        if halved >= most || *searched >= MOST_RANGES {
            // so near to where they meet modes are not sure to be found
            account.ends.extend([range.ends[0] - AWAY, range.ends[1] + AWAY]);
            let [from, to] = range.ends;
            let wide = to - from;
            // not at its ends, which may themselves be branch points
            let of = numbers
                .filter(|_| !infinite)
                .map_or([true; FUNCTIONS], |n| n.of.map(|x| x != 0));
            let meeting = (wide < SMALL).then(|| self.0.meeting([from - wide, to + wide], &of));
            match meeting.flatten() {
                Some(0) => (),
                Some(pairs) if !infinite && zeros == pairs as i64 => account.real += pairs,
                _ => account.leave_open(range.ends, (!infinite).then_some(zeros)),
            }
            return;
        }
        let [from, to] = range.ends;
        let middle = from + PARTS * (to - from);
        let mut within = [0; FUNCTIONS];
        let height = (FLAT * (middle - from)).min(range.height);
        let ups = [from, middle, to].map(|end| self.up(end, height));
        for (k, ends) in [[from, middle], [middle, to]].into_iter().enumerate() {
            *searched += 1;
            let half = Range { ends, height };
            let own = self.numbers(&half, [&ups[k], &ups[k + 1]]);
            for (sum, x) in within.iter_mut().zip(own.map_or([0; FUNCTIONS], |own| own.of)) {
                *sum += x;
            }
            self.settle(&half, own, halved + 1, searched, account);
        }
        if let Some(numbers) = numbers {
            let left_out = |odd: usize| -> i64 {
                let off = numbers.of.iter().zip(within).map(|(all, within)| all - within);
                off.skip(odd).step_by(2).sum()
            };
            account.complex += left_out(0).max(0) as usize;
            account.poles += left_out(1).max(0) as usize;
        }
    }
}
