//! How far the outputs of a block are from wanted readings, wherever on the turn these start.
//!
//! With the zeros of both dials free, the least greatest error of a start is half the range of `+-beta(start + a) - b`; the sign
//! is the direction in which the output's axis points.

use super::wish::Readings;
use crate::rssr::{BLOCK, Dimensions, Lane};
use crate::simd::multiply_add;
use crate::vector_math::{ROUNDER, atan2, sin_cos};
use std::f64::consts::TAU;

/// Linkages whose windows are compared at a time, in registers.
const LANES: usize = 8;

/// A number for each of them.
type Group = [f64; LANES];

/// The best start of each linkage of a block.
pub(super) struct Best {
    /// The error there [rad]; infinite where there is none.
    pub(super) error: Lane,
    /// The square of the sine of the least transmission angle there.
    pub(super) sine: Lane,
    /// The start, by its number.
    pub(super) start: Lane,
    /// Twice the branch, and one more where the output is read backwards.
    pub(super) way: Lane,
}

impl Best {
    const fn new() -> Self {
        Self {
            error: [0.0; BLOCK],
            sine: [0.0; BLOCK],
            start: [0.0; BLOCK],
            way: [0.0; BLOCK],
        }
    }
}

/// The outputs of a block at all samples, and their errors.
pub(super) struct Compared {
    /// Both branches at each sample.
    angles: Vec<[Lane; 2]>,
    /// The square of the sine of the transmission angle at each sample.
    sines: Vec<Lane>,
    /// The greatest of all starts' least ones.
    pub(super) widest: Lane,
    /// Of the starts that transmit well enough, that of the least error.
    pub(super) nearest: Best,
    /// Of the starts within tolerance, that which transmits best.
    pub(super) clearest: Best,
}

impl Compared {
    pub(super) fn new(readings: &Readings) -> Self {
        let count = readings.samples.len();
        Self {
            angles: vec![[[0.0; BLOCK]; 2]; count],
            sines: vec![[0.0; BLOCK]; count],
            widest: [0.0; BLOCK],
            nearest: Best::new(),
            clearest: Best::new(),
        }
    }

    /// Computes the outputs from each linkage's own start on, then compares every window.
    #[inline(always)]
    pub(super) fn find<const FUSED: bool>(
        &mut self,
        block: &Dimensions,
        start: &Lane,
        readings: &Readings,
        floor: f64,
        tolerance: f64,
    ) {
        self.follow::<FUSED>(block, start, readings);
        self.widest = [-1.0; BLOCK];
        self.nearest.error = [f64::INFINITY; BLOCK];
        self.nearest.sine = [-1.0; BLOCK];
        self.clearest.error = [f64::INFINITY; BLOCK];
        self.clearest.sine = [-1.0; BLOCK];
        for group in 0..BLOCK / LANES {
            for (number, &first) in readings.first.iter().enumerate() {
                self.compare(group, number, first, readings, floor, tolerance);
            }
        }
    }

    /// `beta = atan2(F, E) -+ acos(K / rho)` on both branches, continued from sample to sample.
    #[inline(always)]
    fn follow<const FUSED: bool>(&mut self, block: &Dimensions, start: &Lane, readings: &Readings) {
        let [m, n, l1, l2, l3, d, s, c] = block;
        let zero = [0.0; BLOCK];
        let (mut p, mut q, mut k0, mut arm) = (zero, zero, zero, zero);
        for i in 0..BLOCK {
            let (sine, cosine) = sin_cos::<FUSED>(start[i] * readings.between);
            (p[i], q[i]) = (l1[i] * cosine, l1[i] * sine);
            let z = multiply_add::<FUSED>(n[i], c[i], -m[i]);
            let f = n[i] * s[i];
            let squares =
                multiply_add::<FUSED>(d[i], d[i], f * f) + multiply_add::<FUSED>(z, z, l1[i] * l1[i]);
            k0[i] = 0.5 * (squares + (l3[i] - l2[i]) * (l3[i] + l2[i]));
            let product = l2[i] * l3[i];
            arm[i] = 1.0 / (product * product);
        }
        let mut before = [zero; 2];
        for (k, &angle) in readings.samples.iter().enumerate() {
            let (sa, ca) = sin_cos::<FUSED>(angle);
            let [first, second] = &mut self.angles[k];
            let sines = &mut self.sines[k];
            let [before_first, before_second] = &mut before;
            for i in 0..BLOCK {
                let along = multiply_add::<FUSED>(p[i], ca, -q[i] * sa);
                let across = multiply_add::<FUSED>(q[i], ca, p[i] * sa);
                let e = across - d[i];
                let f = multiply_add::<FUSED>(n[i], s[i], -c[i] * along);
                let k =
                    multiply_add::<FUSED>(-m[i] * s[i], along, multiply_add::<FUSED>(-d[i], across, k0[i]));
                let square = multiply_add::<FUSED>(e, e, f * f);
                let w = multiply_add::<FUSED>(l3[i] * l3[i], square, -k * k);
                let slope = if w > 0.0 { w } else { 0.0 }.sqrt();
                let spread = atan2::<FUSED>(slope, k);
                let phase = atan2::<FUSED>(f, e);
                sines[i] = w * arm[i];
                first[i] = continued::<FUSED>(before_first[i], phase - spread);
                second[i] = continued::<FUSED>(before_second[i], phase + spread);
                before_first[i] = first[i];
                before_second[i] = second[i];
            }
        }
    }

