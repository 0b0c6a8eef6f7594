//! The spin of several links together about the line of the two balls between which they stand, with one joint among them.
//!
//! No other joint feels that spin, only how far apart the links keep the balls. So the chain that is followed has in their place a
//! flat triangle (or, for a slide, the flat path) that keeps them as far apart at each value of the joint, and the first ball as two
//! turns, the second at right angles to that plane: the balls' line lies in it, so each direction can be reached. How the links
//! themselves lie about the line is put on top.
//!
//! Source: the law of cosines.

use crate::loops::equation::flat::Flat;
use crate::loops::equation::kinds::Kind;
use crate::loops::equation::rotations::{Rotation, product, transposed};
use crate::loops::rates::turns::{product_series, turned_series};
use crate::rigid::{
    Pose, Vec3, Vec3Taylor, cross, cross_taylor, dot, dot_taylor, most_perpendicular_axis, norm, scale,
    scale_taylor, sub, unit,
};
use crate::taylor::Taylor;

/// A moving rotation.
type Series<const N: usize> = [[Taylor<N>; 3]; 3];

/// A path nearer to the ball than this part of the size is taken as one through it, and has no plane.
const STRAIGHT: f64 = 1e-8;

/// Places of a joint, two turns of it, at which its balls' line is checked.
const LOOKS: usize = 720;

/// Links between two balls with one joint among them, in the frame of the first ball.
#[derive(Clone, Debug)]
pub(crate) struct Spun {
    kind: Kind,
    /// The joint as the links have it, and the second ball after it.
    joint: Pose,
    end: Vec3,
    /// A direction of the first link that the line keeps away from.
    across: Vec3,
    flat: Flat,
    /// Columns: the line at zero, across it in the plane, across the plane.
    plane: Rotation,
    /// From [`Self::flat_frame`] to [`Self::frame`] at zero.
    between: Rotation,
    /// The rotation from the first ball to the second at zero.
    through: Rotation,
}

impl Spun {
    /// Of a turn or a slide with this frame in that of the first ball, and the way on to the second; `normal` is the second turn's axis.
    pub fn new(kind: Kind, joint: &Pose, rest: &Pose, normal: Vec3) -> Self {
        let end = rest.translation;
        let line = joint.carry(end);
        let long = norm(line);
        let along = if long > 0.0 {
            unit(sub(line, scale(normal, dot(line, normal))))
        } else {
            most_perpendicular_axis(normal)
        };
        let ball = joint.inverse().translation;
        let flat = if kind == Kind::Slide {
            let way = joint.column(2);
            let forth = dot(way, along);
            Flat::Path([long, 0.0], [forth, norm(sub(way, scale(along, forth)))])
        } else {
            arms(ball, end)
        };
        let mut spun = Self {
            kind,
            joint: *joint,
            end,
            across: joint.turn(away_from_line(kind, ball, end)),
            flat,
            plane: transposed(&[along, cross(normal, along), normal]),
            between: Pose::STILL.rotation,
            through: joint.then(rest).rotation,
        };
        // where the balls lie upon each other at zero, their line has no direction there to begin with
        if long > 0.0 {
            let zero = Taylor::<1>::constant(0.0);
            let (flat, own) = (
                first_terms(&spun.flat_frame(zero)),
                first_terms(&spun.frame(zero)),
            );
            spun.between = product(&transposed(&flat), &own);
        }
        spun
    }

    /// The line in the plane.
    pub fn flat(&self) -> Flat {
        self.flat
    }

    /// The frame of the joint of the flat triangle, and from there to the second ball.
    pub fn flat_joint(&self) -> (Pose, Pose) {
        let column = |v: [f64; 2]| -> Vec3 {
            std::array::from_fn(|k| self.plane[k][0] * v[0] + self.plane[k][1] * v[1])
        };
        let normal: Vec3 = std::array::from_fn(|k| self.plane[k][2]);
        let framed = |z: Vec3, x: Vec3| transposed(&[x, cross(z, x), z]);
        let joint = match self.flat {
            Flat::Arms(near, _) => Pose {
                rotation: framed(normal, column([1.0, 0.0])),
                translation: scale(column(near), -1.0),
            },
            Flat::Path(_, way) => Pose::turning(framed(column(way), normal)),
        };
        let [x, y] = self.flat.line(Taylor::<1>::constant(0.0));
        let end = Pose { rotation: self.through, translation: column([x.value(), y.value()]) };
        (joint, joint.inverse().then(&end))
    }

