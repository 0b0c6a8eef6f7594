//! A followed curve as rows over an input: passes between dead centres, rows on a grid of inputs, extremes.

use super::row::{self, Row, Solved, UNIT};
use super::row_lanes::{Near, rows_near};
use super::row_store::RowStore;
use crate::loops::circuits::curve::{self, Curve, Node};
use crate::loops::circuits::turnings::{self, begun_at, insert, turns_at};
use crate::loops::circuits::walked_again;
use crate::loops::equation::chain::Chain;
use crate::loops::equation::closed::{At, Closed, Explicits, Stretch};
use crate::loops::equation::dense::{Array, combined, dot, length};
use crate::loops::rates::velocities::ORDERS;
use crate::outcome::RowStatus;
use crate::stopping;
use crate::vectors::{LANES, QUAD};
use std::f64::consts::TAU;

/// A row nearer than this part of a grid step to a dead centre is that dead centre's.
const SAME_ROW: f64 = 1e-9;

/// An input of a law nearer than this to a dead centre's is that dead centre's.
const SAME_LIMIT: f64 = 1e-12;

/// Rows that are solved before they are put down: whole blocks of lanes, and few enough that what they begin from takes no room.
const AT_ONCE: usize = 512 * LANES;

/// The closure error [rad, or relative to the size] that a row may keep.
const ROW_CLOSED: f64 = 1e-10;

/// A place near a node of the curve: so far along its tangent.
#[derive(Clone, Copy, Debug)]
struct Rough {
    node: usize,
    along: f64,
    /// Radius about the place within which the curve is alone.
    tube: f64,
}

/// A stretch of the curve on which the input only rises or only falls.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pass {
    /// The nodes with which it begins and ends, and the inputs there.
    pub from: usize,
    pub to: usize,
    pub start: f64,
    pub end: f64,
}

/// A curve made ready for an input: cut open at a good place, walked so that the input rises first.
pub(crate) struct Passes<'a, S: Closed = Chain> {
    pub chain: &'a S,
    pub curve: Curve<S>,
    pub input: usize,
    pub passes: Vec<Pass>,
    /// The dead centres at the passes' ends; the first and last are one where the circuit is closed.
    pub limits: Vec<Node<S>>,
}

impl<'a, S: Closed> Passes<'a, S> {
    /// The passes of a curve on which the input does not rest.
    pub fn new(chain: &'a S, curve: Curve<S>, input: usize) -> Option<Self> {
        // an input that gains turns rises on the whole, though it may turn back on the way
        let curve = if curve.gained()[input] < 0.0 && curve.goes_round(chain, input) && !curve.crosses() {
            walked_again::turned_round(chain, &curve, &[])
        } else {
            curve
        };
        let passes = Self::of(chain, curve, input)?;
        // a curve over change points was joined in the direction it is to have
        if passes.passes[0].end > passes.passes[0].start || passes.curve.crosses() {
            return Some(passes);
        }
        Some(
            Self::of(
                chain,
                walked_again::turned_round(chain, &passes.curve, &[]),
                input,
            )
            .unwrap_or(passes),
        )
    }

    fn of(chain: &'a S, mut curve: Curve<S>, input: usize) -> Option<Self> {
        if curve.nodes.len() < 2 {
            return None;
        }
        let turnings = turnings::turnings(&curve, chain, input);
        // each turning becomes a node; a closed curve then begins at the lowest
        insert(chain, &mut curve, &turnings, input);
        let is_turning = |n: &Node<S>| turns_at(n, input);
        if curve.is_closed() && !turnings.is_empty() {
            let value = |k: usize| curve.nodes[k].at.values[input];
            let goes_round = curve.goes_round(chain, input);
            // which is the lowest of an input that gains turns depends on where the round begins: of its low ends that in the turn's
            // first part is taken
            let height = |k: usize| match goes_round {
                true if value(k) < value(k + 1) => value(k).rem_euclid(TAU),
                true => TAU + value(k).rem_euclid(TAU),
                false => value(k),
            };
            let lowest = (0..curve.nodes.len() - 1)
                .filter(|&k| is_turning(&curve.nodes[k]))
                .min_by(|&a, &b| height(a).total_cmp(&height(b)))?;
            curve = begun_at(&curve, lowest);
        }
        let last = curve.nodes.len() - 1;
        let mut marks: Vec<usize> = (1..last).filter(|&k| is_turning(&curve.nodes[k])).collect();
        marks.insert(0, 0);
        marks.push(last);
        let value = |k: usize| curve.nodes[k].at.values[input];
        let passes = marks
            .windows(2)
            .map(|m| Pass { from: m[0], to: m[1], start: value(m[0]), end: value(m[1]) })
            .collect();
        let limits = marks.iter().map(|&k| curve.nodes[k]).filter(is_turning).collect();
        Some(Self { chain, curve, input, passes, limits })
    }

