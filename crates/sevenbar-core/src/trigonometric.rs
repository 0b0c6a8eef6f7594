//! Real zeros of a trigonometric polynomial of degree two, counted and located without sampling.
//!
//! `f(x) = c0 + c1 cos x + s1 sin x + c2 cos 2x + s2 sin 2x` becomes, with `t = tan((x - turn - pi)/2)`,
//! a quartic in `t`. Between two neighbouring zeros of its derivative the quartic is monotonic, so the signs
//! at those points count its real zeros, and each lies in a bracket of its own. `turn` is chosen so that
//! no zero is near `t = infinity`.

use std::f64::consts::{PI, TAU};

/// Zeros nearer to each other than this [rad] are not distinct: a change of 1e-12 in the coefficients
/// makes two of them meet, which no drawing or machine can promise not to happen.
pub const DOUBLE_ZERO_DISTANCE: f64 = 1e-6;

/// `c0 + c1 cos x + s1 sin x`
#[derive(Clone, Copy, Debug)]
pub struct TrigLinear {
    /// The constant.
    pub c0: f64,
    /// The factor of `cos x`.
    pub c1: f64,
    /// The factor of `sin x`.
    pub s1: f64,
}

/// The angle moved by whole turns into [0, 2 pi).
pub(crate) fn within_turn(angle: f64) -> f64 {
    let moved = angle.rem_euclid(TAU);
    // an angle below zero by less than a rounding of the turn comes out as the whole turn
    if moved < TAU { moved } else { 0.0 }
}

impl TrigLinear {
    /// The square, as a polynomial of degree two.
    pub fn square(&self) -> TrigQuadratic {
        let Self { c0, c1, s1 } = *self;
        TrigQuadratic {
            c0: c0 * c0 + 0.5 * (c1 * c1 + s1 * s1),
            c1: 2.0 * c0 * c1,
            s1: 2.0 * c0 * s1,
            c2: 0.5 * (c1 - s1) * (c1 + s1),
            s2: c1 * s1,
        }
    }
}

/// `c0 + c1 cos x + s1 sin x + c2 cos 2x + s2 sin 2x`
#[derive(Clone, Copy, Debug)]
pub struct TrigQuadratic {
    /// The constant.
    pub c0: f64,
    /// The factor of `cos x`.
    pub c1: f64,
    /// The factor of `sin x`.
    pub s1: f64,
    /// The factor of `cos 2x`.
    pub c2: f64,
    /// The factor of `sin 2x`.
    pub s2: f64,
}

/// A place where the polynomial vanishes, or nearly does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Zero {
    /// The angle in [0, 2 pi).
    pub angle: f64,
    /// Two or more zeros, real or complex, lie within [`DOUBLE_ZERO_DISTANCE`] of here.
    pub multiple: bool,
}

impl TrigQuadratic {
    /// A combination `a f + b g`.
    pub fn combine(a: f64, f: &Self, b: f64, g: &Self) -> Self {
        Self {
            c0: a * f.c0 + b * g.c0,
            c1: a * f.c1 + b * g.c1,
            s1: a * f.s1 + b * g.s1,
            c2: a * f.c2 + b * g.c2,
            s2: a * f.s2 + b * g.s2,
        }
    }

    /// The sum of the absolute coefficients: no value of the polynomial is greater.
    pub fn magnitude(&self) -> f64 {
        self.c0.abs() + self.c1.abs() + self.s1.abs() + self.c2.abs() + self.s2.abs()
    }

    /// The value at `x`.
    pub fn value(&self, x: f64) -> f64 {
        let (s, c) = x.sin_cos();
        self.c0 + self.c1 * c + self.s1 * s + self.c2 * (c - s) * (c + s) + self.s2 * 2.0 * s * c
    }

    /// The derivative, again of degree two.
    pub fn derivative(&self) -> Self {
        Self {
            c0: 0.0,
            c1: self.s1,
            s1: -self.c1,
            c2: 2.0 * self.s2,
            s2: -2.0 * self.c2,
        }
    }

