//! One pose of a linkage, and how its coupler lies in the seats of its balls.

use super::cone::{from_seat, smallest};
use super::wish::Wish;
use crate::rigid::Vec3;

/// The numbers of one linkage, with sine and cosine of the angle between its axes.
pub(super) type Row = [f64; 8];

/// The output on a branch, held at the limit where the input is beyond it.
pub(super) fn output(row: &Row, input: f64, branch: usize) -> f64 {
    let [m, n, l1, l2, l3, d, s, c] = *row;
    let (sa, ca) = input.sin_cos();
    let (e, f) = (l1 * sa - d, n * s - c * l1 * ca);
    let z = n * c - m + l1 * s * ca;
    let k = 0.5 * (e * e + f * f + z * z + (l3 - l2) * (l3 + l2));
    let w = (l3 * l3 * (e * e + f * f) - k * k).max(0.0);
    let spread = w.sqrt().atan2(k);
    f.atan2(e) + if branch == 0 { -spread } else { spread }
}

/// The coupler's directions from both balls, in the frames of crank and rocker: outwards, the way the ball moves, along the axis.
fn directions(row: &Row, input: f64, branch: usize) -> [Vec3; 2] {
    let [m, n, l1, l2, l3, d, s, c] = *row;
    let (sa, ca) = input.sin_cos();
    let (sb, cb) = output(row, input, branch).sin_cos();
    let b = [m * s - c * l3 * sb, d + l3 * cb, m * c + s * l3 * sb];
    let v = [b[0] - l1 * ca, b[1] - l1 * sa, b[2] - n].map(|x| x / l2);
    // the rocker's plane is spanned by y and (-c, 0, s), its axis is (s, 0, c)
    let (y, up, along) = (v[1], s * v[2] - c * v[0], s * v[0] + c * v[2]);
    [
        [ca * v[0] + sa * v[1], ca * v[1] - sa * v[0], v[2]],
        [-(cb * y + sb * up), -(cb * up - sb * y), -along],
    ]
}

/// The greatest angle of each ball from its seat at some inputs: the one given, or the best.
pub(super) fn ball_angles(
    row: &Row,
    inputs: impl Iterator<Item = f64>,
    branch: usize,
    wish: &Wish,
) -> [f64; 2] {
    let both: Vec<[Vec3; 2]> = inputs.map(|input| directions(row, input, branch)).collect();
    std::array::from_fn(|ball| {
        let own: Vec<Vec3> = both.iter().map(|pair| pair[ball]).collect();
        let cosine = match wish.seats[ball] {
            Some(seat) => from_seat(seat, &own),
            None => smallest(&own).1,
        };
        cosine.clamp(-1.0, 1.0).acos()
    })
}
