//! Poses at which a motion is not smooth, and every way out of them.
//!
//! Where the screws lose rank, `k` directions `K` are free to first order and wrenches `W` do not see them. With the other joints
//! solved for, what is left of the closure is `g(x) = W e(q(x)) = b + x H x / 2 + ..`, `x` in the plane of `K`. The pose itself is where
//! the slope of `g` is zero: Newton's method with second derivatives of the closure finds it to rounding, also where `b` is not zero and
//! two curves pass each other by a hair. The ways out are the solutions of the closure on a small sphere about it: as many as there are,
//! however they touch, and none where the pose stands alone.
//!
//! Source: docs/theory.md, (19) to (22).

use super::curve::{Curve, Node};
use super::follow::{Start, Stop};
use crate::loops::equation::chain::{Chain, Configuration};
use crate::loops::equation::dense::{COLUMNS, Columns, dot, least_squares, length, singular_values};
use crate::loops::equation::rotations::squared_up;
use crate::loops::mobility::singular_place::{LAST_STEP, MOST_STEPS, Place, STEADY, singular_place};
use crate::loops::modes::polish::CLOSED;
use crate::random::Random;

/// Curves are cut this far [rad, or relative to the size] from the pose: farther in rounding turns their tangents by more than the way bends.
const CUT: f64 = 2e-5;

/// Curves that pass at a distance are cut so many times as far out, where both are straight.
const CUT_TIMES: f64 = 30.0;

/// Norm of the screws' inverse at which curves are cut where it grows faster than usual, as where three of them touch: beyond, rounding
/// hides them from each other.
const HIDDEN: f64 = 1e7;

/// Radii of the sphere, the next where curves do not run straight into the pose from the one before [rad, or relative to the size].
const RADII: [f64; 4] = [1e-2, 2e-3, 4e-4, 8e-5];

/// A sphere's radius is at least so many times the distance at which curves are cut, and at most this, where what redundant constraints
/// miss each other by keeps curves far apart [rad, or relative to the size].
const LEAST_RADIUS: f64 = 3.0;
const WIDEST: f64 = 0.05;

/// Directions tried on the circle of two free directions, and for each further one so many times as many.
const DIRECTIONS: usize = 48;
const MORE_DIRECTIONS: usize = 6;

/// Directions that lead nowhere before the others are given up.
const MOST_IN_VAIN: usize = 288;

/// Seen from the pose, places on spheres of half the radius may differ by so much, and by so little a curve is straight.
const MOST_BENT: f64 = 0.2;
const STRAIGHT: f64 = 1e-6;

/// Ways out that differ by less than this part of the radius are one.
const SAME_WAY: f64 = 1e-5;

/// Tangents at the pose that differ by less than this from opposite ones belong to one smooth curve.
const OPPOSITE: f64 = 0.03;

/// A pose this many times as far from a change point as curves are cut there still is at it.
pub(super) const AT_POINT: f64 = 3.0;

/// Steps on a sphere that are longer than this part of its radius after so many of them lead nowhere.
const WANDERING_AFTER: usize = 15;
const WANDERING: f64 = 1e-2;

/// A closure error [rad, or relative to the size] up to which it is rounding; a part of the distance from a pose, and the part of the error
/// up to which the loop is only shaky where so much is left there: 1/64 by the second order. What redundant constraints miss each other by
/// may fall, too, but as the distance: to 1/8.
const ROUNDED: f64 = 1e-13;
const NEARER: f64 = 0.125;
const LEAST_FALL: f64 = 0.042;

/// A singular value below this part of the radius and of the greatest is a freedom all along.
const NO_FREEDOM: f64 = 1e-4;

/// A way out of a pose.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ray {
    /// Its place on the sphere, and the direction outwards there.
    pub start: Start,
    /// Seen from the pose, the places on the sphere and on the one of half its radius, relative to the radius.
    seen: [Columns; 2],
    /// How near to the pose it can be followed [rad, or relative to the size].
    hidden: f64,
}

/// A pose at which the motion is not smooth.
#[derive(Clone, Debug)]
pub(crate) struct ChangePoint {
    pub at: Configuration,
    pub rays: Vec<Ray>,
    /// For each ray the one that continues it smoothly.
    pub partner: Vec<Option<usize>>,
    /// Where curves are cut that run into it.
    pub cut: f64,
    /// The most freedoms of the motions out of it: none where it stands alone, two or more where it lies on a surface.
    pub finite: usize,
}

