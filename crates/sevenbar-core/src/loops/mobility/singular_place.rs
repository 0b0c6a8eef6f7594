//! A pose at which the screws lose rank, and what is left of the closure there.
//!
//! Source: docs/theory.md, (19) and (20).

use super::rank::{self, wrenches};
use crate::loops::equation::closed::{At, Closed, Screws, twist_of};
use crate::loops::equation::dense::{Array, least_squares, length, singular_values};
use crate::stopping;

/// Singular values below this part of the greatest, and this many times the one that is known to vanish near by, vanish there too.
const NEARLY_ZERO: f64 = 1e-3;

const AS_SMALL: f64 = 100.0;

/// Farther than this [rad, or relative to the size] from where it was looked for, a place is another.
const NEAR: f64 = 0.05;

/// Two limits of a joint nearer than this [rad, or relative to the size] are a change point.
pub(crate) const SAME_LIMIT: f64 = 1e-6;

/// Curves that pass each other at more than this [rad, or relative to the size] are followed apart, whatever their limits.
const APART: f64 = 1e-5;

/// Curves that pass each other nearer than this [rad, or relative to the size] are not distinct: a relative change of some 1e-12 in a
/// dimension makes as much, and rounding hides the way between them.
const TOUCHING: f64 = 1e-6;

/// A second-order form below this part of the closure's is none: a redundant constraint's.
const NO_FORM: f64 = 1e-7;

/// Second-order forms in two directions whose determinant is below this part of the form's square have one direction only in which curves
/// may run: these touch.
const ONE_DIRECTION: f64 = 1e-3;

/// A second-order form below this part of the closure's is weak: curves part by what is of higher order.
const WEAK_FORM: f64 = 1e-4;

/// A closure error below this [rad, or relative to the size] is rounding, however weak the form that it is held against.
const NO_VALUE: f64 = 1e-15;

/// Steps of Newton's method; where it converges by halves only, as to a cusp, a place is known to the square root of rounding.
pub(crate) const MOST_STEPS: usize = 40;

/// A step [rad, or relative to the size] below which steps that no longer shrink are rounding, and one above which nothing was found.
pub(crate) const LAST_STEP: f64 = 1e-15;

pub(crate) const STEADY: f64 = 1e-9;

const UNSTEADY: f64 = 1e-6;

/// A part of the greatest slope below which nothing is solved for; the second where no constraint is redundant, as slopes fall with the
/// square of the distance to where curves touch.
const NO_SLOPE: f64 = 1e-9;
const NO_SLOPE_IN_TOUCH: f64 = 1e-12;

/// A place where the screws lose rank, and the closure there.
pub(crate) struct Place<S: Closed> {
    pub at: At<S>,
    /// Free directions, of unit length and square to each other.
    pub free: Vec<S::Columns<f64>>,
    /// The wrenches that see a motion.
    pub seen: Vec<Vec<f64>>,
    /// The value and the second-order form, by rows, of each part of the closure that the screws leave and that is not redundant.
    pub forms: Vec<(f64, Vec<f64>)>,
    /// Closure error that no form explains.
    pub open: f64,
    /// The closure error up to which it is a pose.
    agree: f64,
    /// Whether constraints are redundant, which hide how curves part.
    redundant: bool,
}

impl<S: Closed> Place<S> {
    /// By how much curves pass each other there [rad, or relative to the size], as seen in all columns.
    pub fn passing(&self) -> f64 {
        let passes = |(value, form): &(f64, Vec<f64>)| {
            let norm = form.iter().map(|x| x * x).sum::<f64>().sqrt();
            (2.0 * value.abs() / norm).sqrt()
        };
        let known = self.forms.iter().filter(|(value, _)| value.abs() > NO_VALUE);
        known.map(passes).fold(0.0, f64::max)
    }

