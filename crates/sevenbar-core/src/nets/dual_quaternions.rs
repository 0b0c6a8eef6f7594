//! A pose as a dual quaternion `(x, y)` of complex numbers, up to scale.
//!
//! Source: docs/theory_nets.md, (19).

use crate::loops::equation::closure::Solution;
use num_complex::Complex64;
use std::array::from_fn;

/// The numbers of a pose: x, then y.
pub(super) const UNKNOWNS: usize = 8;

/// A vector, or a number and nothing.
pub(super) type Triple = [Complex64; 3];

/// The sum of products, without conjugates.
pub(super) fn dot<const N: usize>(a: &[Complex64; N], b: &[Complex64; N]) -> Complex64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// A quaternion of complex numbers.
pub(super) type Quaternion = [Complex64; 4];

/// The product of two.
pub(super) fn product(a: &Quaternion, b: &Quaternion) -> Quaternion {
    [
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    ]
}

/// The two halves of a solution.
pub(super) fn halves(z: &Solution<UNKNOWNS>) -> (Quaternion, Quaternion) {
    (from_fn(|i| z[i]), from_fn(|i| z[i + 4]))
}

/// The pose of a solution: the images of the axes, and of the origin.
pub(super) fn pose(z: &Solution<UNKNOWNS>) -> [Triple; 4] {
    let (x, y) = halves(z);
    let square = dot(&x, &x);
    let conjugate = [x[0], -x[1], -x[2], -x[3]];
    let place = product(&y, &conjugate);
    let image = |k: usize| -> Triple {
        let mut axis = [Complex64::ZERO; 4];
        axis[k + 1] = Complex64::ONE;
        let turned = product(&product(&x, &axis), &conjugate);
        from_fn(|i| turned[i + 1] / square)
    };
    [
        image(0),
        image(1),
        image(2),
        from_fn(|i| 2.0 * place[i + 1] / square),
    ]
}
