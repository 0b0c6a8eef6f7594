//! The account of a net's branch points set against the curves that are known.
//!
//! Source: docs/theory_nets.md, (24) to (29).

use super::branch_ranges::{Counted, Inputs};
use super::dyad_branch_points::{BranchPoints, Zero};
use super::modes::Part;
use super::net::Net;
use super::piece_branch_points;
use super::sized::SizedNet;
use crate::loops::circuits::known_curves::Curves;
use crate::loops::circuits::turnings::turnings;
use crate::loops::equation::closed::{At, Closed};
use crate::loops::{Count, Open};

/// A circuit that is not followed reaches this far [rad] about an input at which it was seen, or farther.
const NEAR_BY: f64 = 1e-5;

/// A range that is narrower [rad] is settled by a change point in it.
const NARROW: f64 = 3.0 * NEAR_BY;

/// An input at the end of a range, and its modes that lay on no curve then known.
pub(super) struct AtEnd<S: Closed> {
    /// The input [rad].
    pub input: f64,
    /// The modes.
    pub unknown: Vec<At<S>>,
    /// Whether there may be others, as they were searched for.
    pub searched: bool,
}

/// The branch points of a net.
pub(super) struct Account<'a> {
    counted: Counted,
    dyads: Option<BranchPoints<'a>>,
}

impl<'a> Account<'a> {
    /// Of a net and its parts, over an input; `None` where they are not counted.
    pub fn of<const C: usize, const R: usize, const B: usize>(
        sized: &'a SizedNet<C, R, B>,
        net: &Net,
        parts: &[Part],
        input: usize,
    ) -> Option<Self> {
        let in_space = parts
            .iter()
            .any(|part| matches!(part, Part::Body(_) | Part::Loop(_)));
        let inputs = if sized.is_turn(input) {
            Inputs::Turn
        } else {
            Inputs::Slide(sized.reach_of_slide(input, if in_space { 3 } else { 2 })?)
        };
        let dyads = sized.dyads().map(BranchPoints::of);
        let counted = match &dyads {
            Some(dyads) => Counted::of(dyads, inputs),
            None => piece_branch_points::counted(net, parts, input, inputs)?,
        };
        Some(Self { counted, dyads })
    }

    /// Inputs [rad, or relative to the size] between which there is at most one branch point, outside of the ranges that are open.
    pub fn ends(&self) -> impl Iterator<Item = f64> {
        self.counted.ends.iter().copied()
    }

    /// The count, with what is known where curves turn back or meet; all modes at ends of ranges should lie on them.
    pub fn against<const C: usize, const R: usize, const B: usize>(
        &self,
        net: &SizedNet<C, R, B>,
        curves: &Curves<SizedNet<C, R, B>>,
        at_ends: &[AtEnd<SizedNet<C, R, B>>],
        input: usize,
    ) -> Count {
        let points = curves.change_points.iter().map(|p| net.values(&p.at)[input]);
        let points: Vec<f64> = points.collect();
        let turnings = curves.curves.iter().flat_map(|curve| turnings(curve, net, input));
        let turnings: Vec<(f64, Option<Zero>)> = turnings
            .filter(|turning| !turning.node.is_crossing())
            .map(|turning| {
                let values = net.values(&turning.node.at);
                let zero = self.dyads.as_ref().map(|dyads| dyads.zero_at(values));
                (values[input], zero)
            })
            .collect();
        // curves meet there
        let meet_in = |open: &Open| open.to - open.from < NARROW && points.iter().any(|at| open.has(*at));
        let mut real = self.counted.real;
        let mut open: Vec<Open> = Vec::new();
        for range in &self.counted.open {
            let within = turnings.iter().filter(|(at, _)| range.has(*at));
            let zeros = distinct(within.map(|(_, zero)| *zero));
            if range.missing == Some(zeros as i64) {
                real += zeros;
            } else if !meet_in(range) {
                open.push(*range);
            }
        }
        // the smallest circuits are not followed
        for end in at_ends {
            let lost = curves.unknown(net, &end.unknown).len();
            let missing = Some(lost as i64).filter(|_| !end.searched);
            let around = Open { from: end.input - NEAR_BY, to: end.input + NEAR_BY, missing };
            if missing != Some(0) && !meet_in(&around) {
                open.push(around);
            }
        }
        Count {
            column: input,
            dead_centres: real,
            complex_branch_points: self.counted.complex,
            poles: self.counted.poles,
            circles: 1,
            open,
        }
    }
}

/// How many of the zeros at which curves turn back are different: with each way of the dyads after it one turns back, of a block each at its own.
fn distinct(zeros: impl Iterator<Item = Option<Zero>>) -> usize {
    let mut known: Vec<Option<Zero>> = Vec::new();
    for zero in zeros {
        if zero.is_none() || !known.contains(&zero) {
            known.push(zero);
        }
    }
    known.len()
}
