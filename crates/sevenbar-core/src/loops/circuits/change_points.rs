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
use super::sphere::{RADII, on_sphere, ways_out};
use crate::loops::equation::chain::Chain;
use crate::loops::equation::closed::{At, Closed, copied};
use crate::loops::equation::dense::{Array, combined, dot, length, singular_values};
use crate::loops::mobility::singular_place::{Place, singular_place};

/// Distance from the pose at which curves are cut [rad, or relative to the size]. Closer in, rounding turns their tangents by more than
/// the curves bend.
const CUT: f64 = 2e-5;

/// Two curves that miss each other are cut at this many times the distance between them, where both are straight.
const CUT_TIMES: f64 = 30.0;

/// Norm of the inverse of the screws' matrix at which curves are cut where it grows faster than usual, as where three curves touch. At a
/// greater norm, rounding hides the curves from each other.
const HIDDEN: f64 = 2e6;

/// The same where curves touch, which is sooner: on the way in there, steps are as short as the curves are near. No farther out than the
/// second number times the sphere's radius.
const HIDDEN_IN_TOUCH: f64 = 1e5;
const NEAR_TOUCH: f64 = 0.1;

/// Radii of the sphere where curves may touch: their distance falls with the square of the radius, and they part where it is great.
const RADII_OF_TOUCHING: [f64; 6] = [5e-2, 2e-2, 1e-2, 2e-3, 4e-4, 8e-5];

/// A sphere's radius is at least this many times the distance at which curves are cut.
const LEAST_RADIUS: f64 = 3.0;

/// The greatest radius [rad, or relative to the size]. It is needed where the closure error of redundant constraints keeps curves apart.
const WIDEST: f64 = 0.05;

/// The direction from the pose to a curve may change by this much between one sphere and that of half the radius; a change below
/// `STRAIGHT` is rounding.
const MOST_BENT: f64 = 0.2;
const STRAIGHT: f64 = 1e-6;

/// From one halving of the radius to the next that change halves, for a smooth curve; up to this part of it is allowed.
const BEND_FALLS: f64 = 0.75;

/// Tangents at the pose that differ by less than this from opposite ones belong to one smooth curve.
const OPPOSITE: f64 = 0.03;

/// A pose belongs to a change point up to this many times the distance at which curves are cut there.
pub(super) const AT_POINT: f64 = 3.0;

/// Another change point is at least so many times as far as ways out reach, so that none starts beyond it.
const CROWDED: f64 = 2.5;

/// Ends of curves nearer to each other than this [rad, or relative to the size] are at one change point: rounding ends them as far from it.
const SAME_END: f64 = 1e-2;

/// Zeros that the determinant has in an isolated pose, where two curves cross, or where one has a cusp.
const ZEROS_OF_POSE: usize = 2;

/// A way out of a pose.
pub(crate) struct Ray<S: Closed> {
    /// Its pose on the sphere, and the direction outwards there.
    pub start: Start<S>,
    /// From the change point to the way's poses on the sphere and on that of half the radius, each divided by its sphere's radius.
    seen: [S::Columns<f64>; 2],
    /// Distance from the change point up to which it can be followed inwards [rad, or relative to the size].
    hidden: f64,
    /// The power of the distance with which the least singular value of the screws falls: 1 for each curve that crosses, 2 for each
    /// that touches.
    power: f64,
}

copied!(Ray<S>);

/// A pose at which the motion is not smooth.
pub(crate) struct ChangePoint<S: Closed = Chain> {
    pub at: At<S>,
    pub rays: Vec<Ray<S>>,
    /// For each ray, the ray that continues it smoothly.
    pub partner: Vec<Option<usize>>,
    /// Distance from it at which curves that run into it are cut [rad, or relative to the size].
    pub cut: f64,
    /// The greatest mobility of the motions out of it: 0 if it is isolated, 2 or more if it lies on a surface.
    pub finite: usize,
    /// Ways out of it that are not followed.
    pub lost: usize,
    /// The sphere on which its ways out start [rad, or relative to the size].
    reach: f64,
    /// Whether not all of its ways out are known one by one, as where another point is so near that those of both are taken for one.
    pub blurred: bool,
}

