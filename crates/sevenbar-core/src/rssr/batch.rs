//! Both branches of the closed form for many inputs at once, with derivatives by time.

use super::pair::{DEAD_CENTRE_CONDITION, Pair, REACH_ROUNDING};
use crate::error::Error;
use crate::simd::{Kernel, dispatch, multiply_add};
use crate::taylor::Taylor;
use crate::vector_math::{LARGEST_ANGLE, atan2, sin_cos};
use std::f64::consts::TAU;

/// The highest derivative: jerk.
pub const MAX_ORDER: usize = 3;

/// From this condition on a pose is computed anew with rounding errors kept: [`Pair::follower_taylor`].
const CAREFUL_CONDITION: f64 = 1e3;

/// Inputs handled together; the scratch arrays of a block stay in the nearest cache.
const BLOCK: usize = 64;

/// How the input moves at each sample.
#[derive(Clone, Copy, Debug)]
pub enum BatchRates<'a> {
    /// The same speed [rad/s] everywhere.
    Constant(f64),
    /// Speed, acceleration and jerk of each sample; only as many as the order needs are read.
    Law([&'a [f64]; 3]),
}

impl Pair {
    /// The output and its derivatives up to `outputs.len() - 1` for each input, first all of branch 0, then all of branch 1.
    ///
    /// Out of reach everything is NaN; at a dead centre of the input the rates are.
    ///
    /// # Errors
    /// [`Error::NotFinite`] for an input or rate, [`Error::Lengths`], [`Error::Order`].
    pub fn outputs(
        &self,
        inputs: &[f64],
        rates: BatchRates,
        outputs: &mut [&mut [f64]],
    ) -> Result<(), Error> {
        let order = outputs.len().wrapping_sub(1);
        if order > MAX_ORDER {
            return Err(Error::Order { got: order, highest: MAX_ORDER });
        }
        for output in outputs.iter() {
            if output.len() != 2 * inputs.len() {
                return Err(Error::Lengths { what: "output", got: output.len(), want: 2 * inputs.len() });
            }
        }
        finite("input", inputs)?;
        if let BatchRates::Law(law) = rates {
            for (what, values) in ["speed", "acceleration", "jerk"].into_iter().zip(law).take(order) {
                if values.len() != inputs.len() {
                    return Err(Error::Lengths { what, got: values.len(), want: inputs.len() });
                }
                finite(what, values)?;
            }
        }
        let kernel = Blocks { pair: self, inputs, rates, outputs };
        match order {
            0 => dispatch(Ordered::<0>(kernel)),
            1 => dispatch(Ordered::<1>(kernel)),
            2 => dispatch(Ordered::<2>(kernel)),
            _ => dispatch(Ordered::<3>(kernel)),
        }
        Ok(())
    }
}

fn finite(what: &'static str, values: &[f64]) -> Result<(), Error> {
    let mut largest = 0;
    dispatch(LargestBits { values, largest: &mut largest });
    if largest < f64::INFINITY.to_bits() {
        return Ok(());
    }
    let index = values.iter().position(|x| !x.is_finite()).unwrap_or(0);
    Err(Error::NotFinite { what, index, value: values[index] })
}

/// The greatest absolute value, as its bits: their order is that of the values, with infinity and NaN on top.
struct LargestBits<'a> {
    values: &'a [f64],
    largest: &'a mut u64,
}

impl Kernel for LargestBits<'_> {
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        *self.largest = largest_bits(self.values);
    }
}

#[inline(always)]
fn largest_bits(values: &[f64]) -> u64 {
    values.iter().fold(0, |largest, x| x.abs().to_bits().max(largest))
}

struct Blocks<'a, 'b> {
    pair: &'a Pair,
    inputs: &'a [f64],
    rates: BatchRates<'a>,
    outputs: &'a mut [&'b mut [f64]],
}

struct Ordered<'a, 'b, const ORDER: usize>(Blocks<'a, 'b>);

/// Results of a block: branch, derivative, sample.
type Scratch = [[[f64; BLOCK]; MAX_ORDER + 1]; 2];

