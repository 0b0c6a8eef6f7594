//! The verdict on a linkage, once its measures are there.

use super::pose::{Row, ball_angles, output};
use super::tally::{Entry, Tally, Verdict};
use super::wish::{Rank, Wish};

/// What was measured of a linkage at the best place for what is wanted.
pub(super) struct Measured {
    pub(super) index: u64,
    pub(super) cell: usize,
    pub(super) row: Row,
    pub(super) branch: usize,
    pub(super) sense: f64,
    pub(super) start: f64,
    pub(super) error: f64,
    /// The square of the sine of the least transmission angle.
    pub(super) sine: f64,
}

impl Measured {
    fn entry(&self, figure: f64, cones: [f64; 2]) -> Entry {
        Entry {
            figure,
            index: self.index,
            branch: self.branch,
            sense: self.sense,
            start: self.start,
            error: self.error,
            transmission: self.sine.clamp(0.0, 1.0).sqrt().asin(),
            cones,
        }
    }

    /// Too far off: the nearer the better.
    pub(super) fn too_far(&self, tally: &mut Tally) {
        tally.near(Verdict::Error, self.entry(self.error, [f64::NAN; 2]));
    }

    /// Near enough, but it transmits too little: the more the better.
    pub(super) fn too_flat(&self, tally: &mut Tally) {
        let entry = self.entry(0.0, [f64::NAN; 2]);
        tally.near(
            Verdict::Transmission,
            Entry { figure: -entry.transmission, ..entry },
        );
    }

    /// Near enough and clear: the balls decide, over the inputs from the start on.
    pub(super) fn near_enough(&self, inputs: impl Iterator<Item = f64>, wish: &Wish, tally: &mut Tally) {
        let inputs = inputs.map(|x| self.start + x);
        let cones = ball_angles(&self.row, inputs, self.branch, wish);
        let greatest = if cones[0] > cones[1] { cones[0] } else { cones[1] };
        tally.cone.add(greatest);
        let over = |k: usize| cones[k] - wish.cones[k];
        let excess = if over(0) > over(1) { over(0) } else { over(1) };
        if excess > 0.0 {
            return tally.near(Verdict::Cone, self.entry(excess, cones));
        }
        let entry = self.entry(self.error, cones);
        let figure = match wish.rank {
            Rank::Error => self.error,
            Rank::Transmission => -entry.transmission,
            Rank::Cone => greatest,
        };
        tally.found(self.cell, Entry { figure, ..entry });
    }

    /// The branch on which the output at the start is an angle.
    pub(super) fn branch_of(row: &Row, start: f64, angle: f64) -> usize {
        let apart = |branch: usize| {
            let (s, c) = (output(row, start, branch) - angle).sin_cos();
            s.atan2(c).abs()
        };
        usize::from(apart(1) < apart(0))
    }
}
