//! Places and poses in a plane as complex numbers of whose parts each is a number of any kind.
//!
//! Source: docs/theory_nets.md, (7).

use crate::number::Number;
use num_complex::Complex64;

/// A place or a direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Complex<N> {
    pub re: N,
    pub im: N,
}

impl<N: Number> Complex<N> {
    /// One that is known.
    #[inline(always)]
    pub fn constant(z: Complex64) -> Self {
        Self { re: N::splat(z.re), im: N::splat(z.im) }
    }

    #[inline(always)]
    pub fn plus(self, b: Self) -> Self {
        Self { re: self.re + b.re, im: self.im + b.im }
    }

    #[inline(always)]
    pub fn minus(self, b: Self) -> Self {
        Self { re: self.re - b.re, im: self.im - b.im }
    }

    #[inline(always)]
    pub fn times(self, b: Self) -> Self {
        Self {
            re: (self.re * b.re).minus_product(self.im, b.im),
            im: (self.re * b.im).plus_product(self.im, b.re),
        }
    }

    /// The product with a number that is known.
    #[inline(always)]
    pub fn by(self, b: Complex64) -> Self {
        Self {
            re: self.re.scaled(b.re) - self.im.scaled(b.im),
            im: self.re.scaled(b.im) + self.im.scaled(b.re),
        }
    }

    /// The product with a real number.
    #[inline(always)]
    pub fn stretched(self, by: N) -> Self {
        Self { re: self.re * by, im: self.im * by }
    }

    /// The conjugate times another: their dot product, and how far it is turned to the left of this.
    #[inline(always)]
    pub fn towards(self, b: Self) -> Self {
        Self { re: self.dot(b), im: self.cross(b) }
    }

    #[inline(always)]
    pub fn dot(self, b: Self) -> N {
        (self.re * b.re).plus_product(self.im, b.im)
    }

    #[inline(always)]
    pub fn cross(self, b: Self) -> N {
        (self.re * b.im).minus_product(self.im, b.re)
    }
}

/// A pose `x -> z x + t` with `|z| = 1`.
#[derive(Clone, Copy, Debug)]
pub(super) struct InPlane<N> {
    pub z: Complex<N>,
    pub t: Complex<N>,
}

impl<N: Number> InPlane<N> {
    /// That of the ground.
    #[inline(always)]
    pub fn still() -> Self {
        Self {
            z: Complex::constant(Complex64::ONE),
            t: Complex::constant(Complex64::ZERO),
        }
    }

    /// The image of a place.
    #[inline(always)]
    pub fn carry(&self, x: Complex64) -> Complex<N> {
        self.z.by(x).plus(self.t)
    }

    /// The pose with this turn that takes a place to another.
    #[inline(always)]
    pub fn through(z: Complex<N>, from: Complex64, to: Complex<N>) -> Self {
        Self { z, t: to.minus(z.by(from)) }
    }

    /// The pose of what is shifted against it.
    #[inline(always)]
    pub fn shifted(&self, by: Complex<N>) -> Self {
        Self { z: self.z, t: self.t.plus(by) }
    }
}
