//! The curves of a net through its modes at many values of the input.
//!
//! Modes are taken at values of a grid, and at the ends of ranges with at most one branch point where these are counted.
//!
//! Source: docs/theory_nets.md, (8).

use super::account::{Account, AtEnd};
use super::described::DescribedNet;
use super::modes::{Part, modes};
use super::search::{STARTS_OF_MANY, searched};
use super::sized::SizedNet;
use crate::loops::circuits::known_curves::Curves;
use crate::loops::equation::closed::{At, Closed};
use crate::loops::modes::finder::Completeness;
use std::f64::consts::TAU;

/// Values of the input in a turn at which modes are sought.
const SEEDS: usize = 24;

/// Values of a slide at which they are, and how far apart [share of the size].
const SLIDE_SEEDS: i32 = 24;
const SLIDE_SEED: f64 = 0.02;

/// All curves that are known over the input, the first of two columns; the net's modes are those of its `parts` where these are given.
pub(super) fn whole_curves<const C: usize, const R: usize, const B: usize>(
    described: &DescribedNet,
    net: &SizedNet<C, R, B>,
    parts: Option<&[Part]>,
    ends: [usize; 2],
) -> Curves<SizedNet<C, R, B>> {
    let input = ends[0];
    let turns = net.is_turn(input);
    let drawn = described.net.drawn();
    let values: Vec<f64> = if turns {
        (0..SEEDS).map(|k| TAU * k as f64 / SEEDS as f64).collect()
    } else {
        (-SLIDE_SEEDS..=SLIDE_SEEDS)
            .map(|k| drawn[input] + f64::from(k) * SLIDE_SEED)
            .collect()
    };
    let mut curves = Curves::new(&ends);
    let account = parts.and_then(|parts| Account::of(net, &described.net, parts, input));
    // modes at some values of a slide say nothing of those beyond
    if parts.is_none() || !(turns || account.is_some()) {
        curves.search.completeness = Completeness::Searched;
    }
    curves.search.columns = vec![input];
    curves.take(net, &[net.at(&drawn)], input);
    let seeds = values.len();
    let ends = account.iter().flat_map(|account| account.ends());
    let values: Vec<f64> = values.into_iter().chain(ends).collect();
    curves.search.values = values.len();
    let mut at_ends: Vec<AtEnd<SizedNet<C, R, B>>> = Vec::new();
    let mut all: Vec<At<SizedNet<C, R, B>>> = Vec::new();
    for (k, &input_value) in values.iter().enumerate() {
        let found = parts.and_then(|parts| modes(&described.net, parts, input, input_value));
        let isolated = found
            .iter()
            .flat_map(|found| &found.modes)
            .filter(|mode| !mode.on_curve);
        let mut modes: Vec<At<SizedNet<C, R, B>>> = isolated.map(|mode| net.at(&mode.values)).collect();
        let word = found.map_or(Some(Completeness::Searched), |found| found.completeness);
        let searches = word == Some(Completeness::Searched);
        if searches {
            modes.extend(searched(net, input, input_value, STARTS_OF_MANY));
        }
        all.extend(&modes);
        let unknown = curves.unknown(net, &modes);
        curves.take(net, &unknown, input);
        if k < seeds {
            curves.search.completeness = curves.search.completeness.or_less(word);
        } else {
            at_ends.push(AtEnd { input: input_value, unknown, searched: searches });
        }
    }
    curves.finish(net);
    if forget_open(described, net, &mut curves) && !curves.unknown(net, &all).is_empty() {
        curves.search.completeness = Completeness::Searched;
    }
    if let Some(account) = account {
        curves.search.count = Ok(account.against(net, &curves, &at_ends, input));
    }
    curves
}

/// Forgets curves along which rows that were left out, as they repeat others, do not agree: those of a net without these rows. Whether there
/// were any.
fn forget_open<const C: usize, const R: usize, const B: usize>(
    described: &DescribedNet,
    net: &SizedNet<C, R, B>,
    curves: &mut Curves<SizedNet<C, R, B>>,
) -> bool {
    let closes = |at: &At<SizedNet<C, R, B>>| described.closes(net.values(at), net.balls(at));
    let before = curves.curves.len();
    curves.curves.retain(|c| c.nodes.iter().all(|n| closes(&n.at)));
    let forgets = curves.curves.len() < before;
    if forgets {
        let own = &curves.curves;
        curves
            .change_points
            .retain(|p| own.iter().any(|c| p.is_on(net, c)));
    }
    forgets
}
