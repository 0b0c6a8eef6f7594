//! What acts on the links of a loop: bodies and gravity, loads, springs and dampers.
//!
//! Lengths are relative to the size, so forces are in kg size/s^2 and torques in kg size^2/s^2.

use crate::rigid::Vec3;

/// A body on the link behind so many joints, in the frame there; by one of each number it moves in that frame by a twist.
#[derive(Clone, Debug)]
pub struct Body {
    /// How many joints are before its link.
    pub joints: usize,
    /// Mass [kg].
    pub mass: f64,
    /// Centre of mass.
    pub centre: Vec3,
    /// Moments of inertia about the centre.
    pub inertia: [[f64; 3]; 3],
    /// By number, the twist.
    pub ways: Vec<(usize, [f64; 6])>,
}

/// A place on the link behind so many joints, in the frame there; by one of each number it moves in that frame by a twist.
#[derive(Clone, Debug)]
pub struct Place {
    /// How many joints are before its link.
    pub joints: usize,
    /// Where it is.
    pub at: Vec3,
    /// By number, the twist.
    pub ways: Vec<(usize, [f64; 6])>,
}

/// A force and a torque at a place; in the frame of its link or of the ground. Row by row it is multiplied by a factor.
#[derive(Clone, Debug)]
pub struct Load {
    /// Where the force acts.
    pub place: Place,
    /// The force.
    pub force: Vec3,
    /// The torque.
    pub torque: Vec3,
    /// Whether both turn with the link.
    pub turns: bool,
}

/// A spring and a damper between two places.
#[derive(Clone, Debug)]
pub struct PointSpring {
    /// Where it is fixed.
    pub ends: [Place; 2],
    /// Force by length, or torque by angle.
    pub stiffness: f64,
    /// The length at which it is slack.
    pub length: f64,
    /// Force by speed, or torque by angular velocity.
    pub damping: f64,
}

/// A spring and a damper in the joint of a column.
#[derive(Clone, Copy, Debug)]
pub struct JointSpring {
    /// The column.
    pub column: usize,
    /// Force by length, or torque by angle.
    pub stiffness: f64,
    /// The value at which it is slack.
    pub slack: f64,
    /// Force by speed, or torque by angular velocity.
    pub damping: f64,
}

/// All that acts.
#[derive(Clone, Debug, Default)]
pub struct Acting {
    /// In the report frame.
    pub gravity: Vec3,
    /// Bodies.
    pub bodies: Vec<Body>,
    /// Loads.
    pub loads: Vec<Load>,
    /// Springs between places.
    pub springs: Vec<PointSpring>,
    /// Springs in joints.
    pub joint_springs: Vec<JointSpring>,
}
