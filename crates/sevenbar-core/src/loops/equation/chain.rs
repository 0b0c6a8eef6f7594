//! The closed chain as it is followed: at most seven freedoms, a closure error, and the joints' screws.
//!
//! Source: docs/theory.md, (1) to (5).

use super::dense::{COLUMNS, Columns};
use super::flat::Flat;
use super::rotations::{
    Rotation, dot3, product, rotation, rotation_vector, short_way, splatted, transposed, turned,
};
use super::screws::{Twist, screw};
use crate::number::Number;
use crate::rigid::{Pose, norm};
use crate::vectors::{LANES, Vector};

/// The closure error [rad, or relative to the size] up to which redundant constraints agree by default: a nanometre in a metre, far below
/// what can be made or measured, and far above rounding.
pub const AGREE: f64 = 1e-9;

/// Most balls in seven columns.
pub(crate) const BALLS: usize = 2;

/// A joint of the chain; a ball has three columns, the others one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Joint {
    Turn,
    Slide,
    /// Advance for each radian, relative to the size.
    Screw(f64),
    /// The n-th ball.
    Ball(usize),
}

impl Joint {
    /// How many columns it has.
    #[inline(always)]
    pub fn columns(&self) -> usize {
        if matches!(self, Self::Ball(_)) { 3 } else { 1 }
    }
}

/// `Z1 G1 Z2 .. Zn Gn = 1`, lengths relative to the size.
#[derive(Clone, Debug)]
pub(crate) struct Chain {
    pub joints: Vec<Joint>,
    /// The first column of each joint.
    pub first: Vec<usize>,
    /// G after each joint; the last closes the loop.
    pub links: Vec<Pose>,
    pub columns: usize,
    /// The sum of the links' lengths.
    pub around: f64,
    /// The closure error [rad, or relative to the size] up to which redundant constraints agree.
    pub agree: f64,
    /// Turns of which one half counts: in the other stand the same poses, with links that spin idly turned over.
    pub halves: Vec<Half>,
    /// The pose of a drawing, where it closes.
    pub drawn: Configuration,
}

/// The half turn of a joint that counts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Half {
    pub joint: usize,
    /// Its middle [rad].
    pub middle: f64,
    /// The joint by which the line of two balls turns besides, and how.
    pub line: Option<(usize, Flat)>,
}

/// Where the joints stand: a value for each column but a ball's, a rotation for each ball.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Configuration<N = f64> {
    pub values: Columns<N>,
    pub balls: [Rotation<N>; BALLS],
}

/// The chain evaluated: each column's screw in the frame of the first joint, and how far it is from closing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed<N = f64> {
    pub screws: [Twist<N>; COLUMNS],
    pub error: Twist<N>,
    /// Cosine of the angle by which the loop fails to close.
    pub closing_cosine: N,
}

const UNTURNED: Rotation = Pose::STILL.rotation;

impl Configuration {
    pub const ZERO: Self = Self { values: [0.0; COLUMNS], balls: [UNTURNED; BALLS] };
}

impl<V: Vector> Configuration<V> {
    /// Configurations side by side, one in each lane.
    #[inline(always)]
    pub fn beside(each: &[Configuration; LANES], balls: usize) -> Self {
        let zero = V::splat(0.0);
        let mut out = Self { values: [zero; COLUMNS], balls: [[[zero; 3]; 3]; BALLS] };
        let mut lanes = [0.0; LANES];
        for c in 0..COLUMNS {
            for k in 0..LANES {
                lanes[k] = each[k].values[c];
            }
            out.values[c] = V::load(&lanes);
        }
        for b in 0..balls {
            for i in 0..9 {
                for k in 0..LANES {
                    lanes[k] = each[k].balls[b][i / 3][i % 3];
                }
                out.balls[b][i / 3][i % 3] = V::load(&lanes);
            }
        }
        out
    }

