//! The classes of geometry: which numbers of a closure's normal form are zero, or a quarter or half turn.
//!
//! The frame of a turning joint may be placed anywhere along its axis, that of a sliding joint anywhere. If frames are placed as Denavit
//! and Hartenberg place them, parallel and intersecting axes, zero offsets and right angles turn into numbers 0, 1, -1, i or -i of the
//! normal form. All closures with the same such numbers form a class: a linear space of parameters, whose general member has as many
//! solutions as a closure of that geometry can have.
//!
//! Source: docs/theory.md, (6).

use crate::loops::equation::closure::{JOINTS, Parameters};
use crate::loops::equation::complex_frame::{Frame, NO_TWIST};
use crate::rigid::Pose;
use num_complex::Complex64;

/// Numbers of the form below this [rad, or relative to the size] are rounding. A closure farther off a class does not belong to it: it has
/// solutions near infinity that the class lacks.
const ROUNDING: f64 = NO_TWIST;

/// Axes at an angle with a smaller sine are nearly parallel and have their common normal far away. Such a closure keeps its frames.
const LEAST_SINE: f64 = 0.01;

/// A closure also keeps its frames if they would be farther apart than this [relative to the size].
const FARTHEST: f64 = 3.0;

/// Rounds of the loop until all frames are placed: moving a frame changes the links on both sides of it, and the second round settles
/// what the first one changed.
const ROUNDS: usize = 2;

/// The links between the joints as `Rz(before) T(shift) Rx(twist) Rz(after)`, angles as `e^(i t)`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Form {
    pub before: [Complex64; JOINTS],
    pub shifts: [[f64; 3]; JOINTS],
    pub twists: [Complex64; JOINTS],
    pub after: [Complex64; JOINTS],
}

/// A turn that a class fixes, in quarter turns; `None` if the class leaves it free.
type Quarters = Option<u8>;

/// The numbers of the normal form that the closures of a class share.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Pattern {
    twists: [Quarters; JOINTS],
    /// The fixed turns of sliding joints.
    turns: [Quarters; JOINTS],
    /// Which components of the shifts are not zero.
    shifts: [[bool; 3]; JOINTS],
    /// Whether the input advances: a slide, or a screw.
    input_advances: bool,
}

impl Form {
    /// From the fixed transforms after the joints.
    pub fn of(transforms: [&Pose; JOINTS]) -> Self {
        let normal = transforms.map(|t| Frame::from_pose(t).normal_form());
        Self {
            before: std::array::from_fn(|i| normal[i].before),
            shifts: std::array::from_fn(|i| normal[i].shift.map(|x| x.re)),
            twists: std::array::from_fn(|i| normal[i].twist),
            after: std::array::from_fn(|i| normal[i].after),
        }
    }

    /// The angle, as `e^(i t)`, that the form adds to each joint's own value.
    pub fn zeros(&self) -> [Complex64; JOINTS] {
        std::array::from_fn(|i| self.before[i] * self.after[(i + JOINTS - 1) % JOINTS])
    }

    /// The same closure with each frame where Denavit and Hartenberg place it, and rounded numbers made exact, except links that may be any;
    /// `None` if that is far away.
    pub fn with_zeros(mut self, slides: &[bool; JOINTS], any: &[bool; JOINTS]) -> Option<Self> {
        for _ in 0..ROUNDS {
            for link in 0..JOINTS {
                let next = (link + 1) % JOINTS;
                if !(any[link] || slides[next] && any[next]) {
                    self.move_frame_after(link, slides)?;
                }
            }
        }
        let links = self.shifts.iter_mut().zip(&mut self.twists);
        for ((shift, twist), _) in links.zip(any).filter(|(_, any)| !**any) {
            for x in shift {
                *x = if x.abs() < ROUNDING { 0.0 } else { *x };
            }
            *twist = quarters(*twist).map_or(*twist, turn_of);
        }
        let near = |x: &f64| x.abs() < FARTHEST;
        self.shifts.as_flattened().iter().all(near).then_some(self)
    }

    /// Moves the frame at the end of a link: before a slide onto the link's first frame, otherwise along its joint's axis. `None` if it
    /// would move far away.
    fn move_frame_after(&mut self, link: usize, slides: &[bool; JOINTS]) -> Option<()> {
        let next = (link + 1) % JOINTS;
        let (cosine, sine) = (self.twists[link].re, self.twists[link].im);
        let [x, y, z] = self.shifts[link];
        if slides[next] {
            // in the axes of the frame after the slide's turn
            let (y, z) = (y * cosine + z * sine, z * cosine - y * sine);
            let turn = self.after[link] * self.before[next];
            let moved = Complex64::new(x, y) * turn.conj();
            self.shifts[link] = [0.0; 3];
            for (shift, by) in self.shifts[next].iter_mut().zip([moved.re, moved.im, z]) {
                *shift += by;
            }
        } else if sine.abs() < NO_TWIST {
            // parallel axes: no offset between the frames, and x along their common normal
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

    /// The class of a closure, given which joints slide, and which links may be any.
    pub fn pattern(&self, slides: &[bool; JOINTS], any: &[bool; JOINTS], input_advances: bool) -> Pattern {
        let zeros = self.zeros();
        let fixed = |i: usize| slides[i] && !any[i] && !any[(i + JOINTS - 1) % JOINTS];
        let quarters_unless = |any: bool, turn: Complex64| if any { None } else { quarters(turn) };
        Pattern {
            twists: std::array::from_fn(|i| quarters_unless(any[i], self.twists[i])),
            turns: std::array::from_fn(|i| quarters_unless(!fixed(i), zeros[i])),
            shifts: std::array::from_fn(|i| self.shifts[i].map(|x| any[i] || x != 0.0)),
            input_advances,
        }
    }
}

impl Pattern {
    /// Parameters of any closure with the numbers of the class put in their places.
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

/// How many quarter turns a turn is, if it is a whole number of them up to rounding.
fn quarters(turn: Complex64) -> Quarters {
    (0..4).find(|&n| (turn - turn_of(n)).norm() < ROUNDING)
}

fn turn_of(quarters: u8) -> Complex64 {
    let (one, i) = (Complex64::ONE, Complex64::I);
    [one, i, -one, -i][usize::from(quarters % 4)]
}
