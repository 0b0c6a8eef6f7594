//! The greatest and the least of the output's rates along a circuit on which the input goes round.
//!
//! Rows on the grid and at the nodes of the curve, where these stand closer since rates change fast, bracket the zeros of the next
//! derivative, and in these the extremes are; the jerk's, whose derivative no row has, by the rows between lesser or greater
//! neighbours. Only those are refined that may be the greatest or the least.
//!
//! Source: docs/theory_many.md, (11).

use super::passes::Passes;
use super::row::UNIT;
use super::row_store::RowStore;
use crate::loops::equation::closed::{At, Closed};
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
pub(super) fn output_extremes<S: Closed, K: RowStore<S>>(
    passes: &Passes<S>,
    rows: &K,
    output: usize,
    gained: &S::Columns<f64>,
    step: f64,
) -> [Option<Ends>; ORDERS] {
    let at_nodes: K = passes.node_rows(step);
    if rows.count() == 0 {
        return [None; ORDERS];
    }
    let lists = [rows, &at_nodes];
    let is_ok = |list: &K| (0..list.count()).all(|k| list.status(k) == RowStatus::Ok);
    if !lists.into_iter().all(is_ok) {
        return [None; ORDERS];
    }
    let first = rows.value(0, passes.input);
    let span = gained[passes.input];
    let mut samples: Vec<OfRow> = Vec::with_capacity(rows.count() + at_nodes.count());
    for (place, list) in lists.into_iter().enumerate() {
        samples.extend((0..list.count()).map(|k| {
            let off = list.value(k, passes.input) - first;
            // one that lies in the span needs no remainder, which is slow
            let off = if off >= 0.0 && off < span {
                off
            } else {
                off.rem_euclid(span)
            };
            OfRow { input: first + off, rates: list.rates(k, output), place: (place, k) }
        }));
    }
    samples.sort_by(|a, b| a.input.total_cmp(&b.input));
    samples.dedup_by(|a, b| a.input - b.input < SAME_SAMPLE);
    // the last may be the first, by a rounding short of a turn on
    if let [first, .., last] = samples[..]
        && first.input + span - last.input < SAME_SAMPLE
    {
        samples.pop();
    }
    let search = Search { passes, lists, samples: &samples, output, span };
    std::array::from_fn(|order| Some(search.ends(order)))
}

/// A derivative of the output, one order below that whose zeros are looked for, at an input.
#[derive(Clone, Copy)]
struct Sample {
    input: f64,
    value: f64,
    slope: f64,
}

/// The output's rates on a row, with the place of that.
#[derive(Clone, Copy)]
struct OfRow {
    input: f64,
    rates: [f64; ORDERS],
    place: (usize, usize),
}

struct Search<'a, 'b, S: Closed, K> {
    passes: &'a Passes<'b, S>,
    /// Rows on the grid, and at nodes.
    lists: [&'a K; 2],
    /// What they have of the output, by their inputs, rising.
    samples: &'a [OfRow],
    output: usize,
    /// Of the input, all the way round.
    span: f64,
}

/// The rate of an order, 0 for the velocity.
fn rate(rates: &[f64; ORDERS], order: usize) -> f64 {
    let factorial = [1.0, 1.0, 2.0];
    rates[order] * factorial[order]
}

impl<S: Closed, K: RowStore<S>> Search<'_, '_, S, K> {
    /// The slope of the rate of an order.
    #[inline]
    fn slope(&self, rates: &[f64; ORDERS], at: impl Fn() -> At<S>, order: usize) -> f64 {
        if order + 1 < ORDERS {
            rate(rates, order + 1)
        } else {
            let chain = self.passes.chain;
            velocities::fourth_derivative(chain, &at(), self.passes.input, self.output)
        }
    }

    /// A row before or after the others is one a turn back or on.
    #[inline]
    fn place(&self, k: i64) -> OfRow {
        let count = self.samples.len() as i64;
        // most need no division, which is slow
        let (turns, k) = if k < 0 || k >= count {
            (k.div_euclid(count), k.rem_euclid(count))
        } else {
            (0, k)
        };
        let row = self.samples[k as usize];
        OfRow { input: row.input + turns as f64 * self.span, ..row }
    }

    /// Input and jerk of such a row.
    #[inline]
    fn jerk_at(&self, k: i64) -> (f64, f64) {
        let row = self.place(k);
        (row.input, rate(&row.rates, ORDERS - 1))
    }

    #[inline]
    fn sample(&self, k: i64, order: usize) -> Sample {
        let OfRow { input, rates, place: (list, k) } = self.place(k);
        let at = || self.lists[list].at(k);
        Sample {
            input,
            value: rate(&rates, order),
            slope: self.slope(&rates, at, order),
        }
    }

    fn ends(&self, order: usize) -> Ends {
        let mut ends = [[f64::INFINITY, 0.0], [f64::NEG_INFINITY, 0.0]];
        for row in self.samples {
            look(&mut ends, rate(&row.rates, order), row.input);
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
            let (before, here, after) = (self.jerk_at(k - 1), self.jerk_at(k), self.jerk_at(k + 1));
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
            let rates = row.rates.map(|order| order[self.output]);
            let here = Sample {
                input,
                value: rate(&rates, order),
                slope: self.slope(&rates, || row.at, order),
            };
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
