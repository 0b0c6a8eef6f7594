//! Rigid motions that depend on numbers of a description, with the twists by which each number moves them.
//!
//! A number that changes by dp moves what stands behind a factor by the twist w dp in the frame there, and that goes through all
//! behind it:
//!
//! `dF = F w dp`, `F = A B: w = Ad(B^-1) w_A + w_B`
//!
//! Source: docs/theory_design.md, (2).

use super::twists::{adjoined, plus};
use crate::loops::equation::screws::Twist;
use crate::rigid::{Pose, Vec3, add, cross, dot, most_perpendicular_axis, norm, scale, sub};

/// Below this share of the way to a place the place lies on an axis.
const ON_AXIS: f64 = 1e-12;

/// Below this sine of the angle between a coupler and the axis before it another axis holds its spin.
const SPIN_UNDEFINED: f64 = 1e-8;

/// What is rounding of a cosine or sine at most, however large the angle.
const MOST_ROUNDING: f64 = 1e-9;

/// Where the three numbers of a vector stand among those of the description.
pub type Three = [usize; 3];

/// The frame on a joint as drawn, its z along the first or second axis, x towards another joint.
///
/// Its numbers move the line; a turn about the line itself, before and behind the joint, changes nothing, unless the joint slides
/// in a plane.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnFrame {
    /// Its place.
    pub at: Three,
    /// Its one axis, two of U, none of a ball.
    pub axes: Vec<Three>,
    /// Which axis is its z.
    pub which: usize,
    /// The place towards which x goes where there is one axis.
    pub towards: Three,
    /// Whether x counts: that of a joint that slides across its line.
    pub has_plane: bool,
}

/// An axis that numbers make, or a given one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Axis {
    /// The numbers, of any length.
    Written(Three),
    /// The axis.
    Given(Vec3),
}

/// The frame of an axis, seen from a drawn ball, about which it turns as its link's spin is held.
#[derive(Clone, Debug, PartialEq)]
pub struct Held {
    /// The axis of the joint before, or the given one.
    pub axis: Axis,
    /// The places of the ball and of the next one.
    pub line: [Three; 2],
    /// 0 for the axis, 1 for one square to it and to the line, 2 for the one square to both, about which it does not turn; 3 for
    /// that one where something slides along it.
    pub which: usize,
}

/// A rigid motion that depends on numbers, in radians and lengths.
#[derive(Clone, Debug, PartialEq)]
pub enum Factor {
    /// One that depends on nothing.
    Still(Pose),
    /// A turn about an axis 0, 1, 2 by a number.
    Turn(usize, usize),
    /// A slide along an axis 0, 1, 2 by a number.
    Slide(usize, usize),
    /// The frame on a joint as drawn.
    Drawn(DrawnFrame),
    /// The frame of an axis about which a drawn ball turns.
    Held(Held),
}

/// Motions one after the other, some of them backwards.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Product(Vec<(Factor, bool)>);

/// A vector, and what it changes by.
type Changing = [Vec3; 2];

/// The axes of a frame and its origin.
type Frame = [Changing; 4];

const STILL: Changing = [[0.0; 3]; 2];

/// A vector of numbers, of which one changes.
fn vector(values: &[f64], place: Three, by: Option<usize>) -> Changing {
    [
        place.map(|k| values[k]),
        place.map(|k| if Some(k) == by { 1.0 } else { 0.0 }),
    ]
}

fn minus(a: Changing, b: Changing) -> Changing {
    [sub(a[0], b[0]), sub(a[1], b[1])]
}

fn square_to(a: Changing, b: Changing) -> Changing {
    [cross(a[0], b[0]), add(cross(a[1], b[0]), cross(a[0], b[1]))]
}

/// `a / |a|`
fn unit(a: Changing) -> Changing {
    let length = norm(a[0]);
    let [way, by] = a.map(|v| v.map(|x| x / length));
    [way, sub(by, scale(way, dot(way, by)))]
}

