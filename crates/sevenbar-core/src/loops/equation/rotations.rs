//! Rotations of links and balls, as matrices and as vectors, of one number or of several side by side.

use crate::number::Number;
use crate::rigid::{Vec3, dot, norm, scale};
use crate::vector_math::ROUNDER;

/// A rotation, row by row.
pub(crate) type Rotation<N = f64> = [[N; 3]; 3];

/// Below this angle [rad] the sine of half of it, as a share of the angle, is a half to the last digit.
const SMALL_ANGLE: f64 = 1e-8;

/// Below this sine of its angle a rotation is a small one, whose angle is its sine, or half a turn.
const SMALL_SINE: f64 = 1e-6;

/// Takes z to x, and x to minus z.
pub(crate) const Z_TO_X: Rotation = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]];

/// `a x b`
#[inline(always)]
pub(crate) fn cross<N: Number>(a: &[N], b: &[N]) -> [N; 3] {
    [
        (a[1] * b[2]).minus_product(a[2], b[1]),
        (a[2] * b[0]).minus_product(a[0], b[2]),
        (a[0] * b[1]).minus_product(a[1], b[0]),
    ]
}

/// An angle moved by whole turns into (-pi, pi].
#[inline(always)]
pub(crate) fn short_way(angle: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    // rounds to a whole number without a call, which keeps loops vector code
    let turns = (angle / turn + ROUNDER) - ROUNDER;
    let short = angle - turn * turns;
    if short <= -std::f64::consts::PI {
        short + turn
    } else {
        short
    }
}

/// The images of the axes by `R by`, for axes that are their images by R.
#[inline(always)]
pub(super) fn turned<N: Number>(axes: &[[N; 3]; 3], by: &Rotation<N>) -> [[N; 3]; 3] {
    let mut out = [[N::splat(0.0); 3]; 3];
    for j in 0..3 {
        for k in 0..3 {
            out[j][k] = (axes[0][k] * by[0][j])
                .plus_product(axes[1][k], by[1][j])
                .plus_product(axes[2][k], by[2][j]);
        }
    }
    out
}

/// The same rotation in each of several numbers side by side.
#[inline(always)]
pub(super) fn splatted<N: Number>(r: &Rotation) -> Rotation<N> {
    let mut out = [[N::splat(0.0); 3]; 3];
    for i in 0..3 {
        for j in 0..3 {
            out[i][j] = N::splat(r[i][j]);
        }
    }
    out
}

#[inline(always)]
pub(crate) fn dot3<N: Number>(a: &[N], b: &[N]) -> N {
    (a[0] * b[0]).plus_product(a[1], b[1]).plus_product(a[2], b[2])
}

#[inline(always)]
pub(crate) fn product<N: Number>(a: &Rotation<N>, b: &Rotation<N>) -> Rotation<N> {
    let mut out = [[N::splat(0.0); 3]; 3];
    for i in 0..3 {
        for j in 0..3 {
            out[i][j] = (a[i][0] * b[0][j])
                .plus_product(a[i][1], b[1][j])
                .plus_product(a[i][2], b[2][j]);
        }
    }
    out
}

pub(crate) fn transposed(a: &Rotation) -> Rotation {
    std::array::from_fn(|i| std::array::from_fn(|j| a[j][i]))
}

/// The turn about a vector by its length, by the unit quaternion.
#[inline(always)]
pub(crate) fn rotation<N: Number>(v: [N; 3]) -> Rotation<N> {
    let (one, two, half) = (N::splat(1.0), N::splat(2.0), N::splat(0.5));
    let angle = dot3(&v, &v).sqrt();
    let (s, w) = (half * angle).sin_cos();
    let factor = angle.if_greater(N::splat(SMALL_ANGLE), s / angle, half);
    let [x, y, z] = [v[0] * factor, v[1] * factor, v[2] * factor];
    [
        [
            one - two * (y * y + z * z),
            two * (x * y - w * z),
            two * (x * z + w * y),
        ],
        [
            two * (x * y + w * z),
            one - two * (x * x + z * z),
            two * (y * z - w * x),
        ],
        [
            two * (x * z - w * y),
            two * (y * z + w * x),
            one - two * (x * x + y * y),
        ],
    ]
}

/// The vector of a rotation, of length up to pi.
pub(super) fn rotation_vector(r: &Rotation) -> Vec3 {
    let v = [
        0.5 * (r[2][1] - r[1][2]),
        0.5 * (r[0][2] - r[2][0]),
        0.5 * (r[1][0] - r[0][1]),
    ];
    let sine = norm(v);
    let cosine = 0.5 * (r[0][0] + r[1][1] + r[2][2] - 1.0);
    if sine > SMALL_SINE {
        return scale(v, sine.atan2(cosine) / sine);
    }
    if cosine > 0.0 {
        return v;
    }
    // half a turn: the axis is the longest column of r + 1
    let columns: [Vec3; 3] =
        std::array::from_fn(|j| std::array::from_fn(|i| r[i][j] + if i == j { 1.0 } else { 0.0 }));
    let axis = columns.into_iter().fold(
        [0.0; 3],
        |best: Vec3, c| {
            if dot(c, c) > dot(best, best) { c } else { best }
        },
    );
    scale(axis, std::f64::consts::PI / norm(axis))
}

/// A rotation freed from the rounding of many products, its columns made orthonormal in their order.
#[inline(always)]
pub(crate) fn squared_up<N: Number>(r: &Rotation<N>) -> Rotation<N> {
    let one = N::splat(1.0);
    let mut x = [r[0][0], r[1][0], r[2][0]];
    let mut y = [r[0][1], r[1][1], r[2][1]];
    let length = one / dot3(&x, &x).sqrt();
    for x in &mut x {
        *x = *x * length;
    }
    let along = dot3(&x, &y);
    for k in 0..3 {
        y[k] = y[k].minus_product(x[k], along);
    }
    let length = one / dot3(&y, &y).sqrt();
    for y in &mut y {
        *y = *y * length;
    }
    let z = cross(&x, &y);
    [[x[0], y[0], z[0]], [x[1], y[1], z[1]], [x[2], y[2], z[2]]]
}

/// `Rz(t1) Ry(t2) Rx(t3)`
pub(crate) fn ball_rotation(t: &[f64; 3]) -> Rotation {
    let about =
        |axis: usize, angle: f64| rotation(std::array::from_fn(|k| if k == axis { angle } else { 0.0 }));
    product(&product(&about(2, t[0]), &about(1, t[1])), &about(0, t[2]))
}
