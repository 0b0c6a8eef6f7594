//! Poses at which a motion is not smooth, and every way out of them.
//!
//! Where the matrix of screws loses rank, `k` directions `K` are free to first order, and the wrenches `W` do no work on any joint. With
//! the other joints solved for, the closure reduces to `g(x) = W e(q(x)) = b + x H x / 2 + ..` with `x` in the space of `K`. The pose is
//! where the slope of `g` is zero. Newton's method with second derivatives of the closure finds it to rounding, even where `b` is not
//! zero and two curves narrowly miss each other. The ways out are the solutions of the closure on a small sphere about it. This finds
//! all of them however they touch, and none if the pose is isolated.
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
use crate::stopping;

/// Distance from the pose at which curves are cut [rad, or relative to the size]. Closer in, rounding turns their tangents by more than
/// the curves bend.
const CUT: f64 = 2e-5;

/// Two curves that miss each other are cut at this many times the distance between them, where both are straight.
const CUT_TIMES: f64 = 30.0;

/// Norm of the inverse of the screws' matrix at which curves are cut where it grows faster than usual, as where three curves touch. At a
/// greater norm, rounding hides the curves from each other.
const HIDDEN: f64 = 1e7;

/// Radii of the sphere [rad, or relative to the size], tried in turn until all curves run straight from the sphere into the pose.
const RADII: [f64; 4] = [1e-2, 2e-3, 4e-4, 8e-5];

/// A sphere's radius is at least this many times the distance at which curves are cut.
const LEAST_RADIUS: f64 = 3.0;

/// The greatest radius [rad, or relative to the size]. It is needed where the closure error of redundant constraints keeps curves apart.
const WIDEST: f64 = 0.05;

/// Directions tried on the circle of two free directions, and the factor for each further free direction.
const DIRECTIONS: usize = 48;
const MORE_DIRECTIONS: usize = 6;

/// If none of the first directions, this many, leads to a solution, the others are not tried.
const MOST_IN_VAIN: usize = 288;

/// The direction from the pose to a curve may change by this much between one sphere and that of half the radius; a change below
/// `STRAIGHT` is rounding.
const MOST_BENT: f64 = 0.2;
const STRAIGHT: f64 = 1e-6;

/// From one halving of the radius to the next that change halves, for a smooth curve; up to this part of it is allowed.
const BEND_FALLS: f64 = 0.75;

/// Ways out that are closer to each other than this part of the radius are the same.
const SAME_WAY: f64 = 1e-5;

/// Tangents at the pose that differ by less than this from opposite ones belong to one smooth curve.
const OPPOSITE: f64 = 0.03;

/// A pose belongs to a change point up to this many times the distance at which curves are cut there.
pub(super) const AT_POINT: f64 = 3.0;

/// Newton's method on a sphere is given up if a step is still longer than this part of the radius after this many steps.
const WANDERING_AFTER: usize = 15;
const WANDERING: f64 = 1e-2;

/// Longest step of Newton's method on a sphere [parts of the radius]: it cannot cross the sphere.
const LONGEST_STEP: f64 = 0.3;

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

/// On a sphere, a singular value below this times the radius and the greatest singular value counts as zero.
const NO_FREEDOM: f64 = 1e-4;

/// Ways out whose directions have a greater cosine, either way, are along one line; on a surface directions are tried all round.
const ONE_LINE: f64 = 0.95;

/// So many on one line are no surface, on which each direction leads to a pose of its own: of the directions on a circle these are
/// an eighth of a turn.
const ENOUGH_ON_LINE: usize = 6;

/// A way out of a pose.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ray {
    /// Its pose on the sphere, and the direction outwards there.
    pub start: Start,
    /// From the change point to the way's poses on the sphere and on that of half the radius, each divided by its sphere's radius.
    seen: [Columns; 2],
    /// Distance from the change point up to which it can be followed inwards [rad, or relative to the size].
    hidden: f64,
}

/// A pose at which the motion is not smooth.
#[derive(Clone, Debug)]
pub(crate) struct ChangePoint {
    pub at: Configuration,
    pub rays: Vec<Ray>,
    /// For each ray, the ray that continues it smoothly.
    pub partner: Vec<Option<usize>>,
    /// Distance from it at which curves that run into it are cut [rad, or relative to the size].
    pub cut: f64,
    /// The greatest mobility of the motions out of it: 0 if it is isolated, 2 or more if it lies on a surface.
    pub finite: usize,
    /// Whether it lies on a motion all of whose poses have as many free directions to first order, and more than one: a constraint is
    /// met twice over along it.
    pub is_on_double: bool,
}

/// The change point at or near a pose, if there is one, judged by the wished columns; `stuck` says that a walk could not go on there.
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
    let mut found = ChangePoint {
        at: place.at,
        rays: Vec::new(),
        partner: Vec::new(),
        cut,
        finite: 0,
        is_on_double: false,
    };
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
        found.is_on_double = ways.is_empty() && finite == 1;
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
    // a place that is merely let pass is not reported as an isolated pose
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

