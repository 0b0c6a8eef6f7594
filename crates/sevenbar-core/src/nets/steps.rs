//! Where the links of a net stand: a tree of one-freedom steps from the ground outwards, each about its axis as drawn.
//!
//! At the drawn pose all values are zero, and every link's frame is that of the ground: `(R_k, p_k) = (R_parent, p_parent) Z_k(q_k)`.
//!
//! Source: docs/theory_nets.md, (1) to (3).

use crate::rigid::{Pose, Vec3, dot, sub};

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

/// The screw of a column at a pose: what turns about its axis, and where the origin goes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Screw {
    pub turn: Vec3,
    pub shift: Vec3,
}

impl Step {
    /// Where it leads from the step before it, by a value [rad, or length].
    pub(super) fn moved(&self, value: f64) -> Pose {
        let (angle, along) = match self.moves {
            Move::Turn => (value, 0.0),
            Move::Slide => (0.0, value),
            Move::Screw(advance) => (value, advance * value),
        };
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