impl<const ORDER: usize> Kernel for Ordered<'_, '_, ORDER> {
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let Blocks { pair, inputs, rates, outputs } = self.0;
        let count = inputs.len();
        let mut angles = [0.0; BLOCK];
        let mut law = [[0.0; BLOCK]; MAX_ORDER];
        if let BatchRates::Constant(speed) = rates {
            law[0] = [speed; BLOCK];
        }
        let mut scratch: Scratch = [[[0.0; BLOCK]; MAX_ORDER + 1]; 2];
        let mut start = 0;
        while start < count {
            let size = BLOCK.min(count - start);
            angles[..size].copy_from_slice(&inputs[start..start + size]);
            if largest_bits(&angles) > LARGEST_ANGLE.to_bits() {
                for x in &mut angles {
                    let (s, c) = x.sin_cos();
                    *x = s.atan2(c);
                }
            }
            if let BatchRates::Law(given) = rates {
                for (slots, values) in law.iter_mut().zip(given).take(ORDER) {
                    slots[..size].copy_from_slice(&values[start..start + size]);
                }
            }
            let careful = block::<FUSED, ORDER>(pair, &angles, &law, &mut scratch);
            if careful {
                redo_near_limits(pair, &angles[..size], &law, &mut scratch);
            }
            for (branch, derivatives) in scratch.iter().enumerate() {
                for (output, values) in outputs.iter_mut().zip(derivatives) {
                    let first = branch * count + start;
                    output[first..first + size].copy_from_slice(&values[..size]);
                }
            }
            start += size;
        }
    }
}

/// Computes the poses near a limit anew, one by one.
#[inline(never)]
fn redo_near_limits(pair: &Pair, angles: &[f64], law: &[[f64; BLOCK]; MAX_ORDER], results: &mut Scratch) {
    for (i, &angle) in angles.iter().enumerate() {
        let reach = pair.reach(angle);
        // a little less than the mark that raised the flag, which was computed in another way
        if reach.condition < 0.5 * CAREFUL_CONDITION {
            continue;
        }
        let Some(slope) = reach.slope else {
            continue;
        };
        let driver = Taylor::<4>::from_derivatives(&[angle, law[0][i], law[1][i], law[2][i]]);
        for (branch, derivatives) in results.iter_mut().enumerate() {
            let follower = pair.follower_taylor(driver, branch).unwrap_or_else(|| {
                let mut still = Taylor([f64::NAN; 4]);
                still.0[0] = pair.angle(&reach, slope, branch);
                still
            });
            for (order, slots) in derivatives.iter_mut().enumerate() {
                slots[i] = follower.derivative(order);
            }
        }
    }
}

