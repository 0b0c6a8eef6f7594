//! Places and poses in a plane as complex numbers of whose parts each is a number of any kind.
//!
//! Source: docs/theory_nets.md, (7).

use super::dyads::Plane;
use super::joints::TERMS;
use super::steps::Placement;
use crate::loops::equation::rotations::dot3;
use crate::number::Number;
use num_complex::Complex64;
use std::array::from_fn;

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

    /// That of a link that moves in a plane, lengths relative to a size.
    pub fn of(placement: &Placement<N>, plane: &Plane, size: f64) -> Self {
        let axes = plane.axes().map(|axis| axis.map(N::splat));
        let seen = |v: &[N; 3]| Complex { re: dot3(&axes[0], v), im: dot3(&axes[1], v) };
        let t = seen(&placement.translation).by((1.0 / size).into());
        Self { z: seen(&placement.turn(&plane.axes()[0])), t }
    }

    /// The same in space.
    pub fn in_space(&self, plane: &Plane, size: f64) -> Placement<N> {
        let axes = plane.axes().map(|axis| axis.map(N::splat));
        let [x, y, n] = &axes;
        let turned = |a: N, b: N| -> [N; 3] { from_fn(|k| a * x[k] + b * y[k]) };
        let images = [turned(self.z.re, self.z.im), turned(-self.z.im, self.z.re), *n];
        let entry = |i: usize, j: usize| {
            let [a, b, c]: [N; 3] = from_fn(|k| images[k][i] * axes[k][j]);
            a + b + c
        };
        Placement {
            rotation: from_fn(|i| from_fn(|j| entry(i, j))),
            translation: turned(self.t.re, self.t.im).map(|x| x.scaled(size)),
        }
    }

    /// The pose of what is shifted against it.
    #[inline(always)]
    pub fn shifted(&self, by: Complex<N>) -> Self {
        Self { z: self.z, t: self.t.plus(by) }
    }
}

/// How a link moves: its turn, the place of its pin with three derivatives, its angular velocity with two.
#[derive(Clone, Copy)]
pub(super) struct Moving<N> {
    pub z: Complex<N>,
    pin: [Complex<N>; TERMS],
    pub spin: [N; TERMS - 1],
    /// What takes a place on the link to its second and third derivative.
    bent: [Complex<N>; 2],
}

impl<N: Number> Moving<N> {
    #[inline(always)]
    pub fn new(z: Complex<N>, pin: [Complex<N>; TERMS], spin: [N; TERMS - 1]) -> Self {
        let [w, a, j] = spin;
        let square = w * w;
        let bent = [
            Complex { re: -square, im: a },
            Complex { re: (w * a).scaled(-3.0), im: j.minus_product(square, w) },
        ];
        Self { z, pin, spin, bent }
    }

    /// A place on the link, with three derivatives.
    #[inline(always)]
    pub fn carry(&self, off: Complex64) -> [Complex<N>; TERMS] {
        let r = self.z.by(off);
        let [place, first, second, third] = self.pin;
        let w = self.spin[0];
        [
            place.plus(r),
            Complex {
                re: first.re.minus_product(w, r.im),
                im: first.im.plus_product(w, r.re),
            },
            plus_product(second, self.bent[0], r),
            plus_product(third, self.bent[1], r),
        ]
    }
}

/// `a + b c`
#[inline(always)]
pub(super) fn plus_product<N: Number>(a: Complex<N>, b: Complex<N>, c: Complex<N>) -> Complex<N> {
    Complex {
        re: a.re.plus_product(b.re, c.re).minus_product(b.im, c.im),
        im: a.im.plus_product(b.re, c.im).plus_product(b.im, c.re),
    }
}

/// `a - b c`
#[inline(always)]
pub(super) fn minus_product<N: Number>(a: Complex<N>, b: Complex<N>, c: Complex<N>) -> Complex<N> {
    Complex {
        re: a.re.minus_product(b.re, c.re).plus_product(b.im, c.im),
        im: a.im.minus_product(b.re, c.im).minus_product(b.im, c.re),
    }
}
