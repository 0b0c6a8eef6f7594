//! Links that are one loop, between known links that have complex poses: all ways to put them together.
//!
//! The closure is that of a single loop with one more joint, which is held; the link from the last joint to it has the pose of the one known link
//! against the other.
//!
//! Source: docs/theory_nets.md, (7) and (29).

use super::branch_ranges::turned;
use super::complex_known::{Held, Known, Own, Solved};
use super::loop_block::{HELD, LoopBlock, frame};
use super::monodromy::FAR;
use super::steps::{ComplexPose, Move, Placement, Step};
use crate::loops::Kind;
use crate::loops::equation::closure::{JOINTS, Slides, Solution, UNKNOWNS};
use crate::loops::equation::complex_frame::Frame;
use crate::loops::modes::complex_links::{ComplexLinks, Placed};
use crate::rigid::{Pose, Vec3, scale};
use num_complex::Complex64;
use std::array::from_fn;
use std::cell::{Cell, RefCell};

/// The loop, and its solutions in each way of what it hangs at.
pub(super) struct ComplexLoop<'a> {
    block: &'a LoopBlock,
    steps: [Step; UNKNOWNS],
    /// The frames of the steps as drawn, and of the held joint; lengths are relative to the size.
    frames: [Pose; JOINTS],
    /// After how many of the steps each link comes.
    after: Vec<usize>,
    /// The second turn of each ball.
    middles: Vec<usize>,
    links: ComplexLinks,
    last: RefCell<Vec<Last>>,
    restarts: Cell<usize>,
}

/// Where a way was last, and the solutions there, each pose once: a ball's turns have two values for each.
struct Last {
    placed: Placed,
    solutions: Vec<Solution>,
}

/// Solutions are one where no link is farther off [relative to the size].
const MET: f64 = 1e-6;

