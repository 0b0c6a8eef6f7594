//! Curves walked eight side by side in vector lanes, each until it comes back or cannot go on.

use super::curve::{self, Curve, End, Node, Stand};
use crate::loops::equation::chain::Chain;
use crate::loops::equation::closed::{At, Closed, Joint, copied};
use crate::loops::equation::dense::{Array, dot, length};
use crate::simd::{self, Kernel};
use crate::stopping;
use crate::vectors::{self, LANES, LaneKernel, Vector};

/// Shorter steps mean a place where the curve is not smooth: a change point.
const SHORTEST: f64 = 1e-10;

/// Norm of the screws' inverse beyond which rounding moves a place by more than its distance from where the curve is not smooth.
const BLIND: f64 = 3e7;

/// Most nodes of a curve, 43 MB; an ordinary circuit has some hundreds, three screws over 50 rad 70,000.
const MOST_NODES: usize = 100_000;

/// The same of a piece between starts, which many walk at once; a longer one is left to the ordinary way.
const MOST_PIECE_NODES: usize = 5_000;

/// Steps in a row, each to a greater norm of the screws' inverse beyond the second number, after which a curve is followed no farther until
/// the place that it runs into has been searched for. Where curves cross they are some hundred; where they touch, as many more as it is nearer.
pub(super) const MOST_NARROWING: usize = 1_000;
const NARROWING: f64 = 1e4;

/// Nearer to a change point than this [rad, or relative to the size] so many steps are followed at least: it is what the curve runs into.
const NEAR_STOP: f64 = 0.1;
pub(super) const MOST_NARROWING_NEAR: usize = 8_000;

/// Most nodes of curves that are walked side by side, 260 MB; those that are still under way by then end there.
const MOST_TOGETHER: usize = 600_000;

/// Slides [share of the size] and screws [rad] are not followed farther than this.
const FARTHEST: f64 = 50.0;

/// A closed configuration and the direction in which to leave it.
pub(super) type Start<S> = (At<S>, <S as Closed>::Columns<f64>);

/// A pose at which walks end, and how near to it.
pub(crate) struct Stop<S: Closed = Chain> {
    pub at: At<S>,
    pub radius: f64,
}

copied!(Stop<S>);

/// How far curves are followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Until {
    /// Until they come back, or end.
    End,
    /// The same, or until so many steps in a row lead to where they are shorter.
    Narrow(usize),
    /// Until they reach any of the starts.
    Start,
}

/// Follows the motions through closed configurations until they come back; those that do not, from end to end.
pub(crate) fn follow<S: Closed>(chain: &S, starts: &[Start<S>], stops: &[Stop<S>]) -> Vec<Curve<S>> {
    // what redundant constraints miss each other by hides how near a curve comes
    let until = if chain.is_redundant() {
        Until::End
    } else {
        Until::Narrow(MOST_NARROWING)
    };
    follow_until(chain, starts, stops, until)
}

pub(super) fn follow_until<S: Closed>(
    chain: &S,
    starts: &[Start<S>],
    stops: &[Stop<S>],
    until: Until,
) -> Vec<Curve<S>> {
    let mut curves = walk_until(chain, starts, stops, until).0;
    let open: Vec<usize> = (0..curves.len())
        .filter(|&k| !curves[k].is_closed() && !curves[k].ends_by(End::Open))
        .collect();
    // once more from the end it ran into; a long curve is held once only
    let ends: Vec<Start<S>> = open.iter().map(|&k| back_from_end(&curves[k])).collect();
    for &k in &open {
        curves[k].nodes = Vec::new();
    }
    for (k, back) in open.into_iter().zip(walk_until(chain, &ends, stops, until).0) {
        curves[k] = begun_for(curves[k].why[1], back);
    }
    curves
}

