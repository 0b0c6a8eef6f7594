//! Where curves of an overconstrained loop meet curves on which added joints move.
//!
//! An overconstrained loop has fewer than six passive freedoms, so joints about general axes are added for the count. With them the
//! loop closes in more ways, in which the added joints move. Where such a curve crosses one of the loop's own, the determinant of the
//! screws is zero although the input does not turn back: a zero that the count includes and that belongs to no dead centre. Signs
//! distinguish the two: along a real curve, determinant and rate of the input change sign together at a dead centre, and the
//! determinant alone at such a crossing.
//!
//! Source: docs/theory_many.md, (12).

use super::curve::{self, Curve};
use super::turnings::ROUNDED;
use crate::loops::branch_points::survey::Survey;
use crate::loops::equation::chain::{Chain, Configuration};
use crate::loops::equation::closure::Solution;
use crate::loops::modes::circle::{InputClosure, side_by_side};
use crate::loops::modes::continuation::Homotopy;
use crate::loops::modes::finder::Unknown;
use crate::vectors::{LANES, LaneKernel, Vector, dispatch};
use num_complex::Complex64;

/// A rate of the input below this, at a node in a dead centre, has the sign of a rounding, as the determinant has.
const AT_REST: f64 = 1e-6;

/// Halvings of a step, down to rounding.
const HALVINGS: usize = 50;

/// The determinant of the passive screws at real solutions.
struct Determinants<'a> {
    closure: &'a InputClosure<'a>,
    at: &'a [(Solution, Complex64)],
    out: &'a mut Vec<f64>,
}

impl LaneKernel for Determinants<'_> {
    #[inline(always)]
    fn run<V: Vector>(self) {
        for block in self.at.chunks(LANES) {
            let (x, input) = side_by_side::<V>(block);
            let (.., determinant) = self.closure.linearise::<V, true>(&x, input).solve();
            self.out.extend_from_slice(&determinant.re.store()[..block.len()]);
        }
    }
}

/// The inputs at which a curve meets those on which added joints move [rad]; none if no joints were added, or balls turn.
pub(super) fn meetings(survey: &Survey, chain: &Chain, curve: &Curve) -> Vec<f64> {
    let unknowns = &survey.finder.unknowns;
    let added = unknowns.iter().any(|u| matches!(u, Unknown::Added));
    if !added || unknowns.iter().any(|u| matches!(u, Unknown::BallTurn(..))) {
        return Vec::new();
    }
    let column = survey.finder.input;
    let closure = survey.algebraic.closure(None);
    let determinants = |places: &[Configuration]| {
        let at: Vec<(Solution, Complex64)> = places
            .iter()
            .map(|at| {
                (
                    solution(survey, at),
                    closure.zero() * Complex64::cis(at.values[column]),
                )
            })
            .collect();
        let mut out = Vec::with_capacity(at.len());
        dispatch(Determinants { closure: &closure, at: &at, out: &mut out });
        out
    };
    let nodes = &curve.nodes;
    let places: Vec<Configuration> = nodes.iter().map(|n| n.at).collect();
    // the product has no sign change at a dead centre
    let signs: Vec<Option<f64>> = determinants(&places)
        .iter()
        .zip(nodes)
        .map(|(d, n)| {
            let rate = n.rates[0][column];
            (rate.abs() > AT_REST.max(ROUNDED * n.inverse_norm.powi(2))).then(|| d.signum() * rate.signum())
        })
        .collect();
    // a node in a dead centre has the sign of the one before, the first of a closed curve that of the last
    let mut sure = signs.iter().flatten();
    let (first, last) = (sure.next().copied(), sure.next_back().copied());
    let mut sign = if curve.is_closed() { last.or(first) } else { first }.unwrap_or(0.0);
    let signs: Vec<f64> = signs
        .into_iter()
        .map(|sure| {
            sign = sure.unwrap_or(sign);
            sign
        })
        .collect();
    let mut found = Vec::new();
    for (k, node) in nodes.iter().enumerate().take(nodes.len() - 1) {
        if signs[k] * signs[k + 1] >= 0.0 || node.is_crossing() || nodes[k + 1].is_crossing() {
            continue;
        }
        let (mut low, mut high) = (0.0, node.step);
        let mut at = node.at.values[column];
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            let Some(here) = curve::ahead(chain, node, middle) else {
                break;
            };
            at = here.at.values[column];
            let sign = determinants(&[here.at])[0].signum() * here.rates[0][column].signum();
            if sign * signs[k] > 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        found.push(at);
    }
    found
}

/// A configuration in the closure's unknowns, added joints at zero.
fn solution(survey: &Survey, at: &Configuration) -> Solution {
    let zeros = &survey.algebraic.zeros;
    std::array::from_fn(|i| match survey.finder.unknowns[i] {
        Unknown::Column(c) if survey.finder.slides[i] => at.values[c].into(),
        Unknown::Column(c) => zeros[i] * Complex64::cis(at.values[c]),
        _ => zeros[i],
    })
}
