//! Curves walked again: farther towards a place that they near slowly, or the other way.

use super::curve::{Curve, End, Node, measure, passes_through};
use super::follow::{self, MOST_NARROWING, MOST_NARROWING_NEAR, Start, Stop, Until};
use crate::loops::equation::chain::Chain;
use crate::loops::equation::dense::COLUMNS;

/// Where that place was not found, a curve is followed by so many times as many steps, up to the second number.
const MORE_NARROWING: usize = 4;
const MOST_NARROWING_AT_ALL: usize = 16_000;

/// Follows a curve again that nears a place so slowly that it was left, farther each time, until `search` finds that place or it ends;
/// `patience` is how many more may be followed so in vain.
pub(super) fn follow_on(
    chain: &Chain,
    start: Start,
    curve: &mut Curve,
    patience: &mut usize,
    search: &mut dyn FnMut(&Curve) -> (bool, Vec<Stop>),
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
pub(crate) fn turned_round(chain: &Chain, curve: &Curve, stops: &[Stop]) -> Curve {
    reversed(chain, curve).unwrap_or_else(|| {
        let (mut back, _) = follow::walk_until(chain, &[follow::back_from_end(curve)], stops, Until::End);
        let back = back.swap_remove(0);
        follow::begun_for(curve.why[1], back)
    })
}

/// The same nodes in the other direction, if the argument holds for each step that way too.
pub(crate) fn reversed(chain: &Chain, curve: &Curve) -> Option<Curve> {
    let (first, last) = (&curve.nodes[0], curve.nodes.last()?);
    let mut nodes: Vec<Node> = curve.nodes.iter().rev().copied().collect();
    for node in &mut nodes {
        for order in [0, 2] {
            node.rates[order] = node.rates[order].map(|x| -x);
        }
        if curve.is_closed() {
            for c in 0..COLUMNS {
                node.at.values[c] -= last.at.values[c] - first.at.values[c];
            }
        }
    }
    measure(chain, &mut nodes);
    let certain = |pair: &[Node]| passes_through(chain, &pair[0], &pair[1].at).is_some();
    nodes
        .windows(2)
        .all(certain)
        .then_some(Curve { nodes, why: [curve.why[1], curve.why[0]] })
}
