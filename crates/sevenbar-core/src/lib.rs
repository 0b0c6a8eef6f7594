//! Sevenbar's core: closing spatial loops, following them, differentiating them.
//!
//! No input or output, no printing, no clock; the only state is a cache of start systems, and who may stop the work of a thread. Angles are radians; lengths are in
//! whatever unit the caller uses, the same in and out.

pub mod driven;
pub mod error;
pub mod loops;
pub mod nets;
mod number;
mod one_pose;
pub mod outcome;
pub mod parallel;
pub mod piecewise;
mod random;
pub mod rigid;
pub mod rssr;
pub mod simd;
pub mod stopping;
pub mod survey;
pub mod taylor;
mod trigonometric;
mod twofold;
mod vector_math;
mod vectors;

pub use error::Error;
