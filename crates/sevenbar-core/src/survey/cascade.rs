//! The questions to the linkages of a block, from cheap to dear; only those that are left go on to the next.

use super::draw::{Draw, NUMBERS};
use super::figures::Figures;
use super::judge::Measured;
use super::kind::Kind;
use super::pose::Row;
use super::readings::{Best, Compared};
use super::swing::Swing;
use super::tally::{Tally, Verdict};
use super::transmission::Transmission;
use super::wish::{Rank, Readings, Want, Wish};
use crate::rssr::{BLOCK, Dimensions, Lane, MotionType};
use crate::simd::{Kernel, dispatch};
use crate::stopping;
use std::f64::consts::{PI, TAU};

/// Inputs of a whole turn at which the balls are measured.
const TURN: usize = 36;

/// Judges the linkages of some indices; the answer is the same however they are divided.
pub fn survey(draw: &Draw, wish: &Wish, first: u64, count: u64) -> Tally {
    let mut tally = Tally::new();
    dispatch(Cascade { draw, wish, first, count, tally: &mut tally });
    tally
}

struct Cascade<'a> {
    draw: &'a Draw,
    wish: &'a Wish,
    first: u64,
    count: u64,
    tally: &'a mut Tally,
}

/// What is measured of every linkage of a block.
struct Every {
    kind: Kind,
    swing: Swing,
    transmission: Transmission,
}

/// Linkages that wait until a block of them is full.
struct Waiting {
    block: Dimensions,
    start: Lane,
    index: [u64; BLOCK],
    size: usize,
}

impl Every {
    const fn new() -> Self {
        Self {
            kind: Kind::new(),
            swing: Swing::new(),
            transmission: Transmission::new(),
        }
    }

    #[inline(always)]
    fn find<const FUSED: bool>(&mut self, block: &Dimensions) {
        self.kind.find::<FUSED>(block);
        self.swing.find::<FUSED>(block, &self.kind);
        self.transmission.find::<FUSED>(block);
    }

    /// Counts one linkage in the histograms.
    fn count(&self, tally: &mut Tally, i: usize) {
        tally.types[self.kind.code[i] as usize] += 1;
        let limits = self.kind.limits.iter().filter(|lane| !lane[i].is_nan()).count();
        tally.limits[limits / 2] += 1;
        for circuit in 0..2 {
            tally.swing.add(self.swing.angle[circuit][i]);
            tally.slow.add(self.swing.slow(circuit, i) - PI);
        }
        if self.kind.input_turns(i) {
            tally
                .transmission
                .add(self.transmission.least[i].clamp(0.0, 1.0).sqrt().asin());
        }
    }
}

impl Kernel for Cascade<'_> {
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let Self { draw, wish, first, count, tally } = self;
        let mut every = Box::new(Every::new());
        let (mut block, mut start) = ([[0.0; BLOCK]; 8], [0.0; BLOCK]);
        let mut waiting = Waiting { block, start, index: [0; BLOCK], size: 0 };
        let mut compared = match &wish.want {
            Want::Readings(readings) => Some(Compared::new(readings)),
            Want::Swing { .. } => None,
        };
        let mut at = first;
        while at < first + count {
            stopping::piece();
            let size = (first + count - at).min(BLOCK as u64) as usize;
            draw.block::<FUSED>(at, &mut block, &mut start);
            every.find::<FUSED>(&block);
            for i in 0..size {
                let index = at + i as u64;
                every.count(tally, i);
                if let Some(refused) = refused(&block, &every, wish, i) {
                    tally.count(refused);
                } else if let Want::Swing { angle, slow } = wish.want {
                    judge_swing(draw, wish, tally, &block, &every, [angle, slow], index, i);
                } else {
                    waiting.push(&block, &start, index, i);
                }
                if waiting.size == BLOCK {
                    judge_readings::<FUSED>(draw, wish, tally, &mut waiting, compared.as_mut());
                }
            }
            at += size as u64;
        }
        judge_readings::<FUSED>(draw, wish, tally, &mut waiting, compared.as_mut());
    }
}

