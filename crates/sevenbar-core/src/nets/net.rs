//! A net as a value: a tree of steps and the rows that close it; `e` and `A = de/dq` at a pose, and the closed pose next to one.
//!
//! Source: docs/theory_nets.md, (1) to (4).

use super::rows::{On, Row};
use super::steps::{Move, Placement, Screw, Step};
use crate::loops::equation::rotations::Rotation;
use crate::loops::least_squares;
use crate::number::Number;
use crate::rigid::{Pose, Vec3};

/// Most columns of a net that is followed.
pub(super) const MOST_COLUMNS: usize = 17;

/// Singular values below this part of the greatest are zero: in nets of many kinds the least of the others was 8e-3.
pub(super) const NO_RANK: f64 = 1e-8;

/// Steps of Newton's method, and the closure error and the step [rad, or relative to the size] at which they have arrived: where the pose is
/// singular errors fall with the square of the steps, and it is not known well enough to tell a rank.
const MOST_STEPS: usize = 40;
const CLOSED: f64 = 1e-13;
const SETTLED: f64 = 1e-9;

/// A tree of steps, each a column, and the rows that close it.
#[derive(Clone, Debug)]
pub struct Net {
    /// The steps, each after its parent.
    pub steps: Vec<Step>,
    /// The rows of the chords.
    pub rows: Vec<Row>,
    /// Directions of two links that would be opposite where rows of angles hold and the net does not close.
    pub facing: Vec<Facing>,
    /// The first of the three turns of each ball, about one place; where it is followed it turns as one, about the axes of the link before it.
    pub balls: Vec<usize>,
    /// The size [length] of which places are parts in every tolerance.
    pub size: f64,
}

/// A direction, as drawn, of two links, between which there is less than a right angle wherever they are joined.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facing {
    /// The links.
    pub on: [On; 2],
    /// The direction, of length 1.
    pub direction: Vec3,
}

impl Net {
    /// Whether a column is a length.
    pub(super) fn slides(&self, column: usize) -> bool {
        self.steps[column].moves == Move::Slide
    }

    /// The columns in the drawn pose [rad, or relative to the size].
    pub(super) fn drawn(&self) -> Vec<f64> {
        let unit = |step: &Step| {
            if step.moves == Move::Slide {
                1.0 / self.size
            } else {
                1.0
            }
        };
        self.steps.iter().map(|step| step.reads * unit(step)).collect()
    }

    /// The same with lengths relative to the size, which is 1 then.
    pub(super) fn relative(&self) -> Self {
        Self {
            steps: self.steps.iter().map(|step| step.relative(self.size)).collect(),
            rows: self.rows.iter().map(|row| row.relative(self.size)).collect(),
            facing: self.facing.clone(),
            balls: self.balls.clone(),
            size: 1.0,
        }
    }

    /// Where all steps lead at values of the columns [rad, or relative to the size], and the screw of each column; balls are as they are given,
    /// or, where none are, three turns.
    #[inline]
    pub(super) fn place<N: Number>(
        &self,
        values: &[N],
        balls: &[Rotation<N>],
        poses: &mut [Placement<N>],
        screws: &mut [Screw<N>],
    ) {
        for (&first, ball) in self.balls.iter().zip(balls) {
            // what is known of the steps before it is known when the step is met
            poses[first].rotation = *ball;
        }
        for (k, step) in self.steps.iter().enumerate() {
            if !balls.is_empty() && self.balls.iter().any(|&first| (first..first + 3).contains(&k)) {
                self.place_ball(k, poses, screws);
                continue;
            }
            let value = if step.moves == Move::Slide {
                values[k] * N::splat(self.size)
            } else {
                values[k]
            };
            let before = on(poses, step.parent);
            screws[k] = step.screw(&before);
            poses[k] = before.then(&step.moved(value));
        }
    }

    /// The same for one of a ball's three steps, whose rotation is in the pose of the first; the last leads to the link beyond.
    #[inline]
    fn place_ball<N: Number>(&self, k: usize, poses: &mut [Placement<N>], screws: &mut [Screw<N>]) {
        let first = self
            .balls
            .iter()
            .copied()
            .find(|first| (*first..first + 3).contains(&k));
        let first = first.unwrap_or(k);
        let before = on(poses, self.steps[first].parent);
        let centre = self.steps[first].origin;
        let mut axis = [0.0; 3];
        axis[k - first] = 1.0;
        let turned = Step { moves: Move::Turn, origin: centre, axis, ..self.steps[first] };
        screws[k] = turned.screw(&before);
        if k == first + 2 {
            let mut ball = Placement { rotation: poses[first].rotation, ..Placement::still() };
            let back = ball.turn(&centre);
            for i in 0..3 {
                ball.translation[i] = N::splat(centre[i]) - back[i];
            }
            poses[k] = before.then(&ball);
        }
    }

