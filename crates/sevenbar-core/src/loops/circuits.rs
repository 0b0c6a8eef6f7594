//! A followed curve as rows over an input: passes between dead centres, rows on a grid of inputs, extremes.

use super::chain::{COLUMNS, Chain, Columns, Configuration, squared_up};
use super::curve::{Curve, End, Node, bordered, combined, dot, measure, reversed};
use super::many;
use super::rates::{ORDERS, Rates};
use crate::outcome::RowStatus;
use crate::simd::{Kernel, dispatch};
use std::f64::consts::TAU;

/// A rate of a column below this part of the curve's is zero.
const AT_REST: f64 = 1e-13;

/// A column whose part of the unit tangent is below this stands still.
const STILL: f64 = 1e-9;

/// The input at unit speed.
const UNIT: [f64; ORDERS] = [1.0, 0.0, 0.0];

/// A row nearer than this part of a grid step to a dead centre is that dead centre's.
const SAME_ROW: f64 = 1e-9;

/// A correction [rad, or parts of the size] after which the next is rounding.
pub(super) const SETTLED: f64 = 1e-7;

/// Corrections of a row, and how far they may lead together [rad, or parts of the size].
const MOST_CORRECTIONS: usize = 8;
const FARTHEST_CORRECTION: f64 = 0.3;

/// The closure error [rad, or parts of the size] that a row may keep.
const ROW_CLOSED: f64 = 1e-10;

/// Places looked at within a step for a change of a column's direction.
const LOOKS: usize = 6;

/// A row of a circuit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    pub at: Configuration,
    pub rates: Rates,
    pub status: RowStatus,
    pub pass: usize,
    pub residual: f64,
    pub condition: f64,
}

/// A place where a column changes direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turning {
    /// The node that it follows.
    pub segment: usize,
    pub node: Node,
}

/// A stretch of the curve on which the input only rises or only falls.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pass {
    /// The nodes with which it begins and ends, and the inputs there.
    pub from: usize,
    pub to: usize,
    pub start: f64,
    pub end: f64,
}

/// A curve made ready for an input: cut open at a good place, walked so that the input rises first.
pub(super) struct Passes<'a> {
    chain: &'a Chain,
    pub curve: Curve,
    pub input: usize,
    pub passes: Vec<Pass>,
    /// The dead centres at the passes' ends; the first and last are one where the circuit rocks and is closed.
    pub limits: Vec<Node>,
}

impl Curve {
    /// Where a column changes direction, in order.
    pub fn turnings(&self, chain: &Chain, column: usize) -> Vec<Turning> {
        let mut found = Vec::new();
        for (segment, pair) in self.nodes.windows(2).enumerate() {
            let (a, b) = (&pair[0], &pair[1]);
            let cubic = self.cubic(chain, segment);
            let mut before = (0.0, a.tangent[column]);
            for look in 1..=LOOKS {
                let s = a.step * look as f64 / LOOKS as f64;
                let rate = if look == LOOKS {
                    b.tangent[column]
                } else {
                    cubic.rate(column, s)
                };
                if before.1 * rate < 0.0
                    && let Some(node) = turning_between(chain, a, column, before, (s, rate))
                {
                    found.push(Turning { segment, node });
                }
                if rate != 0.0 {
                    before = (s, rate);
                }
            }
        }
        found
    }

    /// The cubic through both ends of a segment.
    #[inline(always)]
    fn cubic(&self, chain: &Chain, segment: usize) -> Cubic {
        let (a, b) = (&self.nodes[segment], &self.nodes[segment + 1]);
        // lengths are measured along the tangent of the segment's start
        let pace = 1.0 / dot(&a.tangent, &b.tangent);
        Cubic {
            length: a.step,
            whole: chain.difference(&a.at, &b.at),
            start: a.tangent,
            end: b.tangent.map(|t| t * pace),
        }
    }
}

/// A segment of a curve between two nodes, as a move from the first: values and rates at both ends.
struct Cubic {
    length: f64,
    whole: Columns,
    start: Columns,
    end: Columns,
}

impl Cubic {
    #[inline(always)]
    fn column(&self, k: usize, s: f64) -> f64 {
        let (h, x) = (self.length, s / self.length);
        self.whole[k] * x * x * (3.0 - 2.0 * x)
            + h * x * (1.0 - x) * (self.start[k] * (1.0 - x) - self.end[k] * x)
    }

    #[inline(always)]
    fn rate(&self, k: usize, s: f64) -> f64 {
        let x = s / self.length;
        self.whole[k] / self.length * 6.0 * x * (1.0 - x)
            + self.start[k] * (1.0 - x) * (1.0 - 3.0 * x)
            + self.end[k] * x * (3.0 * x - 2.0)
    }

