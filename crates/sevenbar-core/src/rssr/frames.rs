//! Where the links are: their frames with derivatives, points on them, and the turns of the two balls.
//!
//! The coupler may spin freely about the line of its balls. It is held by one rule: the direction of the coupler that
//! is nearest to the crank's axis with every joint at zero stays nearest to it.

use super::linkage::{Input, Rssr};
use crate::error::Error;
use crate::rigid::{
    Pose, Vec3, Vec3Taylor, cross, cross_taylor, dot, dot_taylor, most_perpendicular_axis, norm, scale,
    scale_taylor, still, sub, turns_zyx, unit,
};
use crate::taylor::Taylor;

/// Below this sine of the angle between coupler and crank axis the spin's rule names no direction.
const SPIN_UNDEFINED_SINE: f64 = 1e-8;

/// Columns of joint values: crank, three turns of ball A, three of ball B, rocker.
pub const JOINT_COLUMNS: usize = 8;

/// A moving frame: the images of the coordinate axes, and the origin.
#[derive(Clone, Copy)]
pub(super) struct Frame<const N: usize> {
    columns: [Vec3Taylor<N>; 3],
    origin: Vec3Taylor<N>,
}

impl<const N: usize> Frame<N> {
    fn from_pose(pose: &Pose) -> Self {
        Self {
            columns: std::array::from_fn(|j| still(pose.column(j))),
            origin: still(pose.translation),
        }
    }

    /// The image of a fixed direction.
    fn turn(&self, v: Vec3) -> Vec3Taylor<N> {
        std::array::from_fn(|i| {
            (0..3).fold(Taylor::constant(0.0), |sum, j| {
                sum + self.columns[j][i].scale(v[j])
            })
        })
    }

    /// The image of a fixed point.
    fn carry(&self, p: Vec3) -> Vec3Taylor<N> {
        let turned = self.turn(p);
        std::array::from_fn(|i| turned[i] + self.origin[i])
    }

    /// This frame followed by a fixed transform.
    fn then(&self, pose: &Pose) -> Self {
        Self {
            columns: std::array::from_fn(|j| self.turn(pose.column(j))),
            origin: self.carry(pose.translation),
        }
    }

    /// This frame turned about its own z.
    fn turned(&self, angle: Taylor<N>) -> Self {
        let (s, c) = angle.sin_cos();
        let [x, y, z] = self.columns;
        Self {
            columns: [
                std::array::from_fn(|i| x[i] * c + y[i] * s),
                std::array::from_fn(|i| y[i] * c - x[i] * s),
                z,
            ],
            origin: self.origin,
        }
    }

    /// The turns about z, y and x, one after the other, that lead from this frame to another.
    fn turns_to(&self, other: &Self) -> Option<[Taylor<N>; 3]> {
        turns_zyx(|i, j| dot_taylor(self.columns[i], other.columns[j]))
    }
}

impl Rssr {
    /// The frames of crank, coupler and rocker; the coupler's is `None` where its spin is undefined.
    fn frames<const N: usize>(
        &self,
        crank: Taylor<N>,
        rocker: Taylor<N>,
    ) -> (Frame<N>, Option<Frame<N>>, Frame<N>) {
        let first = Frame::from_pose(&self.base).turned(crank);
        let third = Frame::from_pose(&self.ground)
            .turned(-rocker)
            .then(&self.links[2].inverse());
        let a = first.carry(self.links[0].translation);
        let b = third.origin;
        let line: Vec3Taylor<N> = std::array::from_fn(|i| b[i] - a[i]);
        let x = scale_taylor(line, dot_taylor(line, line).sqrt().recip());
        let Some((y, z)) = spin_rule(x, still(self.crank.axis)) else {
            return (first, None, third);
        };
        let body = self.coupler_body();
        let columns = std::array::from_fn(|j| {
            std::array::from_fn(|i| x[i].scale(body[0][j]) + y[i].scale(body[1][j]) + z[i].scale(body[2][j]))
        });
        (first, Some(Frame { columns, origin: a }), third)
    }