/// `a - (a . z) z`
fn across(a: Changing, z: Changing) -> Changing {
    let along = dot(a[0], z[0]);
    let by = dot(a[1], z[0]) + dot(a[0], z[1]);
    let plain = |v: Vec3, way: Vec3, length: f64| sub(v, scale(way, length));
    [
        plain(a[0], z[0], along),
        plain(plain(a[1], z[0], by), z[1], along),
    ]
}

/// Axes x, y, z: z as it is, x across it towards a place (any where that lies on the axis).
fn frame_about(z: Changing, towards: Changing) -> [Changing; 3] {
    let mut x = across(towards, z);
    if norm(x[0]) <= ON_AXIS * norm(towards[0]) {
        x = across([most_perpendicular_axis(z[0]), [0.0; 3]], z);
    }
    // of a place almost on the axis the first step leaves little but rounding, some of it along the axis
    let x = unit(across(unit(x), z));
    [x, square_to(z, x), z]
}

/// The rotation about an axis; quarter turns are exact: a cosine or sine of which only rounding is left is 0.
fn about(axis: usize, angle: f64) -> [Vec3; 3] {
    let rounding = (f64::EPSILON * angle.abs()).min(MOST_ROUNDING);
    let (s, c) = angle.sin_cos();
    let [s, c] = [s, c].map(|x| if x.abs() < rounding { 0.0 } else { x });
    let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut out = Pose::STILL.rotation;
    (out[j][j], out[j][k]) = (c, -s);
    (out[k][j], out[k][k]) = (s, c);
    out
}

impl DrawnFrame {
    fn frame(&self, values: &[f64], by: Option<usize>) -> Frame {
        let at = vector(values, self.at, by);
        let axis = |k: usize| unit(vector(values, self.axes[k], by));
        let [x, y, z] = match self.axes.len() {
            0 => Pose::STILL.rotation.map(|axis| [axis, [0.0; 3]]),
            1 => frame_about(axis(0), minus(vector(values, self.towards, by), at)),
            _ => {
                let (z, x) = (axis(self.which), unit(square_to(axis(0), axis(1))));
                [x, square_to(z, x), z]
            }
        };
        [x, y, z, at]
    }
}

impl Held {
    /// `None` for its changes where the line lies along the axis, and another one stands in.
    fn frame(&self, values: &[f64], by: Option<usize>) -> (Frame, bool) {
        let [ball, next] = self.line.map(|place| vector(values, place, by));
        let line = minus(next, ball);
        let axis = match self.axis {
            Axis::Written(place) => unit(vector(values, place, by)),
            Axis::Given(axis) => unit([axis, [0.0; 3]]),
        };
        let mut second = square_to(axis, line);
        let is_lost = norm(second[0]) <= SPIN_UNDEFINED * norm(line[0]);
        if is_lost {
            second = square_to([most_perpendicular_axis(line[0]), [0.0; 3]], line);
        }
        let second = unit(second);
        let [x, y, z] = match self.which {
            0 => frame_about(axis, second),
            1 => frame_about(second, axis),
            _ => frame_about(unit(square_to(axis, second)), axis),
        };
        ([x, y, z, STILL], is_lost)
    }
}

impl Factor {
    /// The numbers that it holds.
    fn numbers(&self) -> Vec<usize> {
        match self {
            Self::Still(_) => Vec::new(),
            Self::Turn(_, number) | Self::Slide(_, number) => vec![*number],
            Self::Drawn(own) => {
                let towards = (own.axes.len() == 1).then_some(own.towards);
                let all = own.axes.iter().copied().chain([own.at]).chain(towards);
                all.flatten().collect()
            }
            Self::Held(own) => {
                let axis = if let Axis::Written(place) = own.axis {
                    Some(place)
                } else {
                    None
                };
                own.line.into_iter().chain(axis).flatten().collect()
            }
        }
    }