    /// All zeros in rising order, or `None` where the polynomial vanishes everywhere.
    ///
    /// `noise` bounds the rounding error of a value; zeros that such an error could make or unmake are
    /// reported as multiple ones.
    pub fn zeros(&self, noise: f64) -> Option<Vec<Zero>> {
        if self.magnitude() <= noise {
            return None;
        }
        let turn = (0..16)
            .map(|k| f64::from(k) * TAU / 16.0)
            .max_by(|&x, &y| self.value(x).abs().total_cmp(&self.value(y).abs()))
            .unwrap_or(0.0);
        let quartic = self.about(turn + PI);
        let (stationary, zeros) = monotonic_pieces(&quartic);
        let angle = |t: f64| within_turn(turn + PI + 2.0 * t.atan());

        let mut found: Vec<Zero> = zeros
            .iter()
            .map(|&t| Zero { angle: angle(t), multiple: false })
            .collect();
        let curvature = derivative(&derivative(&quartic));
        for &t in &stationary {
            let value = evaluate(&quartic, t);
            let weight = (1.0 + t * t) * (1.0 + t * t);
            let distance = 4.0 * (2.0 * value / evaluate(&curvature, t)).abs().sqrt() / (1.0 + t * t);
            if value.abs() <= noise * weight || distance < DOUBLE_ZERO_DISTANCE {
                found.push(Zero { angle: angle(t), multiple: true });
            }
        }
        Some(merged(found, noise / self.magnitude()))
    }

    /// The quartic in `t = tan((x - centre) / 2)`, lowest power first, over `(1 + t^2)^2`.
    fn about(&self, centre: f64) -> [f64; 5] {
        let (s, c) = centre.sin_cos();
        let (s_double, c_double) = (2.0 * s * c, (c - s) * (c + s));
        let c1 = self.c1 * c + self.s1 * s;
        let s1 = self.s1 * c - self.c1 * s;
        let c2 = self.c2 * c_double + self.s2 * s_double;
        let s2 = self.s2 * c_double - self.c2 * s_double;
        [
            self.c0 + c1 + c2,
            2.0 * s1 + 4.0 * s2,
            2.0 * self.c0 - 6.0 * c2,
            2.0 * s1 - 4.0 * s2,
            self.c0 - c1 + c2,
        ]
    }
}

/// Joins zeros that are not distinct into multiple ones, round the circle.
fn merged(mut zeros: Vec<Zero>, relative_noise: f64) -> Vec<Zero> {
    let reach = DOUBLE_ZERO_DISTANCE.max(8.0 * relative_noise.sqrt());
    zeros.sort_by(|a, b| a.angle.total_cmp(&b.angle));
    let mut groups: Vec<Vec<Zero>> = Vec::new();
    for zero in zeros {
        match groups.last_mut() {
            Some(group) if zero.angle - group[group.len() - 1].angle < reach => group.push(zero),
            _ => groups.push(vec![zero]),
        }
    }
    if groups.len() > 1 {
        let first = groups[0][0].angle + TAU;
        let last = &groups[groups.len() - 1];
        if first - last[last.len() - 1].angle < reach {
            let tail = groups.pop().unwrap_or_default();
            groups[0].extend(tail);
        }
    }
    let mut joined: Vec<Zero> = groups
        .iter()
        .map(|group| {
            // the stationary point, where there is one, is the well-conditioned place of a double zero
            let best = group.iter().find(|z| z.multiple).unwrap_or(&group[0]);
            Zero { angle: best.angle, multiple: group.len() > 1 || best.multiple }
        })
        .collect();
    joined.sort_by(|a, b| a.angle.total_cmp(&b.angle));
    joined
}

/// The stationary points and the real zeros of a polynomial (lowest power first, leading one not zero).
fn monotonic_pieces(polynomial: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let degree = polynomial.len() - 1;
    if degree == 1 {
        return (Vec::new(), vec![-polynomial[0] / polynomial[1]]);
    }
    let slope = derivative(polynomial);
    let stationary = monotonic_pieces(&slope).1;
    let leading = polynomial[degree];
    let bound = 1.0
        + polynomial[..degree]
            .iter()
            .map(|c| (c / leading).abs())
            .fold(0.0, f64::max);
    let mut ends = vec![-bound];
    ends.extend(stationary.iter().filter(|t| t.abs() < bound));
    ends.push(bound);
    let zeros = ends
        .windows(2)
        .filter_map(|w| bracketed_zero(polynomial, &slope, w[0], w[1]))
        .collect();
    (stationary, zeros)
}

