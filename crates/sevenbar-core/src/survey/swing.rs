//! The ranges of a block's outputs, and the turn of the input from the low end to the high one.
//!
//! The output moves where its own `rho^2 - K^2` is not negative; at an end of its range the crank's two positions are one.

use super::kind::Kind;
use crate::rssr::{BLOCK, Dimensions, Lane, MotionType};
use crate::simd::multiply_add;
use crate::vector_math::{atan2, sin_cos};
use std::f64::consts::TAU;

/// What the outputs of a block do on each circuit; NaN where there is none or the output turns fully.
pub(super) struct Swing {
    /// The low end of the output's range, in [0, 2 pi).
    pub(super) low: [Lane; 2],
    /// How far the output goes.
    pub(super) angle: [Lane; 2],
    /// The input at the low end.
    pub(super) crank: [Lane; 2],
    /// The turn of the input from the low end to the high one, in [0, 2 pi); NaN where the input does not turn fully.
    pub(super) stroke: [Lane; 2],
}

/// The rocker at an angle, as seen from the crank: the place of its ball in the crank's plane, and K.
#[inline(always)]
fn seen<const FUSED: bool>(block: &Dimensions, angle: f64, i: usize) -> (f64, f64, f64) {
    let [m, n, l1, l2, l3, d, s, c] = block;
    let (sb, cb) = sin_cos::<FUSED>(angle);
    let (up, along) = (l3[i] * sb, l3[i] * cb);
    let x = multiply_add::<FUSED>(m[i], s[i], -c[i] * up);
    let y = d[i] + along;
    let z = multiply_add::<FUSED>(m[i], c[i], s[i] * up) - n[i];
    let square = multiply_add::<FUSED>(x, x, multiply_add::<FUSED>(y, y, z * z));
    let k = 0.5 * (square + (l1[i] - l2[i]) * (l1[i] + l2[i]));
    (x, y, k)
}

/// The crank's angle where both its positions are one.
#[inline(always)]
fn crank_at<const FUSED: bool>(block: &Dimensions, angle: f64, i: usize) -> f64 {
    let (x, y, k) = seen::<FUSED>(block, angle, i);
    let side = 1.0_f64.copysign(k);
    atan2::<FUSED>(side * y, side * x)
}

impl Swing {
    pub(super) const fn new() -> Self {
        let none = [[0.0; BLOCK]; 2];
        Self { low: none, angle: none, crank: none, stroke: none }
    }

    #[inline(always)]
    pub(super) fn find<const FUSED: bool>(&mut self, block: &Dimensions, kind: &Kind) {
        let [a, b, c, d] = &kind.turns;
        for i in 0..BLOCK {
            // the output can be between its first two limits, or beyond them
            let middle = 0.5 * (a[i] + b[i]);
            let (x, y, k) = seen::<FUSED>(block, if middle >= 0.0 { middle } else { 0.0 }, i);
            let radius = block[2][i];
            let between = radius * radius * multiply_add::<FUSED>(x, x, y * y) > k * k;
            let two = d[i] >= 0.0;
            let last = if two { d[i] } else { b[i] };
            let first = if between { a[i] } else { last };
            let second = if between { c[i] } else { b[i] };
            self.low[0][i] = first;
            self.angle[0][i] = if between { b[i] - a[i] } else { a[i] + TAU - last };
            self.low[1][i] = if two { second } else { f64::NAN };
            self.angle[1][i] = if two {
                if between { d[i] - c[i] } else { c[i] - b[i] }
            } else {
                f64::NAN
            };
        }
        let (crank_rocker, double_rocker) = (
            f64::from(MotionType::CrankRocker as u8),
            f64::from(MotionType::DoubleRocker as u8),
        );
        for circuit in 0..2 {
            for i in 0..BLOCK {
                let rocks = (kind.code[i] == crank_rocker) | (kind.code[i] == double_rocker);
                let there = rocks & (self.angle[circuit][i] >= 0.0);
                let low = if there { self.low[circuit][i] } else { 0.0 };
                let swing = if there { self.angle[circuit][i] } else { 0.0 };
                let at_low = crank_at::<FUSED>(block, low, i);
                let turn = crank_at::<FUSED>(block, low + swing, i) - at_low;
                let stroke = if turn < 0.0 { turn + TAU } else { turn };
                self.angle[circuit][i] = if there { swing } else { f64::NAN };
                self.crank[circuit][i] = at_low;
                let timed = there & (kind.code[i] == crank_rocker);
                self.stroke[circuit][i] = if timed { stroke } else { f64::NAN };
            }
        }
    }

    /// Time of the slower stroke over that of the quicker; NaN where there is none.
    #[inline(always)]
    pub(super) fn time_ratio(&self, circuit: usize, i: usize) -> f64 {
        let slow = self.slow(circuit, i);
        slow / (TAU - slow)
    }

    /// The turn of the input on the slower stroke.
    #[inline(always)]
    pub(super) fn slow(&self, circuit: usize, i: usize) -> f64 {
        let stroke = self.stroke[circuit][i];
        if stroke > TAU - stroke {
            stroke
        } else {
            TAU - stroke
        }
    }
}
