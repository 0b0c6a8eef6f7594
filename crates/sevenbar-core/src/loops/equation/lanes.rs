//! Eight complex numbers side by side.

use crate::vectors::{Reals, Vector};
use num_complex::Complex64;
use std::ops::{Add, Mul, Neg, Sub};

/// One complex number for each lane.
#[derive(Clone, Copy)]
pub(crate) struct Lanes<V> {
    pub re: V,
    pub im: V,
}

impl<V: Vector> Lanes<V> {
    #[inline(always)]
    pub fn splat(value: Complex64) -> Self {
        Self { re: V::splat(value.re), im: V::splat(value.im) }
    }

    #[inline(always)]
    pub fn zero() -> Self {
        Self::splat(Complex64::ZERO)
    }

    #[inline(always)]
    pub fn one() -> Self {
        Self::splat(Complex64::ONE)
    }

    #[inline(always)]
    pub fn load(re: &Reals, im: &Reals) -> Self {
        Self { re: V::load(re), im: V::load(im) }
    }

    /// `self + other factor` with a real factor in each lane.
    #[inline(always)]
    pub fn plus_scaled(self, other: Self, factor: V) -> Self {
        Self {
            re: self.re.plus_product(other.re, factor),
            im: self.im.plus_product(other.im, factor),
        }
    }

    #[inline(always)]
    pub fn scale(self, factor: V) -> Self {
        Self { re: self.re * factor, im: self.im * factor }
    }

    /// `self + a b`
    #[inline(always)]
    pub fn plus_product(self, a: Self, b: Self) -> Self {
        Self {
            re: self.re.plus_product(a.re, b.re).minus_product(a.im, b.im),
            im: self.im.plus_product(a.re, b.im).plus_product(a.im, b.re),
        }
    }

    /// `self - a b`
    #[inline(always)]
    pub fn minus_product(self, a: Self, b: Self) -> Self {
        Self {
            re: self.re.minus_product(a.re, b.re).plus_product(a.im, b.im),
            im: self.im.minus_product(a.re, b.im).minus_product(a.im, b.re),
        }
    }

    /// `|z|^2` in each lane
    #[inline(always)]
    pub fn square(&self) -> V {
        (self.re * self.re).plus_product(self.im, self.im)
    }

    #[inline(always)]
    pub fn recip(self) -> Self {
        let inverse = V::splat(1.0) / self.square();
        Self {
            re: self.re * inverse,
            im: V::splat(0.0).minus_product(self.im, inverse),
        }
    }

    /// `i z`
    #[inline(always)]
    pub fn times_i(self) -> Self {
        Self { re: -self.im, im: self.re }
    }

    /// `e^(i z)`, to rounding while `|z|` is below a half: the diagonal Pade approximant of order three.
    #[inline(always)]
    pub fn turn(self) -> Self {
        let x = self.times_i();
        let square = x * x;
        let twelve = V::splat(12.0);
        let even = Self {
            re: V::splat(120.0).plus_product(twelve, square.re),
            im: twelve * square.im,
        };
        let odd = Self { re: V::splat(60.0) + square.re, im: square.im } * x;
        (even + odd) * (even - odd).recip()
    }

    /// `other` in the lanes where `size > limit`, else `self`.
    #[inline(always)]
    pub fn replaced_where(self, size: V, limit: V, other: Self) -> Self {
        Self {
            re: size.if_greater(limit, other.re, self.re),
            im: size.if_greater(limit, other.im, self.im),
        }
    }
}

impl<V: Vector> Add for Lanes<V> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { re: self.re + other.re, im: self.im + other.im }
    }
}

impl<V: Vector> Sub for Lanes<V> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { re: self.re - other.re, im: self.im - other.im }
    }
}

impl<V: Vector> Neg for Lanes<V> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::zero() - self
    }
}

impl<V: Vector> Mul for Lanes<V> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        Self {
            re: (self.re * b.re).minus_product(self.im, b.im),
            im: (self.re * b.im).plus_product(self.im, b.re),
        }
    }
}
