//! The greatest and the least of the output's rates along a circuit on which the input goes round.
//!
//! Rows bracket the zeros of the next derivative, and in these the extremes are; the jerk's, whose derivative no row has, by the
//! rows between lesser or greater neighbours. Only those are refined that may be the greatest or the least.

use super::chain::Columns;
use super::circuits::{Passes, Row, UNIT};
use super::rates::ORDERS;
use crate::outcome::RowStatus;
use std::f64::consts::TAU;

/// The least and the greatest value of a quantity, each with the input there.
pub type Ends = [[f64; 2]; 2];

/// Rows in a turn from which extremes are bracketed.
const LEAST_ROWS: f64 = 180.0;

/// A derivative of the output at unit speed, of order four, below which it is zero.
const NO_SLOPE: f64 = 1e-13;

/// Inputs [rad] nearer than this to each other are one.
const SAME_INPUT: f64 = 1e-14;

/// Refinements of a bracket.
const MOST_REFINEMENTS: usize = 40;

/// How many times as dense as a grid of this step [rad] rows must be for extremes.
pub(super) fn times_as_dense(step: f64) -> f64 {
    (step * LEAST_ROWS / TAU).ceil().max(1.0)
}

/// Whether a row of the denser grid is one of the grid: its origin and step.
pub(super) fn is_on_grid(input: f64, (origin, step): (f64, f64)) -> bool {
    let place = (input - origin) / step;
    (place - place.round()).abs() < 0.5 / times_as_dense(step)
}

/// The lowest and highest velocity, acceleration and jerk of the output; none where there are rows without rates.
pub(super) fn output_extremes(
    passes: &Passes,
    rows: &[Row],
    output: usize,
    gained: &Columns,
) -> [Option<Ends>; ORDERS] {
    if rows.is_empty() || rows.iter().any(|r| r.status != RowStatus::Ok) {
        return [None; ORDERS];
    }
    let search = Search { passes, rows, output, gained };
    std::array::from_fn(|order| Some(search.ends(order)))
}

/// A derivative of the output, one order below that whose zeros are looked for, at an input.
#[derive(Clone, Copy)]
struct Sample {
    input: f64,
    value: f64,
    slope: f64,
}

struct Search<'a, 'b> {
    passes: &'a Passes<'b>,
    rows: &'a [Row],
    output: usize,
    gained: &'a Columns,
}

impl Search<'_, '_> {
    /// The rate of an order, 0 for the velocity.
    fn rate(&self, row: &Row, order: usize) -> f64 {
        let factorial = [1.0, 1.0, 2.0];
        row.rates[order][self.output] * factorial[order]
    }

    /// The slope of the rate of an order.
    fn slope(&self, row: &Row, order: usize) -> f64 {
        if order + 1 < ORDERS {
            self.rate(row, order + 1)
        } else {
            let chain = self.passes.chain;
            chain.fourth_derivative(&row.at, self.passes.input, self.output)
        }
    }

    /// A row before or after the others is one a turn back or on.
    fn input(&self, k: i64) -> f64 {
        let count = self.rows.len() as i64;
        let turns = k.div_euclid(count) as f64;
        self.row(k).at.values[self.passes.input] + turns * self.gained[self.passes.input]
    }

    fn row(&self, k: i64) -> &Row {
        &self.rows[k.rem_euclid(self.rows.len() as i64) as usize]
    }

    fn sample(&self, k: i64, order: usize) -> Sample {
        let row = self.row(k);
        Sample {
            input: self.input(k),
            value: self.rate(row, order),
            slope: self.slope(row, order),
        }
    }

    fn ends(&self, order: usize) -> Ends {
        let mut ends = [[f64::INFINITY, 0.0], [f64::NEG_INFINITY, 0.0]];
        for (k, row) in self.rows.iter().enumerate() {
            look(&mut ends, self.rate(row, order), self.input(k as i64));
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
        for k in 0..self.rows.len() as i64 {
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
            let [before, here, after] = [k - 1, k, k + 1].map(|k| self.rate(self.row(k), order));
            let (rise, next) = (here - before, after - here);
            // the parabola through the three reaches an eighth of this farther at most
            if rise * next <= 0.0 && reaches(here, here, (next - rise).abs()) {
                let middle = self.sample(k, order);
                let rising = middle.slope > 0.0;
                let is_most = rise > next;
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
        let (start, span) = (passes.passes[0].start, self.gained[passes.input]);
        for step in 0..MOST_REFINEMENTS {
            let input = if step % 3 == 2 {
                0.5 * (low.input + high.input)
            } else {
                (low.input * high.slope - high.input * low.slope) / (high.slope - low.slope)
            };
            let inside = start + (input - start).rem_euclid(span);
            let Some(row) = passes.row(0, inside, &UNIT) else {
                break;
            };
            let here = Sample { input, value: self.rate(&row, order), slope: self.slope(&row, order) };
            look(ends, here.value, input);
            if here.slope.abs() < NO_SLOPE || (high.input - low.input).abs() < SAME_INPUT {
                break;
            }
            if here.slope * low.slope > 0.0 {
                low = here;
            } else {
                high = here;
            }
        }
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
