//! One freedom with losses and a motor in time: collocation at Chebyshev's nodes, step by step.
//!
//! `m s'' = -U' - D s' - m' s'^2 / 2 + torque(t, dx/dt) dx/ds`
//!
//! On a step, s'' is a polynomial through its values at the nodes, and speed and place are its integrals from
//! the step's beginning; Picard's iteration makes them agree. The steps' polynomials are the solution at all
//! times. Source: docs/theory_free.md, (12).

use crate::piecewise::Piecewise;
use crate::stopping;
use std::f64::consts::PI;

/// Nodes of a step.
pub const NODES: usize = 16;

/// Terms of a step's polynomial of place: two integrals more than of the nodes' values.
pub const TERMS: usize = NODES + 2;

/// Iterations before a step is halved; they converge if a step is short beside the motion's own time.
const ITERATIONS: usize = 40;

/// A step whose iteration moves by this part of the tolerance has converged.
const CONVERGED: f64 = 0.02;

/// Terms that foretell the next step's accelerations.
const FORETOLD: usize = 8;

/// Most that a step is longer than the one before, and of what the last terms allow.
const LONGER: f64 = 2.0;
const CAUTION: f64 = 0.85;

/// A step shorter than this part of the duration is taken as it is: no tolerance can be met at a jump.
const SHORTEST: f64 = 1e-13;

/// The motor's torque by time and the input's speed.
pub type Torque<'a> = dyn FnMut(f64, f64) -> f64 + 'a;

/// What moves and acts along a circuit: m, U', D, d(input)/ds, what U' gains with each lap, and m'.
#[derive(Clone, Copy, Debug)]
pub struct Along<'a> {
    /// These six.
    pub quantities: Piecewise<'a>,
    /// The length of a lap, if the circuit is closed.
    pub lap: Option<f64>,
}

/// Where a motion is, and how exactly it is wanted.
#[derive(Clone, Copy, Debug)]
pub struct Begin {
    /// The time.
    pub time: f64,
    /// The place.
    pub place: f64,
    /// Its rate.
    pub speed: f64,
    /// The time at which it ends at the latest.
    pub until: f64,
    /// What a step may miss of the place.
    pub place_error: f64,
    /// What a step may miss of the speed.
    pub speed_error: f64,
}

/// The motion step by step.
#[derive(Clone, Debug, Default)]
pub struct Steps {
    /// When each step begins, and the end.
    pub times: Vec<f64>,
    /// Chebyshev coefficients of place and speed, (steps, TERMS, 2).
    pub series: Vec<f64>,
    /// The place at the end.
    pub place: f64,
    /// The speed at the end.
    pub speed: f64,
    /// Whether it stopped at one of the bounds.
    pub stopped: bool,
    /// Whether it got to its end at all.
    pub whole: bool,
}

/// Nodes on [-1, 1] in order, and what turns values there into coefficients and integrals from -1 on.
struct Collocation {
    nodes: [f64; NODES],
    /// Chebyshev coefficients of the values.
    terms: [[f64; NODES]; NODES],
    /// What one at each node adds to the first and second integral at the nodes, and at 1.
    once: [[f64; NODES + 1]; NODES],
    twice: [[f64; NODES + 1]; NODES],
}

/// The Chebyshev coefficients of the integral from -1 on.
fn integral(terms: &[f64]) -> Vec<f64> {
    let at = |k: usize| terms.get(k).copied().unwrap_or(0.0);
    let mut out = vec![0.0; terms.len() + 1];
    for (k, value) in out.iter_mut().enumerate().skip(1) {
        let before = if k == 1 { 2.0 * at(0) } else { at(k - 1) };
        *value = (before - at(k + 1)) / (2 * k) as f64;
    }
    out[0] = (1..out.len())
        .map(|k| if k % 2 == 0 { -out[k] } else { out[k] })
        .sum();
    out
}

/// `sum c_k T_k(x)`
fn sum(terms: &[f64], x: f64) -> f64 {
    let (mut one, mut two) = (0.0, 0.0);
    for term in terms.iter().skip(1).rev() {
        (one, two) = (term + 2.0 * x * one - two, one);
    }
    terms[0] + x * one - two
}

impl Collocation {
    fn new() -> Self {
        let count = NODES as f64;
        let angle = |j: usize| PI * (1.0 - (j as f64 + 0.5) / count);
        let nodes = std::array::from_fn(|j| angle(j).cos());
        let terms: [[f64; NODES]; NODES] = std::array::from_fn(|k| {
            let share = if k == 0 { 1.0 } else { 2.0 } / count;
            std::array::from_fn(|j| share * (k as f64 * angle(j)).cos())
        });
        let (mut once, mut twice) = ([[0.0; NODES + 1]; NODES], [[0.0; NODES + 1]; NODES]);
        for j in 0..NODES {
            let own: Vec<f64> = terms.iter().map(|row| row[j]).collect();
            let first = integral(&own);
            let second = integral(&first);
            for (i, &x) in nodes.iter().chain([&1.0]).enumerate() {
                once[j][i] = sum(&first, x);
                twice[j][i] = sum(&second, x);
            }
        }
        Self { nodes, terms, once, twice }
    }

