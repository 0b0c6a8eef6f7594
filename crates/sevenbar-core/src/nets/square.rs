//! Square systems of a size known at run time, within arrays whose size the compiler knows, of one number or of several side by side.

use crate::number::Number;

/// Below this, the square of a column leaves nothing to reflect.
const NOTHING: f64 = 1e-300;

/// A square matrix reduced by Householder reflections to `Q R`; columns and rows past `count` are left out.
pub(super) struct Square<N, const C: usize> {
    /// Column by column: the reflections from the diagonal on, R above it.
    columns: [[N; C]; C],
    /// Two by the squares of the reflections' vectors.
    inverses: [N; C],
    /// One by the diagonal of R.
    diagonal: [N; C],
    count: usize,
}

impl<N: Number, const C: usize> Square<N, C> {
    #[inline(always)]
    pub fn new(mut columns: [[N; C]; C], count: usize) -> Self {
        let (zero, one) = (N::splat(0.0), N::splat(1.0));
        let (mut inverses, mut diagonal) = ([zero; C], [zero; C]);
        for c in 0..count {
            let mut square = zero;
            for k in c..count {
                square = square.plus_product(columns[c][k], columns[c][k]);
            }
            let length = square.sqrt();
            let head = columns[c][c];
            let alpha = head.if_greater(zero, -length, length);
            columns[c][c] = head - alpha;
            // the reflection is 1 - v v' / p with v = x - alpha e1
            let p = square.minus_product(alpha, head);
            inverses[c] = p.if_greater(N::splat(NOTHING), one / p, zero);
            diagonal[c] = one / alpha;
            let pivot = columns[c];
            for j in c + 1..count {
                reflect(&pivot, inverses[c], &mut columns[j], c..count);
            }
        }
        Self { columns, inverses, diagonal, count }
    }

    /// The solution of `A x = b`.
    #[inline(always)]
    pub fn solve(&self, mut b: [N; C]) -> [N; C] {
        for c in 0..self.count {
            reflect(&self.columns[c], self.inverses[c], &mut b, c..self.count);
        }
        let mut x = [N::splat(0.0); C];
        for c in (0..self.count).rev() {
            x[c] = b[c] * self.diagonal[c];
            for k in 0..c {
                b[k] = b[k].minus_product(self.columns[c][k], x[c]);
            }
        }
        x
    }

    /// The sum of the squares of all entries of the inverse: those of `R^-1`, since `Q` turns only.
    #[inline(always)]
    pub fn inverse_square(&self) -> N {
        let mut sum = N::splat(0.0);
        for c in 0..self.count {
            let mut x = [N::splat(0.0); C];
            x[c] = self.diagonal[c];
            sum = sum.plus_product(x[c], x[c]);
            for r in (0..c).rev() {
                let mut right = N::splat(0.0);
                for k in r + 1..=c {
                    right = right.minus_product(self.columns[k][r], x[k]);
                }
                x[r] = right * self.diagonal[r];
                sum = sum.plus_product(x[r], x[r]);
            }
        }
        sum
    }
}

#[inline(always)]
fn reflect<N: Number, const C: usize>(v: &[N; C], inverse: N, x: &mut [N; C], rows: std::ops::Range<usize>) {
    let mut sum = N::splat(0.0);
    for k in rows.clone() {
        sum = sum.plus_product(v[k], x[k]);
    }
    sum = sum * inverse;
    for k in rows {
        x[k] = x[k].minus_product(sum, v[k]);
    }
}
