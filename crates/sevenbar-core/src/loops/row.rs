//! A row of a circuit as the chain has it.

use super::chain::Configuration;
use super::dense::COLUMNS;
use super::rates::{ORDERS, Rates};
use crate::outcome::RowStatus;

/// The input at unit speed.
pub(super) const UNIT: [f64; ORDERS] = [1.0, 0.0, 0.0];

/// A row of a circuit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    pub at: Configuration,
    pub rates: Rates,
    pub status: RowStatus,
    pub pass: usize,
    pub residual: f64,
    pub condition: f64,
}

impl Row {
    /// The row at an input beyond a limit.
    pub fn missing(pass: usize) -> Self {
        let mut at = Configuration::ZERO;
        at.values = [f64::NAN; COLUMNS];
        Self {
            at,
            rates: [[f64::NAN; COLUMNS]; ORDERS],
            status: RowStatus::NoSolution,
            pass,
            residual: f64::NAN,
            condition: f64::NAN,
        }
    }
}

/// A row's numbers.
#[derive(Clone, Copy)]
pub(super) struct Solved<N> {
    pub at: Configuration<N>,
    pub rates: Rates<N>,
    pub residual: N,
    pub condition: N,
}
