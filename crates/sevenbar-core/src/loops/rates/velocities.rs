//! Velocities, accelerations and jerks: the closure of velocities `sum Si ui = 0` as a power series in time.
//!
//! A joint's screw is carried by the link before it, `Si' = [Vi, Si]` with `Vi = sum Sj uj (j before i)`, so the series of the
//! screws follow from those of the joint rates `u`, and these order by order from one factorised matrix:
//! `A u_k = - sum (a >= 1) Si_a ui_(k-a)`. Nothing is differenced and no angle is differentiated.
//!
//! Source: docs/theory.md, (13) to (16).

use crate::loops::equation::chain::{Chain, Configuration, Placed};
use crate::loops::equation::dense::{COLUMNS, Columns, Inverse, ROWS};
use crate::loops::equation::screws::{Twist, bordered_inverse, bracket, input_row, twist_of};
use crate::number::Number;

/// Orders of the rates: velocity, acceleration, jerk.
pub(crate) const ORDERS: usize = 3;

/// Corrections of rates by what they leave over.
const REFINEMENTS: usize = 2;

/// Power series of the joint rates `u(t) = u0 + u1 t + u2 t^2`; a ball's are its angular velocity in the frame before it.
pub(crate) type Rates<N = f64> = [Columns<N>; ORDERS];

/// Power series of the joints' screws, of so many terms.
pub(super) type Screws<N, const TERMS: usize = ORDERS> = [[Twist<N>; COLUMNS]; TERMS];

/// The screws' coefficients of an order, from those of lower ones and the rates.
///
/// Source: docs/theory.md, (13) and (14).
#[inline(always)]
pub(crate) fn carry<N: Number, const TERMS: usize>(
    chain: &Chain,
    screws: &mut Screws<N, TERMS>,
    rates: &[Columns<N>; TERMS],
    order: usize,
) {
    let zero = N::splat(0.0);
    // of the link before each joint
    let mut twists = [[zero; 6]; TERMS];
    let inverse = N::splat(1.0 / order as f64);
    for (joint, &first) in chain.joints.iter().zip(&chain.first) {
        let width = joint.columns();
        for c in first..first + width {
            let mut sum = bracket(&twists[0], &screws[order - 1][c]);
            for a in 1..order {
                let part = bracket(&twists[a], &screws[order - 1 - a][c]);
                for k in 0..6 {
                    sum[k] = sum[k] + part[k];
                }
            }
            for k in 0..6 {
                screws[order][c][k] = sum[k] * inverse;
            }
        }
        for c in first..first + width {
            for a in 0..order {
                for b in 0..=a {
                    for k in 0..6 {
                        twists[a][k] = twists[a][k].plus_product(screws[b][c][k], rates[a - b][c]);
                    }
                }
            }
        }
    }
}

/// The joint rates, order by order, and the series of the screws, by the inverse of the screws with one more row, on which
/// the rates are `given`. Where that row holds one column, the inverse may be that of a place very near.
///
/// Source: docs/theory.md, (15).
#[inline(always)]
pub(crate) fn rates<N: Number, const TERMS: usize>(
    chain: &Chain,
    placed: &Placed<N>,
    inverse: &Inverse<N>,
    given: &[N; TERMS],
    held: Option<usize>,
) -> ([Columns<N>; TERMS], Screws<N, TERMS>) {
    let zero = N::splat(0.0);
    let mut rates = [[zero; COLUMNS]; TERMS];
    let mut screws = [[[zero; 6]; COLUMNS]; TERMS];
    screws[0] = placed.screws;
    for order in 0..TERMS {
        let mut right = [zero; ROWS];
        if order > 0 {
            carry(chain, &mut screws, &rates, order);
            for a in 1..=order {
                for c in 0..chain.columns {
                    for k in 0..6 {
                        right[k] = right[k].minus_product(screws[a][c][k], rates[order - a][c]);
                    }
                }
            }
        }
        right[6] = given[order];
        let mut solved = inverse.times(&right);
        if let Some(column) = held {
            for _ in 0..REFINEMENTS {
                solved[column] = given[order];
                let mut left = twist_of(&placed.screws, &solved);
                for k in 0..6 {
                    left[k] = right[k] - left[k];
                }
                let more = inverse.times(&left);
                for c in 0..COLUMNS {
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
pub(crate) fn fourth_derivative(chain: &Chain, at: &Configuration, input: usize, column: usize) -> f64 {
    let placed = chain.place(at);
    let inverse = bordered_inverse(&placed.screws, chain.columns, &input_row(input));
    let (rates, _) = rates(chain, &placed, &inverse, &[1.0, 0.0, 0.0, 0.0], Some(input));
    6.0 * rates[ORDERS][column]
}
