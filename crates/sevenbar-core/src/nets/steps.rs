//! Where the links of a net stand: a tree of one-freedom steps from the ground outwards, each about its axis as drawn.
//!
//! In the drawn pose every link's frame is that of the ground: `(R_k, p_k) = (R_parent, p_parent) Z_k(q_k)`.
//!
//! Source: docs/theory_nets.md, (1) to (3).

use crate::loops::equation::rotations::{cross, dot3};
use crate::number::Number;
use crate::rigid::{Pose, Vec3, scale};
use num_complex::Complex64;
use std::array::from_fn;

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
    /// What it reads as drawn [rad, or length].
    pub reads: f64,
}

/// A rigid motion `x -> rotation x + translation` of numbers of any kind.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placement<N> {
    pub rotation: [[N; 3]; 3],
    pub translation: [N; 3],
}

impl<N: Number> Placement<N> {
    /// That which leaves all where it is.
    #[inline]
    pub fn still() -> Self {
        let (zero, one) = (N::splat(0.0), N::splat(1.0));
        Self {
            rotation: [[one, zero, zero], [zero, one, zero], [zero, zero, one]],
            translation: [zero; 3],
        }
    }

    /// The image of a direction.
    #[inline]
    pub fn turn(&self, v: &Vec3) -> [N; 3] {
        let mut out = self.translation;
        for k in 0..3 {
            out[k] = (self.rotation[k][0] * N::splat(v[0]))
                .plus_product(self.rotation[k][1], N::splat(v[1]))
                .plus_product(self.rotation[k][2], N::splat(v[2]));
        }
        out
    }

    /// The image of a place.
    #[inline]
    pub fn carry(&self, x: &Vec3) -> [N; 3] {
        let mut out = self.turn(x);
        for k in 0..3 {
            out[k] = out[k] + self.translation[k];
        }
        out
    }

    /// `self` after `other`.
    #[inline]
    pub fn then(&self, other: &Self) -> Self {
        let mut out = *self;
        for i in 0..3 {
            for j in 0..3 {
                out.rotation[i][j] = (self.rotation[i][0] * other.rotation[0][j])
                    .plus_product(self.rotation[i][1], other.rotation[1][j])
                    .plus_product(self.rotation[i][2], other.rotation[2][j]);
            }
            out.translation[i] = self.translation[i] + dot3(&self.rotation[i], &other.translation);
        }
        out
    }
}

/// A pose with complex entries.
pub(super) type ComplexPose = Placement<Complex64>;

impl ComplexPose {
    /// The image of a place that is any.
    pub fn image(&self, x: &[Complex64; 3]) -> [Complex64; 3] {
        from_fn(|i| self.translation[i] + dot3(&self.rotation[i], x))
    }

    /// The inverse motion; the rotation is an orthogonal matrix with complex entries, too.
    pub fn inverse(&self) -> Self {
        let rotation = from_fn(|i| from_fn(|j| self.rotation[j][i]));
        let back = Self { rotation, translation: [Complex64::ZERO; 3] };
        Self { rotation, translation: back.image(&self.translation).map(|x| -x) }
    }
}

impl From<&Pose> for ComplexPose {
    fn from(pose: &Pose) -> Self {
        Self {
            rotation: pose.rotation.map(|row| row.map(Complex64::from)),
            translation: pose.translation.map(Complex64::from),
        }
    }
}

impl From<Placement<f64>> for Pose {
    fn from(placement: Placement<f64>) -> Self {
        Self { rotation: placement.rotation, translation: placement.translation }
    }
}

/// The screw of a column at a pose: what turns about its axis, and where the origin goes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Screw<N = f64> {
    pub turn: [N; 3],
    pub shift: [N; 3],
}

impl<N: Number> Screw<N> {
    /// One that moves nothing.
    #[inline]
    pub fn still() -> Self {
        Self { turn: [N::splat(0.0); 3], shift: [N::splat(0.0); 3] }
    }
}

impl Step {
    /// Where it leads from the step before it, at a value that it reads [rad, or length].
    #[inline]
    pub(super) fn moved<N: Number>(&self, value: N) -> Placement<N> {
        let by = value - N::splat(self.reads);
        let mut placement = Placement::still();
        let along = match self.moves {
            Move::Turn => None,
            Move::Slide => Some(by),
            Move::Screw(advance) => Some(by * N::splat(advance)),
        };
        if self.moves != Move::Slide {
            let (s, c) = by.sin_cos();
            let versed = N::splat(1.0) - c;
            let axis = self.axis;
            for i in 0..3 {
                for j in 0..3 {
                    let square = versed * N::splat(axis[i] * axis[j]);
                    placement.rotation[i][j] = if i == j {
                        square + c
                    } else {
                        // the cross product with the axis, as a matrix
                        let third = 3 - i - j;
                        let sign = if (i + 1) % 3 == j { -1.0 } else { 1.0 };
                        square.plus_product(s, N::splat(sign * axis[third]))
                    };
                }
            }
            let turned = placement.turn(&self.origin);
            for k in 0..3 {
                placement.translation[k] = N::splat(self.origin[k]) - turned[k];
            }
        }
        if let Some(along) = along {
            for k in 0..3 {
                placement.translation[k] =
                    placement.translation[k].plus_product(along, N::splat(self.axis[k]));
            }
        }
        placement
    }

    /// Its screw, of the step before it as placed.
    #[inline]
    pub(super) fn screw<N: Number>(&self, before: &Placement<N>) -> Screw<N> {
        let axis = before.turn(&self.axis);
        if self.moves == Move::Slide {
            return Screw { turn: [N::splat(0.0); 3], shift: axis };
        }
        let mut shift = cross(&before.carry(&self.origin), &axis);
        if let Move::Screw(advance) = self.moves {
            for k in 0..3 {
                shift[k] = shift[k].plus_product(axis[k], N::splat(advance));
            }
        }
        Screw { turn: axis, shift }
    }

    /// The same with lengths relative to a size.
    pub(super) fn relative(&self, size: f64) -> Self {
        let inverse = 1.0 / size;
        let (moves, unit) = match self.moves {
            Move::Screw(advance) => (Move::Screw(advance * inverse), 1.0),
            Move::Slide => (Move::Slide, inverse),
            Move::Turn => (Move::Turn, 1.0),
        };
        Self {
            parent: self.parent,
            moves,
            origin: scale(self.origin, inverse),
            axis: self.axis,
            reads: self.reads * unit,
        }
    }
}
