//! Velocities, accelerations and jerks: the closure of velocities `sum Si ui = 0` as a power series in time.
//!
//! A joint's screw is carried by the link before it, `Si' = [Vi, Si]` with `Vi = sum Sj uj (j before i)`, so the series of the
//! screws follow from those of the joint rates `u`, and these order by order from one factorised matrix:
//! `A u_k = - sum (a >= 1) Si_a ui_(k-a)`. Nothing is differenced and no angle is differentiated.
//!
//! Source: docs/theory.md, (13) to (16).

use crate::loops::equation::chain::Chain;
use crate::loops::equation::closed::{At, Closed, Inverse, Placed, Screws, input_row, twist_of};
use crate::loops::equation::dense::Array;
use crate::number::Number;

/// Orders of the rates: velocity, acceleration, jerk.
pub(crate) const ORDERS: usize = 3;

/// Corrections of rates by what they leave over.
const REFINEMENTS: usize = 2;

/// Power series of the joint rates `u(t) = u0 + u1 t + u2 t^2`; a ball's are its angular velocity in the frame before it.
pub(crate) type Rates<S = Chain, N = f64> = [<S as Closed>::Columns<N>; ORDERS];

/// Power series of the joint rates and of the screws, of so many terms.
type Series<S, N, const TERMS: usize> = ([<S as Closed>::Columns<N>; TERMS], [Screws<S, N>; TERMS]);

/// The joint rates, order by order, and the series of the screws, by the inverse of the screws with one more row, on which
/// the rates are `given`. Where that row holds one column, the inverse may be that of a place very near.
///
/// Source: docs/theory.md, (15).
#[inline(always)]
pub(crate) fn rates<S: Closed, N: Number, const TERMS: usize>(
    chain: &S,
    (at, placed): (&At<S, N>, &Placed<S, N>),
    inverse: &Inverse<S, N>,
    given: &[N; TERMS],
    held: Option<usize>,
) -> Series<S, N, TERMS> {
    let zero = N::splat(0.0);
    let mut rates = [S::Columns::filled(zero); TERMS];
    // the first, and room for the others
    let mut screws = [placed.screws; TERMS];
    for order in 0..TERMS {
        let mut right = S::Bordered::filled(zero);
        if order > 0 {
            chain.carry(at, &mut screws, &rates, order);
            for a in 1..=order {
                for c in 0..chain.columns() {
                    for k in 0..S::ROWS {
                        right[k] = right[k].minus_product(screws[a][c][k], rates[order - a][c]);
                    }
                }
            }
        }
        right[S::ROWS] = given[order];
        let mut solved = inverse.times(right.as_ref());
        if let Some(column) = held {
            for _ in 0..REFINEMENTS {
                solved[column] = given[order];
                let mut left: S::Rows<N> = twist_of(&placed.screws, &solved);
                for k in 0..S::ROWS {
                    left[k] = right[k] - left[k];
                }
                let more = inverse.times(left.as_ref());
                for c in 0..S::COLUMNS {
                    solved[c] = solved[c] + more[c];
                }
            }
            solved[column] = given[order];
        }
        rates[order] = solved;
    }
    (rates, screws)
}

/// The fourth derivative of a column at a closed configuration, by the input, which has unit speed.
pub(crate) fn fourth_derivative<S: Closed>(chain: &S, at: &At<S>, input: usize, column: usize) -> f64 {
    let placed = chain.place(at);
    let inverse = chain.inverse(&placed.screws, &input_row(input));
    let (rates, _) = rates(chain, (at, &placed), &inverse, &[1.0, 0.0, 0.0, 0.0], Some(input));
    6.0 * rates[ORDERS][column]
}
