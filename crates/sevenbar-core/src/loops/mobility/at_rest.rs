//! Joints that rest along a motion on which a constraint is met twice over, or nearly so.
//!
//! There two directions `x` are free to first order, and with the other joints solved for the closure reduces to `g(x) = (s x)^2 / 2 + ..`:
//! one square, where curves that cross have two factors. The motion goes along `t` with `s t = 0`, and `g` is at its extreme across it
//! wherever the motion leads. A joint that takes part across it and not along it is at that extreme: held there, it leaves an
//! overconstrained loop of the rank that it has, which is followed like any other.
//!
//! Source: docs/theory.md, (20).

use super::rank::rank;
use super::singular_place::singular_place;
use crate::loops::equation::closed::{At, Closed, Joint};
use crate::loops::equation::dense::{Array, combined, singular_values};
use crate::loops::equation::rotations::short_way;

/// The lesser eigenvalue of a second-order form that is one square, as a part of the greater: rounding, and what curves that touch within
/// rounding leave of it.
const ONE_SQUARE: f64 = 1e-6;

/// Rates of joints along a curve of unit speed below which they rest: rounding by the norm of the inverse where two curves are
/// a millionth apart.
const AT_REST: f64 = 1e-6;

/// Rates across it from which a joint takes part.
const TAKES_PART: f64 = 1e-3;

/// Values of a joint nearer than this [rad, or relative to the size] are one: of curves that are followed apart they differ by more.
const SAME_VALUE: f64 = 1e-8;

/// A joint of the chain that rests, and where [rad, or relative to the size].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Still {
    /// The joint, as the chain counts them.
    pub joint: usize,
    /// Its value.
    pub value: f64,
}

impl Still {
    /// Whether two are one, up to rounding.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        self.joint == other.joint && short_way(self.value - other.value).abs() < SAME_VALUE
    }
}

/// The joints that may rest along a motion through a pose, the one that takes part most first, and the pose to rounding.
pub(crate) fn joints_at_rest<S: Closed>(chain: &S, pose: &At<S>) -> (At<S>, Vec<Still>) {
    let Some((at, [along, across])) = directions(chain, pose) else {
        return (*pose, Vec::new());
    };
    let mut columns: Vec<(usize, usize)> = chain.first().iter().copied().enumerate().collect();
    columns.retain(|&(joint, c)| {
        let single = !matches!(chain.joints()[joint], Joint::Ball(_));
        single && along[c].abs() < AT_REST && across[c].abs() > TAKES_PART
    });
    columns.sort_by(|a, b| across[b.1].abs().total_cmp(&across[a.1].abs()));
    let still = |(joint, c): (usize, usize)| {
        let value = at.values[c];
        let turns = chain.joints()[joint] == Joint::Turn;
        Still { joint, value: if turns { short_way(value) } else { value } }
    };
    (at, columns.into_iter().map(still).collect())
}

/// A pose, the direction of the motion there, and the one across it.
type Directions<S> = (At<S>, [<S as Closed>::Columns<f64>; 2]);

/// The pose to rounding, the direction of the motion there, and the one across it in which the closure is least seen.
fn directions<S: Closed>(chain: &S, pose: &At<S>) -> Option<Directions<S>> {
    if let Some(place) = singular_place(chain, pose).filter(|place| place.counts(&[], false)) {
        let ([a, b], [(_, form)]) = (place.free.as_slice(), place.forms.as_slice()) else {
            return None;
        };
        let square: f64 = form.iter().map(|x| x * x).sum();
        let determinant = form[0] * form[3] - form[1] * form[2];
        if determinant.abs() > ONE_SQUARE * square {
            return None;
        }
        let s = if form[0].abs() > form[3].abs() {
            [form[0], form[1]]
        } else {
            [form[2], form[3]]
        };
        let size = s[0].hypot(s[1]);
        let [x, y] = s.map(|x| x / size);
        return Some((place.at, [combined(a, -y, b, x), combined(a, x, b, y)]));
    }
    let (values, vectors) = singular_values(&chain.screws(pose));
    if chain.columns() < 2 || rank(&values, S::ROWS, chain.no_rank()) + 1 != chain.columns() {
        return None;
    }
    let direction = |n: usize| Array::padded(&vectors[chain.columns() - n], 0.0);
    Some((*pose, [direction(1), direction(2)]))
}
