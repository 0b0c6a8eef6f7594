//! Whether a ball passes the other side's axis at the coupler's distance from its circle: that side is free there.
//!
//! All of `x, y, K` in docs/rssr.md, (3), vanish at such an input, so every output closes. The two solutions go through it with outputs of
//! their own, which only their rates tell, and the zero of the discriminant is no meeting of them.

use super::linkage::{Input, Rssr};
use super::pair::Pair;
use crate::trigonometric::TrigQuadratic;

/// A ball nearer to the axis than this [relative to the linkage's unit], and as near to the coupler's distance, leaves no output to be read
/// off: what is left is rounding.
const ON_AXIS: f64 = 1e-9;

/// Steps of Newton's method on all three at once.
const STEPS: usize = 4;

impl Rssr {
    /// Whether crank or rocker is free at some angle of the other.
    pub fn has_free_side(&self) -> bool {
        [Input::Crank, Input::Rocker]
            .iter()
            .any(|&input| self.pair(input).frees_follower())
    }
}

impl Pair {
    fn frees_follower(&self) -> bool {
        let height = TrigQuadratic::combine(1.0, &self.x.square(), 1.0, &self.y.square());
        let slope = height.derivative();
        let noise = 8.0 * f64::EPSILON * height.magnitude();
        // on an axis that both sides share the height is the same all round, and not zero
        let nearest = slope.zeros(noise).unwrap_or_default();
        nearest.iter().any(|zero| {
            let mut driver = zero.angle;
            for _ in 0..STEPS {
                let (s, c) = driver.sin_cos();
                let (mut along, mut square) = (0.0, 0.0);
                for f in [&self.x, &self.y, &self.k] {
                    let (value, rate) = (f.c0 + f.c1 * c + f.s1 * s, f.s1 * c - f.c1 * s);
                    along += value * rate;
                    square += rate * rate;
                }
                if square == 0.0 {
                    break;
                }
                driver -= along / square;
            }
            let reach = self.reach(driver);
            reach.height < ON_AXIS && reach.k.abs() < ON_AXIS
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ball_on_the_other_axis_at_the_couplers_distance_frees_that_side() {
        let free = |m, n, l1, l2, l3, d| Rssr::square([m, n, l1, l2, l3, d]).unwrap().has_free_side();
        // across the axis, along it, and touching it
        assert!(free(0.0, 0.0, 3.0, 5.0, 4.0, 0.0));
        assert!(free(-1.0, 0.0, 1.0, 5_f64.sqrt(), 2.0, 1.0));
        assert!(free(0.0, 0.0, 1.0, 2.0, 2.0, 1.0));
        // of the crank, the rocker's ball
        assert!(free(0.0, 1.0, 1.0, 1.0, 1.0, 0.0));
        assert!(!free(0.0, 0.0, 3.0, 5.0 + 1e-7, 4.0, 0.0));
        assert!(!free(0.7, 0.7, 0.25, 0.99, 0.55, 0.0));
    }

    #[test]
    fn sides_that_turn_about_one_axis_are_not_free() {
        let circle = |unit: f64| Rssr::skew([0.0, 0.0, 1.0, unit, 1.0, 0.0], [0.0, 1.0]).unwrap();
        assert!(!circle(1.5).has_free_side());
    }
}
