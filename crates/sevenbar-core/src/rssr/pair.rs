//! The closure of the RSSR with one side link given: both solutions for the other.
//!
//! Source: docs/rssr.md, (3) to (5) and (9).

use super::linkage::{Circle, Input, Rssr};
use crate::rigid::{dot, scale, sub};
use crate::trigonometric::{TrigLinear, TrigQuadratic};
use crate::twofold::Twofold;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Rounding of a squared reach, relative to coupler times size: within it a solution just out of reach is at a limit.
pub(super) const REACH_ROUNDING: f64 = 16.0 * f64::EPSILON;

/// From this condition on no digit of the rates is left: the pose is a dead centre of the input.
pub(super) const DEAD_CENTRE_CONDITION: f64 = 1e13;

/// The driving ball as seen from the follower's circle: `x`, `y` in its plane from its centre, `z` along its axis.
#[derive(Clone, Copy, Debug)]
pub struct Pair {
    pub(super) x: TrigLinear,
    pub(super) y: TrigLinear,
    pub(super) z: TrigLinear,
    /// `K = (|p|^2 + r^2 - L2^2) / 2`
    pub(super) k: TrigLinear,
    pub(super) driver_radius: f64,
    pub(super) radius: f64,
    pub(super) coupler: f64,
    pub(super) input: Input,
}

/// How far the coupler reaches at one input: everything the two solutions need.
#[derive(Clone, Copy, Debug)]
pub struct Reach {
    /// The driving ball, seen from the follower.
    pub ball: [f64; 3],
    /// Its distance from the follower's axis.
    pub height: f64,
    /// `2 (rho - K)`: how far the coupler reaches past the nearest point of the follower's circle.
    pub near: f64,
    /// `2 (rho + K)`: how far it stays short of the farthest one.
    pub far: f64,
    /// `K`
    pub k: f64,
    /// `sqrt(rho^2 - K^2)`, the size of the derivative of the closure with respect to the follower; `None` out of reach.
    pub slope: Option<f64>,
    /// How much a relative error of the squared lengths is magnified in `rho^2 - K^2`, on which all rates rest.
    pub condition: f64,
}

impl Reach {
    /// True where the two solutions are so near each other that rates hold no digit.
    pub fn is_dead_centre(&self) -> bool {
        // an undefined condition counts as one
        self.condition.is_nan() || self.condition >= DEAD_CENTRE_CONDITION
    }
}

impl Rssr {
    /// The closure seen from the input.
    pub fn pair(&self, input: Input) -> Pair {
        match input {
            Input::Crank => Pair::new(&self.crank, &self.rocker, self.coupler, input),
            Input::Rocker => Pair::new(&self.rocker, &self.crank, self.coupler, input),
        }
    }
}

impl Pair {
    pub(super) fn new(driver: &Circle, follower: &Circle, coupler: f64, input: Input) -> Self {
        let offset = sub(driver.centre, follower.centre);
        let seen = |direction| TrigLinear {
            c0: dot(offset, direction),
            c1: driver.radius * dot(driver.zero, direction),
            s1: driver.radius * dot(driver.quarter, direction),
        };
        let arm = scale(offset, driver.radius);
        let squares = dot(offset, offset) + driver.radius * driver.radius;
        Self {
            x: seen(follower.zero),
            y: seen(follower.quarter),
            z: seen(follower.axis),
            k: TrigLinear {
                c0: 0.5 * (squares + (follower.radius - coupler) * (follower.radius + coupler)),
                c1: dot(arm, driver.zero),
                s1: dot(arm, driver.quarter),
            },
            driver_radius: driver.radius,
            radius: follower.radius,
            coupler,
            input,
        }
    }

    /// The sign of the closure's derivative with respect to the follower, negated, on branch 0.
    ///
    /// Branch 0 of `beta = f(alpha)` is the paper's eq. (8), an arcsine; branch 0 of `alpha = phi(beta)` is its eq. (9), an
    /// arccosine.
    pub(super) fn branch_sign(&self, branch: usize) -> f64 {
        let first = match self.input {
            Input::Crank => 1.0,
            Input::Rocker => -1.0,
        };
        if branch == 0 { first } else { -first }
    }

    /// Where the phase of the solutions is cut: eq. (8) takes `pi/2 - atan2(E, F)`, eq. (9) `atan2(F, E)`.
    pub(super) fn phase_cut(&self) -> f64 {
        match self.input {
            Input::Crank => -FRAC_PI_2,
            Input::Rocker => f64::NEG_INFINITY,
        }
    }