    /// From the first ball to the second, as the links have it.
    fn line<const N: usize>(&self, value: Taylor<N>) -> Vec3Taylor<N> {
        self.beyond(value, self.end)
    }

    /// A point after the joint.
    pub fn beyond<const N: usize>(&self, value: Taylor<N>, at: Vec3) -> Vec3Taylor<N> {
        let (turn, shift) = match self.kind {
            Kind::Slide => (Taylor::constant(0.0), value),
            _ => (value, Taylor::constant(0.0)),
        };
        let (s, c) = turn.sin_cos();
        let moved = [
            c.scale(at[0]) - s.scale(at[1]),
            s.scale(at[0]) + c.scale(at[1]),
            Taylor::constant(at[2]) + shift,
        ];
        let j = &self.joint;
        std::array::from_fn(|i| {
            (0..3).fold(Taylor::constant(j.translation[i]), |sum, k| {
                sum + moved[k].scale(j.rotation[i][k])
            })
        })
    }

    /// x along the line, y at right angles to the direction that the line keeps away from.
    fn frame<const N: usize>(&self, value: Taylor<N>) -> Series<N> {
        let x = unit_taylor(self.line(value));
        let y = unit_taylor(cross_taylor(self.across.map(Taylor::constant), x));
        columns([x, y, cross_taylor(x, y)])
    }

    /// x along the line of the flat triangle, z across its plane.
    fn flat_frame<const N: usize>(&self, value: Taylor<N>) -> Series<N> {
        let [along, aside] = self.flat.line(value);
        let size = (along * along + aside * aside).sqrt().recip();
        let (c, s) = (along * size, aside * size);
        let (zero, one) = (Taylor::constant(0.0), Taylor::constant(1.0));
        let turn = [[c, -s, zero], [s, c, zero], [zero, zero, one]];
        turned_series(&self.plane, &turn, &Pose::STILL.rotation)
    }

    /// How the first link lies in the frame of the flat triangle.
    pub fn lie<const N: usize>(&self, value: Taylor<N>) -> Series<N> {
        let flat = turned_series(&Pose::STILL.rotation, &self.flat_frame(value), &self.between);
        product_series(&flat, &swapped(&self.frame(value)))
    }

    /// How the frame before the second ball lies as the triangle has it, seen from where the links have it.
    pub fn lie_beyond<const N: usize>(&self, value: Taylor<N>) -> Series<N> {
        let normal: Vec3 = std::array::from_fn(|k| self.plane[k][2]);
        let flat = self.turned(normal, value);
        let moved = product_series(
            &swapped(&self.through(value)),
            &product_series(&swapped(&self.lie(value)), &flat),
        );
        turned_series(&Pose::STILL.rotation, &moved, &self.through)
    }

    /// The rotation from the first ball to the second, as the links have it.
    pub fn through<const N: usize>(&self, value: Taylor<N>) -> Series<N> {
        let turn = self.turned(self.joint.column(2), value);
        turned_series(&Pose::STILL.rotation, &turn, &self.through)
    }

    /// What the joint turns about an axis.
    fn turned<const N: usize>(&self, axis: Vec3, value: Taylor<N>) -> Series<N> {
        let angle = if self.kind == Kind::Turn {
            value
        } else {
            Taylor::constant(0.0)
        };
        let (s, c) = angle.sin_cos();
        let rest = Taylor::constant(1.0) - c;
        let odd = |i: usize, j: usize| match (3 + j - i) % 3 {
            1 => -axis[3 - i - j],
            2 => axis[3 - i - j],
            _ => 0.0,
        };
        std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let even = rest.scale(axis[i] * axis[j]);
                if i == j {
                    even + c
                } else {
                    even + s.scale(odd(i, j))
                }
            })
        })
    }

    /// The unit vector along the line, as the links have it and as the triangle has it.
    pub fn directions(&self, value: f64) -> [Vec3; 2] {
        let value = Taylor::<1>::constant(value);
        let flat = self.flat_frame(value);
        [
            unit_taylor(self.line(value)).map(|x| x.value()),
            std::array::from_fn(|i| flat[i][0].value()),
        ]
    }
}

