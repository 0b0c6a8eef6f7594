//! Sine, cosine and arctangent without branches, for loops that become vector code.
//!
//! Polynomials are minimax fits (Remez exchange in 50-digit arithmetic) on the reduced ranges; together with the reduction
//! the error stays below 1e-15.

use crate::simd::multiply_add;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// Angles up to this size [rad] are reduced by three-part subtraction of quarter turns.
pub(crate) const LARGEST_ANGLE: f64 = 1.0e6;

/// `pi/2` in three parts; a product of the first two with a quarter-turn count below 2^20 is exact.
const QUARTER: [f64; 3] = [1.5707963267341256, 6.077100506303966e-11, 2.0222662487959506e-21];

/// Adding this rounds to an integer, which then stands in the lowest bits.
const ROUNDER: f64 = 6_755_399_441_055_744.0;

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
const TAN_EIGHTH: f64 = 0.41421356237309503;

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sine_and_cosine_agree_with_the_standard_library() {
        for k in -200_000..200_000 {
            let x = f64::from(k) * 0.0137 + 1e-9 * f64::from(k) * f64::from(k);
            for (s, c) in [sin_cos::<true>(x), sin_cos::<false>(x)] {
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
                for got in [atan2::<true>(y, x), atan2::<false>(y, x)] {
                    assert!((got - want).abs() < 1e-15, "{y} {x} {got} {want}");
                }
            }
        }
    }
}
