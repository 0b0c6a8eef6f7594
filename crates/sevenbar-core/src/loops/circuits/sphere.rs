//! The solutions of the closure on a small sphere about a pose: what leads out of it, however curves touch there.
//!
//! Source: docs/theory.md, (19) to (22).

use crate::loops::equation::closed::{At, Closed, Placed};
use crate::loops::equation::dense::{Array, dot, least_squares, length, singular_values};
use crate::loops::mobility::singular_place::{LAST_STEP, MOST_STEPS, Place, STEADY, power};
use crate::loops::modes::polish::CLOSED;
use crate::random::Random;
use crate::stopping;

/// Radii of the sphere [rad, or relative to the size], tried in turn until all curves run straight from the sphere into the pose.
pub(super) const RADII: [f64; 4] = [1e-2, 2e-3, 4e-4, 8e-5];

/// Directions tried on the circle of two free directions, and the factor for each further free direction.
const DIRECTIONS: usize = 48;
const MORE_DIRECTIONS: usize = 6;

/// If none of the first directions, this many, leads to a solution, the others are not tried.
const MOST_IN_VAIN: usize = 288;

/// Ways out that are closer to each other than this part of the radius are the same.
const SAME_WAY: f64 = 1e-5;

/// Newton's method on a sphere is given up if a step is still longer than this part of the radius after this many steps.
const WANDERING_AFTER: usize = 15;
const WANDERING: f64 = 1e-2;

/// Longest step of Newton's method on a sphere [parts of the radius]: it cannot cross the sphere.
const LONGEST_STEP: f64 = 0.3;

/// Where curves may touch, the first steps of Newton's method close only what is seen to first order, and keep the direction: the
/// rest is of a higher order than the error with which a start closes.
const FIRST_STEPS: usize = 3;

/// Newton's method has left the sphere's neighbourhood where the free directions carry less than the first part of the radius, or the
/// pose is farther off than the second [parts of the radius].
const INNERMOST: f64 = 0.1;
const OUTERMOST: f64 = 3.0;

/// A closure error up to this is rounding [rad, or relative to the size].
const ROUNDED: f64 = 1e-13;

/// Test of an infinitesimal freedom: at this part of the radius the closure error falls to 1/64, being of second order. The error of
/// redundant constraints that disagree falls at most in proportion to the radius, to 1/8. `LEAST_FALL` lies between the two.
const NEARER: f64 = 0.125;
const LEAST_FALL: f64 = 0.042;

/// On a sphere, a singular value counts as zero below the first times the radius and the greatest singular value. So small that this is
/// the second, rounding may hide that curves meet twice all along: such a value is that part of the greatest.
const NO_FREEDOM: f64 = 1e-4;
const NO_FREEDOM_AT_ALL: f64 = 1e-7;

/// On a sphere, how far from a solution with more freedoms another is searched for, and how far off it must be [parts of the radius], to
/// belong to a surface. Where curves coincide Newton's method comes back.
const ASIDE: f64 = 0.1;
const SURFACE: f64 = 0.05;

/// Ways out that cannot be followed are one where they are nearer to each other than this part of the radius: the place where curves
/// coincide is known to the square root of rounding.
const SAME_LOST_WAY: f64 = 1e-2;

/// Ways out whose directions have a greater cosine, either way, are along one line; on a surface directions are tried all round.
const ONE_LINE: f64 = 0.95;

/// So many on one line are no surface, on which each direction leads to a pose of its own: of the directions on a circle these are
/// an eighth of a turn.
const ENOUGH_ON_LINE: usize = 6;

/// What leads out of a place.
pub(super) struct Ways<S: Closed> {
    /// The poses at which curves cut a sphere about it, each once.
    pub single: Vec<At<S>>,
    /// The same of curves that coincide.
    pub lost: Vec<At<S>>,
    /// The greatest mobility found on the sphere.
    pub finite: usize,
}

