//! Truncated Taylor arithmetic: a value and its derivatives carried together, exactly.
//!
//! `Taylor([x0, x1, x2, ..])` stands for `x(t + h) = x0 + x1 h + x2 h^2 + ..`; the k-th derivative is
//! `k! xk`. Every operation is the exact rule for the truncated series, so no step size appears anywhere.

use crate::number::Number;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A power series cut off after `N` coefficients (derivatives up to order `N - 1`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taylor<const N: usize>(pub [f64; N]);

impl<const N: usize> Taylor<N> {
    /// A value that does not change.
    pub const fn constant(value: f64) -> Self {
        let mut c = [0.0; N];
        c[0] = value;
        Self(c)
    }

    /// A value with first derivative one: the independent variable itself.
    pub const fn variable(value: f64) -> Self {
        let mut c = [0.0; N];
        c[0] = value;
        if N > 1 {
            c[1] = 1.0;
        }
        Self(c)
    }

    /// From the derivatives `x, x', x'', ..`; those past `N` are left out, missing ones are zero.
    pub fn from_derivatives(derivatives: &[f64]) -> Self {
        let mut c = [0.0; N];
        let mut factorial = 1.0;
        for (k, (slot, d)) in c.iter_mut().zip(derivatives).enumerate() {
            if k > 0 {
                factorial *= k as f64;
            }
            *slot = d / factorial;
        }
        Self(c)
    }

    /// The k-th derivative.
    pub fn derivative(&self, k: usize) -> f64 {
        (1..=k).fold(self.0[k], |value, i| value * i as f64)
    }

    /// The value itself.
    pub const fn value(&self) -> f64 {
        self.0[0]
    }

    /// The product with a plain number.
    pub fn scale(self, factor: f64) -> Self {
        Self(self.0.map(|c| c * factor))
    }

    /// The reciprocal; the value must not be zero.
    pub fn recip(self) -> Self {
        let a = self.0;
        let mut r = [0.0; N];
        r[0] = 1.0 / a[0];
        for k in 1..N {
            let sum: f64 = (1..=k).map(|i| a[i] * r[k - i]).sum();
            r[k] = -sum * r[0];
        }
        Self(r)
    }

    /// The square root; the value must be positive.
    pub fn sqrt(self) -> Self {
        let a = self.0;
        let mut r = [0.0; N];
        r[0] = a[0].sqrt();
        for k in 1..N {
            let sum: f64 = (1..k).map(|i| r[i] * r[k - i]).sum();
            r[k] = (a[k] - sum) / (2.0 * r[0]);
        }
        Self(r)
    }

    /// Sine and cosine together.
    pub fn sin_cos(self) -> (Self, Self) {
        let (mut s, mut c) = ([0.0; N], [0.0; N]);
        (s[0], c[0]) = self.0[0].sin_cos();
        for k in 1..N {
            (s[k], c[k]) = sin_cos_coefficient(&self.0, &s, &c, k);
        }
        (Self(s), Self(c))
    }

    /// The angle of the vector `(x, y)`, from `angle' = (x y' - y x') / (x^2 + y^2)`.
    pub fn atan2(y: Self, x: Self) -> Self {
        let norm = (x * x + y * y).0;
        let mut a = [0.0; N];
        a[0] = y.0[0].atan2(x.0[0]);
        for k in 1..N {
            let mut sum = 0.0;
            for i in 1..=k {
                sum += i as f64 * (x.0[k - i] * y.0[i] - y.0[k - i] * x.0[i]);
            }
            for i in 1..k {
                sum -= i as f64 * a[i] * norm[k - i];
            }
            a[k] = sum / (k as f64 * norm[0]);
        }
        Self(a)
    }
}

/// The k-th coefficients of sine and cosine of `a`, given those below `k`.
pub(crate) fn sin_cos_coefficient<const N: usize>(
    a: &[f64; N],
    sine: &[f64; N],
    cosine: &[f64; N],
    k: usize,
) -> (f64, f64) {
    let (mut s, mut c) = (0.0, 0.0);
    for i in 1..=k {
        s += i as f64 * a[i] * cosine[k - i];
        c -= i as f64 * a[i] * sine[k - i];
    }
    (s / k as f64, c / k as f64)
}

impl<const N: usize> Add for Taylor<N> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] + other.0[k]))
    }
}

impl<const N: usize> Sub for Taylor<N> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] - other.0[k]))
    }
}

impl<const N: usize> Neg for Taylor<N> {
    type Output = Self;
    fn neg(self) -> Self {
        self.scale(-1.0)
    }
}

impl<const N: usize> Mul for Taylor<N> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| {
            (0..=k).map(|i| self.0[i] * other.0[k - i]).sum()
        }))
    }
}

impl<const N: usize> Div for Taylor<N> {
    type Output = Self;
    #[expect(clippy::suspicious_arithmetic_impl)]
    fn div(self, other: Self) -> Self {
        self * other.recip()
    }
}

impl<const N: usize> Number for Taylor<N> {
    fn splat(x: f64) -> Self {
        Self::constant(x)
    }

    fn plus_product(self, a: Self, b: Self) -> Self {
        self + a * b
    }

    fn minus_product(self, a: Self, b: Self) -> Self {
        self - a * b
    }

    fn sqrt(self) -> Self {
        self.sqrt()
    }

    fn if_greater(self, b: Self, yes: Self, no: Self) -> Self {
        if self.value() > b.value() { yes } else { no }
    }

    fn sin_cos(self) -> (Self, Self) {
        self.sin_cos()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: Taylor<6>, b: Taylor<6>) {
        for k in 0..6 {
            assert!((a.0[k] - b.0[k]).abs() < 1e-13, "{a:?} {b:?}");
        }
    }

    #[test]
    fn sine_and_cosine_keep_pythagoras_to_every_order() {
        let x = Taylor([0.7, 0.3, -0.2, 0.5, 0.1, -0.4]);
        let (s, c) = x.sin_cos();
        close(s * s + c * c, Taylor::constant(1.0));
    }

    #[test]
    fn the_angle_of_sine_and_cosine_is_the_angle() {
        let x = Taylor([2.9, 0.3, -0.2, 0.5, 0.1, -0.4]);
        let (s, c) = x.sin_cos();
        close(Taylor::atan2(s.scale(3.0), c.scale(3.0)), x);
    }

    #[test]
    fn roots_and_reciprocals_undo_products() {
        let x = Taylor([1.7, 0.3, -0.2, 0.5, 0.1, -0.4]);
        close((x * x).sqrt(), x);
        close(x * x.recip(), Taylor::constant(1.0));
    }

    #[test]
    fn derivatives_of_a_cubic() {
        let t = Taylor::<6>::variable(2.0);
        let cube = t * t * t;
        let want = [8.0, 12.0, 12.0, 6.0, 0.0, 0.0];
        for (k, w) in want.iter().enumerate() {
            assert_eq!(cube.derivative(k), *w);
        }
        assert_eq!(Taylor::<6>::from_derivatives(&want), cube);
    }
}
