//! The functions by which branch points of a net of dyads are counted: inputs at which a dyad is stretched or folded.
//!
//! With complex inputs every dyad goes together in both ways, so the product of its radicand, over the ways of those before it, is one function
//! of the input.
//!
//! Source: docs/theory_nets.md, (24) and (25).

use super::branch_ranges::{FUNCTIONS, Functions, Values, turned};
use super::dyad_rows::DyadRows;
use super::dyad_sides::Poses;
use super::in_plane::InPlane;
use super::net::MOST_COLUMNS;
use num_complex::Complex64;

/// Most dyads of a net that is put together in closed form.
const MOST_DYADS: usize = MOST_COLUMNS / 2;
const _: () = assert!(2 * MOST_DYADS <= FUNCTIONS);

/// Squared sines of which a dyad is not near to be stretched nor folded: they change by far less in the smallest range.
const CLEAR: f64 = 1e-3;

/// Two ways differ in a dyad where its radicand, or the denominator, differs by more than this part.
const SAME: f64 = 1e-9;

/// Complex inputs at which this is seen; and a square of a length that is none, relative to the size.
const PLACES: [Complex64; 2] = [Complex64::new(0.713, 0.31), Complex64::new(-2.177, 0.173)];
const NOTHING: f64 = 1e-24;

/// The sides on which dyads are.
type Sides = [f64; MOST_DYADS];

/// A zero of a dyad's product at one input: the dyad, and on which sides those are on which it depends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Zero(usize, Sides);

/// Dyads, each with those on which it depends, and the ways of these: all of their sides.
pub(super) struct BranchPoints<'a> {
    rows: &'a DyadRows,
    before: Vec<Vec<usize>>,
    ways: Vec<Vec<Sides>>,
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
        let mut out = Self { rows, before: Vec::new(), ways: Vec::new() };
        for (k, before) in before.iter().enumerate() {
            // of two ways that lead to one place each zero would be two
            let all = ways(before);
            let before = before.iter().copied();
            let before: Vec<usize> = before.filter(|&j| out.depends(k, j, &all)).collect();
            // on these ways its outer hinges are one place all along
            let turns_freely = |sides: &Sides| {
                let mut values = PLACES.iter().map(|at| out.pair(k, sides, *at));
                values.all(|[root, line]| root.norm() < NOTHING || line.norm() < NOTHING)
            };
            let mut ways = ways(&before);
            ways.retain(|sides| !turns_freely(sides));
            out.before.push(before);
            out.ways.push(ways);
        }
        out
    }

    /// The zero at a dead centre of the input, by the columns there.
    pub fn zero_at(&self, values: &[f64]) -> Zero {
        let sines = self.rows.sines(values);
        let dyads = 0..self.before.len();
        let dyad = dyads.min_by(|&a, &b| sines[a].abs().total_cmp(&sines[b].abs()));
        let dyad = dyad.unwrap_or_default();
        let mut sides = [1.0; MOST_DYADS];
        for &j in &self.before[dyad] {
            sides[j] = sines[j].signum();
        }
        Zero(dyad, sides)
    }

    /// Whether on all ways that close at an input no dyad is near to being stretched or folded.
    fn is_clear(&self, input: f64) -> bool {
        let stages = self.rows.stages();
        let all: Vec<usize> = (0..stages.len()).collect();
        ways(&all).iter().all(|sides| {
            for k in 0..stages.len() {
                let [root, _] = self.pair(k, sides, input.into());
                if root.re < CLEAR {
                    return root.re < -CLEAR;
                }
            }
            true
        })
    }

    /// Whether a dyad is another one on some ways of one before it.
    fn depends(&self, k: usize, before: usize, ways: &[Sides]) -> bool {
        let differs = |a: Complex64, b: Complex64| (a - b).norm() > SAME * (a.norm() + b.norm());
        ways.iter().any(|sides| {
            let mut turned = *sides;
            turned[before] = -turned[before];
            let differ = |at: &Complex64| {
                let [one, other] = [sides, &turned].map(|sides| self.pair(k, sides, *at));
                differs(one[0], other[0]) || differs(one[1], other[1])
            };
            PLACES.iter().any(differ)
        })
    }

    /// The two functions of a dyad, those before it on sides.
    fn pair(&self, k: usize, sides: &Sides, at: Complex64) -> [Complex64; 2] {
        let mut poses: Poses<Complex64> = [InPlane::still(); MOST_COLUMNS];
        self.rows.begin(at, &mut poses);
        let stages = self.rows.stages();
        for (stage, side) in stages[..k].iter().zip(sides) {
            let both = stage.put(&poses, *side);
            poses[stage.links[0]] = both[0];
            poses[stage.links[1]] = both[1];
        }
        stages[k].radicand(&poses)
    }
}

impl Functions for BranchPoints<'_> {
    /// The products of both functions over the ways, of each dyad.
    fn values(&self, at: Complex64) -> Option<Values> {
        let mut out = Values::NONE;
        for (k, ways) in self.ways.iter().enumerate() {
            for sides in ways {
                let [root, line] = self.pair(k, sides, at);
                out.phases[2 * k] = turned(out.phases[2 * k], root);
                out.phases[2 * k + 1] = turned(out.phases[2 * k + 1], line);
            }
        }
        Some(out)
    }

    fn meeting(&self, ends: [f64; 2], _of: &[bool; FUNCTIONS]) -> Option<usize> {
        ends.iter().all(|at| self.is_clear(*at)).then_some(0)
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
