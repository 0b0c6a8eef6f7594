//! Whole circuits from many places on them: each piece is followed to the next known place, eight side by side.
//!
//! Where the screws have rank six of seven, their minors give the curve one direction all along. All places are left in that
//! direction, so every piece ends where another begins, and round a closed curve they join.
//!
//! Source: docs/theory_many.md, (9).

use super::curve::{Curve, End};
use super::follow::{self, Start};
use crate::loops::equation::closed::{At, Closed};
use crate::loops::equation::dense::Array;
use crate::loops::equation::free_direction::free_direction;
use crate::loops::modes::many_starts::same;

/// A pivot of the screws below this part of the greatest may be zero: such places are left to the ordinary way.
const LEAST_PIVOT: f64 = 1e-6;

/// The closed curves through some of these closed configurations; those on other curves are left out.
pub(crate) fn closed_curves<S: Closed>(chain: &S, places: &[At<S>]) -> Vec<Curve<S>> {
    if chain.is_redundant() {
        return Vec::new();
    }
    let mut starts: Vec<Start<S>> = Vec::with_capacity(places.len());
    for place in places {
        if let Some(direction) = free_direction::<S>(&chain.place(place).screws, LEAST_PIVOT)
            && starts.iter().all(|s| !same(chain, &s.0, place))
        {
            starts.push((*place, direction));
        }
    }
    let (pieces, next) = follow::pieces(chain, &starts);
    let mut joined = vec![false; pieces.len()];
    let mut curves = Vec::new();
    for first in 0..pieces.len() {
        if joined[first] {
            continue;
        }
        if let Some(round) = round_from(first, &next) {
            for &k in &round {
                joined[k] = true;
            }
            curves.push(one_of(chain, &pieces, &round));
        }
    }
    curves
}

/// One closed curve from pieces that follow each other, turns counted on.
fn one_of<S: Closed>(chain: &S, pieces: &[Curve<S>], round: &[usize]) -> Curve<S> {
    let mut nodes = Vec::with_capacity(1 + round.iter().map(|&k| pieces[k].nodes.len()).sum::<usize>());
    let mut turns: S::Columns<f64> = S::Columns::filled(0.0);
    for (n, &k) in round.iter().enumerate() {
        let next = &pieces[round[(n + 1) % round.len()]].nodes[0];
        let (end, piece) = pieces[k].nodes.split_last().unwrap_or_else(|| unreachable!());
        for node in piece {
            let mut node = *node;
            for c in 0..S::COLUMNS {
                node.at.values[c] += turns[c];
            }
            nodes.push(node);
        }
        for c in (0..S::COLUMNS).filter(|&c| chain.is_turn(c)) {
            turns[c] += end.at.values[c] - next.at.values[c];
        }
    }
    let mut end = nodes[0];
    for c in 0..S::COLUMNS {
        end.at.values[c] += turns[c];
    }
    nodes.push(end);
    Curve { nodes, why: [End::Closed; 2] }
}

/// The pieces from one until it comes again; none if it does not.
fn round_from(first: usize, next: &[Option<usize>]) -> Option<Vec<usize>> {
    let mut round = vec![first];
    loop {
        let to = next[*round.last()?]?;
        if to == first {
            return Some(round);
        }
        if round.contains(&to) {
            return None;
        }
        round.push(to);
    }
}
