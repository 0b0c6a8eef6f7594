//! How a loop follows the numbers of its description: a dimension is a joint that is held.
//!
//! The loop `F0 Z1 F1 .. Zn Fn = 1` has joints Z and fixed transforms F, and a number that changes moves all behind an F by a
//! twist, as a joint there would. With S the screws of the joints and B those of one number p, in the order of the loop, u the
//! rates of the joints by the input, V the twist of what lies before a joint, all power series along the input, and D the
//! derivative by p,
//!
//! `A Dq = -sum B`, `DS_0 = [Vp, S_0]`, `A Du_k = -DS_0 u_k - sum (a >= 1) DS_a u_(k-a) + S_a Du_(k-a)`,
//! `k DS_k = sum [DV_a, S_(k-1-a)] + [V_a, DS_(k-1-a)]`
//!
//! where A holds the screws of the joints that follow, and Vp the parts of joints and of B before a place. The input is one number
//! more, whose B is its own screw; so is an idle joint that is held.
//!
//! Source: docs/theory_design.md, (1) to (5).

use super::factors::Product;
use super::twists::{adjoined, determinant, plus, sliding, turned, turning, turns_near};
use super::word::{Carried, Design, NumberedPoint, Word};
use crate::loops::equation::closed::Joint;
use crate::loops::equation::dense::{COLUMNS, Factored, ROWS, singular_values};
use crate::loops::equation::rotations::{Rotation, product, rotation};
use crate::loops::equation::screws::Twist;
use crate::rigid::Pose;
use crate::stopping;
use std::sync::Arc;

/// Newton's steps on the closure: the most, the longest [rad, or relative to the size], and one after which only rounding is left.
const MOST_STEPS: usize = 20;
const LONGEST: f64 = 0.3;
const LAST: f64 = 1e-8;

/// A closure error [rad, or relative to the size] that rounding leaves where the loop is ill conditioned.
const NEARLY_CLOSED: f64 = 1e-9;

/// A loop of turns (R), slides (P), screws (H) and balls (S) with its numbers; lengths relative to the size.
///
/// Columns are the joints' values, three of a ball: on the way in and out its turns about z, y and x, and in derivatives its
/// rotation about x, y and z of the frame before it.
#[derive(Clone, Debug)]
pub struct NumberedLoop {
    pub(crate) joints: Vec<Joint>,
    pub(crate) first: Vec<usize>,
    pub(crate) columns: usize,
    pub(crate) nominal: Design,
    pub(crate) input: usize,
    /// Columns that stay where they are since they move no other link.
    pub(crate) held: Vec<usize>,
    /// The other passive columns.
    pub(crate) free: Vec<usize>,
    /// Idle freedoms that no column stands for; at each pose one more column is held for each.
    pub(crate) spins: usize,
    pub(crate) numbers: usize,
    pub(super) moves: Vec<Vec<(usize, Twist)>>,
    pub(super) advances: Vec<Option<(usize, f64)>>,
    pub(super) points: Vec<NumberedPoint>,
    /// The numbers, in radians and lengths, and those among them by which derivatives are.
    values: Vec<f64>,
    only: Vec<usize>,
    word: Arc<Word>,
}

/// Poses of changed designs: joint values (designs, rows, columns), NaN where they do not close on the same pass, and the
/// determinants (designs, rows) that change their sign at a dead centre.
#[derive(Clone, Debug)]
pub struct Followed {
    pub values: Vec<f64>,
    pub sides: Vec<f64>,
}

/// Where the joints stand.
#[derive(Clone, Debug, Default)]
pub(crate) struct State {
    values: Vec<f64>,
    balls: Vec<Rotation>,
}

/// The loop once round.
#[derive(Clone, Debug, Default)]
pub(crate) struct Around {
    /// Behind each fixed transform but the last, and behind each joint.
    pub(crate) before: Vec<Pose>,
    pub(super) after: Vec<Pose>,
    pub(super) screws: Vec<Twist>,
    pub(super) error: Twist,
}

/// Directions of the kept screws at a pose, by which another is on the same side of dead centres.
struct Side {
    kept: Vec<usize>,
    basis: Vec<Twist>,
}

