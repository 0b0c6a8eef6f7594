//! The linkage: two circles and a coupler, in the report frame.

use crate::error::Error;
use crate::rigid::{Pose, Vec3, cross, norm, scale, sub};

/// Which of the two turning joints is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Input {
    /// The first joint of the loop; the other angle is `beta = f(alpha)`.
    Crank,
    /// The last joint of the loop; the other angle is `alpha = phi(beta)`.
    Rocker,
}

/// The circle on which a side link carries its ball.
#[derive(Clone, Copy, Debug)]
pub struct Circle {
    /// The foot of the ball on the axis.
    pub centre: Vec3,
    /// The length of the side link.
    pub radius: f64,
    /// The unit vector of the axis.
    pub axis: Vec3,
    /// The unit vector to the ball at angle zero.
    pub zero: Vec3,
    /// The unit vector to the ball at a quarter turn.
    pub quarter: Vec3,
}

impl Circle {
    pub(super) fn new(centre: Vec3, axis: Vec3, arm: Vec3) -> Self {
        let radius = norm(arm);
        let zero = arm.map(|x| x / radius);
        Self { centre, radius, axis, zero, quarter: cross(axis, zero) }
    }

    /// The ball at an angle.
    pub fn at(&self, angle: f64) -> Vec3 {
        let (s, c) = angle.sin_cos();
        std::array::from_fn(|i| self.centre[i] + self.radius * (c * self.zero[i] + s * self.quarter[i]))
    }
}

/// The greatest of some lengths, rounded down to a power of two; 1 where all are zero.
fn power_of_two(lengths: [f64; 4]) -> f64 {
    let greatest = lengths.into_iter().fold(0.0, f64::max);
    if greatest > 0.0 {
        greatest.log2().floor().exp2()
    } else {
        1.0
    }
}

/// A spatial four-bar of two turning joints and two balls, in units of `unit`.
///
/// Inside, lengths are divided by `unit`, a power of two near the greatest dimension: nothing overflows and no bit
/// is lost. Everything that leaves this module is in the caller's unit again.
#[derive(Clone, Copy, Debug)]
pub struct Rssr {
    pub(super) unit: f64,
    pub(super) crank: Circle,
    pub(super) rocker: Circle,
    pub(super) coupler: f64,
    /// The frame of joint 1 in the report frame.
    pub(super) base: Pose,
    /// The side of joint 4 that belongs to the ground, in the report frame.
    pub(super) ground: Pose,
    /// From each joint's frame to the next one's, for the three moving links.
    pub(super) links: [Pose; 3],
}

impl Rssr {
    /// From the closed loop `base Z(q1) G1 S G2 S G3 Z(q8) = ground`.
    ///
    /// `base` is the frame of joint 1 and `ground` that of the ground's side of joint 4, both in the report frame; `links` are
    /// the fixed transforms G of the three moving links.
    ///
    /// # Errors
    /// [`Error::NoLength`] where a ball lies on the axis it turns about or the two balls coincide;
    /// [`Error::NotFinite`].
    pub fn new(base: Pose, ground: Pose, links: [Pose; 3]) -> Result<Self, Error> {
        for (index, pose) in [base, ground].iter().chain(&links).enumerate() {
            let numbers = pose.rotation.iter().flatten().chain(&pose.translation);
            if let Some(&value) = numbers.into_iter().find(|x| !x.is_finite()) {
                return Err(Error::NotFinite { what: "transform", index, value });
            }
        }
        let to_b = links[2].inverse().translation;
        let to_a = links[0].translation;
        let unit = power_of_two([
            to_a[0].hypot(to_a[1]),
            to_b[0].hypot(to_b[1]),
            norm(links[1].translation),
            norm(sub(
                base.carry([0.0, 0.0, to_a[2]]),
                ground.carry([0.0, 0.0, to_b[2]]),
            )),
        ]);
        let shrink = |pose: Pose| Pose { translation: pose.translation.map(|x| x / unit), ..pose };
        let (base, ground, links) = (shrink(base), shrink(ground), links.map(shrink));
        let (to_a, to_b) = (to_a.map(|x| x / unit), to_b.map(|x| x / unit));

        let crank = Circle::new(
            base.carry([0.0, 0.0, to_a[2]]),
            base.column(2),
            base.turn([to_a[0], to_a[1], 0.0]),
        );
        // joint 4 turns the ground against the rocker, so the rocker turns about the axis reversed
        let rocker = Circle::new(
            ground.carry([0.0, 0.0, to_b[2]]),
            scale(ground.column(2), -1.0),
            ground.turn([to_b[0], to_b[1], 0.0]),
        );
        let coupler = norm(links[1].translation);
        for (index, length) in [crank.radius, coupler, rocker.radius].into_iter().enumerate() {
            // a link shorter than the rounding of the others has no direction
            if length.is_nan() || length <= f64::EPSILON {
                return Err(Error::NoLength { link: index + 1 });
            }
        }
        Ok(Self { unit, crank, rocker, coupler, base, links, ground })
    }

    /// From M, N, L1, L2, L3, D of the paper, whose axes are square: the crank about z at height N, the rocker about x at (M, D, 0).
    ///
    /// # Errors
    /// As of [`Rssr::new`].
    ///
    /// Source: Sun and Zhou, Figure 2.
    pub fn square(dimensions: [f64; 6]) -> Result<Self, Error> {
        Self::skew(dimensions, [1.0, 0.0])
    }

    /// The same with axes at any angle, given by its sine s and cosine c: the rocker turns about (s, 0, c) through (0, D, 0), M along it.
    ///
    /// # Errors
    /// As of [`Rssr::new`].
    pub fn skew([m, n, l1, l2, l3, d]: [f64; 6], [s, c]: [f64; 2]) -> Result<Self, Error> {
        let straight = Pose::STILL.rotation;
        // joint 4 turns the ground against the rocker, about the axis reversed; 0.0 - c, so that square axes have no -0.0
        let towards_rocker = [[0.0, 0.0 - c, -s], [-1.0, 0.0, 0.0], [0.0, s, 0.0 - c]];
        let half_turn = [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]];
        let pose = |rotation, translation| Pose { rotation, translation };
        Self::new(
            pose(straight, [0.0, 0.0, n]),
            pose(towards_rocker, [m * s, d, m * c]),
            [
                pose(straight, [l1, 0.0, 0.0]),
                pose(straight, [l2, 0.0, 0.0]),
                pose(half_turn, [l3, 0.0, 0.0]),
            ],
        )
    }

    /// The lengths of crank, coupler and rocker.
    pub fn lengths(&self) -> [f64; 3] {
        [self.crank.radius, self.coupler, self.rocker.radius].map(|x| x * self.unit)
    }

    /// The greatest dimension, rounded down to a power of two; residuals are given relative to it.
    pub fn size(&self) -> f64 {
        self.unit
    }
}
