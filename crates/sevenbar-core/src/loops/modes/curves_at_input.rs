//! Curves of poses that all close at one input: `e(q) = 0` where the input is held and the other joints still move.
//!
//! A path that leads to such a curve ends nowhere in particular, so none of its poses is among the modes. A rhombus folded flat has one:
//! its coupler and rocker turn about the same point. Where paths are missing, Newton's method from many places searches for such a pose.

use super::many_starts::ON_CURVE;
use super::polish::polish_with_spare;
use crate::loops::equation::chain::{Chain, Configuration};
use crate::loops::equation::closed::Closed;
use crate::loops::equation::dense::{COLUMNS, Columns, length, singular_values};

/// The least singular value, as a part of the greatest, of joints that can move with the input held.
const STILL_MOVES: f64 = 1e-7;

/// How far along a curve [rad, or relative to the size] another of its poses is searched for.
const ALONG: f64 = 0.02;

/// A pose on a curve of poses that close at this input; `None` where none was found.
pub(super) fn pose_on_curve(chain: &Chain, input: usize, value: f64) -> Option<Configuration> {
    ON_CURVE.first(chain, input, Some(value), |at| runs_on(chain, input, at))
}

/// Whether another pose next to this one, in the direction that the held input leaves free, closes and can move as well. At a dead
/// centre, where the screws lose rank too, nothing closes there.
fn runs_on(chain: &Chain, input: usize, at: &Configuration) -> bool {
    let Some(free) = still_free(chain, input, at) else {
        return false;
    };
    [ALONG, -ALONG].iter().any(|step| {
        let rough = chain.moved(at, &free.map(|x| x * step));
        polish_with_spare(chain, Some(input), &rough).is_some_and(|next| {
            let gone = length(&chain.difference(at, &next));
            (0.5 * ALONG..2.0 * ALONG).contains(&gone) && still_free(chain, input, &next).is_some()
        })
    })
}

/// The direction of unit length in which the other joints move with the input held, to first order; `None` where they do not.
fn still_free(chain: &Chain, input: usize, at: &Configuration) -> Option<Columns> {
    let mut others = chain.screws(at);
    others.remove(input);
    let (values, vectors) = singular_values(&others);
    let (last, greatest) = (*values.last()?, values[0]);
    // more columns than rows leave the last ones free
    (last <= STILL_MOVES * greatest).then(|| {
        let mut free = [0.0; COLUMNS];
        let mut others = vectors[vectors.len() - 1].iter();
        for (c, x) in free.iter_mut().enumerate().take(chain.columns) {
            if c != input {
                *x = *others.next().unwrap_or(&0.0);
            }
        }
        free
    })
}
