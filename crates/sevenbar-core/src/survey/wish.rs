//! What is wanted of the linkages of a survey: readings of the output, or a swing; and what must hold.

use crate::rigid::Vec3;
use std::f64::consts::TAU;

/// Places of a turn at which readings may start, and samples of the output at most.
const STARTS: usize = 48;
const MOST_SAMPLES: usize = 160;
const FEWEST_STARTS: usize = 8;

/// How far steps of readings may differ to count as even [rad].
const EVEN: f64 = 1e-12;

/// What is wanted.
#[derive(Clone, Debug)]
pub enum Want {
    /// Readings of the output at those of the input, the zeros of both free.
    Readings(Readings),
    /// A crank-rocker whose output swings so far, with so much of the input's turn for the slower stroke.
    Swing {
        /// How far the output goes.
        angle: f64,
        /// The input's turn on the slower stroke.
        slow: f64,
    },
}

/// Readings of input and output, and where on the turn they are tried.
#[derive(Clone, Debug)]
pub struct Readings {
    /// Of the output, from the first.
    pub(super) output: Vec<f64>,
    /// Inputs, from the linkage's own start, at which the output is computed.
    pub(super) samples: Vec<f64>,
    /// The first sample of each start.
    pub(super) first: Vec<usize>,
    /// The distance of two starts.
    pub(super) between: f64,
    /// Whether only the first and the last output count.
    pub(super) ends_only: bool,
    /// Whether the output must move one way.
    pub(super) monotone: bool,
}

impl Readings {
    /// From readings of the input that rise by less than a turn, and those of the output.
    pub fn new(input: &[f64], output: &[f64], ends_only: bool, monotone: bool) -> Self {
        let count = input.len();
        let span = input[count - 1] - input[0];
        let step = span / (count - 1) as f64;
        let even = input
            .iter()
            .enumerate()
            .all(|(k, x)| (x - input[0] - step * k as f64).abs() < EVEN);
        let whole = (TAU / step).floor() as usize;
        let (samples, first, between) = if even && whole + count <= MOST_SAMPLES && whole >= FEWEST_STARTS {
            // starts share their samples
            let stride = whole.div_ceil(STARTS);
            let starts: Vec<usize> = (0..whole).step_by(stride).collect();
            let samples = (0..whole + count).map(|k| step * k as f64).collect();
            (samples, starts, stride as f64 * step)
        } else {
            let starts = (MOST_SAMPLES / count).clamp(FEWEST_STARTS, STARTS);
            let between = TAU / starts as f64;
            let place = |i: usize| input.iter().map(move |x| between * i as f64 + x - input[0]);
            let samples = (0..starts).flat_map(place).collect();
            (samples, (0..starts).map(|i| i * count).collect(), between)
        };
        Self {
            output: output.iter().map(|y| y - output[0]).collect(),
            samples,
            first,
            between,
            ends_only,
            monotone,
        }
    }
}

/// By what the linkages that do it are ranked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rank {
    /// The least error.
    Error,
    /// The greatest least transmission angle.
    Transmission,
    /// The least angle of the ball that turns most.
    Cone,
}

/// What is wanted, what must hold, and how that is ranked.
#[derive(Clone, Debug)]
pub struct Wish {
    /// What is wanted.
    pub want: Want,
    /// The greatest error [rad].
    pub tolerance: f64,
    /// The motion type as a number; any where there is none.
    pub motion_type: Option<u8>,
    /// The longest length over the shortest link, at most.
    pub ratio: f64,
    /// The least transmission angle [rad].
    pub transmission: f64,
    /// The greatest angle of each ball from its seat [rad].
    pub cones: [f64; 2],
    /// The seats in the frames of crank and rocker (outwards, the way the ball moves, along the axis); the best where there is none.
    pub seats: [Option<Vec3>; 2],
    /// How they are ranked.
    pub rank: Rank,
}
