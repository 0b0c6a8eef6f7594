//! A row of a circuit as the chain has it.

use crate::loops::equation::chain::Chain;
use crate::loops::equation::closed::{At, Closed, Explicits, Inverse, Placed, copied, input_row};
use crate::loops::equation::dense::{Array, length};
use crate::loops::rates::velocities::{self, ORDERS, Rates};
use crate::number::Number;
use crate::outcome::RowStatus;
use crate::stopping;

/// The input at unit speed.
pub(super) const UNIT: [f64; ORDERS] = [1.0, 0.0, 0.0];

/// A row of a circuit.
#[derive(Debug)]
pub(crate) struct Row<S: Closed = Chain> {
    pub at: At<S>,
    pub rates: Rates<S>,
    pub status: RowStatus,
    pub pass: usize,
    pub residual: f64,
    pub condition: f64,
}

impl<S: Closed> Row<S> {
    /// Its rates, which are those at unit speed of the input, at another speed.
    pub fn rates_at(&self, speed: f64) -> Rates<S> {
        let mut rates = self.rates;
        let mut factor = 1.0;
        for order in &mut rates {
            factor *= speed;
            for x in order.as_mut() {
                *x *= factor;
            }
        }
        rates
    }

    /// One of those in closed form.
    pub fn explicit(pass: usize, own: &Explicits<S>, k: usize) -> Self {
        let mut at = At::zero();
        at.values = S::Columns::from_fn(|c| own.values[c][k]);
        Self {
            at,
            rates: own.rates.map(|order| S::Columns::from_fn(|c| order[c][k])),
            status: RowStatus::Ok,
            pass,
            residual: own.residual[k],
            condition: own.condition[k],
        }
    }

    /// The row at an input beyond a limit.
    pub fn missing(pass: usize) -> Self {
        let mut at = At::zero();
        at.values = S::Columns::filled(f64::NAN);
        Self {
            at,
            rates: [S::Columns::filled(f64::NAN); ORDERS],
            status: RowStatus::NoSolution,
            pass,
            residual: f64::NAN,
            condition: f64::NAN,
        }
    }
}

/// A row's numbers.
pub(super) struct Solved<S: Closed, N: Number> {
    pub at: At<S, N>,
    pub rates: Rates<S, N>,
    pub residual: N,
    pub condition: N,
}

copied!(Row<S>, Solved<S, N>);

/// A correction [rad, or relative to the size] after which the next is rounding.
const SETTLED: f64 = 1e-7;

/// Corrections of a row, and how far they may lead together [rad, or relative to the size].
const MOST_CORRECTIONS: usize = 8;
const FARTHEST_CORRECTION: f64 = 0.3;

/// The configuration with the input at a value, by Newton from a near one, with its rates.
pub(super) fn solved<S: Closed>(
    chain: &S,
    input: usize,
    rough: &At<S>,
    value: f64,
    rates: &[f64; ORDERS],
) -> Option<Solved<S, f64>> {
    let mut at = *rough;
    at.values[input] = value;
    let row: S::Columns<f64> = input_row(input);
    let mut moved = 0.0;
    for step in 0..MOST_CORRECTIONS {
        stopping::piece();
        let placed = chain.place(&at);
        let inverse = chain.inverse(&placed.screws, &row);
        let mut by = inverse.times(placed.error.as_ref()).map(|x| -x);
        by[input] = 0.0;
        let size = length(&by);
        moved += size;
        if !size.is_finite() || moved > FARTHEST_CORRECTION {
            return None;
        }
        at = chain.moved(&at, &by);
        // the correction of the next step would be the square of this one
        if size < SETTLED || step == MOST_CORRECTIONS - 1 {
            let placed = chain.place(&at);
            let inverse = chain.inverse(&placed.screws, &row);
            return Some(finished(chain, at, &placed, &inverse, (input, rates)));
        }
    }
    None
}

/// The row at a solved configuration, by the inverse there or very near.
#[inline(always)]
pub(super) fn finished<S: Closed, N: Number>(
    chain: &S,
    at: At<S, N>,
    placed: &Placed<S, N>,
    inverse: &Inverse<S, N>,
    (input, given): (usize, &[f64; ORDERS]),
) -> Solved<S, N> {
    let one = N::splat(1.0);
    // the rate's series has half its second derivative
    let series = [N::splat(given[0]), N::splat(given[1]), N::splat(given[2] / 2.0)];
    let (rates, _) = velocities::rates(chain, (&at, placed), inverse, &series, Some(input));
    let mut square = one;
    for screw in placed.screws.as_ref() {
        for x in screw.as_ref() {
            square = square.plus_product(*x, *x);
        }
    }
    let mut at = at;
    at.square_up(chain.ball_count());
    Solved {
        at,
        rates,
        residual: chain.residual(placed),
        condition: (square * inverse.square(S::ROWS + 1)).sqrt(),
    }
}
