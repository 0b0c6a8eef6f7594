//! Turns of joints as power series in time, from the series of the rates.
//!
//! Source: docs/theory.md, (15) and (16).

use super::velocities::{ORDERS, Rates};
use crate::loops::equation::chain::{Chain, Configuration};
use crate::loops::equation::closed::Joint;
use crate::loops::equation::rotations::{Rotation, Z_TO_X, transposed};
use crate::rigid::Vec3;
use crate::taylor::Taylor;

/// A joint's turn and slide from the frame before it to that after, as a series.
pub(crate) fn joint_series(
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
pub(crate) fn value_series(chain: &Chain, joint: usize, at: &Configuration, rates: &Rates) -> Taylor<4> {
    let first = chain.first[joint];
    Taylor([
        at.values[first],
        rates[0][first],
        rates[1][first] / 2.0,
        rates[2][first] / 3.0,
    ])
}

/// The rotation by the two turns of a ball that holds a spin, the first of which is this joint, in their frame.
pub(crate) fn universal_series(
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

/// `a b c` of a fixed, a moving and a fixed rotation.
pub(crate) fn turned_series<const N: usize>(
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
pub(crate) fn product_series<const N: usize>(
    a: &[[Taylor<N>; 3]; 3],
    b: &[[Taylor<N>; 3]; 3],
) -> [[Taylor<N>; 3]; 3] {
    std::array::from_fn(|i| {
        std::array::from_fn(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j])
    })
}
