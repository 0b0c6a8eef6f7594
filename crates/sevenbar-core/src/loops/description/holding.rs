//! A loop with a joint of its chain held: the links on both sides of it become one.

use super::described_loop::{Column, Loop};
use super::reduce::{Carrier, Reduced, Source};
use crate::loops::equation::chain::{Chain, Configuration};
use crate::loops::equation::closed::Joint;
use crate::loops::equation::dense::COLUMNS;
use crate::loops::mobility::at_rest::Still;
use crate::rigid::Pose;
use std::borrow::Cow;

/// The same with a joint of the chain held; `None` for a ball, for a turn that a ball with an idle spin is made of, and where links
/// spin together.
pub(crate) fn holding(linkage: &Loop, still: Still) -> Option<Loop> {
    let old = &linkage.reduced;
    let chain = old.chain.as_ref()?;
    let part_of = |joint: usize| {
        let mut parts = old.parts.iter();
        parts.any(|part| matches!(part.source, Source::Joint(j) if j == joint))
    };
    let single = !matches!(chain.joints.get(still.joint)?, Joint::Ball(_));
    if !(single && part_of(still.joint) && old.spun.is_none() && chain.joints.len() > 1) {
        return None;
    }
    let mut at = Configuration::zero();
    at.values[chain.first[still.joint]] = still.value;
    // from the frame before the joint to that before the next
    let motion = chain.motion_of(still.joint, &at);
    let through = motion.then(&chain.links[still.joint]);
    let number = |joint: usize| joint - usize::from(joint > still.joint);
    let mut parts = old.parts.clone();
    for part in &mut parts {
        part.source = match part.source {
            Source::Joint(joint) if joint == still.joint => Source::Held(still.value),
            Source::Joint(joint) => Source::Joint(number(joint)),
            Source::Universal(joint, frame) => Source::Universal(number(joint), frame),
            other => other,
        };
        part.link = match part.link {
            Carrier::Joint(joint, pose) if joint == still.joint => {
                let way = motion.then(&pose);
                match joint.checked_sub(1) {
                    Some(before) => Carrier::Joint(before, chain.links[before].then(&way)),
                    None => Carrier::Ground(old.base.then(&way)),
                }
            }
            Carrier::Joint(joint, pose) => Carrier::Joint(number(joint), pose),
            other => other,
        };
    }
    let base = if still.joint == 0 {
        old.base.then(&through)
    } else {
        old.base
    };
    Some(Loop {
        reduced: Reduced {
            parts,
            idle: old.idle.clone(),
            chain: Some(shortened(chain, still.joint, &through)),
            freedoms: old.freedoms - 1,
            base,
            spun: None,
        },
        ..linkage.clone()
    })
}

/// The column of a held joint, as an output that rests: past all that move, where nothing does.
pub(crate) fn column_at_rest(linkage: &Loop, outer: usize) -> Option<Column> {
    let chain = linkage.reduced.chain.as_ref()?;
    let held = matches!(
        linkage.reduced.parts[linkage.joint_of(outer)].source,
        Source::Held(_)
    );
    (held && chain.columns < COLUMNS).then_some(Column { outer, inner: COLUMNS - 1 })
}

/// The loop in which rows were followed: with a joint held, if they say so.
pub(crate) fn followed(linkage: &Loop, still: Option<Still>) -> Cow<'_, Loop> {
    still
        .and_then(|still| holding(linkage, still))
        .map_or(Cow::Borrowed(linkage), Cow::Owned)
}

/// The chain without a joint, which is replaced by a fixed way from the frame before it to that before the next.
fn shortened(chain: &Chain, joint: usize, through: &Pose) -> Chain {
    let (mut joints, mut links) = (chain.joints.clone(), chain.links.clone());
    joints.remove(joint);
    links.remove(joint);
    let before = joint.checked_sub(1).unwrap_or(joints.len() - 1);
    links[before] = links[before].then(through);
    let mut out = Chain::new(joints, links);
    out.agree = chain.agree;
    out.halves = chain.halves.clone();
    for half in &mut out.halves {
        half.joint -= usize::from(half.joint > joint);
    }
    out
}

/// A configuration of a chain without one of its joints.
pub(crate) fn without(chain: &Chain, joint: usize, at: &Configuration) -> Configuration {
    let column = chain.first[joint];
    let mut out = *at;
    out.values.copy_within(column + 1.., column);
    out.values[COLUMNS - 1] = 0.0;
    out
}
