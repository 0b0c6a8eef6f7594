//! The measures of a loop's motion, without its rows: for many loops at once.

use super::motion::motion;
use crate::loops::description::described_loop::Loop;
use crate::outcome::CircuitMeasures;

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

/// The result of a loop.
#[derive(Clone, Debug)]
pub struct Measures {
    /// Whether there is a motion.
    pub driven: Driven,
    /// The circuits' common type or "mixed", or why there are none; empty where there is no motion.
    pub motion_type: &'static str,
    /// The circuits.
    pub circuits: Vec<CircuitMeasures>,
}

/// The measures of the motion over a column, with so many rows a turn, the input at a speed.
pub fn measures(linkage: &Loop, input: usize, output: usize, samples: usize, speed: f64) -> Measures {
    let none = |driven| Measures { driven, motion_type: "", circuits: Vec::new() };
    if !linkage.can_be_driven() {
        return none(Driven::ManyFreedoms);
    }
    let Some(motion) = motion(linkage, input, output, samples, speed, None, true) else {
        return none(Driven::NoInput);
    };
    if motion.motion_type == "two-inputs" {
        return none(Driven::ManyFreedoms);
    }
    Measures {
        driven: Driven::Yes,
        motion_type: motion.motion_type,
        circuits: motion.circuits.into_iter().map(|c| c.measures).collect(),
    }
}