/// The arms of a flat triangle with the sides that a joint leaves to two balls in its frame: with a and b how far they are from the
/// axis and h one above the other, the arms have the product a b, and squares that add up to a^2 + b^2 + h^2.
///
/// Source: the law of cosines.
fn arms(ball: Vec3, end: Vec3) -> Flat {
    let (a, b) = (ball[0].hypot(ball[1]), end[0].hypot(end[1]));
    let above = end[2] - ball[2];
    let (farthest, nearest) = ((a + b).hypot(above), (a - b).hypot(above));
    let long = 0.5 * (farthest + nearest);
    let short = 2.0 * a * b / (farthest + nearest);
    let (near, far) = if a >= b { (long, short) } else { (short, long) };
    let angle = end[1].atan2(end[0]) - ball[1].atan2(ball[0]);
    let (s, c) = angle.sin_cos();
    // in the frame of the first arm the line at zero is `across`; turned so that it lies along x
    let across = [far * c - near, far * s];
    let size = across[0].hypot(across[1]);
    let (c0, s0) = if size > 0.0 {
        (across[0] / size, -across[1] / size)
    } else {
        (1.0, 0.0)
    };
    let turned = |r: f64, s: f64, c: f64| [r * (c * c0 - s * s0), r * (s * c0 + c * s0)];
    Flat::Arms(turned(near, 0.0, 1.0), turned(far, s, c))
}

/// A direction, in the frame of a joint, that the line of two balls keeps away from while the joint moves: across the plane in which a
/// slide moves it; of a turn the axis, or, if the line keeps farther away from that, what is at right angles to axis and first arm.
pub(super) fn away_from_line(kind: Kind, ball: Vec3, end: Vec3) -> Vec3 {
    let axis = [0.0, 0.0, 1.0];
    if kind == Kind::Slide {
        let across = cross(axis, sub(end, ball));
        return if norm(across) > STRAIGHT {
            unit(across)
        } else {
            [1.0, 0.0, 0.0]
        };
    }
    let advance = if let Kind::Screw(a) = kind { a } else { 0.0 };
    let arm = [ball[0], ball[1], 0.0];
    if norm(arm) <= STRAIGHT {
        return axis;
    }
    let aside = unit(cross(axis, arm));
    let nearest = |from: Vec3| {
        (0..LOOKS)
            .map(|k| {
                let q = 4.0 * std::f64::consts::PI * (k as f64 / LOOKS as f64 - 0.5);
                let (s, c) = q.sin_cos();
                let moved = [
                    c * end[0] - s * end[1],
                    s * end[0] + c * end[1],
                    end[2] + advance * q,
                ];
                let line = sub(moved, ball);
                norm(cross(from, line)) / norm(line).max(f64::MIN_POSITIVE)
            })
            .fold(1.0, f64::min)
    };
    if nearest(aside) > nearest(axis) {
        aside
    } else {
        axis
    }
}

fn unit_taylor<const N: usize>(v: Vec3Taylor<N>) -> Vec3Taylor<N> {
    scale_taylor(v, dot_taylor(v, v).sqrt().recip())
}

fn columns<const N: usize>(c: [Vec3Taylor<N>; 3]) -> Series<N> {
    std::array::from_fn(|i| std::array::from_fn(|j| c[j][i]))
}

fn swapped<const N: usize>(a: &Series<N>) -> Series<N> {
    std::array::from_fn(|i| std::array::from_fn(|j| a[j][i]))
}

/// The rotation that a series begins with.
pub(super) fn first_terms<const N: usize>(a: &Series<N>) -> Rotation {
    std::array::from_fn(|i| std::array::from_fn(|j| a[i][j].value()))
}
