//! Sums and products with their rounding errors kept: numbers of about 32 digits, for the few differences that cancel.

use std::ops::{Add, Mul, Sub};

/// `high + low`, where `low` is below half a unit in the last place of `high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Twofold {
    high: f64,
    low: f64,
}

impl Twofold {
    /// A plain number.
    pub(crate) const fn new(value: f64) -> Self {
        Self { high: value, low: 0.0 }
    }

    /// The product of two plain numbers, exactly.
    pub(crate) fn product(a: f64, b: f64) -> Self {
        let high = a * b;
        Self { high, low: a.mul_add(b, -high) }
    }

    /// The nearest plain number.
    pub(crate) fn value(self) -> f64 {
        self.high
    }

    /// The square root; zero for what is not positive.
    pub(crate) fn sqrt(self) -> Self {
        if self.high <= 0.0 {
            return Self::new(0.0);
        }
        let root = self.high.sqrt();
        let rest = self - Self::product(root, root);
        Self::normal(root, rest.high / (2.0 * root))
    }

    /// The sum of two plain numbers of which the first is not the smaller.
    fn normal(large: f64, small: f64) -> Self {
        let high = large + small;
        Self { high, low: small - (high - large) }
    }
}

impl Add for Twofold {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let high = self.high + other.high;
        let part = high - self.high;
        let low = (self.high - (high - part)) + (other.high - part);
        Self::normal(high, low + self.low + other.low)
    }
}

impl Sub for Twofold {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + Self { high: -other.high, low: -other.low }
    }
}

impl Mul for Twofold {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let Self { high, low } = Self::product(self.high, other.high);
        Self::normal(high, low + self.high * other.low + self.low * other.high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_difference_of_squares_keeps_the_digits_that_plain_numbers_lose() {
        // (1 + e)^2 - 1 = 2 e + e^2
        let e = 2.0_f64.powi(-40);
        let x = Twofold::new(1.0) + Twofold::new(e);
        let difference = x * x - Twofold::new(1.0);
        assert_eq!(difference.value(), 2.0 * e + e * e);
    }

    #[test]
    fn a_root_squared_comes_back() {
        let two = Twofold::new(2.0);
        let rest = two.sqrt() * two.sqrt() - two;
        assert!(rest.value().abs() < 1e-31);
    }
}