    /// How far apart two limits of a column are there, also where they are complex.
    pub fn limits_apart(&self, column: usize) -> f64 {
        let [(value, form)] = self.forms.as_slice() else {
            return 2.0 * self.passing();
        };
        let [x, y] = self.free.as_slice() else {
            return 2.0 * self.passing();
        };
        let determinant = form[0] * form[3] - form[1] * form[2];
        let (a, b) = (x[column], y[column]);
        let bent = (a * a * form[3] - 2.0 * a * b * form[1] + b * b * form[0]) / determinant;
        2.0 * (2.0 * (value * bent).abs()).sqrt()
    }

    /// Whether curves that run through it may touch: the second-order forms do not tell their directions apart.
    pub fn may_touch(&self) -> bool {
        match (self.free.len(), self.forms.as_slice()) {
            _ if self.redundant => false,
            (2, [(_, form)]) => {
                let determinant = form[0] * form[3] - form[1] * form[2];
                let square: f64 = form.iter().map(|x| x * x).sum();
                square < WEAK_FORM * WEAK_FORM || determinant.abs() < ONE_DIRECTION * square
            }
            (free, forms) => forms.len() + 1 < free,
        }
    }

    /// Whether motions lead over it within what redundant constraints may miss each other by: two forms in two free directions have
    /// no curve in common but through the pose itself, so nothing passes near it.
    pub fn is_let_pass(&self) -> bool {
        let values = self.forms.iter().map(|(value, _)| value * value);
        let missed = (self.open * self.open + values.sum::<f64>()).sqrt();
        self.free.len() == 2 && self.forms.len() > 1 && missed < self.agree
    }

    /// Whether it counts as a change point for these columns: it is one, up to rounding, or their limits nearly meet; or nothing
    /// can be followed between curves so near.
    pub fn counts(&self, wished: &[usize], stuck: bool) -> bool {
        let passing = self.passing();
        let limits_meet = || wished.iter().any(|&c| self.limits_apart(c) < SAME_LIMIT);
        self.open < self.agree && (passing < TOUCHING || (passing < APART && (stuck || limits_meet())))
    }
}

/// The screws' first derivatives along rates of the joints.
pub(super) fn carried<S: Closed>(
    chain: &S,
    (at, screws): (&At<S>, &Screws<S>),
    rates: &S::Columns<f64>,
) -> Screws<S> {
    let mut series = [*screws; 2];
    chain.carry(at, &mut series, &[*rates, S::Columns::filled(0.0)], 1);
    series[1]
}

/// The place near a pose where the screws have lost rank, with the closure's slope zero in all directions they leave free.
pub(crate) fn singular_place<S: Closed>(chain: &S, rough: &At<S>) -> Option<Place<S>> {
    let mut at = *rough;
    let (values, _) = singular_values(&chain.screws(&at));
    let least = chain.columns().checked_sub(2)?;
    let zero = (NEARLY_ZERO * values[0]).min(AS_SMALL * values[least]);
    let mut rank = values.iter().filter(|&&v| v > zero).count().min(least);
    // what else vanishes there is known once it is reached
    for _ in 0..S::COLUMNS {
        at = settled_at_rank(chain, &at, rank)?;
        if length(&chain.difference(rough, &at)) > NEAR {
            return None;
        }
        let there = rank::rank(&singular_values(&chain.screws(&at)).0, S::ROWS, chain.no_rank());
        if there > rank {
            return None;
        }
        if there == rank {
            return Some(place_at(chain, &at, rank));
        }
        rank = there;
    }
    None
}

