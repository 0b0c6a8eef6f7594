//! Sine, cosine and arctangent without branches, for loops that become vector code.
//!
//! Polynomials are minimax fits (Remez exchange in 50-digit arithmetic) on the reduced ranges; together with the reduction
//! the error stays below 1e-15.

use crate::number::Number;
use crate::simd::multiply_add;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// Angles up to this size [rad] are reduced by three-part subtraction of quarter turns.
pub(crate) const LARGEST_ANGLE: f64 = 1.0e6;

/// `pi/2` in three parts; a product of the first two with a quarter-turn count below 2^20 is exact.
const QUARTER: [f64; 3] = [1.5707963267341256, 6.077100506303966e-11, 2.0222662487959506e-21];

/// Adding this rounds to an integer, which then stands in the lowest bits.
pub(crate) const ROUNDER: f64 = 6_755_399_441_055_744.0;

const SINE: [f64; 6] = [
    -0.16666666666666632,
    0.00833333333332256,
    -0.00019841269829904467,
    2.755731372078613e-06,
    -2.505076212453891e-08,
    1.5897006122290992e-10,
];

const COSINE: [f64; 6] = [
    0.041666666666666616,
    -0.0013888888888876141,
    2.480158729058172e-05,
    -2.7557314636056255e-07,
    2.087575830322097e-09,
    -1.1361316130563182e-11,
];

const ARCTANGENT: [f64; 11] = [
    -0.3333333333333323,
    0.19999999999961648,
    -0.1428571428087969,
    0.11111110813305483,
    -0.09090898526250861,
    0.07692072666373852,
    -0.06663234579191393,
    0.05848773574277903,
    -0.050430422734122585,
    0.03815418495043819,
    -0.01800031309020013,
];

/// `tan(pi/8)`
pub(crate) const TAN_EIGHTH: f64 = 0.41421356237309503;

#[inline(always)]
fn polynomial<const FUSED: bool, const N: usize>(coefficients: &[f64; N], x: f64) -> f64 {
    let mut sum = coefficients[N - 1];
    let mut k = N - 1;
    while k > 0 {
        k -= 1;
        sum = multiply_add::<FUSED>(sum, x, coefficients[k]);
    }
    sum
}

/// Sine and cosine of an angle of at most [`LARGEST_ANGLE`].
#[inline(always)]
pub(crate) fn sin_cos<const FUSED: bool>(angle: f64) -> (f64, f64) {
    let rounded = multiply_add::<FUSED>(angle, std::f64::consts::FRAC_2_PI, ROUNDER);
    let quarter = rounded.to_bits();
    let count = rounded - ROUNDER;
    let mut r = multiply_add::<FUSED>(-count, QUARTER[0], angle);
    r = multiply_add::<FUSED>(-count, QUARTER[1], r);
    r = multiply_add::<FUSED>(-count, QUARTER[2], r);
    let w = r * r;
    let s = multiply_add::<FUSED>(r * w, polynomial::<FUSED, 6>(&SINE, w), r);
    let tail = multiply_add::<FUSED>(w * w, polynomial::<FUSED, 6>(&COSINE, w), -0.5 * w);
    let c = 1.0 + tail;
    let odd = quarter & 1 == 1;
    let (sine, cosine) = (if odd { c } else { s }, if odd { s } else { c });
    (
        f64::from_bits(sine.to_bits() ^ ((quarter & 2) << 62)),
        f64::from_bits(cosine.to_bits() ^ ((quarter.wrapping_add(1) & 2) << 62)),
    )
}

/// The same for numbers side by side, whose bits are out of reach: quarter turns are distinguished by arithmetic.
#[inline(always)]
pub(crate) fn sin_cos_side_by_side<N: Number>(angle: N) -> (N, N) {
    let (rounder, half, one) = (N::splat(ROUNDER), N::splat(0.5), N::splat(1.0));
    let count = rounder.plus_product(angle, N::splat(std::f64::consts::FRAC_2_PI)) - rounder;
    let mut r = angle;
    for part in QUARTER {
        r = r.minus_product(count, N::splat(part));
    }
    let w = r * r;
    let (mut s, mut c) = (N::splat(SINE[5]), N::splat(COSINE[5]));
    for k in (0..5).rev() {
        s = N::splat(SINE[k]).plus_product(s, w);
        c = N::splat(COSINE[k]).plus_product(c, w);
    }
    let s = r.plus_product(r * w, s);
    let c = one + (w * w * c).minus_product(half, w);
    // whole multiples of two and of four quarter turns taken off
    let two = count.minus_product(N::splat(2.0), rounder.plus_product(count, half) - rounder);
    let four = count.minus_product(
        N::splat(4.0),
        rounder.plus_product(count, N::splat(0.25)) - rounder,
    );
    let odd = two * two;
    let (sine, cosine) = (odd.if_greater(half, c, s), odd.if_greater(half, s, c));
    (sine * sign_of_quarter(-four), cosine * sign_of_quarter(four))
}

