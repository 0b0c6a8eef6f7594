//! Least squares with up to seven rows and columns, and singular values of small matrices.

use crate::number::Number;
use std::fmt::Debug;
use std::ops::IndexMut;

/// So many of one kind as the compiler knows.
pub(crate) trait Array<T: Copy + Debug>:
    Copy + Debug + IndexMut<usize, Output = T> + AsRef<[T]> + AsMut<[T]>
{
    /// How many.
    const COUNT: usize;
    /// All the same.
    fn filled(value: T) -> Self;
    /// Some, and then all the same.
    fn padded(some: &[T], rest: T) -> Self;
    /// Each by its number.
    fn from_fn(value: impl FnMut(usize) -> T) -> Self;
    /// Each changed. Not for lanes: closures are not compiled for the vector unit.
    fn map(self, change: impl FnMut(T) -> T) -> Self;
}

impl<T: Copy + Debug, const COUNT: usize> Array<T> for [T; COUNT] {
    const COUNT: usize = COUNT;
    #[inline(always)]
    fn filled(value: T) -> Self {
        [value; COUNT]
    }
    #[inline(always)]
    fn padded(some: &[T], rest: T) -> Self {
        let mut out = [rest; COUNT];
        out[..some.len()].copy_from_slice(some);
        out
    }
    #[inline(always)]
    fn from_fn(value: impl FnMut(usize) -> T) -> Self {
        std::array::from_fn(value)
    }
    #[inline(always)]
    fn map(self, change: impl FnMut(T) -> T) -> Self {
        self.map(change)
    }
}

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
    pub fn inverse(&self) -> [Columns<N>; ROWS] {
        let mut out = [[N::splat(0.0); COLUMNS]; ROWS];
        for (row, column) in out.iter_mut().enumerate() {
            let mut unit = [N::splat(0.0); ROWS];
            unit[row] = N::splat(1.0);
            *column = self.solve(unit);
        }
        out
    }
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
pub(crate) fn dot<N: Number, A: Array<N>>(a: &A, b: &A) -> N {
    let mut sum = N::splat(0.0);
    for k in 0..A::COUNT {
        sum = sum.plus_product(a[k], b[k]);
    }
    sum
}

#[inline(always)]
pub(crate) fn combined<A: Array<f64>>(a: &A, x: f64, b: &A, y: f64) -> A {
    A::from_fn(|k| a[k] * x + b[k] * y)
}

#[inline(always)]
pub(crate) fn length<N: Number, A: Array<N>>(a: &A) -> N {
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
    let turning = sharing(columns);
    for _ in 0..MOST_SWEEPS {
        let mut turned = false;
        for (k, &p) in turning.iter().enumerate() {
            for &q in &turning[k + 1..] {
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

/// The columns that have a row in common with others; the rest, as those that a net has in store, are at right angles to all.
fn sharing(columns: &[Vec<f64>]) -> Vec<usize> {
    let mut used = vec![0; columns.first().map_or(0, Vec::len)];
    for column in columns {
        for (used, x) in used.iter_mut().zip(column) {
            *used += usize::from(*x != 0.0);
        }
    }
    let shares = |column: &[f64]| column.iter().zip(&used).any(|(x, used)| *x != 0.0 && *used > 1);
    let all = 0..columns.len();
    all.filter(|&c| shares(&columns[c])).collect()
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
