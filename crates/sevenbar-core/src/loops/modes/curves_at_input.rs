//! Curves of poses that all close at one input: `e(q) = 0` where the input is held and the other joints still move.
//!
//! A path that leads to such a curve ends nowhere in particular, so none of its poses is among the modes. A rhombus folded flat has one:
//! its coupler and rocker turn about the same point. Where paths are missing, Newton's method from many places searches for such a pose.

use super::many_starts::ON_CURVE;
use super::polish::polish_with_spare;
use crate::loops::equation::chain::{Chain, Configuration};
use crate::loops::equation::closed::{At, Closed};
use crate::loops::equation::dense::{Array, length, singular_values};

/// The least singular value, as a part of the greatest, of joints that can move with the input held.
const STILL_MOVES: f64 = 1e-7;

/// How far along a curve [rad, or relative to the size] another of its poses is searched for.
const ALONG: f64 = 0.02;

/// A pose on a curve of poses that close at this input; `None` where none was found.
pub(super) fn pose_on_curve(chain: &Chain, input: usize, value: f64) -> Option<Configuration> {
    ON_CURVE.first(chain, input, Some(value), |at| {
        runs_on(chain, input, at, |at| chain.screws(at))
    })
}

/// Whether another pose next to this one, in the direction that the held input leaves free, closes and can move as well. At a dead
/// centre, where the screws lose rank too, nothing closes there.
///
/// The screws are those of the columns in use.
pub(crate) fn runs_on<S: Closed>(
    of: &S,
    input: usize,
    at: &At<S>,
    screws: impl Fn(&At<S>) -> Vec<Vec<f64>>,
) -> bool {
    let Some(free) = still_free::<S>(input, screws(at)) else {
        return false;
    };
    [ALONG, -ALONG].iter().any(|step| {
        let rough = of.moved(at, &free.map(|x| x * step));
        polish_with_spare(of, Some(input), &rough).is_some_and(|next| {
            let gone = length(&of.difference(at, &next));
            (0.5 * ALONG..2.0 * ALONG).contains(&gone) && still_free::<S>(input, screws(&next)).is_some()
        })
    })
}

/// The direction of unit length in which the other joints move with the input held, to first order; `None` where they do not.
fn still_free<S: Closed>(input: usize, mut others: Vec<Vec<f64>>) -> Option<S::Columns<f64>> {
    let count = others.len();
    others.remove(input);
    let (values, vectors) = singular_values(&others);
    let (last, greatest) = (*values.last()?, values[0]);
    // more columns than rows leave the last ones free
    (last <= STILL_MOVES * greatest).then(|| {
        let mut free = S::Columns::filled(0.0);
        let passive = (0..count).filter(|&c| c != input);
        for (c, x) in passive.zip(&vectors[vectors.len() - 1]) {
            free[c] = *x;
        }
        free
    })
}
