//! `e(q) = 0` as a linkage is described, brought to that of the chain that is followed: idle freedoms held, balls made one joint.

pub(crate) mod described_loop;
pub(crate) mod holding;
pub(crate) mod joint_values;
pub(crate) mod reduce;
mod spin_axis;
mod spun;
