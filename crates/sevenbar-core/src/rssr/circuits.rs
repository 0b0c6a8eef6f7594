//! Rows along a circuit: the input grid, every joint with its derivatives, and what can be said of each row.

use super::domain::{Extent, turn_between};
use super::frames::JOINT_COLUMNS;
use super::linkage::{Input, Rssr};
use super::motion::{Circuit, Motion, MotionType, branch_at};
use super::pair::Pair;
use crate::one_pose::each_once;
use crate::outcome::{DeadCentreKind, RowStatus};
use crate::stopping;
use crate::taylor::Taylor;
use std::f64::consts::TAU;

/// A grid input nearer to a limit than this part of a step is the limit's own row.
const SAME_ROW: f64 = 1e-6;

/// One sample of a circuit.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// What it holds.
    pub status: RowStatus,
    /// The pass between input dead centres, from 0.
    pub branch: usize,
    /// The branch of the closed form, 0 or 1.
    pub mode: usize,
    /// Joint values in loop order: value and three derivatives by time.
    pub joints: [[f64; 4]; JOINT_COLUMNS],
    /// The closure error relative to the linkage's size.
    pub residual: f64,
    /// How much a relative error of the squared lengths is magnified in what all rates rest on.
    pub condition: f64,
}

/// A limit nearer than this [rad] to a change point is one of the two that meet there: they lie within 1e-6 rad of each other.
const MEETING: f64 = 2e-6;

/// A place along a circuit before it is solved.
#[derive(Clone, Copy)]
struct Stop {
    input: f64,
    pass: usize,
    at_limit: bool,
}

impl Rssr {
    /// The rows of a circuit on the grid `2 pi k / samples`, the input moving at `speed` [rad/s].
    ///
    /// A circuit that goes round is walked, in the direction of the speed, until it closes and does not repeat its first row. One
    /// that rocks starts at its lower limit and holds each pass, with an exact row at each limit.
    pub fn rows(&self, motion: &Motion, circuit: &Circuit, samples: usize, speed: f64) -> Vec<Row> {
        let step = TAU / samples as f64;
        let stops: Vec<Stop> = match circuit.input {
            Extent::Full => (0..samples * circuit.turns)
                .map(|k| Stop {
                    // the product is rounded once, so that whole turns divided evenly hit their fractions
                    input: (TAU * k as f64 / samples as f64).copysign(speed),
                    pass: 0,
                    at_limit: false,
                })
                .collect(),
            Extent::Arc(start, end) => rocking_stops(start, end, step, samples),
        };
        let drive = |input: f64| Taylor::from_derivatives(&[input, speed, 0.0, 0.0]);
        let drivers: Vec<(Stop, Taylor<4>)> = stops.into_iter().map(|s| (s, drive(s.input))).collect();
        self.walk(motion, circuit, &drivers)
    }

    /// The rows of a circuit for an input law, once for each pass: `law` holds the input and its derivatives by time.
    ///
    /// An input beyond the limits of the circuit has no solution, and keeps its row.
    pub fn law_rows(&self, motion: &Motion, circuit: &Circuit, law: &[[f64; 4]]) -> Vec<Vec<Row>> {
        let passes = if circuit.input == Extent::Full { 1 } else { 2 };
        (0..passes)
            .map(|pass| {
                let drivers: Vec<(Stop, Taylor<4>)> = law
                    .iter()
                    .map(|d| {
                        (
                            Stop { input: d[0], pass, at_limit: false },
                            Taylor::from_derivatives(d),
                        )
                    })
                    .collect();
                self.walk(motion, circuit, &drivers)
            })
            .collect()
    }

