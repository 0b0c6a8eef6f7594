//! A closure of which some links are any rigid motions with complex entries: all of its solutions, and these carried on while the links change.
//!
//! Source: docs/theory.md, (6); docs/theory_nets.md, (29).

use super::chain_closure::Closure;
use super::continuation::{CAREFUL, determinants};
use super::straight::{Straight, along, carried, carried_near};
use crate::loops::equation::closed::Joint;
use crate::loops::equation::closure::{JOINTS, Parameters, Slides, Solution, UNKNOWNS};
use crate::loops::equation::complex_frame::{Frame, NormalForm};
use crate::rigid::Pose;
use num_complex::Complex64;
use std::array::from_fn;

/// Where a way round leads through, as a part of the straight one.
const ASIDE: Complex64 = Complex64::new(0.5, 0.4);

/// A closure whose last joint, which turns, is held at zero.
pub(crate) struct ComplexLinks {
    slides: Slides,
    closure: Closure,
    /// By how much the frame at the beginning of each link that may be any was moved along its joint [relative to the size].
    moved: [f64; JOINTS],
}

/// The closure while its links are somewhere.
#[derive(Clone)]
pub(crate) struct Placed {
    parameters: Parameters,
    /// The links that may be any.
    forms: [Option<NormalForm>; JOINTS],
    /// `e^(i t)` of the unknowns' zeros.
    pub zeros: [Complex64; UNKNOWNS],
}

impl ComplexLinks {
    /// From the transforms after the joints, the first unknown one's first, at real ones of the links that may be `any`.
    pub fn of(transforms: &[Pose; JOINTS], slides: &Slides, any: &[bool; JOINTS]) -> Self {
        let closure = Closure::with_any(transforms, slides, Joint::Turn, any);
        let along = |link: usize| {
            let own = Frame::from_pose(&transforms[link]).normal_form().shift[2].re;
            if any[link] {
                closure.form.shifts[link][2] - own
            } else {
                0.0
            }
        };
        let moved = from_fn(along);
        Self { slides: *slides, closure, moved }
    }

    /// Where these links are so; their turns differ least from those of a place near by.
    pub fn placed(&self, links: &[Option<Frame>; JOINTS], near: Option<&Placed>) -> Placed {
        let form = &self.closure.form;
        let forms: [Option<NormalForm>; JOINTS] = from_fn(|i| {
            let own = links[i].as_ref()?.normal_form();
            let near = near.and_then(|near| near.forms[i].as_ref());
            Some(near.map_or(own, |near| own.near(near)))
        });
        let turned = |i: usize| -> Complex64 {
            let last = (i + JOINTS - 1) % JOINTS;
            let before = forms[i].map_or(form.before[i], |own| own.before);
            before * forms[last].map_or(form.after[last], |own| own.after)
        };
        let turns = from_fn(turned);
        let shift = |i: usize| match forms[i].map(|own| own.shift) {
            Some([x, y, z]) => [x, y, z + self.moved[i]],
            None => form.shifts[i].map(Complex64::from),
        };
        let parameters = Parameters {
            twists: from_fn(|i| forms[i].map_or(form.twists[i], |own| own.twist)),
            shifts: from_fn(shift),
            turns,
            slide: Complex64::ZERO,
        };
        Placed { parameters, forms, zeros: from_fn(|i| turns[i]) }
    }

    /// All solutions at a place in general position.
    pub fn solutions(&self, at: &Placed) -> Vec<Solution> {
        self.closure.class.solutions(&at.parameters)
    }

    /// Those to which solutions at one place lead at another near by.
    pub fn carried(&self, from: &Placed, solutions: &[Solution], to: &Placed) -> Vec<Solution> {
        carried_near(&self.slides, &from.parameters, &to.parameters, solutions)
    }

    /// The same round what two of them meet at on the straight way.
    pub fn carried_round(&self, from: &Placed, solutions: &[Solution], to: &Placed) -> Vec<Solution> {
        let aside = along(&from.parameters, &to.parameters, ASIDE);
        let mut solutions = solutions.to_vec();
        for (from, to) in [(&from.parameters, &aside), (&aside, &to.parameters)] {
            let ends = carried(&self.slides, from, to, &solutions, CAREFUL);
            solutions = ends.into_iter().flatten().collect();
        }
        solutions
    }

    /// The determinants of the joints' columns at solutions.
    pub fn determinants(&self, at: &Placed, solutions: &[Solution]) -> Vec<Complex64> {
        let here = Straight { slides: &self.slides, from: &at.parameters, to: &at.parameters };
        determinants(&here, solutions)
    }
}
