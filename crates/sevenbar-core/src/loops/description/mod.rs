//! `e(q) = 0` as a linkage is described, brought to that of the chain that is followed: idle freedoms held, balls made one joint.

pub(super) mod described_loop;
pub(super) mod holding;
pub(super) mod joint_values;
pub(super) mod reduce;
mod spin_axis;
mod spun;
