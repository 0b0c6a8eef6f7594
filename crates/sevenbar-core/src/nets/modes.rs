//! All modes of a net at one value of its input, block by block: `e(q) = 0` with the input held.
//!
//! Source: docs/theory_nets.md, (7) and (10) to (13).

use super::before::Before;
use super::body_block::BodyBlock;
use super::dyads::Dyad;
use super::loop_block::LoopBlock;
use super::net::Net;
use super::planar_block::PlanarBlock;
use super::rows::On;
use super::steps::Move;
use super::unfolded::turn_towards;
use crate::loops::equation::rotations::short_way;
use crate::loops::least_squares;
use crate::loops::modes::completeness::Completeness;
use crate::rigid::{Pose, cross, dot, most_perpendicular_axis, sub, unit};

/// A dyad of a net: the steps that carry its two links, and those that carry the known links at which it hangs.
#[derive(Clone, Copy, Debug)]
pub struct Stage {
    /// Its joints as drawn.
    pub dyad: Dyad,
    /// The steps of its links.
    pub links: [usize; 2],
    /// Those of the known links.
    pub known: [On; 2],
}

/// Links that are solved together.
#[derive(Clone, Debug)]
pub enum Part {
    /// Two, in closed form.
    Dyad(Stage),
    /// Others in a plane.
    Planar(PlanarBlock),
    /// One in space, with legs.
    Body(BodyBlock),
    /// Those of one loop.
    Loop(LoopBlock),
}

/// Modes of a net, and how it is known that none is missing.
#[derive(Clone, Debug)]
pub struct NetModes {
    /// The modes.
    pub modes: Vec<Mode>,
    /// `None` where they are in closed form; "searched" where some paths ended at no isolated pose: there may be others.
    pub completeness: Option<Completeness>,
}

/// A pose of a net: a value for each column [rad, or relative to the size], where each step leads, the greatest error of a row.
#[derive(Clone, Debug)]
pub struct Mode {
    /// The columns.
    pub values: Vec<f64>,
    /// The steps.
    pub poses: Vec<Pose>,
    /// The error [rad, or relative to the size].
    pub residual: f64,
    /// Whether it is one pose of a curve of poses that all close at this input.
    pub on_curve: bool,
}

/// Singular values below this part of the greatest are zero: two modes that nearly meet are still corrected.
const NO_RANK: f64 = 1e-10;

/// Modes nearer than this in every column [rad, or relative to the size] are one: two that meet part by the root of rounding.
const MEET: f64 = 5e-6;

/// Steps of Newton's method that take the rounding of the closed form off, an error [rad, or relative to the size] that is rounding, and that of a mode.
const STEPS: usize = 2;
const ROUNDED: f64 = 1e-14;
const CLOSES: f64 = 1e-9;

/// All isolated modes of a net, each part after those that it hangs at, with a step held at a value; and some poses of each curve of poses that
/// a dyad has. `None` where a part has more unknowns than are followed.
pub fn modes(net: &Net, parts: &[Part], driven: usize, value: f64) -> Option<NetModes> {
    let (start, moved) = started(net, driven, value);
    let from = net.steps[driven].parent;
    let mut completeness: Option<Completeness> = None;
    let mut partial = vec![(start, false)];
    for part in parts {
        let mut longer = Vec::new();
        for (poses, on_curve) in &partial {
            match part {
                Part::Dyad(stage) => {
                    let known = stage.known.map(|on| on.map_or(Pose::STILL, |k| poses[k]));
                    let known = [&known[0], &known[1]];
                    let isolated = stage.dyad.poses(known).into_iter().map(|both| (both, *on_curve));
                    let curves = stage.dyad.on_curve(known).into_iter().map(|both| (both, true));
                    for (both, on_curve) in isolated.chain(curves) {
                        longer.push((placed(poses, &stage.links, &both), on_curve));
                    }
                }
                Part::Planar(block) => {
                    let before = Before { poses, held: driven, from, moved, size: net.size };
                    let together = block.together(&before)?;
                    completeness = Some(together.completeness.or_less(completeness));
                    for own in together.poses {
                        let mut next = placed(poses, &block.links, &own);
                        before.weld(&mut next, &block.links);
                        longer.push((next, *on_curve));
                    }
                }
                Part::Body(block) => {
                    let before = Before { poses, held: driven, from, moved, size: net.size };
                    let together = block.together(net, &before)?;
                    let own = together.completeness;
                    completeness = own.map_or(completeness, |own| Some(own.or_less(completeness)));
                    let curved = *on_curve || together.on_curve;
                    longer.extend(together.poses.into_iter().map(|next| (next, curved)));
                }
                Part::Loop(block) => {
                    let before = Before { poses, held: driven, from, moved, size: net.size };
                    let together = block.together(net, &before)?;
                    completeness = Some(together.completeness.or_less(completeness));
                    let curved = |curved| *on_curve || curved;
                    longer.extend(together.poses.into_iter().map(|(next, own)| (next, curved(own))));
                }
            }
        }
        partial = longer;
    }
    let closed = partial
        .iter()
        .map(|(poses, on_curve)| settled(net, net.values(poses), (driven, value), *on_curve))
        .filter(|mode| mode.residual < CLOSES && net.is_facing(&mode.poses));
    let mut modes: Vec<Mode> = Vec::new();
    for mode in closed {
        // two that meet are one, as dyads have it
        if completeness.is_none() || mode.on_curve || modes.iter().all(|m| !same(net, m, &mode)) {
            modes.push(mode);
        }
    }
    Some(NetModes { modes, completeness })
}

