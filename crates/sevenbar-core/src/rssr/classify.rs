//! Motion type and limits of many square-axis RSSRs: in vector code where the answer stands clear, else one by one.

use super::lines::{ARCS, BLOCK, Dimensions, EMPTY, FULL, Lane, Lines};
use super::linkage::{Input, Rssr};
use super::motion::MotionType;
use crate::error::Error;
use crate::parallel::for_each;
use crate::simd::{Kernel, dispatch};

/// Limits that a linkage can have: the zeros of a quartic.
pub const MOST_LIMITS: usize = 4;

/// The code of dimensions that make no linkage: not finite, a length that is not positive or is lost beside the others.
pub const INVALID: u8 = 6;

/// The code of what vector code leaves to the other solver, which replaces it.
pub(crate) const DOUBTFUL: u8 = 7;

/// Linkages of the paper's square axes.
const SQUARE: Dimensions = {
    let mut block = [[1.0; BLOCK]; 8];
    block[7] = [0.0; BLOCK];
    block
};

/// No limits.
const NONE: [f64; MOST_LIMITS] = [f64::NAN; MOST_LIMITS];

/// Where the exponent stands in the bits of a number.
const MANTISSA_BITS: u32 = 52;

/// The exponents of a number and of the power of two that brings it into [1/2, 1) have this sum, as they stand in the bits.
const EXPONENT_SUM: u64 = 2045;

/// Linkages that a thread takes at a time.
const CHUNK: usize = 64 * BLOCK;

/// A length below this share of the greatest dimension is left to the other solver, which knows when it is lost.
const SHORT: f64 = 1e-10;

/// The motion type of each linkage as a number, or [`INVALID`], and its input dead centres in [0, 2 pi), rising, NaN after
/// the last.
///
/// `dimensions` are M, N, L1, L2, L3, D of the paper's square axes, in any unit of length. The answer for a linkage does not
/// depend on the others, nor on the number of threads.
///
/// # Errors
/// [`Error::Lengths`] where the arrays are not of one length.
pub fn classify(
    dimensions: [&[f64]; 6],
    input: Input,
    threads: usize,
    codes: &mut [u8],
    limits: &mut [[f64; MOST_LIMITS]],
) -> Result<(), Error> {
    let want = columns_of_one_length(dimensions)?;
    for (what, got) in [("codes", codes.len()), ("limits", limits.len())] {
        if got != want {
            return Err(Error::Lengths { what, got, want });
        }
    }
    let chunks = codes.chunks_mut(CHUNK).zip(limits.chunks_mut(CHUNK)).enumerate();
    for_each(chunks, threads, |(index, (codes, limits))| {
        let first = index * CHUNK;
        let dimensions = dimensions.map(|column| &column[first..first + codes.len()]);
        dispatch(Chunk { dimensions, input, codes, limits });
    });
    Ok(())
}

/// The length that the columns of the dimensions have in common.
pub(super) fn columns_of_one_length(dimensions: [&[f64]; 6]) -> Result<usize, Error> {
    let want = dimensions[0].len();
    match dimensions.into_iter().find(|column| column.len() != want) {
        Some(column) => Err(Error::Lengths { what: "dimensions", got: column.len(), want }),
        None => Ok(want),
    }
}

/// Linkages one after the other, with the room for their answers.
struct Chunk<'a> {
    dimensions: [&'a [f64]; 6],
    input: Input,
    codes: &'a mut [u8],
    limits: &'a mut [[f64; MOST_LIMITS]],
}

