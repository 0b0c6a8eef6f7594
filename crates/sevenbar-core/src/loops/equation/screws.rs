//! Screws of joints, and the linear equations that they make.
//!
//! Source: docs/theory.md, (4), (5) and (13).

use super::dense::{COLUMNS, Columns, Factored, Inverse, ROWS};
use super::rotations::cross;
use crate::number::Number;

/// An angular part and a linear part, or a twist and what it does to the origin.
pub(crate) type Twist<N = f64> = [N; 6];

/// The screw with this axis through a point, and the advance for each radian.
#[inline(always)]
pub(super) fn screw<N: Number>(axis: &[N; 3], point: &[N; 3], advance: f64) -> Twist<N> {
    let moment = cross(point, axis);
    let mut out = [axis[0], axis[1], axis[2], moment[0], moment[1], moment[2]];
    if advance != 0.0 {
        for k in 0..3 {
            out[k + 3] = out[k + 3].plus_product(axis[k], N::splat(advance));
        }
    }
    out
}

/// `[a, b]`: how the screw `b` changes while its body moves with the twist `a`.
///
/// Source: docs/theory.md, (13).
#[inline(always)]
pub(crate) fn bracket<N: Number>(a: &Twist<N>, b: &Twist<N>) -> Twist<N> {
    let turn = cross(&a[..3], &b[..3]);
    let (first, second) = (cross(&a[..3], &b[3..]), cross(&a[3..], &b[..3]));
    [
        turn[0],
        turn[1],
        turn[2],
        first[0] + second[0],
        first[1] + second[1],
        first[2] + second[2],
    ]
}

/// The twist of rates by the screws.
#[inline(always)]
pub(crate) fn twist_of<N: Number>(screws: &[Twist<N>; COLUMNS], rates: &Columns<N>) -> Twist<N> {
    let mut sum = [N::splat(0.0); 6];
    for c in 0..COLUMNS {
        for k in 0..6 {
            sum[k] = sum[k].plus_product(screws[c][k], rates[c]);
        }
    }
    sum
}

/// The row of the Jacobian that names the input.
pub(crate) fn input_row<N: Number>(input: usize) -> Columns<N> {
    let mut row = [N::splat(0.0); COLUMNS];
    row[input] = N::splat(1.0);
    row
}

/// The pseudo-inverse of the screws of so many columns with one more row.
#[inline(always)]
pub(crate) fn bordered_inverse<N: Number>(
    screws: &[Twist<N>; COLUMNS],
    count: usize,
    row: &Columns<N>,
) -> Inverse<N> {
    let mut columns = [[N::splat(0.0); ROWS]; COLUMNS];
    for c in 0..count {
        columns[c][..6].copy_from_slice(&screws[c]);
        columns[c][6] = row[c];
    }
    Factored::new(columns, count).inverse()
}

/// The move `d` with `(A + change) d = -error`, by the inverse of `A` and a few terms of Neumann's series.
#[inline(always)]
pub(crate) fn correction<N: Number>(
    inverse: &Inverse<N>,
    (from, now): (&[Twist<N>; COLUMNS], &[Twist<N>; COLUMNS]),
    error: &Twist<N>,
    terms: usize,
) -> (Columns<N>, Columns<N>) {
    let mut change = *now;
    for c in 0..COLUMNS {
        for k in 0..6 {
            change[c][k] = change[c][k] - from[c][k];
        }
    }
    let mut first = inverse.times(error);
    for x in &mut first {
        *x = -*x;
    }
    let mut d = first;
    for _ in 0..terms {
        let seen = inverse.times(&twist_of(&change, &d));
        for c in 0..COLUMNS {
            d[c] = first[c] - seen[c];
        }
    }
    (d, first)
}