    /// One start of a group of linkages, on both branches and read both ways.
    #[inline(always)]
    fn compare(
        &mut self,
        group: usize,
        number: usize,
        first: usize,
        readings: &Readings,
        floor: f64,
        tolerance: f64,
    ) {
        let wanted = &readings.output[..];
        let count = wanted.len();
        let mut sine = [f64::INFINITY; LANES];
        for row in &self.sines[first..first + count] {
            sine = lesser(&sine, part(row, group));
        }
        let widest = part_mut(&mut self.widest, group);
        *widest = greater(widest, &sine);
        if greatest(&sine) <= 0.0 {
            return;
        }
        let (mid, end) = (count / 2, count - 1);
        let worst = greater(part(&self.nearest.error, group), &[tolerance; LANES]);
        let angles = &self.angles[first..first + count];
        for way in 0..4 {
            let (branch, sign) = (way / 2, if way % 2 == 0 { 1.0 } else { -1.0 });
            let zero = part(&angles[0][branch], group);
            // no window is better than half the range of some of its readings
            let last = off(part(&angles[end][branch], group), zero, sign, wanted[end]);
            let middle = off(part(&angles[mid][branch], group), zero, sign, wanted[mid]);
            let mut bound = [0.0; LANES];
            let mut hopeful = [0.0; LANES];
            for i in 0..LANES {
                let (low, high) = if last[i] < middle[i] {
                    (last[i], middle[i])
                } else {
                    (middle[i], last[i])
                };
                let three = above(high) + above(-low);
                bound[i] = if readings.ends_only { last[i].abs() } else { three };
                let hope = (0.5 * bound[i] <= worst[i]) & (sine[i] > 0.0);
                hopeful[i] = if hope { 1.0 } else { 0.0 };
            }
            if greatest(&hopeful) == 0.0 {
                continue;
            }
            let (mut low, mut high, mut back) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
            let forwards = if wanted[end] < 0.0 { -1.0 } else { 1.0 };
            let mut before = [0.0; LANES];
            for (k, reading) in wanted.iter().enumerate() {
                let error = off(part(&angles[k][branch], group), zero, sign, *reading);
                low = lesser(&low, &error);
                high = greater(&high, &error);
                for i in 0..LANES {
                    let now = forwards * (error[i] + reading);
                    let step = now - before[i];
                    back[i] = if step < back[i] { step } else { back[i] };
                    before[i] = now;
                }
            }
            let mut range = bound;
            if !readings.ends_only {
                for i in 0..LANES {
                    range[i] = high[i] - low[i];
                }
            }
            let slack = if readings.monotone { 0.0 } else { f64::NEG_INFINITY };
            for i in 0..LANES {
                let lane = group * LANES + i;
                let good = (back[i] >= slack) & (sine[i] > 0.0);
                let error = if good { 0.5 * range[i] } else { f64::INFINITY };
                let (number, way) = (number as f64, way as f64);
                let nearer = (sine[i] >= floor) & (error < self.nearest.error[lane]);
                self.nearest.take(nearer, lane, error, sine[i], number, way);
                let clearer = (error <= tolerance) & (sine[i] > self.clearest.sine[lane]);
                self.clearest.take(clearer, lane, error, sine[i], number, way);
            }
        }
    }
}

#[inline(always)]
fn part(lane: &Lane, group: usize) -> &Group {
    &lane.as_chunks().0[group]
}

#[inline(always)]
fn part_mut(lane: &mut Lane, group: usize) -> &mut Group {
    &mut lane.as_chunks_mut().0[group]
}

/// How far each is from a reading, from its first on.
#[inline(always)]
fn off(angle: &Group, zero: &Group, sign: f64, wanted: f64) -> Group {
    let mut off = [0.0; LANES];
    for i in 0..LANES {
        off[i] = sign * (angle[i] - zero[i]) - wanted;
    }
    off
}

#[inline(always)]
fn lesser(a: &Group, b: &Group) -> Group {
    let mut less = *a;
    for i in 0..LANES {
        less[i] = if b[i] < a[i] { b[i] } else { a[i] };
    }
    less
}

#[inline(always)]
fn greater(a: &Group, b: &Group) -> Group {
    let mut more = *a;
    for i in 0..LANES {
        more[i] = if b[i] > a[i] { b[i] } else { a[i] };
    }
    more
}

#[inline(always)]
fn greatest(a: &Group) -> f64 {
    let mut most = a[0];
    for x in a {
        most = if *x > most { *x } else { most };
    }
    most
}

#[inline(always)]
fn above(x: f64) -> f64 {
    if x > 0.0 { x } else { 0.0 }
}

impl Best {
    #[inline(always)]
    fn take(&mut self, better: bool, i: usize, error: f64, sine: f64, start: f64, way: f64) {
        self.error[i] = if better { error } else { self.error[i] };
        self.sine[i] = if better { sine } else { self.sine[i] };
        self.start[i] = if better { start } else { self.start[i] };
        self.way[i] = if better { way } else { self.way[i] };
    }
}

/// An angle moved by whole turns to where it is nearest to the one before.
#[inline(always)]
fn continued<const FUSED: bool>(before: f64, angle: f64) -> f64 {
    let turns = multiply_add::<FUSED>(before - angle, 1.0 / TAU, ROUNDER) - ROUNDER;
    multiply_add::<FUSED>(TAU, turns, angle)
}
