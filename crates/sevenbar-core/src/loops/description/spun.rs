//! The idle spin of two links between two balls, with one joint between the links, about the line through the balls.
//!
//! The rest of the loop does not depend on that spin, only on the distance of the balls. So the chain that is followed replaces the two
//! links by a flat triangle (for a slide: a straight path in a plane) that gives the same distance at each value of the joint, and the
//! first ball by two turns. The axis of the second turn is normal to that plane: the line through the balls lies in the plane, so it can
//! take any direction. How the actual links are turned about the line is added afterwards.
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

/// A path closer to the ball than this part of the size counts as one through the ball, which defines no plane.
const STRAIGHT: f64 = 1e-8;

/// Values of a joint, over two turns, at which the line through the balls is checked: one a degree.
const CHECKED_VALUES: usize = 720;

/// Two links between two balls and the joint between them, in the frame of the first ball.
#[derive(Clone, Debug)]
pub(crate) struct Spun {
    kind: Kind,
    /// The joint's frame in that of the first ball, and the second ball's centre in the joint's frame.
    joint: Pose,
    end: Vec3,
    /// A direction on the first link that the line through the balls never comes near.
    across: Vec3,
    flat: Flat,
    /// Columns: the line at joint value zero, the direction across it in the plane, the plane's normal.
    plane: Rotation,
    /// From [`Self::flat_frame`] to [`Self::frame`] at zero.
    between: Rotation,
    /// The rotation from the first ball to the second at zero.
    through: Rotation,
}

impl Spun {
    /// From the frame of a turn or a slide in that of the first ball, and the transform `rest` from there to the second ball. `normal`
    /// is the axis of the first ball's second turn.
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
        // where the two centres coincide at zero, their line has no direction there
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

    /// The flat triangle or path that replaces the links.
    pub fn flat(&self) -> Flat {
        self.flat
    }

    /// The frame of the flat triangle's joint, and the transform from there to the second ball.
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

    /// The vector from the first ball to the second on the actual links.
    fn line<const N: usize>(&self, value: Taylor<N>) -> Vec3Taylor<N> {
        self.beyond(value, self.end)
    }

    /// A point of the second link, in the frame of the first ball.
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

    /// The frame of the actual links: x along the line, y normal to the direction that the line never comes near.
    fn frame<const N: usize>(&self, value: Taylor<N>) -> Series<N> {
        let x = unit_taylor(self.line(value));
        let y = unit_taylor(cross_taylor(self.across.map(Taylor::constant), x));
        columns([x, y, cross_taylor(x, y)])
    }

    /// The frame of the flat triangle: x along its line, z normal to its plane.
    fn flat_frame<const N: usize>(&self, value: Taylor<N>) -> Series<N> {
        let [along, aside] = self.flat.line(value);
        let size = (along * along + aside * aside).sqrt().recip();
        let (c, s) = (along * size, aside * size);
        let (zero, one) = (Taylor::constant(0.0), Taylor::constant(1.0));
        let turn = [[c, -s, zero], [s, c, zero], [zero, zero, one]];
        turned_series(&self.plane, &turn, &Pose::STILL.rotation)
    }

    /// The rotation of the first link in the frame of the flat triangle.
    pub fn lie<const N: usize>(&self, value: Taylor<N>) -> Series<N> {
        let flat = turned_series(&Pose::STILL.rotation, &self.flat_frame(value), &self.between);
        product_series(&flat, &swapped(&self.frame(value)))
    }

    /// The rotation of the frame before the second ball on the triangle, relative to the same frame on the actual links.
    pub fn lie_beyond<const N: usize>(&self, value: Taylor<N>) -> Series<N> {
        let normal: Vec3 = std::array::from_fn(|k| self.plane[k][2]);
        let flat = self.turned(normal, value);
        let moved = product_series(
            &swapped(&self.through(value)),
            &product_series(&swapped(&self.lie(value)), &flat),
        );
        turned_series(&Pose::STILL.rotation, &moved, &self.through)
    }

    /// The rotation from the first ball to the second on the actual links.
    pub fn through<const N: usize>(&self, value: Taylor<N>) -> Series<N> {
        let turn = self.turned(self.joint.column(2), value);
        turned_series(&Pose::STILL.rotation, &turn, &self.through)
    }

    /// The joint's rotation, about an axis given in the first ball's frame (none for a slide).
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

    /// The unit vector along the line, on the actual links and on the triangle.
    pub fn directions(&self, value: f64) -> [Vec3; 2] {
        let value = Taylor::<1>::constant(value);
        let flat = self.flat_frame(value);
        [
            unit_taylor(self.line(value)).map(|x| x.value()),
            std::array::from_fn(|i| flat[i][0].value()),
        ]
    }
}

/// The arms of the flat triangle in which two balls have the same distance as on a turning joint at every angle. With a and b the
/// balls' distances from the joint's axis and h their distance along it, the arms r and s obey r s = a b and r^2 + s^2 = a^2 + b^2 + h^2.
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

/// A direction, in the frame of a joint, that the line through two balls never comes near while the joint moves. For a slide it is the
/// normal of the plane in which the line moves. For a turn it is the axis, or the normal of axis and first arm, whichever the line
/// stays farther away from.
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
        (0..CHECKED_VALUES)
            .map(|k| {
                let q = 4.0 * std::f64::consts::PI * (k as f64 / CHECKED_VALUES as f64 - 0.5);
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

/// The rotation at the start: the constant terms of a series.
pub(super) fn first_terms<const N: usize>(a: &Series<N>) -> Rotation {
    std::array::from_fn(|i| std::array::from_fn(|j| a[i][j].value()))
}