/// Why a linkage is refused before it is compared with what is wanted.
fn refused(block: &Dimensions, every: &Every, wish: &Wish, i: usize) -> Option<Verdict> {
    let code = every.kind.code[i];
    let [m, n, l1, l2, l3, d, ..] = block;
    let shortest = l1[i].min(l2[i]).min(l3[i]);
    let longest = [m[i], n[i], l1[i], l2[i], l3[i], d[i]]
        .into_iter()
        .fold(0.0, |longest: f64, x| longest.max(x.abs()));
    if longest > wish.ratio * shortest {
        return Some(Verdict::Size);
    }
    if code == f64::from(MotionType::CannotAssemble as u8) {
        return Some(Verdict::Assembly);
    }
    if code == f64::from(MotionType::ChangePoint as u8) {
        return Some(Verdict::ChangePoint);
    }
    let other = wish.motion_type.is_some_and(|wanted| code != f64::from(wanted));
    other.then_some(Verdict::MotionType)
}

fn row(block: &Dimensions, i: usize) -> Row {
    std::array::from_fn(|k| block[k][i])
}

impl Waiting {
    fn push(&mut self, block: &Dimensions, start: &Lane, index: u64, i: usize) {
        for (own, lane) in self.block.iter_mut().zip(block) {
            own[self.size] = lane[i];
        }
        self.start[self.size] = start[i];
        self.index[self.size] = index;
        self.size += 1;
    }
}

/// Compares the linkages that wait with the readings.
#[inline(always)]
fn judge_readings<const FUSED: bool>(
    draw: &Draw,
    wish: &Wish,
    tally: &mut Tally,
    waiting: &mut Waiting,
    compared: Option<&mut Compared>,
) {
    let (Want::Readings(readings), Some(compared)) = (&wish.want, compared) else {
        return;
    };
    let sine = wish.transmission.sin();
    let floor = sine * sine;
    compared.find::<FUSED>(&waiting.block, &waiting.start, readings, floor, wish.tolerance);
    for i in 0..std::mem::take(&mut waiting.size) {
        judge_one(draw, wish, tally, waiting, compared, readings, floor, i);
    }
}

/// The verdict on one that was compared.
#[expect(clippy::too_many_arguments)]
fn judge_one(
    draw: &Draw,
    wish: &Wish,
    tally: &mut Tally,
    waiting: &Waiting,
    compared: &Compared,
    readings: &Readings,
    floor: f64,
    i: usize,
) {
    let measured = |best: &Best| {
        let (start, way) = (best.start[i] as usize, best.way[i] as usize);
        Measured {
            index: waiting.index[i],
            cell: draw.cell(waiting.index[i]),
            row: row(&waiting.block, i),
            branch: way / 2,
            sense: if way.is_multiple_of(2) { 1.0 } else { -1.0 },
            start: waiting.start[i] * readings.between + readings.samples[readings.first[start]],
            error: best.error[i],
            sine: best.sine[i],
        }
    };
    let (nearest, clearest) = (&compared.nearest, &compared.clearest);
    tally.error.add(nearest.error[i]);
    if nearest.error[i] <= wish.tolerance {
        let best = if wish.rank == Rank::Error {
            nearest
        } else {
            clearest
        };
        let first = readings.first[best.start[i] as usize];
        let from = readings.samples[first];
        let inputs = readings.samples[first..first + readings.output.len()].iter();
        measured(best).near_enough(inputs.map(|x| x - from), wish, tally);
    } else if clearest.sine[i] > 0.0 {
        measured(clearest).too_flat(tally);
    } else if nearest.error[i].is_finite() {
        measured(nearest).too_far(tally);
    } else if compared.widest[i] <= 0.0 {
        tally.count(Verdict::Reach);
    } else {
        tally.count(if compared.widest[i] < floor {
            Verdict::Transmission
        } else {
            Verdict::Error
        });
    }
}

/// The verdict on a crank-rocker of which a swing is wanted; others have another motion type.
#[expect(clippy::too_many_arguments)]
fn judge_swing(
    draw: &Draw,
    wish: &Wish,
    tally: &mut Tally,
    block: &Dimensions,
    every: &Every,
    [angle, slow]: [f64; 2],
    index: u64,
    i: usize,
) {
    if every.kind.code[i] != f64::from(MotionType::CrankRocker as u8) {
        return tally.count(Verdict::MotionType);
    }
    let swing = &every.swing;
    let [first, second] = [0, 1].map(|k| {
        let (off, late) = ((swing.angle[k][i] - angle).abs(), (swing.slow(k, i) - slow).abs());
        if off > late { off } else { late }
    });
    let (circuit, error) = if second < first { (1, second) } else { (0, first) };
    tally.error.add(error);
    let row = row(block, i);
    let start = swing.crank[circuit][i];
    let found = Measured {
        index,
        cell: draw.cell(index),
        row,
        branch: Measured::branch_of(&row, start, swing.low[circuit][i]),
        sense: 1.0,
        start,
        error,
        sine: every.transmission.least[i],
    };
    let sine = wish.transmission.sin();
    if error > wish.tolerance {
        found.too_far(tally);
    } else if found.sine < sine * sine {
        found.too_flat(tally);
    } else {
        let step = TAU / TURN as f64;
        found.near_enough((0..TURN).map(|k| step * k as f64), wish, tally);
    }
}

