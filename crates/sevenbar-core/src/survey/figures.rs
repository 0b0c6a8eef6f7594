//! The figures of one linkage, whatever is wanted of it.

use crate::rssr::MOST_LIMITS;

/// What one linkage is measured by.
#[derive(Clone, Copy, Debug)]
pub struct Figures {
    /// The code of its [`crate::rssr::MotionType`].
    pub motion_type: u8,
    /// Input dead centres in [0, 2 pi), rising, NaN after the last.
    pub limits: [f64; MOST_LIMITS],
    /// How far the output goes on each circuit; NaN where it turns fully, and where there is none.
    pub swing: [f64; 2],
    /// Time of the slower stroke over that of the quicker; NaN where the input does not turn fully.
    pub time_ratio: [f64; 2],
    /// The least transmission angle; NaN where the input does not turn fully.
    pub transmission: f64,
}
