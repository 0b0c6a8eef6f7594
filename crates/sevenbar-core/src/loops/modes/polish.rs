//! Newton's method with the input held, and when that to which it comes counts as closed.
//!
//! A loop with redundant constraints closes by its exact dimensions alone: numbers that are rounded leave it open everywhere, though by
//! next to nothing. Newton's method, by least squares, then settles where what is left is borne by wrenches to which no joint yields.
//! Such a pose counts as closed while its closure error is below what the chain takes to agree, and so does a node of a circuit. What
//! joints could close must be closed to rounding, in every loop.

use crate::loops::equation::chain::{Chain, Configuration};
use crate::loops::equation::closed::{At, Closed};
use crate::loops::equation::dense::{
    Array, COLUMNS, Columns, Factored, ROWS, least_squares, singular_values,
};
use crate::loops::mobility::rank::{rank, unyielding};
use crate::stopping;

/// The closure error [rad, or relative to the size] that a mode may keep in constraints that count.
pub(crate) const CLOSED: f64 = 1e-11;

/// The closure error [rad, or relative to the size] up to which a pose counts as kept open by redundant constraints alone: links of 100 mm
/// cut to a hundredth of a millimetre.
const NEARLY: f64 = 1e-4;

/// A move [rad, or relative to the size] after which the next would be rounding.
const SETTLED: f64 = 1e-12;

/// A closed pose is left for no other that closes worse by this.
const WORSE: f64 = 10.0;

/// Most steps; a pose that is still so far from closing [rad, or relative to the size] after so many of them will not close.
const MOST_STEPS: usize = 60;
const HOPELESS_AFTER: usize = 25;
const HOPELESS: f64 = 1e-3;

/// Most steps where there are freedoms to spare: the way to an isolated pose winds if lengths of links differ widely.
const MOST_WITH_SPARE: usize = 240;

/// Steps after which it is seen whether a pose comes nearer to closing.
const LOOK: usize = 8;

/// A pose that closes as well as it can with the input held.
pub(crate) struct Settled {
    pub at: Configuration,
    /// The closure error that is left in redundant constraints [rad, or relative to the size].
    pub error: f64,
    /// Whether its redundant constraints agree, so that it is a mode.
    pub agrees: bool,
}

/// Newton's method with the input held; `None` where it does not close, redundant constraints aside, or goes farther than `reach`.
pub(crate) fn polish(chain: &Chain, input: usize, rough: &Configuration, reach: f64) -> Option<Settled> {
    let mut at = *rough;
    let (mut best, mut closed) = (f64::INFINITY, None);
    for step in 0..MOST_STEPS {
        stopping::piece();
        let placed = chain.place(&at);
        let residual = chain.residual(&placed);
        if let Some(before) = closed.filter(|_| residual > WORSE * best) {
            // rounding leads out of a pose that closes by a square
            at = before;
            break;
        }
        if residual < CLOSED && (residual >= 0.5 * best || residual < 1e-15) {
            break;
        }
        best = best.min(residual);
        closed = (residual < CLOSED).then_some(at);
        let mut columns = [[0.0; ROWS]; COLUMNS];
        for (c, column) in columns.iter_mut().enumerate().take(chain.columns) {
            if c == input {
                // held, also where redundant constraints would rather have it move
                column[6] = 1.0;
            } else {
                column[..6].copy_from_slice(&placed.screws[c]);
            }
        }
        let mut right = [0.0; ROWS];
        for (r, e) in right.iter_mut().zip(&placed.error) {
            *r = -e;
        }
        let by = Factored::new(columns, chain.columns).solve(right);
        let longest = by.iter().fold(0.0, |m: f64, b| m.max(b.abs()));
        if !longest.is_finite() || (step > HOPELESS_AFTER && residual > HOPELESS) {
            return None;
        }
        if longest < SETTLED && residual >= CLOSED {
            break;
        }
        // a full step near the answer, a bounded one far from it
        let factor = if longest > 1.0 { 1.0 / longest } else { 1.0 };
        let by: Columns = by.map(|b| b * factor);
        at = chain.moved(&at, &by);
        at.square_up(chain.ball_count());
    }
    let gone = chain
        .difference(rough, &at)
        .iter()
        .fold(0.0, |m: f64, d| m.max(d.abs()));
    let error = closure_error(chain, &at)?;
    (gone <= reach).then_some(Settled { at, error, agrees: error < chain.agree })
}

/// The same where joints have freedoms to spare: each step is the shortest of those that lead as near. No input is `held` where any pose
/// will do.
pub(super) fn polish_with_spare<S: Closed>(of: &S, held: Option<usize>, rough: &At<S>) -> Option<At<S>> {
    let mut at = *rough;
    let mut best = f64::INFINITY;
    let mut looked = f64::INFINITY;
    for step in 0..MOST_WITH_SPARE {
        stopping::piece();
        let placed = of.place(&at);
        let residual = of.residual(&placed);
        // a pose that closes by a square is as near as rounding lets it come, not where it first closes
        if residual < CLOSED && (residual >= 0.5 * best || residual < 1e-15) {
            return Some(at);
        }
        best = best.min(residual);
        if !residual.is_finite() {
            return None;
        }
        if step % LOOK == LOOK - 1 {
            // even where it closes by a square each step halves what is left
            if best > 0.5 * looked {
                return None;
            }
            looked = best;
        }
        let mut columns = of.screws(&at);
        if let Some(input) = held {
            columns[input].fill(0.0);
        }
        let by = least_squares(&columns, placed.error.map(|e| -e).as_ref(), of.no_rank());
        let longest = by.iter().fold(0.0, |m: f64, b| m.max(b.abs()));
        if !longest.is_finite() {
            return None;
        }
        let factor = if longest > 1.0 { 1.0 / longest } else { 1.0 };
        let moved = S::Columns::padded(&by, 0.0).map(|b| b * factor);
        at = of.moved(&at, &moved);
        at.square_up(of.ball_count());
    }
    None
}

/// The closure error that is left in redundant constraints; `None` for a pose that is open in others too.
fn closure_error(chain: &Chain, at: &Configuration) -> Option<f64> {
    let placed = chain.place(at);
    let residual = chain.residual(&placed);
    if residual < CLOSED {
        return Some(residual);
    }
    let error = &placed.error;
    let left = error.iter().map(|e| e * e).sum::<f64>().sqrt();
    // turned right round, the error shows nothing
    if !chain.is_redundant() || left.is_nan() || residual > NEARLY.max(chain.agree) {
        return None;
    }
    let columns = chain.screws(at);
    let rank = rank(
        &singular_values(&columns).0,
        ROWS - 1,
        chain.no_rank().max(30.0 * left),
    );
    if chain.columns - rank != 1 {
        return None;
    }
    let mut rest = *error;
    for row in unyielding(&columns, ROWS - 1, rank) {
        let borne: f64 = row.iter().zip(error).map(|(w, e)| w * e).sum();
        for k in 0..6 {
            rest[k] -= borne * row[k];
        }
    }
    // to first order: what a joint could close, and has not
    let rest = rest.iter().map(|e| e * e).sum::<f64>().sqrt();
    (rest < CLOSED.max(10.0 * left * left)).then_some(left)
}
