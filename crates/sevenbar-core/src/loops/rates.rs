//! Velocities, accelerations and jerks: the closure of velocities `sum Si ui = 0` as a power series in time.
//!
//! A joint's screw is carried by the link before it, `Si' = [Vi, Si]` with `Vi = sum Sj uj (j before i)`, so the series of the
//! screws follow from those of the joint rates `u`, and these order by order from one factorised matrix:
//! `A u_k = - sum (a >= 1) Si_a ui_(k-a)`. Nothing is differenced and no angle is differentiated.
//!
//! Source: docs/theory.md, (13) to (16).

use super::chain::{Chain, Configuration, Joint, Placed};
use super::dense::{COLUMNS, Columns, Inverse, ROWS};
use super::rotations::{Rotation, Z_TO_X, transposed};
use super::screws::{Twist, bordered_inverse, bracket, input_row, twist_of};
use crate::number::Number;
use crate::rigid::{Pose, Vec3};
use crate::taylor::Taylor;

/// Orders of the rates: velocity, acceleration, jerk.
pub(super) const ORDERS: usize = 3;

/// Corrections of rates by what they leave over.
const REFINEMENTS: usize = 2;

/// Power series of the joint rates `u(t) = u0 + u1 t + u2 t^2`; a ball's are its angular velocity in the frame before it.
pub(super) type Rates<N = f64> = [Columns<N>; ORDERS];

/// Power series of the joints' screws, of so many terms.
pub(super) type Screws<N, const TERMS: usize = ORDERS> = [[Twist<N>; COLUMNS]; TERMS];

