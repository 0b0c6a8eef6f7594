//! The classes of geometry: which numbers of a closure's normal form are zero, or a quarter or half turn.
//!
//! A frame may stand anywhere on the axis of its turning joint, and anywhere at all beside a sliding one. Put where Denavit and
//! Hartenberg put it, the frames make parallel axes, axes that meet, offsets of nothing and right angles numbers of the form 0,
//! 1, -1, i or -i. All closures with the same such numbers are a class: a linear space of parameters, whose general member has
//! as many solutions as a closure of that geometry can have.
//!
//! Source: docs/theory.md, (6).

use crate::loops::equation::closure::{JOINTS, Parameters};
use crate::loops::equation::complex_frame::{Frame, NO_TWIST};
use crate::rigid::Pose;
use num_complex::Complex64;

/// Numbers of the form below this [rad, or relative to the size] are rounding. What lies farther off a class does not belong to it: it has
/// solutions near infinity that the class has not.
const ROUNDING: f64 = NO_TWIST;

/// Axes that are parallel but for less than this sine have their common normal far away: such a closure keeps the frames it has.
const LEAST_SINE: f64 = 0.01;

/// The same for frames that would be farther apart than this [share of the size].
const FARTHEST: f64 = 3.0;

/// Ways round the loop after which a frame moves no other.
const ROUNDS: usize = 2;

/// The links between the joints as `Rz(before) T(shift) Rx(twist) Rz(after)`, angles as `e^(i t)`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Form {
    pub before: [Complex64; JOINTS],
    pub shifts: [[f64; 3]; JOINTS],
    pub twists: [Complex64; JOINTS],
    pub after: [Complex64; JOINTS],
}

/// A turn that a class has fixed, in quarters; `None` where it may be any.
type Quarters = Option<u8>;

/// What the closures of a class have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Pattern {
    twists: [Quarters; JOINTS],
    /// The given turns of sliding joints.
    turns: [Quarters; JOINTS],
    /// Which parts of the shifts are not zero.
    shifts: [[bool; 3]; JOINTS],
    /// Whether the input slides, or does both.
    input_advances: bool,
}

impl Form {
    /// Of the transforms after the joints.
    pub fn of(transforms: [&Pose; JOINTS]) -> Self {
        let normal = transforms.map(|t| Frame::from_pose(t).normal_form());
        Self {
            before: std::array::from_fn(|i| normal[i].before),
            shifts: std::array::from_fn(|i| normal[i].shift.map(|x| x.re)),
            twists: std::array::from_fn(|i| normal[i].twist),
            after: std::array::from_fn(|i| normal[i].after),
        }
    }

    /// What each joint turns by in its zero.
    pub fn zeros(&self) -> [Complex64; JOINTS] {
        std::array::from_fn(|i| self.before[i] * self.after[(i + JOINTS - 1) % JOINTS])
    }

    /// The same closure with each frame where Denavit and Hartenberg have it, rounding taken off; `None` where that is far away.
    pub fn with_zeros(mut self, slides: &[bool; JOINTS]) -> Option<Self> {
        for _ in 0..ROUNDS {
            for link in 0..JOINTS {
                self.move_frame_after(link, slides)?;
            }
        }
        for (shift, twist) in self.shifts.iter_mut().zip(&mut self.twists) {
            for x in shift {
                *x = if x.abs() < ROUNDING { 0.0 } else { *x };
            }
            *twist = quarters(*twist).map_or(*twist, turn_of);
        }
        let near = |x: &f64| x.abs() < FARTHEST;
        self.shifts.as_flattened().iter().all(near).then_some(self)
    }

    /// Moves the frame at the end of a link: beside a slide into the one before, else along its axis.
    fn move_frame_after(&mut self, link: usize, slides: &[bool; JOINTS]) -> Option<()> {
        let next = (link + 1) % JOINTS;
        let (cosine, sine) = (self.twists[link].re, self.twists[link].im);
        let [x, y, z] = self.shifts[link];
        if slides[next] {
            // as the frame after the slide's turn has it
            let (y, z) = (y * cosine + z * sine, z * cosine - y * sine);
            let turn = self.after[link] * self.before[next];
            let moved = Complex64::new(x, y) * turn.conj();
            self.shifts[link] = [0.0; 3];
            for (shift, by) in self.shifts[next].iter_mut().zip([moved.re, moved.im, z]) {
                *shift += by;
            }
        } else if sine.abs() < NO_TWIST {
            // parallel: level with the frame before, and the split of the turns such that x leads to it
            let along = Complex64::new(x, y);
            self.shifts[link] = [along.norm(), 0.0, 0.0];
            self.shifts[next][2] += z * cosine.signum();
            if along.norm() >= ROUNDING {
                let turn = along / along.norm();
                self.before[link] *= turn;
                self.after[link] *= if cosine > 0.0 { turn.conj() } else { turn };
            }
        } else if sine.abs() < LEAST_SINE {
            return None;
        } else {
            let by = y / sine;
            self.shifts[link] = [x, 0.0, z + by * cosine];
            self.shifts[next][2] -= by;
        }
        Some(())
    }

    /// The class of a closure with these sliding joints.
    pub fn pattern(&self, slides: &[bool; JOINTS], input_advances: bool) -> Pattern {
        let zeros = self.zeros();
        Pattern {
            twists: self.twists.map(quarters),
            turns: std::array::from_fn(|i| slides[i].then(|| quarters(zeros[i])).flatten()),
            shifts: self.shifts.map(|s| s.map(|x| x != 0.0)),
            input_advances,
        }
    }
}

impl Pattern {
    /// Parameters of the class from parameters of any closure.
    pub fn imposed_on(&self, mut parameters: Parameters) -> Parameters {
        for i in 0..JOINTS {
            if let Some(n) = self.twists[i] {
                parameters.twists[i] = turn_of(n);
            }
            if let Some(n) = self.turns[i] {
                parameters.turns[i] = turn_of(n);
            }
            for (x, kept) in parameters.shifts[i].iter_mut().zip(self.shifts[i]) {
                if !kept {
                    *x = Complex64::ZERO;
                }
            }
        }
        if !self.input_advances {
            parameters.slide = Complex64::ZERO;
        }
        parameters
    }
}

/// The quarter turns that a turn is, up to rounding.
fn quarters(turn: Complex64) -> Quarters {
    (0..4).find(|&n| (turn - turn_of(n)).norm() < ROUNDING)
}

fn turn_of(quarters: u8) -> Complex64 {
    let (one, i) = (Complex64::ONE, Complex64::I);
    [one, i, -one, -i][usize::from(quarters % 4)]
}
