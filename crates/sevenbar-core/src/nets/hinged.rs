//! A link on one turn or slide, held by one row more, in closed form.
//!
//! While it turns, every row is a sum of a cosine, a sine and a constant of the angle; while it slides, a quadratic.
//!
//! Source: docs/theory_nets.md, (23).

use super::body_family::{Held, Holds};
use super::dual_quaternions::Triple;
use super::steps::Move;
use crate::number::Number;
use crate::rigid::{Pose, Vec3, add, dot, sub};
use std::f64::consts::{FRAC_PI_2, PI};

/// The values of a row are known to this part of the squares that they come from.
const ROUNDING: f64 = 1e-15;

/// Ways in which a row holds its link: by how much the step moves [rad, or length], and whether it may move by any amount.
pub(super) struct Ways {
    pub by: Vec<f64>,
    pub at_rest: bool,
}

/// A row of a link on one step where that moves it by nothing, and by a quarter and half a turn, or once the size back and on.
#[derive(Clone, Copy, Debug)]
pub(super) struct OnStep<N>(pub [N; 3]);

impl OnStep<f64> {
    /// Of a row whose numbers are those of a real member; `pose` is that of the link, lengths relative to the `size`, as the row has them.
    pub fn of(moves: Move, size: f64, pose: impl Fn(f64) -> Pose, row: &Held, member: &[Triple]) -> Self {
        let value = |by: f64| row.value(member, &pose(by));
        Self(
            if moves == Move::Slide {
                [0.0, -size, size]
            } else {
                [0.0, FRAC_PI_2, PI]
            }
            .map(value),
        )
    }
}

impl<N: Number> OnStep<N> {
    /// The row as `a x^2 + b x + c` while the step slides.
    pub fn quadratic(&self) -> [N; 3] {
        let Self([here, before, beyond]) = *self;
        [
            (beyond + before).scaled(0.5) - here,
            (beyond - before).scaled(0.5),
            here,
        ]
    }

    /// The row as `a cos q + b sin q + c` while the step turns.
    pub fn wave(&self) -> [N; 3] {
        let Self([here, quarter, half]) = *self;
        let constant = (here + half).scaled(0.5);
        [here - constant, quarter - constant, constant]
    }
}

/// By how much a step moves where a row of its link holds; `pose` is that of the link, lengths relative to the `size`, as the row has them.
pub(super) fn hinged(
    moves: Move,
    size: f64,
    pose: impl Fn(f64) -> Pose,
    row: &Held,
    member: &[Triple],
) -> Ways {
    let on_step = OnStep::of(moves, size, pose, row, member);
    let error = ROUNDING * row.squares(member);
    if moves == Move::Slide {
        let [square, line, here] = on_step.quadratic();
        let at_rest = [square, line, here].iter().all(|x| x.abs() < 8.0 * error);
        let by = if at_rest {
            vec![0.0]
        } else {
            roots(square, line, here, error)
        };
        return Ways { by: by.into_iter().map(|root| root * size).collect(), at_rest };
    }
    let [cosine, sine, constant] = on_step.wave();
    let reach = cosine.hypot(sine);
    let middle = sine.atan2(cosine);
    let at_rest = reach < 8.0 * error && constant.abs() < 8.0 * error;
    let by = if at_rest {
        vec![0.0]
    } else if constant.abs() > reach + 8.0 * error {
        Vec::new()
    } else {
        // the height is a product, so that it is zero where both are equal
        let height = ((reach - constant) * (reach + constant)).max(0.0).sqrt();
        let aside = height.atan2(-constant);
        if height > 0.0 {
            vec![middle + aside, middle - aside]
        } else {
            vec![middle + aside]
        }
    };
    Ways { by, at_rest }
}

/// The real roots of `a x^2 + b x + c`, whose numbers are known to an error.
fn roots(a: f64, b: f64, c: f64, error: f64) -> Vec<f64> {
    if a.abs() < 8.0 * error {
        return if b.abs() < 8.0 * error {
            Vec::new()
        } else {
            vec![-c / b]
        };
    }
    let left = b * b - 4.0 * a * c;
    if left < -8.0 * error * (a.abs() + b.abs() + c.abs()) {
        return Vec::new();
    }
    // without a difference of near numbers
    let sum = -0.5 * (b + left.max(0.0).sqrt().copysign(b));
    if left <= 0.0 || sum == 0.0 {
        return vec![-0.5 * b / a];
    }
    vec![sum / a, c / sum]
}

impl Held {
    /// The squares of the lengths of which a row of a real member is made.
    fn squares(&self, member: &[Triple]) -> f64 {
        let square = |v: usize| member[v].iter().map(|x| x.norm_sqr()).sum::<f64>();
        1.0 + square(self.known) + square(self.own)
    }

    /// The value of the row of a real member, where the link is.
    fn value(&self, member: &[Triple], pose: &Pose) -> f64 {
        let real = |v: usize| -> Vec3 { member[v].map(|x| x.re) };
        let (known, own) = (real(self.known), real(self.own));
        let [number, ..] = real(self.number);
        match self.holds {
            Holds::Rod => {
                let d = sub(add(pose.turn(own), pose.translation), known);
                dot(d, d) - dot(known, known) - dot(own, own) + number
            }
            Holds::Plane => dot(known, pose.carry(own)) + number,
            Holds::OwnPlane => dot(own, pose.turn_back(sub(known, pose.translation))) + number,
            Holds::Angle => dot(known, pose.turn(own)) + number,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_are_those_of_the_quadratic() {
        assert_eq!(roots(1.0, -3.0, 2.0, ROUNDING), [2.0, 1.0]);
        assert_eq!(roots(1.0, 2.0, 1.0, ROUNDING), [-1.0]);
        assert_eq!(roots(1.0, 2.0, 1.0 + ROUNDING, ROUNDING), [-1.0]);
        assert_eq!(roots(0.0, 2.0, 1.0, ROUNDING), [-0.5]);
        assert!(roots(1.0, 0.0, 1.0, ROUNDING).is_empty());
        let far = roots(1.0, 1e8, 1.0, ROUNDING);
        assert!(
            (far[1] + 1e-8).abs() < 1e-22 && (far[0] + 1e8).abs() < 1e-6,
            "{far:?}"
        );
    }
}
