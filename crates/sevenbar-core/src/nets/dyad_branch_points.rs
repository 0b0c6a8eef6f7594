//! The branch points of a turning input of a net of dyads, counted: inputs at which a dyad is stretched or folded.
//!
//! With complex inputs every dyad goes together in both ways, so the product of its radicand, over the ways of those
//! before it, is one function of the input, which is real at real inputs. Its phase round a range counts its zeros there. In a range with
//! at most one of them every mode leads to one at an end of the range; so ranges are halved until they have no more.
//!
//! Source: docs/theory_nets.md, (24) to (26).

use super::dyad_rows::DyadRows;
use super::dyad_sides::{MOST, Poses};
use super::in_plane::InPlane;
use crate::loops::Open;
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};

/// Most dyads of a net that is put together in closed form.
const MOST_DYADS: usize = MOST / 2;

/// Two functions for each dyad: the radicand of its root, and the denominator of its links' turns.
const FUNCTIONS: usize = 2 * MOST_DYADS;

/// Ranges to begin with, how high up in the complex inputs they reach [rad], and where the first one begins, as a part of a range: not
/// where people draw.
const RANGES: usize = 24;
const HEIGHT: f64 = 0.05;
const BEGINS: [f64; 3] = [0.381_966, 0.723_607, 0.145_898];

/// Where a range is parted.
const PARTS: f64 = 0.478;

/// How often a range is halved: to a millionth of a radian, to rounding where its branch points are of several dyads, as these come near to
/// each other with the square of a length, and fewer times where it has no whole count.
const MOST_HALVINGS: usize = 18;
const MOST_HALVINGS_OF_SEVERAL: usize = 34;
const MOST_HALVINGS_LOST: usize = 3;

/// Ranges that are searched, all together.
const MOST_RANGES: usize = 2_000;

/// A range is searched up to this height, as part of its width.
const FLAT: f64 = 0.4;

/// Pieces of an arc and of a way up, the greatest change of a phase on half of one [rad], and how often a piece is halved.
const ARC: usize = 8;
const UP: usize = 3;
const STEADY: f64 = 0.5;
const MOST_PARTS: usize = 30;

/// Squared sines of which a dyad is not near to be stretched nor folded: they change by far less in the smallest range.
const CLEAR: f64 = 1e-3;

/// How far from a whole number a count may be.
const WHOLE: f64 = 0.05;

/// Two ways differ in a dyad where its radicand, or the denominator, differs by more than this part.
const SAME: f64 = 1e-9;

/// Complex inputs at which this is seen; and a square of a length that is none, relative to the size.
const PLACES: [Complex64; 2] = [Complex64::new(0.713, 0.31), Complex64::new(-2.177, 0.173)];
const NOTHING: f64 = 1e-24;

/// The account of the branch points of an input.
#[derive(Clone, Debug, Default)]
pub(super) struct Counted {
    /// Inputs [rad] between which there is at most one branch point; none next to an open range is missing.
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

/// Numbers of a range, of each function.
type Numbers = [i64; FUNCTIONS];

/// The sides on which dyads are.
type Sides = [f64; MOST_DYADS];

/// Dyads, each with the ways of those before it: all sides of those on which it depends.
pub(super) struct BranchPoints<'a> {
    rows: &'a DyadRows,
    ways: Vec<Vec<Sides>>,
}

/// A range of the input, up to a height [rad], and the change of phases on the ways up at its ends.
#[derive(Clone, Copy)]
struct Range {
    ends: [f64; 2],
    height: f64,
}