    /// Joint values and closure error of each assembly mode at one input, angles in (-pi, pi]: none, two, or one at a limit.
    pub fn assembly_modes(&self, input: Input, driver: f64) -> Vec<([f64; JOINT_COLUMNS], f64)> {
        let pair = self.pair(input);
        let reach = pair.reach(driver);
        let Some(slope) = reach.slope else {
            return Vec::new();
        };
        let count = if slope == 0.0 { 1 } else { 2 };
        let modes = (0..count)
            .map(|branch| {
                let follower = pair.angle(&reach, slope, branch);
                let (crank, rocker) = Self::in_loop_order(input, driver, follower);
                let joints = self.joints(Taylor::<1>::constant(crank), Taylor::constant(rocker));
                let wrapped = joints.map(|q| -turn_between(q.value(), 0.0));
                (wrapped, self.residual(crank, rocker))
            })
            .collect();
        each_once(modes, |_| None)
    }

    /// Joint values at a change point, an input of those of a motion, angles in (-pi, pi]; and the circuits that meet there, by their
    /// number: none where the loop closes in that pose only.
    pub fn change_point(&self, motion: &Motion, driver: f64) -> ([f64; JOINT_COLUMNS], Vec<usize>) {
        let pair = self.pair(motion.input);
        let follower = pair.angle(&pair.reach(driver), 0.0, 0);
        let (crank, rocker) = Self::in_loop_order(motion.input, driver, follower);
        let joints = self.joints(Taylor::<1>::constant(crank), Taylor::constant(rocker));
        let meets = |circuit: &Circuit| {
            let near = |a: f64, b: f64| turn_between(a, b).abs() < MEETING;
            circuit.touches.iter().any(|&t| near(t, driver))
                || circuit.dead_centres.iter().any(|d| match d.kind {
                    DeadCentreKind::Input => near(d.input, driver),
                    DeadCentreKind::Output => near(d.output, follower),
                })
        };
        let circuits = (0..motion.circuits.len())
            .filter(|&k| meets(&motion.circuits[k]))
            .collect();
        (joints.map(|q| -turn_between(q.value(), 0.0)), circuits)
    }

    fn walk(&self, motion: &Motion, circuit: &Circuit, drivers: &[(Stop, Taylor<4>)]) -> Vec<Row> {
        let pair = self.pair(motion.input);
        let mut rows: Vec<Row> = Vec::with_capacity(drivers.len());
        let mut previous: Option<(Stop, f64)> = None;
        for &(stop, driver) in drivers {
            stopping::piece();
            let mut row = self.row(motion, circuit, &pair, stop, driver);
            let follower = follower_column(motion.input);
            let angle = row.joints[follower][0];
            if row.status != RowStatus::NoSolution {
                let unwrapped = unwrap_follower(&pair, circuit, stop, angle, previous);
                row.joints[follower][0] = unwrapped;
                previous = Some((stop, unwrapped));
            }
            rows.push(row);
        }
        unwrap_balls(&mut rows);
        rows
    }

    fn row(&self, motion: &Motion, circuit: &Circuit, pair: &Pair, stop: Stop, driver: Taylor<4>) -> Row {
        let mode = (branch_at(circuit, stop.input) + stop.pass) % 2;
        let reach = pair.reach(stop.input);
        let mut row = Row {
            status: RowStatus::NoSolution,
            branch: stop.pass,
            mode,
            joints: [[f64::NAN; 4]; JOINT_COLUMNS],
            residual: f64::NAN,
            condition: if stop.at_limit {
                f64::INFINITY
            } else {
                reach.condition
            },
        };
        row.joints[driver_column(motion.input)] = std::array::from_fn(|k| driver.derivative(k));
        let slope = if stop.at_limit { Some(0.0) } else { reach.slope };
        // near a change point rounding may leave a gap that is none
        let gap = motion.motion_type == MotionType::ChangePoint
            && circuit
                .touches
                .iter()
                .any(|&t| turn_between(t, stop.input).abs() < 1e-6);
        // another circuit may close there
        let beyond = circuit.input.distance(stop.input) > SAME_ROW;
        let Some(slope) = slope.or(gap.then_some(0.0)).filter(|_| !beyond) else {
            return row;
        };
        let follower = (!stop.at_limit && !gap)
            .then(|| pair.follower_taylor(driver, mode))
            .flatten();
        if let Some(follower) = follower {
            let (crank, rocker) = Self::in_loop_order(motion.input, driver, follower);
            let joints = self.joints(crank, rocker);
            row.joints = joints.map(|q| std::array::from_fn(|k| q.derivative(k)));
            row.status = RowStatus::Ok;
        } else {
            let angle = pair.angle(&reach, slope, mode);
            let (crank, rocker) = Self::in_loop_order(motion.input, stop.input, angle);
            let still = self.joints(Taylor::<1>::constant(crank), Taylor::constant(rocker));
            row.joints = still.map(|q| [q.value(), f64::NAN, f64::NAN, f64::NAN]);
            row.status = if gap {
                RowStatus::ChangePoint
            } else {
                RowStatus::DeadCentre
            };
        }
        if row.status == RowStatus::Ok && row.joints.iter().flatten().any(|x| x.is_nan()) {
            row.status = RowStatus::TurnsUndefined;
        }
        row.residual = self.residual(row.joints[0][0], row.joints[JOINT_COLUMNS - 1][0]);
        row
    }
}

