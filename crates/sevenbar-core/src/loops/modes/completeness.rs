//! How complete a set of modes is, with the word for it.

/// How complete a set of modes is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Completeness {
    /// All solutions over the complex numbers were accounted for.
    Algebraic,
    /// Found from many starts; no proof that there are no others.
    Searched,
}

impl Completeness {
    /// The word for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Algebraic => "algebraic",
            Self::Searched => "searched",
        }
    }
}
