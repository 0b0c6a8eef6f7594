//! A leg of a link at complex poses: what two ways of a leg on a universal joint have in common vanishes where they meet.
//!
//! Source: docs/theory_nets.md, (22) and (29).

use super::body_block::Leg;
use super::complex_known::{Held, Known, Own, Solved};
use super::rows::On;
use super::steps::{Move, Placement};
use super::two_turns::TwoTurns;
use crate::loops::equation::rotations::{cross, dot3};
use crate::rigid::Vec3;
use num_complex::Complex64;
use std::array::from_fn;

/// A leg, and the link that it holds.
#[derive(Clone, Copy)]
pub(super) struct ComplexLeg<'a> {
    pub leg: &'a Leg,
    pub link: usize,
}

type ComplexVector = [Complex64; 3];

impl ComplexLeg<'_> {
    /// Whether it has one way.
    pub fn is_single(&self) -> bool {
        self.leg.steps.len() == 1
    }

    /// Its ways where the link is; two of a universal joint.
    pub fn solved(&self, held: &Held, known: &Known) -> Option<Solved> {
        let leg = self.leg;
        let (first, last) = (*leg.steps.first()?, *leg.steps.last()?);
        let on = |on: On| on.map_or(Placement::still(), |step| known.poses[step]);
        let base = on(held.net.steps[first].parent);
        let ball = held.offset(known, leg.on[0], last)?.carry(&leg.ball);
        let goal = on(Some(self.link))
            .then(&held.offset(known, leg.on[1], self.link)?)
            .carry(&leg.ball);
        let goal = base.inverse().image(&goal);
        let steps = &held.net.steps;
        let (origin, axis) = (steps[first].origin, steps[first].axis);
        let [from, to] = [ball, goal].map(|place| from_fn(|i| place[i] - origin[i]));
        let placed = |moved: &[Complex64]| -> Own {
            let mut pose = base;
            let mut own = Own::new();
            for (&step, by) in leg.steps.iter().zip(moved) {
                pose = pose.then(&steps[step].moved(by + steps[step].reads));
                own.push((step, pose));
            }
            held.weld(known, &mut own);
            own
        };
        let one = Complex64::ONE;
        match leg.steps[..] {
            [_] if steps[first].moves == Move::Slide => {
                let by = along(axis, &from_fn(|i| to[i] - from[i]));
                Some(Solved::in_closed_form(vec![placed(&[by])], one, one))
            }
            [_] => Some(Solved::in_closed_form(
                vec![placed(&[turn(axis, &from, &to)])],
                one,
                one,
            )),
            [_, second] => {
                let other = steps[second].axis;
                let turns = TwoTurns::of([axis, other], &from, &to);
                let height = turns.square.sqrt();
                let way = |height: Complex64| {
                    let between = turns.between(height);
                    placed(&[turn(axis, &between, &to), turn(other, &from, &between)])
                };
                let solutions = vec![way(height), way(-height)];
                // a part of its own length would be infinite where that is zero
                let size = held.net.size * held.net.size;
                Some(Solved::in_closed_form(solutions, turns.square / size, one))
            }
            _ => None,
        }
    }
}

fn along(axis: Vec3, v: &ComplexVector) -> Complex64 {
    (0..3).map(|i| axis[i] * v[i]).sum()
}

/// The turn about an axis that takes a vector to another, as far as both are across it.
fn turn(axis: Vec3, from: &ComplexVector, to: &ComplexVector) -> Complex64 {
    let (up_from, up_to) = (along(axis, from), along(axis, to));
    let cosine = dot3(from, to) - up_from * up_to;
    let sine = along(axis, &cross(from, to));
    let square = dot3(from, from) - up_from * up_from;
    -Complex64::I * ((cosine + Complex64::I * sine) / square).ln()
}
