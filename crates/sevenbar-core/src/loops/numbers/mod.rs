//! `A dq = -(de/dp) dp`: how the joints and their rates follow the numbers p of the description.

pub(super) mod factors;
pub(super) mod numbered_loop;
pub(super) mod slopes;
mod twists;
pub(super) mod word;
