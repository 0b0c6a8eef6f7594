//! One circuit: its rows over an input, and what it is measured by.

use super::extremes::output_extremes;
use super::passes::{Pass, Passes};
use super::row::Row;
use super::row_store::RowStore;
use super::rows::{Rows, Tally};
use crate::loops::circuits::curve::{Curve, Node};
use crate::loops::circuits::turnings::{self, Turning};
use crate::loops::description::described_loop::{Column, Described, Loop};
use crate::loops::description::holding::followed;
use crate::loops::equation::chain::Chain;
use crate::loops::equation::closed::{At, Closed, Joint};
use crate::loops::equation::dense::{Array, length};
use crate::loops::equation::rotations::short_way;
use crate::loops::mobility::at_rest::Still;
use crate::loops::rates::velocities::ORDERS;
use crate::outcome::{CircuitMeasures, DeadCentre, DeadCentreKind, Role, RowStatus};
use std::f64::consts::TAU;

/// One connected motion over an input.
#[derive(Clone, Debug)]
pub struct Circuit {
    /// The rows; none of them where there is a course.
    pub rows: Rows,
    /// What makes the rows, where they are not kept.
    pub course: Option<Course>,
    /// What it is measured by, at the speed of the rows; by a law there are no extremes of rates.
    pub measures: CircuitMeasures,
    pub(super) reach: Reach,
}

/// How far a circuit goes.
#[derive(Clone, Debug)]
pub(crate) struct Reach {
    /// Where input and output turn back, as they are followed.
    pub limits: [Limits; 2],
    /// The distance of its farthest pose from its first [rad, or relative to the size].
    pub extent: f64,
}

/// A circuit over an input as it is followed.
pub(crate) struct OverInput<K> {
    /// Its rows at unit speed of the input, or by a law.
    pub rows: K,
    /// Whole turns to be added to each column of the description.
    pub offsets: Vec<f64>,
    /// d(input)/dt of the rows that are wanted, as it is followed.
    pub speed: f64,
    /// What it is measured by, at that speed.
    pub measures: CircuitMeasures,
    pub reach: Reach,
}

impl From<OverInput<Vec<Row>>> for Circuit {
    fn from(circuit: OverInput<Vec<Row>>) -> Self {
        let OverInput { rows, offsets, speed, measures, reach } = circuit;
        Self {
            rows: Rows { rows, offsets, speed, still: None },
            course: None,
            measures,
            reach,
        }
    }
}

impl Circuit {
    /// The same with a course in place of its rows on a grid, as it was followed.
    pub(super) fn on_course(mut self, linkage: &Loop, passes: &Passes, grid: (f64, f64)) -> Self {
        // one without rows is no circuit, so a course is never of none
        if !self.rows.is_empty() {
            self.course = Some(Course {
                followed: Followed { kept: Kept::of(passes), still: None },
                grid,
                offsets: self.rows.offsets.clone(),
                speed: self.rows.speed,
                tally: self.rows.tally(linkage),
            });
            self.rows.rows = Vec::new();
        }
        self
    }

    /// The circuit of a loop with a joint held, as one of that loop with the joint free.
    pub(super) fn holding(mut self, still: Still, held: &Loop, output: usize) -> Self {
        if held.inner(output).is_none() {
            // nothing moves in its column, and it rests where it is held
            let value = still.value / held.inward(output);
            self.measures.output = Some([value; 2]);
            for dead_centre in &mut self.measures.dead_centres {
                dead_centre.output = value;
            }
        }
        self.rows.still = Some(still);
        if let Some(course) = &mut self.course {
            course.followed.still = Some(still);
        }
        self
    }
}

/// A value at which a column turns back, and the column's second derivative there by the length of the curve.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limit {
    pub value: f64,
    pub bend: f64,
}

/// The limits of a column: its greatest values near by, and its least.
#[derive(Clone, Debug, Default)]
pub(crate) struct Limits {
    pub upper: Vec<Limit>,
    pub lower: Vec<Limit>,
}

