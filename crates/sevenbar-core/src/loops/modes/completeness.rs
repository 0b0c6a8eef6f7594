//! How complete a set of modes is, with the word for it.

/// How complete a set of modes is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Completeness {
    /// All solutions over the complex numbers were accounted for.
    Algebraic,
    /// Found by monodromy until nothing new came; no trace test says that these are all.
    Monodromy,
    /// Found from many starts; no proof that there are no others.
    Searched,
}

impl Completeness {
    /// That of modes together with others, which are in closed form if they have none.
    pub(crate) fn or_less(self, other: Option<Self>) -> Self {
        match (self, other) {
            (Self::Searched, _) | (_, Some(Self::Searched)) => Self::Searched,
            (Self::Monodromy, _) | (_, Some(Self::Monodromy)) => Self::Monodromy,
            _ => Self::Algebraic,
        }
    }

    /// The word for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Algebraic => "algebraic",
            Self::Monodromy => "monodromy",
            Self::Searched => "searched",
        }
    }
}