/// The change point at or near a pose, if there is one, as the wished columns have it; `stuck` where a walk can go no farther.
pub(super) fn change_point(
    chain: &Chain,
    rough: &Configuration,
    wished: &[usize],
    stuck: bool,
) -> Option<ChangePoint> {
    let place = singular_place(chain, rough)?;
    let counts = place.counts(wished, stuck);
    let let_pass = stuck && place.is_let_pass();
    if !(counts || let_pass) {
        return None;
    }
    let cut = CUT.max(CUT_TIMES * place.passing());
    let mut found = ChangePoint { at: place.at, rays: Vec::new(), partner: Vec::new(), cut, finite: 0 };
    let least = LEAST_RADIUS * cut;
    let mut radii: Vec<f64> = RADII.into_iter().filter(|&r| r > least).collect();
    if radii.is_empty() {
        if least > WIDEST {
            return None;
        }
        radii.push(least);
    }
    for radius in radii {
        let (ways, finite) = ways_out(chain, &place, radius);
        found.finite = finite;
        let rays: Vec<Ray> = ways
            .iter()
            .filter_map(|at| ray(chain, &place, at, radius))
            .collect();
        let straight = rays.len() == ways.len();
        if straight || rays.len() > found.rays.len() {
            found.rays = rays;
        }
        if straight {
            break;
        }
    }
    // what is only let pass is no isolated pose
    if !counts && found.rays.is_empty() {
        return None;
    }
    found.partner = partners(&found.rays);
    let hidden = found.rays.iter().map(|r| r.hidden).fold(0.0, f64::max);
    if hidden < RADII[0] / LEAST_RADIUS {
        found.cut = found.cut.max(hidden);
    }
    Some(found)
}

/// Whether a place on a sphere closes only because it is near: nearer far less is left open. On a motion what is left
/// is rounding, or what redundant constraints miss each other by: the same everywhere, or by the first order less.
fn opens_with_distance(chain: &Chain, place: &Place, at: &Configuration, radius: f64) -> bool {
    let open = |at: &Configuration| chain.residual(&chain.place(at));
    let inward = chain.difference(&place.at, at).map(|x| x / radius);
    open(at) > ROUNDED
        && on_sphere(chain, place, &inward, NEARER * radius)
            .is_some_and(|nearer| open(&nearer) < LEAST_FALL * open(at))
}

/// Where curves cut a sphere about a place, each once, and the most freedoms found on it: surfaces have no ways to tell apart, but
/// curves may run into them.
fn ways_out(chain: &Chain, place: &Place, radius: f64) -> (Vec<Configuration>, usize) {
    let mut found: Vec<Configuration> = Vec::new();
    let mut finite = 0;
    for (tried, direction) in directions(place).into_iter().enumerate() {
        if tried == MOST_IN_VAIN && found.is_empty() && finite == 0 {
            break;
        }
        let Some(at) = on_sphere(chain, place, &direction, radius) else {
            continue;
        };
        let known = |f: &Configuration| length(&chain.difference(f, &at)) < SAME_WAY * radius;
        if found.iter().any(known) || opens_with_distance(chain, place, &at, radius) {
            continue;
        }
        let (values, _) = singular_values(&chain.screws(&at));
        let rank = values
            .iter()
            .take(6)
            .filter(|&&v| v > NO_FREEDOM * radius * values[0])
            .count();
        let freedoms = chain.columns - rank;
        finite = finite.max(freedoms);
        if freedoms == 1 {
            found.push(at);
        }
        // all that is free there is one surface's
        if freedoms > 1 && freedoms == place.free.len() {
            break;
        }
    }
    (found, finite)
}

/// The solution of the closure at a distance from a place that Newton's method finds from a direction.
fn on_sphere(chain: &Chain, place: &Place, direction: &Columns, radius: f64) -> Option<Configuration> {
    let mut at = chain.moved(&place.at, &direction.map(|x| x * radius));
    let mut before = f64::INFINITY;
    for step in 0..MOST_STEPS {
        let placed = chain.place(&at);
        let off = chain.difference(&place.at, &at);
        let seen: Vec<f64> = place.free.iter().map(|f| dot(f, &off)).collect();
        let distance = seen.iter().map(|x| x * x).sum::<f64>().sqrt();
        if !(distance > 0.1 * radius && length(&off) < 3.0 * radius) {
            return None;
        }
        let mut outward = [0.0; COLUMNS];
        for (x, free) in seen.iter().zip(&place.free) {
            for c in 0..COLUMNS {
                outward[c] += x / distance * free[c];
            }
        }
        let columns: Vec<Vec<f64>> = (0..chain.columns)
            .map(|c| {
                let mut column = placed.screws[c].to_vec();
                column.push(outward[c]);
                column
            })
            .collect();
        let mut right: Vec<f64> = placed.error.iter().map(|e| -e).collect();
        right.push(radius - distance);
        let mut by = [0.0; COLUMNS];
        by[..chain.columns].copy_from_slice(&least_squares(&columns, &right, chain.no_rank()));
        let size = length(&by);
        // where curves touch, steps halve at least
        if !size.is_finite() || (step >= WANDERING_AFTER && size > WANDERING * radius) {
            return None;
        }
        // no farther than the sphere is large, and so never across it
        let factor = (0.3 * radius / size).min(1.0);
        at = chain.moved(&at, &by.map(|x| x * factor));
        for ball in &mut at.balls {
            *ball = squared_up(ball);
        }
        let steady = size < LAST_STEP || (size < STEADY && size >= 0.5 * before);
        before = size;
        if steady {
            break;
        }
    }
    let closed = if chain.is_redundant() { chain.agree } else { CLOSED };
    (before < STEADY && chain.residual(&chain.place(&at)) < closed).then_some(at)
}

