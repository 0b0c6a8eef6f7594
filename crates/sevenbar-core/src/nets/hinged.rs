//! A link on one turn or slide, held by one row more, in closed form.
//!
//! While it turns, every row is a sum of a cosine, a sine and a constant of the angle; while it slides, a quadratic.
//!
//! Source: docs/theory_nets.md, (23).

use super::body_family::{Held, Holds, Triple};
use super::net::Net;
use super::steps::Move;
use crate::rigid::{Pose, Vec3, add, dot, scale, sub};
use std::f64::consts::{FRAC_PI_2, PI};

/// A square that is below zero by less than this part of those that it comes from is zero.
const ROUNDING: f64 = 1e-14;

/// A row that changes by less than this part of its greatest does not hold the link.
const RESTS: f64 = 1e-12;

/// By how much a step moves [rad, or length] where a row of its link holds, in each way; lengths of the row are relative to the size.
pub(super) fn hinged(net: &Net, step: usize, base: &Pose, row: &Held, member: &[Triple]) -> Vec<f64> {
    let unit = 1.0 / net.size;
    let value = |by: f64| {
        let pose = base.then(&net.moving_by(step, by));
        let pose = Pose { translation: scale(pose.translation, unit), ..pose };
        row.value(member, &pose)
    };
    if net.steps[step].moves == Move::Slide {
        let [before, here, beyond] = [-net.size, 0.0, net.size].map(value);
        let (square, line) = (0.5 * (beyond + before) - here, 0.5 * (beyond - before));
        return roots(square, line, here)
            .into_iter()
            .map(|root| root * net.size)
            .collect();
    }
    let [here, quarter, half] = [0.0, FRAC_PI_2, PI].map(value);
    let constant = 0.5 * (here + half);
    let (cosine, sine) = (here - constant, quarter - constant);
    let squares = cosine * cosine + sine * sine;
    let left = squares - constant * constant;
    if left < -ROUNDING * (squares + constant * constant) || squares.sqrt() < RESTS {
        return Vec::new();
    }
    let aside = left.max(0.0).sqrt().atan2(-constant);
    let middle = sine.atan2(cosine);
    if left > 0.0 {
        vec![middle + aside, middle - aside]
    } else {
        vec![middle + aside]
    }
}

/// The real roots of `a x^2 + b x + c`.
fn roots(a: f64, b: f64, c: f64) -> Vec<f64> {
    if a.abs() < RESTS * b.abs() {
        return vec![-c / b];
    }
    let left = b * b - 4.0 * a * c;
    if left < -ROUNDING * (b * b + (4.0 * a * c).abs()) || a == 0.0 {
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
        assert_eq!(roots(1.0, -3.0, 2.0), [2.0, 1.0]);
        assert_eq!(roots(1.0, 2.0, 1.0), [-1.0]);
        assert_eq!(roots(0.0, 2.0, 1.0), [-0.5]);
        assert!(roots(1.0, 0.0, 1.0).is_empty());
        let far = roots(1.0, 1e8, 1.0);
        assert!(
            (far[1] + 1e-8).abs() < 1e-22 && (far[0] + 1e8).abs() < 1e-6,
            "{far:?}"
        );
    }
}