    fn coefficients(&self, values: &[f64; NODES]) -> [f64; NODES] {
        self.terms
            .map(|row| row.iter().zip(values).map(|(c, value)| c * value).sum())
    }
}

/// Integrals of values at nodes, by what one at each adds.
fn integrals(by_node: &[[f64; NODES + 1]; NODES], values: &[f64; NODES]) -> [f64; NODES + 1] {
    let mut out = [0.0; NODES + 1];
    for (own, value) in by_node.iter().zip(values) {
        for (total, part) in out.iter_mut().zip(own) {
            *total += part * value;
        }
    }
    out
}

impl Along<'_> {
    /// `s''` at a time, place and speed, by the polynomials between two bounds.
    fn acceleration(
        &self,
        (low, high): (f64, f64),
        state: [f64; 3],
        motor: &mut Option<&mut Torque<'_>>,
    ) -> f64 {
        let [time, place, speed] = state;
        let inside = place.clamp(low, high);
        let lap = self.lap.map_or(0.0, |length| (inside / length).floor());
        let start = lap * self.lap.unwrap_or(0.0);
        let mut own = [0.0; 6];
        let piece = self.quantities.piece(inside - start);
        self.quantities.on(piece, place - start, &mut own);
        let [mass, slope, loss, input, winding, by_mass] = own;
        let mut force = -(slope + lap * winding) - loss * speed - by_mass * speed * speed / 2.0;
        if let Some(torque) = motor {
            force += torque(time, input * speed) * input;
        }
        force / mass
    }

    /// The motion from a state until a time, or until it reaches one of the bounds.
    pub fn driven(&self, begin: Begin, bounds: (f64, f64), mut motor: Option<&mut Torque<'_>>) -> Steps {
        let rule = Collocation::new();
        let Begin { mut time, mut place, mut speed, until, place_error, speed_error } = begin;
        let mut out = Steps { times: vec![time], place, speed, ..Steps::default() };
        let mut step = (until - time) / 64.0;
        let mut last: Option<(f64, [f64; NODES])> = None;
        let mut cut = false;
        while time < until {
            stopping::piece();
            // no end that rounding makes a step of its own
            if !cut && until - time < step * 1.01 {
                step = until - time;
            }
            let half = step / 2.0;

            let mut values = match last {
                Some((before, terms)) => std::array::from_fn(|j| {
                    sum(&terms[..FORETOLD], 1.0 + (rule.nodes[j] + 1.0) * step / before)
                }),
                None => [self.acceleration(bounds, [time, place, speed], &mut motor); NODES],
            };
            let mut moved = f64::INFINITY;
            for _ in 0..ITERATIONS {
                let (once, twice) = (integrals(&rule.once, &values), integrals(&rule.twice, &values));
                let after: [f64; NODES] = std::array::from_fn(|j| {
                    let since = half * (rule.nodes[j] + 1.0);
                    let s = place + since * speed + half * half * twice[j];
                    self.acceleration(bounds, [time + since, s, speed + half * once[j]], &mut motor)
                });
                moved = (0..NODES).fold(0.0f64, |most, j| most.max((after[j] - values[j]).abs()));
                values = after;
                if !(moved * half > CONVERGED * speed_error || moved * half * half > CONVERGED * place_error)
                {
                    break;
                }
            }
            let shortest = step <= SHORTEST * until;
            if !values.iter().all(|a| a.is_finite()) {
                if shortest {
                    return out;
                }
                (step, last, cut) = (step * 0.4, None, false);
                continue;
            }
            let terms = rule.coefficients(&values);
            let tail = terms[NODES - 2].abs().max(terms[NODES - 1].abs()) / (2 * NODES) as f64;
            let missing =
                (tail * half / speed_error).max(tail * half * half / (2 * NODES) as f64 / place_error);
            let settled = moved * half <= speed_error && moved * half * half <= place_error;
            if !(settled && missing <= 1.0 || shortest) {
                let allowed = CAUTION * missing.powf(-1.0 / NODES as f64);
                step *= if settled { allowed.clamp(0.1, 0.7) } else { 0.4 };
                cut = false;
                continue;
            }
            let mut first = integral(&terms);
            first.iter_mut().for_each(|c| *c *= half);
            first[0] += speed;
            let mut second = integral(&first);
            second.iter_mut().for_each(|c| *c *= half);
            second[0] += place;
            if !cut && let Some(x) = leaves(&second, bounds, &rule.nodes) {
                // the same once more, up to the bound
                step = half * (x + 1.0);
                cut = true;
                if step > SHORTEST * until {
                    continue;
                }
            }
            first.push(0.0);
            out.series
                .extend(second.iter().zip(&first).flat_map(|(&s, &v)| [s, v]));
            time = if step == until - time { until } else { time + step };
            place += 2.0 * half * speed + half * half * integrals(&rule.twice, &values)[NODES];
            speed += half * integrals(&rule.once, &values)[NODES];
            out.times.push(time);
            (out.place, out.speed) = (place, speed);
            if cut {
                out.stopped = true;
                break;
            }
            last = Some((step, terms));
            step *= (CAUTION * missing.powf(-1.0 / NODES as f64)).clamp(0.2, LONGER);
        }
        out.whole = true;
        out
    }
}

