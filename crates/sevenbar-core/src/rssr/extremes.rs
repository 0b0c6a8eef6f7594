//! Extremes of what a designer reads, located by root finding: the output's rates and the transmission angle.
//!
//! Source: docs/theory_many.md, (10).

use super::domain::Extent;
use super::pair::Pair;
use crate::taylor::Taylor;
use crate::trigonometric::within_turn;
use std::f64::consts::TAU;

/// Cells in which a turn is searched; two stationary points within one cell are distinguished as well.
const CELLS: usize = 360;

/// How often the cells beside a nearest approach of the branches are halved: down to 1e-9 rad.
const NARROWINGS: i32 = 24;

/// An extreme value and the input at which it occurs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extreme {
    /// The input angle.
    pub input: f64,
    /// The value: an angle, or a rate per radian of input to the power of its order.
    pub value: f64,
}

/// The derivatives of the output by the input, from order 0.
type Derivatives = [f64; 6];

/// Lowest and highest first derivative, then second, then third, on a branch without dead centres.
///
/// None where the other branch comes so near that no digit of the rates is left: they peak just there.
pub(super) fn rate_extremes(pair: &Pair, branch: usize) -> Option<[[Extreme; 2]; 3]> {
    let derivatives = |input: f64| -> Option<Derivatives> {
        let series = pair.follower_taylor(Taylor::<6>::variable(input), branch)?;
        Some(std::array::from_fn(|k| series.derivative(k)))
    };
    let nodes = nodes(pair)
        .into_iter()
        .map(|input| Some((input, derivatives(input)?)))
        .collect::<Option<Vec<(f64, Derivatives)>>>()?;
    let at = |input: f64| derivatives(input).unwrap_or([f64::NAN; 6]);
    Some([1, 2, 3].map(|order| {
        let mut candidates = vec![(nodes[0].0, nodes[0].1[order])];
        for cell in nodes.windows(2) {
            for input in stationary(&at, cell[0], cell[1], order) {
                candidates.push((input, at(input)[order]));
            }
        }
        let extreme = |best: Option<&(f64, f64)>| {
            let &(input, value) = best.unwrap_or(&(f64::NAN, f64::NAN));
            Extreme { input: within_turn(input), value }
        };
        [
            extreme(candidates.iter().min_by(|a, b| a.1.total_cmp(&b.1))),
            extreme(candidates.iter().max_by(|a, b| a.1.total_cmp(&b.1))),
        ]
    }))
}

/// The ends of the cells: evenly spread, and ever closer towards each place where the two branches come nearest.
///
/// Just past a change point the rates peak there, within the square root of the distance from it.
fn nodes(pair: &Pair) -> Vec<f64> {
    let cell = TAU / CELLS as f64;
    let mut nodes: Vec<f64> = (0..=CELLS).map(|k| cell * k as f64).collect();
    let slope = pair.discriminant().derivative();
    for zero in slope.zeros(pair.discriminant_noise()).unwrap_or_default() {
        nodes.push(zero.angle);
        let offsets = (0..NARROWINGS).map(|k| cell * 0.5_f64.powi(k));
        nodes.extend(offsets.flat_map(|x| [zero.angle - x, zero.angle + x]));
    }
    nodes.retain(|x| (0.0..=TAU).contains(x));
    nodes.sort_by(f64::total_cmp);
    nodes.dedup();
    nodes
}

/// Zeros of derivative `order + 1` in a cell: one where its sign changes; two where it only dips to the other sign,
/// which its own derivative betrays by pointing towards zero at both ends.
fn stationary(
    at: &impl Fn(f64) -> Derivatives,
    (low, f_low): (f64, Derivatives),
    (high, f_high): (f64, Derivatives),
    order: usize,
) -> Vec<f64> {
    let k = order + 1;
    if f_low[k] * f_high[k] <= 0.0 {
        return vec![zero(at, low, high, k)];
    }
    let dips = f_low[k] * f_low[k + 1] < 0.0 && f_high[k] * f_high[k + 1] > 0.0;
    if !dips {
        return Vec::new();
    }
    let turn = zero(at, low, high, k + 1);
    if at(turn)[k] * f_low[k] > 0.0 {
        return Vec::new();
    }
    vec![zero(at, low, turn, k), zero(at, turn, high, k)]
}

/// The zero of derivative `k` between two inputs at which its signs differ: regula falsi (Illinois), then halving where slow.
fn zero(at: &impl Fn(f64) -> Derivatives, low: f64, high: f64, k: usize) -> f64 {
    let (mut a, mut b) = (low, high);
    let (mut fa, mut fb) = (at(a)[k], at(b)[k]);
    for step in 0..200 {
        if fa == 0.0 {
            return a;
        }
        if fb == 0.0 || (b - a).abs() <= 4.0 * f64::EPSILON * b.abs().max(1.0) {
            return b;
        }
        let secant = b - fb * (b - a) / (fb - fa);
        let x = if step % 4 == 3 { 0.5 * (a + b) } else { secant };
        let fx = at(x)[k];
        if fx * fb < 0.0 {
            (a, fa) = (b, fb);
        } else {
            fa *= 0.5;
        }
        (b, fb) = (x, fx);
    }
    b
}

/// The least and the greatest transmission angle: where `rho^2 - K^2` is stationary, and at the limits.
pub(super) fn transmission_extremes(pair: &Pair, extent: Extent, branch: usize) -> [Extreme; 2] {
    let slope = pair.discriminant().derivative();
    let mut inputs: Vec<f64> = slope
        .zeros(pair.discriminant_noise())
        .unwrap_or_default()
        .into_iter()
        .map(|z| z.angle)
        .filter(|&x| extent.distance(x) == 0.0)
        .collect();
    match extent {
        Extent::Full => inputs.push(0.0),
        // the angle rises from one limit and falls to the other; where rounding hides the place between, any is as good
        Extent::Arc(start, end) if inputs.is_empty() => inputs.push(0.5 * (start + end)),
        Extent::Arc(..) => {}
    }
    let angle_at = |&input: &f64| Extreme { input, value: pair.transmission_angle(input, branch) };
    let least = inputs
        .iter()
        .map(angle_at)
        .min_by(|a, b| a.value.total_cmp(&b.value));
    let greatest = inputs
        .iter()
        .map(angle_at)
        .max_by(|a, b| a.value.total_cmp(&b.value));
    let nowhere = Extreme { input: f64::NAN, value: f64::NAN };
    // at a limit the coupler's line meets the driven axis: it moves the driven ball neither way
    let least = match extent {
        Extent::Full => least,
        Extent::Arc(start, _) => Some(Extreme { input: start, value: 0.0 }),
    };
    [least.unwrap_or(nowhere), greatest.unwrap_or(nowhere)]
}

impl Pair {
    /// 90 degrees less the angle between the coupler's line and the direction in which its far ball moves.
    pub fn transmission_angle(&self, driver: f64, branch: usize) -> f64 {
        let reach = self.reach(driver);
        let slope = reach.slope.unwrap_or(0.0);
        if slope == 0.0 {
            // the line of the coupler meets the driven axis, perhaps in the ball, with which no direction is
            return 0.0;
        }
        let (sine, cosine) = self.direction(&reach, slope, branch);
        let [x, y, z] = reach.ball;
        let radial = x * cosine + y * sine - self.radius;
        (slope / self.radius).atan2(radial.hypot(z))
    }
}
