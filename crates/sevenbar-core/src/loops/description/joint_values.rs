//! Values and rates of the description's joints, from those of the chain that is followed, and back.

use super::described_loop::{Described, Loop};
use super::reduce::{Source, SpunLinks};
use super::spun::first_terms;
use crate::loops::equation::chain::{BALLS, Chain, Configuration};
use crate::loops::equation::closed::Joint;
use crate::loops::equation::dense::COLUMNS;
use crate::loops::equation::kinds::Kind;
use crate::loops::equation::rotations::{Rotation, Z_TO_X, ball_rotation, product, short_way, transposed};
use crate::loops::rates::turns::{joint_series, product_series, universal_series, value_series};
use crate::loops::rates::velocities::{ORDERS, Rates};
use crate::rigid::{Pose, turns_zyx};
use crate::taylor::Taylor;
use std::f64::consts::PI;

/// Joint values of a configuration; angles as they come, a ball's turns NaN where they are undefined.
pub(crate) fn joint_values(linkage: &Loop, at: &Configuration) -> Vec<f64> {
    let still = [[0.0; COLUMNS]; ORDERS];
    joint_rates(linkage, at, &still)
        .iter()
        .enumerate()
        .map(|(c, q)| {
            if linkage.is_slide(c) {
                q[0]
            } else {
                wrapped(linkage, c, q[0])
            }
        })
        .collect()
}

/// The same loop whose joints have these values in the pose of its drawing; without, all are zero there.
pub fn drawn_at(mut linkage: Loop, values: &[f64]) -> Loop {
    let drawn = configuration(&linkage, values);
    if let Some(chain) = &mut linkage.reduced.chain {
        chain.drawn = drawn;
    }
    linkage
}

/// The configuration with these joint values; the idle spin of links is left out.
pub(crate) fn configuration(linkage: &Loop, values: &[f64]) -> Configuration {
    let mut out = Configuration::zero();
    let mut left_out = [Pose::STILL.rotation; BALLS];
    let Some(chain) = &linkage.reduced.chain else {
        return out;
    };
    for (part, &first) in linkage.reduced.parts.iter().zip(&linkage.first) {
        let turns = || ball_rotation(&[values[first], values[first + 1], values[first + 2]]);
        match (part.source, part.kind) {
            (Source::Held(_), _) => {}
            (Source::Joint(joint), Kind::Ball) => {
                if let Joint::Ball(b) = chain.joints[joint] {
                    out.balls[b] = turns();
                }
            }
            (Source::Joint(joint), _) => {
                out.values[chain.first[joint]] = values[first] * linkage.inward(first);
            }
            (Source::Universal(joint, frame), _) => {
                let spun = configure_universal(chain, joint, &frame, &turns(), &mut out);
                // what is left out of the spin goes to the other ball, which is the next joint of the chain
                let next = (joint + 2) % chain.joints.len();
                let way = product(&product(&frame, &Z_TO_X), &chain.links[joint + 1].rotation);
                if let Joint::Ball(b) = chain.joints[next] {
                    left_out[b] = product(&product(&transposed(&way), &spun), &way);
                }
            }
            // both below, for they need the joint between them
            (Source::BeforeSpun(..) | Source::AfterSpun(_), _) => {}
        }
    }
    for (ball, spun) in out.balls.iter_mut().zip(&left_out) {
        *ball = product(spun, ball);
    }
    if let Some(links) = &linkage.reduced.spun {
        configure_spun(linkage, links, values, &mut out);
    }
    out
}

/// The turns of the balls of links that spin together.
fn configure_spun(linkage: &Loop, links: &SpunLinks, values: &[f64], out: &mut Configuration) {
    let Some(chain) = &linkage.reduced.chain else {
        return;
    };
    let turns = |first: usize| ball_rotation(&[values[first], values[first + 1], values[first + 2]]);
    let value = Taylor::<1>::constant(out.values[chain.first[links.joint]]);
    let mut spun = Pose::STILL.rotation;
    for (part, &first) in linkage.reduced.parts.iter().zip(&linkage.first) {
        match part.source {
            Source::BeforeSpun(joint, frame) => {
                let back = transposed(&frame);
                let [own, flat] = links.spun.directions(value.value());
                // the line in the frame of the two turns, z the first axis and x the second, before and after these
                let flat = Pose::turning(back).turn(flat);
                let to = Pose::turning(product(&back, &turns(first))).turn(own);
                let second = to[2].atan2(-to[0].hypot(to[1])) - flat[2].atan2(flat[1]);
                out.values[chain.first[joint]] = to[0].atan2(-to[1]);
                out.values[chain.first[joint + 1]] = short_way(second);
                let still = [[0.0; COLUMNS]; ORDERS];
                let two = universal_series(chain, joint, &frame, out, &still);
                let held = product(&first_terms(&two), &first_terms(&links.spun.lie(value)));
                // what is left out of the spin
                spun = product(&transposed(&held), &turns(first));
            }
            Source::AfterSpun(joint) => {
                if let Joint::Ball(b) = chain.joints[joint] {
                    let before = first_terms(&links.spun.through(value));
                    let own = product(&product(&transposed(&before), &spun), &before);
                    let lie = transposed(&first_terms(&links.spun.lie_beyond(value)));
                    out.balls[b] = product(&lie, &product(&own, &turns(first)));
                }
            }
            _ => {}
        }
    }
}

