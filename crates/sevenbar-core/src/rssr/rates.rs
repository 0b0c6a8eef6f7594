//! Derivatives of the follower for any motion of the driver, to any order.
//!
//! Source: docs/rssr.md, (6) to (8).

use super::pair::Pair;
use crate::taylor::{Taylor, sin_cos_coefficient};
use crate::trigonometric::TrigLinear;

impl Pair {
    /// The follower's angle with its time derivatives, on a branch, for a driver with its own.
    ///
    /// The closure `K - E cos x - F sin x = 0` holds order by order; each coefficient of `x` enters its own order linearly,
    /// with the factor that the first derivative has (the paper's `R` of eq. (12), (13)). `None` where the coupler does not reach or
    /// at a dead centre of the driver, where no rate exists.
    ///
    /// Source: docs/rssr.md, (6) to (8).
    pub fn follower_taylor<const N: usize>(&self, driver: Taylor<N>, branch: usize) -> Option<Taylor<N>> {
        let reach = self.reach(driver.value());
        let slope = reach.slope.filter(|_| !reach.is_dead_centre())?;
        let (s, c) = driver.sin_cos();
        let along = |f: &TrigLinear, factor: f64| {
            (c.scale(f.c1) + s.scale(f.s1) + Taylor::constant(f.c0)).scale(factor)
        };
        let e = along(&self.x, self.radius).0;
        let f = along(&self.y, self.radius).0;
        let k = along(&self.k, 1.0).0;

        let sign = self.branch_sign(branch);
        let (sine, cosine) = self.direction(&reach, slope, branch);
        let (mut sines, mut cosines) = ([0.0; N], [0.0; N]);
        (sines[0], cosines[0]) = (sine, cosine);
        let mut angle = [0.0; N];
        angle[0] = self.angle(&reach, slope, branch);
        for order in 1..N {
            (sines[order], cosines[order]) = sin_cos_coefficient(&angle, &sines, &cosines, order);
            let mut remainder = k[order];
            for i in 0..=order {
                remainder -= e[i] * cosines[order - i] + f[i] * sines[order - i];
            }
            angle[order] = remainder / (sign * slope);
            sines[order] += angle[order] * cosine;
            cosines[order] -= angle[order] * sine;
        }
        Some(Taylor(angle))
    }

    /// Sine and cosine of the follower's angle, without the angle.
    pub(super) fn direction(&self, reach: &super::pair::Reach, slope: f64, branch: usize) -> (f64, f64) {
        let signed = self.branch_sign(branch) * slope;
        let [x, y, _] = reach.ball;
        let scale = 1.0 / (self.radius * reach.height * reach.height);
        (
            (reach.k * y - signed * x) * scale,
            (reach.k * x + signed * y) * scale,
        )
    }
}