/// Newton's method on the closure that screws of a rank see, and on the slope of what they leave.
pub(super) fn settled_at_rank<S: Closed>(chain: &S, rough: &At<S>, rank: usize) -> Option<At<S>> {
    let mut at = *rough;
    let mut before = f64::INFINITY;
    for _ in 0..MOST_STEPS {
        stopping::piece();
        let placed = chain.place(&at);
        let split = Split::new(chain, &placed.screws, rank);
        let count = split.seen.len() + split.left.len() * split.free.len();
        let mut columns = vec![vec![0.0; count]; chain.columns()];
        let mut right = vec![0.0; count];
        for (r, row) in split.seen.iter().enumerate() {
            right[r] = -power(row, &placed.error);
            for c in 0..chain.columns() {
                columns[c][r] = power(row, &placed.screws[c]);
            }
        }
        for c in 0..chain.columns() {
            let mut unit = S::Columns::filled(0.0);
            unit[c] = 1.0;
            let moved = carried(chain, (&at, &placed.screws), &unit);
            for (f, free) in split.free.iter().enumerate() {
                let bent: S::Rows<f64> = twist_of(&moved, free);
                for (w, row) in split.left.iter().enumerate() {
                    columns[c][split.seen.len() + w * split.free.len() + f] = power(row, &bent);
                }
            }
        }
        for (f, free) in split.free.iter().enumerate() {
            let slope: S::Rows<f64> = twist_of(&placed.screws, free);
            for (w, row) in split.left.iter().enumerate() {
                right[split.seen.len() + w * split.free.len() + f] = -power(row, &slope);
            }
        }
        let zero = if chain.is_redundant() {
            NO_SLOPE
        } else {
            NO_SLOPE_IN_TOUCH
        };
        let step = least_squares(&columns, &right, zero);
        let by: S::Columns<f64> = Array::padded(&step, 0.0);
        let size = length(&by);
        if !size.is_finite() || size > NEAR {
            return None;
        }
        at = chain.moved(&at, &by);
        at.square_up(chain.ball_count());
        let steady = size < LAST_STEP || (size < STEADY && size >= 0.5 * before);
        before = size;
        if steady {
            break;
        }
    }
    (before < UNSTEADY).then_some(at)
}

pub(super) fn place_at<S: Closed>(chain: &S, at: &At<S>, rank: usize) -> Place<S> {
    let placed = chain.place(at);
    let split = Split::new(chain, &placed.screws, rank);
    let count = split.free.len();
    // each wrench's form as a vector, by which redundant ones are distinguished
    let forms: Vec<Vec<f64>> = split
        .left
        .iter()
        .map(|row| {
            let mut form = Vec::with_capacity(count * count);
            for a in &split.free {
                let moved = carried(chain, (at, &placed.screws), a);
                let bent = |b: &S::Columns<f64>| -> S::Rows<f64> { twist_of(&moved, b) };
                form.extend(split.free.iter().map(|b| power(row, &bent(b))));
            }
            form
        })
        .collect();
    let values: Vec<f64> = split.left.iter().map(|row| power(row, &placed.error)).collect();
    let (sizes, mixes) = singular_values(&forms);
    let mut found = Vec::new();
    let mut open = 0.0;
    for (size, mix) in sizes.iter().zip(&mixes) {
        let value: f64 = mix.iter().zip(&values).map(|(m, v)| m * v).sum();
        if *size > NO_FORM.max(chain.no_rank()) {
            let form = (0..count * count)
                .map(|k| mix.iter().zip(&forms).map(|(m, f)| m * f[k]).sum())
                .collect();
            found.push((value, form));
        } else {
            open += value * value;
        }
    }
    Place {
        at: *at,
        free: split.free,
        seen: split.seen,
        forms: found,
        open: f64::sqrt(open),
        agree: chain.agree(),
        redundant: chain.is_redundant(),
    }
}

/// The directions that screws of a rank leave free, and the wrenches that see a motion and those that do not.
pub(super) struct Split<S: Closed> {
    pub free: Vec<S::Columns<f64>>,
    pub seen: Vec<Vec<f64>>,
    pub left: Vec<Vec<f64>>,
}

impl<S: Closed> Split<S> {
    pub fn new(chain: &S, screws: &Screws<S>, rank: usize) -> Self {
        let used = &screws.as_ref()[..chain.columns()];
        let columns: Vec<Vec<f64>> = used.iter().map(|s| s.as_ref().to_vec()).collect();
        let (_, right) = singular_values(&columns);
        let free = right[rank..].iter().map(|v| Array::padded(v, 0.0)).collect();
        let (seen, left) = wrenches(&columns, S::ROWS, rank);
        Self { free, seen, left }
    }
}

pub(crate) fn power<R: Array<f64>>(row: &[f64], twist: &R) -> f64 {
    row.iter().zip(twist.as_ref()).map(|(a, b)| a * b).sum()
}