/// The change point at or near a pose, if there is one, judged by the wished columns; `stuck` says that a walk could not go on there.
/// Its ways out are searched `within` a distance from it; `spheres` counts those on which they are.
pub(super) fn change_point<S: Closed>(
    chain: &S,
    rough: &At<S>,
    (wished, stuck): (&[usize], bool),
    within: f64,
    spheres: &mut usize,
) -> Option<ChangePoint<S>> {
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
        reach: 0.0,
        blurred: false,
    };
    let least = LEAST_RADIUS * cut;
    let all = if place.may_touch() {
        RADII_OF_TOUCHING.as_slice()
    } else {
        RADII.as_slice()
    };
    let mut radii: Vec<f64> = all.iter().map(|r| r.min(within)).filter(|&r| r > least).collect();
    radii.dedup();
    if radii.is_empty() {
        if least > WIDEST.min(within) {
            return None;
        }
        radii.push(least);
    }
    // the sphere up to which nothing but the pose itself is seen
    let mut widest = RADII[0].min(within);
    let mut seen = None;
    for radius in radii {
        *spheres += 1;
        let ways = ways_out(chain, &place, radius);
        found.finite = ways.finite;
        let rays: Vec<Ray<S>> = ways
            .single
            .iter()
            .filter_map(|at| ray(chain, &place, at, radius))
            .collect();
        let straight = rays.len() == ways.single.len();
        if straight || rays.len() > found.rays.len() {
            found.lost = ways.lost.len() + ways.single.len() - rays.len();
            found.rays = rays;
            found.reach = radius;
            // there is another such pose between two spheres with different ways out
            let alone = seen.is_none_or(|seen| seen == ways.single.len());
            widest = if alone { radius.max(widest) } else { radius };
        }
        seen = Some(ways.single.len());
        if straight {
            break;
        }
    }
    // a place that is merely let pass is not reported as an isolated pose
    if !counts && found.rays.is_empty() {
        return None;
    }
    found.partner = partners(&found.rays, found.lost);
    let hidden = found.rays.iter().map(|r| r.hidden).fold(0.0, f64::max);
    let farthest = widest / LEAST_RADIUS;
    if hidden < farthest || place.may_touch() {
        found.cut = found.cut.max(hidden.min(farthest));
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

/// The way out through a pose on the sphere; `None` if its curve does not run straight into the change point.
fn ray<S: Closed>(chain: &S, place: &Place<S>, at: &At<S>, radius: f64) -> Option<Ray<S>> {
    let mut outer = *at;
    let mut seen = [S::Columns::filled(0.0); 3];
    for (k, seen) in seen.iter_mut().enumerate() {
        let scale = 1.0 / (radius * 0.5_f64.powi(k as i32));
        *seen = chain.difference(&place.at, &outer).map(|x| x * scale);
        if k < 2 {
            outer = on_sphere(chain, place, seen, 0.5 / scale)?;
        }
    }
    let apart = |a: &S::Columns<f64>, b: &S::Columns<f64>| length(&combined(a, 1.0, b, -1.0));
    let (first, second) = (apart(&seen[0], &seen[1]), apart(&seen[1], &seen[2]));
    // a hyperbola departs from its asymptotes by the square of the distance at which its branches pass
    let passing = 4.0 * place.passing() / radius;
    if first > MOST_BENT || second > BEND_FALLS * first + STRAIGHT + 2.0 * passing * passing {
        return None;
    }
    let (values, vectors) = singular_values(&chain.screws(at));
    let mut direction: S::Columns<f64> = Array::padded(&vectors[chain.columns() - 1], 0.0);
    if dot(&direction, &seen[0]) < 0.0 {
        direction = direction.map(|x| -x);
    }
    // the inverse's norm grows as a power of 1 / distance; `outer` is now at a quarter of the radius
    let norm = |values: &[f64]| values[chain.columns() - 2].recip();
    let (far, near) = (norm(&values), norm(&singular_values(&chain.screws(&outer)).0));
    let power = ((near / far).log2() / 2.0).max(1.0);
    let hidden = radius * (far / HIDDEN).powf(1.0 / power);
    Some(Ray { start: (*at, direction), seen: [seen[0], seen[1]], hidden, power })
}

impl<S: Closed> Ray<S> {
    /// The tangent at the change point, outwards: extrapolated from the two spheres.
    pub fn tangent(&self) -> S::Columns<f64> {
        let t: S::Columns<f64> = Array::from_fn(|c| 2.0 * self.seen[1][c] - self.seen[0][c]);
        let size = length(&t);
        t.map(|x| x / size)
    }

    /// How far two ways out are from being one smooth curve: by their tangents, and by their bends.
    fn mismatch(&self, other: &Self) -> (f64, f64) {
        let (a, b) = (self.tangent(), other.tangent());
        let kink = length(&combined(&a, 1.0, &b, 1.0));
        // twice the second-order term, which is the same on both arms of a smooth curve
        let bend = |ray: &Self| combined(&ray.seen[0], 1.0, &ray.seen[1], -1.0);
        (kink, length(&combined(&bend(self), 1.0, &bend(other), -1.0)))
    }
}

impl<S: Closed> ChangePoint<S> {
    /// Where a curve ends, and nothing is known of what begins there.
    pub fn of_end(at: &At<S>) -> Self {
        Self {
            at: *at,
            rays: Vec::new(),
            partner: Vec::new(),
            cut: SAME_END / AT_POINT,
            finite: 1,
            lost: 1,
            reach: 0.0,
            blurred: false,
        }
    }

    /// How far its ways out may reach, where another point is so far from it; `None` where they do not reach farther.
    pub fn crowded(&self, chain: &S, other: &Self) -> Option<f64> {
        let most = length(&chain.difference(&self.at, &other.at)) / CROWDED;
        (self.reach > most).then_some(most)
    }

    /// Keeps its ways out as they are: they reach over another point, which is too near.
    pub fn blur(&mut self) {
        self.reach = 0.0;
        self.blurred = true;
    }

    /// Whether a pose is this one.
    pub fn is_at(&self, chain: &S, pose: &At<S>) -> bool {
        length(&chain.difference(&self.at, pose)) < AT_POINT * self.cut
    }

    /// Whether a curve passes through it, or ends there.
    pub fn is_on(&self, chain: &S, curve: &Curve<S>) -> bool {
        let near = |n: &Node<S>| self.is_at(chain, &n.at);
        let last = curve.nodes.len() - 1;
        curve.nodes.iter().any(|n| n.is_crossing() && near(n))
            || near(&curve.nodes[0])
            || near(&curve.nodes[last])
    }

    /// Whether all ways out of it are known, and each goes on smoothly by another.
    pub fn is_smooth(&self) -> bool {
        self.lost == 0 && self.partner.iter().all(Option::is_some)
    }

    /// How many zeros the determinant has there, two for each pair of curves that cross.
    pub fn zeros(&self) -> usize {
        let powers: f64 = self.rays.iter().map(|r| r.power.round()).sum();
        if self.is_smooth() {
            (powers / 2.0) as usize
        } else {
            0
        }
        .max(ZEROS_OF_POSE)
    }

    /// Where a walk that runs into it ends.
    pub fn stop(&self) -> Stop<S> {
        Stop { at: self.at, radius: self.cut }
    }
}

/// For each way out, the way out that continues it smoothly; pairs nearest in tangent and bend are joined first. Ways out come in pairs,
/// so two that are left over are one curve, be it that it bends sharply within the sphere, or has a cusp; not where others are `lost`.
fn partners<S: Closed>(rays: &[Ray<S>], lost: usize) -> Vec<Option<usize>> {
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
    let left: Vec<usize> = (0..rays.len()).filter(|&k| partner[k].is_none()).collect();
    if let [i, j] = left[..]
        && (lost == 0 || rays.len() == 2)
    {
        (partner[i], partner[j]) = (Some(j), Some(i));
    }
    partner
}