/// The way out through a place on the sphere; none where its curve does not run straight into the pose.
fn ray(chain: &Chain, place: &Place, at: &Configuration, radius: f64) -> Option<Ray> {
    let mut outer = *at;
    let mut seen = [[0.0; COLUMNS]; 3];
    for (k, seen) in seen.iter_mut().enumerate() {
        let scale = 1.0 / (radius * 0.5_f64.powi(k as i32));
        *seen = chain.difference(&place.at, &outer).map(|x| x * scale);
        if k < 2 {
            outer = on_sphere(chain, place, seen, 0.5 / scale)?;
        }
    }
    let apart = |a: &Columns, b: &Columns| length(&std::array::from_fn(|c| a[c] - b[c]));
    let (first, second) = (apart(&seen[0], &seen[1]), apart(&seen[1], &seen[2]));
    // asymptotes are left by the square of the distance at which curves pass
    let passing = 4.0 * place.passing() / radius;
    if first > MOST_BENT || second > 0.75 * first + STRAIGHT + 2.0 * passing * passing {
        return None;
    }
    let (values, vectors) = singular_values(&chain.screws(at));
    let mut direction = [0.0; COLUMNS];
    direction[..chain.columns].copy_from_slice(&vectors[chain.columns - 1]);
    if dot(&direction, &seen[0]) < 0.0 {
        direction = direction.map(|x| -x);
    }
    // the norm grows as a power of the distance; `outer` is at a quarter of it now
    let norm = |values: &[f64]| values[chain.columns - 2].recip();
    let (far, near) = (norm(&values), norm(&singular_values(&chain.screws(&outer)).0));
    let power = ((near / far).log2() / 2.0).max(1.0);
    let hidden = radius * (far / HIDDEN).powf(1.0 / power);
    Some(Ray { start: (*at, direction), seen: [seen[0], seen[1]], hidden })
}

impl Ray {
    /// The tangent at the pose, outwards.
    pub fn tangent(&self) -> Columns {
        let t: Columns = std::array::from_fn(|c| 2.0 * self.seen[1][c] - self.seen[0][c]);
        let size = length(&t);
        t.map(|x| x / size)
    }

    /// How far two ways out are from being one smooth curve: their tangents, then their bends.
    fn mismatch(&self, other: &Self) -> (f64, f64) {
        let (a, b) = (self.tangent(), other.tangent());
        let kink = length(&std::array::from_fn(|c| a[c] + b[c]));
        // twice the bend of each, which a smooth curve has in common
        let bend = |ray: &Self, c: usize| ray.seen[0][c] - ray.seen[1][c];
        (
            kink,
            length(&std::array::from_fn(|c| bend(self, c) - bend(other, c))),
        )
    }
}

impl ChangePoint {
    /// Whether a curve passes it, or ends there.
    pub fn is_on(&self, chain: &Chain, curve: &Curve) -> bool {
        let near = |n: &Node| length(&chain.difference(&self.at, &n.at)) < AT_POINT * self.cut;
        let last = curve.nodes.len() - 1;
        curve.nodes.iter().any(|n| n.is_crossing() && near(n))
            || near(&curve.nodes[0])
            || near(&curve.nodes[last])
    }

    /// Where walks end that run into it.
    pub fn stop(&self) -> Stop {
        Stop { at: self.at, radius: self.cut }
    }
}

/// For each way out the one that continues it smoothly, nearest in tangent and bend first.
fn partners(rays: &[Ray]) -> Vec<Option<usize>> {
    let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
    for i in 0..rays.len() {
        for j in i + 1..rays.len() {
            let (kink, bend) = rays[i].mismatch(&rays[j]);
            if kink < OPPOSITE {
                pairs.push((kink + bend, i, j));
            }
        }
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut partner = vec![None; rays.len()];
    for (_, i, j) in pairs {
        if partner[i].is_none() && partner[j].is_none() {
            (partner[i], partner[j]) = (Some(j), Some(i));
        }
    }
    // the two arms of a cusp
    if let [a @ None, b @ None] = partner.as_mut_slice() {
        (*a, *b) = (Some(1), Some(0));
    }
    partner
}

/// Unit vectors in the free directions of a place from which Newton's method begins.
fn directions(place: &Place) -> Vec<Columns> {
    let count = place.free.len();
    let combined = |weights: &[f64]| {
        let size = weights.iter().map(|w| w * w).sum::<f64>().sqrt();
        let mut out = [0.0; COLUMNS];
        for (w, free) in weights.iter().zip(&place.free) {
            for c in 0..COLUMNS {
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
