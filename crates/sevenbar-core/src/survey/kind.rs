//! Motion type and limits of a block of RSSRs with axes at any angle, and the turns of their outputs.

use crate::rssr::{
    BLOCK, DOUBTFUL, Dimensions, Input, Lane, Lines, MOST_LIMITS, MotionType, Rssr, code_of, padded,
};

/// What the joints of the linkages of a block can do.
pub(super) struct Kind {
    there: Lines,
    back: Lines,
    /// The motion type as a number.
    pub(super) code: Lane,
    /// Input dead centres in [0, 2 pi), rising, NaN after the last.
    pub(super) limits: [Lane; MOST_LIMITS],
    /// The same of the output.
    pub(super) turns: [Lane; MOST_LIMITS],
}

impl Kind {
    pub(super) const fn new() -> Self {
        Self {
            there: Lines::new(),
            back: Lines::new(),
            code: [0.0; BLOCK],
            limits: [[0.0; BLOCK]; MOST_LIMITS],
            turns: [[0.0; BLOCK]; MOST_LIMITS],
        }
    }

    /// Finds everything: in vector code where it is clear, else by the solver that counts zeros by signs.
    #[inline(always)]
    pub(super) fn find<const FUSED: bool>(&mut self, block: &Dimensions) {
        self.there.find::<FUSED>(block, Input::Crank);
        self.back.find::<FUSED>(block, Input::Rocker);
        self.there.limits::<FUSED>(block, Input::Crank, &mut self.limits);
        self.back.limits::<FUSED>(block, Input::Rocker, &mut self.turns);
        let mut doubtful = 0;
        for i in 0..BLOCK {
            let clear = self.there.doubt[i] + self.back.doubt[i] == 0.0;
            let code = code_of(self.there.reach[i], self.back.reach[i]);
            self.code[i] = if clear { code } else { f64::from(DOUBTFUL) };
            doubtful += u64::from(self.code[i] == f64::from(DOUBTFUL));
        }
        if doubtful > 0 {
            self.one_by_one(block);
        }
    }

    #[inline(never)]
    fn one_by_one(&mut self, block: &Dimensions) {
        for i in 0..BLOCK {
            if self.code[i] != f64::from(DOUBTFUL) {
                continue;
            }
            let [m, n, l1, l2, l3, d, s, c] = block.map(|lane| lane[i]);
            let none = (MotionType::CannotAssemble, Vec::new());
            let found = Rssr::skew([m, n, l1, l2, l3, d], [s, c])
                .ok()
                .map(|linkage| [Input::Crank, Input::Rocker].map(|input| linkage.type_and_limits(input)));
            let [(code, limits), (_, turns)] = found.unwrap_or([none.clone(), none]);
            self.code[i] = f64::from(code as u8);
            let (limits, turns) = (padded(&limits), padded(&turns));
            for k in 0..MOST_LIMITS {
                self.limits[k][i] = limits[k];
                self.turns[k][i] = turns[k];
            }
        }
    }

    /// Whether the input of a linkage turns fully.
    #[inline(always)]
    pub(super) fn input_turns(&self, i: usize) -> bool {
        (self.code[i] == f64::from(MotionType::CrankRocker as u8))
            | (self.code[i] == f64::from(MotionType::DoubleCrank as u8))
    }
}