/// Whether a curve ended since there were too many nodes: it may have no end, as on a surface of poses, or be so long that rounding
/// leads it on, as where lengths of one loop differ by many powers of ten.
pub(super) fn is_endless<S: Closed>(chain: &S, curve: &Curve<S>) -> bool {
    let ends = curve.ends().into_iter().zip(curve.why);
    ends.into_iter()
        .any(|(at, why)| why == End::Far && !is_far(chain, at))
}

/// A walk from an end, with the reason of that end.
pub(super) fn begun_for<S: Closed>(why: End, mut walked: Curve<S>) -> Curve<S> {
    if !walked.is_closed() {
        walked.why[0] = why;
    }
    walked
}

/// Whether a slide or screw is farther out than curves are followed.
pub(super) fn is_far<S: Closed>(chain: &S, at: &At<S>) -> bool {
    let far = |(joint, &c): (&Joint, &usize)| {
        !matches!(joint, Joint::Turn | Joint::Ball(_)) && at.values[c].abs() > FARTHEST
    };
    chain.joints().iter().zip(chain.first()).any(far)
}

/// Each motion until it comes to the next of the starts, its own or another, and which that is.
pub(super) fn pieces<S: Closed>(chain: &S, starts: &[Start<S>]) -> (Vec<Curve<S>>, Vec<Option<usize>>) {
    walk_until(chain, starts, &[], Until::Start)
}

pub(super) fn walk_until<S: Closed>(
    chain: &S,
    starts: &[Start<S>],
    stops: &[Stop<S>],
    until: Until,
) -> (Vec<Curve<S>>, Vec<Option<usize>>) {
    let mut curves = vec![Curve { nodes: Vec::new(), why: [End::Far; 2] }; starts.len()];
    let mut reached = vec![None; starts.len()];
    let mut narrowing = vec![0; starts.len()];
    // one curve has nothing beside it, and vector code would be slower
    let together = if S::SIDE_BY_SIDE { starts.len().max(1) } else { 1 };
    let each = starts.chunks(together).zip(curves.chunks_mut(together));
    let each = each.zip(reached.chunks_mut(together));
    for (((starts, curves), reached), narrowing) in each.zip(narrowing.chunks_mut(together)) {
        let walk = Walk { chain, starts, stops, until, curves, reached, narrowing, nodes: 0 };
        // asked by itself, so that what is not wanted is not compiled
        if S::SIDE_BY_SIDE {
            if walk.starts.len() == 1 {
                simd::dispatch(walk);
            } else {
                vectors::dispatch(walk);
            }
        } else {
            Kernel::run::<false>(walk);
        }
    }
    (curves, reached)
}

/// The start, its turns counted on, where it lies in the step from a node: with the step that leads there.
fn returned<S: Closed>(chain: &S, first: &Node<S>, from: &Node<S>) -> Option<(f64, Node<S>)> {
    if !curve::may_pass(chain, from, &first.at) || dot(&first.rates[0], &from.rates[0]) < 0.5 {
        return None;
    }
    let along = curve::passes_through(chain, from, &first.at)?;
    // the start itself, with the turns made on the way
    let mut end = *first;
    for c in 0..chain.columns() {
        if chain.is_turn(c) {
            let here = from.at.values[c] + from.gone(c, along);
            let turn = std::f64::consts::TAU;
            end.at.values[c] += turn * ((here - first.at.values[c]) / turn).round();
        }
    }
    Some((along, end))
}

pub(super) fn back_from_end<S: Closed>(curve: &Curve<S>) -> Start<S> {
    let last = &curve.nodes[curve.nodes.len() - 1];
    (last.at, last.rates[0].map(|t| -t))
}

/// Walks eight curves side by side.
struct Walk<'a, S: Closed> {
    chain: &'a S,
    starts: &'a [Start<S>],
    stops: &'a [Stop<S>],
    until: Until,
    curves: &'a mut [Curve<S>],
    /// The start to which each came.
    reached: &'a mut [Option<usize>],
    /// How many of each one's last steps led to a greater norm of the screws' inverse.
    narrowing: &'a mut [usize],
    /// How many nodes there are on all.
    nodes: usize,
}

