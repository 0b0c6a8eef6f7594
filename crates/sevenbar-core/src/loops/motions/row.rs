//! A row of a circuit as the chain has it.

use crate::loops::equation::chain::{Chain, Configuration, Placed};
use crate::loops::equation::dense::{COLUMNS, Inverse, length};
use crate::loops::equation::rotations::squared_up;
use crate::loops::equation::screws::{bordered_inverse, input_row};
use crate::loops::rates::velocities::{self, ORDERS, Rates};
use crate::number::Number;
use crate::outcome::RowStatus;
use crate::stopping;

/// The input at unit speed.
pub(super) const UNIT: [f64; ORDERS] = [1.0, 0.0, 0.0];

/// A row of a circuit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    pub at: Configuration,
    pub rates: Rates,
    pub status: RowStatus,
    pub pass: usize,
    pub residual: f64,
    pub condition: f64,
}

impl Row {
    /// The row at an input beyond a limit.
    pub fn missing(pass: usize) -> Self {
        let mut at = Configuration::ZERO;
        at.values = [f64::NAN; COLUMNS];
        Self {
            at,
            rates: [[f64::NAN; COLUMNS]; ORDERS],
            status: RowStatus::NoSolution,
            pass,
            residual: f64::NAN,
            condition: f64::NAN,
        }
    }
}

/// A row's numbers.
#[derive(Clone, Copy)]
pub(super) struct Solved<N> {
    pub at: Configuration<N>,
    pub rates: Rates<N>,
    pub residual: N,
    pub condition: N,
}

/// A correction [rad, or relative to the size] after which the next is rounding.
const SETTLED: f64 = 1e-7;

/// Corrections of a row, and how far they may lead together [rad, or relative to the size].
const MOST_CORRECTIONS: usize = 8;
const FARTHEST_CORRECTION: f64 = 0.3;

/// The configuration with the input at a value, by Newton from a near one, with its rates.
pub(super) fn solved(
    chain: &Chain,
    input: usize,
    rough: &Configuration,
    value: f64,
    rates: &[f64; ORDERS],
) -> Option<Solved<f64>> {
    let mut at = *rough;
    at.values[input] = value;
    let row = input_row(input);
    let mut moved = 0.0;
    for step in 0..MOST_CORRECTIONS {
        stopping::piece();
        let placed = chain.place(&at);
        let inverse = bordered_inverse(&placed.screws, chain.columns, &row);
        let mut by = inverse.times(&placed.error).map(|x| -x);
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
            let inverse = bordered_inverse(&placed.screws, chain.columns, &row);
            return Some(finished(chain, at, &placed, &inverse, (input, rates)));
        }
    }
    None
}

/// The row at a solved configuration, by the inverse there or very near.
#[inline(always)]
pub(super) fn finished<N: Number>(
    chain: &Chain,
    at: Configuration<N>,
    placed: &Placed<N>,
    inverse: &Inverse<N>,
    (input, given): (usize, &[f64; ORDERS]),
) -> Solved<N> {
    let one = N::splat(1.0);
    // the rate's series has half its second derivative
    let series = [N::splat(given[0]), N::splat(given[1]), N::splat(given[2] / 2.0)];
    let (rates, _) = velocities::rates(chain, placed, inverse, &series, Some(input));
    let mut square = one;
    for x in placed.screws.as_flattened() {
        square = square.plus_product(*x, *x);
    }
    let mut at = at;
    for ball in &mut at.balls[..chain.ball_count()] {
        *ball = squared_up(ball);
    }
    Solved {
        at,
        rates,
        residual: chain.residual(placed),
        condition: (square * inverse.square(7)).sqrt(),
    }
}
