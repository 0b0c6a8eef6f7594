//! Rows of a circuit eight at a time in vector lanes. What does not settle at once is left to the single row.

use super::row::{self, Row, UNIT};
use crate::loops::equation::chain::{Chain, Configuration};
use crate::loops::equation::dense::{COLUMNS, length};
use crate::loops::equation::screws::{bordered_inverse, correction, input_row};
use crate::loops::rates::velocities::ORDERS;
use crate::outcome::RowStatus;
use crate::stopping;
use crate::vectors::{LANES, LaneKernel, Vector, dispatch};

/// A last correction [rad, or relative to the size] after which the next is rounding.
const SETTLED: f64 = 1e-8;

/// Terms of Neumann's series in the second correction, whose inverse is that of the first.
const NEUMANN: usize = 2;

/// Part of its tube to which a row's corrections may lead: to a place on its own plane they are at most that much longer.
const WITHIN: f64 = 0.45;

/// A place near a row: the input there, and the radius within which the curve is alone.
#[derive(Clone, Copy, Debug)]
pub(super) struct Near {
    pub at: Configuration,
    pub value: f64,
    pub tube: f64,
}

/// The rows of a pass near some places, at unit speed of the input; `None` where one does not settle.
pub(super) fn rows_near(chain: &Chain, input: usize, pass: usize, starts: &[Near]) -> Vec<Option<Row>> {
    let mut rows = Vec::with_capacity(starts.len());
    dispatch(RowsNear { chain, input, pass, starts, rows: &mut rows });
    rows
}

struct RowsNear<'a> {
    chain: &'a Chain,
    input: usize,
    pass: usize,
    starts: &'a [Near],
    rows: &'a mut Vec<Option<Row>>,
}

impl LaneKernel for RowsNear<'_> {
    #[inline(always)]
    fn run<V: Vector>(mut self) {
        for block in self.starts.chunks(LANES) {
            stopping::piece();
            let mut each = [Configuration::ZERO; LANES];
            for (lane, at) in each.iter_mut().enumerate() {
                let near = &block[lane.min(block.len() - 1)];
                *at = near.at;
                at.values[self.input] = near.value;
            }
            let at = Configuration::<V>::beside(&each, self.chain.ball_count());
            self.block(&at, block);
        }
    }
}

impl RowsNear<'_> {
    #[inline(always)]
    fn block<V: Vector>(&mut self, rough: &Configuration<V>, starts: &[Near]) {
        let (chain, input) = (self.chain, self.input);
        let placed = chain.place(rough);
        let inverse = bordered_inverse(&placed.screws, chain.columns, &input_row(input));
        let mut by = inverse.times(&placed.error);
        for x in &mut by {
            *x = -*x;
        }
        by[input] = V::splat(0.0);
        let near = chain.moved(rough, &by);
        let again = chain.place(&near);
        let (mut more, _) = correction(&inverse, (&placed.screws, &again.screws), &again.error, NEUMANN);
        more[input] = V::splat(0.0);
        let at = chain.moved(&near, &more);
        let last = length(&more);
        let gone = (length(&by) + last).store();
        let last = last.store();
        let solved = row::finished(chain, at, &chain.place(&at), &inverse, (input, &UNIT));
        let (residual, condition) = (solved.residual.store(), solved.condition.store());
        let first = self.rows.len();
        for (k, near) in starts.iter().enumerate() {
            let settled = last[k] < SETTLED && gone[k] < WITHIN * near.tube;
            self.rows.push(settled.then_some(Row {
                status: RowStatus::Ok,
                residual: residual[k],
                condition: condition[k],
                ..Row::missing(self.pass)
            }));
        }
        let rows = &mut self.rows[first..];
        let places = solved.at.apart(chain.ball_count());
        for (row, at) in rows.iter_mut().zip(places) {
            if let Some(row) = row {
                row.at = at;
            }
        }
        for c in 0..COLUMNS {
            for order in 0..ORDERS {
                let lanes = solved.rates[order][c].store();
                for (row, rate) in rows.iter_mut().zip(lanes) {
                    if let Some(row) = row {
                        row.rates[order][c] = rate;
                    }
                }
            }
        }
    }
}
