//! The closed chain as it is followed: at most seven freedoms, a closure error, and the joints' screws.

use crate::rigid::{Pose, Vec3, add, cross, dot, norm, scale};

/// Most one-freedom columns of a chain with one freedom left: rank six and one.
pub(super) const COLUMNS: usize = 7;

/// Most balls in seven columns.
pub(super) const BALLS: usize = 2;

/// A rotation, row by row.
pub(super) type Rotation = [[f64; 3]; 3];

/// A value for each column.
pub(super) type Columns = [f64; COLUMNS];

/// An angular part and a linear part, or a twist and what it does to the origin.
pub(super) type Twist = [f64; 6];

/// A joint of the chain; a ball has three columns, the others one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Joint {
    Turn,
    Slide,
    /// Advance for each radian, in parts of the size.
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

/// `Z1 G1 Z2 .. Zn Gn = 1`, lengths in parts of the size.
#[derive(Clone, Debug)]
pub(super) struct Chain {
    pub joints: Vec<Joint>,
    /// The first column of each joint.
    pub first: Vec<usize>,
    /// G after each joint; the last closes the loop.
    pub links: Vec<Pose>,
    pub columns: usize,
    /// Columns of turns that must stay within a quarter turn of an angle [rad]: the others are the same pose with a link that
    /// spins idly turned over.
    pub halves: Vec<(usize, f64)>,
}

/// Where the joints stand: a value for each column but a ball's, a rotation for each ball.
#[derive(Clone, Copy, Debug)]
pub(super) struct Configuration {
    pub values: Columns,
    pub balls: [Rotation; BALLS],
}

/// The chain evaluated: each column's screw in the frame of the first joint, and how far it is from closing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed {
    pub screws: [Twist; COLUMNS],
    pub error: Twist,
    /// Cosine of the angle by which the loop fails to close.
    pub closing_cosine: f64,
}

const UNTURNED: Rotation = Pose::STILL.rotation;

impl Configuration {
    pub const ZERO: Self = Self { values: [0.0; COLUMNS], balls: [UNTURNED; BALLS] };
}

/// The screw with this axis through a point, and the advance for each radian.
#[inline(always)]
fn screw(axis: Vec3, point: Vec3, advance: f64) -> Twist {
    let moment = add(cross(point, axis), scale(axis, advance));
    [axis[0], axis[1], axis[2], moment[0], moment[1], moment[2]]
}

/// `[a, b]`: how the screw `b` changes while its body moves with the twist `a`.
#[inline(always)]
pub(super) fn bracket(a: &Twist, b: &Twist) -> Twist {
    let angular = cross([a[0], a[1], a[2]], [b[0], b[1], b[2]]);
    let first = cross([a[0], a[1], a[2]], [b[3], b[4], b[5]]);
    let second = cross([a[3], a[4], a[5]], [b[0], b[1], b[2]]);
    [
        angular[0],
        angular[1],
        angular[2],
        first[0] + second[0],
        first[1] + second[1],
        first[2] + second[2],
    ]
}

impl Chain {
    pub fn new(joints: Vec<Joint>, links: Vec<Pose>) -> Self {
        let mut first = Vec::with_capacity(joints.len());
        let mut columns = 0;
        for joint in &joints {
            first.push(columns);
            columns += joint.columns();
        }
        Self { joints, first, links, columns, halves: Vec::new() }
    }

    /// The joint of each column.
    pub fn joint_of(&self, column: usize) -> usize {
        self.first.iter().rposition(|&f| f <= column).unwrap_or(0)
    }

