//! Phases along followed solutions: of the determinant of the passive screws, and of each joint's distance from a complex value.
//!
//! A phase is unwrapped: it goes on beyond whole turns, so the change along a way is the difference of its two ends.
//!
//! Source: docs/theory_many.md, (12) and (14).

use crate::loops::equation::closure::{Slides, UNKNOWNS};
use crate::loops::equation::lanes::Lanes;
use crate::vectors::{Reals, Vector};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// The determinant, and two factors for each unknown joint.
pub(crate) const FACTORS: usize = 1 + 2 * UNKNOWNS;

/// Square of the cosine of the greatest change of a phase in one step, 0.8 rad. Turns would be miscounted from half a turn on.
const LEAST_COSINE_SQUARE: f64 = 0.485;

/// The joint values whose phases are followed, apart from the determinant.
#[derive(Clone, Debug)]
pub(crate) struct Watch {
    /// The value of each joint that is watched, as the solutions have it: `e^(i t)`, or a length.
    pub values: [Option<Complex64>; UNKNOWNS],
    /// The middle turns of balls, and `e^(i t)` of their zeros. The determinant is divided by the cosine of each such turn: then a ball
    /// counts with three screws along fixed axes, and no turn of the ball alone makes the determinant zero.
    pub middles: Vec<(usize, Complex64)>,
}

impl Watch {
    /// The indices of the factors in use: the determinant, and two for each watched joint.
    pub fn watched(&self) -> impl Iterator<Item = usize> + '_ {
        let joints = (0..UNKNOWNS).filter(|&i| self.values[i].is_some());
        std::iter::once(0).chain(joints.flat_map(|i| [1 + 2 * i, 2 + 2 * i]))
    }
}

/// The unwrapped phases at a place [rad]; NaN for factors not in use.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Phases(pub [f64; FACTORS]);

impl Phases {
    /// The phases of a place at which none were computed.
    pub const NONE: Self = Self([f64::NAN; FACTORS]);
}

/// The phases in each lane: the last factors, and the whole turns so far.
#[derive(Clone, Copy)]
pub(super) struct PhaseLanes<V> {
    factors: [Lanes<V>; FACTORS],
    turns: [V; FACTORS],
}

impl Watch {
    /// The factors at solutions whose screws have these determinants.
    #[inline(always)]
    pub fn factors<V: Vector, const N: usize>(
        &self,
        slides: &Slides<N>,
        x: &[Lanes<V>; N],
        determinant: Lanes<V>,
    ) -> [Lanes<V>; FACTORS] {
        let mut out = [Lanes::zero(); FACTORS];
        out[0] = determinant;
        for &(middle, zero) in &self.middles {
            let z = x[middle] * Lanes::splat(zero.conj());
            out[0] = out[0] * (z + z.recip()).recip();
        }
        for (i, value) in self.values.iter().enumerate() {
            if let &Some(value) = value {
                // the second factor is the first of the solution mirrored at the real inputs
                let mirrored = if slides[i] { x[i] } else { x[i].recip() };
                out[1 + 2 * i] = x[i] - Lanes::splat(value);
                out[2 + 2 * i] = mirrored - Lanes::splat(value.conj());
            }
        }
        out
    }
}

impl<V: Vector> PhaseLanes<V> {
    #[inline(always)]
    pub fn none() -> Self {
        Self { factors: [Lanes::zero(); FACTORS], turns: [V::splat(0.0); FACTORS] }
    }

    /// Negative in the lanes in which some phase changes by more than one step may change it.
    #[inline(always)]
    pub fn steady(&self, now: &[Lanes<V>; FACTORS], watch: &Watch) -> Reals {
        let mut worst = V::splat(0.0);
        for k in watch.watched() {
            let (a, b) = (self.factors[k], now[k]);
            let along = (a.re * b.re).plus_product(a.im, b.im);
            let least = V::splat(LEAST_COSINE_SQUARE) * a.square() * b.square();
            worst = worst.lesser((along * along.size()) - least);
        }
        worst.store()
    }

    /// Takes over new factors in the lanes in which a step is taken, and counts turns.
    #[inline(always)]
    pub fn go_on(&mut self, now: &[Lanes<V>; FACTORS], taken: V, watch: &Watch) {
        let (zero, one, half) = (V::splat(0.0), V::splat(1.0), V::splat(0.5));
        for k in watch.watched() {
            let (a, b) = (self.factors[k], now[k]);
            // one turn more or less where the step crosses the negative real axis
            let sense = (a.re * b.im).minus_product(a.im, b.re);
            let (below, now_below) = (zero.if_greater(a.im, one, zero), zero.if_greater(b.im, one, zero));
            let up = (one - below) * now_below * sense.if_greater(zero, one, zero);
            let down = below * (one - now_below) * zero.if_greater(sense, one, zero);
            self.turns[k] = self.turns[k] + taken.if_greater(half, up - down, zero);
            self.factors[k] = a.replaced_where(taken, half, b);
        }
    }

    /// The phases of a lane.
    #[inline(always)]
    pub fn get(&self, lane: usize, watch: &Watch) -> Phases {
        let mut out = Phases::NONE;
        for k in watch.watched() {
            let z = self.factors[k];
            // a negative zero would be the other side of the cut
            let phase = (z.im.store()[lane] + 0.0).atan2(z.re.store()[lane]);
            out.0[k] = phase + TAU * self.turns[k].store()[lane];
        }
        out
    }

    /// Puts phases into a lane.
    #[inline(always)]
    pub fn put(&mut self, lane: usize, phases: &Phases, watch: &Watch) {
        for k in watch.watched() {
            let phase = phases.0[k];
            let (mut re, mut im) = (self.factors[k].re.store(), self.factors[k].im.store());
            let mut turns = self.turns[k].store();
            // a first phase has nothing to be compared with
            (im[lane], re[lane]) = if phase.is_nan() {
                (0.0, 0.0)
            } else {
                phase.sin_cos()
            };
            turns[lane] = if phase.is_nan() {
                0.0
            } else {
                ((phase - im[lane].atan2(re[lane])) / TAU).round()
            };
            self.factors[k] = Lanes::load(&re, &im);
            self.turns[k] = V::load(&turns);
        }
    }
}
