//! The whole motion of an RSSR: where it can go, its circuits, its motion type, and its dead centres.

use super::domain::{Domain, Extent, turn_between};
use super::extremes::{Extreme, rate_extremes, transmission_extremes};
use super::linkage::{Input, Rssr};
use super::pair::Pair;
use crate::outcome::{DeadCentre, DeadCentreKind};
use crate::trigonometric::within_turn;
use std::f64::consts::TAU;

/// What input and output can do; as numbers they are the codes of a batch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum MotionType {
    /// The input turns fully, the output rocks.
    CrankRocker = 0,
    /// The input rocks, the output turns fully.
    RockerCrank = 1,
    /// Both turn fully.
    DoubleCrank = 2,
    /// Both rock.
    DoubleRocker = 3,
    /// Two limits meet, or nearly do: the least change of a dimension decides.
    ChangePoint = 4,
    /// No input closes the loop.
    CannotAssemble = 5,
}

impl MotionType {
    /// The name in the field's words.
    pub fn name(self) -> &'static str {
        match self {
            Self::CrankRocker => "crank-rocker",
            Self::RockerCrank => "rocker-crank",
            Self::DoubleCrank => "double-crank",
            Self::DoubleRocker => "double-rocker",
            Self::ChangePoint => "change-point",
            Self::CannotAssemble => "cannot-assemble",
        }
    }
}

/// One connected motion.
#[derive(Clone, Debug)]
pub struct Circuit {
    /// Its own type.
    pub motion_type: MotionType,
    /// The range of the input.
    pub input: Extent,
    /// The range of the output, in the turn in which the circuit's first row lies; `Full` at a change point, where only
    /// following the circuit shows it.
    pub output: Extent,
    /// The branch of the closed form on the first pass.
    pub first_branch: usize,
    /// Change points within: angles of the input where the circuit goes over to the other branch, rising.
    pub touches: Vec<f64>,
    /// Turns of the input until it closes on itself; 0 for one that rocks.
    pub turns: usize,
    /// Dead centres: those of the input first, then those of the output by input angle.
    pub dead_centres: Vec<DeadCentre>,
    /// The least and the greatest transmission angle.
    pub transmission: [Extreme; 2],
    /// Lowest and highest d(output)/d(input); `None` where there is no bound or a change point lies within.
    pub velocity: Option<[Extreme; 2]>,
    /// Lowest and highest second derivative of output by input.
    pub acceleration: Option<[Extreme; 2]>,
    /// Lowest and highest third derivative of output by input.
    pub jerk: Option<[Extreme; 2]>,
}

/// All circuits of a linkage for one choice of input.
#[derive(Clone, Debug)]
pub struct Motion {
    /// Which joint drives.
    pub input: Input,
    /// The type that the circuits share.
    pub motion_type: MotionType,
    /// Input dead centres in [0, 2 pi), rising.
    pub limits: Vec<f64>,
    /// Input angles at which two limits meet or nearly meet.
    pub change_points: Vec<f64>,
    /// The circuits: by branch for a full turn, by their first input otherwise.
    pub circuits: Vec<Circuit>,
}

impl Rssr {
    /// The motion type from the number of extents of input and output, each counted from its own quartic.
    ///
    /// On the torus of both angles each input has at most two outputs and each output at most two inputs. A circuit on
    /// which an angle rocks has therefore exactly two limits of that angle, and one on which it turns uses up one of the two
    /// solutions everywhere. So the only counts are: both full; one full and the other two arcs; as many arcs as arcs. Any
    /// other pair of counts is a change point that rounding has torn open.
    fn motion_type(input: &Domain, output: &Domain) -> MotionType {
        if input.degenerate || output.degenerate {
            return MotionType::ChangePoint;
        }
        match (input.turns_fully(), output.turns_fully()) {
            (true, true) => MotionType::DoubleCrank,
            (true, false) if output.extents.len() == 2 => MotionType::CrankRocker,
            (false, true) if input.extents.len() == 2 => MotionType::RockerCrank,
            (false, false) if input.extents.is_empty() && output.extents.is_empty() => {
                MotionType::CannotAssemble
            }
            (false, false) if input.extents.len() == output.extents.len() => MotionType::DoubleRocker,
            _ => MotionType::ChangePoint,
        }
    }

    /// From input to output, and back.
    fn pairs(&self, input: Input) -> [Pair; 2] {
        let output = match input {
            Input::Crank => Input::Rocker,
            Input::Rocker => Input::Crank,
        };
        [self.pair(input), self.pair(output)]
    }

    /// The motion type and the input dead centres alone.
    pub(crate) fn type_and_limits(&self, input: Input) -> (MotionType, Vec<f64>) {
        let [forward, backward] = self.pairs(input);
        let (inputs, outputs) = (Domain::new(&forward), Domain::new(&backward));
        (Self::motion_type(&inputs, &outputs), inputs.limits)
    }

