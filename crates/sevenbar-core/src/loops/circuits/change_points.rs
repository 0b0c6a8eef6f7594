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

/// The same where curves touch, which is sooner: on the way in there, steps are as short as the curves are near. No farther out than the
/// second number times the sphere's radius.
const HIDDEN_IN_TOUCH: f64 = 1e5;
const NEAR_TOUCH: f64 = 0.1;

/// Radii of the sphere [rad, or relative to the size], tried in turn until all curves run straight from the sphere into the pose.
const RADII: [f64; 4] = [1e-2, 2e-3, 4e-4, 8e-5];

/// The same where curves may touch: their distance falls with the square of the radius, and they part where it is great.
const RADII_OF_TOUCHING: [f64; 6] = [5e-2, 2e-2, 1e-2, 2e-3, 4e-4, 8e-5];

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

/// Ends of curves nearer to each other than this [rad, or relative to the size] are at one change point: rounding ends them as far from it.
const SAME_END: f64 = 1e-2;

/// Newton's method on a sphere is given up if a step is still longer than this part of the radius after this many steps.
const WANDERING_AFTER: usize = 15;
const WANDERING: f64 = 1e-2;

/// Longest step of Newton's method on a sphere [parts of the radius]: it cannot cross the sphere.
const LONGEST_STEP: f64 = 0.3;

/// Where curves may touch, the first steps of Newton's method see only what is seen to first order, so that the direction is kept: the
/// rest is of a higher order than the error with which a start closes.
const FIRST_STEPS: usize = 3;

/// Newton's method has left the sphere's neighbourhood where the free directions carry less than the first part of the radius, or the
/// pose is farther off than the second [parts of the radius].
const INNERMOST: f64 = 0.1;
const OUTERMOST: f64 = 3.0;

/// Zeros that the determinant has in an isolated pose, where two curves cross, or where one has a cusp.
const ZEROS_OF_POSE: usize = 2;

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

/// A way out of a pose.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ray {
    /// Its pose on the sphere, and the direction outwards there.
    pub start: Start,
    /// From the change point to the way's poses on the sphere and on that of half the radius, each divided by its sphere's radius.
    seen: [Columns; 2],
    /// Distance from the change point up to which it can be followed inwards [rad, or relative to the size].
    hidden: f64,
    /// The power of the distance with which the least singular value of the screws falls: 1 for each curve that crosses, 2 for each
    /// that touches.
    power: f64,
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
    /// Ways out of it that are not followed.
    pub lost: usize,
}