    #[inline(always)]
    fn all(&self, s: f64) -> Columns {
        std::array::from_fn(|k| self.column(k, s))
    }
}

/// The place in a segment where a column's rate is zero, between two where its sign differs.
fn turning_between(
    chain: &Chain,
    a: &Node,
    column: usize,
    low: (f64, f64),
    high: (f64, f64),
) -> Option<Node> {
    let (mut low, mut high) = (low, high);
    let mut best: Option<Node> = None;
    for step in 0..60 {
        // regula falsi, each second time a bisection as long as the bracket is wide
        let s = if step % 3 == 2 {
            0.5 * (low.0 + high.0)
        } else {
            (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1)
        };
        let node = chain.refined(&chain.ahead(a, s)?)?;
        let rate = node.tangent[column];
        if best.as_ref().is_none_or(|b| rate.abs() < b.tangent[column].abs()) {
            best = Some(node);
        }
        if rate.abs() < AT_REST || (high.0 - low.0).abs() < 1e-15 {
            break;
        }
        if rate * low.1 > 0.0 {
            low = (s, rate);
        } else {
            high = (s, rate);
        }
    }
    best
}

impl Chain {
    /// The node once more at its own place, so that its tangent has no error of the last correction.
    pub fn refined(&self, node: &Node) -> Option<Node> {
        let mut again = self.node(&node.at, &node.tangent)?;
        again.step = node.step;
        Some(again)
    }

    /// The configuration with the input at a value, by Newton from a near one, with its rates.
    #[inline(always)]
    pub fn solved(
        &self,
        input: usize,
        value: f64,
        rough: &Configuration,
        rates: &[f64; ORDERS],
    ) -> Option<Row> {
        let mut at = *rough;
        at.values[input] = value;
        let mut row = [0.0; COLUMNS];
        row[input] = 1.0;
        let mut moved = 0.0;
        for step in 0..MOST_CORRECTIONS {
            let placed = self.place(&at);
            let (factored, right) = bordered(&placed.screws, &placed.error, self.columns, &row);
            let correction = factored.solve(right);
            let size = dot(&correction, &correction).sqrt();
            moved += size;
            if !size.is_finite() || moved > FARTHEST_CORRECTION {
                return None;
            }
            at = self.moved(&at, &correction);
            at.values[input] = value;
            // the correction of the next step would be the square of this one
            if size < SETTLED || step == MOST_CORRECTIONS - 1 {
                for ball in &mut at.balls {
                    *ball = squared_up(ball);
                }
                let placed = self.place(&at);
                let (factored, _) = bordered(&placed.screws, &placed.error, self.columns, &row);
                let residual = self.residual(&placed);
                return (residual < ROW_CLOSED).then(|| Row {
                    at,
                    rates: self.rates(&placed, &factored, (input, rates)),
                    status: RowStatus::Ok,
                    pass: 0,
                    residual,
                    condition: factored.condition(),
                });
            }
        }
        None
    }
}

impl<'a> Passes<'a> {
    /// `None` where the input stands still all along the curve.
    pub fn new(chain: &'a Chain, curve: &Curve, input: usize) -> Option<Self> {
        let fastest = curve
            .nodes
            .iter()
            .fold(0.0, |m: f64, n| m.max(n.tangent[input].abs()));
        if curve.nodes.len() < 2 || fastest < STILL {
            return None;
        }
        let mut curve = curve.clone();
        let turnings = curve.turnings(chain, input);
        if turnings.is_empty() {
            if curve.nodes[0].tangent[input] < 0.0 {
                curve = reversed(chain, &curve);
            }
            let last = curve.nodes.len() - 1;
            let (start, end) = (
                curve.nodes[0].at.values[input],
                curve.nodes[last].at.values[input],
            );
            let pass = Pass { from: 0, to: last, start, end };
            return Some(Self { chain, curve, input, passes: vec![pass], limits: Vec::new() });
        }
        // each turning becomes a node; a closed curve then begins at the lowest
        insert(chain, &mut curve, &turnings);
        let is_turning = |n: &Node| n.tangent[input].abs() < STILL;
        if curve.end == End::Closed {
            let lowest = (0..curve.nodes.len() - 1)
                .filter(|&k| is_turning(&curve.nodes[k]))
                .min_by(|&a, &b| {
                    let value = |k: usize| curve.nodes[k].at.values[input];
                    value(a).total_cmp(&value(b))
                })?;
            curve = begun_at(chain, &curve, lowest);
        }
        let rises = |c: &Curve| {
            let first = c.nodes[0].at.values[input];
            c.nodes
                .iter()
                .map(|n| n.at.values[input] - first)
                .find(|d| d.abs() > 1e-12)
                .is_none_or(|d| d > 0.0)
        };
        if !rises(&curve) {
            curve = reversed(chain, &curve);
        }
        let mut marks: Vec<usize> = (1..curve.nodes.len() - 1)
            .filter(|&k| is_turning(&curve.nodes[k]))
            .collect();
        marks.insert(0, 0);
        marks.push(curve.nodes.len() - 1);
        let value = |k: usize| curve.nodes[k].at.values[input];
        let passes = marks
            .windows(2)
            .map(|m| Pass { from: m[0], to: m[1], start: value(m[0]), end: value(m[1]) })
            .collect();
        let limits = marks.iter().map(|&k| curve.nodes[k]).filter(is_turning).collect();
        Some(Self { chain, curve, input, passes, limits })
    }

