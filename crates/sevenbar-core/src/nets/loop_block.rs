//! Links that are one loop between known links: its modes are those of a single loop in which one more joint is held.
//!
//! Source: docs/theory_nets.md, (7).

use super::before::Before;
use super::net::Net;
use super::rows::On;
use super::steps::{Move, Step};
use crate::loops::equation::rotations::ball_rotation;
use crate::loops::modes::completeness::Completeness;
use crate::loops::{Kind, Loop, modes};
use crate::rigid::{Pose, Vec3, add, cross, most_perpendicular_axis, scale, unit};

/// A freedom of a joint, or a ball, in the order of the loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopStep {
    /// What it lets go.
    pub kind: Kind,
    /// A place on its axis, or of the ball, as drawn.
    pub origin: Vec3,
    /// The direction of its axis as drawn, of length 1; of a ball any.
    pub axis: Vec3,
}

/// A link of the loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopLink {
    /// How many steps lead to it.
    pub after: usize,
    /// The steps of the net that carry the sides at which the loop comes and leaves: two where the held joint is between them.
    pub on: [usize; 2],
}

/// Links in a row between two known ones.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopBlock {
    /// From one known link to the other.
    pub steps: Vec<LoopStep>,
    /// The links between them, in this order.
    pub links: Vec<LoopLink>,
    /// The steps that carry the known links.
    pub ends: [On; 2],
    /// The steps of each of its joints that has several in the net, in a row.
    pub joints: Vec<Vec<usize>>,
    /// The point in which all axes meet, where they do.
    pub centre: Option<Vec3>,
}

/// Directions of the held joint's axis, not as people draw, each tried where solutions are lost with those before; and how far from the first joint
/// it is, relative to the size.
pub(super) const HELD: [Vec3; 3] = [
    [0.362_738_1, -0.528_417_9, 0.767_616_4],
    [-0.811_370_2, 0.236_914_8, 0.534_378_1],
    [0.137_951_3, 0.917_260_4, -0.373_614_9],
];
const AWAY: f64 = 0.103_731_7;

/// Turns of the frame of a ball: its angles are not undefined at right angles to what is drawn.
const BALL: [f64; 3] = [0.7312, 0.4187, -1.1043];

/// All ways to put a block together: the poses of all steps, which are of a curve of them, and how complete they are.
pub(super) struct Together {
    pub poses: Vec<(Vec<Pose>, bool)>,
    pub completeness: Completeness,
}

impl LoopBlock {
    /// All ways to put it together; `None` where it has more or fewer freedoms than a loop that is held.
    pub(super) fn together(&self, net: &Net, before: &Before) -> Option<Together> {
        let frames: Vec<Pose> = self.steps.iter().map(LoopStep::frame).collect();
        let [first, last] = self.ends.map(|on| on.map_or(Pose::STILL, |k| before.poses[k]));
        let welds: Option<Vec<Pose>> = self.links.iter().map(|link| link.weld(before)).collect();
        let welds = welds?;
        // between the frames of two steps the link may be welded to another
        let between = |k: usize| {
            let mut out = frames[k].inverse();
            for (link, weld) in self.links.iter().zip(&welds) {
                if link.after == k + 1 {
                    out = out.then(weld);
                }
            }
            out
        };
        let mut kinds = vec![Kind::Turn];
        kinds.extend(self.steps.iter().map(|step| step.kind));
        // from the held joint on
        let mut fixed = vec![*frames.first()?];
        fixed.extend((1..frames.len()).map(|k| between(k - 1).then(&frames[k])));
        let held_about = |axis: Vec3| {
            let held = self.held_frame(axis, before.size)?;
            let mut fixed = fixed.clone();
            fixed[0] = held.inverse().then(&fixed[0]);
            let linkage = Loop::new(&kinds, first.then(&held), last.then(frames.last()?), &fixed);
            modes(&linkage, 0, 0.0)
        };
        let mut found = held_about(HELD[0])?;
        for axis in &HELD[1..] {
            if found.completeness == Completeness::Searched {
                found = held_about(*axis)?;
            }
        }
        let of_values = |values: &Vec<f64>, on_curve: bool| {
            let placed = self.placed(&first, &welds, &values[1..]);
            let mut poses = before.poses.to_vec();
            for (link, pose) in self.links.iter().zip(placed) {
                poses[link.on[0]] = pose;
                before.weld(&mut poses, &link.on);
            }
            for steps in &self.joints {
                if let Some(&last) = steps.last() {
                    let to = poses[last];
                    net.unfold(&mut poses, steps, &to);
                }
            }
            (poses, on_curve)
        };
        let isolated = found.modes.iter().map(|(values, _)| of_values(values, false));
        let on_curve = found.on_curve.iter().map(|values| of_values(values, true));
        let mut poses: Vec<(Vec<Pose>, bool)> = isolated.chain(on_curve).collect();
        let count = poses.len();
        poses.retain(|(poses, _)| {
            poses
                .iter()
                .flat_map(|pose| pose.rotation)
                .flatten()
                .all(f64::is_finite)
        });
        let lost = poses.len() < count;
        let completeness = if lost {
            Completeness::Searched
        } else {
            found.completeness
        };
        Some(Together { poses, completeness })
    }

