//! What closes: the equation `e(q) = 0` of anything that can be followed, and what must be known of it.
//!
//! Curves are followed, rates solved, and change points passed by the same code for whatever closes. What the code has to know is here: the
//! joints behind the columns, `e` and `A = de/dq` at a place, the power series of `A` along a motion, and bounds of what such a series leaves
//! out. How many columns and rows there are is known to the compiler; fewer may be in use, the others are zero.
//!
//! docs/design.md has it under "Closed".
//!
//! Source: docs/theory.md, (1) to (14).

use super::dense::Array;
use super::rotations::{Rotation, product, rotation, rotation_vector, short_way, squared_up, transposed};
use crate::number::Number;
use crate::rigid::Pose;
use crate::vectors::{LANES, QUAD, Vector};
use std::fmt::Debug;

/// A joint with its columns; a ball has three, the others one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Joint {
    Turn,
    Slide,
    /// Advance for each radian, relative to the size.
    Screw(f64),
    /// The n-th ball.
    Ball(usize),
}

impl Joint {
    /// How many columns it has.
    #[inline(always)]
    pub fn columns(&self) -> usize {
        if matches!(self, Self::Ball(_)) { 3 } else { 1 }
    }
}

/// Most signs by which a stretch of a pass is distinguished from others at the same inputs.
pub(crate) const MOST_SIGNS: usize = 8;

/// The signs of a stretch of a pass, and its first end.
#[derive(Debug)]
pub(crate) struct Stretch<S: Closed> {
    pub signs: [f64; MOST_SIGNS],
    pub from: S::Columns<f64>,
    /// Cosine and sine of the turns at these columns.
    pub turns: S::Columns<[f64; 2]>,
}

/// Rows in closed form that are made at once, of nets without balls: each number for all rows.
#[derive(Debug)]
pub(crate) struct Explicits<S: Closed> {
    pub values: S::Columns<[f64; QUAD]>,
    /// Series of the rates.
    pub rates: [S::Columns<[f64; QUAD]>; 3],
    /// The closure errors.
    pub residual: [f64; QUAD],
    /// The condition numbers of `A` with the input's row.
    pub condition: [f64; QUAD],
    /// Whether their closed form is sure.
    pub is_sure: [bool; QUAD],
}

/// What closes.
pub(crate) trait Closed: Sized {
    /// One for each column.
    type Columns<T: Copy + Debug>: Array<T>;
    /// One for each row.
    type Rows<T: Copy + Debug>: Array<T>;
    /// One for each row, and one for the row that borders them.
    type Bordered<T: Copy + Debug>: Array<T>;
    /// One for each ball.
    type Balls<T: Copy + Debug>: Array<T>;
    /// One for each cycle.
    type Cycles<T: Copy + Debug>: Array<T>;

    /// Whether curves and rows are followed eight side by side in vector lanes; else one after the other, by code of a fourth of the size.
    const SIDE_BY_SIDE: bool = true;

    /// Whether some have rows in closed form.
    const EXPLICIT: bool = false;

    /// How many columns.
    const COLUMNS: usize = <Self::Columns<f64> as Array<f64>>::COUNT;

    /// How many rows.
    const ROWS: usize = <Self::Rows<f64> as Array<f64>>::COUNT;

    /// The joints whose columns these are.
    fn joints(&self) -> &[Joint];

    /// The first column of each joint.
    fn first(&self) -> &[usize];

    /// How many columns are in use.
    fn columns(&self) -> usize;

    /// The closure error [rad, or relative to the size] up to which redundant constraints agree.
    fn agree(&self) -> f64;

    /// `e` and `A` at a place.
    fn place<N: Number>(&self, at: &At<Self, N>) -> Placed<Self, N>;

    /// How far it is from closing: an angle [rad], or a gap relative to the size.
    fn residual<N: Number>(&self, placed: &Placed<Self, N>) -> N;

    /// The pseudo-inverse of the screws with one more row.
    fn inverse<N: Number>(&self, screws: &Screws<Self, N>, row: &Self::Columns<N>) -> Inverse<Self, N>;

    /// The screws' coefficients of an order at a place, from those of lower ones and the rates.
    ///
    /// Source: docs/theory.md, (13) and (14).
    fn carry<N: Number, const TERMS: usize>(
        &self,
        at: &At<Self, N>,
        screws: &mut [Screws<Self, N>; TERMS],
        rates: &[Self::Columns<N>; TERMS],
        order: usize,
    );

    /// A bound of the distances within each cycle, and of how slides move its points: half the way round.
    ///
    /// Source: docs/theory.md, (10).
    fn farthest<N: Number>(&self, at: &At<Self, N>) -> Self::Cycles<N>;

    /// `|A+| K3` and `|A+| K5`: bounds of the third derivative of the screws and of the fifth of the closure error, by joints with such
    /// rates, a distance on.
    ///
    /// Source: docs/theory.md, (8) to (11).
    fn bounds<N: Number>(
        &self,
        inverse_norm: N,
        far: &Self::Cycles<N>,
        rates: &[Self::Columns<N>; 3],
        s: N,
    ) -> [N; 2];

