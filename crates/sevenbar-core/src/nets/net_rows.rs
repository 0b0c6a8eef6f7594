//! The rows of a circuit of a net as it is followed, one after the other in one array.

use super::joints::TERMS;
use crate::loops::equation::rotations::Rotation;
use crate::outcome::RowStatus;

/// Numbers of a row besides its columns and balls: status, pass, residual and condition.
const BESIDES: usize = 4;

/// The rows of a circuit: columns and their rates as they are followed, at unit speed of the input or by a law.
#[derive(Clone, Debug)]
pub struct NetRows {
    numbers: Vec<f64>,
    /// How many columns and balls are followed.
    sizes: [usize; 2],
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
    /// No rows yet, with room for so many.
    pub(super) fn new(sizes: [usize; 2], room: usize, offsets: Vec<f64>, speed: f64) -> Self {
        Self {
            numbers: Vec::with_capacity(room * count(sizes)),
            sizes,
            offsets,
            speed,
        }
    }

    /// Takes in one more row, with `besides` its status, pass, residual and condition.
    pub(super) fn push<'a>(
        &mut self,
        values: &[f64],
        balls: &[Rotation],
        rates: impl Iterator<Item = &'a [f64]>,
        besides: (RowStatus, usize, f64, f64),
    ) {
        self.numbers.extend_from_slice(values);
        self.numbers
            .extend_from_slice(balls.as_flattened().as_flattened());
        for order in rates {
            self.numbers.extend_from_slice(order);
        }
        let (status, pass, residual, condition) = besides;
        self.numbers
            .extend_from_slice(&[f64::from(status as u8), pass as f64, residual, condition]);
    }

    /// How many rows.
    pub fn len(&self) -> usize {
        self.numbers.len() / count(self.sizes)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.numbers.is_empty()
    }

    /// The rows, one after the other.
    pub fn rows(&self) -> impl Iterator<Item = NetRow<'_>> {
        let sizes = self.sizes;
        self.numbers
            .chunks_exact(count(sizes))
            .map(move |numbers| NetRow { numbers, sizes })
    }

    /// Every row as numbers, from which `from_numbers` makes it again to the last bit; how many columns and balls are followed, turns to be
    /// added to each column of the description, and the speed.
    pub fn numbers(&self) -> (Vec<f64>, [usize; 2], Vec<f64>, f64) {
        (self.numbers.clone(), self.sizes, self.offsets.clone(), self.speed)
    }

    /// Rows of what `numbers` gave; `None` where these are no such numbers.
    pub fn from_numbers(numbers: &[f64], sizes: [usize; 2], offsets: Vec<f64>, speed: f64) -> Option<Self> {
        let whole = numbers.len().is_multiple_of(count(sizes));
        let rows = Self { numbers: numbers.to_vec(), sizes, offsets, speed };
        let known = |row: NetRow<'_>| RowStatus::numbered(row.besides(0)).is_some();
        (whole && rows.rows().all(known)).then_some(rows)
    }
}

/// How many numbers a row is.
fn count([columns, balls]: [usize; 2]) -> usize {
    TERMS * columns + 9 * balls + BESIDES
}

impl<'a> NetRow<'a> {
    /// Its columns.
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
    pub(super) fn rates(&self, order: usize) -> &'a [f64] {
        let [columns, balls] = self.sizes;
        &self.numbers[columns + 9 * balls + order * columns..][..columns]
    }

    fn besides(&self, place: usize) -> f64 {
        self.numbers[self.numbers.len() - BESIDES + place]
    }

    /// What it holds.
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
