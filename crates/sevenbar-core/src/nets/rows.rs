//! Rows of chords: each is a distance, a place or an angle between two links.
//!
//! `x` is a place, `u` and `v` are directions, all as drawn, where both links' frames are the ground's; `d = x_a - x_b` is how far the place on one
//! link has gone from that on the other. Every joint is made of the last two: what it does not let turn is an `Angle`, what it does not let slide an
//! `Along`. A row's gradient is a wrench on each link: its power on a column's screw is the entry of `A`.
//!
//! Source: docs/theory_nets.md, (4).

use super::steps::Screw;
use crate::rigid::{Pose, Vec3, add, cross, dot, scale, sub};

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
pub(super) struct Wrench {
    moment: Vec3,
    force: Vec3,
}

impl Wrench {
    fn at(force: Vec3, place: Vec3) -> Self {
        Self { moment: cross(place, force), force }
    }

    fn turned_round(self) -> Self {
        Self { moment: scale(self.moment, -1.0), force: scale(self.force, -1.0) }
    }

    pub fn power(&self, screw: &Screw) -> f64 {
        dot(self.moment, screw.turn) + dot(self.force, screw.shift)
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
    pub(super) fn evaluated(&self, a: &Pose, b: &Pose) -> (f64, [Wrench; 2]) {
        match *self {
            Self::Length { at, length, .. } => {
                let (p, q) = (a.carry(at[0]), b.carry(at[1]));
                let d = sub(p, q);
                let force = scale(d, 1.0 / length);
                let value = (dot(d, d) - length * length) / (2.0 * length);
                (value, [Wrench::at(force, p), Wrench::at(force, q).turned_round()])
            }
            Self::Along { at, v, .. } => {
                let (p, q, v) = (a.carry(at), b.carry(at), b.turn(v));
                let d = sub(p, q);
                // the direction turns with the second link, about which d then swings
                let back = Wrench::at(scale(v, -1.0), q);
                let swung = Wrench { moment: add(back.moment, cross(v, d)), force: back.force };
                (dot(d, v), [Wrench::at(v, p), swung])
            }
            Self::Angle { u, v, cosine, .. } => {
                let (u, v) = (a.turn(u), b.turn(v));
                let couple = Wrench { moment: cross(u, v), force: [0.0; 3] };
                let back = Wrench { moment: cross(v, u), force: [0.0; 3] };
                (dot(u, v) - cosine, [couple, back])
            }
        }
    }

    /// Whether it is a length, of which its value is a part of the size.
    pub(super) fn is_length(&self) -> bool {
        !matches!(self, Self::Angle { .. })
    }
}
