//! Least squares with up to seven rows and columns, and singular values of small matrices.

use crate::number::Number;

/// Most one-freedom columns of a chain with one freedom left: rank six and one.
pub(crate) const COLUMNS: usize = 7;

/// A value for each column.
pub(crate) type Columns<N = f64> = [N; COLUMNS];

/// Rows of the bordered closure: six and one.
pub(crate) const ROWS: usize = 7;

/// Loops whose counter is known to the compiler in each turn, so that numbers stay in registers.
macro_rules! unrolled {
    ($c:ident in [$($n:literal)*] $body:block) => { $( { let $c: usize = $n; $body } )* };
}

/// A matrix with at least as many rows as columns, reduced by Householder reflections to `Q R`.
///
/// Columns past `count` are left out, and must be zero.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Factored<N = f64> {
    /// Column by column: the reflections below the diagonal, R above it.
    columns: [[N; ROWS]; COLUMNS],
    /// One by half the squares of the reflections' vectors.
    inverses: Columns<N>,
    /// One by the diagonal of R; zero in the columns left out, which are to be zero.
    inverse_diagonal: Columns<N>,
}

/// Below this, the square of a column leaves nothing to reflect.
const NOTHING: f64 = 1e-300;

impl<N: Number> Factored<N> {
    #[inline(always)]
    pub fn new(mut columns: [[N; ROWS]; COLUMNS], count: usize) -> Self {
        let (zero, one) = (N::splat(0.0), N::splat(1.0));
        let (mut inverse_diagonal, mut inverses) = ([zero; COLUMNS], [zero; COLUMNS]);
        unrolled!(c in [0 1 2 3 4 5 6] {
            let mut square = zero;
            for k in c..ROWS {
                square = square.plus_product(columns[c][k], columns[c][k]);
            }
            let length = square.sqrt();
            let head = columns[c][c];
            let alpha = head.if_greater(zero, -length, length);
            columns[c][c] = head - alpha;
            // the reflection is 1 - v v' / p with v = x - alpha e1; one division for both inverses
            let p = square.minus_product(alpha, head);
            let both = one / (alpha * p);
            inverses[c] = p.if_greater(N::splat(NOTHING), both * alpha, zero);
            if c < count {
                inverse_diagonal[c] = both * p;
            }
            let pivot = columns[c];
            for j in c + 1..COLUMNS {
                reflect(&pivot, inverses[c], &mut columns[j], c);
            }
        });
        Self { columns, inverses, inverse_diagonal }
    }

    /// The least-squares solution of `A x = b`; zero in the columns left out.
    #[inline(always)]
    pub fn solve(&self, mut b: [N; ROWS]) -> Columns<N> {
        unrolled!(c in [0 1 2 3 4 5 6] {
            reflect(&self.columns[c], self.inverses[c], &mut b, c);
        });
        let mut x = [N::splat(0.0); COLUMNS];
        unrolled!(c in [6 5 4 3 2 1 0] {
            x[c] = b[c] * self.inverse_diagonal[c];
            for k in 0..c {
                b[k] = b[k].minus_product(self.columns[c][k], x[c]);
            }
        });
        x
    }

    /// The pseudo-inverse, one column for each row of the matrix.
    #[inline(always)]
    pub fn inverse(&self) -> Inverse<N> {
        let mut out = [[N::splat(0.0); COLUMNS]; ROWS];
        for (row, column) in out.iter_mut().enumerate() {
            let mut unit = [N::splat(0.0); ROWS];
            unit[row] = N::splat(1.0);
            *column = self.solve(unit);
        }
        Inverse(out)
    }
}

/// A pseudo-inverse, one column for each row of the matrix.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Inverse<N = f64>(pub [Columns<N>; ROWS]);

impl<N: Number> Inverse<N> {
    /// The product with right-hand sides of the first rows.
    #[inline(always)]
    pub fn times(&self, b: &[N]) -> Columns<N> {
        let mut x = [N::splat(0.0); COLUMNS];
        for (column, b) in self.0.iter().zip(b) {
            for c in 0..COLUMNS {
                x[c] = x[c].plus_product(column[c], *b);
            }
        }
        x
    }

    /// The square of the Frobenius norm of the first columns.
    #[inline(always)]
    pub fn square(&self, columns: usize) -> N {
        let mut sum = N::splat(0.0);
        for column in &self.0[..columns] {
            for x in column {
                sum = sum.plus_product(*x, *x);
            }
        }
        sum
    }
}