    /// The x, y, z of the spin's rule, written in the coupler's own frame.
    fn coupler_body(&self) -> [Vec3; 3] {
        let x = unit(self.links[1].translation);
        let axis = self.links[0].turn_back([0.0, 0.0, 1.0]);
        let across = |v: Vec3| sub(v, scale(x, dot(v, x)));
        let z = if norm(across(axis)) > SPIN_UNDEFINED_SINE {
            unit(across(axis))
        } else {
            unit(across(most_perpendicular_axis(x)))
        };
        [x, cross(z, x), z]
    }

    /// All joint values with their derivatives, in loop order; the turns of a ball are NaN where they are undefined.
    pub(super) fn joints<const N: usize>(
        &self,
        crank: Taylor<N>,
        rocker: Taylor<N>,
    ) -> [Taylor<N>; JOINT_COLUMNS] {
        let (first, coupler, third) = self.frames(crank, rocker);
        let undefined = [Taylor([f64::NAN; N]); 3];
        let (ball_a, ball_b) = match coupler {
            None => (undefined, undefined),
            Some(second) => (
                first.then(&self.links[0]).turns_to(&second).unwrap_or(undefined),
                second.then(&self.links[1]).turns_to(&third).unwrap_or(undefined),
            ),
        };
        let [a1, a2, a3] = ball_a;
        let [b1, b2, b3] = ball_b;
        [crank, a1, a2, a3, b1, b2, b3, rocker]
    }

    /// A point of a link (1 crank, 2 coupler, 3 rocker, 4 ground) with its derivatives, in the report frame.
    ///
    /// `at` is given in the link's frame, whose origin is the joint it begins with; for the ground in the report frame.
    /// NaN for the coupler where its spin is undefined.
    ///
    /// # Errors
    /// [`Error::Range`] for a link that does not exist.
    pub fn point<const N: usize>(
        &self,
        link: usize,
        at: Vec3,
        crank: Taylor<N>,
        rocker: Taylor<N>,
    ) -> Result<Vec3Taylor<N>, Error> {
        let (first, second, third) = self.frames(crank, rocker);
        let inside = at.map(|x| x / self.unit);
        let moved = match link {
            1 => first.carry(inside),
            2 => second.map_or([Taylor([f64::NAN; N]); 3], |frame| frame.carry(inside)),
            3 => third.carry(inside),
            4 => still(inside),
            _ => return Err(Error::Range { what: "link", got: link, least: 1, greatest: 4 }),
        };
        Ok(moved.map(|x| x.scale(self.unit)))
    }

    /// `| |A - B| - L2 |` relative to [`Self::size`].
    pub fn residual(&self, crank: f64, rocker: f64) -> f64 {
        (norm(sub(self.crank.at(crank), self.rocker.at(rocker))) - self.coupler).abs()
    }

    /// The two angles in loop order, whichever is the input.
    pub(super) fn in_loop_order<T>(input: Input, driver: T, follower: T) -> (T, T) {
        match input {
            Input::Crank => (driver, follower),
            Input::Rocker => (follower, driver),
        }
    }
}

/// The two directions across `x`: z as near to `axis` as can be, and y = z x x.
fn spin_rule<const N: usize>(
    x: Vec3Taylor<N>,
    axis: Vec3Taylor<N>,
) -> Option<(Vec3Taylor<N>, Vec3Taylor<N>)> {
    let along = dot_taylor(axis, x);
    let across: Vec3Taylor<N> = std::array::from_fn(|i| axis[i] - x[i] * along);
    let square = dot_taylor(across, across);
    if square.value() < SPIN_UNDEFINED_SINE * SPIN_UNDEFINED_SINE {
        return None;
    }
    // once more, since rounding of the difference is along x too, and counts where the difference is small
    let rest = dot_taylor(across, x);
    let across: Vec3Taylor<N> = std::array::from_fn(|i| across[i] - x[i] * rest);
    let z = scale_taylor(across, dot_taylor(across, across).sqrt().recip());
    Some((cross_taylor(z, x), z))
}