/// The closed form of [`Pair::reach`], [`Pair::angle`] and the implicit derivatives of the closure, written without branches.
///
/// With `u = p - B` and the follower's radius r the closure `(|u|^2 - L2^2)/2 = 0` has the derivatives `u . p'` by the
/// input and `r (x sin - y cos)` by the output; the paper's Q, R, S, T of eq. (13) are the second ones. Returns whether
/// a pose lies so near a limit that it wants more care.
///
/// Source: docs/rssr.md, (3) to (9).
#[inline(always)]
fn block<const FUSED: bool, const ORDER: usize>(
    pair: &Pair,
    angles: &[f64; BLOCK],
    law: &[[f64; BLOCK]; MAX_ORDER],
    results: &mut Scratch,
) -> bool {
    let radius = pair.radius;
    let radius_inverse = 1.0 / radius;
    let coupler = pair.coupler;
    let coupler_square = coupler * coupler;
    let mut careful = 0_u64;
    let driver_square = pair.driver_radius * pair.driver_radius;
    let cut = pair.phase_cut();
    let signs = [pair.branch_sign(0), pair.branch_sign(1)];
    let [first, second] = results;
    for i in 0..BLOCK {
        let (s, c) = sin_cos::<FUSED>(angles[i]);
        let turning = |c1: f64, s1: f64| multiply_add::<FUSED>(c1, c, s1 * s);
        let (qx, qy, qz) = (
            turning(pair.x.c1, pair.x.s1),
            turning(pair.y.c1, pair.y.s1),
            turning(pair.z.c1, pair.z.s1),
        );
        let (x, y, z) = (pair.x.c0 + qx, pair.y.c0 + qy, pair.z.c0 + qz);
        let square = multiply_add::<FUSED>(x, x, y * y);
        let height = square.sqrt();
        let (inner, outer) = (height - radius, height + radius);
        let axial = (coupler - z) * (coupler + z);
        let near = multiply_add::<FUSED>(-inner, inner, axial);
        let far = multiply_add::<FUSED>(outer, outer, -axial);
        let rounding = -REACH_ROUNDING * coupler * (outer + z.abs());
        let k = 0.25 * (far - near);
        let product = 0.25 * (near.max(0.0) * far.max(0.0));
        let reached = (near >= rounding) & (far >= rounding);
        let slope = if reached { product.sqrt() } else { f64::NAN };
        // the condition is terms / product
        let terms = radius
            * height
            * multiply_add::<FUSED>(outer, outer, multiply_add::<FUSED>(z, z, coupler_square));
        careful |= u64::from(reached & (product * CAREFUL_CONDITION < terms));

        let spread = atan2::<FUSED>(slope, k);
        let phase = atan2::<FUSED>(y, x);
        let phase = if phase < cut { phase + TAU } else { phase };
        first[0][i] = multiply_add::<FUSED>(-signs[0], spread, phase);
        second[0][i] = multiply_add::<FUSED>(-signs[1], spread, phase);
        if ORDER == 0 {
            continue;
        }

        let has_rates = product * DEAD_CENTRE_CONDITION > terms;
        let slope = if has_rates { slope } else { f64::NAN };
        let slope_inverse = 1.0 / slope;
        let unscale = radius_inverse / square;
        let quarter = |c1: f64, s1: f64| multiply_add::<FUSED>(s1, c, -c1 * s);
        let (dx, dy, dz) = (
            quarter(pair.x.c1, pair.x.s1),
            quarter(pair.y.c1, pair.y.s1),
            quarter(pair.z.c1, pair.z.s1),
        );
        let (d1, d2, d3) = (law[0][i], law[1][i], law[2][i]);
        for (branch, sign) in signs.into_iter().enumerate() {
            let signed = sign * slope;
            let sine = multiply_add::<FUSED>(k, y, -signed * x) * unscale;
            let cosine = multiply_add::<FUSED>(k, x, signed * y) * unscale;
            let over = sign * slope_inverse;
            let (ux, uy) = (
                multiply_add::<FUSED>(-radius, cosine, x),
                multiply_add::<FUSED>(-radius, sine, y),
            );
            let along =
                |a: f64, b: f64, e: f64| multiply_add::<FUSED>(a, ux, multiply_add::<FUSED>(b, uy, e * z));
            let across = |a: f64, b: f64| radius * multiply_add::<FUSED>(a, sine, -b * cosine);
            let outward = |a: f64, b: f64| radius * multiply_add::<FUSED>(a, cosine, b * sine);
            let f_a = along(dx, dy, dz);
            let v = f_a * over;
            let target = if branch == 0 { &mut *first } else { &mut *second };
            target[1][i] = v * d1;
            if ORDER == 1 {
                continue;
            }
            let f_aa = driver_square - along(qx, qy, qz);
            let f_ab = across(dx, dy);
            // by the closure itself the second derivative by the output is K
            let f_bb = k;
            let a = (f_aa + v * multiply_add::<FUSED>(v, f_bb, 2.0 * f_ab)) * over;
            target[2][i] = multiply_add::<FUSED>(a * d1, d1, v * d2);
            if ORDER == 2 {
                continue;
            }
            // third derivatives of the closure: by the input -f_a, by the output -(x sin - y cos) r = +sign slope
            let f_aab = -across(qx, qy);
            let f_abb = outward(dx, dy);
            let cubic = multiply_add::<FUSED>(
                v,
                3.0 * multiply_add::<FUSED>(v, f_abb, f_aab) + v * v * signed,
                -f_a,
            );
            let mixed = 3.0 * a * multiply_add::<FUSED>(v, f_bb, f_ab);
            let j = (cubic + mixed) * over;
            target[3][i] =
                multiply_add::<FUSED>(j * d1 * d1, d1, multiply_add::<FUSED>(3.0 * a * d1, d2, v * d3));
        }
    }
    careful != 0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigid::Pose;
    use crate::rssr::{Input, Rssr};

    /// Skew axes 1.3 apart, neither square nor meeting.
    fn skew() -> Rssr {
        let pose = |rotation, translation| Pose { rotation, translation };
        let straight = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let (s, c) = 0.7_f64.sin_cos();
        let tilted = [[0.0, c, -s], [-1.0, 0.0, 0.0], [0.0, s, c]];
        let links = [[0.4, 0.0, 0.1], [1.9, 0.0, 0.0], [0.9, 0.0, -0.2]].map(|t| pose(straight, t));
        Rssr::new(
            pose(straight, [0.0, 0.0, 0.5]),
            pose(tilted, [1.3, 0.2, 0.0]),
            links,
        )
        .unwrap()
    }

    fn batch(pair: &Pair, inputs: &[f64], rates: BatchRates) -> Vec<Vec<f64>> {
        let mut arrays = vec![vec![0.0; 2 * inputs.len()]; 4];
        let mut slices: Vec<&mut [f64]> = arrays.iter_mut().map(Vec::as_mut_slice).collect();
        pair.outputs(inputs, rates, &mut slices).unwrap();
        arrays
    }

    #[test]
    fn vector_code_agrees_with_taylor_arithmetic() {
        let inputs: Vec<f64> = (0..1000).map(|k| 0.013 * f64::from(k) - 5.0).collect();
        let law: Vec<[f64; 3]> = inputs.iter().map(|x| [1.0 + x, 2.0 - x * x, *x]).collect();
        let column = |k: usize| law.iter().map(|d| d[k]).collect::<Vec<f64>>();
        let (d1, d2, d3) = (column(0), column(1), column(2));
        for input in [Input::Crank, Input::Rocker] {
            let pair = skew().pair(input);
            let arrays = batch(&pair, &inputs, BatchRates::Law([&d1, &d2, &d3]));
            for (n, (&x, d)) in inputs.iter().zip(&law).enumerate() {
                for branch in 0..2 {
                    let driver = Taylor::<4>::from_derivatives(&[x, d[0], d[1], d[2]]);
                    let Some(want) = pair.follower_taylor(driver, branch) else {
                        assert!(arrays[1][branch * inputs.len() + n].is_nan());
                        continue;
                    };
                    for (order, array) in arrays.iter().enumerate() {
                        let (got, want) = (array[branch * inputs.len() + n], want.derivative(order));
                        assert!(
                            (got - want).abs() <= 1e-11 * want.abs().max(1.0),
                            "{x} {order} {got} {want}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn the_least_machine_agrees_with_the_best() {
        let pair = skew().pair(Input::Crank);
        let inputs: Vec<f64> = (0..777)
            .map(|k| 0.01 * f64::from(k) + 1e7 * f64::from(k % 2))
            .collect();
        let best = batch(&pair, &inputs, BatchRates::Constant(2.0));
        let mut arrays = vec![vec![0.0; 2 * inputs.len()]; 4];
        let mut slices: Vec<&mut [f64]> = arrays.iter_mut().map(Vec::as_mut_slice).collect();
        let blocks = Blocks {
            pair: &pair,
            inputs: &inputs,
            rates: BatchRates::Constant(2.0),
            outputs: &mut slices,
        };
        Ordered::<3>(blocks).run::<false>();
        for (a, b) in arrays.iter().flatten().zip(best.iter().flatten()) {
            let close = (a - b).abs() <= 1e-9 * b.abs().max(1.0);
            assert!(close || (a.is_nan() && b.is_nan()), "{a} {b}");
        }
    }

    #[test]
    fn what_is_not_finite_is_named() {
        let pair = skew().pair(Input::Crank);
        let mut out = vec![0.0; 6];
        let error = pair.outputs(&[0.0, 1.0, f64::NAN], BatchRates::Constant(1.0), &mut [&mut out]);
        assert!(matches!(
            error,
            Err(Error::NotFinite { what: "input", index: 2, .. })
        ));
    }
}
