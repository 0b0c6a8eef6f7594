//! The linkages of a survey by their index alone: `x_j(k) = frac(s_j + k A_j)`, with powers of one number as the steps A.
//!
//! The number is the root of `x^9 = x + 1`, whose inverse powers fill a cube of eight sides evenly (Roberts' generalisation of
//! the golden ratio; Kronecker's sequence). Everything is a sum of integers, so any block is made anywhere to the same bits.

use crate::random::Random;
use crate::rssr::{BLOCK, Dimensions, Lane};
use crate::vector_math::sin_cos;

/// M, N, L1, L2, L3, D, and the angle between the axes.
pub const NUMBERS: usize = 7;

/// The numbers, and where the input's readings start.
const SIDES: usize = NUMBERS + 1;

/// Newton steps for the root: they converge in six.
const STEPS: usize = 20;

/// Parts into which the range of each number is divided where linkages are distinguished.
const PARTS: u32 = 3;

/// The part of the cube that a linkage lies in, at most this.
pub(super) const CELLS: usize = 3_usize.pow(NUMBERS as u32);

/// How linkages are drawn: the range of each number, and a seed.
#[derive(Clone, Debug)]
pub struct Draw {
    low: [f64; NUMBERS],
    width: [f64; NUMBERS],
    shift: [u64; SIDES],
    step: [u64; SIDES],
}

impl Draw {
    /// Numbers between bounds: lengths of about the size 1, the angle in radians.
    pub fn new(bounds: [[f64; 2]; NUMBERS], seed: u64) -> Self {
        let mut root: f64 = 1.1;
        for _ in 0..STEPS {
            let fourth = root * root * root * root;
            let eighth = fourth * fourth;
            root -= (eighth * root - root - 1.0) / (9.0 * eighth - 1.0);
        }
        let mut random = Random(seed);
        let mut power = 1.0;
        Self {
            low: bounds.map(|[low, _]| low),
            width: bounds.map(|[low, high]| high - low),
            shift: std::array::from_fn(|_| (random.uniform() * 2.0_f64.powi(53)) as u64 * 2048),
            step: std::array::from_fn(|_| {
                power /= root;
                (power * 2.0_f64.powi(64)) as u64
            }),
        }
    }

    /// A coordinate of a linkage in the cube, in [0, 1).
    #[inline(always)]
    fn share(&self, side: usize, index: u64) -> f64 {
        let word = self.shift[side].wrapping_add(index.wrapping_mul(self.step[side]));
        (word >> 11) as f64 * (0.5 * f64::EPSILON)
    }

    /// The numbers of one linkage.
    pub fn numbers(&self, index: u64) -> [f64; NUMBERS] {
        std::array::from_fn(|k| self.low[k] + self.width[k] * self.share(k, index))
    }

    /// The dimensions of a block that begins with an index, and the share of a step by which its readings are shifted.
    #[inline(always)]
    pub(super) fn block<const FUSED: bool>(&self, first: u64, block: &mut Dimensions, start: &mut Lane) {
        for (k, lane) in block.iter_mut().enumerate().take(NUMBERS) {
            for (i, x) in lane.iter_mut().enumerate() {
                *x = self.low[k] + self.width[k] * self.share(k, first + i as u64);
            }
        }
        for i in 0..BLOCK {
            start[i] = self.share(NUMBERS, first + i as u64);
            (block[6][i], block[7][i]) = sin_cos::<FUSED>(block[6][i]);
        }
    }

    /// The part of the cube in which a linkage lies: of each number that is free the low, the middle or the high third.
    pub(super) fn cell(&self, index: u64) -> usize {
        (0..NUMBERS).fold(0, |cell, k| {
            let third = if self.width[k] > 0.0 {
                (f64::from(PARTS) * self.share(k, index)) as usize
            } else {
                0
            };
            cell * PARTS as usize + third
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_has_the_numbers_of_its_indices() {
        let draw = Draw::new([[-1.0, 2.0]; NUMBERS], 5);
        let (mut block, mut start) = ([[0.0; BLOCK]; 8], [0.0; BLOCK]);
        for first in [0, 1, 77, 99_999_936] {
            draw.block::<false>(first, &mut block, &mut start);
            for (i, index) in (first..first + BLOCK as u64).enumerate() {
                let row = block.map(|lane| lane[i]);
                let numbers = draw.numbers(index);
                assert_eq!(row[..6], numbers[..6]);
                assert!((row[6] - numbers[6].sin()).abs() < 1e-15);
                assert!((row[7] - numbers[6].cos()).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn every_eighth_of_a_range_has_its_share_of_any_thousand() {
        let draw = Draw::new([[0.0, 8.0]; NUMBERS], 3);
        for first in [0, 31_415_926, 99_999_000] {
            let mut counts = [[0_i32; 8]; NUMBERS];
            for index in first..first + 1000 {
                for (k, x) in draw.numbers(index).into_iter().enumerate() {
                    counts[k][x as usize] += 1;
                }
            }
            assert!(
                counts.iter().flatten().all(|n| (n - 125).abs() <= 12),
                "{counts:?}"
            );
        }
    }
}