    /// The motion.
    fn pose(&self, values: &[f64]) -> Pose {
        let frame = match self {
            Self::Still(pose) => return *pose,
            Self::Turn(axis, number) => return Pose::turning(about(*axis, values[*number])),
            Self::Slide(axis, number) => {
                let mut pose = Pose::STILL;
                pose.translation[*axis] = values[*number];
                return pose;
            }
            Self::Drawn(own) => own.frame(values, None),
            Self::Held(own) => own.frame(values, None).0,
        };
        Pose {
            rotation: std::array::from_fn(|i| std::array::from_fn(|j| frame[j][0][i])),
            translation: frame[3][0],
        }
    }

    /// The twist in the frame behind it by one of a number that it holds.
    fn twist(&self, values: &[f64], number: usize) -> Twist {
        let mut out = [0.0; 6];
        let ([x, y, z, at], has_plane) = match self {
            Self::Still(_) => return out,
            Self::Turn(axis, _) => {
                out[*axis] = 1.0;
                return out;
            }
            Self::Slide(axis, _) => {
                out[*axis + 3] = 1.0;
                return out;
            }
            Self::Drawn(own) => (own.frame(values, Some(number)), own.has_plane),
            Self::Held(own) => {
                let (frame, is_lost) = own.frame(values, Some(number));
                if is_lost || own.which == 2 {
                    // nothing turns about it, so where it is does not matter
                    return out;
                }
                (frame, false)
            }
        };
        out[0] = -dot(y[0], z[1]);
        out[1] = dot(x[0], z[1]);
        if has_plane {
            out[2] = dot(y[0], x[1]);
        }
        for (k, axis) in [x, y, z].iter().enumerate() {
            out[k + 3] = dot(axis[0], at[1]);
        }
        out
    }
}

impl Product {
    /// One motion.
    pub fn of(factor: Factor) -> Self {
        Self(vec![(factor, false)])
    }

    /// It, and another behind it; what meets itself backwards goes.
    pub fn then(&self, other: &Self) -> Self {
        let mut all = self.0.clone();
        for (factor, back) in &other.0 {
            if all
                .last()
                .is_some_and(|(last, way)| way != back && last == factor)
            {
                all.pop();
            } else {
                all.push((factor.clone(), *back));
            }
        }
        Self(all)
    }

    /// It backwards.
    pub fn back(&self) -> Self {
        Self(
            self.0
                .iter()
                .rev()
                .map(|(factor, back)| (factor.clone(), !back))
                .collect(),
        )
    }

    /// The numbers that it holds.
    pub fn numbers(&self) -> impl Iterator<Item = usize> {
        self.0.iter().flat_map(|(factor, _)| factor.numbers())
    }

    /// The numbers by which it slides along an axis.
    pub fn slides(&self) -> impl Iterator<Item = usize> {
        self.0.iter().filter_map(|(factor, _)| match factor {
            Factor::Slide(_, number) => Some(*number),
            _ => None,
        })
    }

    /// The motion.
    pub fn pose(&self, values: &[f64]) -> Pose {
        self.0.iter().fold(Pose::STILL, |pose, (factor, back)| {
            let own = factor.pose(values);
            pose.then(&if *back { own.inverse() } else { own })
        })
    }

    /// The twists in the frame behind it by one of each of `only` some numbers, by their places there.
    pub fn moves(&self, values: &[f64], only: &[usize]) -> Vec<(usize, Twist)> {
        let mut found: Vec<(usize, Twist)> = Vec::new();
        let mut behind = Pose::STILL;
        for (factor, back) in self.0.iter().rev() {
            let own = factor.pose(values);
            let numbers = factor.numbers();
            for (place, &number) in only.iter().enumerate().filter(|(_, n)| numbers.contains(n)) {
                let mut twist = factor.twist(values, number);
                if *back {
                    twist = adjoined(&own, &twist).map(|x| -x);
                }
                let seen = adjoined(&behind, &twist);
                match found.iter_mut().find(|known| known.0 == place) {
                    Some(known) => plus(&mut known.1, &seen, 1.0),
                    None => found.push((place, seen)),
                }
            }
            behind = behind.then(&if *back { own } else { own.inverse() });
        }
        found
    }
}
