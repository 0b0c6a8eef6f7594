//! Motions along which a constraint is met twice over, or nearly so: the loop's with a joint held that rests along them.
//!
//! Source: docs/theory.md, (20).

use crate::loops::circuits::known_curves::Curves;
use crate::loops::circuits::on_curve::lies_on_any;
use crate::loops::circuits::search::curves;
use crate::loops::description::described_loop::Loop;
use crate::loops::description::holding::{holding, without};
use crate::loops::equation::chain::{Chain, Configuration};
use crate::loops::mobility::at_rest::{Still, joints_at_rest};
use crate::loops::modes::many_starts::ALL_FREE;

/// Poses from which no motion could be followed and on which no joint was found that rests, after which no others are tried:
/// each takes as long as a search for a change point.
const MOST_IN_VAIN: usize = 64;

/// A loop with a joint held, and its curves.
pub(super) struct Held {
    pub still: Still,
    pub linkage: Loop,
    pub curves: Curves,
}

/// The loop with a joint held that rests along a motion through a pose, and that motion; `None` where there is none. Of several such joints
/// the one that leaves most to be followed: one that rests along this motion alone would keep others that it meets away.
pub(super) fn held_at(linkage: &Loop, pose: &Configuration) -> Option<Held> {
    let chain = linkage.reduced.chain.as_ref()?;
    let (at, joints) = joints_at_rest(chain, pose);
    let mut most: Option<Held> = None;
    for still in joints {
        let Some(held) = holding(linkage, still) else {
            continue;
        };
        let Some(own) = &held.reduced.chain else {
            continue;
        };
        let mut curves = Curves::new(&[0]);
        curves.take(own, &[without(chain, still.joint, &at)], 0);
        curves.finish(own);
        if curves.curves.len() > most.as_ref().map_or(0, |m| m.curves.curves.len()) {
            most = Some(Held { still, linkage: held, curves });
        }
    }
    most
}

/// The motions through poses from which none could be followed.
#[derive(Default)]
pub(super) struct HeldMotions {
    /// One for each joint that rests, and where; with all its curves, or the first.
    pub motions: Vec<Held>,
    /// How many of the poses are on one of them.
    pub explained: usize,
}

impl HeldMotions {
    pub fn through(linkage: &Loop, poses: &[Configuration], wished: &[usize], first_only: bool) -> Self {
        let mut found = Self::default();
        let mut in_vain = 0;
        for pose in poses {
            if in_vain == MOST_IN_VAIN {
                break;
            }
            if found.explain(linkage, pose, wished, first_only) {
                found.explained += 1;
            } else {
                in_vain += 1;
            }
        }
        found
    }

    /// Adds those through poses that a search finds: solutions meet there at every input, and the paths to some are lost.
    pub fn search(&mut self, linkage: &Loop, wished: &[usize]) {
        let Some(chain) = &linkage.reduced.chain else {
            return;
        };
        for pose in ALL_FREE.poses(chain, 0, None) {
            self.explain(linkage, &pose, wished, false);
        }
    }

    /// Whether a pose lies on one of the motions, or on a new one.
    fn explain(&mut self, linkage: &Loop, pose: &Configuration, wished: &[usize], first_only: bool) -> bool {
        let Some(chain) = &linkage.reduced.chain else {
            return false;
        };
        let (at, joints) = joints_at_rest(chain, pose);
        if self
            .motions
            .iter()
            .any(|held| held.leads_over(chain, &at, &joints))
        {
            return true;
        }
        let known = |still: &Still| self.motions.iter().any(|held| held.still.is_same(still));
        let Some(mut held) = held_at(linkage, pose).filter(|held| !known(&held.still)) else {
            return false;
        };
        if let Some(own) = &held.linkage.reduced.chain {
            let mut inner: Vec<usize> = wished
                .iter()
                .filter_map(|&c| held.linkage.chain_column(c))
                .collect();
            if inner.is_empty() {
                inner.push(0);
            }
            held.curves = curves(own, &inner, first_only);
        }
        let moves = !held.curves.curves.is_empty();
        if moves {
            self.motions.push(held);
        }
        moves
    }
}

impl Held {
    /// Whether a pose lies on one of its curves, where one of these joints may rest.
    fn leads_over(&self, chain: &Chain, at: &Configuration, joints: &[Still]) -> bool {
        let own = self.linkage.reduced.chain.as_ref();
        let pose = without(chain, self.still.joint, at);
        joints.iter().any(|still| still.is_same(&self.still))
            && own.is_some_and(|own| lies_on_any(own, &self.curves.curves, &pose))
    }
}
