//! Rows of dyads four at once in vector lanes, or one by one on processors of another kind.

use super::dyad_rows::{DyadRows, Found};
use super::joints::TERMS;
use crate::loops::equation::closed::{Closed, Explicit, Explicits, Stretch};
use crate::number::Number;
use crate::vectors::{Four, QUAD, QuadKernel, dispatch_quads};

/// The closure error [rad, or relative to the size] of a row in closed form: rounding.
const CLOSES: f64 = 1e-12;

/// Makes the rows of a stretch at inputs, of which derivatives by time are given.
pub(super) fn made<S: Closed>(
    dyads: &DyadRows,
    on: &Stretch<S>,
    values: &[f64; QUAD],
    given: &[f64; TERMS - 1],
    rows: &mut Explicits<S>,
) {
    let has_quads = dispatch_quads(Made { dyads, on, values, given, rows: &mut *rows });
    // an x86 processor without the registers is older than 2014: it leaves rows to Newton's method, and the code is not twice as long
    if cfg!(not(target_arch = "x86_64")) && !has_quads {
        for k in 0..QUAD {
            Made { dyads, on, values, given, rows: &mut *rows }.one(k);
        }
    }
}

/// Rows being made.
struct Made<'a, S: Closed> {
    dyads: &'a DyadRows,
    on: &'a Stretch<S>,
    values: &'a [f64; QUAD],
    given: &'a [f64; TERMS - 1],
    rows: &'a mut Explicits<S>,
}

impl<S: Closed> Made<'_, S> {
    #[inline(always)]
    fn found<N: Number>(&self, value: N) -> Found<N> {
        let [velocity, acceleration, jerk] = *self.given;
        let series = [
            value,
            N::splat(velocity),
            N::splat(acceleration / 2.0),
            N::splat(jerk / 6.0),
        ];
        self.dyads.row(&self.on.signs, series, self.on.from.as_ref())
    }

    fn one(self, k: usize) {
        let found = self.found(self.values[k]);
        let row = &mut self.rows[k];
        for c in 0..self.dyads.columns() {
            row.at.values[c] = found.values[c];
            for order in 0..TERMS - 1 {
                row.rates[order][c] = found.rates[order][c];
            }
        }
        close(row, [found.residual, found.condition, found.sine]);
    }
}

impl<S: Closed> QuadKernel for Made<'_, S> {
    #[inline(always)]
    fn run<F: Four>(self) {
        let found = self.found(F::load(self.values));
        for c in 0..self.dyads.columns() {
            let lanes = found.values[c].store();
            for k in 0..QUAD {
                self.rows[k].at.values[c] = lanes[k];
            }
            for order in 0..TERMS - 1 {
                let lanes = found.rates[order][c].store();
                for k in 0..QUAD {
                    self.rows[k].rates[order][c] = lanes[k];
                }
            }
        }
        let (residual, condition) = (found.residual.store(), found.condition.store());
        let sine = found.sine.store();
        for k in 0..QUAD {
            close(&mut self.rows[k], [residual[k], condition[k], sine[k]]);
        }
    }
}

/// Puts down how well a row closes, its condition number, and whether it is sure with such a sine of a dyad.
#[inline(always)]
fn close<S: Closed>(row: &mut Explicit<S>, [residual, condition, sine]: [f64; 3]) {
    row.residual = residual;
    row.condition = condition;
    row.is_sure = DyadRows::is_sure(sine) && residual < CLOSES;
}