impl Around {
    /// The frame behind so many joints.
    pub(crate) fn behind(&self, joints: usize) -> Pose {
        joints.checked_sub(1).map_or(Pose::STILL, |last| self.after[last])
    }
}

impl NumberedLoop {
    /// The loop of a word at numbers, in their units, driven by a column: derivatives are by `only` some of them, and of points.
    /// `None` where these do not fit.
    pub fn new(
        word: &Arc<Word>,
        numbers: &[f64],
        input: usize,
        only: &[usize],
        points: &[Carried],
    ) -> Option<Self> {
        let count = numbers.len();
        if count != word.scales.len() || only.iter().any(|&k| k >= count) || !word.fits(points) {
            return None;
        }
        let values = word.values(numbers);
        let nominal = word.design(&values);
        let mut balls = 0;
        let mut joints = Vec::new();
        let mut first = Vec::new();
        let mut columns = 0;
        for (letter, &advance) in word.letters.chars().zip(&nominal.advances) {
            let joint = match letter {
                'R' => Joint::Turn,
                'P' => Joint::Slide,
                'H' => Joint::Screw(advance),
                'S' => Joint::Ball(balls),
                _ => return None,
            };
            balls += usize::from(letter == 'S');
            first.push(columns);
            columns += joint.columns();
            joints.push(joint);
        }
        let free: Vec<usize> = (0..columns)
            .filter(|c| *c != input && !word.held.contains(c))
            .collect();
        let fits = input < columns && free.len() >= word.spins && free.len() - word.spins <= COLUMNS;
        fits.then(|| Self {
            joints,
            first,
            columns,
            input,
            held: word.held.clone(),
            free,
            spins: word.spins,
            numbers: only.len(),
            moves: word.moves(&values, only),
            advances: word.advances(only),
            points: points
                .iter()
                .map(|point| word.point(point, &values, only))
                .collect(),
            nominal,
            values,
            only: only.to_vec(),
            word: Arc::clone(word),
        })
    }

    /// By each number that moves it, the twist of a link's frame behind the joints before it.
    pub fn twists(&self, frame: &Product) -> Option<Vec<(usize, Twist)>> {
        let fits = frame.numbers().all(|k| k < self.values.len());
        fits.then(|| {
            let pose = frame.pose(&self.values);
            let own = Pose { translation: pose.translation.map(|x| x / self.word.size), ..pose };
            let twists = self.word.twists(frame, &self.values, &self.only);
            twists
                .into_iter()
                .map(|(number, twist)| (number, adjoined(&own, &twist)))
                .collect()
        })
    }

    /// How many columns of joint values there are.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// How many joints there are.
    pub fn joints(&self) -> usize {
        self.joints.len()
    }

    /// How many numbers there are.
    pub fn numbers(&self) -> usize {
        self.numbers
    }

    /// How many points there are.
    pub fn points(&self) -> usize {
        self.points.len()
    }

    /// How many columns are held at a pose.
    pub fn idle(&self) -> usize {
        self.held.len() + self.spins
    }

    /// The points (rows, points, 3) at poses (rows, columns).
    pub fn places(&self, values: &[f64]) -> Vec<f64> {
        let mut around = Around::default();
        let mut places = Vec::with_capacity(values.len() / self.columns * self.points.len() * 3);
        for at in values.chunks(self.columns) {
            self.walk(&self.nominal, &self.state(at), &mut around);
            for point in &self.points {
                places.extend(around.behind(point.joints).carry(point.at));
            }
        }
        places
    }

    pub(crate) fn state(&self, values: &[f64]) -> State {
        let balls = self
            .joints
            .iter()
            .zip(&self.first)
            .filter(|(joint, _)| matches!(joint, Joint::Ball(_)))
            .map(|(_, &c)| turned(&values[c..c + 3]))
            .collect();
        State { values: values.to_vec(), balls }
    }

