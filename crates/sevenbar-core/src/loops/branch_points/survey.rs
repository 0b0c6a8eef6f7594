//! What the count of branch points needs to know of a closure: the joints to watch, and where solutions run to infinity.
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

/// An input at which the loop moves with the input at rest counts as real if `|ln |e^(i tau)||` is below this.
const REAL_INPUT: f64 = 1e-6;

/// Inputs closer than this [rad] are the same.
const SAME_INPUT: f64 = 1e-9;

/// Part of the range between two inputs with slides at infinity that is next to each.
const MARGIN: f64 = 0.25;

/// The joints watched on the way round, and the inputs at which they take their watched values.
pub(crate) struct Survey<'a> {
    pub finder: &'a ModeFinder<'a>,
    pub algebraic: Algebraic<'a>,
    pub watch: Watch,
    pub infinite: Infinite,
    /// Real inputs at which slides are at infinity.
    pub afar: Vec<Afar>,
    /// How many solutions of the closure are the same pose: those with a ball's turns, or an idle coupler, flipped over.
    pub flips: i64,
    /// Whether other joints may move with the input at rest.
    pub still: bool,
}

/// How solutions that run to infinity are counted.
pub(crate) enum Infinite {
    /// By the inputs `e^(i tau)` at which they do. One at infinity is the mirror image, at the real inputs, of one at zero.
    At(Vec<Complex64>),
    /// By watched values: the inputs `e^(i tau)` at which each joint takes its value.
    Watched([Vec<Complex64>; UNKNOWNS]),
}

impl<'a> Survey<'a> {
    /// For an input that turns; `None` where its modes are not algebraic.
    pub fn new(finder: &'a ModeFinder<'a>) -> Option<Self> {
        let algebraic = finder.algebraic()?;
        // where two links spin together, the middle of the flipped pair moves with the joint between them
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
        // a general loop of seven turning joints
        let general = watch.middles.is_empty()
            && !finder.slides.contains(&true)
            && finder.unknowns.iter().all(|u| matches!(u, Unknown::Column(_)))
            && algebraic.is_general();
        let known = if general { algebraic.poles() } else { None };
        if let Some(at) = known {
            // a solution at infinity at a real input may belong to a motion with the input at rest
            let still = at.iter().any(|x| x.norm().ln().abs() < REAL_INPUT);
            let infinite = Infinite::At(at);
            return Some(Self { finder, algebraic, watch, infinite, afar: Vec::new(), flips, still });
        }
        let unwatched = algebraic.unwatched_three();
        Some(Self::watching(finder, algebraic, watch, unwatched))
    }

    /// With the passive joints watched, as special geometry needs. Three neighbours need no watch if another joint always goes to infinity
    /// with them; `unwatched` is the first of such three.
    pub fn watching(
        finder: &'a ModeFinder<'a>,
        algebraic: Algebraic<'a>,
        mut watch: Watch,
        unwatched: Option<usize>,
    ) -> Self {
        let zeros = algebraic.zeros;
        let mut random = Random(0xb0b);
        let mut met: [Vec<Complex64>; UNKNOWNS] = Default::default();
        let mut rests = false;
        let chain = turned_out(finder);
        let closure = algebraic.closure(None);
        for i in 0..UNKNOWNS {
            let aside = unwatched.is_some_and(|first| (first..first + 3).contains(&i));
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

    /// The middle of each range between neighbouring inputs with slides at infinity that contains none of the inputs `2 pi k / count`
    /// well within: next to its ends slides are farther out than curves are followed. A curve along which the input only rises ends
    /// at such inputs, so one seed between them finds it.
    pub fn unseeded(&self, count: usize) -> Vec<f64> {
        let spacing = TAU / count as f64;
        let mut ends: Vec<f64> = self.afar.iter().map(|a| a.input.rem_euclid(TAU)).collect();
        ends.sort_by(f64::total_cmp);
        ends.extend(ends.first().map(|e| e + TAU));
        let pairs = ends.windows(2).filter(|w| w[1] - w[0] > SAME_INPUT);
        let unseeded = pairs.filter(|w| {
            let margin = MARGIN * (w[1] - w[0]);
            ((w[0] + margin) / spacing).floor() == ((w[1] - margin) / spacing).floor()
        });
        unseeded.map(|w| 0.5 * (w[0] + w[1])).collect()
    }
}
