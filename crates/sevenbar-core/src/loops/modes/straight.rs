//! Solutions of the closure while its parameters move on straight lines, from one closure to another.
//!
//! Where only the input differs they stay within one linkage; but see [`super::circle`].
//!
//! Source: docs/theory.md, (6).

use super::continuation::{FIRST_STEP, Homotopy, Pace, Place, ROUNDING, Way, follow, one_step};
use crate::loops::equation::closure::{
    JOINTS, Linear, Parameters, Slides, Solution, UNKNOWNS, cosine_sine, cross, turn,
};
use crate::loops::equation::lanes::Lanes;
use crate::vectors::Vector;
use num_complex::Complex64;

/// Twists, shifts, turns and the input's slide go from the one to the other while the parameter goes from 0 to 1.
pub(super) struct Straight<'a> {
    pub slides: &'a Slides,
    pub from: &'a Parameters,
    pub to: &'a Parameters,
}

/// Where the solutions of one closure lead to another; `None` where a path does not arrive at a finite regular solution.
pub(super) fn carried(
    slides: &Slides,
    from: &Parameters,
    to: &Parameters,
    starts: &[Solution],
    pace: Pace,
) -> Vec<Option<Solution>> {
    let starts: Vec<Place> = starts.iter().map(|x| Place::start(x, Complex64::ZERO)).collect();
    let way = Way {
        direction: Complex64::ONE,
        length: 1.0,
        end: Complex64::ONE,
        settle: true,
    };
    let ends = follow(&Straight { slides, from, to }, &starts, &[&[way]], pace);
    ends.iter()
        .map(|end| end.as_ref().map(|place| *place.solution()))
        .collect()
}

/// The parameters on the straight line from some to others, these being at 1.
pub(super) fn along(from: &Parameters, to: &Parameters, at: Complex64) -> Parameters {
    let between = |a: Complex64, b: Complex64| a + (b - a) * at;
    Parameters {
        twists: std::array::from_fn(|i| between(from.twists[i], to.twists[i])),
        shifts: std::array::from_fn(|i| std::array::from_fn(|k| between(from.shifts[i][k], to.shifts[i][k]))),
        turns: std::array::from_fn(|i| between(from.turns[i], to.turns[i])),
        slide: between(from.slide, to.slide),
    }
}

/// Where the solutions of one closure lead to another near by: in one step, where that will do; without those that do not arrive.
pub(super) fn carried_near(
    slides: &Slides,
    from: &Parameters,
    to: &Parameters,
    starts: &[Solution],
) -> Vec<Solution> {
    let far = along(from, to, Complex64::from(1.0 / FIRST_STEP));
    one_step(&Straight { slides, from, to: &far }, starts)
}

impl Homotopy for Straight<'_> {
    #[inline(always)]
    fn slides(&self) -> &Slides {
        self.slides
    }

    /// What stands still or is zero is left out.
    #[inline(always)]
    fn linearise<V: Vector, const DRIFT: bool>(&self, x: &[Lanes<V>; UNKNOWNS], at: Lanes<V>) -> Linear<V> {
        let t = at.re;
        let zero = Lanes::<V>::zero();
        let one = Lanes::<V>::one();
        let mut rows = [[zero; UNKNOWNS]; UNKNOWNS];
        let mut ex = [one, zero, zero];
        let mut ey = [zero, one, zero];
        let mut ez = [zero, zero, one];
        let mut place = [zero; 3];
        let mut drift_turn = [zero; 3];
        let mut drift_shift = [zero; 3];
        let moving = |a: Complex64, b: Complex64| {
            let rate = Lanes::<V>::splat(b - a);
            (Lanes::splat(a).plus_scaled(rate, t), rate)
        };
        for i in 0..JOINTS {
            let moment = cross(&place, &ez);
            let given = i == UNKNOWNS || self.slides[i];
            let turn_now = if given {
                if i < UNKNOWNS {
                    for k in 0..3 {
                        rows[k + 3][i] = ez[k];
                    }
                }
                let (z, rate) = moving(self.from.turns[i], self.to.turns[i]);
                if DRIFT && self.from.turns[i] != self.to.turns[i] {
                    let angular = (rate * z.recip()).times_i();
                    for k in 0..3 {
                        drift_turn[k] = drift_turn[k].minus_product(ez[k], angular);
                        drift_shift[k] = drift_shift[k].minus_product(moment[k], angular);
                    }
                }
                z
            } else {
                for k in 0..3 {
                    rows[k][i] = ez[k];
                    rows[k + 3][i] = moment[k];
                }
                x[i]
            };
            let (cosine, sine, _) = cosine_sine(turn_now);
            turn(&mut ex, &mut ey, cosine, sine);
            if i == UNKNOWNS {
                let (slide, rate) = moving(self.from.slide, self.to.slide);
                for k in 0..3 {
                    place[k] = place[k].plus_product(ez[k], slide);
                    drift_shift[k] = drift_shift[k].plus_product(ez[k], rate);
                }
            } else if self.slides[i] {
                for k in 0..3 {
                    place[k] = place[k].plus_product(ez[k], x[i]);
                }
            }
            for (j, axis) in [&ex, &ey, &ez].into_iter().enumerate() {
                let (from, to) = (self.from.shifts[i][j], self.to.shifts[i][j]);
                if from == to && from == Complex64::ZERO {
                    continue;
                }
                let (shift, rate) = moving(from, to);
                for k in 0..3 {
                    place[k] = place[k].plus_product(axis[k], shift);
                }
                if DRIFT && from != to {
                    for k in 0..3 {
                        drift_shift[k] = drift_shift[k].plus_product(axis[k], rate);
                    }
                }
            }
            let (w, rate) = moving(self.from.twists[i], self.to.twists[i]);
            let (cosine, sine, inverse) = cosine_sine(w);
            if DRIFT && self.from.twists[i] != self.to.twists[i] {
                let angular = (rate * inverse).times_i();
                let moment = cross(&place, &ex);
                for k in 0..3 {
                    drift_turn[k] = drift_turn[k].minus_product(ex[k], angular);
                    drift_shift[k] = drift_shift[k].minus_product(moment[k], angular);
                }
            }
            turn(&mut ey, &mut ez, cosine, sine);
        }
        let mut error = [
            (ey[2] - ez[1]).scale(V::splat(0.5)),
            (ez[0] - ex[2]).scale(V::splat(0.5)),
            (ex[1] - ey[0]).scale(V::splat(0.5)),
            place[0],
            place[1],
            place[2],
        ];
        let mut drift = [zero; UNKNOWNS];
        for k in 0..3 {
            drift[k] = -drift_turn[k];
            drift[k + 3] = -drift_shift[k];
        }
        for k in 0..6 {
            let unknown = Lanes { re: V::splat(ROUNDING * (k + 1) as f64), im: V::splat(0.0) };
            error[k] = unknown - error[k];
        }
        Linear { rows, error, drift }
    }
}
