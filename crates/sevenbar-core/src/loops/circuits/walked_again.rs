//! Curves walked again: farther towards a place that they near slowly, or the other way.

use super::curve::{Curve, End, Node, measure, passes_through};
use super::follow::{self, MOST_NARROWING, MOST_NARROWING_NEAR, Start, Stop, Until};
use crate::loops::equation::closed::Closed;
use crate::loops::equation::dense::Array;

/// Where that place was not found, a curve is followed by so many times as many steps, up to the second number.
const MORE_NARROWING: usize = 4;
const MOST_NARROWING_AT_ALL: usize = 16_000;

/// Whether the place was found, and where walks end by now.
type Searched<S> = (bool, Vec<Stop<S>>);

/// Follows a curve again that nears a place so slowly that it was left, farther each time, until `search` finds that place or it ends;
/// `patience` is how many more may be followed so in vain.
pub(super) fn follow_on<S: Closed>(
    chain: &S,
    start: Start<S>,
    curve: &mut Curve<S>,
    patience: &mut usize,
    search: &mut dyn FnMut(&Curve<S>) -> Searched<S>,
) -> bool {
    let mut most = MOST_NARROWING;
    loop {
        let (found, stops) = search(curve);
        if found || !curve.ends_by(End::Narrow) || *patience == 0 {
            return found;
        }
        // one that ends next to a known place would end there on another walk, too
        if most >= MOST_NARROWING_AT_ALL || curve.nodes.len() > MOST_NARROWING_NEAR {
            *patience -= 1;
            return found;
        }
        most *= MORE_NARROWING;
        *curve = follow::follow_until(chain, &[start], &stops, Until::Narrow(most)).swap_remove(0);
    }
}

/// The curve walked the other way: its own nodes where each step is certain that way too.
pub(crate) fn turned_round<S: Closed>(chain: &S, curve: &Curve<S>, stops: &[Stop<S>]) -> Curve<S> {
    reversed(chain, curve).unwrap_or_else(|| {
        let (mut back, _) = follow::walk_until(chain, &[follow::back_from_end(curve)], stops, Until::End);
        let back = back.swap_remove(0);
        follow::begun_for(curve.why[1], back)
    })
}

/// The same nodes in the other direction, if the argument holds for each step that way too.
pub(crate) fn reversed<S: Closed>(chain: &S, curve: &Curve<S>) -> Option<Curve<S>> {
    let (first, last) = (&curve.nodes[0], curve.nodes.last()?);
    let mut nodes: Vec<Node<S>> = curve.nodes.iter().rev().copied().collect();
    for node in &mut nodes {
        for order in [0, 2] {
            node.rates[order] = node.rates[order].map(|x| -x);
        }
        if curve.is_closed() {
            for c in 0..S::COLUMNS {
                node.at.values[c] -= last.at.values[c] - first.at.values[c];
            }
        }
    }
    measure(chain, &mut nodes);
    let certain = |pair: &[Node<S>]| passes_through(chain, &pair[0], &pair[1].at).is_some();
    nodes
        .windows(2)
        .all(certain)
        .then_some(Curve { nodes, why: [curve.why[1], curve.why[0]] })
}