/// The screws' coefficients of an order, from those of lower ones and the rates.
///
/// Source: docs/theory.md, (13) and (14).
#[inline(always)]
pub(super) fn carry<N: Number, const TERMS: usize>(
    chain: &Chain,
    screws: &mut Screws<N, TERMS>,
    rates: &[Columns<N>; TERMS],
    order: usize,
) {
    let zero = N::splat(0.0);
    // of the link before each joint
    let mut twists = [[zero; 6]; TERMS];
    let inverse = N::splat(1.0 / order as f64);
    for (joint, &first) in chain.joints.iter().zip(&chain.first) {
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

/// The joint rates, order by order, and the series of the screws, by the inverse of the screws with one more row, on which
/// the rates are `given`. Where that row holds one column, the inverse may be that of a place very near.
///
/// Source: docs/theory.md, (15).
#[inline(always)]
pub(super) fn rates<N: Number, const TERMS: usize>(
    chain: &Chain,
    placed: &Placed<N>,
    inverse: &Inverse<N>,
    given: &[N; TERMS],
    held: Option<usize>,
) -> ([Columns<N>; TERMS], Screws<N, TERMS>) {
    let zero = N::splat(0.0);
    let mut rates = [[zero; COLUMNS]; TERMS];
    let mut screws = [[[zero; 6]; COLUMNS]; TERMS];
    screws[0] = placed.screws;
    for order in 0..TERMS {
        let mut right = [zero; ROWS];
        if order > 0 {
            carry(chain, &mut screws, &rates, order);
            for a in 1..=order {
                for c in 0..chain.columns {
                    for k in 0..6 {
                        right[k] = right[k].minus_product(screws[a][c][k], rates[order - a][c]);
                    }
                }
            }
        }
        right[6] = given[order];
        let mut solved = inverse.times(&right);
        if let Some(column) = held {
            for _ in 0..REFINEMENTS {
                solved[column] = given[order];
                let mut left = twist_of(&placed.screws, &solved);
                for k in 0..6 {
                    left[k] = right[k] - left[k];
                }
                let more = inverse.times(&left);
                for c in 0..COLUMNS {
                    solved[c] = solved[c] + more[c];
                }
            }
            solved[column] = given[order];
        }
        rates[order] = solved;
    }
    (rates, screws)
}

/// The fourth derivative of a column at a closed configuration, by the input, which has unit speed.
pub(super) fn fourth_derivative(chain: &Chain, at: &Configuration, input: usize, column: usize) -> f64 {
    let placed = chain.place(at);
    let inverse = bordered_inverse(&placed.screws, chain.columns, &input_row(input));
    let (rates, _) = rates(chain, &placed, &inverse, &[1.0, 0.0, 0.0, 0.0], Some(input));
    6.0 * rates[ORDERS][column]
}

/// The series of the twist of the link after a joint, in the frame of the first joint: `V0 + V1 t + V2 t^2`.
pub(super) fn link_twist(chain: &Chain, placed: &Placed, rates: &Rates, joint: usize) -> [Twist; ORDERS] {
    let mut screws: Screws<f64> = [placed.screws, [[0.0; 6]; COLUMNS], [[0.0; 6]; COLUMNS]];
    for order in 1..ORDERS {
        carry(chain, &mut screws, rates, order);
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

/// A joint's turn and slide from the frame before it to that after, as a series.
pub(super) fn joint_series(
    chain: &Chain,
    joint: usize,
    at: &Configuration,
    rates: &Rates,
) -> [[Taylor<4>; 3]; 3] {
    let first = chain.first[joint];
    if let Joint::Ball(b) = chain.joints[joint] {
        let spin = std::array::from_fn(|order| std::array::from_fn(|k| rates[order][first + k]));
        return rotation_series(&at.balls[b], &spin);
    }
    let (s, c) = value_series(chain, joint, at, rates).sin_cos();
    let (zero, one) = (Taylor::constant(0.0), Taylor::constant(1.0));
    [[c, -s, zero], [s, c, zero], [zero, zero, one]]
}

/// The value of a joint that is no ball.
pub(super) fn value_series(chain: &Chain, joint: usize, at: &Configuration, rates: &Rates) -> Taylor<4> {
    let first = chain.first[joint];
    Taylor([
        at.values[first],
        rates[0][first],
        rates[1][first] / 2.0,
        rates[2][first] / 3.0,
    ])
}

/// The rotation by the two turns of a ball that holds a spin, the first of which is this joint, in their frame.
pub(super) fn universal_series(
    chain: &Chain,
    joint: usize,
    frame: &Rotation,
    at: &Configuration,
    rates: &Rates,
) -> [[Taylor<4>; 3]; 3] {
    let a = joint_series(chain, joint, at, rates);
    let b = joint_series(chain, joint + 1, at, rates);
    let b = turned_series(&Z_TO_X, &b, &transposed(&Z_TO_X));
    turned_series(frame, &product_series(&a, &b), &transposed(frame))
}

/// A rotation with the series of its angular velocity, by `B' = w x B`.
fn rotation_series(now: &Rotation, spin: &[Vec3; ORDERS]) -> [[Taylor<4>; 3]; 3] {
    let mut out = [[Taylor::constant(0.0); 3]; 3];
    for i in 0..3 {
        for j in 0..3 {
            out[i][j].0[0] = now[i][j];
        }
    }
    for order in 1..4 {
        for j in 0..3 {
            let mut sum = [0.0; 3];
            for a in 0..order {
                let column: Vec3 = std::array::from_fn(|i| out[i][j].0[order - 1 - a]);
                let part = crate::rigid::cross(spin[a], column);
                for k in 0..3 {
                    sum[k] += part[k];
                }
            }
            for (i, s) in sum.iter().enumerate() {
                out[i][j].0[order] = s / order as f64;
            }
        }
    }
    out
}

/// A point carried by a link with the series of its twist: position, velocity, acceleration, jerk.
///
/// Source: docs/theory.md, (16).
pub(super) fn point_rates(place: Vec3, twist: &[Twist; ORDERS]) -> [Vec3; 4] {
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

/// `a b c` of a fixed, a moving and a fixed rotation.
pub(super) fn turned_series<const N: usize>(
    a: &Rotation,
    b: &[[Taylor<N>; 3]; 3],
    c: &Rotation,
) -> [[Taylor<N>; 3]; 3] {
    let sum = |f: &dyn Fn(usize) -> Taylor<N>| f(0) + f(1) + f(2);
    let left: [[Taylor<N>; 3]; 3] =
        std::array::from_fn(|i| std::array::from_fn(|j| sum(&|k| b[k][j].scale(a[i][k]))));
    std::array::from_fn(|i| std::array::from_fn(|j| sum(&|k| left[i][k].scale(c[k][j]))))
}

/// `a b` of two moving rotations.
pub(super) fn product_series<const N: usize>(
    a: &[[Taylor<N>; 3]; 3],
    b: &[[Taylor<N>; 3]; 3],
) -> [[Taylor<N>; 3]; 3] {
    std::array::from_fn(|i| {
        std::array::from_fn(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j])
    })
}

/// The frame of the first joint, in which twists are written, moved into the report frame.
pub(super) fn in_report_frame(base: &Pose, place: Vec3, rates: [Vec3; 4]) -> [Vec3; 4] {
    [
        base.carry(place),
        base.turn(rates[1]),
        base.turn(rates[2]),
        base.turn(rates[3]),
    ]
}