impl Limits {
    /// Of the places at which a column turns back.
    fn of<'a, S: Closed + 'a>(turnings: impl Iterator<Item = &'a Node<S>>, column: usize) -> Self {
        let mut limits = Self::default();
        for node in turnings {
            let limit = Limit { value: node.at.values[column], bend: node.rates[1][column] };
            let side = if limit.bend < 0.0 {
                &mut limits.upper
            } else {
                &mut limits.lower
            };
            side.push(limit);
        }
        limits
    }
}

/// What is kept of a circuit that was followed: rows of it at any inputs are made of that.
#[derive(Clone, Debug)]
pub(crate) struct Kept<S: Closed = Chain> {
    curve: Curve<S>,
    input: usize,
    passes: Vec<Pass>,
    limits: Vec<Node<S>>,
}

impl<S: Closed> Kept<S> {
    pub(super) fn of(passes: &Passes<S>) -> Self {
        Self {
            curve: passes.curve.clone(),
            input: passes.input,
            passes: passes.passes.clone(),
            limits: passes.limits.clone(),
        }
    }

    /// The passes, of the chain that they were followed in.
    pub(super) fn passes<'a>(&self, chain: &'a S) -> Passes<'a, S> {
        Passes {
            chain,
            curve: self.curve.clone(),
            input: self.input,
            passes: self.passes.clone(),
            limits: self.limits.clone(),
        }
    }
}

/// A circuit of a loop as it was followed.
#[derive(Clone, Debug)]
pub struct Followed {
    pub(super) kept: Kept,
    /// The joint that was held.
    pub(super) still: Option<Still>,
}

/// A circuit on a grid of inputs whose rows are computed when they are wanted, and may be dropped again.
#[derive(Clone, Debug)]
pub struct Course {
    followed: Followed,
    grid: (f64, f64),
    offsets: Vec<f64>,
    speed: f64,
    /// What the rows were when they were computed first.
    pub tally: Tally,
}

impl Course {
    /// The rows, to the last bit those that were dropped.
    pub fn rows(&self, linkage: &Loop) -> Rows {
        let still = self.followed.still;
        let linkage = followed(linkage, still);
        let chain = linkage.reduced.chain.as_ref();
        let rows = chain.map(|chain| grid_rows(&self.followed.kept.passes(chain), self.grid));
        Rows {
            rows: rows.unwrap_or_default(),
            offsets: self.offsets.clone(),
            speed: self.speed,
            still,
        }
    }
}

/// What is wanted of circuits.
#[derive(Clone, Copy)]
pub(crate) struct Wanted<'a> {
    /// The input.
    pub driver: Column,
    /// The output.
    pub follower: Column,
    /// Origin and step of the inputs.
    pub grid: (f64, f64),
    /// d(input)/dt
    pub speed: f64,
    /// The input and its derivatives by time, instead of the grid.
    pub law: Option<&'a [[f64; 4]]>,
}

