//! Rows of a circuit eight at a time in vector lanes. What does not settle at once is left to the single row.

use super::chain::{COLUMNS, Configuration};
use super::circuits::{Passes, Rough, Row, UNIT, input_row, missing};
use super::curve::{bordered_inverse, correction, length};
use super::rates::ORDERS;
use crate::outcome::RowStatus;
use crate::vectors::{LANES, LaneKernel, Vector, dispatch};

/// A last correction [rad, or parts of the size] after which the next is rounding.
const SETTLED: f64 = 1e-8;

/// Terms of Neumann's series in the second correction, whose inverse is that of the first.
const NEUMANN: usize = 2;

/// Part of its tube to which a row's corrections may lead: to a place on its own plane they are at most that much longer.
const WITHIN: f64 = 0.45;

/// Adds the rows of a pass at inputs near which rough places are known, at unit speed of the input.
pub(super) fn add_rows(passes: &Passes, pass: usize, starts: &[(Rough, f64)], rows: &mut Vec<Row>) {
    dispatch(Many { passes, pass, starts, rows });
}

struct Many<'a, 'b> {
    passes: &'a Passes<'b>,
    pass: usize,
    starts: &'a [(Rough, f64)],
    rows: &'a mut Vec<Row>,
}

impl LaneKernel for Many<'_, '_> {
    #[inline(always)]
    fn run<V: Vector>(mut self) {
        let (chain, input) = (self.passes.chain, self.passes.input);
        self.rows.reserve(self.starts.len());
        let starts = self.starts;
        for block in starts.chunks(LANES) {
            let mut each = [Configuration::ZERO; LANES];
            for (lane, at) in each.iter_mut().enumerate() {
                let (rough, value) = &block[lane.min(block.len() - 1)];
                *at = self.passes.start(rough);
                at.values[input] = *value;
            }
            let at = Configuration::<V>::beside(&each, chain.ball_count());
            self.block(&at, block);
        }
    }
}

impl Many<'_, '_> {
    #[inline(always)]
    fn block<V: Vector>(&mut self, rough: &Configuration<V>, starts: &[(Rough, f64)]) {
        let (chain, input) = (self.passes.chain, self.passes.input);
        let placed = chain.place(rough);
        let inverse = bordered_inverse(&placed.screws, chain.columns, &input_row(input));
        let mut by = inverse.times(&placed.error);
        for x in &mut by {
            *x = -*x;
        }
        by[input] = V::splat(0.0);
        let near = chain.moved(rough, &by);
        let again = chain.place(&near);
        let (mut more, _) = correction(&inverse, (&placed.screws, &again), NEUMANN);
        more[input] = V::splat(0.0);
        let at = chain.moved(&near, &more);
        let last = length(&more);
        let gone = (length(&by) + last).store();
        let last = last.store();
        let solved = chain.finished(at, &chain.place(&at), &inverse, (input, &UNIT));
        let (residual, condition) = (solved.residual.store(), solved.condition.store());
        let first = self.rows.len();
        let mut settled = [false; LANES];
        for (k, (rough, value)) in starts.iter().enumerate() {
            settled[k] = last[k] < SETTLED && gone[k] < WITHIN * rough.tube;
            let mut row = missing(self.pass);
            if settled[k] {
                row.status = RowStatus::Ok;
                row.residual = residual[k];
                row.condition = condition[k];
            } else if let Some(single) = self.passes.row(self.pass, *value, &UNIT) {
                row = single;
            }
            self.rows.push(row);
        }
        let rows = &mut self.rows[first..];
        let places = solved.at.apart(chain.ball_count());
        for (k, row) in rows.iter_mut().enumerate().filter(|(k, _)| settled[*k]) {
            row.at = places[k];
        }
        for c in 0..COLUMNS {
            for order in 0..ORDERS {
                let lanes = solved.rates[order][c].store();
                for (k, row) in rows.iter_mut().enumerate().filter(|(k, _)| settled[*k]) {
                    row.rates[order][c] = lanes[k];
                }
            }
        }
    }
}