    /// The row of a pass at an input, which lies in it.
    pub fn row(&self, pass: usize, value: f64, rates: &[f64; ORDERS]) -> Option<Row<S>> {
        let segment = self.segment(pass, value);
        if let Some(row) = self.crossing_row(pass, segment, value) {
            return Some(row);
        }
        if let Some(on) = self.stretch(segment) {
            let mut made = Explicits::none();
            self.chain.explicit(&on, &[value; QUAD], rates, &mut made);
            if made.is_sure[0] {
                return Some(Row::explicit(pass, &made, 0));
            }
        }
        self.newton_row(pass, segment, value, rates)
    }

    /// The row of a segment at an input by Newton's method.
    fn newton_row(&self, pass: usize, segment: usize, value: f64, rates: &[f64; ORDERS]) -> Option<Row<S>> {
        let rough = self.rough_in(segment, value);
        let node = &self.curve.nodes[rough.node];
        row::solved(self.chain, self.input, &self.start(&rough), value, rates)
            .and_then(|solved| self.accepted(pass, &rough, &solved))
            .or_else(|| {
                // where the input nearly stands still: along the curve first, then the input
                let mut s = rough.along;
                let mut here = curve::ahead(self.chain, node, s)?;
                for _ in 0..20 {
                    let off = value - here.at.values[self.input];
                    let next = s + off / (here.rates[0][self.input] / dot(&here.rates[0], &node.rates[0]));
                    if !next.is_finite() || (next - s).abs() < 1e-14 {
                        break;
                    }
                    s = next;
                    here = curve::ahead(self.chain, node, s)?;
                }
                let solved = row::solved(self.chain, self.input, &here.at, value, rates)?;
                self.accepted(pass, &rough, &solved)
            })
    }

    /// A solved row, if it is certainly a place of this curve: it lies within the tube of the node it was made from.
    fn accepted(&self, pass: usize, rough: &Rough, solved: &Solved<S, f64>) -> Option<Row<S>> {
        let node = &self.curve.nodes[rough.node];
        let off = self.chain.difference(&node.at, &solved.at);
        let along = dot(&off, &node.rates[0]);
        let aside = length(&combined(
            &off,
            1.0,
            &curve::predicted(self.chain, node, along),
            -1.0,
        ));
        // the closure error of redundant constraints changes between its nodes
        let closed = if self.chain.is_redundant() {
            2.0 * self.chain.agree()
        } else {
            ROW_CLOSED
        };
        (aside <= rough.tube && solved.residual < closed).then_some(Row {
            at: solved.at,
            rates: solved.rates,
            status: RowStatus::Ok,
            pass,
            residual: solved.residual,
            condition: solved.condition,
        })
    }

    /// What distinguishes a segment from others at the same inputs, if its rows have a closed form.
    fn stretch(&self, segment: usize) -> Option<Stretch<S>> {
        let (a, b) = (&self.curve.nodes[segment], &self.curve.nodes[segment + 1]);
        let smooth = S::EXPLICIT && !a.is_crossing() && !b.is_crossing();
        smooth
            .then(|| self.chain.stretch(self.input, [&a.at, &b.at]))
            .flatten()
    }

    /// The row beside or at a change point, between the nodes where curves are cut: the pose, and no rates.
    fn crossing_row(&self, pass: usize, segment: usize, value: f64) -> Option<Row<S>> {
        let chain = self.chain;
        let (a, b) = (&self.curve.nodes[segment], &self.curve.nodes[segment + 1]);
        let (crossing, other) = match (a.is_crossing(), b.is_crossing()) {
            (true, _) => (a, b),
            (_, true) => (b, a),
            _ => return None,
        };
        let (here, there) = (crossing.at.values[self.input], other.at.values[self.input]);
        let part = (value - here) / (there - here);
        let part = if part.is_finite() { part } else { 0.0 };
        let by = chain.difference(&crossing.at, &other.at).map(|x| x * part);
        let mut at = chain.moved(&crossing.at, &by);
        at.values[self.input] = value;
        Some(self.pose_row(pass, at, RowStatus::ChangePoint))
    }

