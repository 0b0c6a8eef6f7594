//! What both solvers say of a circuit's rows and dead centres.

/// What a row holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum RowStatus {
    /// Everything.
    Ok = 0,
    /// The pose; no rates, the input stands at a dead centre.
    DeadCentre = 1,
    /// The pose; no rates, two branches cross here.
    ChangePoint = 2,
    /// Nothing: the input is beyond a limit.
    NoSolution = 3,
    /// All but the turns of a ball, which this pose does not determine.
    TurnsUndefined = 4,
}

impl RowStatus {
    /// The status of a number.
    pub fn numbered(number: f64) -> Option<Self> {
        [
            Self::Ok,
            Self::DeadCentre,
            Self::ChangePoint,
            Self::NoSolution,
            Self::TurnsUndefined,
        ]
        .into_iter()
        .find(|&status| f64::from(status as u8) == number)
    }
}

/// Which joint stands still at a dead centre.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DeadCentreKind {
    /// The input can go no further; rates per input grow without bound.
    Input,
    /// The output turns back.
    Output,
}

impl DeadCentreKind {
    /// The word for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Input => "input",
            Self::Output => "output",
        }
    }
}

/// A dead centre of a circuit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeadCentre {
    /// Whose it is.
    pub kind: DeadCentreKind,
    /// The input's value.
    pub input: f64,
    /// The output's value.
    pub output: f64,
    /// The pass between input dead centres on which it lies; for one of the input the pass that starts there.
    pub branch: usize,
    /// How ill its place is conditioned: for the RSSR, how much a relative change of the squared dimensions is magnified in it; else
    /// the norm of the inverse of the bordered Jacobian.
    pub condition: f64,
}