/// What linkages of given numbers (M, N, L1, L2, L3, D, the angle between the axes) are measured by.
pub fn figures(numbers: &[[f64; NUMBERS]]) -> Vec<Figures> {
    let mut found = Vec::with_capacity(numbers.len());
    dispatch(Listed { numbers, found: &mut found });
    found
}

struct Listed<'a> {
    numbers: &'a [[f64; NUMBERS]],
    found: &'a mut Vec<Figures>,
}

impl Kernel for Listed<'_> {
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let mut every = Box::new(Every::new());
        for part in self.numbers.chunks(BLOCK) {
            let mut block = [[1.0; BLOCK]; 8];
            for (i, numbers) in part.iter().enumerate() {
                let [m, n, l1, l2, l3, d, angle] = *numbers;
                let (sine, cosine) = angle.sin_cos();
                for (lane, x) in block.iter_mut().zip([m, n, l1, l2, l3, d, sine, cosine]) {
                    lane[i] = x;
                }
            }
            every.find::<FUSED>(&block);
            self.found.extend((0..part.len()).map(|i| every.figures(i)));
        }
    }
}

impl Every {
    fn figures(&self, i: usize) -> Figures {
        Figures {
            motion_type: self.kind.code[i] as u8,
            limits: std::array::from_fn(|k| self.kind.limits[k][i]),
            swing: std::array::from_fn(|k| self.swing.angle[k][i]),
            time_ratio: std::array::from_fn(|k| self.swing.time_ratio(k, i)),
            transmission: if self.kind.input_turns(i) {
                self.transmission.least[i].clamp(0.0, 1.0).sqrt().asin()
            } else {
                f64::NAN
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rssr::{Input, Rssr};
    use crate::survey::{Entry, VERDICTS};
    use std::f64::consts::FRAC_PI_2;

    const BOUNDS: [[f64; 2]; NUMBERS] = [
        [-2.0, 2.0],
        [-2.0, 2.0],
        [0.2, 2.0],
        [0.2, 3.0],
        [1.0, 1.0],
        [-2.0, 2.0],
        [0.0, PI],
    ];

    fn wish(want: Want, rank: Rank) -> Wish {
        Wish {
            want,
            tolerance: 0.2,
            motion_type: None,
            ratio: 15.0,
            transmission: 0.6,
            cones: [0.5, 2.0],
            seats: [None, Some([-1.0, 0.0, 0.0])],
            rank,
        }
    }

    fn readings() -> Want {
        let input: Vec<f64> = (0..13).map(|k| 0.125 * PI / 3.0 * f64::from(k)).collect();
        let output: Vec<f64> = input.iter().map(|x| 0.3 * x).collect();
        Want::Readings(Readings::new(&input, &output, false, true))
    }

    /// The best of several tallies, put together in any order.
    fn together(parts: &[Tally], count: usize) -> Vec<(usize, Entry)> {
        let mut best: Vec<(usize, Entry)> = Vec::new();
        for (cell, entry) in parts.iter().flat_map(|part| part.best(count)) {
            match best
                .iter_mut()
                .find(|(other, known)| *other == cell && known.branch == entry.branch)
            {
                Some((_, known)) if (entry.figure, entry.index) < (known.figure, known.index) => {
                    *known = entry
                }
                Some(_) => {}
                None => best.push((cell, entry)),
            }
        }
        best.sort_by(|(_, a), (_, b)| a.figure.total_cmp(&b.figure).then(a.index.cmp(&b.index)));
        best.truncate(count);
        best
    }

    #[test]
    fn the_answer_is_the_same_however_indices_are_divided() {
        let draw = Draw::new(BOUNDS, 7);
        for want in [readings(), Want::Swing { angle: 1.0, slow: 3.3 }] {
            for rank in [Rank::Error, Rank::Transmission, Rank::Cone] {
                let wish = wish(want.clone(), rank);
                let whole = survey(&draw, &wish, 1000, 20_000);
                assert!(whole.verdicts[0] > 2, "{:?}", whole.verdicts);
                for size in [997, 6400] {
                    let mut parts = Vec::new();
                    for first in (1000..21_000).step_by(size) {
                        let count = (21_000 - first).min(size as u64);
                        parts.push(survey(&draw, &wish, first, count));
                    }
                    parts.reverse();
                    let sum = |k: usize| parts.iter().map(|part| part.verdicts[k]).sum::<u64>();
                    assert!((0..VERDICTS).all(|k| sum(k) == whole.verdicts[k]));
                    assert_eq!(together(&parts, 10), whole.best(10));
                }
            }
        }
    }

    #[test]
    fn every_linkage_has_one_verdict_and_one_type() {
        let draw = Draw::new(BOUNDS, 1);
        let tally = survey(&draw, &wish(readings(), Rank::Error), 0, 3001);
        for counts in [&tally.verdicts[..], &tally.types, &tally.limits] {
            assert_eq!(counts.iter().sum::<u64>(), 3001);
        }
    }

    /// The same numbers as by the solver that takes one linkage at a time.
    fn agree(numbers: &[[f64; NUMBERS]]) {
        for (row, found) in numbers.iter().zip(figures(numbers)) {
            let [m, n, l1, l2, l3, d, angle] = *row;
            let motion = Rssr::skew([m, n, l1, l2, l3, d], [angle.sin(), angle.cos()])
                .unwrap()
                .motion(Input::Crank);
            assert_eq!(found.motion_type, motion.motion_type as u8, "{row:?}");
            if motion.motion_type == MotionType::ChangePoint {
                continue;
            }
            let limits: Vec<f64> = found.limits.into_iter().filter(|x| !x.is_nan()).collect();
            assert_eq!(limits.len(), motion.limits.len(), "{row:?}");
            for (got, want) in limits.iter().zip(&motion.limits) {
                let turn = (got - want).abs();
                assert!(turn.min(TAU - turn) < 1e-9, "{row:?} {got} {want}");
            }
            let measures: Vec<crate::outcome::CircuitMeasures> =
                motion.circuits.into_iter().map(Into::into).collect();
            let sorted = |values: Vec<f64>| {
                let mut values: Vec<f64> = values.into_iter().filter(|x| !x.is_nan()).collect();
                values.sort_by(f64::total_cmp);
                values
            };
            let pairs = [
                (
                    found.swing.to_vec(),
                    measures.iter().filter_map(|c| c.swing()).collect(),
                ),
                (
                    found.time_ratio.to_vec(),
                    measures.iter().filter_map(|c| c.time_ratio()).collect(),
                ),
            ];
            for (got, want) in pairs {
                let (got, want): (Vec<f64>, Vec<f64>) = (sorted(got), sorted(want));
                assert_eq!(got.len(), want.len(), "{row:?} {got:?} {want:?}");
                for (x, y) in got.iter().zip(&want) {
                    assert!((x - y).abs() < 1e-8 * y.max(1.0), "{row:?} {x} {y}");
                }
            }
            if let Some(turning) = measures.iter().find(|c| c.input.is_none()) {
                let want = turning.transmission.unwrap()[0][0];
                assert!(
                    (found.transmission.sin() - want.sin()).abs() < 1e-7,
                    "{row:?} {} {want}",
                    found.transmission
                );
            }
        }
    }

    #[test]
    fn the_measures_of_any_linkage_are_those_of_its_motion() {
        let draw = Draw::new(BOUNDS, 2);
        let numbers: Vec<[f64; NUMBERS]> = (0..3000).map(|k| draw.numbers(k)).collect();
        agree(&numbers);
        let square: Vec<[f64; NUMBERS]> = numbers
            .iter()
            .map(|row| std::array::from_fn(|k| if k == 6 { FRAC_PI_2 } else { row[k] }))
            .collect();
        agree(&square);
    }

    #[test]
    fn so_are_those_of_what_people_type() {
        let tenths = |x: f64| (10.0 * x).round() / 10.0;
        let draw = Draw::new(BOUNDS, 3);
        let mut numbers: Vec<[f64; NUMBERS]> = Vec::new();
        for k in 0..600 {
            let row = draw.numbers(k).map(tenths);
            // meeting, parallel and square axes; equal lengths; balls at the foot of the common normal
            for angle in [0.0, FRAC_PI_2, PI, 0.5] {
                numbers.push([row[0], row[1], row[2], row[3], 1.0, 0.0, angle]);
                numbers.push([0.0, 0.0, row[2], row[3], 1.0, row[5], angle]);
                numbers.push([row[0], row[1], 1.0, 1.0, 1.0, row[5], angle]);
            }
        }
        agree(&numbers);
    }
}