    /// Every circuit, with its dead centres and measures.
    pub fn motion(&self, input: Input) -> Motion {
        let [forward, backward] = self.pairs(input);
        let (inputs, outputs) = (Domain::new(&forward), Domain::new(&backward));
        let motion_type = Self::motion_type(&inputs, &outputs);

        let mut circuits = Vec::new();
        for extent in &inputs.extents {
            let touches: Vec<f64> = match *extent {
                Extent::Full => inputs.touches.clone(),
                Extent::Arc(start, _) => {
                    let mut inside: Vec<f64> = inputs
                        .touches
                        .iter()
                        .filter(|&&t| extent.distance(t) == 0.0)
                        .map(|&t| start + within_turn(t - start))
                        .collect();
                    inside.sort_by(f64::total_cmp);
                    inside
                }
            };
            let full = *extent == Extent::Full;
            let turns = if full { 1 + touches.len() % 2 } else { 0 };
            let branches = if turns == 1 { 2 } else { 1 };
            for first_branch in 0..branches {
                circuits.push(circuit(
                    &forward,
                    &outputs,
                    Circuit {
                        motion_type,
                        input: *extent,
                        output: Extent::Full,
                        first_branch,
                        touches: touches.clone(),
                        turns,
                        dead_centres: Vec::new(),
                        transmission: transmission_extremes(&forward, *extent, first_branch),
                        velocity: None,
                        acceleration: None,
                        jerk: None,
                    },
                ));
            }
        }
        place_output_dead_centres(&mut circuits, &forward, &backward, &outputs);
        // where only the output's limits come so near, the place is known by the output
        let mut change_points = inputs.change_points;
        if change_points.is_empty() {
            let input_at = |&output: &f64| within_turn(backward.angle(&backward.reach(output), 0.0, 0));
            change_points = outputs.change_points.iter().map(input_at).collect();
            change_points.sort_by(f64::total_cmp);
        }
        Motion { input, motion_type, limits: inputs.limits, change_points, circuits }
    }
}

/// Completes a circuit: the range of its output, its input dead centres, its rates' extremes.
fn circuit(forward: &Pair, outputs: &Domain, mut circuit: Circuit) -> Circuit {
    let first = match circuit.input {
        Extent::Full => 0.0,
        Extent::Arc(start, _) => start,
    };
    let inside = match circuit.input {
        Extent::Full => first,
        Extent::Arc(start, end) => 0.5 * (start + end),
    };
    let output_at = |driver: f64| {
        let reach = forward.reach(driver);
        forward.angle(&reach, reach.slope.unwrap_or(0.0), circuit.first_branch)
    };
    let nearest = outputs.extents.iter().min_by(|a, b| {
        a.distance(output_at(inside))
            .total_cmp(&b.distance(output_at(inside)))
    });
    // at a change point the ranges of two circuits run together, so the output is followed instead of placed
    if circuit.motion_type != MotionType::ChangePoint {
        circuit.output = nearest.map_or(Extent::Full, |e| e.holding(output_at(first)));
    }
    if let Extent::Arc(start, end) = circuit.input {
        for (branch, driver) in [start, end].into_iter().enumerate() {
            let reach = forward.reach(driver);
            let output = forward.angle(&reach, 0.0, circuit.first_branch);
            circuit.dead_centres.push(DeadCentre {
                kind: DeadCentreKind::Input,
                input: driver,
                output: circuit.output.unwrap(output),
                branch,
                condition: condition(forward, driver),
            });
        }
    } else if circuit.motion_type != MotionType::ChangePoint {
        [circuit.velocity, circuit.acceleration, circuit.jerk] =
            rate_extremes(forward, circuit.first_branch).map_or([None; 3], |rates| rates.map(Some));
    }
    circuit
}

/// Gives every output dead centre to the circuit that passes through it.
fn place_output_dead_centres(circuits: &mut [Circuit], forward: &Pair, backward: &Pair, outputs: &Domain) {
    for &output in &outputs.limits {
        let input = within_turn(backward.angle(&backward.reach(output), 0.0, 0));
        let reach = forward.reach(input);
        let slope = reach.slope.unwrap_or(0.0);
        let [d0, d1] = [0, 1].map(|b| turn_between(forward.angle(&reach, slope, b), output).abs());
        let branch = usize::from(d1 < d0);
        let home = circuits.iter_mut().min_by(|a, b| {
            let apart = |c: &Circuit| match c.input {
                Extent::Full if c.turns == 1 && branch_at(c, input) != branch => f64::INFINITY,
                extent => extent.distance(input),
            };
            apart(a).total_cmp(&apart(b))
        });
        if let Some(circuit) = home {
            let (input, pass) = match circuit.input {
                Extent::Full => (input, 0),
                Extent::Arc(start, _) => (
                    start + within_turn(input - start),
                    usize::from(branch_at(circuit, input) != branch),
                ),
            };
            circuit.dead_centres.push(DeadCentre {
                kind: DeadCentreKind::Output,
                input,
                output: circuit.output.unwrap(output),
                branch: pass,
                condition: condition(backward, output),
            });
        }
    }
    for circuit in circuits {
        circuit.dead_centres.sort_by(|a, b| {
            let rank = |d: &DeadCentre| (d.kind == DeadCentreKind::Output, d.input);
            rank(a).partial_cmp(&rank(b)).unwrap_or(std::cmp::Ordering::Equal)
        });
    }
}

/// The branch of the closed form that a circuit's first pass follows at an input: each change point swaps it.
pub(super) fn branch_at(circuit: &Circuit, input: f64) -> usize {
    let start = match circuit.input {
        Extent::Full => 0.0,
        Extent::Arc(start, _) => start,
    };
    let turns = ((input - start) / TAU).floor();
    let here = input - turns * TAU;
    let passed = circuit.touches.iter().filter(|&&t| t <= here).count();
    let whole = circuit.touches.len() * (turns.rem_euclid(2.0) as usize);
    (circuit.first_branch + passed + whole) % 2
}

/// The condition number of a limit: the sum of the discriminant's terms over its slope there.
fn condition(pair: &Pair, driver: f64) -> f64 {
    let terms = pair.discriminant_noise() / (8.0 * f64::EPSILON);
    (terms / pair.discriminant().derivative().value(driver)).abs()
}