impl<S: Closed> LaneKernel for Walk<'_, S> {
    #[inline(always)]
    fn run<V: Vector>(mut self) {
        let count = self.starts.len();
        let mut walker = [usize::MAX; LANES];
        for (lane, w) in walker.iter_mut().enumerate().take(count) {
            *w = lane;
        }
        let mut waiting = LANES.min(count);
        let mut here = self.begun::<V>(&walker);
        let mut split = self.split(&here.node);
        for lane in 0..LANES {
            self.record(walker[lane], split[lane]);
        }
        // curves may come to starts that have not yet been left
        for block in (LANES..count).step_by(LANES) {
            let mut later = [usize::MAX; LANES];
            for (lane, w) in later.iter_mut().enumerate().take(count - block) {
                *w = block + lane;
            }
            let begun = self.begun::<V>(&later);
            let nodes = self.split(&begun.node);
            for lane in 0..LANES {
                self.record(later[lane], nodes[lane]);
            }
        }
        let mut growth = [0.0; LANES];
        let mut step = curve::likely(self.chain, &here.node, V::load(&growth)).store();
        while walker.iter().any(|&w| w < count) {
            stopping::piece();
            let tried = curve::step(self.chain, &here, V::load(&step));
            let (mut allowed, tube) = (tried.allowed.store(), tried.tube.store());
            growth = tried.growth.store();
            split = self.split(&tried.next.node);
            for lane in 0..LANES {
                // not a number is no allowance either
                if !(allowed[lane] >= 0.0 && split[lane].inverse_norm.is_finite()) {
                    allowed[lane] = -1.0;
                }
            }
            let mut fresh = [false; LANES];
            for lane in 0..LANES {
                if walker[lane] >= count {
                    continue;
                }
                let end = if allowed[lane] >= 0.0 {
                    self.stepped(walker[lane], (step[lane], tube[lane]), split[lane])
                } else {
                    too_short(step[lane])
                };
                if let Some(end) = end {
                    self.curves[walker[lane]].why = [end; 2];
                    walker[lane] = if waiting < count { waiting } else { usize::MAX };
                    waiting += 1;
                    fresh[lane] = walker[lane] != usize::MAX;
                }
            }
            let mask = V::load(&allowed);
            replace(&mut here, mask, &tried.next, self.chain.ball_count());
            if fresh.contains(&true) {
                let begun = self.begun::<V>(&walker);
                let mut mask = [-1.0; LANES];
                for lane in (0..LANES).filter(|&k| fresh[k]) {
                    mask[lane] = 1.0;
                }
                replace(&mut here, V::load(&mask), &begun, self.chain.ball_count());
            }
            for lane in (0..LANES).filter(|&k| fresh[k]) {
                growth[lane] = 0.0;
            }
            let likely = curve::likely(self.chain, &here.node, V::load(&growth)).store();
            for lane in 0..LANES {
                step[lane] = if allowed[lane] >= 0.0 || fresh[lane] {
                    likely[lane]
                } else {
                    shortened(step[lane], likely[lane])
                };
            }
        }
    }
}

impl<S: Closed> Kernel for Walk<'_, S> {
    #[inline(always)]
    fn run<const FUSED: bool>(mut self) {
        let (at, before) = &self.starts[0];
        let mut here = curve::stand(self.chain, at, before);
        self.record(0, here.node);
        let mut step = curve::likely(self.chain, &here.node, 0.0);
        loop {
            stopping::piece();
            let tried = curve::step(self.chain, &here, step);
            let allowed = tried.allowed >= 0.0 && tried.next.node.inverse_norm.is_finite();
            let end = if allowed {
                here = tried.next;
                self.stepped(0, (step, tried.tube), here.node)
            } else {
                too_short(step)
            };
            if let Some(end) = end {
                self.curves[0].why = [end; 2];
                return;
            }
            let likely = curve::likely(self.chain, &here.node, tried.growth);
            step = if allowed { likely } else { shortened(step, likely) };
        }
    }
}