impl<'a> BranchPoints<'a> {
    /// Of the rows of a net of dyads.
    pub fn of(rows: &'a DyadRows) -> Self {
        let stages = rows.stages();
        let mut before: Vec<Vec<usize>> = Vec::new();
        for stage in stages {
            let carriers = stage.known.iter().flatten();
            let carriers = carriers.filter_map(|known| stages.iter().position(|s| s.links.contains(known)));
            let mut all: Vec<usize> = carriers
                .flat_map(|j| before[j].iter().copied().chain([j]))
                .collect();
            all.sort_unstable();
            all.dedup();
            before.push(all);
        }
        let mut out = Self { rows, ways: Vec::new() };
        for (k, before) in before.iter().enumerate() {
            // of two ways that lead to one place each zero would be two
            let all = ways(before);
            let before = before.iter().copied();
            let before: Vec<usize> = before.filter(|&j| out.depends(k, j, &all)).collect();
            // on these ways its outer hinges are one place all along
            let turns_freely = |sides: &Sides| {
                let mut values = PLACES.iter().map(|at| out.values(k, sides, *at));
                values.all(|[root, line]| root.norm() < NOTHING || line.norm() < NOTHING)
            };
            let mut ways = ways(&before);
            ways.retain(|sides| !turns_freely(sides));
            out.ways.push(ways);
        }
        out
    }

    /// Whether a dyad is another one on some ways of one before it.
    fn depends(&self, k: usize, before: usize, ways: &[Sides]) -> bool {
        let differs = |a: Complex64, b: Complex64| (a - b).norm() > SAME * (a.norm() + b.norm());
        ways.iter().any(|sides| {
            let mut turned = *sides;
            turned[before] = -turned[before];
            let differ = |at: &Complex64| {
                let [one, other] = [sides, &turned].map(|sides| self.values(k, sides, *at));
                differs(one[0], other[0]) || differs(one[1], other[1])
            };
            PLACES.iter().any(differ)
        })
    }

    /// The two functions of a dyad, those before it on sides.
    fn values(&self, k: usize, sides: &Sides, at: Complex64) -> [Complex64; 2] {
        let mut poses: Poses<Complex64> = [InPlane::still(); MOST];
        self.rows.begin(at, &mut poses);
        let stages = self.rows.stages();
        for (stage, side) in stages[..k].iter().zip(sides) {
            let both = stage.put(&poses, *side);
            poses[stage.links[0]] = both[0];
            poses[stage.links[1]] = both[1];
        }
        stages[k].radicand(&poses)
    }

    /// The products of both functions over the ways, of each dyad.
    fn functions(&self, at: Complex64) -> [Complex64; FUNCTIONS] {
        let mut out = [Complex64::ONE; FUNCTIONS];
        for (k, ways) in self.ways.iter().enumerate() {
            for sides in ways {
                let [root, line] = self.values(k, sides, at);
                out[2 * k] *= root;
                out[2 * k + 1] *= line;
            }
        }
        out
    }

    /// The change of all phases [rad] on the straight line between two inputs; `None` where they do not settle.
    fn change(&self, from: Complex64, to: Complex64, pieces: usize) -> Option<[f64; FUNCTIONS]> {
        let mut sum = [0.0; FUNCTIONS];
        let at = |k: usize| from + (to - from) * (k as f64 / pieces as f64);
        let mut first = self.functions(from);
        for k in 0..pieces {
            let last = self.functions(at(k + 1));
            self.piece([at(k), at(k + 1)], [&first, &last], MOST_PARTS, &mut sum)?;
            first = last;
        }
        Some(sum)
    }

    fn piece(
        &self,
        [from, to]: [Complex64; 2],
        [first, last]: [&[Complex64; FUNCTIONS]; 2],
        parts: usize,
        sum: &mut [f64; FUNCTIONS],
    ) -> Option<()> {
        let middle = 0.5 * (from + to);
        let between = self.functions(middle);
        let halves: [[f64; 2]; FUNCTIONS] =
            std::array::from_fn(|k| [(between[k] / first[k]).arg(), (last[k] / between[k]).arg()]);
        if halves.as_flattened().iter().all(|x| x.abs() < STEADY) {
            for (sum, [a, b]) in sum.iter_mut().zip(halves) {
                *sum += a + b;
            }
            return Some(());
        }
        if parts == 0 || !halves.as_flattened().iter().all(|x| x.is_finite()) {
            return None;
        }
        self.piece([from, middle], [first, &between], parts - 1, sum)?;
        self.piece([middle, to], [&between, last], parts - 1, sum)
    }

