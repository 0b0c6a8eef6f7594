//! The greatest and the least of the output's rates along a circuit on which the input goes round.
//!
//! Rows on the grid and at the nodes of the curve, where these stand closer since rates change fast, bracket the zeros of the next
//! derivative, and in these the extremes are; the jerk's, whose derivative no row has, by the rows between lesser or greater
//! neighbours. Only those are refined that may be the greatest or the least.
//!
//! Source: docs/theory_many.md, (11).

use super::passes::Passes;
use super::row::{Row, UNIT};
use crate::loops::equation::closed::Closed;
use crate::loops::rates::velocities::{self, ORDERS};
use crate::outcome::{Ends, RowStatus};

/// A derivative of the output at unit speed, of order four, below which it is zero.
const NO_SLOPE: f64 = 1e-13;

/// Inputs [rad] nearer than this to each other are one.
const SAME_INPUT: f64 = 1e-14;

/// Rows at inputs [rad] nearer than this to each other bracket nothing.
const SAME_SAMPLE: f64 = 1e-9;

/// Values of a rate that differ by less than this part, at inputs [rad] nearer than this, are of one extreme.
const SAME_VALUE: f64 = 1e-14;
const SAME_EXTREME: f64 = 1e-6;

/// Refinements of a bracket, and those after which every other halves it.
const MOST_REFINEMENTS: usize = 60;
const UNHALVED: usize = 8;

/// The lowest and highest velocity, acceleration and jerk of the output; none where there are rows without rates.
///
/// Inputs are given in the turns of the rows, which follow each other from the first on, a `step` apart.
pub(super) fn output_extremes<S: Closed>(
    passes: &Passes<S>,
    rows: &[Row<S>],
    output: usize,
    gained: &S::Columns<f64>,
    step: f64,
) -> [Option<Ends>; ORDERS] {
    let at_nodes = passes.node_rows(step);
    let Some(first) = rows.first().map(|r| r.at.values[passes.input]) else {
        return [None; ORDERS];
    };
    if rows.iter().chain(&at_nodes).any(|r| r.status != RowStatus::Ok) {
        return [None; ORDERS];
    }
    let span = gained[passes.input];
    let mut samples: Vec<(f64, &Row<S>)> = rows
        .iter()
        .chain(&at_nodes)
        .map(|r| (first + (r.at.values[passes.input] - first).rem_euclid(span), r))
        .collect();
    samples.sort_by(|a, b| a.0.total_cmp(&b.0));
    samples.dedup_by(|a, b| a.0 - b.0 < SAME_SAMPLE);
    // the last may be the first, by a rounding short of a turn on
    if let [first, .., last] = samples[..]
        && first.0 + span - last.0 < SAME_SAMPLE
    {
        samples.pop();
    }
    let search = Search { passes, samples: &samples, output, span };
    std::array::from_fn(|order| Some(search.ends(order)))
}

/// A derivative of the output, one order below that whose zeros are looked for, at an input.
#[derive(Clone, Copy)]
struct Sample {
    input: f64,
    value: f64,
    slope: f64,
}

struct Search<'a, 'b, S: Closed> {
    passes: &'a Passes<'b, S>,
    /// Rows by their inputs, rising.
    samples: &'a [(f64, &'a Row<S>)],
    output: usize,
    /// Of the input, all the way round.
    span: f64,
}

impl<S: Closed> Search<'_, '_, S> {
    /// The rate of an order, 0 for the velocity.
    fn rate(&self, row: &Row<S>, order: usize) -> f64 {
        let factorial = [1.0, 1.0, 2.0];
        row.rates[order][self.output] * factorial[order]
    }

    /// The slope of the rate of an order.
    fn slope(&self, row: &Row<S>, order: usize) -> f64 {
        if order + 1 < ORDERS {
            self.rate(row, order + 1)
        } else {
            let chain = self.passes.chain;
            velocities::fourth_derivative(chain, &row.at, self.passes.input, self.output)
        }
    }

    /// A row before or after the others is one a turn back or on.
    fn place(&self, k: i64) -> (f64, &Row<S>) {
        let count = self.samples.len() as i64;
        let (input, row) = self.samples[k.rem_euclid(count) as usize];
        (input + k.div_euclid(count) as f64 * self.span, row)
    }

    fn sample(&self, k: i64, order: usize) -> Sample {
        let (input, row) = self.place(k);
        Sample { input, value: self.rate(row, order), slope: self.slope(row, order) }
    }

