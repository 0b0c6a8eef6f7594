//! What both solvers say of a circuit: its rows, its dead centres, and what it is measured by.

use std::f64::consts::TAU;

/// What a row holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum RowStatus {
    /// Everything.
    Ok = 0,
    /// The pose; no rates, the input stands at a dead centre.
    DeadCentre = 1,
    /// The pose; no rates, two branches cross here.
    ChangePoint = 2,
    /// Nothing: the input is beyond a limit.
    NoSolution = 3,
    /// All but the turns of a ball, which this pose does not determine.
    TurnsUndefined = 4,
}

impl RowStatus {
    /// How many there are.
    pub const COUNT: usize = 5;

    /// The status of a number.
    pub fn numbered(number: f64) -> Option<Self> {
        [
            Self::Ok,
            Self::DeadCentre,
            Self::ChangePoint,
            Self::NoSolution,
            Self::TurnsUndefined,
        ]
        .into_iter()
        .find(|&status| f64::from(status as u8) == number)
    }
}

/// Which joint stands still at a dead centre.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DeadCentreKind {
    /// The input can go no further; rates per input grow without bound.
    Input,
    /// The output turns back.
    Output,
}

impl DeadCentreKind {
    /// The word for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Input => "input",
            Self::Output => "output",
        }
    }
}

/// A dead centre of a circuit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeadCentre {
    /// Whose it is.
    pub kind: DeadCentreKind,
    /// The input's value.
    pub input: f64,
    /// The output's value.
    pub output: f64,
    /// The pass between input dead centres on which it lies; for one of the input the pass that starts there.
    pub branch: usize,
    /// How ill its place is conditioned: for the RSSR, how much a relative change of the squared dimensions is magnified in it; else
    /// the norm of the inverse of the bordered Jacobian.
    pub condition: f64,
}

/// The least and the greatest value of a quantity, each with the input there.
pub type Ends = [[f64; 2]; 2];

/// What a joint does on a circuit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// It turns fully.
    Crank,
    /// It turns to and fro.
    Rocker,
    /// It slides.
    Slider,
    /// It turns without end, and the loop never comes back.
    Spindle,
}

impl Role {
    /// The motion type of a circuit whose input and output do this.
    pub fn pair(input: Self, output: Self) -> &'static str {
        use Role::{Crank, Rocker, Slider, Spindle};
        match (input, output) {
            (Crank, Crank) => "double-crank",
            (Crank, Rocker) => "crank-rocker",
            (Crank, Slider) => "crank-slider",
            (Crank, Spindle) => "crank-spindle",
            (Rocker, Crank) => "rocker-crank",
            (Rocker, Rocker) => "double-rocker",
            (Rocker, Slider) => "rocker-slider",
            (Rocker, Spindle) => "rocker-spindle",
            (Slider, Crank) => "slider-crank",
            (Slider, Rocker) => "slider-rocker",
            (Slider, Slider) => "double-slider",
            (Slider, Spindle) => "slider-spindle",
            (Spindle, Crank) => "spindle-crank",
            (Spindle, Rocker) => "spindle-rocker",
            (Spindle, Slider) => "spindle-slider",
            (Spindle, Spindle) => "double-spindle",
        }
    }
}

/// Extremes of the output [rad, or relative to the size] that differ by less differ by rounding.
const ALIKE: f64 = 1e-9;

/// Inputs with a smaller sine of half their difference are one.
const SAME_INPUT: f64 = 1e-7;

/// What a circuit is measured by, whichever solver found it.
#[derive(Clone, Debug)]
pub struct CircuitMeasures {
    /// How input and output move; "change-point" where it is not smooth.
    pub motion_type: &'static str,
    /// Whether it comes back to its first pose.
    pub closed: bool,
    /// Turns that the input gains until it closes, be it with dead centres on the way; none where it rocks.
    pub turns: usize,
    /// The range of the input; `None` for one that turns fully.
    pub input: Option<[f64; 2]>,
    /// The range of the output; `None` for one that turns fully.
    pub output: Option<[f64; 2]>,
    /// Those of input and output.
    pub dead_centres: Vec<DeadCentre>,
    /// The transmission angle, where it is defined.
    pub transmission: Option<Ends>,
    /// Velocity, acceleration and jerk of the output; `None` where they have no bound or the circuit is not smooth.
    pub rates: [Option<Ends>; 3],
    /// That of which differences of the output are parts: 1 for an angle, the linkage's size for a slide.
    pub output_unit: f64,
}

impl CircuitMeasures {
    /// The same at another speed of the input, from that at unit speed.
    pub fn at_speed(mut self, speed: f64) -> Self {
        let mut factor = 1.0;
        for ends in &mut self.rates {
            factor *= speed;
            if let Some(ends) = ends {
                *ends = ends.map(|[value, at]| [factor * value, at]);
                if ends[1] < ends[0] {
                    ends.swap(0, 1);
                }
            }
        }
        self
    }

    /// Whether the input has dead centres.
    pub fn turns_back(&self) -> bool {
        self.dead_centres.iter().any(|d| d.kind == DeadCentreKind::Input)
    }

    /// The lowest and the highest output dead centre, of equal ones the first; `None` for an output that turns fully, and where
    /// there are not two.
    pub fn angle(&self) -> Option<Ends> {
        self.output?;
        let outputs = self
            .dead_centres
            .iter()
            .filter(|d| d.kind == DeadCentreKind::Output);
        let mut ends = outputs.map(|d| [d.output, d.input]);
        let (first, second) = (ends.next()?, ends.next()?);
        let (mut lowest, mut highest) = (first, first);
        for end in std::iter::once(second).chain(ends) {
            lowest = if end[0] < lowest[0] { end } else { lowest };
            highest = if end[0] > highest[0] { end } else { highest };
        }
        Some([lowest, highest])
    }

    /// How far the output goes; `None` for one that turns fully.
    pub fn swing(&self) -> Option<f64> {
        self.output.map(|[low, high]| high - low)
    }

    /// Whether the input turns fully and never back.
    fn goes_round(&self) -> bool {
        self.closed && self.input.is_none() && !self.turns_back()
    }

    /// Whether the output is at its highest, or lowest, at several inputs: more than two strokes.
    pub fn many_strokes(&self) -> bool {
        let Some(ends) = self.angle().filter(|_| self.goes_round()) else {
            return false;
        };
        ends.iter().any(|[end, at]| {
            let elsewhere = |d: &DeadCentre| (0.5 * (d.input - at)).sin().abs() > SAME_INPUT;
            let alike = |d: &DeadCentre| (d.output - end).abs() < ALIKE * self.output_unit;
            let mut outputs = self
                .dead_centres
                .iter()
                .filter(|d| d.kind == DeadCentreKind::Output);
            outputs.any(|d| alike(d) && elsewhere(d))
        })
    }

    /// Time of the slower stroke of the output over that of the quicker, for an input that turns fully and never back; `None` also
    /// where both ends of the output are at one input, a stroke without time, and where more than two strokes leave open which count. A
    /// circuit may take several turns of the input.
    pub fn time_ratio(&self) -> Option<f64> {
        let [low, high] = self
            .angle()
            .filter(|_| self.goes_round() && !self.many_strokes())?;
        let round = TAU * self.turns.max(1) as f64;
        let stroke = (high[1] - low[1]).rem_euclid(round);
        let (slower, quicker) = (stroke.max(round - stroke), stroke.min(round - stroke));
        (quicker > 0.0).then_some(slower / quicker)
    }
}