/// The zero in `(low, high]` of a polynomial monotonic there: Newton steps kept inside a shrinking bracket.
fn bracketed_zero(polynomial: &[f64], slope: &[f64], low: f64, high: f64) -> Option<f64> {
    let (mut low, mut high) = (low, high);
    let at_high = evaluate(polynomial, high);
    if at_high == 0.0 {
        return Some(high);
    }
    if (evaluate(polynomial, low) > 0.0) == (at_high > 0.0) {
        return None;
    }
    let mut t = 0.5 * (low + high);
    // a Newton step that leaves the bracket is replaced by halving it; near a multiple zero Newton's steps
    // shrink by a constant factor, hence the generous bound
    for _ in 0..200 {
        let value = evaluate(polynomial, t);
        if value == 0.0 {
            return Some(t);
        }
        if (value > 0.0) == (at_high > 0.0) {
            high = t;
        } else {
            low = t;
        }
        let newton = t - value / evaluate(slope, t);
        let next = if newton > low && newton < high {
            newton
        } else {
            0.5 * (low + high)
        };
        if (next - t).abs() <= f64::EPSILON * t.abs().max(f64::EPSILON) || next == low || next == high {
            return Some(next);
        }
        t = next;
    }
    Some(t)
}

fn derivative(polynomial: &[f64]) -> Vec<f64> {
    polynomial[1..]
        .iter()
        .enumerate()
        .map(|(k, c)| (k + 1) as f64 * c)
        .collect()
}

fn evaluate(polynomial: &[f64], t: f64) -> f64 {
    polynomial.iter().rev().fold(0.0, |sum, c| sum * t + c)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The polynomial `product of sin((x - z) / 2)` over four angles: its zeros are those angles.
    fn with_zeros(z: [f64; 4]) -> TrigQuadratic {
        // sin((x-a)/2) sin((x-b)/2) = (cos((a-b)/2) - cos(x - (a+b)/2)) / 2
        let pair = |a: f64, b: f64| TrigLinear {
            c0: 0.5 * ((a - b) / 2.0).cos(),
            c1: -0.5 * ((a + b) / 2.0).cos(),
            s1: -0.5 * ((a + b) / 2.0).sin(),
        };
        let (f, g) = (pair(z[0], z[1]), pair(z[2], z[3]));
        let sum = TrigLinear { c0: f.c0 + g.c0, c1: f.c1 + g.c1, s1: f.s1 + g.s1 };
        let difference = TrigLinear { c0: f.c0 - g.c0, c1: f.c1 - g.c1, s1: f.s1 - g.s1 };
        TrigQuadratic::combine(0.25, &sum.square(), -0.25, &difference.square())
    }

    #[test]
    fn an_angle_a_rounding_below_zero_is_zero_not_a_turn() {
        for angle in [-1e-17, -1e-300, -0.0, 0.0, TAU, -TAU] {
            assert_eq!(within_turn(angle), 0.0, "{angle}");
        }
        assert!(within_turn(-1e-15) < TAU && within_turn(-1e-15) > TAU - 1e-14);
        assert!((within_turn(7.0) - (7.0 - TAU)).abs() < 1e-15);
    }

    #[test]
    fn four_known_zeros_come_back() {
        for turn in 0..200 {
            let turn = f64::from(turn) * 0.1;
            let mut want = [0.3, 1.1, 2.9, 5.0].map(|z: f64| within_turn(z + turn));
            let zeros = with_zeros(want).zeros(1e-15).unwrap();
            want.sort_by(f64::total_cmp);
            assert_eq!(zeros.len(), 4);
            for (zero, w) in zeros.iter().zip(want) {
                assert!((zero.angle - w).abs() < 1e-13 && !zero.multiple, "{zero:?} {w}");
            }
        }
    }

    #[test]
    fn a_double_zero_is_called_multiple_on_either_side_of_meeting() {
        for shift in [0.0, 1e-9, 1e-14] {
            let mut f = with_zeros([1.0, 1.0, 3.0, 4.0]);
            for c0 in [f.c0 - shift * 1e-6, f.c0 + shift * 1e-6] {
                f.c0 = c0;
                let zeros = f.zeros(1e-15).unwrap();
                assert_eq!(zeros.len(), 3, "{zeros:?}");
                assert!(zeros[0].multiple && (zeros[0].angle - 1.0).abs() < 1e-9);
                assert!(!zeros[1].multiple && !zeros[2].multiple);
            }
        }
        let apart = with_zeros([1.0, 1.0 + 4e-6, 3.0, 4.0]).zeros(1e-15).unwrap();
        assert!(apart.len() == 4 && apart.iter().all(|z| !z.multiple));
    }

    #[test]
    fn no_zero_where_the_constant_rules_and_none_told_where_all_vanishes() {
        let mut f = with_zeros([0.3, 1.1, 2.9, 5.0]);
        f.c0 += 10.0;
        assert!(f.zeros(1e-15).unwrap().is_empty());
        let nothing = TrigQuadratic::combine(0.0, &f, 0.0, &f);
        assert!(nothing.zeros(1e-15).is_none());
    }
}