/// Whether a pose on a sphere closes only because it is near: its closure error falls with the square of the distance. Along a real
/// motion the closure error is rounding, or that of redundant constraints, which is constant or falls in proportion.
fn opens_with_distance(chain: &Chain, place: &Place, at: &Configuration, radius: f64) -> bool {
    let open = |at: &Configuration| chain.residual(&chain.place(at));
    let inward = chain.difference(&place.at, at).map(|x| x / radius);
    open(at) > ROUNDED
        && on_sphere(chain, place, &inward, NEARER * radius)
            .is_some_and(|nearer| open(&nearer) < LEAST_FALL * open(at))
}

/// The poses at which curves cut a sphere about a place, each once, and the greatest mobility found on it. A surface has no separate
/// ways out, but curves may run into it.
fn ways_out(chain: &Chain, place: &Place, radius: f64) -> (Vec<Configuration>, usize) {
    let mut found: Vec<Configuration> = Vec::new();
    let mut finite = 0;
    let mut line: Option<Columns> = None;
    let mut on_line = 0;
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
        if freedoms > 1 && freedoms == place.free.len() {
            let way = chain.difference(&place.at, &at);
            let along = |first: &Columns| dot(first, &way).abs() > ONE_LINE * length(first) * length(&way);
            // a motion along which a constraint is met twice over has as many free directions, and goes one way only
            if line.as_ref().is_none_or(along) {
                line = line.or(Some(way));
                finite = finite.max(1);
                on_line += 1;
                if on_line == ENOUGH_ON_LINE && found.is_empty() {
                    break;
                }
                continue;
            }
            // one surface accounts for all of them
            finite = finite.max(freedoms);
            break;
        }
        finite = finite.max(freedoms);
        if freedoms == 1 {
            found.push(at);
        }
    }
    (found, finite)
}

/// The solution of the closure at distance `radius` from a place that Newton's method finds, starting in a direction.
fn on_sphere(chain: &Chain, place: &Place, direction: &Columns, radius: f64) -> Option<Configuration> {
    let mut at = chain.moved(&place.at, &direction.map(|x| x * radius));
    let mut before = f64::INFINITY;
    for step in 0..MOST_STEPS {
        stopping::piece();
        let placed = chain.place(&at);
        let off = chain.difference(&place.at, &at);
        let seen: Vec<f64> = place.free.iter().map(|f| dot(f, &off)).collect();
        let distance = seen.iter().map(|x| x * x).sum::<f64>().sqrt();
        if !(distance > INNERMOST * radius && length(&off) < OUTERMOST * radius) {
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
        // where curves touch, each step is at most half the one before
        if !size.is_finite() || (step >= WANDERING_AFTER && size > WANDERING * radius) {
            return None;
        }
        let factor = (LONGEST_STEP * radius / size).min(1.0);
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

/// The way out through a pose on the sphere; `None` if its curve does not run straight into the change point.
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
    // a hyperbola departs from its asymptotes by the square of the distance at which its branches pass
    let passing = 4.0 * place.passing() / radius;
    if first > MOST_BENT || second > BEND_FALLS * first + STRAIGHT + 2.0 * passing * passing {
        return None;
    }
    let (values, vectors) = singular_values(&chain.screws(at));
    let mut direction = [0.0; COLUMNS];
    direction[..chain.columns].copy_from_slice(&vectors[chain.columns - 1]);
    if dot(&direction, &seen[0]) < 0.0 {
        direction = direction.map(|x| -x);
    }
    // the inverse's norm grows as a power of 1 / distance; `outer` is now at a quarter of the radius
    let norm = |values: &[f64]| values[chain.columns - 2].recip();
    let (far, near) = (norm(&values), norm(&singular_values(&chain.screws(&outer)).0));
    let power = ((near / far).log2() / 2.0).max(1.0);
    let hidden = radius * (far / HIDDEN).powf(1.0 / power);
    Some(Ray { start: (*at, direction), seen: [seen[0], seen[1]], hidden })
}

impl Ray {
    /// The tangent at the change point, outwards: extrapolated from the two spheres.
    pub fn tangent(&self) -> Columns {
        let t: Columns = std::array::from_fn(|c| 2.0 * self.seen[1][c] - self.seen[0][c]);
        let size = length(&t);
        t.map(|x| x / size)
    }

    /// How far two ways out are from being one smooth curve: by their tangents, and by their bends.
    fn mismatch(&self, other: &Self) -> (f64, f64) {
        let (a, b) = (self.tangent(), other.tangent());
        let kink = length(&std::array::from_fn(|c| a[c] + b[c]));
        // twice the second-order term, which is the same on both arms of a smooth curve
        let bend = |ray: &Self, c: usize| ray.seen[0][c] - ray.seen[1][c];
        (
            kink,
            length(&std::array::from_fn(|c| bend(self, c) - bend(other, c))),
        )
    }
}

impl ChangePoint {
    /// Whether a curve passes through it, or ends there.
    pub fn is_on(&self, chain: &Chain, curve: &Curve) -> bool {
        let near = |n: &Node| length(&chain.difference(&self.at, &n.at)) < AT_POINT * self.cut;
        let last = curve.nodes.len() - 1;
        curve.nodes.iter().any(|n| n.is_crossing() && near(n))
            || near(&curve.nodes[0])
            || near(&curve.nodes[last])
    }

    /// Where a walk that runs into it ends.
    pub fn stop(&self) -> Stop {
        Stop { at: self.at, radius: self.cut }
    }
}

/// For each way out, the way out that continues it smoothly; pairs nearest in tangent and bend are joined first.
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
    // two arms left over are those of a cusp
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
