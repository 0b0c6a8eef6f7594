//! The closed chain as it is followed: at most seven freedoms, a closure error, and the joints' screws.
//!
//! Source: docs/theory.md, (1) to (5).

use super::closed::{At, Closed, Inverse, Joint, Placed, Screws};
use super::dense::{COLUMNS, Columns, Factored, ROWS};
use super::flat::Flat;
use super::rotations::{dot3, splatted, turned};
use super::screws::{bracket, screw};
use crate::number::Number;
use crate::rigid::{Pose, norm};
use std::fmt::Debug;

/// The closure error [rad, or relative to the size] up to which redundant constraints agree by default: a nanometre in a metre, far below
/// what can be made or measured, and far above rounding.
pub const AGREE: f64 = 1e-9;

/// Most balls in seven columns.
pub(crate) const BALLS: usize = 2;

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

/// Where a chain's joints stand.
pub(crate) type Configuration<N = f64> = At<Chain, N>;

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
            drawn: Configuration::zero(),
        }
    }

    /// Whether a configuration is the one of its pose that counts.
    pub fn counts(&self, at: &Configuration) -> bool {
        let value = |joint: usize| at.values[self.first[joint]];
        self.halves.iter().all(|half| {
            let more = half.line.map_or(0.0, |(joint, flat)| flat.angle(value(joint)));
            (value(half.joint) + more - half.middle).cos() > 0.0
        })
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

impl Closed for Chain {
    type Columns<T: Copy + Debug> = [T; COLUMNS];
    type Rows<T: Copy + Debug> = [T; ROWS - 1];
    type Bordered<T: Copy + Debug> = [T; ROWS];
    type Balls<T: Copy + Debug> = [T; BALLS];
    type Cycles<T: Copy + Debug> = [T; 1];

    #[inline(always)]
    fn joints(&self) -> &[Joint] {
        &self.joints
    }

    #[inline(always)]
    fn first(&self) -> &[usize] {
        &self.first
    }

    #[inline(always)]
    fn columns(&self) -> usize {
        self.columns
    }

    fn agree(&self) -> f64 {
        self.agree
    }

    #[inline(always)]
    fn place<N: Number>(&self, at: &Configuration<N>) -> Placed<Self, N> {
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

    #[inline(always)]
    fn residual<N: Number>(&self, placed: &Placed<Self, N>) -> N {
        // the greater of the angle and the gap
        let e = &placed.error;
        let (turn, gap) = (dot3(&e[..3], &e[..3]).sqrt(), dot3(&e[3..], &e[3..]).sqrt());
        // turned right round the antisymmetric part is small again
        let turn = N::splat(0.0).if_greater(placed.closing_cosine, turn + N::splat(1.0), turn);
        turn.if_greater(gap, turn, gap)
    }

    #[inline(always)]
    fn inverse<N: Number>(&self, screws: &Screws<Self, N>, row: &Columns<N>) -> Inverse<Self, N> {
        let mut columns = [[N::splat(0.0); ROWS]; COLUMNS];
        for c in 0..self.columns {
            columns[c][..6].copy_from_slice(&screws[c]);
            columns[c][6] = row[c];
        }
        Inverse(Factored::new(columns, self.columns).inverse())
    }

    /// A joint's screw is carried by the link before it.
    #[inline(always)]
    fn carry<N: Number, const TERMS: usize>(
        &self,
        _at: &Configuration<N>,
        screws: &mut [Screws<Self, N>; TERMS],
        rates: &[Columns<N>; TERMS],
        order: usize,
    ) {
        let zero = N::splat(0.0);
        // of the link before each joint
        let mut twists = [[zero; 6]; TERMS];
        let inverse = N::splat(1.0 / order as f64);
        for (joint, &first) in self.joints.iter().zip(&self.first) {
            let width = joint.columns();
            for c in first..first + width {
                let mut sum = bracket(&twists[0], &screws[order - 1][c]);
                for a in 1..order {
                    let part = bracket(&twists[a], &screws[order - 1 - a][c]);
                    for k in 0..6 {
                        sum[k] = sum[k] + part[k];
                    }
                }
                for k in 0..6 {
                    screws[order][c][k] = sum[k] * inverse;
                }
            }
            for c in first..first + width {
                for a in 0..order {
                    for b in 0..=a {
                        for k in 0..6 {
                            twists[a][k] = twists[a][k].plus_product(screws[b][c][k], rates[a - b][c]);
                        }
                    }
                }
            }
        }
    }

    #[inline(always)]
    fn farthest<N: Number>(&self, at: &Configuration<N>) -> [N; 1] {
        // a little more where the loop does not quite close
        let mut around = N::splat(1.02 * self.around);
        let mut least = N::splat(0.0);
        for (joint, &c) in self.joints.iter().zip(&self.first) {
            let advance = match *joint {
                Joint::Slide => 1.0,
                Joint::Screw(advance) => advance,
                _ => continue,
            };
            around = around + (at.values[c] * N::splat(advance)).size();
            least = N::splat(1.0);
        }
        let half = around * N::splat(0.5);
        [half.if_greater(least, half, least)]
    }

    #[inline(always)]
    fn bounds<N: Number>(&self, inverse_norm: N, [far]: &[N; 1], rates: &[Columns<N>; 3], s: N) -> [N; 2] {
        let (mut u, mut v, mut w) = (N::splat(0.0), N::splat(0.0), N::splat(0.0));
        let mut third = N::splat(0.0);
        for c in 0..self.columns {
            // the screw of a column is carried by those before it
            let z = (u * u * u).plus_product(N::splat(3.0) * u, v) + w;
            let p =
                *far * ((N::splat(8.0) * u * u * u).plus_product(N::splat(12.0) * u, v) + N::splat(2.0) * w);
            third = third.plus_product(z, z).plus_product(p, p);
            let [a, b, c] = [rates[0][c].size(), rates[1][c].size(), rates[2][c].size()];
            let slope = b.plus_product(c, s);
            u = u + a.plus_product(slope, s);
            v = v + slope.plus_product(c, s);
            w = w + N::splat(2.0) * c;
        }
        let fifth = u * u * u * (u * u + N::splat(10.0) * v)
            + N::splat(15.0) * u * v * v
            + N::splat(10.0) * w * (u * u + v);
        let lever = (N::splat(1.0) + *far * *far).sqrt();
        [inverse_norm * third.sqrt(), inverse_norm * lever * fifth]
    }

    #[inline(always)]
    fn across<N: Number>(&self, [far]: &[N; 1], square: N) -> N {
        let pairs = (self.columns * (self.columns - 1)) as f64 / 2.0;
        let turning = N::splat(pairs.sqrt()) * (N::splat(1.0) + N::splat(4.0) * *far * *far).sqrt();
        turning.plus_product(N::splat(2.2), square)
    }
}
