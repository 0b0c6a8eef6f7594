//! Rows of a circuit eight at a time in vector lanes. What does not settle at once is left to the single row.

use super::row::{self, Row, UNIT};
use crate::loops::equation::closed::{At, Closed, input_row};
use crate::loops::equation::dense::length;
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
pub(super) struct Near<S: Closed> {
    pub at: At<S>,
    pub value: f64,
    pub tube: f64,
}

/// The rows of a pass near some places, at unit speed of the input; `None` where one does not settle.
pub(super) fn rows_near<S: Closed>(
    chain: &S,
    input: usize,
    pass: usize,
    starts: &[Near<S>],
) -> Vec<Option<Row<S>>> {
    if S::SIDE_BY_SIDE {
        let mut rows = Vec::with_capacity(starts.len());
        dispatch(RowsNear { chain, input, pass, starts, rows: &mut rows });
        rows
    } else {
        vec![None; starts.len()]
    }
}

struct RowsNear<'a, S: Closed> {
    chain: &'a S,
    input: usize,
    pass: usize,
    starts: &'a [Near<S>],
    rows: &'a mut Vec<Option<Row<S>>>,
}

impl<S: Closed> LaneKernel for RowsNear<'_, S> {
    #[inline(always)]
    fn run<V: Vector>(mut self) {
        for block in self.starts.chunks(LANES) {
            stopping::piece();
            let mut each = [At::zero(); LANES];
            for (lane, at) in each.iter_mut().enumerate() {
                let near = &block[lane.min(block.len() - 1)];
                *at = near.at;
                at.values[self.input] = near.value;
            }
            let at = At::<S, V>::beside(&each, self.chain.ball_count());
            self.block(&at, block);
        }
    }
}

impl<S: Closed> RowsNear<'_, S> {
    #[inline(always)]
    fn block<V: Vector>(&mut self, rough: &At<S, V>, starts: &[Near<S>]) {
        let (chain, input) = (self.chain, self.input);
        let placed = chain.place(rough);
        let inverse = chain.inverse(&placed.screws, &input_row(input));
        let mut by = inverse.times(placed.error.as_ref());
        for x in by.as_mut() {
            *x = -*x;
        }
        by[input] = V::splat(0.0);
        let near = chain.moved(rough, &by);
        let again = chain.place(&near);
        let (mut more, _) = inverse.correction((&placed.screws, &again.screws), &again.error, NEUMANN);
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
        for c in 0..S::COLUMNS {
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
