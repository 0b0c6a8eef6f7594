//! Poses that are the same: at a dead centre two modes meet, and a solver finds the pose twice, apart by the root of its rounding.

use std::f64::consts::{PI, TAU};

/// Poses nearer to each other than this in every joint [rad, or relative to the size] are the same.
const ONE_POSE: f64 = 1e-6;

/// Poses by their joint values, each with what belongs to it, without those that are the same as an earlier one.
///
/// `size` is that to which the values of a column are relative, `None` for an angle.
pub(crate) fn each_once<P: AsRef<[f64]>, T>(
    poses: Vec<(P, T)>,
    size: impl Fn(usize) -> Option<f64>,
) -> Vec<(P, T)> {
    let one = |a: &P, b: &P| {
        a.as_ref()
            .iter()
            .zip(b.as_ref())
            .enumerate()
            .all(|(column, (a, b))| {
                let apart = match size(column) {
                    None => (a - b + PI).rem_euclid(TAU) - PI,
                    Some(size) => (a - b) / size,
                };
                // a ball's turns that have no value here do not make two poses differ
                apart.is_nan() || apart.abs() < ONE_POSE
            })
    };
    let first = (0..poses.len())
        .map(|i| !poses[..i].iter().any(|(before, _)| one(&poses[i].0, before)))
        .collect::<Vec<_>>();
    poses
        .into_iter()
        .zip(first)
        .filter_map(|(pose, first)| first.then_some(pose))
        .collect()
}
