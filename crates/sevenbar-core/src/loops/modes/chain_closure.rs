//! The closure of a chain at any value of its input, and the class of its geometry.

use super::geometry::Form;
use super::starts::Class;
use crate::loops::equation::closed::Joint;
use crate::loops::equation::closure::{JOINTS, Parameters, Slides, UNKNOWNS};
use crate::rigid::Pose;
use num_complex::Complex64;
use std::sync::Arc;

/// The input as the closure takes it: `e^(i t)` and the slide. A screw's two are moved apart on the way to it.
#[derive(Clone, Copy)]
pub(super) struct Input {
    pub turn: Complex64,
    pub slide: Complex64,
}

/// The links' normal form, and closures of the same geometry.
pub(super) struct Closure {
    pub form: Form,
    pub class: Arc<Class>,
}

impl Closure {
    /// From the transforms after the joints, the first unknown one's first and the input's last.
    pub fn of(transforms: &[Pose; JOINTS], slides: &Slides, input: Joint) -> Self {
        Self::with_any(transforms, slides, input, &[false; JOINTS])
    }

    /// The same where some links may be any, so that nothing of them is of the class.
    pub fn with_any(
        transforms: &[Pose; JOINTS],
        slides: &Slides,
        input: Joint,
        any: &[bool; JOINTS],
    ) -> Self {
        let form = Form::of(transforms.each_ref());
        let mut given = [input == Joint::Slide; JOINTS];
        given[..UNKNOWNS].copy_from_slice(slides);
        if let Some(form) = form.with_zeros(&given, any) {
            let class = Class::of(slides, Some(form.pattern(&given, any, input != Joint::Turn)));
            // without solutions that stand alone a class leads nowhere
            if class.count() > 0 {
                return Self { form, class };
            }
        }
        Self { form, class: Class::of(slides, None) }
    }

    /// The closure at an input, and what its unknowns differ by from the joints' values.
    pub fn parameters(&self, input: Input) -> (Parameters, [Complex64; UNKNOWNS]) {
        let zeros = self.form.zeros();
        let mut turns = zeros;
        turns[UNKNOWNS] *= input.turn;
        let parameters = Parameters {
            twists: self.form.twists,
            shifts: self.form.shifts.map(|s| s.map(Complex64::from)),
            turns,
            slide: input.slide,
        };
        (parameters, std::array::from_fn(|i| zeros[i]))
    }
}