    /// `L`: how the screws and the closure's coordinates change across, by the sum of the screws' squares.
    ///
    /// Source: docs/theory.md, (8).
    fn across<N: Number>(&self, far: &Self::Cycles<N>, square: N) -> N;

    /// The stretch of a pass between two places, if its rows over an input have a closed form.
    fn stretch(&self, _input: usize, _ends: [&At<Self>; 2]) -> Option<Stretch<Self>> {
        None
    }

    /// The rows of a stretch at inputs, of which derivatives by time are given; those of no net are not sure.
    fn explicit(
        &self,
        _on: &Stretch<Self>,
        _values: &[f64; QUAD],
        _given: &[f64; 3],
        _rows: &mut Explicits<Self>,
    ) {
    }

    /// Whether joints that move with one freedom leave constraints that say what others say: as many columns as there can be do not.
    fn is_redundant(&self) -> bool {
        self.columns() < Self::COLUMNS
    }

    /// Singular values below this part of the greatest are zero: those that a closure error within what agrees may bring.
    fn no_rank(&self) -> f64 {
        10.0 * self.agree()
    }

    /// The joint of each column.
    fn joint_of(&self, column: usize) -> usize {
        self.first().iter().rposition(|&f| f <= column).unwrap_or(0)
    }

    /// The columns that are angles of joints with one axis.
    fn is_turn(&self, column: usize) -> bool {
        self.joints()[self.joint_of(column)] == Joint::Turn
    }

    /// How many joints are balls.
    fn ball_count(&self) -> usize {
        self.joints()
            .iter()
            .filter(|j| matches!(j, Joint::Ball(_)))
            .count()
    }

    /// The configuration after a move of every column; a ball turns about the axes of the frame before it.
    #[inline(always)]
    fn moved<N: Number>(&self, at: &At<Self, N>, by: &Self::Columns<N>) -> At<Self, N> {
        let mut out = *at;
        for (joint, &column) in self.joints().iter().zip(self.first()) {
            if let Joint::Ball(b) = *joint {
                let turn = rotation([by[column], by[column + 1], by[column + 2]]);
                out.balls[b] = product(&turn, &at.balls[b]);
            } else {
                out.values[column] = out.values[column] + by[column];
            }
        }
        out
    }

    /// The move from one configuration to another, turns taken the short way.
    #[inline(always)]
    fn difference(&self, from: &At<Self>, to: &At<Self>) -> Self::Columns<f64> {
        let mut by = Self::Columns::filled(0.0);
        for (joint, &column) in self.joints().iter().zip(self.first()) {
            match *joint {
                Joint::Ball(b) => {
                    let turn = product(&to.balls[b], &transposed(&from.balls[b]));
                    by.as_mut()[column..column + 3].copy_from_slice(&rotation_vector(&turn));
                }
                Joint::Turn => {
                    by[column] = short_way(to.values[column] - from.values[column]);
                }
                _ => by[column] = to.values[column] - from.values[column],
            }
        }
        by
    }

    /// The joints' screws at a configuration, one for each column in use.
    fn screws(&self, at: &At<Self>) -> Vec<Vec<f64>> {
        let screws = self.place(at).screws;
        let used = &screws.as_ref()[..self.columns()];
        used.iter().map(|s| s.as_ref().to_vec()).collect()
    }
}

/// `Clone` and `Copy` of what is generic over what closes. Derived they would ask the same of that.
macro_rules! copied {
    ($($name:ident<S $(, $n:ident)?>),*) => { $(
        impl<S: Closed $(, $n: Number)?> Clone for $name<S $(, $n)?> {
            #[inline(always)]
            fn clone(&self) -> Self {
                *self
            }
        }
        impl<S: Closed $(, $n: Number)?> Copy for $name<S $(, $n)?> {}
    )* };
}
pub(crate) use copied;

/// `A`, column by column.
pub(crate) type Screws<S, N = f64> = <S as Closed>::Columns<<S as Closed>::Rows<N>>;

/// Where the joints stand: a value for each column but a ball's, a rotation for each ball.
#[derive(Debug)]
pub(crate) struct At<S: Closed, N: Number = f64> {
    pub values: S::Columns<N>,
    pub balls: S::Balls<Rotation<N>>,
}

/// `e` and `A` evaluated: each column's screw, and how far it is from closing.
#[derive(Debug)]
pub(crate) struct Placed<S: Closed, N: Number = f64> {
    pub screws: Screws<S, N>,
    pub error: S::Rows<N>,
    /// Cosine of the angle by which it fails to close.
    pub closing_cosine: N,
}

/// A pseudo-inverse, one column for each row of the matrix, the last for the row that borders them.
#[derive(Debug)]
pub(crate) struct Inverse<S: Closed, N: Number = f64>(pub S::Bordered<S::Columns<N>>);