/// What leads over a sphere about a place. A surface has no separate ways out, but curves may run into it.
pub(super) fn ways_out<S: Closed>(chain: &S, place: &Place<S>, radius: f64) -> Ways<S> {
    let mut found = Ways { single: Vec::new(), lost: Vec::new(), finite: 0 };
    let near = |known: &[At<S>], at: &At<S>, part: f64| {
        let near = |f: &At<S>| length(&chain.difference(f, at)) < part * radius;
        known.iter().any(near)
    };
    // how often the same of those that coincide
    let mut again = 0;
    for (tried, direction) in directions(place).into_iter().enumerate() {
        if tried == MOST_IN_VAIN && found.single.is_empty() && found.finite == 0 {
            break;
        }
        let Some(at) = on_sphere(chain, place, &direction, radius) else {
            continue;
        };
        if near(&found.single, &at, SAME_WAY) || opens_with_distance(chain, place, &at, radius) {
            continue;
        }
        let redundant = chain.is_redundant();
        if near(&found.lost, &at, SAME_LOST_WAY) {
            again += 1;
            if redundant && again == ENOUGH_ON_LINE && found.single.is_empty() {
                break;
            }
            continue;
        }
        let (values, vectors) = singular_values(&chain.screws(&at));
        let least = if redundant {
            f64::INFINITY
        } else {
            NO_FREEDOM_AT_ALL
        };
        let zero = least.min(NO_FREEDOM * radius) * values[0];
        let rank = values.iter().take(S::ROWS).filter(|&&v| v > zero).count();
        let freedoms = chain.columns() - rank;
        if freedoms == 1 {
            found.single.push(at);
        } else if !redundant && !is_on_surface(chain, place, &at, &vectors[rank..], radius) {
            found.lost.push(at);
        } else if freedoms == place.free.len() {
            let way = chain.difference(&place.at, &at);
            let along = |known: &At<S>| {
                let first = chain.difference(&place.at, known);
                dot(&first, &way).abs() > ONE_LINE * length(&first) * length(&way)
            };
            if !redundant || !found.lost.first().is_none_or(along) {
                // one surface accounts for all free directions
                found.finite = freedoms;
                if redundant {
                    found.lost.clear();
                }
                break;
            }
            // a motion along which a constraint is met twice over has as many free directions, and goes one way only
            found.lost.push(at);
        } else {
            found.finite = found.finite.max(freedoms);
            continue;
        }
        found.finite = found.finite.max(1);
    }
    found
}

/// Whether a pose on a sphere closes only because it is near: its closure error falls with the square of the distance. Along a real
/// motion the closure error is rounding, or that of redundant constraints, which is constant or falls in proportion.
fn opens_with_distance<S: Closed>(chain: &S, place: &Place<S>, at: &At<S>, radius: f64) -> bool {
    let open = |at: &At<S>| chain.residual(&chain.place(at));
    // so far out nothing closes that is no motion, unless constraints are redundant
    if radius >= RADII[0] && !chain.is_redundant() {
        return false;
    }
    let inward = chain.difference(&place.at, at).map(|x| x / radius);
    open(at) > ROUNDED
        && on_sphere(chain, place, &inward, NEARER * radius)
            .is_some_and(|nearer| open(&nearer) < LEAST_FALL * open(at))
}

/// Whether there are other solutions next to one on a sphere, in a direction that is free there.
fn is_on_surface<S: Closed>(chain: &S, place: &Place<S>, at: &At<S>, free: &[Vec<f64>], radius: f64) -> bool {
    let off = chain.difference(&place.at, at);
    let distance = length(&off);
    let along = |v: &[f64]| v.iter().zip(off.as_ref()).map(|(a, b)| a * b).sum::<f64>() / distance;
    // the freest direction along the sphere
    let Some(least) = free
        .iter()
        .min_by(|a, b| along(a).abs().total_cmp(&along(b).abs()))
    else {
        return false;
    };
    let outward = along(least) / distance;
    let start: S::Columns<f64> = Array::from_fn(|c| {
        let aside = least.get(c).map_or(0.0, |x| x - outward * off[c]);
        off[c] / radius + ASIDE * aside
    });
    on_sphere(chain, place, &start, radius)
        .is_some_and(|other| length(&chain.difference(at, &other)) > SURFACE * radius)
}