/// The step after one that was refused.
fn shortened(step: f64, likely: f64) -> f64 {
    // what is likely may be not a number
    if likely < 0.5 * step && likely > 0.05 * step {
        likely
    } else {
        0.5 * step
    }
}

/// The end of a curve whose steps have become too short.
fn too_short(step: f64) -> Option<End> {
    (step < SHORTEST || step.is_nan()).then_some(End::Singular)
}

impl<S: Closed> Walk<'_, S> {
    /// The stands at the starts of walkers; a lane without one has the first's.
    #[inline(always)]
    fn begun<V: Vector>(&self, walker: &[usize; LANES]) -> Stand<S, V> {
        let mut each = [At::zero(); LANES];
        let mut directions = S::Columns::filled([0.0; LANES]);
        for lane in 0..LANES {
            let (at, direction) = self.starts.get(walker[lane]).unwrap_or(&self.starts[0]);
            each[lane] = *at;
            for c in 0..S::COLUMNS {
                directions[c][lane] = direction[c];
            }
        }
        let mut before = S::Columns::filled(V::splat(0.0));
        for c in 0..S::COLUMNS {
            before[c] = V::load(&directions[c]);
        }
        let at = At::beside(&each, self.chain.ball_count());
        curve::stand(self.chain, &at, &before)
    }

    /// The lanes of a node.
    #[inline(always)]
    fn split<V: Vector>(&self, node: &Node<S, V>) -> [Node<S>; LANES] {
        let blank = Node {
            at: At::zero(),
            rates: [S::Columns::filled(0.0); 3],
            step: 0.0,
            tube: 0.0,
            inverse_norm: 0.0,
            slopes: [0.0; 2],
            across: 0.0,
            far: S::Cycles::filled(0.0),
            open: 0.0,
        };
        let mut out = [blank; LANES];
        let places = node.at.apart(self.chain.ball_count());
        for k in 0..LANES {
            out[k].at = places[k];
        }
        for c in 0..S::COLUMNS {
            for order in 0..3 {
                let lanes = node.rates[order][c].store();
                for k in 0..LANES {
                    out[k].rates[order][c] = lanes[k];
                }
            }
        }
        for cycle in 0..S::Cycles::<f64>::COUNT {
            let lanes = node.far[cycle].store();
            for k in 0..LANES {
                out[k].far[cycle] = lanes[k];
            }
        }
        let (norm, slope, sway) = (
            node.inverse_norm.store(),
            node.slopes[0].store(),
            node.slopes[1].store(),
        );
        let (across, open) = (node.across.store(), node.open.store());
        for k in 0..LANES {
            out[k].inverse_norm = norm[k];
            out[k].slopes = [slope[k], sway[k]];
            (out[k].across, out[k].open) = (across[k], open[k]);
        }
        out
    }

    fn record(&mut self, walker: usize, node: Node<S>) {
        if let Some(curve) = self.curves.get_mut(walker) {
            curve.nodes.push(node);
            self.nodes += 1;
        }
    }

    /// Adds the node of a step; returns whether the curve ends with it.
    fn stepped(&mut self, walker: usize, (step, tube): (f64, f64), next: Node<S>) -> Option<End> {
        let chain = self.chain;
        let curve = &mut self.curves[walker];
        let last = curve.nodes.len() - 1;
        if next.open > chain.agree() {
            return Some(End::Open);
        }
        curve.nodes[last].step = step;
        curve.nodes[last].tube = tube;
        let mut nearest: Option<(f64, Node<S>, usize)> = None;
        let ends = if self.until == Until::Start {
            0..self.starts.len()
        } else {
            walker..walker + 1
        };
        for end in ends {
            // it has left its own first steps behind
            if (end != walker || last > 3)
                && let Some((along, node)) = returned(
                    chain,
                    &self.curves[end].nodes[0],
                    &self.curves[walker].nodes[last],
                )
                && nearest.as_ref().is_none_or(|n| along < n.0)
            {
                nearest = Some((along, node, end));
            }
        }
        let curve = &mut self.curves[walker];
        if let Some((along, node, end)) = nearest {
            curve.nodes[last].step = along;
            curve.nodes.push(node);
            self.reached[walker] = Some(end);
            return Some(End::Closed);
        }
        let narrower = next.inverse_norm > NARROWING && next.inverse_norm > curve.nodes[last].inverse_norm;
        curve.nodes.push(next);
        self.nodes += 1;
        let mut stopped = next.inverse_norm > BLIND;
        let mut near = false;
        for stop in self.stops {
            let off = chain.difference(&next.at, &stop.at);
            let distance = length(&off);
            // one that it has just left lies behind
            stopped |= distance < stop.radius && dot(&off, &next.rates[0]) > 0.0;
            near |= distance < NEAR_STOP;
        }
        if stopped {
            return Some(End::Singular);
        }
        self.narrowing[walker] = if narrower { self.narrowing[walker] + 1 } else { 0 };
        if let Until::Narrow(most) = self.until {
            let most = if near { most.max(MOST_NARROWING_NEAR) } else { most };
            if self.narrowing[walker] > most {
                return Some(End::Narrow);
            }
        }
        let curve = &self.curves[walker];
        let start = &curve.nodes[0].at;
        let far = chain.joints().iter().zip(chain.first()).any(|(joint, &c)| {
            // a curve that is followed back from its end begins beyond
            let farthest = FARTHEST.max(start.values[c].abs());
            !matches!(joint, Joint::Turn | Joint::Ball(_)) && next.at.values[c].abs() > farthest
        });
        let most = if self.until == Until::Start {
            MOST_PIECE_NODES
        } else {
            MOST_NODES
        };
        (far || curve.nodes.len() > most || self.nodes > MOST_TOGETHER).then_some(End::Far)
    }
}