fn wrapped(linkage: &Loop, column: usize, angle: f64) -> f64 {
    let joint = linkage.joint_of(column);
    if matches!(linkage.reduced.parts[joint].kind, Kind::Screw(_)) {
        angle
    } else {
        short_way(angle)
    }
}

/// Value and three derivatives of each column of the description, lengths in its unit.
fn joint_rates(linkage: &Loop, at: &Configuration, rates: &Rates) -> Vec<[f64; 4]> {
    let mut out = vec![[0.0; 4]; linkage.columns];
    write_joint_rates(linkage, at, rates, &mut out);
    out
}

pub(crate) fn write_joint_rates(linkage: &Loop, at: &Configuration, rates: &Rates, out: &mut [[f64; 4]]) {
    let Some(chain) = &linkage.reduced.chain else {
        return;
    };
    for (part, &first) in linkage.reduced.parts.iter().zip(&linkage.first) {
        match (part.source, part.kind) {
            (Source::Held(value), kind) => {
                let factor = if kind == Kind::Slide { linkage.size } else { 1.0 };
                out[first] = [value * factor, 0.0, 0.0, 0.0];
            }
            (Source::Joint(joint), Kind::Ball) => {
                let series = joint_series(chain, joint, at, rates);
                write_turns(&mut out[first..first + 3], turns_zyx(|i, j| series[i][j]));
            }
            (Source::Joint(joint), kind) => {
                let c = chain.first[joint];
                let factor = if kind == Kind::Slide { linkage.size } else { 1.0 };
                out[first] = [
                    at.values[c] * factor,
                    rates[0][c] * factor,
                    rates[1][c] * factor,
                    2.0 * rates[2][c] * factor,
                ];
            }
            (Source::Universal(joint, frame), _) => {
                let series = universal_series(chain, joint, &frame, at, rates);
                write_turns(&mut out[first..first + 3], turns_zyx(|i, j| series[i][j]));
            }
            (Source::BeforeSpun(joint, frame), _) => {
                let Some(links) = &linkage.reduced.spun else {
                    continue;
                };
                let lie = links.spun.lie(value_series(chain, links.joint, at, rates));
                let series = product_series(&universal_series(chain, joint, &frame, at, rates), &lie);
                write_turns(&mut out[first..first + 3], turns_zyx(|i, j| series[i][j]));
            }
            (Source::AfterSpun(joint), _) => {
                let Some(links) = &linkage.reduced.spun else {
                    continue;
                };
                let lie = links.spun.lie_beyond(value_series(chain, links.joint, at, rates));
                let series = product_series(&lie, &joint_series(chain, joint, at, rates));
                write_turns(&mut out[first..first + 3], turns_zyx(|i, j| series[i][j]));
            }
        }
    }
}

fn write_turns(out: &mut [[f64; 4]], turns: Option<[Taylor<4>; 3]>) {
    for (k, slot) in out.iter_mut().enumerate() {
        *slot = match &turns {
            Some(t) => std::array::from_fn(|order| t[k].derivative(order)),
            None => [f64::NAN; 4],
        };
    }
}

/// The two turns of a ball whose link's spin is held, at which the line to the other ball lies as the ball's rotation takes it; and the
/// spin that this leaves out.
fn configure_universal(
    chain: &Chain,
    joint: usize,
    frame: &Rotation,
    turns: &Rotation,
    out: &mut Configuration,
) -> Rotation {
    let middle = chain
        .halves
        .iter()
        .find(|half| half.joint == joint + 1)
        .map_or(0.0, |half| half.middle);
    // the line's angle in the plane across the second axis, which the half turn that counts takes beyond a quarter
    let line = PI - middle;
    let to = Pose::turning(product(&product(&transposed(frame), turns), frame)).turn([
        0.0,
        line.cos(),
        line.sin(),
    ]);
    out.values[chain.first[joint]] = to[0].atan2(-to[1]);
    out.values[chain.first[joint + 1]] = short_way(to[2].atan2(-to[0].hypot(to[1])) - line);
    let still = [[0.0; COLUMNS]; ORDERS];
    let held = first_terms(&universal_series(chain, joint, frame, out, &still));
    product(&transposed(&held), turns)
}