/// Directions along which a loop about a point might slide.
const ACROSS: [Vec3; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// What numbers of a link's pose weigh in sums, each time otherwise, and their squares besides.
const WEIGHTS: [[f64; 12]; FAR] = [
    [0.9, 0.7, 1.6, 0.5, 1.2, 1.1, 0.3, 1.9, 0.8, 1.0, 0.6, 1.4],
    [0.3, 2.9, 0.8, 4.1, 0.2, 1.3, 2.2, 0.7, 3.3, 0.4, 1.8, 0.1],
    [3.7, 0.4, 0.25, 1.4, 2.3, 0.15, 1.1, 4.3, 0.6, 2.6, 0.2, 0.9],
];
const SQUARES: f64 = 0.37;

impl<'a> ComplexLoop<'a> {
    /// Of a block; `None` where it screws, or has other freedoms than a closure.
    pub fn of(block: &'a LoopBlock, held: &Held, known: &Known) -> Option<Self> {
        let (mut steps, mut middles) = (Vec::new(), Vec::new());
        let mut before = vec![0];
        for step in &block.steps {
            let frame = step.frame();
            let single = |moves, axis| Step { parent: None, moves, origin: step.origin, axis, reads: 0.0 };
            match step.kind {
                Kind::Turn => steps.push(single(Move::Turn, step.axis)),
                Kind::Slide => steps.push(single(Move::Slide, step.axis)),
                Kind::Screw(_) => return None,
                Kind::Ball => {
                    middles.push(steps.len() + 1);
                    steps.extend([2, 1, 0].map(|axis| single(Move::Turn, frame.column(axis))));
                }
            }
            before.push(steps.len());
        }
        let after: Vec<usize> = block.links.iter().map(|link| before[link.after]).collect();
        if let (3, Some(centre), true) = (steps.len(), block.centre, middles.is_empty()) {
            // their columns are at right angles to those of the turns, whatever these are
            let slide = |axis| Step { parent: None, moves: Move::Slide, origin: centre, axis, reads: 0.0 };
            steps.extend(ACROSS.map(slide));
        }
        let steps: [Step; UNKNOWNS] = steps.try_into().ok()?;
        HELD.iter().find_map(|axis| {
            let size = held.net.size;
            let held_frame = block.held_frame(*axis, size)?;
            let frames = from_fn(|k| {
                let frame = steps
                    .get(k)
                    .map_or(held_frame, |step| frame(step.axis, step.origin));
                Pose { translation: scale(frame.translation, 1.0 / size), ..frame }
            });
            let own = Self {
                block,
                steps,
                frames,
                after: after.clone(),
                middles: middles.clone(),
                links: links(block, &frames, &after, &steps),
                last: RefCell::default(),
                restarts: Cell::default(),
            };
            let first = own.placed(held, known, None)?;
            (!own
                .each_once(held, known, &first, &own.links.solutions(&first))
                .is_empty())
            .then_some(own)
        })
    }

    /// How often its solutions were found anew, in another order.
    pub fn restarts(&self) -> usize {
        self.restarts.get()
    }

    /// All solutions where the links are that are known, in one of the ways of these; `None` where some are lost.
    pub fn solved(&self, held: &Held, known: &Known, way: usize) -> Option<Solved> {
        let mut last = self.last.borrow_mut();
        let count = last.first().map(|last| last.solutions.len());
        let placed = self.placed(held, known, last.get(way).map(|last| &last.placed))?;
        let carried = last.get(way).and_then(|last| {
            let there = |solutions: Vec<Solution>| {
                let solutions = self.each_once(held, known, &placed, &solutions);
                (Some(solutions.len()) == count).then_some(solutions)
            };
            let straight = self.links.carried(&last.placed, &last.solutions, &placed);
            there(straight)
                .or_else(|| there(self.links.carried_round(&last.placed, &last.solutions, &placed)))
        });
        let solutions = carried.unwrap_or_else(|| {
            self.restarts.set(self.restarts.get() + 1);
            self.each_once(held, known, &placed, &self.links.solutions(&placed))
        });
        if solutions.is_empty() || count.is_some_and(|count| count != solutions.len()) {
            return None;
        }
        let solved = self.measured(held, known, &placed, &solutions);
        let next = Last { placed, solutions };
        match last.get_mut(way) {
            Some(last) => *last = next,
            None => last.push(next),
        }
        Some(solved)
    }

    /// Solutions with what vanishes where two of them meet.
    fn measured(&self, held: &Held, known: &Known, placed: &Placed, solutions: &[Solution]) -> Solved {
        let mut meets = Complex64::ONE;
        for (x, determinant) in solutions.iter().zip(self.links.determinants(placed, solutions)) {
            // a ball's turns are singular where its pose is not
            let cosine = |&i: &usize| {
                let turn = x[i] / placed.zeros[i];
                turn + turn.inv()
            };
            let meets_here = self.middles.iter().map(cosine).fold(determinant, |d, by| d / by);
            meets = turned(meets, meets_here);
        }
        let solutions: Vec<Own> = solutions
            .iter()
            .map(|x| self.own(held, known, placed, x))
            .collect();
        let poses = || solutions.iter().flatten().map(|(_, pose)| pose);
        let sums = WEIGHTS.map(|by| poses().map(|pose| weighed(pose, &by, held.net.size)).sum());
        Solved { solutions, meets, finite: Complex64::ONE, sums }
    }

    fn slides(&self) -> Slides {
        slides(&self.steps)
    }

    /// The closure where the links are that are known; its turns differ least from those of a place near by. `None` where a link is not known.
    fn placed(&self, held: &Held, known: &Known, near: Option<&Placed>) -> Option<Placed> {
        let [first, last] = self
            .block
            .ends
            .map(|on| on.map_or(Placement::still(), |k| known.poses[k]));
        let mut links = [None; JOINTS];
        let relative = |pose: ComplexPose| {
            let translation = pose.translation.map(|x| x / held.net.size);
            Placement { translation, ..pose }
        };
        let mut between = |k: usize, pose: ComplexPose| {
            let from = ComplexPose::from(&self.frames[k]).inverse();
            let to = ComplexPose::from(&self.frames[(k + 1) % JOINTS]);
            let pose = from.then(&relative(pose)).then(&to);
            let axes = from_fn(|j| from_fn(|i| pose.rotation[i][j]));
            links[k] = Some(Frame { axes, origin: pose.translation });
        };
        for (link, after) in self.block.links.iter().zip(&self.after) {
            if link.on[0] != link.on[1] {
                between(after - 1, held.offset(known, Some(link.on[1]), link.on[0])?);
            }
        }
        between(UNKNOWNS - 1, last.inverse().then(&first));
        Some(self.links.placed(&links, near))
    }

    /// Where the links are in a solution.
    fn own(&self, held: &Held, known: &Known, placed: &Placed, x: &Solution) -> Own {
        let slides = self.slides();
        let mut at = self.block.ends[0].map_or(Placement::still(), |k| known.poses[k]);
        let mut own = Own::new();
        let mut links = self.block.links.iter().zip(&self.after).peekable();
        for (k, step) in self.steps.iter().enumerate() {
            let by = if slides[k] {
                x[k] * held.net.size
            } else {
                -Complex64::I * (x[k] / placed.zeros[k]).ln()
            };
            at = at.then(&step.moved(by));
            while let Some((link, _)) = links.next_if(|(_, after)| **after == k + 1) {
                own.push((link.on[0], at));
                if let Some(weld) = held.offset(known, Some(link.on[1]), link.on[0]) {
                    at = at.then(&weld);
                }
            }
        }
        held.weld(known, &mut own);
        own
    }

    /// Solutions of which no two put the links in the same places.
    fn each_once(&self, held: &Held, known: &Known, placed: &Placed, all: &[Solution]) -> Vec<Solution> {
        let mut distinct: Vec<(Solution, Own)> = Vec::new();
        for x in all {
            let own = self.own(held, known, placed, x);
            if distinct.iter().all(|(_, other)| !held.are_near(&own, other, MET)) {
                distinct.push((*x, own));
            }
        }
        distinct.into_iter().map(|(x, _)| x).collect()
    }
}

/// A sum that is infinite where a pose is.
fn weighed(pose: &ComplexPose, by: &[f64; 12], size: f64) -> Complex64 {
    let moved = pose.translation.map(|x| x / size);
    let numbers = pose.rotation.as_flattened().iter().chain(&moved);
    let weighed = numbers.zip(by).map(|(x, by)| (x + SQUARES * x * x) * by);
    weighed.sum()
}

fn slides(steps: &[Step; UNKNOWNS]) -> Slides {
    from_fn(|i| steps[i].moves == Move::Slide)
}

/// The closure, of which links may be any that end at the held joint, or whose sides the held step moves against each other.
fn links(
    block: &LoopBlock,
    frames: &[Pose; JOINTS],
    after: &[usize],
    steps: &[Step; UNKNOWNS],
) -> ComplexLinks {
    let transforms = from_fn(|k| frames[k].inverse().then(&frames[(k + 1) % JOINTS]));
    let mut any = [false; JOINTS];
    any[UNKNOWNS - 1] = true;
    for (link, after) in block.links.iter().zip(after) {
        any[after - 1] |= link.on[0] != link.on[1];
    }
    ComplexLinks::of(&transforms, &slides(steps), &any)
}
