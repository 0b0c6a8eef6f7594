//! Screws of joints, and how they are carried.
//!
//! Source: docs/theory.md, (4), (5) and (13).

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
