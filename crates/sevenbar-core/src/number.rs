//! A number, or several side by side.

use num_complex::Complex64;
use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number, or several side by side: what the formulas of a loop are written in, once for both.
pub(crate) trait Number:
    Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The same number in each lane.
    fn splat(x: f64) -> Self;
    /// `self + a b`
    fn plus_product(self, a: Self, b: Self) -> Self;
    /// `self - a b`
    fn minus_product(self, a: Self, b: Self) -> Self;
    /// The square root.
    fn sqrt(self) -> Self;
    /// `yes` in the lanes where `self > b`, `no` in the others, and where either is not a number.
    fn if_greater(self, b: Self, yes: Self, no: Self) -> Self;
    /// Sine and cosine of an angle [rad].
    fn sin_cos(self) -> (Self, Self);
    /// The product with a plain number.
    #[inline(always)]
    fn scaled(self, by: f64) -> Self {
        self * Self::splat(by)
    }
    /// The lesser of two.
    #[inline(always)]
    fn lesser(self, b: Self) -> Self {
        self.if_greater(b, b, self)
    }
    /// The size of a number.
    #[inline(always)]
    fn size(self) -> Self {
        self.if_greater(Self::splat(0.0), self, -self)
    }
}

impl Number for f64 {
    #[inline(always)]
    fn splat(x: f64) -> Self {
        x
    }
    #[inline(always)]
    fn plus_product(self, a: Self, b: Self) -> Self {
        self + a * b
    }
    #[inline(always)]
    fn minus_product(self, a: Self, b: Self) -> Self {
        self - a * b
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }
    #[inline(always)]
    fn if_greater(self, b: Self, yes: Self, no: Self) -> Self {
        if self > b { yes } else { no }
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        self.sin_cos()
    }
}

/// What is written for numbers goes on to complex ones; it compares none.
impl Number for Complex64 {
    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self::new(x, 0.0)
    }
    #[inline(always)]
    fn plus_product(self, a: Self, b: Self) -> Self {
        self + a * b
    }
    #[inline(always)]
    fn minus_product(self, a: Self, b: Self) -> Self {
        self - a * b
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }
    #[inline(always)]
    fn if_greater(self, b: Self, yes: Self, no: Self) -> Self {
        if self.re > b.re { yes } else { no }
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let turn = (Self::I * self).exp();
        let back = turn.inv();
        ((turn - back) * Self::new(0.0, -0.5), (turn + back) * 0.5)
    }
}
