//! A net as a value: a tree of steps and the rows that close it; `e` and `A = de/dq` at a pose, and the closed pose next to one.
//!
//! Source: docs/theory_nets.md, (1) to (4).

use super::rows::Row;
use super::steps::{Move, Screw, Step};
use crate::loops::least_squares;
use crate::rigid::{Pose, cross, scale};

/// Singular values below this part of the greatest are zero: in nets of many kinds the least of the others was 8e-3.
pub(super) const NO_RANK: f64 = 1e-8;

/// Steps of Newton's method, and the closure error [rad, or relative to the size] at which they have arrived.
const MOST_STEPS: usize = 20;
const CLOSED: f64 = 1e-13;

/// A tree of steps, each a column, and the rows that close it.
#[derive(Clone, Debug)]
pub struct Net {
    /// The steps, each after its parent.
    pub steps: Vec<Step>,
    /// The rows of the chords.
    pub rows: Vec<Row>,
    /// The size [length] of which places are parts in every tolerance.
    pub size: f64,
}

/// A net at a pose: the pose of what each step moves, and each column's screw.
pub(super) struct Placed {
    pub poses: Vec<Pose>,
    pub screws: Vec<Screw>,
}

impl Net {
    /// Whether a column is a length.
    pub(super) fn slides(&self, column: usize) -> bool {
        self.steps[column].moves == Move::Slide
    }

    /// Where all steps are at values of the columns [rad, or relative to the size].
    pub(super) fn place(&self, values: &[f64]) -> Placed {
        let mut placed = Placed {
            poses: Vec::with_capacity(self.steps.len()),
            screws: Vec::with_capacity(self.steps.len()),
        };
        for (c, (step, &value)) in self.steps.iter().zip(values).enumerate() {
            let value = if self.slides(c) { value * self.size } else { value };
            let before = step.parent.map_or(Pose::STILL, |p| placed.poses[p]);
            let (axis, origin) = (before.turn(step.axis), before.carry(step.origin));
            let (turn, along) = match step.moves {
                Move::Turn => (1.0, 0.0),
                Move::Slide => (0.0, 1.0),
                Move::Screw(advance) => (1.0, advance),
            };
            let moment = cross(origin, axis);
            placed.screws.push(Screw {
                turn: scale(axis, turn),
                shift: std::array::from_fn(|k| turn * moment[k] + along * axis[k]),
            });
            placed.poses.push(before.then(&step.moved(value)));
        }
        placed
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

    /// `e` of every row, lengths relative to the size, and `A` column by column, at values of the columns, slides relative to the size, too.
    pub fn closure(&self, values: &[f64]) -> (Vec<f64>, Vec<Vec<f64>>) {
        let placed = self.place(values);
        let mut errors = Vec::with_capacity(self.rows.len());
        let mut columns = vec![Vec::with_capacity(self.rows.len()); self.steps.len()];
        for row in &self.rows {
            let on = row.on();
            let [a, b] = on.map(|step| step.map_or(Pose::STILL, |k| placed.poses[k]));
            let (value, wrenches) = row.evaluated(&a, &b);
            let unit = if row.is_length() { 1.0 / self.size } else { 1.0 };
            errors.push(value * unit);
            for (c, column) in columns.iter_mut().enumerate() {
                let seen = on.iter().zip(&wrenches).map(|(step, wrench)| {
                    let carried = step.is_some_and(|k| self.carries(c, k));
                    if carried {
                        wrench.power(&placed.screws[c])
                    } else {
                        0.0
                    }
                });
                let scale = if self.slides(c) { self.size } else { 1.0 };
                column.push(seen.sum::<f64>() * unit * scale);
            }
        }
        (errors, columns)
    }

    /// The closed pose that Newton's shortest steps lead to; `None` where they lead to none.
    pub fn closed(&self, rough: &[f64]) -> Option<Vec<f64>> {
        let mut pose = rough.to_vec();
        for _ in 0..MOST_STEPS {
            let (errors, columns) = self.closure(&pose);
            let greatest = errors.iter().fold(0.0, |m: f64, e| m.max(e.abs()));
            if greatest < CLOSED {
                return Some(pose);
            }
            if !greatest.is_finite() {
                return None;
            }
            let by = least_squares(&columns, &errors, NO_RANK);
            for (x, d) in pose.iter_mut().zip(by) {
                *x -= d;
            }
        }
        None
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
        let step = |parent, origin| Step { parent, moves: Move::Turn, origin, axis: z };
        let net = Net {
            steps: vec![step(None, [0.0; 3]), step(Some(0), [1.0, 0.0, 0.0])],
            rows: Vec::new(),
            size: 1.0,
        };
        let placed = net.place(&[quarter, -quarter]);
        let end = placed.poses[1].carry([2.0, 0.0, 0.0]);
        assert!(norm(sub(end, [1.0, 1.0, 0.0])) < 1e-15);
        assert!(net.carries(0, 1) && !net.carries(1, 0));
    }
}