/// The circuit of some passes.
pub(crate) fn circuit<S: Closed, D: Described, K: RowStore<S>>(
    linkage: &D,
    passes: &Passes<S>,
    wanted: &Wanted,
) -> OverInput<K> {
    let chain = passes.chain;
    let Wanted { driver, follower, grid, speed, law, .. } = *wanted;
    let curve = &passes.curve;
    let gained = curve.gained();
    let closed = curve.is_closed();
    let crosses = curve.crosses();
    let turns = curve.goes_round(chain, driver.inner);
    // never stopped by a dead centre
    let driven_round = turns && !passes.turns_back();
    let mut rows: K = grid_rows(passes, grid);
    let extremes = if driven_round && !crosses && law.is_none() {
        output_extremes(passes, &rows, follower.inner, &gained, grid.1)
    } else {
        [None; ORDERS]
    };
    let shift = shift(chain, &rows);
    let seen = Seen { linkage, passes, driver, follower, shift };
    let turnings = turnings::turnings(curve, chain, follower.inner);
    let (input, output) = (seen.input_range(), seen.output_range(&turnings));
    let singular = curve.is_stuck() || crosses;
    let role = |column: Column, range: Option<[f64; 2]>| linkage.role(column, range, !closed && !singular);
    let measures = CircuitMeasures {
        motion_type: if singular {
            "change-point"
        } else {
            Role::pair(role(driver, input), role(follower, output))
        },
        closed,
        turns: if turns {
            (gained[driver.inner] / TAU).abs().round() as usize
        } else {
            0
        },
        input,
        output,
        dead_centres: seen.dead_centres(&turnings),
        transmission: None,
        rates: extremes.map(|e| {
            e.map(|ends| {
                ends.map(|[value, at]| [value / linkage.inward(follower.outer), at + shift[driver.inner]])
            })
        }),
        output_unit: if linkage.is_slide(follower.outer) {
            linkage.size()
        } else {
            1.0
        },
    };
    if let Some(law) = law {
        let inner_law: Vec<[f64; 4]> = law
            .iter()
            .map(|q| q.map(|x| x * linkage.inward(driver.outer)))
            .collect();
        rows = passes.law_rows(&inner_law, chain.is_turn(driver.inner), shift[driver.inner]);
    }
    let offset = |column| linkage.followed_column(column).map_or(0.0, |c| shift[c]);
    let limits = [
        Limits::of(passes.limits.iter(), driver.inner),
        Limits::of(turnings.iter().map(|t| &t.node), follower.inner),
    ];
    let first = &curve.nodes[0].at;
    let apart = curve
        .nodes
        .iter()
        .map(|n| length(&chain.difference(first, &n.at)));
    let extent = apart.fold(0.0, f64::max);
    OverInput {
        rows,
        offsets: (0..linkage.columns()).map(offset).collect(),
        speed: if law.is_some() {
            1.0
        } else {
            speed * linkage.inward(driver.outer)
        },
        measures: measures.at_speed(speed),
        reach: Reach { limits, extent },
    }
}

/// The rows of a circuit on a grid of inputs, from its first to its last, and from the input zero where it goes round.
fn grid_rows<S: Closed, K: RowStore<S>>(passes: &Passes<S>, grid: (f64, f64)) -> K {
    let (chain, curve) = (passes.chain, &passes.curve);
    let mut rows: K = passes.rows(grid.0, grid.1);
    if !curve.is_closed() {
        // an input of the grid may touch an end at which the motion is not smooth, and nothing closes there
        let lost = |rows: &K, k: usize| rows.status(k) == RowStatus::NoSolution;
        let count = rows.count();
        rows.truncate(count - (0..count).rev().take_while(|&k| lost(&rows, k)).count());
        rows.leave_out((0..rows.count()).take_while(|&k| lost(&rows, k)).count());
    }
    if curve.goes_round(chain, passes.input) && !passes.turns_back() {
        begin_at_zero(&mut rows, passes.input, &curve.gained(), grid.1);
    }
    rows
}

/// A curve as the description has it.
struct Seen<'a, S: Closed, D> {
    linkage: &'a D,
    passes: &'a Passes<'a, S>,
    driver: Column,
    follower: Column,
    /// Whole turns that are added to each column.
    shift: S::Columns<f64>,
}

