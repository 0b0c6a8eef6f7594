//! How the rows of a circuit are stored: one after the other as they are, or only the numbers that are in use.

use super::row::Row;
use crate::loops::equation::closed::{At, Closed, Explicits};
use crate::outcome::RowStatus;

/// Rows one after the other.
pub(crate) trait RowStore<S: Closed> {
    /// None yet, with room for so many.
    fn none(chain: &S, room: usize) -> Self;
    /// Makes room for so many more.
    fn reserve(&mut self, more: usize);
    /// Takes in one more.
    fn push(&mut self, row: Row<S>);
    /// Takes in the first of some in closed form.
    fn push_explicit(&mut self, pass: usize, own: &Explicits<S>, count: usize) {
        for k in 0..count {
            self.push(Row::explicit(pass, own, k));
        }
    }
    /// How many there are.
    fn count(&self) -> usize;
    /// What one holds.
    fn status(&self, k: usize) -> RowStatus;
    /// A column of one.
    fn value(&self, k: usize, column: usize) -> f64;
    /// The rates of a column of one.
    fn rates(&self, k: usize, column: usize) -> [f64; 3];
    /// The place of one.
    fn at(&self, k: usize) -> At<S>;
    /// Adds to the columns of the first ones.
    fn add(&mut self, count: usize, by: &S::Columns<f64>);
    /// Leaves some out at the beginning.
    fn leave_out(&mut self, first: usize);
    /// Keeps so many.
    fn truncate(&mut self, count: usize);
    /// Begins with another, after the last of which come those before it.
    fn begin_with(&mut self, first: usize);
}

impl<S> RowStore<S> for Vec<Row<S>>
where
    S: Closed,
{
    fn none(_chain: &S, room: usize) -> Self {
        Self::with_capacity(room)
    }

    fn reserve(&mut self, more: usize) {
        self.reserve_exact(more);
    }

    fn push(&mut self, row: Row<S>) {
        self.push(row);
    }

    fn count(&self) -> usize {
        self.len()
    }

    fn status(&self, k: usize) -> RowStatus {
        self[k].status
    }

    fn value(&self, k: usize, column: usize) -> f64 {
        self[k].at.values[column]
    }

    fn rates(&self, k: usize, column: usize) -> [f64; 3] {
        self[k].rates.map(|order| order[column])
    }

    fn at(&self, k: usize) -> At<S> {
        self[k].at
    }

    fn add(&mut self, count: usize, by: &S::Columns<f64>) {
        for row in &mut self[..count] {
            for (value, by) in row.at.values.as_mut().iter_mut().zip(by.as_ref()) {
                *value += by;
            }
        }
    }

    fn leave_out(&mut self, first: usize) {
        self.drain(..first);
    }

    fn truncate(&mut self, count: usize) {
        self.truncate(count);
    }

    fn begin_with(&mut self, first: usize) {
        self.rotate_left(first);
    }
}