    /// The frame as drawn of the joint that is held, about an axis of this direction.
    pub(super) fn held_frame(&self, axis: Vec3, size: f64) -> Option<Pose> {
        let (axis, origin) = (unit(axis), self.steps.first()?.origin);
        let away = add(origin, scale([axis[1], axis[2], axis[0]], AWAY * size));
        Some(frame(axis, self.centre.unwrap_or(away)))
    }

    /// The poses of its links at values of its columns.
    fn placed(&self, first: &Pose, welds: &[Pose], values: &[f64]) -> Vec<Pose> {
        let (mut at, mut column) = (*first, 0);
        let mut out = Vec::with_capacity(self.links.len());
        for (k, step) in self.steps.iter().enumerate() {
            let own = &values[column..column + step.kind.columns()];
            column += own.len();
            at = at.then(&step.moved(own));
            for (link, weld) in self.links.iter().zip(welds) {
                if link.after == k + 1 {
                    out.push(at);
                    at = at.then(weld);
                }
            }
        }
        out
    }
}

impl LoopStep {
    pub(super) fn frame(&self) -> Pose {
        if self.kind == Kind::Ball {
            Pose { translation: self.origin, ..Pose::turning(ball_rotation(&BALL)) }
        } else {
            frame(self.axis, self.origin)
        }
    }

    /// Where it leads from where it is drawn at values of its columns.
    fn moved(&self, values: &[f64]) -> Pose {
        let moves = match self.kind {
            Kind::Turn => Move::Turn,
            Kind::Slide => Move::Slide,
            Kind::Screw(advance) => Move::Screw(advance),
            Kind::Ball => {
                let (frame, turned) = (self.frame(), ball_rotation(&[values[0], values[1], values[2]]));
                return frame.then(&Pose::turning(turned)).then(&frame.inverse());
            }
        };
        let step = Step { parent: None, moves, origin: self.origin, axis: self.axis, reads: 0.0 };
        step.moved(values[0]).into()
    }
}

impl LoopLink {
    /// The pose of the side at which the loop leaves against that at which it comes.
    fn weld(&self, before: &Before) -> Option<Pose> {
        before.offset(Some(self.on[1]), self.on[0])
    }
}

/// A frame with z along an axis.
pub(super) fn frame(axis: Vec3, origin: Vec3) -> Pose {
    let x = unit(cross(axis, most_perpendicular_axis(axis)));
    let y = cross(axis, x);
    let rotation = std::array::from_fn(|i| [x[i], y[i], axis[i]]);
    Pose { translation: origin, ..Pose::turning(rotation) }
}
