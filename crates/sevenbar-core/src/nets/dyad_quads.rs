//! Rows of dyads four at once in vector lanes, or one by one on processors of another kind.

use super::dyad_rows::DyadRows;
use super::dyad_sides::Found;
use super::joints::TERMS;
use crate::loops::equation::closed::{Closed, Explicits, Stretch};
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
    /// Power series of the input.
    #[inline(always)]
    fn series<N: Number>(&self, value: N) -> [N; TERMS] {
        let [velocity, acceleration, jerk] = *self.given;
        [
            value,
            N::splat(velocity),
            N::splat(acceleration / 2.0),
            N::splat(jerk / 6.0),
        ]
    }

    /// Makes the row of a net of pins, if it is one.
    #[inline(always)]
    fn of_pins<N: Number>(&self, value: N, found: &mut Found<N>) -> bool {
        let near = (self.on.from.as_ref(), self.on.turns.as_ref());
        if let Some(pins) = &self.dyads.pins {
            pins.row(&self.on.signs, self.series(value), near, found);
        }
        self.dyads.pins.is_some()
    }

    /// The row of a net of any dyads.
    #[inline(always)]
    fn of_dyads<N: Number>(&self, value: N) -> Found<N> {
        self.dyads
            .row(&self.on.signs, self.series(value), self.on.from.as_ref())
    }

    fn one(mut self, k: usize) {
        let mut found = Found::nothing();
        if self.of_pins(self.values[k], &mut found) {
            self.put_one(k, &found);
            if self.rows.is_sure[k] {
                return;
            }
        }
        let found = self.of_dyads(self.values[k]);
        self.put_one(k, &found);
    }

    fn put_one(&mut self, k: usize, found: &Found<f64>) {
        let rows = &mut *self.rows;
        for c in 0..self.dyads.columns() {
            rows.values[c][k] = found.values[c];
            for order in 0..TERMS - 1 {
                rows.rates[order][c][k] = found.rates[order][c];
            }
        }
        rows.residual[k] = found.residual;
        rows.condition[k] = found.condition;
        rows.is_sure[k] = is_sure(found.residual, found.sine);
    }

    #[inline(always)]
    fn put<F: Four>(&mut self, found: &Found<F>) {
        let rows = &mut *self.rows;
        for c in 0..self.dyads.columns() {
            rows.values[c] = found.values[c].store();
            for order in 0..TERMS - 1 {
                rows.rates[order][c] = found.rates[order][c].store();
            }
        }
        rows.residual = found.residual.store();
        rows.condition = found.condition.store();
        let sine = found.sine.store();
        for k in 0..QUAD {
            rows.is_sure[k] = is_sure(rows.residual[k], sine[k]);
        }
    }
}

impl<S: Closed> QuadKernel for Made<'_, S> {
    #[inline(always)]
    fn run<F: Four>(mut self) {
        let value = F::load(self.values);
        let mut found = Found::nothing();
        if self.of_pins(value, &mut found) {
            self.put(&found);
            if self.rows.is_sure == [true; QUAD] {
                return;
            }
        }
        let found = self.of_dyads(value);
        self.put(&found);
    }
}

/// Whether a row that closes so well is sure with such a sine of a dyad.
#[inline(always)]
fn is_sure(residual: f64, sine: f64) -> bool {
    DyadRows::is_sure(sine) && residual < CLOSES
}