/// The first x in (-1, 1] at which a place lies beyond one of the bounds.
fn leaves(place: &[f64], (low, high): (f64, f64), nodes: &[f64; NODES]) -> Option<f64> {
    let beyond = |x: f64| {
        let s = sum(place, x);
        s < low || s > high
    };
    let mut inside = -1.0;
    for &x in nodes.iter().chain([&1.0]) {
        if !beyond(x) {
            inside = x;
            continue;
        }
        let mut outside = x;
        while outside - inside > 2.0 * f64::EPSILON {
            let middle = (inside + outside) / 2.0;
            *(if beyond(middle) { &mut outside } else { &mut inside }) = middle;
        }
        return Some(outside);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    const EXACT: Begin = Begin {
        time: 0.0,
        place: 1.0,
        speed: 0.0,
        until: 20.0,
        place_error: 1e-14,
        speed_error: 1e-14,
    };

    /// m, U', D, dx/ds, winding, m' on [-10, 10] by their first two terms.
    fn line(terms: [[f64; 6]; 2]) -> Vec<f64> {
        terms.concat()
    }

    #[test]
    fn a_damped_vibration_is_the_one_of_the_formula() {
        // U' = 4 s, D = 0.2: s = exp(-0.1 t) (cos w t + 0.1/w sin w t), w^2 = 4 - 0.01
        let series = line([[1.0, 0.0, 0.2, 1.0, 0.0, 0.0], [0.0, 40.0, 0.0, 0.0, 0.0, 0.0]]);
        let quantities = Piecewise::new(&[-10.0, 10.0], &series, 2, 6).unwrap();
        let found = Along { quantities, lap: None }.driven(EXACT, (-10.0, 10.0), None);
        let w = 3.99f64.sqrt();
        let exact = |t: f64| (-0.1 * t).exp() * ((w * t).cos() + 0.1 / w * (w * t).sin());
        assert!(found.whole && !found.stopped);
        assert!((found.place - exact(20.0)).abs() < 1e-13);
        let own = Piecewise::new(&found.times, &found.series, TERMS, 2).unwrap();
        for k in 0..200 {
            let (t, mut out) = (0.1 * f64::from(k), [0.0; 2]);
            own.on(own.piece(t), t, &mut out);
            assert!((out[0] - exact(t)).abs() < 2e-13, "{t}");
        }
    }

    #[test]
    fn a_motor_by_time_is_followed_and_a_bound_stops_it() {
        // s'' = t from rest at 1: s = 1 + t^3 / 6 is at 2 at the cube root of 6
        let series = line([[1.0, 0.0, 0.0, 1.0, 0.0, 0.0], [0.0; 6]]);
        let quantities = Piecewise::new(&[-10.0, 10.0], &series, 2, 6).unwrap();
        let mut torque = |t: f64, _: f64| t;
        let found = Along { quantities, lap: None }.driven(EXACT, (-10.0, 2.0), Some(&mut torque));
        assert!(found.stopped);
        assert!((found.times.last().unwrap() - 6f64.cbrt()).abs() < 1e-14);
        assert!((found.speed - 6f64.cbrt().powi(2) / 2.0).abs() < 1e-13);
    }

    #[test]
    fn a_torque_without_a_value_has_no_motion() {
        let series = line([[1.0, 0.0, 0.0, 1.0, 0.0, 0.0], [0.0; 6]]);
        let quantities = Piecewise::new(&[-10.0, 10.0], &series, 2, 6).unwrap();
        let mut torque = |t: f64, _: f64| if t > 1.0 { f64::NAN } else { 0.0 };
        let found = Along { quantities, lap: None }.driven(EXACT, (-10.0, 10.0), Some(&mut torque));
        assert!(!found.whole);
        assert!((found.times.last().unwrap() - 1.0).abs() < 1e-6);
    }
}