    fn ends(&self, order: usize) -> Ends {
        let mut ends = [[f64::INFINITY, 0.0], [f64::NEG_INFINITY, 0.0]];
        for (input, row) in self.samples {
            look(&mut ends, self.rate(row, order), *input);
        }
        for (low, high) in self.brackets(order, &ends) {
            self.refine(order, low, high, &mut ends);
        }
        ends
    }

    /// Neighbouring samples with an extreme between them that may reach beyond what the rows have.
    fn brackets(&self, order: usize, ends: &Ends) -> Vec<(Sample, Sample)> {
        let reaches = |lowest: f64, highest: f64, more: f64| {
            lowest - more <= ends[0][0] || highest + more >= ends[1][0]
        };
        let mut found = Vec::new();
        for k in 0..self.samples.len() as i64 {
            if order + 1 < ORDERS {
                let (low, high) = (self.sample(k, order), self.sample(k + 1, order));
                // tangents bound what lies between
                let more = 0.5 * (high.input - low.input).abs() * low.slope.abs().max(high.slope.abs());
                let (least, most) = (low.value.min(high.value), low.value.max(high.value));
                if low.slope * high.slope < 0.0 && reaches(least, most, more) {
                    found.push((low, high));
                }
                continue;
            }
            let [before, here, after] = [k - 1, k, k + 1].map(|k| self.place(k));
            let [before, here, after] = [before, here, after].map(|(at, row)| (at, self.rate(row, order)));
            let (rise, next) = (here.1 - before.1, after.1 - here.1);
            if rise * next > 0.0 {
                continue;
            }
            let middle = self.sample(k, order);
            // the tangent bounds what lies beside
            let more = middle.slope.abs() * (here.0 - before.0).max(after.0 - here.0);
            if reaches(here.1, here.1, more) {
                let rising = middle.slope > 0.0;
                let is_most = rise > 0.0 || next < 0.0;
                let beside = if rising == is_most { k + 1 } else { k - 1 };
                let other = self.sample(beside, order);
                if middle.slope * other.slope < 0.0 {
                    found.push(if beside > k {
                        (middle, other)
                    } else {
                        (other, middle)
                    });
                }
            }
        }
        found
    }

    /// Looks at the extreme between two samples whose slopes differ in sign.
    fn refine(&self, order: usize, mut low: Sample, mut high: Sample, ends: &mut Ends) {
        let passes = self.passes;
        let start = passes.passes[0].start;
        let side = usize::from(low.slope > high.slope);
        // rounding of values hides the place; that of slopes does not
        let mut flattest: Option<Sample> = None;
        let mut before = None;
        for step in 0..MOST_REFINEMENTS {
            let input = if step >= UNHALVED && step % 2 == 0 {
                0.5 * (low.input + high.input)
            } else {
                flat_between(&low, &high, before.as_ref())
            };
            let inside = start + (input - start).rem_euclid(self.span);
            let Some(row) = passes.row(0, inside, &UNIT) else {
                break;
            };
            let here = Sample { input, value: self.rate(&row, order), slope: self.slope(&row, order) };
            if flattest.is_none_or(|f| here.slope.abs() < f.slope.abs()) {
                flattest = Some(here);
            }
            if here.slope.abs() < NO_SLOPE || (high.input - low.input).abs() < SAME_INPUT {
                break;
            }
            let end = if here.slope * low.slope > 0.0 {
                &mut low
            } else {
                &mut high
            };
            before = Some(std::mem::replace(end, here));
        }
        if let Some(Sample { input, value, .. }) = flattest {
            let end = &mut ends[side];
            let beyond = if side == 1 { value - end[0] } else { end[0] - value };
            let same = beyond > -SAME_VALUE * value.abs() && (input - end[1]).abs() < SAME_EXTREME;
            if beyond > 0.0 || same {
                *end = [value, input];
            }
        }
    }
}

/// Where the slope is zero between two samples: the input as a parabola of the slopes of these and a third, where that is between them,
/// else as a line.
fn flat_between(low: &Sample, high: &Sample, third: Option<&Sample>) -> f64 {
    let chord = (low.input * high.slope - high.input * low.slope) / (high.slope - low.slope);
    let Some(third) = third else { return chord };
    let part = |at: &Sample, a: &Sample, b: &Sample| {
        at.input * a.slope * b.slope / ((at.slope - a.slope) * (at.slope - b.slope))
    };
    let bent = part(low, high, third) + part(high, low, third) + part(third, low, high);
    if bent > low.input && bent < high.input {
        bent
    } else {
        chord
    }
}

fn look(ends: &mut Ends, value: f64, input: f64) {
    if value < ends[0][0] {
        ends[0] = [value, input];
    }
    if value > ends[1][0] {
        ends[1] = [value, input];
    }
}
