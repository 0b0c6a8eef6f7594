//! The rows of a circuit of a net as it is followed, one after the other in one array.

use super::joints::TERMS;
use super::net::MOST_COLUMNS;
use super::sized::SizedNet;
use crate::loops::equation::closed::{At, Explicits};
use crate::loops::equation::rotations::Rotation;
use crate::loops::motions::row::Row;
use crate::loops::motions::row_store::RowStore;
use crate::outcome::RowStatus;

/// Numbers of a row besides its columns and balls: status, pass, residual and condition.
const BESIDES: usize = 4;

/// Most numbers of a row without balls.
const MOST_NUMBERS: usize = TERMS * MOST_COLUMNS + BESIDES;

/// The rows of a circuit: columns and their rates as they are followed, at unit speed of the input or by a law.
#[derive(Clone, Debug)]
pub struct NetRows {
    numbers: Vec<f64>,
    /// How many columns and balls are followed.
    sizes: [usize; 2],
    /// The row that comes first; after the last come those before it.
    first: usize,
    /// Whole turns to be added to each column of the description.
    pub(super) offsets: Vec<f64>,
    pub(super) speed: f64,
}

/// A row of a circuit: its columns, its balls, its rates order by order, and what else is known of it.
#[derive(Clone, Copy, Debug)]
pub struct NetRow<'a> {
    numbers: &'a [f64],
    sizes: [usize; 2],
}

impl NetRows {
    /// The same with turns to be added to columns of the description, at a speed.
    pub(super) fn at_speed(self, offsets: Vec<f64>, speed: f64) -> Self {
        Self { offsets, speed, ..self }
    }

    /// How many rows.
    pub fn len(&self) -> usize {
        self.numbers.len() / count(self.sizes)
    }

    /// One of the rows.
    #[inline]
    fn row(&self, k: usize) -> NetRow<'_> {
        let (size, place) = (count(self.sizes), self.first + k);
        let place = if place < self.len() {
            place
        } else {
            place - self.len()
        };
        NetRow { numbers: &self.numbers[place * size..][..size], sizes: self.sizes }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.numbers.is_empty()
    }

    /// The rows, one after the other.
    pub fn rows(&self) -> impl Iterator<Item = NetRow<'_>> {
        let sizes = self.sizes;
        let (last, first) = self.numbers.split_at(self.first * count(sizes));
        let each = first
            .chunks_exact(count(sizes))
            .chain(last.chunks_exact(count(sizes)));
        each.map(move |numbers| NetRow { numbers, sizes })
    }

    /// Every row as numbers, from which `from_numbers` makes it again to the last bit; how many columns and balls are followed, turns to be
    /// added to each column of the description, and the speed.
    pub fn numbers(&self) -> (Vec<f64>, [usize; 2], Vec<f64>, f64) {
        let mut numbers = self.numbers.clone();
        numbers.rotate_left(self.first * count(self.sizes));
        (numbers, self.sizes, self.offsets.clone(), self.speed)
    }

    /// Rows of what `numbers` gave; `None` where these are no such numbers.
    pub fn from_numbers(numbers: &[f64], sizes: [usize; 2], offsets: Vec<f64>, speed: f64) -> Option<Self> {
        let whole = numbers.len().is_multiple_of(count(sizes));
        let rows = Self { numbers: numbers.to_vec(), sizes, first: 0, offsets, speed };
        let known = |row: NetRow<'_>| RowStatus::numbered(row.besides(0)).is_some();
        (whole && rows.rows().all(known)).then_some(rows)
    }
}

impl<const C: usize, const R: usize, const B: usize> RowStore<SizedNet<C, R, B>> for NetRows {
    fn none(net: &SizedNet<C, R, B>, room: usize) -> Self {
        let sizes = [net.used(), net.net.balls.len()];
        Self {
            numbers: Vec::with_capacity(room * count(sizes)),
            sizes,
            first: 0,
            offsets: Vec::new(),
            speed: 1.0,
        }
    }

    fn reserve(&mut self, more: usize) {
        self.numbers.reserve(more * count(self.sizes));
    }

