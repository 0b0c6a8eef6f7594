//! Rows of chords: each is a distance, a place or an angle between two links.
//!
//! `x` is a place, `u` and `v` are directions, all as drawn, where both links' frames are the ground's; `d = x_a - x_b` is how far the place on one
//! link has gone from that on the other. Every joint is made of the last two: what it does not let turn is an `Angle`, what it does not let slide an
//! `Along`. A row's gradient is a wrench on each link: its power on a column's screw is the entry of `A`.
//!
//! Source: docs/theory_nets.md, (4).

use super::steps::{Placement, Screw};
use crate::loops::equation::rotations::{cross, dot3};
use crate::number::Number;
use crate::rigid::{Vec3, scale};

/// A step whose link a row is on; `None` is the ground.
pub type On = Option<usize>;

/// An equation between two links.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Row {
    /// Of a rod: `(d . d - L^2) / (2 L)` with d between two different places.
    Length {
        /// The links.
        on: [On; 2],
        /// The places on them, as drawn.
        at: [Vec3; 2],
        /// L
        length: f64,
    },
    /// `d . v_b`: the place does not go this way, which the second link holds.
    Along {
        /// The links.
        on: [On; 2],
        /// The place, as drawn.
        at: Vec3,
        /// The direction, of length 1.
        v: Vec3,
    },
    /// `u_a . v_b - c`
    Angle {
        /// The links.
        on: [On; 2],
        /// The direction that the first link holds, of length 1.
        u: Vec3,
        /// That of the second.
        v: Vec3,
        /// The cosine of the angle between them.
        cosine: f64,
    },
}

/// A force and its moment about the origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wrench<N> {
    moment: [N; 3],
    force: [N; 3],
}

impl<N: Number> Wrench<N> {
    #[inline]
    fn at(force: [N; 3], place: &[N; 3]) -> Self {
        Self { moment: cross(place, &force), force }
    }

    #[inline]
    fn turned_round(mut self) -> Self {
        for k in 0..3 {
            self.moment[k] = -self.moment[k];
            self.force[k] = -self.force[k];
        }
        self
    }

    #[inline]
    pub fn power(&self, screw: &Screw<N>) -> N {
        dot3(&self.moment, &screw.turn) + dot3(&self.force, &screw.shift)
    }
}

impl Row {
    /// The links that it is on.
    pub fn on(&self) -> [On; 2] {
        match *self {
            Self::Length { on, .. } | Self::Along { on, .. } | Self::Angle { on, .. } => on,
        }
    }

    /// Its value [length, or none], and its gradient as a wrench on each of the two links.
    #[inline]
    pub(super) fn evaluated<N: Number>(&self, a: &Placement<N>, b: &Placement<N>) -> (N, [Wrench<N>; 2]) {
        match self {
            Self::Length { at, length, .. } => {
                let (p, q) = (a.carry(&at[0]), b.carry(&at[1]));
                let d = difference(&p, &q);
                let mut force = d;
                for x in &mut force {
                    *x = *x * N::splat(1.0 / length);
                }
                let value = (dot3(&d, &d) - N::splat(length * length)) * N::splat(0.5 / length);
                (
                    value,
                    [Wrench::at(force, &p), Wrench::at(force, &q).turned_round()],
                )
            }
            Self::Along { at, v, .. } => {
                let (p, q, v) = (a.carry(at), b.carry(at), b.turn(v));
                let d = difference(&p, &q);
                // the direction turns with the second link, about which d then swings
                let mut back = Wrench::at(v, &q).turned_round();
                let swung = cross(&v, &d);
                for k in 0..3 {
                    back.moment[k] = back.moment[k] + swung[k];
                }
                (dot3(&d, &v), [Wrench::at(v, &p), back])
            }
            Self::Angle { u, v, cosine, .. } => {
                let (u, v) = (a.turn(u), b.turn(v));
                let couple = Wrench { moment: cross(&u, &v), force: [N::splat(0.0); 3] };
                (dot3(&u, &v) - N::splat(*cosine), [couple, couple.turned_round()])
            }
        }
    }

    /// Whether it is a length, of which its value is a part of the size.
    pub(super) fn is_length(&self) -> bool {
        !matches!(self, Self::Angle { .. })
    }

    /// The same with lengths relative to a size.
    pub(super) fn relative(&self, size: f64) -> Self {
        let small = |x: Vec3| scale(x, 1.0 / size);
        match *self {
            Self::Length { on, at, length } => Self::Length { on, at: at.map(small), length: length / size },
            Self::Along { on, at, v } => Self::Along { on, at: small(at), v },
            Self::Angle { .. } => *self,
        }
    }
}

#[inline]
fn difference<N: Number>(a: &[N; 3], b: &[N; 3]) -> [N; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}
