//! The least transmission angle over a whole turn of the input: `sin^2 = (rho^2 - K^2) / (L2 L3)^2` where that is least.

use crate::rssr::{BLOCK, Dimensions, Drive, Input, Lane};
use crate::simd::multiply_add;
use crate::vector_math::sin_cos;
use std::f64::consts::TAU;

/// Inputs of a turn between which the least is sought.
const INPUTS: usize = 24;

/// Newton steps from the least of them.
const STEPS: usize = 4;

/// The greatest Newton step [rad]: half the distance of two inputs.
const LONGEST: f64 = 0.5 * TAU / INPUTS as f64;

/// Room for the two least places of a block.
pub(super) struct Transmission {
    value: [Lane; 2],
    place: [Lane; 2],
    /// The square of the sine of the least transmission angle; negative where the input does not turn fully.
    pub(super) least: Lane,
}

impl Transmission {
    pub(super) const fn new() -> Self {
        Self {
            value: [[0.0; BLOCK]; 2],
            place: [[0.0; BLOCK]; 2],
            least: [0.0; BLOCK],
        }
    }

    /// A polynomial of degree two has two lowest places at most: both are followed.
    #[inline(always)]
    pub(super) fn find<const FUSED: bool>(&mut self, block: &Dimensions) {
        let zero = [0.0; BLOCK];
        let (mut c0, mut c1, mut s1, mut c2, mut s2) = (zero, zero, zero, zero, zero);
        for i in 0..BLOCK {
            let square = Drive::new(block, Input::Crank, i).square::<FUSED>();
            (c0[i], c1[i], s1[i], c2[i], s2[i]) = (square.c0, square.c1, square.s1, square.c2, square.s2);
        }
        self.value = [[f64::INFINITY; BLOCK]; 2];
        self.place = [zero; 2];
        let (mut before, mut here) = (zero, zero);
        for step in 0..INPUTS + 2 {
            let angle = step as f64 * (TAU / INPUTS as f64);
            let (s, c) = sin_cos::<FUSED>(angle);
            let (sd, cd) = (2.0 * s * c, (c - s) * (c + s));
            for i in 0..BLOCK {
                let first = multiply_add::<FUSED>(c1[i], c, multiply_add::<FUSED>(s1[i], s, c0[i]));
                let next = multiply_add::<FUSED>(c2[i], cd, multiply_add::<FUSED>(s2[i], sd, first));
                let low = (step >= 2) & (here[i] < before[i]) & (here[i] <= next);
                let best = low & (here[i] < self.value[0][i]);
                let second = low & !best & (here[i] < self.value[1][i]);
                self.value[1][i] = if best {
                    self.value[0][i]
                } else if second {
                    here[i]
                } else {
                    self.value[1][i]
                };
                self.place[1][i] = if best {
                    self.place[0][i]
                } else if second {
                    angle - TAU / INPUTS as f64
                } else {
                    self.place[1][i]
                };
                self.value[0][i] = if best { here[i] } else { self.value[0][i] };
                self.place[0][i] = if best {
                    angle - TAU / INPUTS as f64
                } else {
                    self.place[0][i]
                };
                before[i] = here[i];
                here[i] = next;
            }
        }
        let [_, _, _, l2, l3, ..] = block;
        self.least = [f64::INFINITY; BLOCK];
        for place in &mut self.place {
            for i in 0..BLOCK {
                for _ in 0..STEPS {
                    let (s, c) = sin_cos::<FUSED>(place[i]);
                    let (sd, cd) = (2.0 * s * c, (c - s) * (c + s));
                    let slope = multiply_add::<FUSED>(s1[i], c, -c1[i] * s)
                        + 2.0 * multiply_add::<FUSED>(s2[i], cd, -c2[i] * sd);
                    let bend = -multiply_add::<FUSED>(s1[i], s, c1[i] * c)
                        - 4.0 * multiply_add::<FUSED>(s2[i], sd, c2[i] * cd);
                    let newton = slope / if bend > 0.0 { bend } else { f64::INFINITY };
                    let step = if newton > LONGEST { LONGEST } else { newton };
                    place[i] -= if step < -LONGEST { -LONGEST } else { step };
                }
                let (s, c) = sin_cos::<FUSED>(place[i]);
                let (sd, cd) = (2.0 * s * c, (c - s) * (c + s));
                let first = multiply_add::<FUSED>(c1[i], c, multiply_add::<FUSED>(s1[i], s, c0[i]));
                let value = multiply_add::<FUSED>(c2[i], cd, multiply_add::<FUSED>(s2[i], sd, first));
                let arm = l2[i] * l3[i];
                let sine = value / (arm * arm);
                self.least[i] = if sine < self.least[i] { sine } else { self.least[i] };
            }
        }
    }
}
