//! The values of steps in a row that lead to a pose.

use super::net::Net;
use super::steps::Move;
use crate::loops::least_squares;
use crate::rigid::{Pose, Vec3, cross, dot, scale, sub};

/// Slides whose directions are dependent to this part move by the least.
const NO_RANK: f64 = 1e-10;

/// By how much a turn about an axis takes a direction nearest to another [rad].
pub(super) fn turn_towards(axis: Vec3, from: Vec3, to: Vec3) -> f64 {
    let across = |v: Vec3| sub(v, scale(axis, dot(axis, v)));
    let (from, to) = (across(from), across(to));
    dot(axis, cross(from, to)).atan2(dot(from, to))
}

impl Net {
    /// By how much each of some steps in a row moves [rad, or length] where together they move as a pose does: at most three turns, of three each
    /// at right angles to the others, and slides.
    pub(super) fn unfolded(&self, steps: &[usize], moved: &Pose) -> Vec<f64> {
        let axis = |k: usize| self.steps[steps[k]].axis;
        let turns: Vec<usize> = (0..steps.len())
            .filter(|&k| self.steps[steps[k]].moves != Move::Slide)
            .collect();
        let mut by = vec![0.0; steps.len()];
        let mut left = moved.rotation;
        for (n, &k) in turns.iter().enumerate() {
            let turned = |v: Vec3| Pose { rotation: left, ..Pose::STILL }.turn(v);
            let own = axis(k);
            by[k] = match turns[n + 1..] {
                [] => {
                    let across = crate::rigid::most_perpendicular_axis(own);
                    turn_towards(own, across, turned(across))
                }
                [next] => turn_towards(own, axis(next), turned(axis(next))),
                [next, last, ..] => {
                    // the middle one takes the last axis out of its place by less than a quarter turn
                    let aside = cross(axis(next), axis(last));
                    let sine = dot(own, turned(axis(last))) / dot(own, aside);
                    let cosine = (1.0 - sine * sine).max(0.0).sqrt();
                    let from: Vec3 = std::array::from_fn(|i| cosine * axis(last)[i] + sine * aside[i]);
                    turn_towards(own, from, turned(axis(last)))
                }
            };
            let back = self.moving_by(steps[k], -by[k]);
            left = back.then(&Pose { rotation: left, ..Pose::STILL }).rotation;
        }
        // slides make up for what turns alone miss
        let (mut all, mut columns, mut slides) = (Pose::STILL, Vec::new(), Vec::new());
        for (k, &step) in steps.iter().enumerate() {
            if self.steps[step].moves == Move::Slide {
                columns.push(all.turn(axis(k)).to_vec());
                slides.push(k);
            }
            all = all.then(&self.moving_by(step, by[k]));
        }
        if !slides.is_empty() {
            let missed = sub(moved.translation, all.translation);
            for (k, value) in slides.into_iter().zip(least_squares(&columns, &missed, NO_RANK)) {
                by[k] = value;
            }
        }
        by
    }

    /// Places steps in a row so that they lead to a pose, or as near as they can.
    pub(super) fn unfold(&self, poses: &mut [Pose], steps: &[usize], to: &Pose) {
        let parent = steps.first().and_then(|&first| self.steps[first].parent);
        let moved = parent.map_or(Pose::STILL, |p| poses[p]).inverse().then(to);
        let by = self.unfolded(steps, &moved);
        self.follow(poses, steps, &by);
    }

    /// Places steps in a row that move by so much.
    pub(super) fn follow(&self, poses: &mut [Pose], steps: &[usize], by: &[f64]) {
        for (&step, &by) in steps.iter().zip(by) {
            let parent = self.steps[step].parent.map_or(Pose::STILL, |p| poses[p]);
            poses[step] = parent.then(&self.moving_by(step, by));
        }
    }

    /// The motion of a step by so much [rad, or length] from where it is drawn.
    pub(super) fn moving_by(&self, step: usize, by: f64) -> Pose {
        let step = &self.steps[step];
        step.moved(by + step.reads).into()
    }
}

#[cfg(test)]
mod tests {
    use super::super::steps::Step;
    use super::*;

    #[test]
    fn steps_lead_where_they_should() {
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let step = |parent, moves, axis, origin| Step { parent, moves, axis, origin, reads: 0.3 };
        let at = [1.0, -2.0, 0.5];
        let mut steps = Vec::new();
        for (k, moves) in [Move::Slide, Move::Turn].into_iter().cycle().enumerate().take(6) {
            let axis = scale(axes[k / 2], if k > 3 { -1.0 } else { 1.0 });
            steps.push(step(k.checked_sub(1), moves, axis, at));
        }
        let net = Net {
            steps,
            rows: Vec::new(),
            facing: Vec::new(),
            balls: Vec::new(),
            size: 1.0,
        };
        let moves = [0.4, 1.1, -0.7, -0.9, 0.2, 2.5];
        for some in [
            vec![0, 1, 2, 3, 4, 5],
            vec![1, 3, 5],
            vec![1, 3],
            vec![0, 3],
            vec![3],
            vec![4],
        ] {
            let mut pose = Pose::STILL;
            for &k in &some {
                pose = pose.then(&net.moving_by(k, moves[k]));
            }
            for (by, k) in net.unfolded(&some, &pose).into_iter().zip(&some) {
                assert!((by - moves[*k]).abs() < 1e-14, "{some:?}: {by}");
            }
        }
    }
}