copied!(At<S, N>, Placed<S, N>, Inverse<S, N>);

impl<S: Closed> At<S> {
    /// All joints at zero.
    #[inline(always)]
    pub fn zero() -> Self {
        Self {
            values: S::Columns::filled(0.0),
            balls: S::Balls::filled(Pose::STILL.rotation),
        }
    }
}

impl<S: Closed> Explicits<S> {
    /// Room for rows.
    pub fn none() -> Self {
        let zero = S::Columns::filled([0.0; QUAD]);
        Self {
            values: zero,
            rates: [zero; 3],
            residual: [f64::NAN; QUAD],
            condition: [f64::NAN; QUAD],
            is_sure: [false; QUAD],
        }
    }
}

impl<S: Closed, N: Number> At<S, N> {
    /// Frees the first balls from the rounding of many products.
    #[inline(always)]
    pub fn square_up(&mut self, balls: usize) {
        for b in 0..balls {
            self.balls[b] = squared_up(&self.balls[b]);
        }
    }
}

impl<S: Closed, V: Vector> At<S, V> {
    /// Configurations side by side, one in each lane.
    #[inline(always)]
    pub fn beside(each: &[At<S>; LANES], balls: usize) -> Self {
        let zero = V::splat(0.0);
        let mut out = Self {
            values: S::Columns::filled(zero),
            balls: S::Balls::filled([[zero; 3]; 3]),
        };
        let mut lanes = [0.0; LANES];
        for c in 0..S::COLUMNS {
            for k in 0..LANES {
                lanes[k] = each[k].values[c];
            }
            out.values[c] = V::load(&lanes);
        }
        for b in 0..balls {
            for i in 0..9 {
                for k in 0..LANES {
                    lanes[k] = each[k].balls[b][i / 3][i % 3];
                }
                out.balls[b][i / 3][i % 3] = V::load(&lanes);
            }
        }
        out
    }

    /// The configuration of each lane.
    #[inline(always)]
    pub fn apart(&self, balls: usize) -> [At<S>; LANES] {
        let mut out = [At::<S>::zero(); LANES];
        for c in 0..S::COLUMNS {
            let lanes = self.values[c].store();
            for k in 0..LANES {
                out[k].values[c] = lanes[k];
            }
        }
        for b in 0..balls {
            for i in 0..9 {
                let lanes = self.balls[b][i / 3][i % 3].store();
                for k in 0..LANES {
                    out[k].balls[b][i / 3][i % 3] = lanes[k];
                }
            }
        }
        out
    }
}

impl<S: Closed, N: Number> Inverse<S, N> {
    /// The product with right-hand sides of the first rows.
    #[inline(always)]
    pub fn times(&self, b: &[N]) -> S::Columns<N> {
        let mut x = S::Columns::filled(N::splat(0.0));
        for (column, b) in self.0.as_ref().iter().zip(b) {
            for c in 0..S::COLUMNS {
                x[c] = x[c].plus_product(column[c], *b);
            }
        }
        x
    }

    /// The square of the Frobenius norm of the first columns.
    #[inline(always)]
    pub fn square(&self, columns: usize) -> N {
        let mut sum = N::splat(0.0);
        for column in &self.0.as_ref()[..columns] {
            for x in column.as_ref() {
                sum = sum.plus_product(*x, *x);
            }
        }
        sum
    }

    /// The move `d` with `(A + change) d = -error`, by the inverse of `A` and a few terms of Neumann's series.
    #[inline(always)]
    pub fn correction(
        &self,
        (from, now): (&Screws<S, N>, &Screws<S, N>),
        error: &S::Rows<N>,
        terms: usize,
    ) -> (S::Columns<N>, S::Columns<N>) {
        let mut change = *now;
        for c in 0..S::COLUMNS {
            for k in 0..S::ROWS {
                change[c][k] = change[c][k] - from[c][k];
            }
        }
        let mut first = self.times(error.as_ref());
        for x in first.as_mut() {
            *x = -*x;
        }
        let mut d = first;
        for _ in 0..terms {
            let seen = self.times(twist_of(&change, &d).as_ref());
            for c in 0..S::COLUMNS {
                d[c] = first[c] - seen[c];
            }
        }
        (d, first)
    }
}

/// The twist of rates by the screws.
#[inline(always)]
pub(crate) fn twist_of<N, C, R, M>(screws: &M, rates: &C) -> R
where
    N: Number,
    C: Array<N>,
    R: Array<N>,
    M: Array<R>,
{
    let mut sum = R::filled(N::splat(0.0));
    for c in 0..C::COUNT {
        for k in 0..R::COUNT {
            sum[k] = sum[k].plus_product(screws[c][k], rates[c]);
        }
    }
    sum
}

/// The row of the Jacobian that names the input.
pub(crate) fn input_row<N: Number, C: Array<N>>(input: usize) -> C {
    let mut row = C::filled(N::splat(0.0));
    row[input] = N::splat(1.0);
    row
}