/// The sign of the cosine after so many quarter turns, -2 to 2, its turn into a sine seen to.
#[inline(always)]
fn sign_of_quarter<N: Number>(count: N) -> N {
    let (one, half) = (N::splat(1.0), N::splat(0.5));
    count.if_greater(half, -one, (-count).if_greater(N::splat(1.5), -one, one))
}

/// The angle of the vector `(x, y)` in [-pi, pi]; 0 for the zero vector.
#[inline(always)]
pub(crate) fn atan2<const FUSED: bool>(y: f64, x: f64) -> f64 {
    let (ax, ay) = (x.abs(), y.abs());
    let steep = ay > ax;
    let (small, large) = (if steep { ax } else { ay }, if steep { ay } else { ax });
    let beyond = small > TAN_EIGHTH * large;
    let top = if beyond { small - large } else { small };
    let bottom = if beyond { small + large } else { large };
    let z = top / if bottom > 0.0 { bottom } else { 1.0 };
    let w = z * z;
    let mut angle = multiply_add::<FUSED>(z * w, polynomial::<FUSED, 11>(&ARCTANGENT, w), z);
    angle += if beyond { FRAC_PI_4 } else { 0.0 };
    angle = if steep { FRAC_PI_2 - angle } else { angle };
    angle = if x < 0.0 { PI - angle } else { angle };
    angle.copysign(y)
}

/// The angle of a tangent between those of an eighth of half a turn to either side, [`TAN_EIGHTH`].
#[inline(always)]
pub(crate) fn arctangent<N: Number>(z: N) -> N {
    let w = z * z;
    let mut sum = N::splat(ARCTANGENT[10]);
    for k in (0..10).rev() {
        sum = N::splat(ARCTANGENT[k]).plus_product(sum, w);
    }
    z.plus_product(z * w, sum)
}

/// The same as [`atan2`] for numbers side by side.
#[inline(always)]
pub(crate) fn atan2_side_by_side<N: Number>(y: N, x: N) -> N {
    let (zero, one) = (N::splat(0.0), N::splat(1.0));
    let (ax, ay) = (x.size(), y.size());
    let (small, large) = (ay.if_greater(ax, ax, ay), ay.if_greater(ax, ay, ax));
    let edge = large.scaled(TAN_EIGHTH);
    let top = small.if_greater(edge, small - large, small);
    let bottom = small.if_greater(edge, small + large, large);
    let z = top / bottom.if_greater(zero, bottom, one);
    let angle = arctangent(z) + small.if_greater(edge, N::splat(FRAC_PI_4), zero);
    let angle = ay.if_greater(ax, N::splat(FRAC_PI_2) - angle, angle);
    let angle = zero.if_greater(x, N::splat(PI) - angle, angle);
    zero.if_greater(y, -angle, angle)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sine_and_cosine_agree_with_the_standard_library() {
        for k in -200_000..200_000 {
            let x = f64::from(k) * 0.0137 + 1e-9 * f64::from(k) * f64::from(k);
            for (s, c) in [sin_cos::<true>(x), sin_cos::<false>(x), sin_cos_side_by_side(x)] {
                assert!((s - x.sin()).abs() < 4e-16 && (c - x.cos()).abs() < 4e-16, "{x}");
            }
        }
    }

    #[test]
    fn the_arctangent_agrees_with_the_standard_library() {
        for i in -300..=300 {
            for j in -300..=300 {
                let (y, x) = (f64::from(i) * 0.11, f64::from(j) * 0.13);
                let want = y.atan2(x);
                for got in [
                    atan2::<true>(y, x),
                    atan2::<false>(y, x),
                    atan2_side_by_side(y, x),
                ] {
                    assert!((got - want).abs() < 1e-15, "{y} {x} {got} {want}");
                }
            }
        }
    }
}