impl Kernel for Chunk<'_> {
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let Self { dimensions, input, codes, limits } = self;
        let other = match input {
            Input::Crank => Input::Rocker,
            Input::Rocker => Input::Crank,
        };
        // what stands beyond the last linkage of a block is answered, too, and not read
        let mut block = SQUARE;
        let mut valid = [0.0; BLOCK];
        let (mut there, mut back) = (Lines::new(), Lines::new());
        let mut ends = [[0.0; BLOCK]; MOST_LIMITS];
        let mut found = [0.0; BLOCK];
        for start in (0..codes.len()).step_by(BLOCK) {
            let size = BLOCK.min(codes.len() - start);
            for (column, values) in block.iter_mut().zip(dimensions) {
                column[..size].copy_from_slice(&values[start..start + size]);
            }
            scale(&mut block, &mut valid);
            there.find::<FUSED>(&block, input);
            back.find::<FUSED>(&block, other);
            there.limits::<FUSED>(&block, input, &mut ends);
            decide(&block, &valid, &there, &back, &mut found);
            for i in 0..size {
                let answer = match found[i] as u8 {
                    INVALID => (INVALID, NONE),
                    DOUBTFUL => one_by_one(std::array::from_fn(|k| block[k][i]), input),
                    clear => (clear, std::array::from_fn(|k| ends[k][i])),
                };
                (codes[start + i], limits[start + i]) = answer;
            }
        }
    }
}

/// The size of a number as its bits: their order is that of the sizes, with infinity and NaN on top.
#[inline(always)]
fn size(x: f64) -> u64 {
    x.abs().to_bits()
}

#[inline(always)]
fn larger(a: u64, b: u64) -> u64 {
    if a > b { a } else { b }
}

/// The power of two that brings a number of such a size into [1/2, 1), as near as it can.
#[inline(always)]
fn shrinking(size: u64) -> f64 {
    f64::from_bits(larger(EXPONENT_SUM.saturating_sub(size >> MANTISSA_BITS), 1) << MANTISSA_BITS)
}

/// Divides the dimensions of each linkage by a power of two, and returns which could be one: 1, else 0.
#[inline(always)]
fn scale(block: &mut Dimensions, valid: &mut Lane) {
    let [m, n, l1, l2, l3, d, ..] = block;
    for i in 0..BLOCK {
        let greatest = larger(larger(size(m[i]), size(n[i])), size(d[i]));
        let greatest = larger(greatest, larger(larger(size(l1[i]), size(l2[i])), size(l3[i])));
        let finite = greatest < f64::INFINITY.to_bits();
        let lengths = (l1[i] > 0.0) & (l2[i] > 0.0) & (l3[i] > 0.0);
        valid[i] = if finite & lengths { 1.0 } else { 0.0 };
        let factor = shrinking(greatest);
        for column in [&mut *m, &mut *n, &mut *l1, &mut *l2, &mut *l3, &mut *d] {
            column[i] *= factor;
        }
    }
}

/// The code of each linkage from what both its joints can do.
#[inline(always)]
fn decide(block: &Dimensions, valid: &Lane, there: &Lines, back: &Lines, found: &mut Lane) {
    let [_, _, l1, l2, l3, ..] = block;
    for i in 0..BLOCK {
        let (input, output) = (there.reach[i], back.reach[i]);
        let long = (l1[i] > SHORT) & (l2[i] > SHORT) & (l3[i] > SHORT);
        let clear = long & (there.doubt[i] + back.doubt[i] == 0.0);
        let code = code_of(input, output);
        let code = if clear { code } else { f64::from(DOUBTFUL) };
        found[i] = if valid[i] > 0.0 { code } else { f64::from(INVALID) };
    }
}

/// The motion type of what input and output can do, or [`DOUBTFUL`]: no other pair of counts is possible, see
/// `Rssr::motion_type`.
#[inline(always)]
pub(crate) fn code_of(input: f64, output: f64) -> f64 {
    let same = if input == FULL {
        f64::from(MotionType::DoubleCrank as u8)
    } else if input == EMPTY {
        f64::from(MotionType::CannotAssemble as u8)
    } else {
        f64::from(MotionType::DoubleRocker as u8)
    };
    let other = if (input == FULL) & (output == ARCS) {
        f64::from(MotionType::CrankRocker as u8)
    } else if (input == ARCS) & (output == FULL) {
        f64::from(MotionType::RockerCrank as u8)
    } else {
        f64::from(DOUBTFUL)
    };
    if input == output { same } else { other }
}

/// The answer of the solver that counts zeros by signs.
#[inline(never)]
fn one_by_one(dimensions: [f64; 6], input: Input) -> (u8, [f64; MOST_LIMITS]) {
    linkage(dimensions).map_or((INVALID, NONE), |linkage| {
        let (motion_type, limits) = linkage.type_and_limits(input);
        (motion_type as u8, padded(&limits))
    })
}

