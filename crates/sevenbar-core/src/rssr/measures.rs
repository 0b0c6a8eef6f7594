//! Motions of many square-axis RSSRs as numbers: everything that a circuit is told by.

use super::classify::{INVALID, MOST_LIMITS, columns_of_one_length, linkage, padded};
use super::domain::Extent;
use super::extremes::Extreme;
use super::linkage::Input;
use super::motion::{Circuit, Motion};
use crate::error::Error;
use crate::outcome::DeadCentreKind;
use crate::sweep::in_order;

/// Lowest value, input there, highest value, input there; NaN where there are none.
pub type Ends = [f64; 4];

/// What a motion comes to.
#[derive(Clone, Debug)]
pub struct MotionMeasures {
    /// The motion type as a number, or [`INVALID`].
    pub motion_type: u8,
    /// Input dead centres in [0, 2 pi), rising, NaN after the last.
    pub limits: [f64; MOST_LIMITS],
    /// Those of its circuits, in order.
    pub circuits: Vec<CircuitMeasures>,
}

/// What a circuit comes to, at an input speed of 1.
#[derive(Clone, Copy, Debug)]
pub struct CircuitMeasures {
    /// The range of the input; NaN for a full turn.
    pub input_range: [f64; 2],
    /// The range of the output; NaN for a full turn, and at a change point.
    pub output_range: [f64; 2],
    /// Turns of the input until it closes on itself; 0 for one that rocks.
    pub turns: usize,
    /// The transmission angle.
    pub transmission: Ends,
    /// First, second and third derivative of output by input; NaN where they have no bound or a change point lies within.
    pub rates: [Ends; 3],
    /// The lowest and the highest output dead centre; NaN unless there are two.
    pub output_dead_centres: Ends,
}

/// What the motion of each linkage comes to, from M, N, L1, L2, L3, D of the paper's square axes.
///
/// # Errors
/// [`Error::Lengths`] where the arrays are not of one length.
pub fn measure(dimensions: [&[f64]; 6], input: Input, threads: usize) -> Result<Vec<MotionMeasures>, Error> {
    let count = columns_of_one_length(dimensions)?;
    Ok(in_order(count, threads, |i| {
        linkage(dimensions.map(|column| column[i])).map_or(MotionMeasures::NONE, |linkage| {
            MotionMeasures::of(&linkage.motion(input))
        })
    }))
}

impl MotionMeasures {
    const NONE: Self = Self {
        motion_type: INVALID,
        limits: [f64::NAN; MOST_LIMITS],
        circuits: Vec::new(),
    };

    fn of(motion: &Motion) -> Self {
        Self {
            motion_type: motion.motion_type as u8,
            limits: padded(&motion.limits),
            circuits: motion.circuits.iter().map(CircuitMeasures::of).collect(),
        }
    }
}

impl CircuitMeasures {
    fn of(circuit: &Circuit) -> Self {
        Self {
            input_range: range(circuit.input),
            output_range: range(circuit.output),
            turns: circuit.turns,
            transmission: ends(circuit.transmission),
            rates: [circuit.velocity, circuit.acceleration, circuit.jerk]
                .map(|rate| rate.map_or([f64::NAN; 4], ends)),
            output_dead_centres: output_dead_centres(circuit),
        }
    }
}

fn range(extent: Extent) -> [f64; 2] {
    match extent {
        Extent::Full => [f64::NAN; 2],
        Extent::Arc(start, end) => [start, end],
    }
}

fn ends([lowest, highest]: [Extreme; 2]) -> Ends {
    [lowest.value, lowest.input, highest.value, highest.input]
}

/// Where the output of a circuit turns back, at the lowest and at the highest; of equal ones the first.
fn output_dead_centres(circuit: &Circuit) -> Ends {
    let mut found = circuit
        .dead_centres
        .iter()
        .filter(|d| d.kind == DeadCentreKind::Output)
        .map(|d| [d.output, d.input]);
    let (Some(first), Some(second)) = (found.next(), found.next()) else {
        return [f64::NAN; 4];
    };
    let (mut lowest, mut highest) = (first, first);
    for end in std::iter::once(second).chain(found) {
        lowest = if end[0] < lowest[0] { end } else { lowest };
        highest = if end[0] > highest[0] { end } else { highest };
    }
    [lowest[0], lowest[1], highest[0], highest[1]]
}
