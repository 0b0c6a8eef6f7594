//! The axis that holds the idle spin of links between two balls: one to which their line never becomes parallel.
//!
//! The line is seen from the link before the ball that holds the spin. With two joints on the way to the other ball, each value of
//! the first leaves at most two of the second at which the balls keep their distance, in closed form, so that the directions of the
//! line are curves on the sphere. Where they come near the axis of the joint before, as the rod of an in-line slider-crank comes to
//! lie along the slide, that axis would make singular poses that the loop has not.

use crate::loops::equation::kinds::Kind;
use crate::rigid::{Pose, Vec3, add, cross, dot, norm, scale, sub, unit};

/// The least sine of the angle between the line and the axis before at which that axis holds the spin: three degrees.
const NEAR: f64 = 0.05;

/// Values of the first joint at which the line is checked.
const LOOKS: usize = 96;

/// Directions of the half sphere among which another axis is chosen.
const DIRECTIONS: usize = 48;

/// What leads from one ball to the other on the far side of the line: two joints with a fixed way before, between and after.
pub(super) struct Way {
    pub kinds: [Kind; 2],
    pub poses: [Pose; 3],
}

/// The axis in the frame before the ball that holds the spin: `before`, where the line of this length keeps away from it; else the
/// direction that it keeps farthest away from.
pub(super) fn spin_axis(before: Vec3, way: &Way, length: f64) -> Vec3 {
    let pieces = pieces(way, length);
    let clear = |axis: Vec3| pieces.iter().map(|piece| sine(axis, piece)).fold(1.0, f64::min);
    if pieces.is_empty() || clear(before) >= NEAR {
        return before;
    }
    // the golden spiral
    let turn = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    (0..DIRECTIONS)
        .map(|k| {
            let z = (k as f64 + 0.5) / DIRECTIONS as f64;
            let (s, c) = (k as f64 * turn).sin_cos();
            let level = (1.0 - z * z).sqrt();
            [level * c, level * s, z]
        })
        .chain([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
        .map(|axis| (clear(axis), axis))
        .fold((clear(before), before), |best, next| {
            if next.0 >= best.0 { next } else { best }
        })
        .1
}

/// The least sine of the angle between an axis and the directions of a piece, taken as an arc of a great circle.
fn sine(axis: Vec3, piece: &[Vec3; 2]) -> f64 {
    let [a, b] = *piece;
    let ends = norm(cross(axis, a)).min(norm(cross(axis, b)));
    let normal = cross(a, b);
    let size = norm(normal);
    if size < 1e-12 {
        return ends;
    }
    let normal = scale(normal, 1.0 / size);
    let height = dot(axis, normal);
    let foot = sub(axis, scale(normal, height));
    // the foot lies on the arc, or its opposite does
    let within = |foot: Vec3| dot(cross(a, foot), normal) >= 0.0 && dot(cross(foot, b), normal) >= 0.0;
    if within(foot) || within(scale(foot, -1.0)) {
        height.abs()
    } else {
        ends
    }
}

/// The directions of the line, between neighbouring values of the first joint.
fn pieces(way: &Way, length: f64) -> Vec<[Vec3; 2]> {
    let Some(reach) = reach(way, length) else {
        return Vec::new();
    };
    let full = matches!(way.kinds[0], Kind::Turn);
    let at = |k: usize| {
        let part = k as f64 / LOOKS as f64;
        lines(
            way,
            length,
            if full {
                std::f64::consts::TAU * part
            } else {
                reach * (2.0 * part - 1.0)
            },
        )
    };
    let mut found = Vec::new();
    let mut last: Option<[Vec3; 2]> = None;
    for k in 0..=LOOKS {
        let next = at(k);
        match (last, next) {
            (Some(a), Some(b)) => found.extend([[a[0], b[0]], [a[1], b[1]]]),
            // both run together where a range of the first joint ends
            (Some(ends), None) | (None, Some(ends)) if k > 0 => found.push(ends),
            _ => {}
        }
        last = next;
    }
    found
}

/// How far a slide as the first joint is checked; `None` where the second joint does not move the balls apart, or is a screw.
fn reach(way: &Way, length: f64) -> Option<f64> {
    let start = norm(way.poses[0].inverse().translation);
    let sum = length + start + norm(way.poses[1].translation) + norm(way.poses[2].translation);
    let simple = |kind: Kind| matches!(kind, Kind::Turn | Kind::Slide);
    if !simple(way.kinds[0]) || !simple(way.kinds[1]) {
        return None;
    }
    if way.kinds == [Kind::Slide; 2] {
        let between = way.poses[1].rotation[2];
        let sine = between[0].hypot(between[1]);
        return (sine > NEAR).then(|| sum / sine);
    }
    Some(sum)
}

/// The unit vectors along the line, seen from the link before the ball, at a value of the first joint.
fn lines(way: &Way, length: f64, first: f64) -> Option<[Vec3; 2]> {
    let start = moved_back(way.kinds[0], first, way.poses[0].inverse().translation);
    let start = way.poses[1].inverse().carry(start);
    let end = way.poses[2].translation;
    let values = match way.kinds[1] {
        Kind::Slide => {
            let aside = (start[0] - end[0]).hypot(start[1] - end[1]);
            let square = length * length - aside * aside;
            if square < 0.0 {
                return None;
            }
            [-1.0, 1.0].map(|side| start[2] - end[2] + side * square.sqrt())
        }
        _ => {
            let (a, b) = (start[0].hypot(start[1]), end[0].hypot(end[1]));
            let above = start[2] - end[2];
            let (near, far) = (2.0 * a * b, a * a + b * b + above * above - length * length);
            if near == 0.0 || far.abs() > near {
                return None;
            }
            let cosine = far / near;
            let between = start[1].atan2(start[0]) - end[1].atan2(end[0]);
            [-1.0, 1.0].map(|side| between + side * cosine.acos())
        }
    };
    Some(values.map(|second| {
        let other = sub(moved_back(way.kinds[1], second, start), end);
        unit(way.poses[2].turn_back(other))
    }))
}

/// A point before a joint as the link after it has it.
fn moved_back(kind: Kind, value: f64, at: Vec3) -> Vec3 {
    match kind {
        Kind::Slide => add(at, [0.0, 0.0, -value]),
        _ => {
            let (s, c) = value.sin_cos();
            [c * at[0] + s * at[1], c * at[1] - s * at[0], at[2]]
        }
    }
}