/// The poses of all steps before the first part is placed, and where the held step leads.
fn started(net: &Net, driven: usize, value: f64) -> (Vec<Pose>, Pose) {
    let unit = if net.slides(driven) { net.size } else { 1.0 };
    let moved: Pose = net.steps[driven].moved(value * unit).into();
    let mut start = vec![Pose::STILL; net.steps.len()];
    if net.steps[driven].parent.is_none() {
        start[driven] = moved;
    }
    (start, moved)
}

/// What is known before the first part is placed goes to work.
pub(super) fn at_first<T>(net: &Net, driven: usize, value: f64, work: impl Fn(&Before) -> T) -> T {
    let (start, moved) = started(net, driven, value);
    let from = net.steps[driven].parent;
    work(&Before { poses: &start, held: driven, from, moved, size: net.size })
}

/// Poses with those of some steps put in.
fn placed(poses: &[Pose], steps: &[usize], own: &[Pose]) -> Vec<Pose> {
    let mut next = poses.to_vec();
    for (&step, pose) in steps.iter().zip(own) {
        next[step] = *pose;
    }
    next
}

/// Whether two modes are one.
fn same(net: &Net, a: &Mode, b: &Mode) -> bool {
    a.values.iter().zip(&b.values).enumerate().all(|(c, (x, y))| {
        let apart = if net.slides(c) { x - y } else { short_way(x - y) };
        apart.abs() < MEET
    })
}

/// The mode that a few of Newton's steps lead to, with a step held.
fn settled(net: &Net, mut values: Vec<f64>, (driven, value): (usize, f64), on_curve: bool) -> Mode {
    values[driven] = value;
    let greatest = |errors: &[f64]| errors.iter().fold(0.0, |most: f64, e| most.max(e.abs()));
    let (mut errors, mut columns) = net.closure(&values);
    let mut residual = greatest(&errors);
    for _ in 0..STEPS {
        columns[driven].fill(0.0);
        let mut next = values.clone();
        for (x, by) in next.iter_mut().zip(least_squares(&columns, &errors, NO_RANK)) {
            *x -= by;
        }
        next[driven] = value;
        let (after, slopes) = net.closure(&next);
        // at a dead centre a step may lead anywhere
        if greatest(&after) > residual.max(ROUNDED) {
            break;
        }
        residual = greatest(&after);
        (values, errors, columns) = (next, after, slopes);
    }
    Mode { poses: net.poses(&values), values, residual, on_curve }
}

impl Net {
    /// Whether the axes of chords on their two links make less than a right angle.
    fn is_facing(&self, poses: &[Pose]) -> bool {
        self.facing.iter().all(|facing| {
            let [a, b] = facing
                .on
                .map(|on| on.map_or(facing.direction, |s| poses[s].turn(facing.direction)));
            dot(a, b) > 0.0
        })
    }

    /// The values of the columns for which steps lead to these poses.
    fn values(&self, poses: &[Pose]) -> Vec<f64> {
        self.steps
            .iter()
            .zip(poses)
            .map(|(step, pose)| {
                let before = step.parent.map_or(Pose::STILL, |p| poses[p]);
                let moved = before.inverse().then(pose);
                match step.moves {
                    Move::Slide => {
                        let slid = dot(sub(moved.carry(step.origin), step.origin), step.axis);
                        (slid + step.reads) / self.size
                    }
                    Move::Turn | Move::Screw(_) => {
                        let across = unit(cross(step.axis, most_perpendicular_axis(step.axis)));
                        turn_towards(step.axis, across, moved.turn(across)) + step.reads
                    }
                }
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::dyads::Pair;
    use super::super::rows::Row;
    use super::super::steps::Step;
    use super::*;

    #[test]
    fn a_watt_six_bar_has_the_product_of_its_dyads_modes() {
        let z = [0.0, 0.0, 1.0];
        let at = [
            [0.0, 0.0, 0.0],
            [1.0, 4.0, 0.0],
            [11.0, 8.0, 0.0],
            [10.0, 0.0, 0.0],
            [15.0, 6.0, 0.0],
            [17.5, 20.0, 0.0],
            [20.0, 0.0, 0.0],
        ];
        let pin = |parent, origin| Step { parent, moves: Move::Turn, origin, axis: z, reads: 0.0 };
        // crank, coupler, rocker, link, lever
        let steps = vec![
            pin(None, at[0]),
            pin(Some(0), at[1]),
            pin(None, at[3]),
            pin(Some(2), at[4]),
            pin(None, at[6]),
        ];
        let closing = |a, b, at| {
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(|v| Row::Along { on: [Some(a), Some(b)], at, v })
        };
        let mut rows = closing(1, 2, at[2]).to_vec();
        rows.extend(closing(3, 4, at[5]));
        let net = Net { steps, rows, facing: Vec::new(), balls: Vec::new(), size: 40.0 };
        let dyad = |a, b, c| Dyad { normal: z, pairs: [Pair::Hinge(a), Pair::Hinge(b), Pair::Hinge(c)] };
        let stage = |dyad, links, known| Part::Dyad(Stage { dyad, links, known });
        let parts = [
            stage(dyad(at[1], at[2], at[3]), [1, 2], [Some(0), None]),
            stage(dyad(at[4], at[5], at[6]), [3, 4], [Some(2), None]),
        ];
        let found = modes(&net, &parts, 0, 0.0).unwrap().modes;
        assert_eq!(found.len(), 4);
        assert!(found.iter().all(|m| m.residual < 1e-15));
        // the drawing is one of them
        assert!(found.iter().any(|m| m.values.iter().all(|x| x.abs() < 1e-12)));
    }
}
