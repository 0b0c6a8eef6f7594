//! Whether a pose is a place of a curve that is known.

use super::curve::{self, Curve, Node, REACH};
use crate::loops::equation::closed::{At, Closed};
use crate::stopping;

pub(crate) fn lies_on_any<S: Closed>(chain: &S, curves: &[Curve<S>], mode: &At<S>) -> bool {
    curves.iter().any(|c| lies_on(chain, c, mode))
}

/// Whether a mode is a place of a curve.
pub(crate) fn lies_on<S: Closed>(chain: &S, curve: &Curve<S>, mode: &At<S>) -> bool {
    place_on(chain, curve, mode).is_some()
}

/// Those modes that lie on none of the curves.
pub(super) fn not_on_any<S: Closed>(chain: &S, curves: &[Curve<S>], mut modes: Vec<At<S>>) -> Vec<At<S>> {
    for curve in curves {
        if modes.is_empty() {
            break;
        }
        // in a row, for the nodes are far apart in memory
        let reaches: Vec<f64> = reaches(curve).collect();
        modes.retain(|mode| place_within(chain, curve, reaches.iter().copied(), mode).is_none());
    }
    modes
}

/// The node of a curve from which a step leads over a mode.
pub(super) fn place_on<'a, S: Closed>(chain: &S, curve: &'a Curve<S>, mode: &At<S>) -> Option<&'a Node<S>> {
    place_within(chain, curve, reaches(curve), mode)
}

/// The most by which each step of a curve changes a turn.
fn reaches<S: Closed>(curve: &Curve<S>) -> impl Iterator<Item = f64> {
    curve.nodes.iter().map(|node| REACH * node.step)
}

fn place_within<'a, S: Closed>(
    chain: &S,
    curve: &'a Curve<S>,
    reaches: impl Iterator<Item = f64>,
    mode: &At<S>,
) -> Option<&'a Node<S>> {
    // no nearer to the mode than this, in the turn that is farthest off
    stopping::piece();
    let mut least = 0.0;
    for (k, reach) in reaches.enumerate() {
        if least <= reach {
            let node = &curve.nodes[k];
            least = curve::farthest_turn(chain, &node.at, mode);
            if least <= reach && curve::passes_through(chain, node, mode).is_some() {
                return Some(node);
            }
        }
        // a step changes no turn by more than its reach
        least -= reach;
    }
    None
}
