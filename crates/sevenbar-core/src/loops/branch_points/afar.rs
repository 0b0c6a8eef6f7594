//! Where slides run to infinity at a real input: the loop seen from so far away that its links have no length.
//!
//! On the way there the slides keep their ratios and the turns come to rest. Divided by the length of one slide the closure loses
//! its links' lengths: what is left is a loop whose axes all meet in one point, with that slide's length given and the input
//! unknown. Its solutions are all such places, and one over the slide is a coordinate of the curve through each.
//!
//! Source: docs/theory_many.md, (19) and (20).

use super::locating::{linearised, solve};
use super::other_input::solutions_with;
use crate::loops::equation::chain::Chain;
use crate::loops::equation::closure::UNKNOWNS;
use crate::loops::modes::finder::{Algebraic, ModeFinder};
use crate::random::Random;
use crate::rigid::Pose;
use num_complex::Complex64;

/// `ln |e^(i tau)|` below which an input is real: roots that stand alone are known to rounding.
const REAL_INPUT: f64 = 1e-9;

/// A slide or a rate below this part of the others is zero up to rounding.
const NOTHING: f64 = 1e-7;

/// Solutions that run to infinity together at a real input.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Afar {
    /// The input there [rad].
    pub input: f64,
    /// Order of the zero that the product of the determinants has there.
    pub order: i64,
    /// How many slides are infinite.
    pub slides: i64,
}

/// Where slides are infinite at real inputs; empty if such places do not stand alone. The chain is the finder's with the input first
/// (`turned_out`).
pub(super) fn afar(finder: &ModeFinder, algebraic: &Algebraic, chain: &Chain) -> Vec<Afar> {
    let slides: Vec<usize> = (0..UNKNOWNS).filter(|&i| finder.slides[i]).collect();
    // one slide alone would have to be matched by finite lengths
    if slides.len() < 2 {
        return Vec::new();
    }
    let links = chain.links.iter().map(|l| Pose::turning(l.rotation));
    let chain_afar = Chain::new(chain.joints.clone(), links.collect());
    let closure = algebraic.closure(None);
    let closure_afar = closure.without_lengths();
    let mut random = Random(0xfa2);
    let mut places = Vec::new();
    for (n, &slide) in slides.iter().enumerate() {
        // all slides by one factor are the same place
        let length = random.phase();
        for (x, input) in solutions_with(&chain_afar, finder, &algebraic.zeros, (slide, length)) {
            let infinite = |i: usize| x[i].norm() > NOTHING * length.norm();
            if input.norm().ln().abs() > REAL_INPUT || slides[..n].iter().any(|&i| infinite(i)) {
                continue;
            }
            // the closure's error with no slide at all is that of the links' lengths
            let mut without_slides = x;
            slides.iter().for_each(|&i| without_slides[i] = Complex64::ZERO);
            let turned = closure.zero() * input;
            let (Some(local), Some(offset)) = (
                linearised(&closure_afar, &[(x, turned)]).pop(),
                linearised(&closure, &[(without_slides, turned)]).pop(),
            ) else {
                continue;
            };
            // rates with one over the slide, the input's in the slide's place
            let mut a: [[Complex64; 6]; 6] = std::array::from_fn(|r| {
                std::array::from_fn(|c| {
                    if c == slide {
                        local.input[r]
                    } else {
                        local.columns[c][r]
                    }
                })
            });
            let mut rates = offset.error.map(|e| -e * length);
            if solve(&mut a, &mut rates).is_none() {
                return Vec::new();
            }
            let greatest = rates.iter().fold(0.0, |m: f64, r| m.max(r.norm()));
            // b of (20): where the input stands still at first, two solutions meet there
            let meeting = if rates[slide].norm() > NOTHING * greatest {
                1
            } else {
                2
            };
            places.push(Afar {
                input: input.arg(),
                // (20), with all slides of the loop for k
                order: slides.len() as i64 + meeting - 3,
                slides: slides.iter().filter(|&&i| infinite(i)).count() as i64,
            });
        }
    }
    places
}
