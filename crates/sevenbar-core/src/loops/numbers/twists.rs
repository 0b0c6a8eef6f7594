//! Twists carried and rotations by turns, as a loop that follows its numbers needs them; determinants.

use crate::loops::equation::rotations::{Rotation, cross, product, rotation, short_way};
use crate::loops::equation::screws::Twist;
use crate::rigid::{Pose, Vec3, add};

pub(super) fn plus(sum: &mut Twist, twist: &Twist, factor: f64) {
    for k in 0..6 {
        sum[k] += factor * twist[k];
    }
}

/// What a twist does to a point.
pub(super) fn carried(twist: &Twist, at: Vec3) -> Vec3 {
    add(cross(&twist[..3], &at), [twist[3], twist[4], twist[5]])
}

/// A twist of a frame in that in which the frame's pose is given.
pub(super) fn adjoined(pose: &Pose, twist: &Twist) -> Twist {
    let spin = pose.turn([twist[0], twist[1], twist[2]]);
    let slide = add(
        pose.turn([twist[3], twist[4], twist[5]]),
        cross(&pose.translation, &spin),
    );
    [spin[0], spin[1], spin[2], slide[0], slide[1], slide[2]]
}

pub(super) fn turning(axis: Vec3, at: Vec3) -> Twist {
    let moment = cross(&at, &axis);
    [axis[0], axis[1], axis[2], moment[0], moment[1], moment[2]]
}

pub(super) fn sliding(axis: Vec3) -> Twist {
    [0.0, 0.0, 0.0, axis[0], axis[1], axis[2]]
}

/// The rotation of turns about z, y and x.
pub(super) fn turned(angles: &[f64]) -> Rotation {
    let about = |axis: usize, angle: f64| {
        let mut v = [0.0; 3];
        v[axis] = angle;
        rotation(v)
    };
    product(
        &product(&about(2, angles[0]), &about(1, angles[1])),
        &about(0, angles[2]),
    )
}

/// Turns about z, y and x that make up a rotation.
pub(super) fn turns(r: &Rotation) -> [f64; 3] {
    let level = r[0][0].hypot(r[1][0]);
    let z = r[1][0].atan2(r[0][0]);
    let (s, c) = z.sin_cos();
    [
        z,
        (-r[2][0]).atan2(level),
        (s * r[0][2] - c * r[1][2]).atan2(c * r[1][1] - s * r[0][1]),
    ]
}

/// The same, as near as can be to others: all may go round, and with the outer ones half round the middle one is mirrored.
pub(super) fn turns_near(r: &Rotation, near: &[f64]) -> [f64; 3] {
    let half = std::f64::consts::PI;
    let [z, y, x] = turns(r);
    let each = [[z, y, x], [z + half, half - y, x + half]]
        .map(|own| std::array::from_fn(|k| near[k] + short_way(own[k] - near[k])));
    let apart = |own: &[f64; 3]| (0..3).map(|k| (own[k] - near[k]).powi(2)).sum::<f64>();
    if apart(&each[1]) < apart(&each[0]) {
        each[1]
    } else {
        each[0]
    }
}

pub(super) fn determinant(mut a: Vec<Vec<f64>>) -> f64 {
    let n = a.len();
    let mut out = 1.0;
    for k in 0..n {
        let pivot = (k..n)
            .max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs()))
            .unwrap_or(k);
        if pivot != k {
            a.swap(pivot, k);
            out = -out;
        }
        out *= a[k][k];
        if a[k][k] == 0.0 {
            return 0.0;
        }
        for i in k + 1..n {
            let factor = a[i][k] / a[k][k];
            for j in k..n {
                a[i][j] -= factor * a[k][j];
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::loops::equation::rotations::transposed;
    use crate::rigid::norm;

    #[test]
    fn turns_make_up_their_rotation_again() {
        for angles in [
            [0.3, -0.8, 2.0],
            [3.0, std::f64::consts::FRAC_PI_2, 0.4],
            [-2.0, 0.0, 0.0],
        ] {
            let r = turned(&angles);
            let again = turned(&turns(&r));
            let apart = product(&r, &transposed(&again));
            assert!((0..3).all(|i| (apart[i][i] - 1.0).abs() < 1e-14), "{angles:?}");
        }
    }

    #[test]
    fn a_determinant_is_signed() {
        let a = vec![vec![0.0, 2.0], vec![3.0, 1.0]];
        assert_eq!(determinant(a), -6.0);
        assert!(norm(carried(&[0.0, 0.0, 1.0, 0.0, 0.0, 0.0], [2.0, 0.0, 5.0])) == 2.0);
    }
}