    /// How many zeros less poles each function has in a range, on both sides of the real inputs.
    fn numbers(&self, range: &Range) -> Option<Numbers> {
        let up = Complex64::new(0.0, range.height);
        let [a, b] = range.ends.map(Complex64::from);
        let ups = [self.change(a, a + up, UP)?, self.change(b, b + up, UP)?];
        let arc = self.change(a + up, b + up, ARC)?;
        let mut out = [0; FUNCTIONS];
        for (k, out) in out.iter_mut().enumerate() {
            let turns = (ups[1][k] - ups[0][k] - arc[k]) / PI;
            if (turns - turns.round()).abs() > WHOLE {
                return None;
            }
            *out = turns.round() as i64;
        }
        Some(out)
    }

    /// Whether, on all ways that close at an input, no dyad is near to being stretched or folded.
    fn is_clear(&self, input: f64) -> bool {
        let stages = self.rows.stages();
        let all: Vec<usize> = (0..stages.len()).collect();
        ways(&all).iter().all(|sides| {
            for k in 0..stages.len() {
                let [root, _] = self.values(k, sides, input.into());
                if root.re < CLEAR {
                    return root.re < -CLEAR;
                }
            }
            true
        })
    }

    /// The account over a whole turn; `None` where an input to begin with is itself a branch point, however it is chosen.
    pub fn account(&self) -> Option<Counted> {
        BEGINS.iter().find_map(|begin| {
            let end = |k: usize| (k as f64 + begin) * TAU / RANGES as f64;
            let mut account = Counted::default();
            let ranges = (0..RANGES).map(|k| Range { ends: [end(k), end(k + 1)], height: HEIGHT });
            let ranges: Option<Vec<(Range, Numbers)>> =
                ranges.map(|range| Some((range, self.numbers(&range)?))).collect();
            let mut searched = RANGES;
            for (range, numbers) in ranges? {
                self.settle(&range, Some(numbers), 0, &mut searched, &mut account);
            }
            Some(account)
        })
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
        let pairs = numbers.map(|n| n.as_chunks::<2>().0.to_vec());
        // where a turn becomes infinite the functions after it have poles
        let infinite = pairs.as_ref().is_none_or(|pairs| pairs.iter().any(|p| p[1] != 0));
        let zeros: i64 = pairs.iter().flatten().map(|p| p[0]).sum();
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
            account.ends.extend(range.ends);
            if range.ends.iter().all(|end| self.is_clear(*end)) {
                return;
            }
            account.leave_open(range.ends, (!infinite).then_some(zeros));
            return;
        }
        let [from, to] = range.ends;
        let middle = from + PARTS * (to - from);
        let mut within = [0; FUNCTIONS];
        for ends in [[from, middle], [middle, to]] {
            *searched += 1;
            let height = (FLAT * (ends[1] - ends[0])).min(range.height);
            let half = Range { ends, height };
            let own = self.numbers(&half);
            for (sum, x) in within.iter_mut().zip(own.unwrap_or_default()) {
                *sum += x;
            }
            self.settle(&half, own, halved + 1, searched, account);
        }
        if let Some(numbers) = numbers {
            let left_out = |odd: usize| -> i64 {
                let off = numbers.iter().zip(within).map(|(all, within)| all - within);
                off.skip(odd).step_by(2).sum()
            };
            account.complex += left_out(0).max(0) as usize;
            account.poles += left_out(1).max(0) as usize;
        }
    }
}

/// All sides of some dyads, others on one.
fn ways(of: &[usize]) -> Vec<Sides> {
    let mut ways = vec![[1.0; MOST_DYADS]];
    for &j in of {
        let others = ways.clone().into_iter().map(|mut sides: Sides| {
            sides[j] = -1.0;
            sides
        });
        ways.extend(others);
    }
    ways
}