    /// The segment of a pass in which it has an input.
    fn segment(&self, pass: usize, value: f64) -> usize {
        let p = &self.passes[pass];
        let nodes = &self.curve.nodes[p.from..=p.to];
        let rising = p.end > p.start;
        let past = nodes.partition_point(|n| {
            let v = n.at.values[self.input];
            if rising { v <= value } else { v >= value }
        });
        p.from + past.saturating_sub(1).min(nodes.len() - 2)
    }

    /// Where a segment nearly has an input: the nearest node, and the length from it.
    fn rough_in(&self, segment: usize, value: f64) -> Rough {
        let input = self.input;
        let (a, b) = (&self.curve.nodes[segment], &self.curve.nodes[segment + 1]);
        let middle = a.at.values[input] + a.gone(input, 0.5 * a.step);
        let (start, end) = (a.at.values[input], b.at.values[input]);
        // by the nearer end, so that the series is short; the last node may fall on the one before it, up to rounding
        let first = (value < middle) == (start < end);
        let reach = 0.6 * a.step.max(0.0);
        let (node, low, high) = if first {
            (segment, 0.0, reach)
        } else {
            (segment + 1, -reach, 0.0)
        };
        if a.is_crossing() || b.is_crossing() {
            // left to the single row
            return Rough { node, along: 0.0, tube: -1.0 };
        }
        let n = &self.curve.nodes[node];
        let target = value - n.at.values[input];
        let (mut low, mut high) = (low, high);
        let mut s = (target / n.rates[0][input]).clamp(low, high);
        for _ in 0..40 {
            let here = n.gone(input, s);
            if (here < target) == (start < end) {
                low = s;
            } else {
                high = s;
            }
            let newton = s + (target - here) / n.rate(input, s);
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
        let tube = if first || 0.6 * a.step <= b.step {
            n.tube
        } else {
            curve::tube(self.chain, n, 0.6 * a.step)
        };
        Rough { node, along: s, tube }
    }

    /// The configuration that a rough place stands for.
    fn start(&self, rough: &Rough) -> At<S> {
        let node = &self.curve.nodes[rough.node];
        self.chain
            .moved(&node.at, &curve::predicted(self.chain, node, rough.along))
    }

    /// The row at a dead centre.
    pub fn limit_row(&self, pass: usize, node: &Node<S>) -> Row<S> {
        let status = if node.is_crossing() {
            RowStatus::ChangePoint
        } else {
            RowStatus::DeadCentre
        };
        self.pose_row(pass, node.at, status)
    }

    /// A row without rates.
    fn pose_row(&self, pass: usize, at: At<S>, status: RowStatus) -> Row<S> {
        let chain = self.chain;
        Row {
            at,
            rates: [S::Columns::filled(f64::NAN); ORDERS],
            status,
            pass,
            residual: chain.residual(&chain.place(&at)),
            condition: f64::INFINITY,
        }
    }

    /// Whether the input has dead centres.
    pub fn turns_back(&self) -> bool {
        !self.limits.is_empty()
    }

    /// Rows on a grid of inputs `origin + k step`, with exact rows at dead centres; the input has unit speed.
    pub fn rows<K: RowStore<S>>(&self, origin: f64, step: f64) -> K {
        let mut rows = K::none(self.chain, 0);
        let closed = self.curve.is_closed();
        let slack = SAME_ROW * step;
        for (n, pass) in self.passes.iter().enumerate() {
            let at_limit = |node: usize| turns_at(&self.curve.nodes[node], self.input);
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
            self.rows_at(n, values, &mut rows);
            if ends_at_limit && !closed && n + 1 == self.passes.len() {
                rows.push(self.limit_row(n, &self.curve.nodes[pass.to]));
            }
        }
        rows
    }

    /// Rows at those nodes of the first pass from which a step leads over less than `step` of the input.
    pub fn node_rows<K: RowStore<S>>(&self, step: f64) -> K {
        let pass = &self.passes[0];
        let value = |k: usize| self.curve.nodes[k].at.values[self.input];
        let near = |a: usize, b: usize| (value(a) - value(b)).abs() < step;
        let dense = |k: &usize| near(*k, k + 1) || (*k > pass.from && near(*k, k - 1));
        let mut rows = K::none(self.chain, 0);
        self.rows_at(0, (pass.from..pass.to).filter(dense).map(value), &mut rows);
        rows
    }

    /// Rows at the inputs of a law, once for each pass.
    ///
    /// An input that turns may be met a turn on or back; one that lies in the pass with `shift` taken off it, as the circuit's
    /// rows are given, is met there, for a pass may be longer than a turn. Only a closed curve is gone along again.
    pub fn law_rows<K: RowStore<S>>(&self, law: &[[f64; 4]], turns: bool, shift: f64) -> K {
        let mut rows = K::none(self.chain, self.passes.len() * law.len());
        for (n, pass) in self.passes.iter().enumerate() {
            let (low, high) = (pass.start.min(pass.end), pass.start.max(pass.end));
            for q in law {
                let span = high - low;
                let value = if self.limits.is_empty() && turns && self.curve.is_closed() {
                    low + (q[0] - low).rem_euclid(span)
                } else if turns && q[0] - shift >= low && q[0] - shift <= high {
                    q[0] - shift
                } else if turns {
                    q[0] - TAU * ((q[0] - 0.5 * (low + high)) / TAU).round()
                } else {
                    q[0]
                };
                let ends = [(pass.from, pass.start), (pass.to, pass.end)];
                let limit = ends.iter().find(|(node, end)| {
                    turns_at(&self.curve.nodes[*node], self.input) && (value - end).abs() < SAME_LIMIT
                });
                if let Some((node, _)) = limit {
                    rows.push(self.limit_row(n, &self.curve.nodes[*node]));
                    continue;
                }
                let row = (value >= low && value <= high)
                    .then(|| self.row(n, value, &[q[1], q[2], q[3]]))
                    .flatten();
                let mut row = row.unwrap_or(Row::missing(n));
                if row.status == RowStatus::Ok && !row.condition.is_finite() {
                    row.status = RowStatus::DeadCentre;
                }
                rows.push(row);
            }
        }
        rows
    }
}

impl<S: Closed> Passes<'_, S> {
    /// Rows of a pass at inputs in it, in its order, side by side; singly where that does not settle.
    fn rows_at<K: RowStore<S>>(&self, pass: usize, values: impl Iterator<Item = f64>, rows: &mut K) {
        let p = &self.passes[pass];
        let value_at = |node: usize| self.curve.nodes[node].at.values[self.input];
        let rising = p.end > p.start;
        let mut segment = p.from;
        rows.reserve(values.size_hint().0);
        if S::EXPLICIT {
            let mut values = values.peekable();
            let mut made = Explicits::none();
            while let Some(&first) = values.peek() {
                stopping::piece();
                while segment + 1 < p.to && (value_at(segment + 1) <= first) == rising {
                    segment += 1;
                }
                let is_own = |value: f64| segment + 1 >= p.to || (value_at(segment + 1) <= value) != rising;
                let stretch = self.stretch(segment);
                // those of one segment, four by four
                while values.peek().is_some_and(|&value| is_own(value)) {
                    let mut four = [0.0; QUAD];
                    let mut count = 0;
                    while count < QUAD
                        && let Some(value) = values.next_if(|&value| is_own(value))
                    {
                        four[count..].fill(value);
                        count += 1;
                    }
                    if let Some(on) = &stretch {
                        self.chain.explicit(on, &four, &UNIT, &mut made);
                    }
                    if stretch.is_some() && made.is_sure == [true; QUAD] {
                        rows.push_explicit(pass, &made, count);
                        continue;
                    }
                    for (k, value) in four[..count].iter().enumerate() {
                        if stretch.is_some() && made.is_sure[k] {
                            rows.push(Row::explicit(pass, &made, k));
                        } else {
                            let row = self
                                .crossing_row(pass, segment, *value)
                                .or_else(|| self.newton_row(pass, segment, *value, &UNIT));
                            rows.push(row.unwrap_or_else(|| Row::missing(pass)));
                        }
                    }
                }
            }
            return;
        }
        let mut values = values.peekable();
        while values.peek().is_some() {
            let starts: Vec<Near<S>> = values
                .by_ref()
                .take(AT_ONCE)
                .map(|value| {
                    while segment + 1 < p.to && (value_at(segment + 1) <= value) == rising {
                        segment += 1;
                    }
                    let rough = self.rough_in(segment, value);
                    Near { at: self.start(&rough), value, tube: rough.tube }
                })
                .collect();
            let found = rows_near(self.chain, self.input, pass, &starts);
            for (near, row) in starts.iter().zip(found) {
                let row = row.or_else(|| self.row(pass, near.value, &UNIT));
                rows.push(row.unwrap_or(Row::missing(pass)));
            }
        }
    }
}
