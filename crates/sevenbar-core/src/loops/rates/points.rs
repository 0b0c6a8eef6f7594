//! Twists of links as power series in time, and the points that the links carry.
//!
//! Source: docs/theory.md, (13) to (16).

use super::velocities::{ORDERS, Rates};
use crate::loops::equation::chain::{Chain, Configuration};
use crate::loops::equation::closed::Closed;
use crate::loops::equation::dense::COLUMNS;
use crate::loops::equation::screws::Twist;
use crate::rigid::{Pose, Vec3};

/// The series of the twist of the link after a joint, in the frame of the first joint: `V0 + V1 t + V2 t^2`.
pub(crate) fn link_twist(chain: &Chain, at: &Configuration, rates: &Rates, joint: usize) -> [Twist; ORDERS] {
    let mut screws = [chain.place(at).screws, [[0.0; 6]; COLUMNS], [[0.0; 6]; COLUMNS]];
    for order in 1..ORDERS {
        chain.carry(at, &mut screws, rates, order);
    }
    let end = chain.first.get(joint + 1).copied().unwrap_or(chain.columns);
    let mut twists = [[0.0; 6]; ORDERS];
    for c in 0..end {
        for a in 0..ORDERS {
            for b in 0..=a {
                for k in 0..6 {
                    twists[a][k] += screws[b][c][k] * rates[a - b][c];
                }
            }
        }
    }
    twists
}

/// A point carried by a link with the series of its twist: position, velocity, acceleration, jerk.
///
/// Source: docs/theory.md, (16).
pub(crate) fn point_rates(place: Vec3, twist: &[Twist; ORDERS]) -> [Vec3; 4] {
    let mut series = [[0.0; 3]; 4];
    series[0] = place;
    for order in 1..4 {
        let lower = order - 1;
        let mut sum: Vec3 = std::array::from_fn(|k| twist[lower][k + 3]);
        for a in 0..=lower {
            let turn = [twist[a][0], twist[a][1], twist[a][2]];
            let part = crate::rigid::cross(turn, series[lower - a]);
            for k in 0..3 {
                sum[k] += part[k];
            }
        }
        series[order] = sum.map(|x| x / order as f64);
    }
    [
        series[0],
        series[1],
        series[2].map(|x| 2.0 * x),
        series[3].map(|x| 6.0 * x),
    ]
}

/// The frame of the first joint, in which twists are written, moved into the report frame.
pub(crate) fn in_report_frame(base: &Pose, place: Vec3, rates: [Vec3; 4]) -> [Vec3; 4] {
    [
        base.carry(place),
        base.turn(rates[1]),
        base.turn(rates[2]),
        base.turn(rates[3]),
    ]
}