    /// Where each step leads.
    pub(super) fn poses(&self, values: &[f64]) -> Vec<Pose> {
        let mut poses = vec![Placement::still(); self.steps.len()];
        self.place(
            values,
            &[],
            &mut poses,
            &mut vec![Screw::still(); self.steps.len()],
        );
        poses.into_iter().map(Pose::from).collect()
    }

    /// Whether a column moves what a step moves.
    pub(super) fn carries(&self, column: usize, step: usize) -> bool {
        let mut at = Some(step);
        while let Some(k) = at {
            if k == column {
                return true;
            }
            at = self.steps[k].parent;
        }
        false
    }

    /// The columns that move the one link of a row and not the other, for each of its two.
    pub(super) fn sides(&self, row: &Row) -> [Vec<usize>; 2] {
        self.moving(row.on())
    }

    /// The columns that move the one of two links and not the other, for each of the two.
    pub(super) fn moving(&self, on: [On; 2]) -> [Vec<usize>; 2] {
        let carries = |c: usize, side: usize| on[side].is_some_and(|step| self.carries(c, step));
        [0, 1].map(|side| {
            let columns = 0..self.steps.len();
            columns
                .filter(|&c| carries(c, side) && !carries(c, 1 - side))
                .collect()
        })
    }

    /// `e` of every row, lengths relative to the size, and `A` column by column, at values of the columns, slides relative to the size, too.
    pub fn closure(&self, values: &[f64]) -> (Vec<f64>, Vec<Vec<f64>>) {
        let count = self.steps.len();
        let (mut poses, mut screws) = (vec![Placement::still(); count], vec![Screw::still(); count]);
        self.place(values, &[], &mut poses, &mut screws);
        let mut errors = Vec::with_capacity(self.rows.len());
        let mut columns = vec![vec![0.0; self.rows.len()]; count];
        for (r, row) in self.rows.iter().enumerate() {
            let [a, b] = row.on().map(|step| on(&poses, step));
            let (value, wrenches) = row.evaluated(&a, &b);
            let unit = if row.is_length() { 1.0 / self.size } else { 1.0 };
            errors.push(value * unit);
            for (side, wrench) in self.sides(row).iter().zip(&wrenches) {
                for &c in side {
                    let scale = if self.slides(c) { self.size } else { 1.0 };
                    columns[c][r] = wrench.power(&screws[c]) * unit * scale;
                }
            }
        }
        (errors, columns)
    }

    /// `e` of every row, as `closure` has it, with balls as they are given.
    pub(super) fn errors(&self, values: &[f64], balls: &[Rotation]) -> Vec<f64> {
        let mut poses = vec![Placement::still(); self.steps.len()];
        let mut screws = vec![Screw::still(); self.steps.len()];
        self.place(values, balls, &mut poses, &mut screws);
        let error = |row: &Row| {
            let [a, b] = row.on().map(|step| on(&poses, step));
            row.evaluated(&a, &b).0 * if row.is_length() { 1.0 / self.size } else { 1.0 }
        };
        self.rows.iter().map(error).collect()
    }

    /// The closed pose that Newton's shortest steps lead to; `None` where they lead to none.
    pub fn closed(&self, rough: &[f64]) -> Option<Vec<f64>> {
        let mut pose = rough.to_vec();
        let mut moved = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            let (errors, columns) = self.closure(&pose);
            let greatest = errors.iter().fold(0.0, |m: f64, e| m.max(e.abs()));
            if greatest < CLOSED && moved < SETTLED {
                return Some(pose);
            }
            if !greatest.is_finite() {
                return None;
            }
            let by = least_squares(&columns, &errors, NO_RANK);
            moved = by.iter().fold(0.0, |m: f64, d| m.max(d.abs()));
            for (x, d) in pose.iter_mut().zip(by) {
                *x -= d;
            }
        }
        None
    }
}

/// The pose of what a step moves, of the ground where there is none.
#[inline]
pub(super) fn on<N: Number>(poses: &[Placement<N>], step: On) -> Placement<N> {
    match step {
        Some(k) => poses[k],
        None => Placement::still(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigid::{norm, sub};

    #[test]
    fn a_link_turns_about_its_axis_as_drawn_and_carries_the_links_beyond() {
        let quarter = std::f64::consts::FRAC_PI_2;
        let z = [0.0, 0.0, 1.0];
        let step = |parent, origin| Step { parent, moves: Move::Turn, origin, axis: z, reads: 0.0 };
        let net = Net {
            steps: vec![step(None, [0.0; 3]), step(Some(0), [1.0, 0.0, 0.0])],
            rows: Vec::new(),
            facing: Vec::new(),
            balls: Vec::new(),
            size: 1.0,
        };
        let poses = net.poses(&[quarter, -quarter]);
        let end = poses[1].carry([2.0, 0.0, 0.0]);
        assert!(norm(sub(end, [1.0, 1.0, 0.0])) < 1e-15);
        assert!(net.carries(0, 1) && !net.carries(1, 0));
    }
}
