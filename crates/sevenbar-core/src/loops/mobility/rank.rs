//! The rank of the screws, and the wrenches to which no joint yields: `A u = 0` and `A^T w = 0`.
//!
//! Source: docs/theory.md, (18).

use crate::loops::equation::dense::singular_values;

/// The rank of columns of so many rows with these singular values, falling, where those below a part of the greatest are zero.
pub(crate) fn rank(values: &[f64], rows: usize, zero: f64) -> usize {
    values
        .iter()
        .take(rows)
        .filter(|&&v| v > zero * values[0])
        .count()
}

/// Two bases, of unit length and square: rows that see a motion of columns of a rank, and those of power zero on every screw; a chain's have moment,
/// then force.
pub(super) fn wrenches(columns: &[Vec<f64>], rows: usize, rank: usize) -> (Vec<Vec<f64>>, Vec<Vec<f64>>) {
    let across: Vec<Vec<f64>> = (0..rows)
        .map(|r| {
            let mut row: Vec<f64> = columns.iter().map(|c| c[r]).collect();
            row.resize(row.len().max(rows), 0.0);
            row
        })
        .collect();
    let mut seen = singular_values(&across).1;
    let unyielding = seen.split_off(rank.min(rows));
    (seen, unyielding)
}

/// A basis of the rows of power zero on every screw.
pub(crate) fn unyielding(columns: &[Vec<f64>], rows: usize, rank: usize) -> Vec<Vec<f64>> {
    wrenches(columns, rows, rank).1
}