fn driver_column(input: Input) -> usize {
    Rssr::in_loop_order(input, 0, JOINT_COLUMNS - 1).0
}

pub(super) fn follower_column(input: Input) -> usize {
    Rssr::in_loop_order(input, 0, JOINT_COLUMNS - 1).1
}

/// Up from the lower limit to the upper one, and back on the other branch.
fn rocking_stops(start: f64, end: f64, step: f64, samples: usize) -> Vec<Stop> {
    let slack = SAME_ROW * step;
    let first = ((start + slack) / step).ceil() as i64;
    let last = ((end - slack) / step).floor() as i64;
    let grid =
        |pass: usize| move |k: i64| Stop { input: TAU * k as f64 / samples as f64, pass, at_limit: false };
    let limit = |input: f64, pass: usize| Stop { input, pass, at_limit: true };
    let mut stops = vec![limit(start, 0)];
    stops.extend((first..=last).map(grid(0)));
    stops.push(limit(end, 1));
    stops.extend((first..=last).rev().map(grid(1)));
    stops
}

/// The follower's angle moved by whole turns so that it continues from the row before.
///
/// An output that rocks is placed in its range; one that turns is followed in steps short enough to be distinguished from a turn.
fn unwrap_follower(
    pair: &Pair,
    circuit: &Circuit,
    stop: Stop,
    angle: f64,
    previous: Option<(Stop, f64)>,
) -> f64 {
    if circuit.output != Extent::Full {
        return circuit.output.unwrap(angle);
    }
    let Some((last, before)) = previous else {
        return angle;
    };
    // between a row and the limit that follows it the circuit is still on the row's pass
    let solve = |x: f64| pair.follower(x, (branch_at(circuit, x) + last.pass) % 2);
    before + followed(&solve, (last.input, before), (stop.input, angle), 40)
}

/// The turn of the follower between two inputs, halving the way until each part is plainly less than half a turn.
fn followed(solve: &impl Fn(f64) -> Option<f64>, from: (f64, f64), to: (f64, f64), depth: usize) -> f64 {
    let turn = turn_between(from.1, to.1);
    if depth == 0 || (turn.abs() < 0.8 && (to.0 - from.0).abs() < 0.2) {
        return turn;
    }
    let middle = 0.5 * (from.0 + to.0);
    match solve(middle) {
        None => turn,
        Some(angle) => {
            followed(solve, from, (middle, angle), depth - 1)
                + followed(solve, (middle, angle), to, depth - 1)
        }
    }
}

/// Moves the turns of the balls by whole turns so that each row continues the one before.
fn unwrap_balls(rows: &mut [Row]) {
    for column in 1..JOINT_COLUMNS - 1 {
        let mut before: Option<f64> = None;
        for row in rows.iter_mut() {
            let angle = row.joints[column][0];
            if angle.is_finite() {
                let unwrapped = before.map_or(angle, |b| b + turn_between(b, angle));
                row.joints[column][0] = unwrapped;
                before = Some(unwrapped);
            }
        }
    }
}
