//! Where a turning joint can be: the ranges in which the loop closes, from the zeros of one quartic.

use super::pair::Pair;
use crate::trigonometric::within_turn;
use std::f64::consts::{PI, TAU};

/// The range of one turning joint on one circuit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Extent {
    /// Every angle.
    Full,
    /// From a first angle to a greater last one.
    Arc(f64, f64),
}

impl Extent {
    /// How far `angle` lies outside, going round; 0 inside.
    pub(super) fn distance(&self, angle: f64) -> f64 {
        match *self {
            Self::Full => 0.0,
            Self::Arc(start, end) => {
                let beyond = (angle - start).rem_euclid(TAU) - (end - start);
                if beyond <= 0.0 {
                    0.0
                } else {
                    beyond.min(TAU - (end - start) - beyond)
                }
            }
        }
    }

    /// The same range moved by whole turns so that it holds, or nearly holds, `angle`.
    pub(super) fn holding(&self, angle: f64) -> Self {
        match *self {
            Self::Full => Self::Full,
            Self::Arc(start, end) => {
                let turns = ((angle - 0.5 * (start + end)) / TAU).round() * TAU;
                Self::Arc(start + turns, end + turns)
            }
        }
    }

    /// The angle moved by whole turns to where it is nearest to the middle of this range.
    pub(super) fn unwrap(&self, angle: f64) -> f64 {
        match *self {
            Self::Full => angle,
            Self::Arc(start, end) => {
                let centre = 0.5 * (start + end);
                centre + turn_between(centre, angle)
            }
        }
    }
}

/// Where a turning joint can be.
#[derive(Clone, Debug, Default)]
pub(super) struct Domain {
    pub(super) extents: Vec<Extent>,
    /// Angles inside an extent where the two solutions meet and part again.
    pub(super) touches: Vec<f64>,
    pub(super) limits: Vec<f64>,
    /// Where zeros meet, or are not distinct.
    pub(super) change_points: Vec<f64>,
    /// True where rounding decides how many extents there are.
    pub(super) degenerate: bool,
}

impl Domain {
    pub(super) fn new(pair: &Pair) -> Self {
        let discriminant = pair.discriminant();
        let Some(mut zeros) = discriminant.zeros(pair.discriminant_noise()) else {
            return Self { extents: vec![Extent::Full], degenerate: true, ..Self::default() };
        };
        for zero in zeros.iter_mut().filter(|z| !z.multiple) {
            zero.angle = within_turn(pair.polished_limit(zero.angle));
        }
        zeros.sort_by(|a, b| a.angle.total_cmp(&b.angle));
        let change_points: Vec<f64> = zeros.iter().filter(|z| z.multiple).map(|z| z.angle).collect();
        let angles: Vec<f64> = zeros.iter().map(|z| z.angle).collect();
        let count = angles.len();
        if count == 0 {
            let assembles = discriminant.value(0.0) > 0.0;
            return Self {
                extents: if assembles { vec![Extent::Full] } else { Vec::new() },
                ..Self::default()
            };
        }
        let next = |i: usize| {
            if i + 1 < count {
                angles[i + 1]
            } else {
                angles[0] + TAU
            }
        };
        let open: Vec<bool> = (0..count)
            .map(|i| discriminant.value(0.5 * (angles[i] + next(i))) > 0.0)
            .collect();
        let before = |i: usize| open[(i + count - 1) % count];

        let mut domain = Self {
            extents: Vec::new(),
            touches: (0..count)
                .filter(|&i| open[i] && before(i))
                .map(|i| angles[i])
                .collect(),
            limits: (0..count)
                .filter(|&i| open[i] != before(i))
                .map(|i| angles[i])
                .collect(),
            // a simple zero that changes no sign is one that rounding made
            degenerate: !change_points.is_empty()
                || (0..count).any(|i| !zeros[i].multiple && open[i] == before(i)),
            change_points,
        };
        if domain.limits.is_empty() && open[0] {
            domain.extents.push(Extent::Full);
        }
        for start in (0..count).filter(|&i| open[i] && !before(i)) {
            let mut last = start;
            while open[(last + 1) % count] {
                last += 1;
            }
            let turns = if last + 1 >= count { TAU } else { 0.0 };
            domain
                .extents
                .push(Extent::Arc(angles[start], angles[(last + 1) % count] + turns));
        }
        domain
    }

    pub(super) fn turns_fully(&self) -> bool {
        matches!(self.extents[..], [Extent::Full])
    }
}

/// The signed turn in [-pi, pi) that leads from one angle to another.
pub(super) fn turn_between(from: f64, to: f64) -> f64 {
    (to - from + PI).rem_euclid(TAU) - PI
}