    /// The configuration of each lane.
    #[inline(always)]
    pub fn apart(&self, balls: usize) -> [Configuration; LANES] {
        let mut out = [Configuration::ZERO; LANES];
        for c in 0..COLUMNS {
            let lanes = self.values[c].store();
            for k in 0..LANES {
                out[k].values[c] = lanes[k];
            }
        }
        for b in 0..balls {
            for i in 0..9 {
                let lanes = self.balls[b][i / 3][i % 3].store();
                for k in 0..LANES {
                    out[k].balls[b][i / 3][i % 3] = lanes[k];
                }
            }
        }
        out
    }
}

impl Chain {
    pub fn new(joints: Vec<Joint>, links: Vec<Pose>) -> Self {
        let mut first = Vec::with_capacity(joints.len());
        let mut columns = 0;
        for joint in &joints {
            first.push(columns);
            columns += joint.columns();
        }
        let around = links.iter().map(|l| norm(l.translation)).sum();
        Self {
            joints,
            first,
            links,
            columns,
            around,
            agree: AGREE,
            halves: Vec::new(),
            drawn: Configuration::ZERO,
        }
    }

    /// How many joints are balls.
    pub fn ball_count(&self) -> usize {
        self.joints.iter().filter(|j| matches!(j, Joint::Ball(_))).count()
    }

    /// The joint of each column.
    pub fn joint_of(&self, column: usize) -> usize {
        self.first.iter().rposition(|&f| f <= column).unwrap_or(0)
    }

    /// Whether a configuration is the one of its pose that counts.
    pub fn counts(&self, at: &Configuration) -> bool {
        let value = |joint: usize| at.values[self.first[joint]];
        self.halves.iter().all(|half| {
            let more = half.line.map_or(0.0, |(joint, flat)| flat.angle(value(joint)));
            (value(half.joint) + more - half.middle).cos() > 0.0
        })
    }

    /// Whether joints that move with one freedom leave constraints that say what others say: seven columns with rank six do not.
    pub fn is_redundant(&self) -> bool {
        self.columns < COLUMNS
    }

    /// Singular values below this part of the greatest are zero: those that a closure error within what agrees may bring.
    pub fn no_rank(&self) -> f64 {
        10.0 * self.agree
    }

    /// How far from real, and from where it closes, a solution may lie [rad, or relative to the size] that closes within what agrees, where
    /// that is more than the default: two that meet part by the root of what parts them.
    pub fn looseness(&self) -> f64 {
        if self.agree > AGREE {
            self.agree.sqrt()
        } else {
            0.0
        }
    }

    /// The columns that are angles of joints with one axis.
    pub fn is_turn(&self, column: usize) -> bool {
        self.joints[self.joint_of(column)] == Joint::Turn
    }