/// Takes over the lanes of another where a number is not negative.
#[inline(always)]
fn replace<S: Closed, V: Vector>(here: &mut Stand<S, V>, mask: V, other: &Stand<S, V>, balls: usize) {
    let (node, new) = (&mut here.node, &other.node);
    take(mask, node.at.values.as_mut(), new.at.values.as_ref());
    for b in 0..balls {
        take(
            mask,
            node.at.balls[b].as_flattened_mut(),
            new.at.balls[b].as_flattened(),
        );
    }
    for (rates, new) in node.rates.iter_mut().zip(&new.rates) {
        take(mask, rates.as_mut(), new.as_ref());
    }
    take(mask, node.far.as_mut(), new.far.as_ref());
    take(mask, &mut node.slopes, &new.slopes);
    let mut scalars = [node.inverse_norm, node.across, node.open];
    take(mask, &mut scalars, &[new.inverse_norm, new.across, new.open]);
    [node.inverse_norm, node.across, node.open] = scalars;
    for (screw, new) in here.screws.as_mut().iter_mut().zip(other.screws.as_ref()) {
        take(mask, screw.as_mut(), new.as_ref());
    }
    for (column, new) in here.inverse.0.as_mut().iter_mut().zip(other.inverse.0.as_ref()) {
        take(mask, column.as_mut(), new.as_ref());
    }
}

/// Takes new numbers over in the lanes where another is not negative.
#[inline(always)]
fn take<V: Vector>(mask: V, old: &mut [V], new: &[V]) {
    let none = V::splat(-f64::MIN_POSITIVE);
    for (x, y) in old.iter_mut().zip(new) {
        *x = mask.if_greater(none, *y, *x);
    }
}