    /// Whether a configuration is the one of its pose that counts.
    pub fn counts(&self, at: &Configuration) -> bool {
        self.halves
            .iter()
            .all(|&(c, middle)| (at.values[c] - middle).cos() > 0.0)
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
    pub fn place(&self, at: &Configuration) -> Placed {
        let mut screws = [[0.0; 6]; COLUMNS];
        let (mut x, mut y, mut z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
        let mut p: Vec3 = [0.0; 3];
        for ((joint, link), &column) in self.joints.iter().zip(&self.links).zip(&self.first) {
            let value = at.values[column];
            let mut turn = None;
            match *joint {
                Joint::Turn => {
                    screws[column] = screw(z, p, 0.0);
                    turn = Some(value);
                }
                Joint::Slide => {
                    screws[column] = [0.0, 0.0, 0.0, z[0], z[1], z[2]];
                    p = add(p, scale(z, value));
                }
                Joint::Screw(advance) => {
                    screws[column] = screw(z, p, advance);
                    p = add(p, scale(z, advance * value));
                    turn = Some(value);
                }
                Joint::Ball(b) => {
                    screws[column] = screw(x, p, 0.0);
                    screws[column + 1] = screw(y, p, 0.0);
                    screws[column + 2] = screw(z, p, 0.0);
                    [x, y, z] = turned(&[x, y, z], &at.balls[b]);
                }
            }
            if let Some(angle) = turn {
                let (s, c) = angle.sin_cos();
                let (x0, y0) = (x, y);
                for k in 0..3 {
                    x[k] = x0[k] * c + y0[k] * s;
                    y[k] = y0[k] * c - x0[k] * s;
                }
            }
            let t = link.translation;
            for k in 0..3 {
                p[k] += x[k] * t[0] + y[k] * t[1] + z[k] * t[2];
            }
            [x, y, z] = turned(&[x, y, z], &link.rotation);
        }
        Placed {
            screws,
            error: [
                0.5 * (y[2] - z[1]),
                0.5 * (z[0] - x[2]),
                0.5 * (x[1] - y[0]),
                p[0],
                p[1],
                p[2],
            ],
            closing_cosine: 0.5 * (x[0] + y[1] + z[2] - 1.0),
        }
    }

    /// The configuration after a move of every column; a ball turns about the axes of the frame before it.
    #[inline(always)]
    pub fn moved(&self, at: &Configuration, by: &Columns) -> Configuration {
        let mut out = *at;
        for (joint, &column) in self.joints.iter().zip(&self.first) {
            if let Joint::Ball(b) = *joint {
                out.balls[b] = product(
                    &rotation([by[column], by[column + 1], by[column + 2]]),
                    &at.balls[b],
                );
            } else {
                out.values[column] += by[column];
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

    /// How far the loop is from closing: the greater of the angle [rad] and the gap in parts of the size.
    #[inline(always)]
    pub fn residual(&self, placed: &Placed) -> f64 {
        let e = &placed.error;
        let length = |x: f64, y: f64, z: f64| (x * x + y * y + z * z).sqrt();
        let (turn, gap) = (length(e[0], e[1], e[2]), length(e[3], e[4], e[5]));
        if placed.closing_cosine < 0.0 {
            return f64::max(1.0, gap);
        }
        turn.max(gap)
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

/// An angle moved by whole turns into (-pi, pi].
#[inline(always)]
pub(super) fn short_way(angle: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    let short = angle - turn * (angle / turn).round_ties_even();
    if short <= -std::f64::consts::PI {
        short + turn
    } else {
        short
    }
}

/// The images of the axes after a rotation that acts before them.
#[inline(always)]
fn turned(axes: &[Vec3; 3], by: &Rotation) -> [Vec3; 3] {
    let mut out = [[0.0; 3]; 3];
    for (j, image) in out.iter_mut().enumerate() {
        for k in 0..3 {
            image[k] = axes[0][k] * by[0][j] + axes[1][k] * by[1][j] + axes[2][k] * by[2][j];
        }
    }
    out
}

pub(super) fn product(a: &Rotation, b: &Rotation) -> Rotation {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

pub(super) fn transposed(a: &Rotation) -> Rotation {
    std::array::from_fn(|i| std::array::from_fn(|j| a[j][i]))
}

/// The turn about a vector by its length, by the unit quaternion.
pub(super) fn rotation(v: Vec3) -> Rotation {
    let angle = norm(v);
    let (s, w) = (0.5 * angle).sin_cos();
    let factor = if angle > 1e-8 { s / angle } else { 0.5 };
    let [x, y, z] = scale(v, factor);
    [
        [
            1.0 - 2.0 * (y * y + z * z),
            2.0 * (x * y - w * z),
            2.0 * (x * z + w * y),
        ],
        [
            2.0 * (x * y + w * z),
            1.0 - 2.0 * (x * x + z * z),
            2.0 * (y * z - w * x),
        ],
        [
            2.0 * (x * z - w * y),
            2.0 * (y * z + w * x),
            1.0 - 2.0 * (x * x + y * y),
        ],
    ]
}

/// The vector of a rotation, of length up to pi.
pub(super) fn rotation_vector(r: &Rotation) -> Vec3 {
    let v = [
        0.5 * (r[2][1] - r[1][2]),
        0.5 * (r[0][2] - r[2][0]),
        0.5 * (r[1][0] - r[0][1]),
    ];
    let sine = norm(v);
    let cosine = 0.5 * (r[0][0] + r[1][1] + r[2][2] - 1.0);
    if sine > 1e-6 {
        return scale(v, sine.atan2(cosine) / sine);
    }
    if cosine > 0.0 {
        return v;
    }
    // half a turn: the axis is the longest column of r + 1
    let columns: [Vec3; 3] =
        std::array::from_fn(|j| std::array::from_fn(|i| r[i][j] + if i == j { 1.0 } else { 0.0 }));
    let axis = columns.into_iter().fold(
        [0.0; 3],
        |best: Vec3, c| {
            if dot(c, c) > dot(best, best) { c } else { best }
        },
    );
    scale(axis, std::f64::consts::PI / norm(axis))
}

/// A rotation freed from the rounding of many products.
pub(super) fn squared_up(r: &Rotation) -> Rotation {
    let [x, y, _] = transposed(r);
    let x = scale(x, 1.0 / norm(x));
    let y = add(y, scale(x, -dot(x, y)));
    let y = scale(y, 1.0 / norm(y));
    transposed(&[x, y, cross(x, y)])
}