/// What leads out of a place.
#[derive(Default)]
struct Ways {
    /// The poses at which curves cut a sphere about it, each once.
    single: Vec<Configuration>,
    /// The same of curves that coincide.
    lost: Vec<Configuration>,
    /// The greatest mobility found on the sphere.
    finite: usize,
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
        lost: 0,
    };
    let least = LEAST_RADIUS * cut;
    let all = if place.may_touch() {
        RADII_OF_TOUCHING.as_slice()
    } else {
        RADII.as_slice()
    };
    let mut radii: Vec<f64> = all.iter().copied().filter(|&r| r > least).collect();
    if radii.is_empty() {
        if least > WIDEST {
            return None;
        }
        radii.push(least);
    }
    // the sphere on which its ways were found
    let mut widest = RADII[0];
    for radius in radii {
        let ways = ways_out(chain, &place, radius);
        found.finite = ways.finite;
        let rays: Vec<Ray> = ways
            .single
            .iter()
            .filter_map(|at| ray(chain, &place, at, radius))
            .collect();
        let straight = rays.len() == ways.single.len();
        if straight || rays.len() > found.rays.len() {
            found.lost = ways.lost.len() + ways.single.len() - rays.len();
            found.rays = rays;
            widest = radius.max(RADII[0]);
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
    if hidden < widest / LEAST_RADIUS {
        found.cut = found.cut.max(hidden);
    }
    if place.may_touch() {
        let early = found
            .rays
            .iter()
            .map(|r| r.hidden * (HIDDEN / HIDDEN_IN_TOUCH).powf(1.0 / r.power));
        found.cut = found.cut.max(early.fold(0.0, f64::max).min(NEAR_TOUCH * widest));
    }
    Some(found)
}

/// Whether a pose on a sphere closes only because it is near: its closure error falls with the square of the distance. Along a real
/// motion the closure error is rounding, or that of redundant constraints, which is constant or falls in proportion.
fn opens_with_distance(chain: &Chain, place: &Place, at: &Configuration, radius: f64) -> bool {
    let open = |at: &Configuration| chain.residual(&chain.place(at));
    // so far out it does not close but for redundant constraints
    if radius >= RADII[0] && !chain.is_redundant() {
        return false;
    }
    let inward = chain.difference(&place.at, at).map(|x| x / radius);
    open(at) > ROUNDED
        && on_sphere(chain, place, &inward, NEARER * radius)
            .is_some_and(|nearer| open(&nearer) < LEAST_FALL * open(at))
}

/// What leads over a sphere about a place. A surface has no separate ways out, but curves may run into it.
fn ways_out(chain: &Chain, place: &Place, radius: f64) -> Ways {
    let mut found = Ways::default();
    let near = |known: &[Configuration], at: &Configuration, part: f64| {
        let near = |f: &Configuration| length(&chain.difference(f, at)) < part * radius;
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
        let rank = values.iter().take(6).filter(|&&v| v > zero).count();
        let freedoms = chain.columns - rank;
        if freedoms == 1 {
            found.single.push(at);
        } else if !redundant && !is_on_surface(chain, place, &at, &vectors[rank..], radius) {
            found.lost.push(at);
        } else if freedoms == place.free.len() {
            let way = chain.difference(&place.at, &at);
            let along = |known: &Configuration| {
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

/// Whether there are other solutions next to one on a sphere, in a direction that is free there.
fn is_on_surface(chain: &Chain, place: &Place, at: &Configuration, free: &[Vec<f64>], radius: f64) -> bool {
    let off = chain.difference(&place.at, at);
    let distance = length(&off);
    let along = |v: &[f64]| v.iter().zip(&off).map(|(a, b)| a * b).sum::<f64>() / distance;
    // the freest direction along the sphere
    let Some(least) = free
        .iter()
        .min_by(|a, b| along(a).abs().total_cmp(&along(b).abs()))
    else {
        return false;
    };
    let outward = along(least) / distance;
    let start = std::array::from_fn(|c| {
        let aside = least.get(c).map_or(0.0, |x| x - outward * off[c]);
        off[c] / radius + ASIDE * aside
    });
    on_sphere(chain, place, &start, radius)
        .is_some_and(|other| length(&chain.difference(at, &other)) > SURFACE * radius)
}

/// The solution of the closure at distance `radius` from a place that Newton's method finds, starting in a direction.
fn on_sphere(chain: &Chain, place: &Place, direction: &Columns, radius: f64) -> Option<Configuration> {
    let mut at = chain.moved(&place.at, &direction.map(|x| x * radius));
    let mut before = f64::INFINITY;
    let first = if place.may_touch() { FIRST_STEPS } else { 0 };
    for step in 0..MOST_STEPS {
        stopping::piece();
        let zero = if step < first { radius } else { chain.no_rank() };
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
        by[..chain.columns].copy_from_slice(&least_squares(&columns, &right, zero));
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
        if steady && step >= first {
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
    Some(Ray { start: (*at, direction), seen: [seen[0], seen[1]], hidden, power })
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
    /// Where a curve ends, and nothing is known of what begins there.
    pub fn of_end(at: &Configuration) -> Self {
        Self {
            at: *at,
            rays: Vec::new(),
            partner: Vec::new(),
            cut: SAME_END / AT_POINT,
            finite: 1,
            lost: 1,
        }
    }

    /// Whether a pose is this one.
    pub fn is_at(&self, chain: &Chain, pose: &Configuration) -> bool {
        length(&chain.difference(&self.at, pose)) < AT_POINT * self.cut
    }

    /// Whether a curve passes through it, or ends there.
    pub fn is_on(&self, chain: &Chain, curve: &Curve) -> bool {
        let near = |n: &Node| self.is_at(chain, &n.at);
        let last = curve.nodes.len() - 1;
        curve.nodes.iter().any(|n| n.is_crossing() && near(n))
            || near(&curve.nodes[0])
            || near(&curve.nodes[last])
    }

    /// How many zeros the determinant has there, two for each pair of curves that cross.
    pub fn zeros(&self) -> usize {
        let smooth = self.lost == 0 && self.partner.iter().all(Option::is_some);
        let powers: f64 = self.rays.iter().map(|r| r.power.round()).sum();
        if smooth { (powers / 2.0) as usize } else { 0 }.max(ZEROS_OF_POSE)
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