impl<S: Closed, D: Described> Seen<'_, S, D> {
    fn value(&self, column: Column, at: &At<S>) -> f64 {
        (at.values[column.inner] + self.shift[column.inner]) / self.linkage.inward(column.outer)
    }

    /// The dead centres of the input, then those of the output.
    fn dead_centres(&self, turnings: &[Turning<S>]) -> Vec<DeadCentre> {
        let passes = self.passes;
        let dead_centre = |kind, node: &Node<S>, branch| DeadCentre {
            kind,
            input: self.value(self.driver, &node.at),
            output: self.value(self.follower, &node.at),
            branch,
            condition: node.inverse_norm,
        };
        let limits = passes.limits.len();
        // round a closed circuit the last is the first
        let again = usize::from(passes.curve.is_closed() && limits > 1);
        let inputs = passes.limits[..limits - again]
            .iter()
            .enumerate()
            .map(|(n, limit)| dead_centre(DeadCentreKind::Input, limit, n.min(passes.passes.len() - 1)));
        let outputs = turnings.iter().map(|t| {
            let pass = passes.passes.iter().position(|p| t.segment < p.to).unwrap_or(0);
            dead_centre(DeadCentreKind::Output, &t.node, pass)
        });
        inputs.chain(outputs).collect()
    }

    fn input_range(&self) -> Option<[f64; 2]> {
        self.range(self.driver, &mut self.passes.limits.iter().chain(self.ends()))
    }

    fn output_range(&self, turnings: &[Turning<S>]) -> Option<[f64; 2]> {
        // a closed circuit has its extremes where it turns back, an open one perhaps at its ends
        let open = !self.passes.curve.is_closed() || turnings.is_empty();
        let ends = self.ends().into_iter().filter(|_| open);
        self.range(self.follower, &mut turnings.iter().map(|t| &t.node).chain(ends))
    }

    /// The range of a column over some nodes; `None` for one that turns fully.
    fn range(&self, column: Column, nodes: &mut dyn Iterator<Item = &Node<S>>) -> Option<[f64; 2]> {
        let wide = |[low, high]: [f64; 2], v: f64| [low.min(v), high.max(v)];
        (!self.passes.curve.goes_round(self.passes.chain, column.inner)).then(|| {
            nodes
                .map(|n| self.value(column, &n.at))
                .fold([f64::INFINITY, f64::NEG_INFINITY], wide)
        })
    }

    fn ends(&self) -> [&Node<S>; 2] {
        let nodes = &self.passes.curve.nodes;
        [&nodes[0], &nodes[nodes.len() - 1]]
    }
}

/// Whole turns that bring the first row into (-pi, pi].
fn shift<S: Closed, K: RowStore<S>>(chain: &S, rows: &K) -> S::Columns<f64> {
    let mut shift = S::Columns::filled(0.0);
    if let Some(row) = (0..rows.count()).find(|&k| rows.status(k) != RowStatus::NoSolution) {
        for (c, s) in shift.as_mut().iter_mut().enumerate() {
            if chain.is_turn(c) {
                let value = rows.value(row, c);
                *s = -TAU * ((value - short_way(value)) / TAU).round();
            }
        }
    }
    shift
}

/// Origin and step of the inputs of rows.
pub(crate) fn grid<S: Closed>(chain: &S, passes: &[Passes<S>], samples: usize) -> (f64, f64) {
    let slides = |p: &Passes<S>| chain.joints()[chain.joint_of(p.input)] == Joint::Slide;
    if !passes.first().is_some_and(slides) {
        return (0.0, TAU / samples as f64);
    }
    let mut ends = [f64::INFINITY, f64::NEG_INFINITY];
    for pass in passes.iter().flat_map(|p| &p.passes) {
        ends = [
            ends[0].min(pass.start).min(pass.end),
            ends[1].max(pass.start).max(pass.end),
        ];
    }
    let span = ends[1] - ends[0];
    if span > 0.0 {
        (ends[0], span / samples as f64)
    } else {
        (0.0, 1.0)
    }
}

/// Rows of a circuit that goes round, begun at the input zero.
fn begin_at_zero<S: Closed, K: RowStore<S>>(rows: &mut K, input: usize, gained: &S::Columns<f64>, step: f64) {
    let whole = |value: f64| (value / TAU - (value / TAU).round()).abs() * TAU < 0.5 * step;
    let Some(first) = (0..rows.count()).find(|&k| whole(rows.value(k, input))) else {
        return;
    };
    rows.add(first, gained);
    rows.begin_with(first);
}
