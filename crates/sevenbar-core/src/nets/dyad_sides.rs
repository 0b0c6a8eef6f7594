//! A dyad put together on one of its two sides, by numbers of any kind.
//!
//! No closures: they would not be compiled for the vector unit.
//!
//! Source: docs/theory_nets.md, (14) and (15).

use super::dyads::{Pair, Plane};
use super::in_plane::{Complex, InPlane};
use super::joints::TERMS;
use super::modes::Stage;
use super::net::MOST_COLUMNS;
use super::rows::On;
use crate::number::Number;
use num_complex::Complex64;

/// Poses in the plane of what every step moves.
pub(super) type Poses<N> = [InPlane<N>; MOST_COLUMNS];

/// A row of numbers of any kind.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found<M> {
    /// The columns [rad, or relative to the size].
    pub values: [M; MOST_COLUMNS],
    /// Series of the rates.
    pub rates: [[M; MOST_COLUMNS]; TERMS - 1],
    /// The closure error.
    pub residual: M,
    /// The condition number of `A` with the input's row.
    pub condition: M,
    /// The least sine of a dyad, to the side of its sign.
    pub sine: M,
}

impl<M: Number> Found<M> {
    /// What is known of none.
    #[inline(always)]
    pub fn nothing() -> Self {
        let zero = M::splat(0.0);
        Self {
            values: [zero; MOST_COLUMNS],
            rates: [[zero; MOST_COLUMNS]; TERMS - 1],
            residual: zero,
            condition: zero,
            sine: M::splat(1.0),
        }
    }
}

/// The pose of what a step moves, of the ground where there is none.
#[inline(always)]
pub(super) fn on<N: Number>(poses: &Poses<N>, step: On) -> InPlane<N> {
    match step {
        Some(k) => poses[k],
        None => InPlane::still(),
    }
}

/// A link from one hinge to another.
#[derive(Clone, Copy, Debug)]
struct Arm {
    vector: Complex64,
    inverse: Complex64,
    length: f64,
}

impl Arm {
    fn new(vector: Complex64) -> Self {
        Self { vector, inverse: vector.inv(), length: vector.norm() }
    }
}

/// A dyad by its joints as drawn, the hinge on a known link first.
#[derive(Clone, Copy, Debug)]
enum Shape {
    /// Hinges at p and q on the known links, and the links from them to the hinge between.
    Hinges { p: Complex64, q: Complex64, arms: [Arm; 2] },
    /// A hinge at p, the link from it to a hinge at c, which slides along s.
    HingesAndSlide { p: Complex64, c: Complex64, s: Complex64, arm: Arm },
    /// Hinges at p and q, and a slide along s between.
    SlideBetween { p: Complex64, s: Complex64, q: Complex64 },
    /// Slides along r and s, and a hinge at c between.
    TwoSlides { r: Complex64, c: Complex64, s: Complex64 },
    /// A hinge at p, a slide along s, one along r.
    SlidesInARow { p: Complex64, s: Complex64, r: Complex64 },
}

/// A dyad with the steps of its links and of those at which it hangs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Joined {
    shape: Shape,
    /// Its links.
    pub links: [usize; 2],
    /// The known links.
    pub known: [On; 2],
}

impl Joined {
    /// Of lengths relative to a size.
    pub fn of(stage: &Stage, plane: &Plane, size: f64) -> Self {
        let place = |pair: Pair| match pair {
            Pair::Hinge(at) => Ok(plane.place(at) / size),
            Pair::Slide(along) => Err(plane.place(along)),
        };
        let slide = |p: Complex64, c: Complex64, s| Shape::HingesAndSlide { p, c, s, arm: Arm::new(c - p) };
        let (shape, order) = match stage.dyad.pairs.map(place) {
            [Ok(p), Ok(c), Ok(q)] => {
                let arms = [Arm::new(c - p), Arm::new(c - q)];
                (Shape::Hinges { p, q, arms }, [0, 1])
            }
            [Ok(p), Ok(c), Err(s)] => (slide(p, c, s), [0, 1]),
            [Err(s), Ok(c), Ok(q)] => (slide(q, c, s), [1, 0]),
            [Ok(p), Err(s), Ok(q)] => (Shape::SlideBetween { p, s, q }, [0, 1]),
            [Err(r), Ok(c), Err(s)] => (Shape::TwoSlides { r, c, s }, [0, 1]),
            [Ok(p), Err(s), Err(r)] => (Shape::SlidesInARow { p, s, r }, [0, 1]),
            [Err(r), Err(s), Ok(q)] => (Shape::SlidesInARow { p: q, s, r }, [1, 0]),
            // turns nothing, and is on no side
            [Err(r), Err(_), Err(_)] => (Shape::TwoSlides { r, c: r, s: r }, [0, 1]),
        };
        Self {
            shape,
            links: order.map(|k| stage.links[k]),
            known: order.map(|k| stage.known[k]),
        }
    }

