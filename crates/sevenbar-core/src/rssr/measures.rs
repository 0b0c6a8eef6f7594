//! What circuits are measured by, and the motions of many square-axis RSSRs as such numbers.

use super::circuits::{Row, follower_column};
use super::classify::{INVALID, MOST_LIMITS, columns_of_one_length, linkage, padded};
use super::domain::Extent;
use super::extremes::Extreme;
use super::linkage::Input;
use super::motion::{Circuit, Motion, MotionType};
use crate::error::Error;
use crate::outcome::{CircuitMeasures, DeadCentreKind, Ends};
use crate::parallel::in_order;
use std::f64::consts::PI;

/// The result of a motion.
#[derive(Clone, Debug)]
pub struct MotionMeasures {
    /// The motion type as a number, or [`INVALID`].
    pub motion_type: u8,
    /// Input dead centres in [0, 2 pi), rising, NaN after the last.
    pub limits: [f64; MOST_LIMITS],
    /// The measures of its circuits, in order.
    pub circuits: Vec<CircuitMeasures>,
}

/// The measures of each linkage's motion, from M, N, L1, L2, L3, D of the paper's square axes, the input of each
/// at its speed.
///
/// # Errors
/// [`Error::Lengths`] where the arrays are not of one length.
pub fn measure(
    dimensions: [&[f64]; 6],
    input: Input,
    speed: &[f64],
    threads: usize,
) -> Result<Vec<MotionMeasures>, Error> {
    let count = columns_of_one_length(dimensions)?;
    if speed.len() != count {
        return Err(Error::Lengths { what: "speed", got: speed.len(), want: count });
    }
    Ok(in_order(count, threads, |i| {
        linkage(dimensions.map(|column| column[i])).map_or(MotionMeasures::NONE, |linkage| {
            MotionMeasures::of(linkage.motion(input), speed[i])
        })
    }))
}

impl MotionMeasures {
    const NONE: Self = Self {
        motion_type: INVALID,
        limits: [f64::NAN; MOST_LIMITS],
        circuits: Vec::new(),
    };

    fn of(motion: Motion, speed: f64) -> Self {
        Self {
            motion_type: motion.motion_type as u8,
            limits: padded(&motion.limits),
            circuits: motion
                .circuits
                .into_iter()
                .map(|circuit| CircuitMeasures::from(circuit).at_speed(speed))
                .collect(),
        }
    }
}

impl From<Circuit> for CircuitMeasures {
    /// At unit speed of the input.
    fn from(circuit: Circuit) -> Self {
        Self {
            motion_type: circuit.motion_type.name(),
            closed: true,
            turns: circuit.turns,
            input: range(circuit.input),
            output: range(circuit.output),
            dead_centres: circuit.dead_centres,
            transmission: Some(ends(circuit.transmission)),
            rates: [circuit.velocity, circuit.acceleration, circuit.jerk].map(|rate| rate.map(ends)),
            output_unit: 1.0,
        }
    }
}

/// The measures of a circuit with its rows, at unit speed of the input: at a change point they alone tell in which turn the output
/// runs, between its dead centres.
pub fn measures_with_rows(circuit: Circuit, rows: &[Row], input: Input) -> CircuitMeasures {
    let followed = (circuit.motion_type == MotionType::ChangePoint).then(|| followed_range(rows, input));
    let mut measures = CircuitMeasures::from(circuit);
    if let Some(rows) = followed {
        measures.output = rows.map(|[low, high]| {
            let turn = Extent::Arc(low, high);
            let mut ends = [low, high];
            for dead_centre in &mut measures.dead_centres {
                dead_centre.output = turn.unwrap(dead_centre.output);
                // the rows pass by the end that it is
                if dead_centre.kind == DeadCentreKind::Output {
                    ends = [ends[0].min(dead_centre.output), ends[1].max(dead_centre.output)];
                }
            }
            ends
        });
    }
    measures
}

/// The range of an output as sampled along its circuit; `None` where it gains a turn.
fn followed_range(rows: &[Row], input: Input) -> Option<[f64; 2]> {
    let column = follower_column(input);
    let angles = || rows.iter().map(|row| row.joints[column][0]);
    let gained = angles().next_back()? - angles().next()?;
    (angles().all(f64::is_finite) && gained.abs() <= PI).then(|| {
        [
            angles().fold(f64::INFINITY, f64::min),
            angles().fold(f64::NEG_INFINITY, f64::max),
        ]
    })
}

fn range(extent: Extent) -> Option<[f64; 2]> {
    match extent {
        Extent::Full => None,
        Extent::Arc(start, end) => Some([start, end]),
    }
}

fn ends(extremes: [Extreme; 2]) -> Ends {
    extremes.map(|extreme| [extreme.value, extreme.input])
}