    /// Everything the two solutions share at one input.
    ///
    /// `rho^2 - K^2` is the product of how far the coupler reaches past the nearest and how far it stays short of the
    /// farthest point of the follower's circle, both squared. Near a limit one of them is a small difference of large squares;
    /// they are formed with their rounding errors kept, so that only the rounding of sine and cosine is left to magnify.
    ///
    /// Source: docs/rssr.md, (5) and (9).
    pub fn reach(&self, driver: f64) -> Reach {
        let (s, c) = driver.sin_cos();
        let at = |f: &TrigLinear| Twofold::new(f.c0) + Twofold::product(f.c1, c) + Twofold::product(f.s1, s);
        let (x, y, z) = (at(&self.x), at(&self.y), at(&self.z));
        let height = (x * x + y * y).sqrt();
        let (coupler, radius) = (Twofold::new(self.coupler), Twofold::new(self.radius));
        let (inner, outer) = (height - radius, height + radius);
        let axial = (coupler - z) * (coupler + z);
        let (near, far) = ((axial - inner * inner).value(), (outer * outer - axial).value());
        let (height, z) = (height.value(), z.value());
        let rounding = -REACH_ROUNDING * self.coupler * (outer.value() + z.abs());
        let slope =
            (near >= rounding && far >= rounding).then(|| 0.5 * (near.max(0.0) * far.max(0.0)).sqrt());
        let terms = self.coupler * self.coupler + z * z + outer.value() * outer.value();
        Reach {
            ball: [x.value(), y.value(), z],
            height,
            near,
            far,
            k: 0.25 * (far - near),
            slope,
            condition: terms / near.max(0.0) + terms / far.max(0.0),
        }
    }

    /// The follower's angle on a branch, or `None` where the coupler does not reach.
    pub fn follower(&self, driver: f64, branch: usize) -> Option<f64> {
        let reach = self.reach(driver);
        reach.slope.map(|slope| self.angle(&reach, slope, branch))
    }

    /// `atan2(F, E) -+ acos(K / rho)`, the phase cut as eq. (8) and (9) cut it.
    ///
    /// Source: docs/rssr.md, (4).
    pub(super) fn angle(&self, reach: &Reach, slope: f64, branch: usize) -> f64 {
        let mut phase = reach.ball[1].atan2(reach.ball[0]);
        if phase < self.phase_cut() {
            phase += TAU;
        }
        phase - self.branch_sign(branch) * slope.atan2(reach.k)
    }

    /// `rho^2 - K^2` as a trigonometric polynomial of the driver: feasible where it is not negative.
    pub(super) fn discriminant(&self) -> TrigQuadratic {
        let square = self.radius * self.radius;
        let rho = TrigQuadratic::combine(square, &self.x.square(), square, &self.y.square());
        TrigQuadratic::combine(1.0, &rho, -1.0, &self.k.square())
    }

    /// A bound on the rounding error of a value of [`Self::discriminant`].
    pub(super) fn discriminant_noise(&self) -> f64 {
        let square = self.radius * self.radius;
        let terms = square * (self.x.square().magnitude() + self.y.square().magnitude())
            + self.k.square().magnitude();
        8.0 * f64::EPSILON * terms
    }

    /// Moves an approximate limit onto the zero of the reach itself.
    pub(super) fn polished_limit(&self, approximate: f64) -> f64 {
        let mut driver = approximate;
        for _ in 0..3 {
            let reach = self.reach(driver);
            let [x, y, z] = reach.ball;
            let (s, c) = driver.sin_cos();
            let rate = |f: &TrigLinear| f.s1 * c - f.c1 * s;
            let climb = (x * rate(&self.x) + y * rate(&self.y)) / reach.height;
            let axial = z * rate(&self.z);
            let step = if reach.near.abs() < reach.far.abs() {
                -reach.near / (2.0 * (axial + (reach.height - self.radius) * climb))
            } else {
                reach.far / (2.0 * (axial + (reach.height + self.radius) * climb))
            };
            // a step as large as the distance to a neighbour means the limit is not a simple one
            if !step.is_finite() || step.abs() > crate::trigonometric::DOUBLE_ZERO_DISTANCE {
                return driver;
            }
            driver -= step;
        }
        driver
    }
}