    /// The row of a pass at an input, which lies in it.
    #[inline(always)]
    pub fn row(&self, pass: usize, value: f64, rates: &[f64; ORDERS]) -> Option<Row> {
        let (segment, s, rough) = self.rough(pass, value);
        let row = self
            .chain
            .solved(self.input, value, &rough, rates)
            .or_else(|| self.beside(segment, s, value, rates))?;
        Some(Row { pass, ..row })
    }

    /// Where the cubics through the nodes of a pass have an input: segment, length into it, and configuration.
    #[inline(always)]
    fn rough(&self, pass: usize, value: f64) -> (usize, f64, Configuration) {
        let p = &self.passes[pass];
        let nodes = &self.curve.nodes[p.from..=p.to];
        let rising = p.end > p.start;
        let past = nodes.partition_point(|n| {
            let v = n.at.values[self.input];
            if rising { v <= value } else { v >= value }
        });
        let segment = p.from + past.saturating_sub(1).min(nodes.len() - 2);
        let a = &self.curve.nodes[segment];
        let cubic = self.curve.cubic(self.chain, segment);
        let (mut low, mut high) = (0.0, a.step);
        let target = value - a.at.values[self.input];
        let mut s = (target / cubic.whole[self.input]).clamp(0.0, 1.0) * a.step;
        for _ in 0..40 {
            let here = cubic.column(self.input, s);
            if (here < target) == rising {
                low = s;
            } else {
                high = s;
            }
            let newton = s + (target - here) / cubic.rate(self.input, s);
            let next = if newton > low && newton < high {
                newton
            } else {
                0.5 * (low + high)
            };
            let settled = (next - s).abs() < 1e-9 * a.step;
            s = next;
            if settled {
                break;
            }
        }
        (segment, s, self.chain.moved(&a.at, &cubic.all(s)))
    }

    /// The row where the input nearly stands still: along the curve first, then the input.
    fn beside(&self, segment: usize, s: f64, value: f64, rates: &[f64; ORDERS]) -> Option<Row> {
        let a = &self.curve.nodes[segment];
        let mut s = s;
        let mut node = self.chain.ahead(a, s)?;
        for _ in 0..20 {
            let off = value - node.at.values[self.input];
            let next = s + off / (node.tangent[self.input] / dot(&node.tangent, &a.tangent));
            if !(next >= -0.1 * a.step && next <= 1.1 * a.step) || (next - s).abs() < 1e-14 {
                break;
            }
            s = next;
            node = self.chain.ahead(a, s)?;
        }
        self.chain.solved(self.input, value, &node.at, rates)
    }

    /// The row at a dead centre.
    pub fn limit_row(&self, pass: usize, node: &Node) -> Row {
        let chain = self.chain;
        Row {
            at: node.at,
            rates: [[f64::NAN; COLUMNS]; ORDERS],
            status: RowStatus::DeadCentre,
            pass,
            residual: chain.residual(&chain.place(&node.at)),
            condition: f64::INFINITY,
        }
    }

    /// Whether the circuit comes back with the input as it was.
    pub fn rocks(&self) -> bool {
        !self.limits.is_empty()
    }

    /// Rows on a grid of inputs `origin + k step`, with exact rows at dead centres; the input has unit speed.
    pub fn rows(&self, origin: f64, step: f64) -> Vec<Row> {
        let mut rows = Vec::new();
        dispatch(OnGrid { passes: self, grid: (origin, step), rows: &mut rows });
        rows
    }

