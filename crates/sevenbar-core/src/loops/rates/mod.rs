//! `A u = 0` with the input at its speed, as a power series in time: velocities, accelerations and jerks of joints, links and points.

pub(crate) mod points;
pub(crate) mod turns;
pub(crate) mod velocities;