/// The direction that six rows of seven columns leave free, oriented so that it makes the determinant positive as a seventh
/// row; none where a pivot is below this part of the greatest number. It changes continuously with the matrix.
///
/// Source: docs/theory_many.md, (9).
pub(crate) fn free_direction(columns: &[[f64; 6]; COLUMNS], least_pivot: f64) -> Option<Columns> {
    let mut a: [[f64; COLUMNS]; 6] = std::array::from_fn(|r| std::array::from_fn(|c| columns[c][r]));
    let mut order: [usize; COLUMNS] = std::array::from_fn(|c| c);
    let mut positive = true;
    let mut greatest = 0.0;
    for n in 0..6 {
        let (mut row, mut column, mut size) = (n, n, -1.0);
        for r in n..6 {
            for c in n..COLUMNS {
                if a[r][c].abs() > size {
                    (row, column, size) = (r, c, a[r][c].abs());
                }
            }
        }
        greatest = f64::max(greatest, size);
        if size <= least_pivot * greatest {
            return None;
        }
        a.swap(n, row);
        order.swap(n, column);
        for r in &mut a {
            r.swap(n, column);
        }
        positive ^= (row != n) ^ (column != n) ^ (a[n][n] < 0.0);
        for r in n + 1..6 {
            let factor = a[r][n] / a[n][n];
            for c in n..COLUMNS {
                a[r][c] -= factor * a[n][c];
            }
        }
    }
    let mut free = [0.0; COLUMNS];
    free[6] = if positive { 1.0 } else { -1.0 };
    for n in (0..6).rev() {
        let sum: f64 = (n + 1..COLUMNS).map(|c| a[n][c] * free[c]).sum();
        free[n] = -sum / a[n][n];
    }
    let length = free.iter().map(|x| x * x).sum::<f64>().sqrt();
    let mut out = [0.0; COLUMNS];
    for (place, x) in order.iter().zip(free) {
        out[*place] = x / length;
    }
    Some(out)
}

#[inline(always)]
fn reflect<N: Number>(v: &[N; ROWS], inverse: N, x: &mut [N; ROWS], from: usize) {
    let mut sum = N::splat(0.0);
    for k in from..ROWS {
        sum = sum.plus_product(v[k], x[k]);
    }
    sum = sum * inverse;
    for k in from..ROWS {
        x[k] = x[k].minus_product(sum, v[k]);
    }
}

#[inline(always)]
pub(crate) fn dot<N: Number>(a: &Columns<N>, b: &Columns<N>) -> N {
    let mut sum = N::splat(0.0);
    for k in 0..COLUMNS {
        sum = sum.plus_product(a[k], b[k]);
    }
    sum
}

#[inline(always)]
pub(crate) fn combined(a: &Columns, x: f64, b: &Columns, y: f64) -> Columns {
    std::array::from_fn(|k| a[k] * x + b[k] * y)
}

#[inline(always)]
pub(crate) fn length<N: Number>(a: &Columns<N>) -> N {
    dot(a, a).sqrt()
}

/// Columns whose cosine is less are square to each other: rounding of their product of seven terms alone makes as much.
const SQUARE: f64 = 4.0 * f64::EPSILON;

/// Most sweeps over all pairs of columns; ten are many.
const MOST_SWEEPS: usize = 60;

/// Singular values, falling, and right singular vectors of a matrix given column by column (one-sided Jacobi).
pub(crate) fn singular_values(columns: &[Vec<f64>]) -> (Vec<f64>, Vec<Vec<f64>>) {
    let n = columns.len();
    let mut a = columns.to_vec();
    let mut v: Vec<Vec<f64>> = (0..n)
        .map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect())
        .collect();
    let product = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(a, b)| a * b).sum::<f64>();
    for _ in 0..MOST_SWEEPS {
        let mut turned = false;
        for p in 0..n {
            for q in p + 1..n {
                let (pp, qq, pq) = (
                    product(&a[p], &a[p]),
                    product(&a[q], &a[q]),
                    product(&a[p], &a[q]),
                );
                // what is not a number is not turned
                if !(pq.abs() > SQUARE * (pp * qq).sqrt() && pq.is_finite()) {
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

/// The shortest least-squares solution of a matrix given column by column; singular values below a part of the greatest are zero.
pub(crate) fn least_squares(columns: &[Vec<f64>], right: &[f64], zero: f64) -> Vec<f64> {
    let (values, vectors) = singular_values(columns);
    let mut out = vec![0.0; columns.len()];
    for (value, vector) in values.iter().zip(&vectors) {
        if *value <= zero * values[0] {
            break;
        }
        let seen: f64 = columns
            .iter()
            .zip(vector)
            .map(|(column, v)| v * column.iter().zip(right).map(|(a, b)| a * b).sum::<f64>())
            .sum();
        for (x, v) in out.iter_mut().zip(vector) {
            *x += seen / (value * value) * v;
        }
    }
    out
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
            let kept = std::array::from_fn(|c| if c < count { a[c] } else { [0.0; ROWS] });
            let got = Factored::new(kept, count).solve(b);
            for c in 0..COLUMNS {
                assert!((got[c] - x[c]).abs() < 1e-11, "{got:?}");
            }
        }
    }

    #[test]
    fn the_free_direction_is_the_oriented_one_of_the_minors() {
        for seed in 0..50 {
            let columns: [[f64; 6]; COLUMNS] = std::array::from_fn(|c| {
                std::array::from_fn(|r| {
                    ((1 + seed) as f64 * (3 * c + 7 * r * r + c * c * r + 1) as f64).sin()
                })
            });
            let free = free_direction(&columns, 1e-9).unwrap();
            // by Laplace along the seventh row
            let minor = |left_out: usize| {
                let kept: Vec<[f64; 6]> = (0..COLUMNS)
                    .filter(|&c| c != left_out)
                    .map(|c| columns[c])
                    .collect();
                determinant(kept)
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
        assert!(free_direction(&repeated, 1e-9).is_none());
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
