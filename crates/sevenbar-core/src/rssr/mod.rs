//! The RSSR in closed form.
//!
//! Crank and rocker carry their balls `A` and `B` round two circles, skew at any angle and any distance; the
//! coupler holds `|A - B| = L2`. With one of the two angles held, the other solves
//! `E cos x + F sin x = K` (Sun and Zhou, eq. (4)), so there are at most two assembly modes; an angle is a limit
//! where the two meet: `E^2 + F^2 = K^2`, a quartic in the tangent of its half.
//!
//! Source: docs/rssr.md, (1) to (3).

mod batch;
mod circuits;
mod classify;
mod domain;
mod extremes;
mod frames;
mod free_side;
mod lines;
mod linkage;
mod measures;
mod motion;
mod pair;
mod rates;

pub use batch::{BatchRates, MAX_ORDER};
pub use circuits::Row;
pub(crate) use classify::{DOUBTFUL, code_of, padded};
pub use classify::{INVALID, MOST_LIMITS, classify};
pub use domain::Extent;
pub use extremes::Extreme;
pub(crate) use lines::{BLOCK, Dimensions, Drive, Lane, Lines};
pub use linkage::{Circle, Input, Rssr};
pub use measures::{MotionMeasures, measure, measures_with_rows};
pub use motion::{Circuit, Motion, MotionType};
pub use pair::{Pair, Reach};