/// The solution of the closure at distance `radius` from a place that Newton's method finds, starting in a direction.
pub(super) fn on_sphere<S: Closed>(
    chain: &S,
    place: &Place<S>,
    direction: &S::Columns<f64>,
    radius: f64,
) -> Option<At<S>> {
    let mut at = chain.moved(&place.at, &direction.map(|x| x * radius));
    let mut before = f64::INFINITY;
    let first = if place.may_touch() { FIRST_STEPS } else { 0 };
    for step in 0..MOST_STEPS {
        stopping::piece();
        let placed = chain.place(&at);
        let off = chain.difference(&place.at, &at);
        let seen: Vec<f64> = place.free.iter().map(|f| dot(f, &off)).collect();
        let distance = seen.iter().map(|x| x * x).sum::<f64>().sqrt();
        if !(distance > INNERMOST * radius && length(&off) < OUTERMOST * radius) {
            return None;
        }
        let (columns, right) = if step < first {
            let aimed: Vec<f64> = place.free.iter().map(|f| radius * dot(f, direction)).collect();
            along(chain, place, &placed, &seen, &aimed)
        } else {
            let mut outward = S::Columns::filled(0.0);
            for (x, free) in seen.iter().zip(&place.free) {
                for c in 0..S::COLUMNS {
                    outward[c] += x / distance * free[c];
                }
            }
            let column = |c: usize| {
                placed.screws[c]
                    .as_ref()
                    .iter()
                    .copied()
                    .chain([outward[c]])
                    .collect()
            };
            let right = placed
                .error
                .as_ref()
                .iter()
                .map(|e| -e)
                .chain([radius - distance]);
            ((0..chain.columns()).map(column).collect(), right.collect())
        };
        let by: S::Columns<f64> = Array::padded(&least_squares(&columns, &right, chain.no_rank()), 0.0);
        let size = length(&by);
        // where curves touch, each step is at most half the one before
        if !size.is_finite() || (step >= WANDERING_AFTER && size > WANDERING * radius) {
            return None;
        }
        let factor = (LONGEST_STEP * radius / size).min(1.0);
        at = chain.moved(&at, &by.map(|x| x * factor));
        at.square_up(chain.ball_count());
        let steady = size < LAST_STEP || (size < STEADY && size >= 0.5 * before);
        before = size;
        if steady && step >= first {
            break;
        }
    }
    let closed = if chain.is_redundant() {
        chain.agree()
    } else {
        CLOSED
    };
    (before < STEADY && chain.residual(&chain.place(&at)) < closed).then_some(at)
}

/// The equations of a step that closes what is seen to first order at a place, and takes what is free from `seen` to where it is `aimed`.
fn along<S: Closed>(
    chain: &S,
    place: &Place<S>,
    placed: &Placed<S>,
    seen: &[f64],
    aimed: &[f64],
) -> (Vec<Vec<f64>>, Vec<f64>) {
    let column = |c: usize| {
        let powers = place.seen.iter().map(|row| power(row, &placed.screws[c]));
        powers.chain(place.free.iter().map(|f| f[c])).collect()
    };
    let left = place.seen.iter().map(|row| -power(row, &placed.error));
    let right = left.chain(aimed.iter().zip(seen).map(|(a, s)| a - s));
    ((0..chain.columns()).map(column).collect(), right.collect())
}

/// Unit vectors in the free directions of a place from which Newton's method begins.
fn directions<S: Closed>(place: &Place<S>) -> Vec<S::Columns<f64>> {
    let count = place.free.len();
    let combined = |weights: &[f64]| {
        let size = weights.iter().map(|w| w * w).sum::<f64>().sqrt();
        let mut out = S::Columns::filled(0.0);
        for (w, free) in weights.iter().zip(&place.free) {
            for c in 0..S::COLUMNS {
                out[c] += w / size * free[c];
            }
        }
        out
    };
    if count == 2 {
        return (0..DIRECTIONS)
            .map(|k| {
                let angle = std::f64::consts::TAU * (k as f64 + 0.31) / DIRECTIONS as f64;
                combined(&[angle.cos(), angle.sin()])
            })
            .collect();
    }
    let mut random = Random(0xd1_5ec7);
    (0..DIRECTIONS * MORE_DIRECTIONS.pow(count.saturating_sub(2).min(2) as u32))
        .map(|_| {
            // a sum of uniform numbers is as good as normal here
            let mut normal = || (0..6).map(|_| random.uniform()).sum::<f64>() - 3.0;
            let weights: Vec<f64> = (0..count).map(|_| normal()).collect();
            combined(&weights)
        })
        .collect()
}
