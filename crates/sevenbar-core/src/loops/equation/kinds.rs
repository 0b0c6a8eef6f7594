//! The joints of a description.

use super::closed::Joint;

/// A joint of the description; C and U are two of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// R
    Turn,
    /// P
    Slide,
    /// H, with its advance for a radian [length].
    Screw(f64),
    /// S
    Ball,
}

impl Kind {
    /// How many columns of joint values it has.
    pub fn columns(self) -> usize {
        self.joint(0).columns()
    }

    /// The chain's joint; a ball is the one of this number.
    pub(crate) fn joint(self, ball: usize) -> Joint {
        match self {
            Self::Turn => Joint::Turn,
            Self::Slide => Joint::Slide,
            Self::Screw(advance) => Joint::Screw(advance),
            Self::Ball => Joint::Ball(ball),
        }
    }
}
