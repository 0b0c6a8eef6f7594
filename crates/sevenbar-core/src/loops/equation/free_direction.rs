//! The direction in which one column more than rows is free.

use super::closed::{Closed, Screws};
use super::dense::Array;

/// The direction that rows leave free of one column more, oriented so that it makes the determinant positive as one more row; none where
/// a pivot is below this part of the greatest number. It changes continuously with the matrix.
///
/// Source: docs/theory_many.md, (9).
pub(crate) fn free_direction<S: Closed>(columns: &Screws<S>, least_pivot: f64) -> Option<S::Columns<f64>> {
    let mut a: S::Rows<S::Columns<f64>> = Array::from_fn(|r| Array::from_fn(|c| columns[c][r]));
    let mut order: S::Columns<usize> = Array::from_fn(|c| c);
    let mut positive = true;
    let mut greatest = 0.0;
    for n in 0..S::ROWS {
        let (mut row, mut column, mut size) = (n, n, -1.0);
        for r in n..S::ROWS {
            for c in n..S::COLUMNS {
                if a[r][c].abs() > size {
                    (row, column, size) = (r, c, a[r][c].abs());
                }
            }
        }
        greatest = f64::max(greatest, size);
        if size <= least_pivot * greatest {
            return None;
        }
        a.as_mut().swap(n, row);
        order.as_mut().swap(n, column);
        for r in a.as_mut() {
            r.as_mut().swap(n, column);
        }
        positive ^= (row != n) ^ (column != n) ^ (a[n][n] < 0.0);
        for r in n + 1..S::ROWS {
            let factor = a[r][n] / a[n][n];
            for c in n..S::COLUMNS {
                let pivot = a[n][c];
                a[r][c] -= factor * pivot;
            }
        }
    }
    let mut free = S::Columns::filled(0.0);
    free[S::ROWS] = if positive { 1.0 } else { -1.0 };
    for n in (0..S::ROWS).rev() {
        let sum: f64 = (n + 1..S::COLUMNS).map(|c| a[n][c] * free[c]).sum();
        free[n] = -sum / a[n][n];
    }
    let length = free.as_ref().iter().map(|x| x * x).sum::<f64>().sqrt();
    let mut out = S::Columns::filled(0.0);
    for (place, x) in order.as_ref().iter().zip(free.as_ref()) {
        out[*place] = x / length;
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::loops::equation::chain::Chain;
    use crate::loops::equation::dense::{COLUMNS, Columns};

    #[test]
    fn the_free_direction_is_the_oriented_one_of_the_minors() {
        for seed in 0..50 {
            let columns: [[f64; 6]; COLUMNS] = std::array::from_fn(|c| {
                std::array::from_fn(|r| {
                    ((1 + seed) as f64 * (3 * c + 7 * r * r + c * c * r + 1) as f64).sin()
                })
            });
            let free = free_direction::<Chain>(&columns, 1e-9).unwrap();
            // by Laplace along the seventh row
            let minor = |left_out: usize| {
                let others: Vec<[f64; 6]> = (0..COLUMNS)
                    .filter(|&c| c != left_out)
                    .map(|c| columns[c])
                    .collect();
                determinant(others)
            };
            let minors: Columns = std::array::from_fn(|c| if c % 2 == 0 { minor(c) } else { -minor(c) });
            let length = minors.iter().map(|x| x * x).sum::<f64>().sqrt();
            for c in 0..COLUMNS {
                assert!(
                    (free[c] - minors[c] / length).abs() < 1e-9,
                    "{seed} {free:?} {minors:?}"
                );
            }
        }
        let mut repeated: [[f64; 6]; COLUMNS] = std::array::from_fn(|c| {
            std::array::from_fn(|r| ((3 * c + 7 * r * r + c * c * r + 1) as f64).sin())
        });
        for row in 0..COLUMNS {
            repeated[row][5] = 2.0 * repeated[row][3];
        }
        assert!(free_direction::<Chain>(&repeated, 1e-9).is_none());
    }

    fn determinant(a: Vec<[f64; 6]>) -> f64 {
        fn of(a: &[Vec<f64>]) -> f64 {
            if a.is_empty() {
                return 1.0;
            }
            (0..a.len())
                .map(|k| {
                    let rest: Vec<Vec<f64>> = (0..a.len())
                        .filter(|&c| c != k)
                        .map(|c| a[c][1..].to_vec())
                        .collect();
                    if k % 2 == 0 {
                        a[k][0] * of(&rest)
                    } else {
                        -a[k][0] * of(&rest)
                    }
                })
                .sum()
        }
        of(&a.iter().map(|c| c.to_vec()).collect::<Vec<_>>())
    }
}
