//! What the motion of a loop comes to in numbers, without its rows: for many loops at once.

use super::description::Loop;
use super::extremes::Ends;
use super::modes::Completeness;
use super::motion::{self, Circuit, Motion};
use crate::outcome::{DeadCentre, DeadCentreKind, RowStatus};

/// Whether there is a motion to be measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Driven {
    /// Yes, or it is known that no pose closes or moves.
    Yes = 0,
    /// The input or the output is no joint of one freedom that moves.
    NoInput = 1,
    /// More freedoms remain than one input drives.
    ManyFreedoms = 2,
}

/// What a loop comes to.
#[derive(Clone, Debug)]
pub struct Measures {
    /// Whether there is a motion.
    pub driven: Driven,
    /// Rank of the joints' screws; `None` where no pose was found.
    pub rank: Option<usize>,
    /// Freedoms of the motion.
    pub finite: Option<usize>,
    /// How completely the modes at the seeds are known.
    pub completeness: Completeness,
    /// Modes at the seeds from which no motion could be followed.
    pub still: usize,
    /// Whether some circuit has the input at rest.
    pub input_rests: bool,
    /// Assembly modes at the input zero; `None` for an input that does not turn.
    pub modes: Option<usize>,
    /// The circuits.
    pub circuits: Vec<CircuitMeasures>,
}

/// What a circuit comes to, the input at unit speed; NaN where there is nothing.
#[derive(Clone, Debug)]
pub struct CircuitMeasures {
    /// Whether it comes back to its first pose.
    pub closed: bool,
    /// Whether it ends where it is not smooth.
    pub singular: bool,
    /// Turns that the input gains until it closes, be it with dead centres on the way; none where it rocks.
    pub turns: usize,
    /// Ranges of input and output; NaN for a joint that turns fully.
    pub input: [f64; 2],
    /// The output's.
    pub output: [f64; 2],
    /// The lowest and highest velocity, acceleration and jerk of the output, each with the input there.
    pub rates: [[f64; 4]; 3],
    /// The lowest and highest output of its dead centres, each with the input there.
    pub output_dead_centres: [f64; 4],
    /// Input and output where the input stands still.
    pub input_dead_centres: Vec<[f64; 2]>,
    /// The greatest closure error of the rows [length].
    pub residual: f64,
    /// The greatest condition number of a row's Jacobian, rows at dead centres aside.
    pub condition: f64,
}

/// What the motion over a column comes to, with so many rows a turn.
pub fn measures(linkage: &Loop, input: usize, output: usize, samples: usize) -> Measures {
    let driven = |driven| Measures {
        driven,
        rank: None,
        finite: None,
        completeness: Completeness::Searched,
        still: 0,
        input_rests: false,
        modes: None,
        circuits: Vec::new(),
    };
    if !linkage.can_be_driven() {
        return driven(Driven::ManyFreedoms);
    }
    match motion::motion(linkage, input, output, samples, 1.0, None) {
        Some(motion) => measured(linkage, &motion),
        None => driven(Driven::NoInput),
    }
}

fn measured(linkage: &Loop, motion: &Motion) -> Measures {
    let finite = motion.found.as_ref().map(|f| f.finite);
    let many = motion.circuits.is_empty() && finite.is_some_and(|f| f > 1);
    Measures {
        driven: if many { Driven::ManyFreedoms } else { Driven::Yes },
        rank: motion.found.as_ref().map(|f| f.rank),
        finite,
        completeness: motion.completeness,
        still: motion.still,
        input_rests: motion.input_rests,
        modes: motion.modes_at_zero,
        circuits: motion
            .circuits
            .iter()
            .map(|c| circuit_measures(linkage, c))
            .collect(),
    }
}

fn circuit_measures(linkage: &Loop, circuit: &Circuit) -> CircuitMeasures {
    let rows = &circuit.rows.rows;
    let ok = || rows.iter().filter(|r| r.status == RowStatus::Ok);
    CircuitMeasures {
        closed: circuit.closed,
        singular: circuit.singular,
        turns: circuit.turns,
        input: circuit.input.unwrap_or([f64::NAN; 2]),
        output: circuit.output.unwrap_or([f64::NAN; 2]),
        rates: circuit.extremes.map(flat),
        output_dead_centres: if circuit.output.is_some() {
            lowest_and_highest(&circuit.dead_centres)
        } else {
            [f64::NAN; 4]
        },
        input_dead_centres: circuit
            .dead_centres
            .iter()
            .filter(|d| d.kind == DeadCentreKind::Input)
            .map(|d| [d.input, d.output])
            .collect(),
        // the greatest number, of which one that is none is not one
        residual: rows.iter().map(|r| r.residual).fold(f64::NAN, f64::max) * linkage.size(),
        condition: ok().map(|r| r.condition).fold(f64::NAN, f64::max),
    }
}

fn flat(ends: Option<Ends>) -> [f64; 4] {
    ends.map_or([f64::NAN; 4], |[low, high]| [low[0], low[1], high[0], high[1]])
}

/// The lowest and the highest output among two or more of its dead centres, the first of equals.
fn lowest_and_highest(dead_centres: &[DeadCentre]) -> [f64; 4] {
    let mut ends: Option<(DeadCentre, DeadCentre)> = None;
    let mut count = 0;
    for d in dead_centres.iter().filter(|d| d.kind == DeadCentreKind::Output) {
        count += 1;
        let (low, high) = ends.get_or_insert((*d, *d));
        if d.output < low.output {
            *low = *d;
        }
        if d.output > high.output {
            *high = *d;
        }
    }
    match ends {
        Some((low, high)) if count > 1 => [low.output, low.input, high.output, high.input],
        _ => [f64::NAN; 4],
    }
}