    /// How far it is from its dead centre, as a part of its lengths; the sign is that of the side on which it lies.
    #[inline(always)]
    pub fn sine<N: Number>(&self, poses: &Poses<N>) -> N {
        let (a, b) = (poses[self.links[0]], poses[self.links[1]]);
        match self.shape {
            Shape::Hinges { arms: [one, two], .. } => {
                let size = 1.0 / (one.length * two.length);
                a.z.by(one.vector).cross(b.z.by(two.vector)).scaled(size)
            }
            Shape::HingesAndSlide { s, arm, .. } => {
                a.z.by(arm.vector).dot(b.z.by(s)).scaled(1.0 / arm.length)
            }
            Shape::SlideBetween { p, s, q } => {
                let line = b.carry(q).minus(a.carry(p));
                let size = (line.dot(line) + N::splat((q - p).norm_sqr())).sqrt();
                a.z.by(s).dot(line) / size
            }
            Shape::TwoSlides { r, s, .. } => a.z.by(r).cross(b.z.by(s)),
            Shape::SlidesInARow { s, r, .. } => a.z.by(s).cross(b.z.by(r)),
        }
    }

    /// Whether there is but one way to put it together.
    pub fn is_single(&self) -> bool {
        matches!(self.shape, Shape::TwoSlides { .. } | Shape::SlidesInARow { .. })
    }

    /// The radicand of its root, as the square of the sine of the angle between its links where it has two, and the denominator of its links'
    /// turns and shifts, where the known links are.
    pub fn radicand<N: Number>(&self, poses: &Poses<N>) -> [N; 2] {
        let (first, second) = (on(poses, self.known[0]), on(poses, self.known[1]));
        let one = N::splat(1.0);
        match self.shape {
            Shape::Hinges { p, q, arms: [long, short] } => {
                let line = second.carry(q).minus(first.carry(p));
                let square = line.dot(line);
                let [long, short] = [long.length * long.length, short.length * short.length];
                let along = (square + N::splat(long - short)).scaled(0.5);
                let root = square.scaled(long).minus_product(along, along);
                [root.scaled((long * short).recip()), square]
            }
            Shape::HingesAndSlide { p, c, s, arm } => {
                let across = second.z.by(s).cross(first.carry(p).minus(second.carry(c)));
                let part = across.scaled(arm.length.recip());
                [one.minus_product(part, part), one]
            }
            Shape::SlideBetween { p, s, q } => {
                let line = second.carry(q).minus(first.carry(p));
                let off = ((q - p) * s.conj()).im;
                let square = line.dot(line);
                [square - N::splat(off * off), square]
            }
            Shape::TwoSlides { r, s, .. } => [one, first.z.by(r).cross(second.z.by(s))],
            Shape::SlidesInARow { .. } => [one, one],
        }
    }

    /// The poses of both links where the known links are, on a side.
    #[inline(always)]
    pub fn put<N: Number>(&self, poses: &Poses<N>, side: f64) -> [InPlane<N>; 2] {
        let (first, second) = (on(poses, self.known[0]), on(poses, self.known[1]));
        match self.shape {
            Shape::Hinges { p, q, arms: [one, two] } => {
                let (a, b) = (first.carry(p), second.carry(q));
                let [long, short] = [one.length * one.length, two.length * two.length];
                let line = b.minus(a);
                let inverse = N::splat(1.0) / line.dot(line);
                let re = inverse.scaled(0.5 * (long - short)) + N::splat(0.5);
                let im = inverse.scaled(long).minus_product(re, re).sqrt().scaled(side);
                let arm = line.times(Complex { re, im });
                let back = arm.minus(line);
                let (z, w) = (arm.by(one.inverse), back.by(two.inverse));
                [InPlane::through(z, p, a), InPlane::through(w, q, b)]
            }
            Shape::HingesAndSlide { p, c, s, arm } => {
                let (a, start) = (first.carry(p), second.carry(c));
                let direction = second.z.by(s);
                let local = direction.towards(a.minus(start));
                let half = N::splat(arm.length * arm.length)
                    .minus_product(local.im, local.im)
                    .sqrt()
                    .scaled(side);
                let shift = direction.stretched(local.re + half);
                let z = start.plus(shift).minus(a).by(arm.inverse);
                [InPlane::through(z, p, a), second.shifted(shift)]
            }
            Shape::SlideBetween { p, s, q } => {
                let (a, b) = (first.carry(p), second.carry(q));
                let line = b.minus(a);
                let square = line.dot(line);
                let off = ((q - p) * s.conj()).im;
                let re = (square - N::splat(off * off)).sqrt().scaled(side);
                let reach = Complex { re, im: N::splat(off) }.by(s);
                let z = reach.towards(line).stretched(N::splat(1.0) / square);
                [InPlane::through(z, p, a), InPlane::through(z, q, b)]
            }
            Shape::TwoSlides { r, c, s } => {
                let (one, two) = (first.z.by(r), second.z.by(s));
                let off = second.carry(c).minus(first.carry(c));
                let inverse = N::splat(1.0) / one.cross(two);
                let (u, v) = (off.cross(two) * inverse, off.cross(one) * inverse);
                [first.shifted(one.stretched(u)), second.shifted(two.stretched(v))]
            }
            Shape::SlidesInARow { p, s, r } => {
                let near = InPlane::through(second.z, p, first.carry(p));
                let (one, two) = (second.z.by(s), second.z.by(r));
                let off = second.t.minus(near.t);
                let v = off.cross(one).scaled(1.0 / (s.conj() * r).im);
                [near, second.shifted(two.stretched(v))]
            }
        }
    }
}