    #[inline(always)]
    fn rows_on_grid(&self, (origin, step): (f64, f64), rows: &mut Vec<Row>) {
        let closed = self.curve.end == End::Closed;
        let slack = SAME_ROW * step;
        for (n, pass) in self.passes.iter().enumerate() {
            let at_limit = |node: usize| self.curve.nodes[node].tangent[self.input].abs() < STILL;
            let (starts_at_limit, ends_at_limit) = (at_limit(pass.from), at_limit(pass.to));
            if starts_at_limit {
                rows.push(self.limit_row(n, &self.curve.nodes[pass.from]));
            }
            let index = |v: f64| (v - origin) / step;
            let (low, high) = (pass.start.min(pass.end), pass.start.max(pass.end));
            let low = if starts_at_limit || ends_at_limit {
                low + slack
            } else {
                low - slack
            };
            let high = if starts_at_limit || ends_at_limit || (closed && self.passes.len() == 1) {
                high - slack
            } else {
                high + slack
            };
            let (first, last) = (index(low).ceil() as i64, index(high).floor() as i64);
            let values = (0..(last - first + 1).max(0)).map(|m| {
                let k = if pass.end > pass.start {
                    first + m
                } else {
                    last - m
                };
                origin + step * k as f64
            });
            self.rows_at(n, values, rows);
            if ends_at_limit && !closed && n + 1 == self.passes.len() {
                rows.push(self.limit_row(n, &self.curve.nodes[pass.to]));
            }
        }
    }

    /// Rows at the inputs of a law, once for each pass.
    pub fn law_rows(&self, law: &[[f64; 4]], turns: bool) -> Vec<Row> {
        let mut rows = Vec::new();
        for (n, pass) in self.passes.iter().enumerate() {
            let (low, high) = (pass.start.min(pass.end), pass.start.max(pass.end));
            for q in law {
                let span = high - low;
                let value = if self.limits.is_empty() && turns {
                    low + (q[0] - low).rem_euclid(span)
                } else if turns {
                    q[0] - TAU * ((q[0] - 0.5 * (low + high)) / TAU).round()
                } else {
                    q[0]
                };
                let row = (value >= low && value <= high)
                    .then(|| self.row(n, value, &[q[1], q[2], q[3]]))
                    .flatten();
                let mut row = row.unwrap_or(missing(n));
                if row.status == RowStatus::Ok && !row.condition.is_finite() {
                    row.status = RowStatus::DeadCentre;
                }
                rows.push(row);
            }
        }
        rows
    }
}

impl Passes<'_> {
    /// Rows of a pass at inputs in it, side by side where the chain suits.
    #[inline(always)]
    fn rows_at(&self, pass: usize, values: impl Iterator<Item = f64>, rows: &mut Vec<Row>) {
        let single = |value: f64| self.row(pass, value, &UNIT).unwrap_or(missing(pass));
        if !many::suits(self.chain) {
            rows.extend(values.map(single));
            return;
        }
        let rough: Vec<Columns> = values
            .map(|value| {
                let mut columns = self.rough(pass, value).2.values;
                columns[self.input] = value;
                columns
            })
            .collect();
        let together = many::solved(self.chain, self.input, &rough);
        rows.extend(together.into_iter().zip(&rough).map(|(row, rough)| match row {
            Some(row) => Row { pass, ..row },
            None => single(rough[self.input]),
        }));
    }
}

/// [`Passes::rows`], compiled for each vector unit.
struct OnGrid<'a, 'b> {
    passes: &'b Passes<'a>,
    grid: (f64, f64),
    rows: &'b mut Vec<Row>,
}

impl Kernel for OnGrid<'_, '_> {
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        self.passes.rows_on_grid(self.grid, self.rows);
    }
}

fn missing(pass: usize) -> Row {
    let mut at = Configuration::ZERO;
    at.values = [f64::NAN; COLUMNS];
    Row {
        at,
        rates: [[f64::NAN; COLUMNS]; ORDERS],
        status: RowStatus::NoSolution,
        pass,
        residual: f64::NAN,
        condition: f64::NAN,
    }
}

fn insert(chain: &Chain, curve: &mut Curve, turnings: &[Turning]) {
    let mut nodes = Vec::with_capacity(curve.nodes.len() + turnings.len());
    let mut rest = turnings.iter().peekable();
    for (k, node) in curve.nodes.iter().enumerate() {
        nodes.push(*node);
        while let Some(t) = rest.next_if(|t| t.segment == k) {
            nodes.push(t.node);
        }
    }
    measure(chain, &mut nodes);
    curve.nodes = nodes;
}

/// A closed curve begun at another of its nodes, turns counted on.
fn begun_at(chain: &Chain, curve: &Curve, start: usize) -> Curve {
    let last = curve.nodes.len() - 1;
    let (first, end) = (curve.nodes[0].at.values, curve.nodes[last].at.values);
    let gained: Columns = combined(&end, 1.0, &first, -1.0);
    let mut nodes: Vec<Node> = curve.nodes[start..last].to_vec();
    nodes.extend(curve.nodes[..=start].iter().map(|n| {
        let mut n = *n;
        for c in 0..COLUMNS {
            n.at.values[c] += gained[c];
        }
        n
    }));
    measure(chain, &mut nodes);
    Curve { nodes, end: curve.end }
}