    fn push(&mut self, row: Row<SizedNet<C, R, B>>) {
        let [columns, balls] = self.sizes;
        self.numbers.extend_from_slice(&row.at.values[..columns]);
        self.numbers
            .extend_from_slice(row.at.balls[..balls].as_flattened().as_flattened());
        for order in &row.rates {
            self.numbers.extend_from_slice(&order[..columns]);
        }
        let (status, pass) = (f64::from(row.status as u8), row.pass as f64);
        self.numbers
            .extend_from_slice(&[status, pass, row.residual, row.condition]);
    }

    fn push_explicit(&mut self, pass: usize, own: &Explicits<SizedNet<C, R, B>>, rows: usize) {
        let columns = self.sizes[0];
        let size = count([columns, 0]);
        let [status, pass] = [f64::from(RowStatus::Ok as u8), pass as f64];
        // nets with a closed form have fewer columns than can be followed
        let mut row = [0.0; MOST_NUMBERS];
        for k in 0..rows {
            for c in 0..columns {
                row[c] = own.values[c][k];
                for order in 0..TERMS - 1 {
                    row[(order + 1) * columns + c] = own.rates[order][c][k];
                }
            }
            row[TERMS * columns..size].copy_from_slice(&[status, pass, own.residual[k], own.condition[k]]);
            self.numbers.extend_from_slice(&row[..size]);
        }
    }

    fn count(&self) -> usize {
        self.len()
    }

    #[inline]
    fn status(&self, k: usize) -> RowStatus {
        self.row(k).status()
    }

    #[inline]
    fn value(&self, k: usize, column: usize) -> f64 {
        self.row(k).values()[column]
    }

    #[inline]
    fn rates(&self, k: usize, column: usize) -> [f64; 3] {
        let row = self.row(k);
        [row.rates(0)[column], row.rates(1)[column], row.rates(2)[column]]
    }

    fn at(&self, k: usize) -> At<SizedNet<C, R, B>> {
        let row = self.row(k);
        let mut at = At::<SizedNet<C, R, B>>::zero();
        at.values[..self.sizes[0]].copy_from_slice(row.values());
        for (ball, own) in at.balls.iter_mut().zip(row.balls()) {
            *ball = own;
        }
        at
    }

    fn add(&mut self, rows: usize, by: &[f64; C]) {
        let [columns, _] = self.sizes;
        let each = self.numbers.chunks_exact_mut(count(self.sizes));
        for row in each.take(rows) {
            for (value, by) in row[..columns].iter_mut().zip(by) {
                *value += by;
            }
        }
    }

    fn leave_out(&mut self, first: usize) {
        self.numbers.drain(..first * count(self.sizes));
    }

    fn truncate(&mut self, rows: usize) {
        self.numbers.truncate(rows * count(self.sizes));
    }

    fn begin_with(&mut self, first: usize) {
        self.first = first;
    }
}

/// How many numbers a row is.
fn count([columns, balls]: [usize; 2]) -> usize {
    TERMS * columns + 9 * balls + BESIDES
}

impl<'a> NetRow<'a> {
    /// Its columns.
    #[inline]
    pub(super) fn values(&self) -> &'a [f64] {
        &self.numbers[..self.sizes[0]]
    }

    /// Its balls.
    pub(super) fn balls(&self) -> impl Iterator<Item = Rotation> {
        let [columns, balls] = self.sizes;
        let each = self.numbers[columns..][..9 * balls].chunks_exact(9);
        each.map(|ball| std::array::from_fn(|i| std::array::from_fn(|j| ball[3 * i + j])))
    }

    /// The series of its rates, one coefficient after the other of all columns.
    #[inline]
    pub(super) fn rates(&self, order: usize) -> &'a [f64] {
        let [columns, balls] = self.sizes;
        &self.numbers[columns + 9 * balls + order * columns..][..columns]
    }

    fn besides(&self, place: usize) -> f64 {
        self.numbers[self.numbers.len() - BESIDES + place]
    }

    /// What it holds.
    #[inline]
    pub fn status(&self) -> RowStatus {
        RowStatus::numbered(self.besides(0)).unwrap_or(RowStatus::NoSolution)
    }

    /// Its pass between dead centres of the input.
    pub fn pass(&self) -> usize {
        self.besides(1) as usize
    }

    /// The closure error [rad, or relative to the size].
    pub fn residual(&self) -> f64 {
        self.besides(2)
    }

    /// The condition number of its Jacobian.
    pub fn condition(&self) -> f64 {
        self.besides(3)
    }
}
