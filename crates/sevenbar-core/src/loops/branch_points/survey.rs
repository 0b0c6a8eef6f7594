//! What is watched along solutions so that their branch points can be counted, and where they run to infinity.
//!
//! Source: docs/theory_many.md, (14) and (17).

use super::afar::{Afar, afar};
use super::locating::still;
use super::other_input::{solutions_with, turned_out};
use crate::loops::equation::closure::{Solution, UNKNOWNS};
use crate::loops::modes::finder::{Algebraic, ModeFinder, Unknown};
use crate::loops::modes::phases::Watch;
use crate::random::Random;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// `ln |e^(i tau)|` below which an input at which another joint moves alone counts as real.
const REAL_INPUT: f64 = 1e-6;

/// Inputs nearer than this [rad] are one.
const SAME_INPUT: f64 = 1e-9;

/// What is watched on the way round, and where the watched joints have their values.
pub(crate) struct Survey<'a> {
    pub finder: &'a ModeFinder<'a>,
    pub algebraic: Algebraic<'a>,
    pub watch: Watch,
    pub infinite: Infinite,
    /// Where slides are infinite at real inputs.
    pub afar: Vec<Afar>,
    /// Of how many solutions each pose has one: those with a ball's turns, or an idle coupler, turned over.
    pub flips: i64,
    /// Whether other joints may move with the input at rest.
    pub still: bool,
}

/// What tells of solutions that run to infinity.
pub(crate) enum Infinite {
    /// `e^(i tau)` where they do, one at infinity being one at zero in the mirror of the real inputs.
    At(Vec<Complex64>),
    /// `e^(i tau)` of the solutions at which each joint has its watched value.
    Watched([Vec<Complex64>; UNKNOWNS]),
}

impl<'a> Survey<'a> {
    /// For an input that turns; `None` where its modes are not algebraic.
    pub fn new(finder: &'a ModeFinder<'a>) -> Option<Self> {
        let algebraic = finder.algebraic()?;
        // the middle of links that spin together moves with the joints among them
        if finder.chain.halves.iter().any(|h| h.line.is_some()) {
            return None;
        }
        let zeros = algebraic.zeros;
        let mut watch = Watch { values: [None; UNKNOWNS], middles: Vec::new() };
        for (i, unknown) in finder.unknowns.iter().enumerate() {
            match *unknown {
                Unknown::BallTurn(_, 1) => watch.middles.push((i, zeros[i])),
                Unknown::Column(c) => {
                    let half = finder
                        .chain
                        .halves
                        .iter()
                        .find(|h| finder.chain.first[h.joint] == c);
                    let middle = half.map(|h| (i, zeros[i] * Complex64::from_polar(1.0, h.middle)));
                    watch.middles.extend(middle);
                }
                _ => {}
            }
        }
        let flips = 1 << watch.middles.len();
        // the columns of a general loop of seven turning joints
        let general = watch.middles.is_empty()
            && !finder.slides.contains(&true)
            && finder.unknowns.iter().all(|u| matches!(u, Unknown::Column(_)))
            && algebraic.is_general();
        let known = if general { algebraic.poles() } else { None };
        if let Some(at) = known {
            // solutions infinite at a real input may be those of a motion with the input at rest
            let still = at.iter().any(|x| x.norm().ln().abs() < REAL_INPUT);
            let infinite = Infinite::At(at);
            return Some(Self { finder, algebraic, watch, infinite, afar: Vec::new(), flips, still });
        }
        let untold = algebraic.untold_three();
        Some(Self::watching(finder, algebraic, watch, untold))
    }

    /// With the passive joints watched, as special geometry asks for: all but three in a row that tell nothing by themselves, if there
    /// are such, by the first of them.
    pub fn watching(
        finder: &'a ModeFinder<'a>,
        algebraic: Algebraic<'a>,
        mut watch: Watch,
        untold: Option<usize>,
    ) -> Self {
        let zeros = algebraic.zeros;
        let mut random = Random(0xb0b);
        let mut met: [Vec<Complex64>; UNKNOWNS] = Default::default();
        let mut rests = false;
        let chain = turned_out(finder);
        let closure = algebraic.closure(None);
        for i in 0..UNKNOWNS {
            let aside = untold.is_some_and(|first| (first..first + 3).contains(&i));
            if aside || matches!(finder.unknowns[i], Unknown::Added) {
                continue;
            }
            let value = Complex64::from_polar(0.45 + 0.35 * random.uniform(), TAU * random.uniform());
            let solutions = solutions_with(&chain, finder, &zeros, (i, value));
            let at: Vec<(Solution, Complex64)> = solutions
                .iter()
                .map(|(x, input)| (*x, closure.zero() * input))
                .collect();
            for ((_, input), alone) in solutions.iter().zip(still(&closure, &at)) {
                if alone {
                    rests |= input.norm().ln().abs() < REAL_INPUT;
                } else {
                    met[i].push(*input);
                }
            }
            let zero = if finder.slides[i] {
                Complex64::ONE
            } else {
                zeros[i]
            };
            watch.values[i] = Some(value * zero);
        }
        let flips = 1 << watch.middles.len();
        let afar = afar(finder, &algebraic, &chain);
        Self {
            finder,
            algebraic,
            watch,
            infinite: Infinite::Watched(met),
            afar,
            flips,
            still: rests,
        }
    }

    /// A value in each range between neighbouring inputs at which slides are infinite that has none of `2 pi k / count`: a curve
    /// through which the input only rises ends at such inputs, and leads over all between.
    pub fn unseeded(&self, count: usize) -> Vec<f64> {
        let spacing = TAU / count as f64;
        let mut ends: Vec<f64> = self.afar.iter().map(|a| a.input.rem_euclid(TAU)).collect();
        ends.sort_by(f64::total_cmp);
        ends.extend(ends.first().map(|e| e + TAU));
        let pairs = ends.windows(2).filter(|w| w[1] - w[0] > SAME_INPUT);
        let within_one = pairs.filter(|w| (w[0] / spacing).floor() == (w[1] / spacing).floor());
        within_one.map(|w| 0.5 * (w[0] + w[1])).collect()
    }
}