    /// Where a joint leads, from the frame before it to that after.
    pub fn motion_of(&self, joint: usize, at: &Configuration) -> Pose {
        let value = at.values[self.first[joint]];
        let (angle, slide) = match self.joints[joint] {
            Joint::Turn => (value, 0.0),
            Joint::Slide => (0.0, value),
            Joint::Screw(advance) => (value, advance * value),
            Joint::Ball(b) => {
                return Pose::turning(at.balls[b]);
            }
        };
        let (s, c) = angle.sin_cos();
        Pose {
            rotation: [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]],
            translation: [0.0, 0.0, slide],
        }
    }

    #[inline(always)]
    pub fn place<N: Number>(&self, at: &Configuration<N>) -> Placed<N> {
        let (zero, one, half) = (N::splat(0.0), N::splat(1.0), N::splat(0.5));
        let mut screws = [[zero; 6]; COLUMNS];
        let mut axes = [[one, zero, zero], [zero, one, zero], [zero, zero, one]];
        let mut p = [zero; 3];
        for ((joint, link), &column) in self.joints.iter().zip(&self.links).zip(&self.first) {
            let value = at.values[column];
            let z = axes[2];
            let advance = match *joint {
                Joint::Turn => 0.0,
                Joint::Slide => 1.0,
                Joint::Screw(advance) => advance,
                Joint::Ball(b) => {
                    for k in 0..3 {
                        screws[column + k] = screw(&axes[k], &p, 0.0);
                    }
                    axes = turned(&axes, &at.balls[b]);
                    0.0
                }
            };
            match *joint {
                Joint::Turn | Joint::Screw(_) => {
                    screws[column] = screw(&z, &p, advance);
                    let (s, c) = value.sin_cos();
                    for k in 0..3 {
                        let (x, y) = (axes[0][k], axes[1][k]);
                        axes[0][k] = (x * c).plus_product(y, s);
                        axes[1][k] = (y * c).minus_product(x, s);
                    }
                }
                Joint::Slide => screws[column] = [zero, zero, zero, z[0], z[1], z[2]],
                Joint::Ball(_) => {}
            }
            if advance != 0.0 {
                let slide = value * N::splat(advance);
                for k in 0..3 {
                    p[k] = p[k].plus_product(z[k], slide);
                }
            }
            for j in 0..3 {
                let t = N::splat(link.translation[j]);
                for k in 0..3 {
                    p[k] = p[k].plus_product(axes[j][k], t);
                }
            }
            axes = turned(&axes, &splatted(&link.rotation));
        }
        let [x, y, z] = axes;
        Placed {
            screws,
            error: [
                half * (y[2] - z[1]),
                half * (z[0] - x[2]),
                half * (x[1] - y[0]),
                p[0],
                p[1],
                p[2],
            ],
            closing_cosine: half * (x[0] + y[1] + z[2] - one),
        }
    }

    /// The configuration after a move of every column; a ball turns about the axes of the frame before it.
    #[inline(always)]
    pub fn moved<N: Number>(&self, at: &Configuration<N>, by: &Columns<N>) -> Configuration<N> {
        let mut out = *at;
        for (joint, &column) in self.joints.iter().zip(&self.first) {
            if let Joint::Ball(b) = *joint {
                let turn = rotation([by[column], by[column + 1], by[column + 2]]);
                out.balls[b] = product(&turn, &at.balls[b]);
            } else {
                out.values[column] = out.values[column] + by[column];
            }
        }
        out
    }

    /// The move from one configuration to another, turns taken the short way.
    #[inline(always)]
    pub fn difference(&self, from: &Configuration, to: &Configuration) -> Columns {
        let mut by = [0.0; COLUMNS];
        for (joint, &column) in self.joints.iter().zip(&self.first) {
            match *joint {
                Joint::Ball(b) => {
                    let turn = product(&to.balls[b], &transposed(&from.balls[b]));
                    by[column..column + 3].copy_from_slice(&rotation_vector(&turn));
                }
                Joint::Turn => {
                    by[column] = short_way(to.values[column] - from.values[column]);
                }
                _ => by[column] = to.values[column] - from.values[column],
            }
        }
        by
    }

    /// How far the loop is from closing: the greater of the angle [rad] and the gap relative to the size.
    #[inline(always)]
    pub fn residual<N: Number>(&self, placed: &Placed<N>) -> N {
        let e = &placed.error;
        let (turn, gap) = (dot3(&e[..3], &e[..3]).sqrt(), dot3(&e[3..], &e[3..]).sqrt());
        // turned right round the antisymmetric part is small again
        let turn = N::splat(0.0).if_greater(placed.closing_cosine, turn + N::splat(1.0), turn);
        turn.if_greater(gap, turn, gap)
    }

    /// The joints' screws at a configuration, one for each column.
    pub fn screws(&self, at: &Configuration) -> Vec<Vec<f64>> {
        let screws = self.place(at).screws;
        screws[..self.columns].iter().map(|s| s.to_vec()).collect()
    }

    /// The frames after each joint, in the frame of the first joint.
    pub fn frames(&self, at: &Configuration) -> Vec<Pose> {
        let mut frame = Pose::STILL;
        let mut frames = Vec::with_capacity(self.joints.len());
        for (joint, link) in self.links.iter().enumerate() {
            frame = frame.then(&self.motion_of(joint, at));
            frames.push(frame);
            frame = frame.then(link);
        }
        frames
    }
}