/// The linkage of some dimensions, of about the size 1; `None` for dimensions that make none.
pub(super) fn linkage(dimensions: [f64; 6]) -> Option<Rssr> {
    let [_, _, l1, l2, l3, _] = dimensions;
    let factor = shrinking(dimensions.into_iter().map(size).fold(0, larger));
    let lengths = l1 > 0.0 && l2 > 0.0 && l3 > 0.0;
    // what is not finite, or lost beside the others, is found there
    lengths
        .then(|| Rssr::square(dimensions.map(|x| x * factor)).ok())
        .flatten()
}

/// Limits with NaN after the last. A quartic has no more; where rounding made more of them, the first ones.
pub(crate) fn padded(limits: &[f64]) -> [f64; MOST_LIMITS] {
    std::array::from_fn(|k| limits.get(k).copied().unwrap_or(f64::NAN))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Numbers in [0, 1), the same in every run.
    struct Random(u64);

    impl Random {
        fn next(&mut self) -> f64 {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
            (self.0 >> 11) as f64 * f64::EPSILON * 0.5
        }
    }

    /// Six columns: lengths uniform or over four decades, couplers short or not, M, N, D of either sign and often 0.
    fn columns(count: usize) -> Vec<Vec<f64>> {
        let mut random = Random(88_172_645_463_325_252);
        let mut columns = vec![Vec::new(); 6];
        for index in 0..count {
            for (k, column) in columns.iter_mut().enumerate() {
                let spread = if index % 4 == 0 { 4.0 } else { 1.0 };
                let length = 10_f64.powf(spread * (random.next() - 0.5));
                let short = if k == 3 && index % 5 == 0 { 1e-3 } else { 1.0 };
                let sign = if random.next() < 0.5 { -1.0 } else { 1.0 };
                let gone = index % 3 == 0 && random.next() < 0.4;
                column.push(match k {
                    2..=4 => length * short,
                    _ if gone => 0.0,
                    _ => sign * length,
                });
            }
        }
        columns
    }

    type Answers = (Vec<u8>, Vec<[u64; MOST_LIMITS]>);

    /// Codes, and the bits of the limits.
    fn answers(columns: &[Vec<f64>], input: Input, threads: usize) -> Answers {
        let count = columns[0].len();
        let (mut codes, mut limits) = (vec![0; count], vec![NONE; count]);
        let slices = std::array::from_fn(|k| columns[k].as_slice());
        classify(slices, input, threads, &mut codes, &mut limits).unwrap();
        (
            codes,
            limits.into_iter().map(|row| row.map(f64::to_bits)).collect(),
        )
    }

    /// Fails unless both say the same, the limits within so many parts of their condition.
    fn agree(columns: &[Vec<f64>], input: Input, (codes, limits): &Answers, parts: f64) {
        for (i, (&code, row)) in codes.iter().zip(limits).enumerate() {
            let dimensions = std::array::from_fn(|k| columns[k][i]);
            let linkage = Rssr::square(dimensions).unwrap();
            let motion = linkage.motion(input);
            assert_eq!(code, motion.motion_type as u8, "{dimensions:?}");
            let got: Vec<f64> = row
                .iter()
                .map(|&x| f64::from_bits(x))
                .filter(|x| !x.is_nan())
                .collect();
            assert_eq!(got.len(), motion.limits.len(), "{dimensions:?}");
            assert!(got.is_sorted() && got.iter().all(|x| (0.0..TAU).contains(x)));
            let pair = linkage.pair(input);
            let discriminant = pair.discriminant();
            for want in motion.limits {
                let slope = discriminant.derivative().value(want);
                let condition = (pair.discriminant_noise() / (8.0 * f64::EPSILON) / slope).abs();
                let apart = |x: &f64| {
                    let turn = (x - want).abs();
                    turn.min(TAU - turn)
                };
                let nearest = got.iter().map(apart).fold(TAU, f64::min);
                assert!(
                    nearest <= parts * condition.max(1.0),
                    "{dimensions:?} {nearest} {condition}"
                );
            }
        }
    }

    #[test]
    fn types_and_limits_are_those_of_the_motion() {
        let columns = columns(3000);
        for input in [Input::Crank, Input::Rocker] {
            agree(&columns, input, &answers(&columns, input, 1), 1e-14);
        }
    }

    #[test]
    fn the_answer_for_a_linkage_knows_nothing_of_the_others() {
        let columns = columns(2 * CHUNK + 77);
        let whole = answers(&columns, Input::Crank, 1);
        assert_eq!(whole, answers(&columns, Input::Crank, 3));
        for start in [0, 1, 63, 64, CHUNK - 1, 2 * CHUNK + 76] {
            for size in [1, 5, 64] {
                let end = (start + size).min(whole.0.len());
                let part: Vec<Vec<f64>> = columns.iter().map(|c| c[start..end].to_vec()).collect();
                let (codes, limits) = answers(&part, Input::Crank, 1);
                assert_eq!(
                    (&codes[..], &limits[..]),
                    (&whole.0[start..end], &whole.1[start..end])
                );
            }
        }
    }

    #[test]
    fn the_least_machine_agrees_with_the_motion_too() {
        let columns = columns(1500);
        let (mut codes, mut limits) = (vec![0; 1500], vec![NONE; 1500]);
        let chunk = Chunk {
            dimensions: std::array::from_fn(|k| columns[k].as_slice()),
            input: Input::Rocker,
            codes: &mut codes,
            limits: &mut limits,
        };
        chunk.run::<false>();
        let bits = limits.into_iter().map(|row| row.map(f64::to_bits)).collect();
        agree(&columns, Input::Rocker, &(codes, bits), 1e-14);
    }

    #[test]
    fn vector_code_answers_all_but_few() {
        let mut random = Random(3);
        let mut block = SQUARE;
        let (mut lines, mut ends, mut doubtful) = (Lines::new(), [[0.0; BLOCK]; MOST_LIMITS], 0);
        for _ in 0..200 {
            for column in &mut block[..6] {
                column.fill_with(|| 0.05 + random.next());
            }
            lines.find::<true>(&block, Input::Crank);
            lines.limits::<true>(&block, Input::Crank, &mut ends);
            doubtful += lines.doubt.iter().filter(|&&x| x > 0.0).count();
        }
        assert!(doubtful * 500 < 200 * BLOCK, "{doubtful}");
    }

    #[test]
    fn what_makes_no_linkage_is_invalid_and_disturbs_no_neighbour() {
        let good = [0.7, 0.7, 0.25, 0.99, 0.55, 0.0];
        let mut rows = vec![good];
        for k in 0..6 {
            for wrong in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                rows.push(std::array::from_fn(|j| if j == k { wrong } else { good[j] }));
            }
        }
        for k in 2..5 {
            for wrong in [0.0, -0.25, 1e-17, 5e-324] {
                rows.push(std::array::from_fn(|j| if j == k { wrong } else { good[j] }));
            }
        }
        rows.push(good);
        let columns: Vec<Vec<f64>> = (0..6).map(|k| rows.iter().map(|row| row[k]).collect()).collect();
        let (codes, limits) = answers(&columns, Input::Crank, 1);
        let last = codes.len() - 1;
        assert!(codes[0] < INVALID && codes[0] == codes[last] && limits[0] == limits[last]);
        assert!(codes[1..last].iter().all(|&code| code == INVALID));
        assert!(
            limits[1..last]
                .iter()
                .flatten()
                .all(|&x| f64::from_bits(x).is_nan())
        );
    }

    #[test]
    fn a_power_of_two_as_the_unit_changes_no_bit() {
        let columns = columns(500);
        let want = answers(&columns, Input::Crank, 1);
        for exponent in [-1000, -60, 1, 1000] {
            let scaled: Vec<Vec<f64>> = columns
                .iter()
                .map(|column| column.iter().map(|x| x * 2_f64.powi(exponent)).collect())
                .collect();
            assert_eq!(answers(&scaled, Input::Crank, 1), want, "{exponent}");
        }
    }
}
