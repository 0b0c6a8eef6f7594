//! Where the links of a net stand: a tree of one-freedom steps from the ground outwards, each about its axis as drawn.
//!
//! At the drawn pose all values are zero, and every link's frame is that of the ground: `(R_k, p_k) = (R_parent, p_parent) Z_k(q_k)`.
//!
//! Source: docs/theory_nets.md, (1) to (3).

use super::rows::Row;
use crate::rigid::{Pose, Vec3, cross, dot, scale, sub};

/// How a step moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Move {
    /// About the axis.
    Turn,
    /// Along it.
    Slide,
    /// About it, and along it by this advance [length] for a radian.
    Screw(f64),
}

/// A step of one freedom: a link, or a body between two freedoms of one joint, moved against the one before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// The step before it; `None` for one on the ground.
    pub parent: Option<usize>,
    /// How it moves.
    pub moves: Move,
    /// A place on its axis as drawn.
    pub origin: Vec3,
    /// The direction of its axis as drawn, of length 1.
    pub axis: Vec3,
}

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

/// The screw of a column at a pose: what turns about its axis, and where the origin goes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Screw {
    pub turn: Vec3,
    pub shift: Vec3,
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
            placed.poses.push(before.then(&step.motion(turn * value, along * value)));
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
}

impl Step {
    /// By an angle about its axis and a length along it.
    fn motion(&self, angle: f64, along: f64) -> Pose {
        let (s, c) = angle.sin_cos();
        let [x, y, z] = self.axis;
        let t = 1.0 - c;
        let rotation = [
            [t * x * x + c, t * x * y - s * z, t * x * z + s * y],
            [t * x * y + s * z, t * y * y + c, t * y * z - s * x],
            [t * x * z - s * y, t * y * z + s * x, t * z * z + c],
        ];
        let turned = rotation.map(|row| dot(row, self.origin));
        let back = sub(self.origin, turned);
        let translation = std::array::from_fn(|k| back[k] + along * self.axis[k]);
        Pose { rotation, translation }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigid::norm;

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