    fn move_by(&self, at: &mut State, columns: impl Iterator<Item = (usize, f64)>) {
        let mut spins = vec![[0.0; 3]; at.balls.len()];
        for (column, by) in columns {
            let joint = self.joint_of(column);
            match self.joints[joint] {
                Joint::Ball(b) => spins[b][column - self.first[joint]] += by,
                _ => at.values[column] += by,
            }
        }
        for (ball, spin) in at.balls.iter_mut().zip(spins) {
            *ball = product(&rotation(spin), ball);
        }
    }

    fn joint_of(&self, column: usize) -> usize {
        self.first.partition_point(|&f| f <= column) - 1
    }

    /// The values of a state, into one row; a ball's turns as near as can be to those of another row.
    fn write(&self, at: &State, near: &[f64], out: &mut [f64]) {
        out.copy_from_slice(&at.values);
        for (joint, &c) in self.joints.iter().zip(&self.first) {
            if let Joint::Ball(b) = *joint {
                out[c..c + 3].copy_from_slice(&turns_near(&at.balls[b], &near[c..c + 3]));
            }
        }
    }

    pub(crate) fn walk(&self, design: &Design, at: &State, out: &mut Around) {
        out.before.clear();
        out.after.clear();
        out.screws.clear();
        let mut frame = design.fixed[0];
        for (i, joint) in self.joints.iter().enumerate() {
            let c = self.first[i];
            out.before.push(frame);
            let z = frame.column(2);
            let value = at.values[c];
            let (advance, angle) = match *joint {
                Joint::Slide => (1.0, None),
                Joint::Ball(b) => {
                    for k in 0..3 {
                        out.screws.push(turning(frame.column(k), frame.translation));
                    }
                    frame.rotation = product(&frame.rotation, &at.balls[b]);
                    (0.0, None)
                }
                Joint::Turn => (0.0, Some(value)),
                Joint::Screw(_) => (design.advances[i], Some(value)),
            };
            if let Some(angle) = angle {
                let mut screw = turning(z, frame.translation);
                plus(&mut screw, &sliding(z), advance);
                out.screws.push(screw);
                let (s, cosine) = angle.sin_cos();
                for row in &mut frame.rotation {
                    (row[0], row[1]) = (row[0] * cosine + row[1] * s, row[1] * cosine - row[0] * s);
                }
            } else if *joint == Joint::Slide {
                out.screws.push(sliding(z));
            }
            if advance != 0.0 {
                for k in 0..3 {
                    frame.translation[k] += advance * value * z[k];
                }
            }
            out.after.push(frame);
            frame = frame.then(&design.fixed[i + 1]);
        }
        let r = &frame.rotation;
        // turned right round the antisymmetric part is small again
        let far = r[0][0] + r[1][1] + r[2][2] < 1.0;
        let skew = [r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]]
            .map(|x| if far { 1.0 } else { x / 2.0 });
        let t = frame.translation;
        out.error = [skew[0], skew[1], skew[2], t[0], t[1], t[2]];
    }

    /// The columns that follow the input at a pose: the free ones without as many as spin idly there.
    pub(super) fn kept(&self, around: &Around) -> Vec<usize> {
        if self.spins == 0 {
            return self.free.clone();
        }
        let columns: Vec<Vec<f64>> = self.free.iter().map(|&c| around.screws[c].to_vec()).collect();
        let (_, vectors) = singular_values(&columns);
        let mut idle: Vec<Vec<f64>> = vectors[vectors.len() - self.spins..].to_vec();
        let mut kept = self.free.clone();
        while let Some(mut vector) = idle.pop() {
            let most = (0..vector.len())
                .max_by(|&i, &j| vector[i].abs().total_cmp(&vector[j].abs()))
                .unwrap_or(0);
            let pivot = vector[most];
            vector.remove(most);
            kept.remove(most);
            for other in &mut idle {
                let share = other.remove(most) / pivot;
                for (x, v) in other.iter_mut().zip(&vector) {
                    *x -= share * v;
                }
            }
        }
        kept
    }

    pub(super) fn factored(&self, around: &Around, kept: &[usize]) -> Factored {
        let mut columns = [[0.0; ROWS]; COLUMNS];
        for (column, &c) in columns.iter_mut().zip(kept) {
            column[..6].copy_from_slice(&around.screws[c]);
        }
        Factored::new(columns, kept.len())
    }

    /// The kept screws' directions, by Gram and Schmidt.
    fn side(&self, around: &Around) -> Side {
        let kept = self.kept(around);
        let mut basis: Vec<Twist> = Vec::with_capacity(kept.len());
        for &c in &kept {
            let mut direction = around.screws[c];
            // twice is enough
            for _ in 0..2 {
                for other in &basis {
                    let along: f64 = (0..6).map(|k| direction[k] * other[k]).sum();
                    plus(&mut direction, other, -along);
                }
            }
            let length = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
            basis.push(direction.map(|x| x / length));
        }
        Side { kept, basis }
    }

    /// The determinant of the kept screws along directions of another pose, positive there.
    fn beside(&self, side: &Side, around: &Around) -> f64 {
        determinant(
            side.basis
                .iter()
                .map(|b| {
                    side.kept
                        .iter()
                        .map(|&c| (0..6).map(|k| b[k] * around.screws[c][k]).sum())
                        .collect()
                })
                .collect(),
        )
    }

    /// How many numbers its description has.
    pub fn all_numbers(&self) -> usize {
        self.values.len()
    }

    /// Closed poses of designs, by their numbers (designs, all) in their units or else its own, at inputs (rows,), by Newton's method from poses (rows, columns) of this loop nearby, moved by
    /// `steps` (designs, rows, columns) at first. One that comes out beyond a dead centre of the input, where the determinant of
    /// the screws changes its sign, is on another pass and so NaN, as is one that does not close.
    pub fn follow(
        &self,
        values: &[f64],
        inputs: &[f64],
        steps: Option<&[f64]>,
        designs: Option<&[f64]>,
    ) -> Followed {
        let (rows, width) = (inputs.len(), self.columns);
        let changed: Vec<Design>;
        let designs = if let Some(numbers) = designs {
            let own = numbers.chunks(self.values.len());
            changed = own.map(|one| self.word.design(&self.word.values(one))).collect();
            &changed[..]
        } else {
            std::slice::from_ref(&self.nominal)
        };
        let mut out = Followed {
            values: vec![f64::NAN; designs.len() * rows * width],
            sides: vec![f64::NAN; designs.len() * rows],
        };
        let mut around = Around::default();
        for (row, (near, &input)) in values.chunks(width).zip(inputs).enumerate() {
            if !(input.is_finite() && near.iter().all(|x| x.is_finite())) {
                continue;
            }
            let start = self.state(near);
            self.walk(&self.nominal, &start, &mut around);
            let side = self.side(&around);
            for (number, design) in designs.iter().enumerate() {
                stopping::piece();
                let place = number * rows + row;
                let mut at = start.clone();
                if let Some(steps) = steps {
                    let step = &steps[place * width..][..width];
                    if step.iter().all(|x| x.is_finite()) {
                        self.move_by(&mut at, step.iter().copied().enumerate());
                    }
                }
                at.values[self.input] = input;
                if let Some(det) = self.close(design, &side, &mut at, &mut around) {
                    self.write(&at, near, &mut out.values[place * width..][..width]);
                    out.sides[place] = det;
                }
            }
        }
        out
    }

    fn close(&self, design: &Design, side: &Side, at: &mut State, around: &mut Around) -> Option<f64> {
        for _ in 0..MOST_STEPS {
            self.walk(design, at, around);
            let e = around.error;
            let step = self
                .factored(around, &side.kept)
                .solve([e[0], e[1], e[2], e[3], e[4], e[5], 0.0]);
            let longest = step.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
            if !longest.is_finite() {
                return None;
            }
            let factor = -(LONGEST / longest.max(LONGEST));
            self.move_by(at, side.kept.iter().zip(step).map(|(&c, x)| (c, factor * x)));
            if longest < LAST {
                break;
            }
        }
        self.walk(design, at, around);
        let det = self.beside(side, around);
        (around.error.iter().all(|x| x.abs() < NEARLY_CLOSED) && det > 0.0).then_some(det)
    }
}
