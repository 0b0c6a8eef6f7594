//! Least squares with up to seven rows and columns, and singular values of small matrices.

use super::chain::{COLUMNS, Columns};

/// Rows of the bordered closure: six and one.
pub(super) const ROWS: usize = 7;

/// A matrix with at least as many rows as columns, reduced by Householder reflections to `Q R`.
///
/// Columns past `count` are left out.
#[derive(Clone, Copy, Debug)]
pub(super) struct Factored {
    /// Column by column: the reflections below the diagonal, R above it.
    columns: [[f64; ROWS]; COLUMNS],
    diagonal: Columns,
    count: usize,
}

impl Factored {
    #[inline(always)]
    pub fn new(mut columns: [[f64; ROWS]; COLUMNS], count: usize) -> Self {
        let mut diagonal = [0.0; COLUMNS];
        for c in 0..count {
            let (head, tail) = columns.split_at_mut(c + 1);
            let pivot = &mut head[c];
            let mut square = 0.0;
            for x in &pivot[c..] {
                square += x * x;
            }
            let length = square.sqrt();
            let alpha = if pivot[c] > 0.0 { -length } else { length };
            diagonal[c] = alpha;
            // v = x - alpha e1, scaled so that the reflection is 1 - v v'
            let scale = 1.0 / (alpha * (alpha - pivot[c])).sqrt();
            let scale = if scale.is_finite() { scale } else { 0.0 };
            pivot[c] -= alpha;
            for x in &mut pivot[c..] {
                *x *= scale;
            }
            for other in tail.iter_mut().take(count - c - 1) {
                reflect(pivot, other, c);
            }
        }
        Self { columns, diagonal, count }
    }

    /// The least-squares solution of `A x = b`; zero in the columns left out.
    #[inline(always)]
    pub fn solve(&self, mut b: [f64; ROWS]) -> Columns {
        for c in 0..self.count {
            reflect(&self.columns[c], &mut b, c);
        }
        let mut x = [0.0; COLUMNS];
        for c in (0..self.count).rev() {
            let mut sum = b[c];
            for j in c + 1..self.count {
                sum -= self.columns[j][c] * x[j];
            }
            x[c] = sum / self.diagonal[c];
        }
        x
    }

    /// The condition number in the Frobenius norm, of the triangular factor, which has that of the matrix.
    #[inline(always)]
    pub fn condition(&self) -> f64 {
        let n = self.count;
        let mut inverse = [[0.0; COLUMNS]; COLUMNS];
        let (mut square, mut inverse_square) = (0.0, 0.0);
        for c in 0..n {
            inverse[c][c] = 1.0 / self.diagonal[c];
            for r in (0..c).rev() {
                let mut sum = 0.0;
                for k in r + 1..=c {
                    sum += self.columns[k][r] * inverse[c][k];
                }
                inverse[c][r] = -sum / self.diagonal[r];
            }
            square += self.diagonal[c] * self.diagonal[c];
            for r in 0..c {
                square += self.columns[c][r] * self.columns[c][r];
            }
            for r in 0..=c {
                inverse_square += inverse[c][r] * inverse[c][r];
            }
        }
        (square * inverse_square).sqrt()
    }

    /// The pseudo-inverse, one column for each row of the matrix.
    #[inline(always)]
    pub fn inverse(&self) -> [Columns; ROWS] {
        let mut out = [[0.0; COLUMNS]; ROWS];
        for (row, column) in out.iter_mut().enumerate() {
            let mut unit = [0.0; ROWS];
            unit[row] = 1.0;
            *column = self.solve(unit);
        }
        out
    }
}

#[inline(always)]
fn reflect(v: &[f64; ROWS], x: &mut [f64; ROWS], from: usize) {
    let mut sum = 0.0;
    for k in from..ROWS {
        sum += v[k] * x[k];
    }
    for k in from..ROWS {
        x[k] -= sum * v[k];
    }
}

/// Singular values, falling, and right singular vectors of a matrix given column by column (one-sided Jacobi).
pub(super) fn singular_values(columns: &[Vec<f64>]) -> (Vec<f64>, Vec<Vec<f64>>) {
    let n = columns.len();
    let mut a = columns.to_vec();
    let mut v: Vec<Vec<f64>> = (0..n)
        .map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect())
        .collect();
    let product = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(a, b)| a * b).sum::<f64>();
    for _ in 0..60 {
        let mut turned = false;
        for p in 0..n {
            for q in p + 1..n {
                let (pp, qq, pq) = (
                    product(&a[p], &a[p]),
                    product(&a[q], &a[q]),
                    product(&a[p], &a[q]),
                );
                if pq.abs() <= 1e-16 * (pp * qq).sqrt() || pq == 0.0 {
                    continue;
                }
                turned = true;
                let zeta = (qq - pp) / (2.0 * pq);
                let t = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
                let c = 1.0 / t.hypot(1.0);
                let s = c * t;
                for m in [&mut a, &mut v] {
                    let (left, right) = m.split_at_mut(q);
                    for (x, y) in left[p].iter_mut().zip(right[0].iter_mut()) {
                        (*x, *y) = (c * *x - s * *y, s * *x + c * *y);
                    }
                }
            }
        }
        if !turned {
            break;
        }
    }
    let lengths: Vec<f64> = a.iter().map(|x| product(x, x).sqrt()).collect();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&i, &j| lengths[j].total_cmp(&lengths[i]));
    (
        order.iter().map(|&i| lengths[i]).collect(),
        order.iter().map(|&i| v[i].clone()).collect(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn least_squares_solves_what_can_be_solved() {
        let a: [[f64; ROWS]; COLUMNS] =
            std::array::from_fn(|c| std::array::from_fn(|r| ((3 * c + 7 * r * r + c * c * r) as f64).sin()));
        for count in [3, 5, 7] {
            let x: Columns = std::array::from_fn(|c| if c < count { 1.0 + c as f64 } else { 0.0 });
            let b = std::array::from_fn(|r| (0..count).map(|c| a[c][r] * x[c]).sum());
            let got = Factored::new(a, count).solve(b);
            for c in 0..COLUMNS {
                assert!((got[c] - x[c]).abs() < 1e-11, "{got:?}");
            }
        }
    }

    #[test]
    fn a_repeated_column_leaves_one_singular_value_zero() {
        let a = vec![
            vec![1.0, 2.0, 3.0, 4.0],
            vec![0.5, -1.0, 2.0, 1.0],
            vec![1.5, 1.0, 5.0, 5.0],
        ];
        let (values, vectors) = singular_values(&a);
        assert!(values[2] < 1e-14 && values[1] > 0.1);
        let ratio: Vec<f64> = vectors[2].iter().map(|x| x / vectors[2][0]).collect();
        assert!(
            (ratio[1] - 1.0).abs() < 1e-13 && (ratio[2] + 1.0).abs() < 1e-13,
            "{ratio:?}"
        );
    }
}
