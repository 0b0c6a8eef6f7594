//! Numbers as power series in time, so that what is written for numbers gives its derivatives.
//!
//! `x(t) = x0 + x1 t + x2 t^2 + ..`, of one number or of several side by side; [`crate::taylor`] has what a plain number needs besides.

use crate::loops::equation::rotations::{Rotation, cross};
use crate::number::Number;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// The first coefficients of a series.
#[derive(Clone, Copy, Debug)]
pub(super) struct Series<N, const TERMS: usize>(pub [N; TERMS]);

/// A rotation with the series of its angular velocity, in the frame before it, by `B' = w x B`.
#[inline(always)]
pub(super) fn rotating<N: Number, const TERMS: usize>(
    now: &Rotation<N>,
    spin: &[[N; 3]],
) -> Rotation<Series<N, TERMS>> {
    let mut out = [[Series::splat(0.0); 3]; 3];
    for j in 0..3 {
        for i in 0..3 {
            out[i][j].0[0] = now[i][j];
        }
        for order in 1..=spin.len() {
            let part = N::splat(1.0 / order as f64);
            for a in 0..order {
                let column = [0, 1, 2].map(|i: usize| out[i][j].0[order - 1 - a]);
                let turned = cross(&spin[a], &column);
                for i in 0..3 {
                    out[i][j].0[order] = out[i][j].0[order].plus_product(turned[i], part);
                }
            }
        }
    }
    out
}

/// Term by term. Closures would not be compiled for the vector unit.
macro_rules! termwise {
    ($($operator:ident $name:ident $sign:tt),*) => { $(
        impl<N: Number, const TERMS: usize> $operator for Series<N, TERMS> {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                let mut out = self.0;
                for k in 0..TERMS {
                    out[k] = self.0[k] $sign other.0[k];
                }
                Self(out)
            }
        }
    )* };
}

termwise!(Add add +, Sub sub -);

impl<N: Number, const TERMS: usize> Neg for Series<N, TERMS> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::splat(0.0) - self
    }
}

impl<N: Number, const TERMS: usize> Mul for Series<N, TERMS> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self::splat(0.0).plus_product(self, other)
    }
}

impl<N: Number, const TERMS: usize> Div for Series<N, TERMS> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        // q d = n, order by order
        let inverse = N::splat(1.0) / other.0[0];
        let mut out = self.0;
        for k in 0..TERMS {
            for i in 0..k {
                out[k] = out[k].minus_product(out[i], other.0[k - i]);
            }
            out[k] = out[k] * inverse;
        }
        Self(out)
    }
}

impl<N: Number, const TERMS: usize> Number for Series<N, TERMS> {
    #[inline(always)]
    fn splat(x: f64) -> Self {
        let mut out = [N::splat(0.0); TERMS];
        out[0] = N::splat(x);
        Self(out)
    }

    #[inline(always)]
    fn plus_product(self, a: Self, b: Self) -> Self {
        let mut out = self.0;
        for k in 0..TERMS {
            for i in 0..=k {
                out[k] = out[k].plus_product(a.0[i], b.0[k - i]);
            }
        }
        Self(out)
    }

    #[inline(always)]
    fn minus_product(self, a: Self, b: Self) -> Self {
        let mut out = self.0;
        for k in 0..TERMS {
            for i in 0..=k {
                out[k] = out[k].minus_product(a.0[i], b.0[k - i]);
            }
        }
        Self(out)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        // r r = x, order by order
        let mut out = self.0;
        out[0] = self.0[0].sqrt();
        let half = N::splat(0.5) / out[0];
        for k in 1..TERMS {
            for i in 1..k {
                out[k] = out[k].minus_product(out[i], out[k - i]);
            }
            out[k] = out[k] * half;
        }
        Self(out)
    }

    #[inline(always)]
    fn if_greater(self, b: Self, yes: Self, no: Self) -> Self {
        let mut out = no.0;
        for k in 0..TERMS {
            out[k] = self.0[0].if_greater(b.0[0], yes.0[k], no.0[k]);
        }
        Self(out)
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let zero = N::splat(0.0);
        let (mut sine, mut cosine) = ([zero; TERMS], [zero; TERMS]);
        (sine[0], cosine[0]) = self.0[0].sin_cos();
        for k in 1..TERMS {
            for i in 1..=k {
                let part = self.0[i] * N::splat(i as f64 / k as f64);
                sine[k] = sine[k].plus_product(part, cosine[k - i]);
                cosine[k] = cosine[k].minus_product(part, sine[k - i]);
            }
        }
        (Self(sine), Self(cosine))
    }

    #[inline(always)]
    fn scaled(self, by: f64) -> Self {
        let mut out = self.0;
        for k in 0..TERMS {
            out[k] = out[k] * N::splat(by);
        }
        Self(out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::taylor::Taylor;

    #[test]
    fn a_series_of_plain_numbers_is_a_taylor_series() {
        let (a, b) = ([0.7, 0.3, -0.2, 0.5], [1.3, -0.4, 0.9, 0.2]);
        let same = |one: Series<f64, 4>, other: Taylor<4>| {
            for k in 0..4 {
                assert!((one.0[k] - other.0[k]).abs() < 1e-15, "{one:?} {other:?}");
            }
        };
        let (x, y, t, u) = (Series(a), Series(b), Taylor(a), Taylor(b));
        same(x * y, t * u);
        same(x / y, t / u);
        same(y.sqrt(), u.sqrt());
        same(x.sin_cos().0, t.sin_cos().0);
        same(x.sin_cos().1, t.sin_cos().1);
        same(x.minus_product(y, y), t - u * u);
        same(-x, -t);
        same(x.if_greater(y, x, y), u);
    }
}
