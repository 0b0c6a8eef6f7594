//! Quantities along a path as Chebyshev polynomials on its pieces: values anywhere, by Clenshaw's sum.

/// `width` quantities on pieces between `edges`, by Chebyshev coefficients `series` (pieces, terms, width).
#[derive(Clone, Copy, Debug)]
pub struct Piecewise<'a> {
    edges: &'a [f64],
    series: &'a [f64],
    terms: usize,
    width: usize,
}

impl<'a> Piecewise<'a> {
    /// `None` where the parts do not fit together.
    pub fn new(edges: &'a [f64], series: &'a [f64], terms: usize, width: usize) -> Option<Self> {
        let pieces = edges.len().checked_sub(1)?;
        (pieces > 0 && terms > 0 && series.len() == pieces * terms * width).then_some(Self {
            edges,
            series,
            terms,
            width,
        })
    }

    /// How many pieces there are.
    pub fn pieces(&self) -> usize {
        self.edges.len() - 1
    }

    /// How many quantities there are.
    pub fn width(&self) -> usize {
        self.width
    }

    /// The piece of a place; beyond the ends it is the first or the last.
    pub fn piece(&self, place: f64) -> usize {
        self.edges
            .partition_point(|&edge| edge <= place)
            .clamp(1, self.pieces())
            - 1
    }

    /// The quantities by the polynomials of a piece, which go on beyond its ends; `out` has room for `width`.
    pub fn on(&self, piece: usize, place: f64, out: &mut [f64]) {
        let (start, end) = (self.edges[piece], self.edges[piece + 1]);
        let x = (2.0 * place - start - end) / (end - start);
        let own = &self.series[piece * self.terms * self.width..][..self.terms * self.width];
        // side by side, as each sum waits for its own last term
        let mut column = 0;
        while column < self.width {
            column += match self.width - column {
                1 => self.sums::<1>(own, column, x, out),
                2..6 => self.sums::<2>(own, column, x, out),
                6..8 => self.sums::<6>(own, column, x, out),
                _ => self.sums::<8>(own, column, x, out),
            };
        }
    }

    /// `sum c_k T_k(x)` of `N` neighbouring columns.
    #[inline]
    fn sums<const N: usize>(&self, own: &[f64], column: usize, x: f64, out: &mut [f64]) -> usize {
        let (mut one, mut two) = ([0.0; N], [0.0; N]);
        for row in own.chunks_exact(self.width).skip(1).rev() {
            let row: &[f64; N] = row[column..].first_chunk().expect("a row has its columns");
            for k in 0..N {
                let next = (row[k] - two[k]) + 2.0 * x * one[k];
                two[k] = one[k];
                one[k] = next;
            }
        }
        for k in 0..N {
            out[column + k] = (own[column + k] - two[k]) + x * one[k];
        }
        N
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_summed_on_their_pieces_and_go_on_beyond_the_ends() {
        // 1 + 2 x + 3 (2 x^2 - 1) on [0, 2], and 5 on [2, 3]
        let series = [1.0, 2.0, 3.0, 5.0, 0.0, 0.0];
        let curve = Piecewise::new(&[0.0, 2.0, 3.0], &series, 3, 1).unwrap();
        let at = |s: f64| {
            let mut out = [0.0];
            curve.on(curve.piece(s), s, &mut out);
            out[0]
        };
        assert_eq!(at(1.0), -2.0);
        assert_eq!(at(1.5), 1.0 + 1.0 + 3.0 * (2.0 * 0.25 - 1.0));
        assert_eq!([at(2.0), at(7.0)], [5.0, 5.0]);
        assert_eq!(at(-1.0), 1.0 - 4.0 + 3.0 * 7.0);
    }

    #[test]
    fn columns_side_by_side_are_those_one_by_one() {
        let (terms, width) = (7, 9);
        let series: Vec<f64> = (0..terms * width).map(|k| (k as f64).sin()).collect();
        let all = Piecewise::new(&[-1.0, 1.0], &series, terms, width).unwrap();
        let mut out = vec![0.0; width];
        all.on(0, 0.3, &mut out);
        for (column, value) in out.iter().enumerate() {
            let exact: f64 = (0..terms)
                .map(|k| series[k * width + column] * (k as f64 * 0.3f64.acos()).cos())
                .sum();
            assert!((value - exact).abs() < 1e-14, "{column}: {value} {exact}");
        }
    }
}
