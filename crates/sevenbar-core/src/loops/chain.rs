//! The closed chain as it is followed: at most seven freedoms, a closure error, and the joints' screws.
//!
//! Source: docs/theory.md, (1) to (5).

use super::spun::Flat;
use crate::rigid::{Pose, Vec3, dot, norm, scale};
use crate::vector_math::ROUNDER;
use crate::vectors::{LANES, Number, Vector};

/// Most one-freedom columns of a chain with one freedom left: rank six and one.
pub(super) const COLUMNS: usize = 7;

/// Most balls in seven columns.
pub(super) const BALLS: usize = 2;

/// A rotation, row by row.
pub(super) type Rotation<N = f64> = [[N; 3]; 3];

/// A value for each column.
pub(super) type Columns<N = f64> = [N; COLUMNS];

/// An angular part and a linear part, or a twist and what it does to the origin.
pub(super) type Twist<N = f64> = [N; 6];

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
    /// The sum of the links' lengths.
    pub around: f64,
    /// Turns of which one half counts: in the other stand the same poses, with links that spin idly turned over.
    pub halves: Vec<Half>,
}

/// The half turn of a joint that counts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Half {
    pub joint: usize,
    /// Its middle [rad].
    pub middle: f64,
    /// The joint by which the line of two balls turns besides, and how.
    pub line: Option<(usize, Flat)>,
}

/// Where the joints stand: a value for each column but a ball's, a rotation for each ball.
#[derive(Clone, Copy, Debug)]
pub(super) struct Configuration<N = f64> {
    pub values: Columns<N>,
    pub balls: [Rotation<N>; BALLS],
}

/// The chain evaluated: each column's screw in the frame of the first joint, and how far it is from closing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed<N = f64> {
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

/// `a x b`
#[inline(always)]
pub(super) fn cross<N: Number>(a: &[N], b: &[N]) -> [N; 3] {
    [
        (a[1] * b[2]).minus_product(a[2], b[1]),
        (a[2] * b[0]).minus_product(a[0], b[2]),
        (a[0] * b[1]).minus_product(a[1], b[0]),
    ]
}

/// The screw with this axis through a point, and the advance for each radian.
#[inline(always)]
fn screw<N: Number>(axis: &[N; 3], point: &[N; 3], advance: f64) -> Twist<N> {
    let moment = cross(point, axis);
    let mut out = [axis[0], axis[1], axis[2], moment[0], moment[1], moment[2]];
    if advance != 0.0 {
        for k in 0..3 {
            out[k + 3] = out[k + 3].plus_product(axis[k], N::splat(advance));
        }
    }
    out
}

/// `[a, b]`: how the screw `b` changes while its body moves with the twist `a`.
///
/// Source: docs/theory.md, (13).
#[inline(always)]
pub(super) fn bracket<N: Number>(a: &Twist<N>, b: &Twist<N>) -> Twist<N> {
    let turn = cross(&a[..3], &b[..3]);
    let (first, second) = (cross(&a[..3], &b[3..]), cross(&a[3..], &b[..3]));
    [
        turn[0],
        turn[1],
        turn[2],
        first[0] + second[0],
        first[1] + second[1],
        first[2] + second[2],
    ]
}

/// The twist of rates by the screws.
#[inline(always)]
pub(super) fn twist_of<N: Number>(screws: &[Twist<N>; COLUMNS], rates: &Columns<N>) -> Twist<N> {
    let mut sum = [N::splat(0.0); 6];
    for c in 0..COLUMNS {
        for k in 0..6 {
            sum[k] = sum[k].plus_product(screws[c][k], rates[c]);
        }
    }
    sum
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
        Self { joints, first, links, columns, around, halves: Vec::new() }
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

    /// How far the loop is from closing: the greater of the angle [rad] and the gap in parts of the size.
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

/// An angle moved by whole turns into (-pi, pi].
#[inline(always)]
pub(super) fn short_way(angle: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    // rounds without a call
    let turns = (angle / turn + ROUNDER) - ROUNDER;
    let short = angle - turn * turns;
    if short <= -std::f64::consts::PI {
        short + turn
    } else {
        short
    }
}

/// The images of the axes after a rotation that acts before them.
#[inline(always)]
fn turned<N: Number>(axes: &[[N; 3]; 3], by: &Rotation<N>) -> [[N; 3]; 3] {
    let mut out = [[N::splat(0.0); 3]; 3];
    for j in 0..3 {
        for k in 0..3 {
            out[j][k] = (axes[0][k] * by[0][j])
                .plus_product(axes[1][k], by[1][j])
                .plus_product(axes[2][k], by[2][j]);
        }
    }
    out
}

#[inline(always)]
fn splatted<N: Number>(r: &Rotation) -> Rotation<N> {
    let mut out = [[N::splat(0.0); 3]; 3];
    for i in 0..3 {
        for j in 0..3 {
            out[i][j] = N::splat(r[i][j]);
        }
    }
    out
}

#[inline(always)]
fn dot3<N: Number>(a: &[N], b: &[N]) -> N {
    (a[0] * b[0]).plus_product(a[1], b[1]).plus_product(a[2], b[2])
}

#[inline(always)]
pub(super) fn product<N: Number>(a: &Rotation<N>, b: &Rotation<N>) -> Rotation<N> {
    let mut out = [[N::splat(0.0); 3]; 3];
    for i in 0..3 {
        for j in 0..3 {
            out[i][j] = (a[i][0] * b[0][j])
                .plus_product(a[i][1], b[1][j])
                .plus_product(a[i][2], b[2][j]);
        }
    }
    out
}

pub(super) fn transposed(a: &Rotation) -> Rotation {
    std::array::from_fn(|i| std::array::from_fn(|j| a[j][i]))
}

/// The turn about a vector by its length, by the unit quaternion.
#[inline(always)]
pub(super) fn rotation<N: Number>(v: [N; 3]) -> Rotation<N> {
    let (one, two, half) = (N::splat(1.0), N::splat(2.0), N::splat(0.5));
    let angle = dot3(&v, &v).sqrt();
    let (s, w) = (half * angle).sin_cos();
    let factor = angle.if_greater(N::splat(1e-8), s / angle, half);
    let [x, y, z] = [v[0] * factor, v[1] * factor, v[2] * factor];
    [
        [
            one - two * (y * y + z * z),
            two * (x * y - w * z),
            two * (x * z + w * y),
        ],
        [
            two * (x * y + w * z),
            one - two * (x * x + z * z),
            two * (y * z - w * x),
        ],
        [
            two * (x * z - w * y),
            two * (y * z + w * x),
            one - two * (x * x + y * y),
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
#[inline(always)]
pub(super) fn squared_up<N: Number>(r: &Rotation<N>) -> Rotation<N> {
    let one = N::splat(1.0);
    let mut x = [r[0][0], r[1][0], r[2][0]];
    let mut y = [r[0][1], r[1][1], r[2][1]];
    let length = one / dot3(&x, &x).sqrt();
    for x in &mut x {
        *x = *x * length;
    }
    let along = dot3(&x, &y);
    for k in 0..3 {
        y[k] = y[k].minus_product(x[k], along);
    }
    let length = one / dot3(&y, &y).sqrt();
    for y in &mut y {
        *y = *y * length;
    }
    let z = cross(&x, &y);
    [[x[0], y[0], z[0]], [x[1], y[1], z[1]], [x[2], y[2], z[2]]]
}
