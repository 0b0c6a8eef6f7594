//! Curves that pass change points: each arc between two of them once, and arcs that pass smoothly joined.

use super::change_points::{self, AT_POINT, ChangePoint};
use super::curve::{Curve, End, Node, measure};
use super::follow::{self, Start, Stop};
use super::found::Bound;
use super::on_curve::lies_on;
use super::turnings::begun_at;
use super::walked_again;
use crate::loops::equation::chain::Chain;
use crate::loops::equation::closed::{At, Closed};
use crate::loops::equation::dense::{Array, dot, length, singular_values};
use std::f64::consts::TAU;

/// Rounds of arcs that lead to further change points; the curves of a linkage pass a few.
const MOST_ROUNDS: usize = 32;

/// No change point is sought again so near to a pose [rad, or relative to the size] that had none, nor at all after so many of them:
/// such a loop is degenerate throughout.
const TRIED: f64 = 1e-3;
const MOST_FAILED: usize = 16;

/// Of poses at which curves coincide, or on a surface, no more than so many are searched: every pose near by is like them.
const MOST_ALIKE: usize = 64;

/// Curves with too many nodes after which nothing is followed any more: on what is nearly a surface of poses each leads to another such
/// curve, and each takes a second.
const MOST_ENDLESS: usize = 2;

/// Nodes of all arcs after which the same holds, 130 MB: many arcs run ever more slowly into places where curves touch.
const MOST_HELD: usize = 300_000;

/// Spheres on which ways out are searched after which the same holds: next to a surface of poses each place seems a change point, and each
/// takes a tenth of a second. Special loops need up to 31, seven axes at right angles more than 60.
const MOST_SPHERES: usize = 100;

/// Places of a curve at which it nearly loses rank that are searched: where it does all along, rounding makes thousands of them.
const MOST_NARROW: usize = 64;

/// Curves that near a place ever more slowly are followed farther until so many led to none.
const MOST_PATIENCE: usize = 4;

/// Norm of the screws' inverse at a pose beyond which none is nearer to a change point.
const BLIND: f64 = 1e6;

/// Norm of the screws' inverse from which a place may lie beside a change point.
const NARROW: f64 = 1e4;

/// A pose beside a change point lies on the way out whose tangent has a greater cosine with the direction to it.
const ALONG: f64 = 0.99;

/// A way out of a change point: which one, and which of its rays.
type Ray = (usize, usize);

/// A curve between two change points; none at an end that has another reason.
struct Arc<S: Closed> {
    curve: Curve<S>,
    /// Where it begins and ends.
    ends: [Option<Ray>; 2],
}

/// Change points and the arcs between them.
pub(crate) struct Arcs<S: Closed = Chain> {
    pub points: Vec<ChangePoint<S>>,
    arcs: Vec<Arc<S>>,
    /// For each point and ray whether its arc is known, or there is none.
    done: Vec<Vec<bool>>,
    /// Where walks ended and there is none.
    failed: Vec<At<S>>,
    /// How many poses were searched about which every pose is like them.
    alike: usize,
    /// How many spheres were searched for ways out.
    spheres: usize,
    /// How many more curves may be followed to where they end however slowly they near it.
    pub patience: usize,
    /// Curves with too many nodes so far, in the arcs or not, be they kept or not; and arcs that were dropped as there are enough.
    pub endless: usize,
    dropped: usize,
    /// How many of the points the arcs end at, where they come by.
    respected: usize,
    /// The most freedoms with which the loop moves out of a pose that was looked at.
    pub finite: usize,
}

impl<S: Closed> Arcs<S> {
    /// None yet.
    pub fn new() -> Self {
        Self {
            points: Vec::new(),
            arcs: Vec::new(),
            done: Vec::new(),
            failed: Vec::new(),
            alike: 0,
            spheres: 0,
            patience: MOST_PATIENCE,
            endless: 0,
            dropped: 0,
            respected: 0,
            finite: 0,
        }
    }

    /// The change point that a pose is at.
    pub fn at(&self, chain: &S, pose: &At<S>) -> Option<usize> {
        self.points.iter().position(|p| p.is_at(chain, pose))
    }

    /// Whether a mode is a place of an arc, or one of the points.
    pub fn hold(&self, chain: &S, mode: &At<S>) -> bool {
        self.at(chain, mode).is_some() || self.arcs.iter().any(|a| lies_on(chain, &a.curve, mode))
    }

    /// Whether there is any motion out of the points.
    pub fn is_empty(&self) -> bool {
        self.arcs.is_empty()
    }

    /// The bound of work that is reached, after which nothing more is followed.
    pub fn bound(&self) -> Option<Bound> {
        let held = || self.arcs.iter().map(|a| a.curve.nodes.len()).sum::<usize>();
        if self.endless >= MOST_ENDLESS {
            Some(Bound::LongCurves)
        } else if self.spheres >= MOST_SPHERES {
            Some(Bound::ChangePoints)
        } else {
            (held() > MOST_HELD).then_some(Bound::Memory)
        }
    }

    /// Whether nothing more is followed.
    pub fn is_endless(&self) -> bool {
        self.bound().is_some()
    }

    /// Forgets the arcs, once they are joined.
    pub fn forget(&mut self) {
        self.arcs = Vec::new();
    }

    /// How many ways out of the points were not followed, as curves have no end.
    pub fn not_followed(&self) -> usize {
        self.dropped + self.done.iter().flatten().filter(|done| !**done).count()
    }

    pub fn stops(&self) -> Vec<Stop<S>> {
        self.points.iter().map(ChangePoint::stop).collect()
    }

    /// Whether there is a change point at or near a pose, known or now found.
    pub fn learn(&mut self, chain: &S, pose: &At<S>, wished: &[usize], stuck: bool) -> Option<usize> {
        if let Some(known) = self.at(chain, pose) {
            return Some(known);
        }
        let tried = |at: &At<S>| length(&chain.difference(at, pose)) < TRIED;
        let degenerate = self.failed.len() >= MOST_FAILED || (self.alike >= MOST_ALIKE && !stuck);
        if degenerate || self.spheres >= MOST_SPHERES || self.failed.iter().any(tried) {
            return None;
        }
        let Some(found) =
            change_points::change_point(chain, pose, (wished, stuck), f64::INFINITY, &mut self.spheres)
        else {
            if stuck && is_blind(chain, pose) {
                self.failed.push(*pose);
            }
            return None;
        };
        self.finite = self.finite.max(found.finite);
        // on a surface every pose is like this one, and where curves coincide
        if found.rays.is_empty() && (found.finite > 1 || found.lost > 0) {
            self.alike += 1;
            return None;
        }
        if let Some(known) = self.at(chain, &found.at) {
            return Some(known);
        }
        self.done.push(vec![false; found.rays.len()]);
        self.points.push(found);
        Some(self.points.len() - 1)
    }

    /// Follows every ray of every point, and of those that they lead to; gives closed curves that passed the points by.
    pub fn complete(&mut self, chain: &S, wished: &[usize]) -> Vec<Curve<S>> {
        let mut passing = Vec::new();
        for _ in 0..MOST_ROUNDS {
            self.keep_apart(chain, wished);
            self.cut(chain);
            let rays: Vec<Ray> = (0..self.points.len())
                .flat_map(|p| (0..self.done[p].len()).map(move |r| (p, r)))
                .filter(|&(p, r)| !self.done[p][r])
                .collect();
            if rays.is_empty() || self.is_endless() {
                break;
            }
            let starts: Vec<Start<S>> = rays.iter().map(|&(p, r)| self.points[p].rays[r].start).collect();
            let mut followed = follow::follow(chain, &starts, &self.stops());
            let count = self.points.len();
            for (&(p, r), curve) in rays.iter().zip(&mut followed) {
                let start = self.points[p].rays[r].start;
                let mut patience = self.patience;
                walked_again::follow_on(chain, start, curve, &mut patience, &mut |curve| {
                    for place in narrow_places(curve) {
                        self.learn(chain, &place, wished, false);
                    }
                    let mut all = true;
                    for end in curve.singular_ends() {
                        all &= self.learn(chain, end, wished, true).is_some();
                    }
                    (all, self.stops())
                });
                self.patience = patience;
            }
            // those that come by the points that they have led to, or towards them, are followed once more, to end there
            let fresh = self.stops().split_off(count);
            for (ray, curve) in rays.into_iter().zip(followed) {
                let towards = !fresh.is_empty() && curve.ends_by(End::Narrow);
                if !towards && !curve.nodes.iter().any(|n| is_at(chain, n, &fresh)) {
                    self.take(chain, ray, curve, &mut passing);
                }
            }
        }
        passing
    }

    fn take(&mut self, chain: &S, (point, ray): Ray, curve: Curve<S>, passing: &mut Vec<Curve<S>>) {
        if std::mem::replace(&mut self.done[point][ray], true) {
            return;
        }
        if follow::is_endless(chain, &curve) {
            if self.is_endless() {
                self.dropped += 1;
                return;
            }
            self.endless += 1;
        }
        if curve.is_closed() {
            passing.push(curve);
        } else if !curve.ends_by(End::Open) {
            let [first, last] = curve.ends();
            let end = self.at(chain, last).filter(|&p| p == point).map(|p| (p, ray));
            let begin = self.at(chain, first).and_then(|p| {
                (0..self.done[p].len())
                    .find(|&r| !self.done[p][r] && lies_on(chain, &curve, &self.points[p].rays[r].start.0))
                    .or_else(|| self.ray_along(chain, p, first))
                    .map(|r| (p, r))
            });
            if let Some((p, r)) = begin {
                self.done[p][r] = true;
            }
            self.arcs.push(Arc { curve, ends: [begin, end] });
        }
    }

    /// The one way out of a point, of those not followed, in whose direction a pose lies; `None` where several or none do.
    fn ray_along(&self, chain: &S, point: usize, at: &At<S>) -> Option<usize> {
        let off = chain.difference(&self.points[point].at, at);
        let along = |r: &usize| dot(&self.points[point].rays[*r].tangent(), &off) > ALONG * length(&off);
        let mut rays = (0..self.done[point].len())
            .filter(|&r| !self.done[point][r])
            .filter(along);
        rays.next().filter(|_| rays.next().is_none())
    }

    /// Seeks the ways out of points again, nearer to them, that reach as far as another point.
    fn keep_apart(&mut self, chain: &S, wished: &[usize]) {
        for p in 0..self.points.len() {
            let point = &self.points[p];
            let others = self.points[..p].iter().chain(&self.points[p + 1..]);
            let crowded = others.filter_map(|other| point.crowded(chain, other));
            let within = crowded.fold(f64::INFINITY, f64::min);
            if within == f64::INFINITY {
                continue;
            }
            let how = (wished, true);
            match change_points::change_point(chain, &point.at, how, within, &mut self.spheres) {
                Some(nearer) => self.points[p] = nearer,
                None => {
                    self.points[p].blur();
                    continue;
                }
            }
            self.done[p] = vec![false; self.points[p].rays.len()];
            self.take_back(|arc| arc.ends.iter().flatten().any(|end| end.0 == p));
        }
    }

    /// Takes back arcs; ways out along which they ran are to be followed again.
    fn take_back(&mut self, wrong: impl Fn(&Arc<S>) -> bool) {
        let done = &mut self.done;
        self.arcs.retain(|arc| {
            let wrong = wrong(arc);
            if wrong {
                for &(p, r) in arc.ends.iter().flatten() {
                    // a point may have other ways out by now
                    if let Some(done) = done[p].get_mut(r) {
                        *done = false;
                    }
                }
            }
            !wrong
        });
    }

    /// Takes back arcs that run through points that were not known when they were followed.
    fn cut(&mut self, chain: &S) {
        let points = self.stops().split_off(self.respected);
        self.respected = self.points.len();
        let through = |n: &Node<S>| is_at(chain, n, &points);
        // an arc that begins where it ends has one node
        self.take_back(|arc| {
            let inner = arc.curve.nodes.get(1..arc.curve.nodes.len() - 1);
            inner.is_some_and(|nodes| nodes.iter().any(through))
        });
    }

    /// The arc that goes on smoothly beyond an end, and which of its ends is there.
    fn beyond(&self, end: Option<Ray>) -> Option<(usize, usize)> {
        let (point, ray) = end?;
        let next = Some((point, self.points[point].partner[ray]?));
        self.arcs
            .iter()
            .enumerate()
            .find_map(|(k, arc)| arc.ends.iter().position(|e| *e == next).map(|side| (k, side)))
    }

    /// The smooth curves that the arcs make together, on which the given column rises: in all, or at first where that says nothing.
    pub fn joined(&self, chain: &S, rising: usize) -> Vec<Curve<S>> {
        let stops = self.stops();
        let mut used = vec![false; self.arcs.len()];
        let mut curves = Vec::new();
        for first in 0..self.arcs.len() {
            if used[first] {
                continue;
            }
            // back to where it begins, or round
            let (mut begin, mut side) = (first, 0);
            for _ in 0..self.arcs.len() {
                match self.beyond(self.arcs[begin].ends[side]) {
                    Some((arc, end)) if !used[arc] => (begin, side) = (arc, 1 - end),
                    _ => break,
                }
                if (begin, side) == (first, 0) {
                    break;
                }
            }
            let mut row: Vec<(usize, usize)> = Vec::new();
            let (mut arc, mut entered) = (begin, side);
            let closed = loop {
                used[arc] = true;
                row.push((arc, entered));
                match self.beyond(self.arcs[arc].ends[1 - entered]) {
                    None => break false,
                    Some(next) if next == (begin, side) => break true,
                    Some((next, _)) if used[next] => break false,
                    Some(next) => (arc, entered) = next,
                }
            };
            let curve = self.join(chain, &row, closed, &stops);
            if falls(&curve, rising) {
                // the other way, each arc entered where it was left
                row.reverse();
                row.iter_mut().for_each(|(_, entered)| *entered = 1 - *entered);
                curves.push(self.join(chain, &row, closed, &stops));
            } else {
                curves.push(curve);
            }
        }
        curves
    }

    /// One curve of arcs, each entered at one of its ends, turns counted on.
    fn join(&self, chain: &S, row: &[(usize, usize)], closed: bool, stops: &[Stop<S>]) -> Curve<S> {
        let mut nodes: Vec<Node<S>> = Vec::new();
        let mut middle = 0;
        let mut why = [End::Closed; 2];
        for (n, &(k, entered)) in row.iter().enumerate() {
            let arc = &self.arcs[k];
            let turned = (entered == 1).then(|| walked_again::turned_round(chain, &arc.curve, stops));
            let curve = turned.as_ref().unwrap_or(&arc.curve);
            let turns = nodes.last().map_or(S::Columns::filled(0.0), |last| {
                counted_on(chain, last, &curve.nodes[0])
            });
            nodes.extend(curve.nodes.iter().map(|node| shifted(node, &turns)));
            if n == 0 {
                middle = nodes.len() / 2;
                if !closed {
                    why[0] = curve.why[0];
                }
            }
            if n + 1 < row.len() || closed {
                nodes.push(self.crossing(chain, arc.ends[1 - entered], nodes[nodes.len() - 1]));
            } else {
                why[1] = curve.why[1];
            }
        }
        if closed {
            let turns = counted_on(chain, &nodes[nodes.len() - 1], &nodes[0]);
            nodes.push(shifted(&nodes[0], &turns));
        }
        measure(chain, &mut nodes);
        let curve = Curve { nodes, why };
        if closed { begun_at(&curve, middle) } else { curve }
    }

    /// The node of a change point that an arc runs into by a ray, its turns as in the arc's last node.
    fn crossing(&self, chain: &S, end: Option<Ray>, last: Node<S>) -> Node<S> {
        let (point, ray) = end.unwrap_or_else(|| unreachable!());
        let point = &self.points[point];
        let mut at = point.at;
        let by = chain.difference(&last.at, &at);
        for c in 0..S::COLUMNS {
            at.values[c] = last.at.values[c] + by[c];
        }
        let tangent = point.rays[ray].tangent().map(|t| -t);
        Node::crossing(at, tangent, AT_POINT * point.cut)
    }
}

/// Whether no place can be nearer to where a curve is not smooth, as rounding has it.
fn is_blind<S: Closed>(chain: &S, pose: &At<S>) -> bool {
    let (values, _) = singular_values(&chain.screws(pose));
    chain.columns() < 2 || values[chain.columns() - 2] * BLIND < 1.0
}

/// Whether a node lies where walks end that run into one of some points.
fn is_at<S: Closed>(chain: &S, node: &Node<S>, points: &[Stop<S>]) -> bool {
    let near = |p: &Stop<S>| length(&chain.difference(&p.at, &node.at)) < p.radius;
    points.iter().any(near)
}

fn falls<S: Closed>(curve: &Curve<S>, column: usize) -> bool {
    let (first, last) = (&curve.nodes[0], &curve.nodes[curve.nodes.len() - 1]);
    let gained = last.at.values[column] - first.at.values[column];
    if curve.is_closed() && gained.abs() > 1.0 {
        gained < 0.0
    } else {
        first.rates[0][column] < 0.0
    }
}

/// Whole turns that bring a node next to another.
fn counted_on<S: Closed>(chain: &S, last: &Node<S>, next: &Node<S>) -> S::Columns<f64> {
    Array::from_fn(|c| {
        if c < chain.columns() && chain.is_turn(c) {
            TAU * ((last.at.values[c] - next.at.values[c]) / TAU).round()
        } else {
            0.0
        }
    })
}

fn shifted<S: Closed>(node: &Node<S>, turns: &S::Columns<f64>) -> Node<S> {
    let mut out = *node;
    for c in 0..S::COLUMNS {
        out.at.values[c] += turns[c];
    }
    out
}

/// Where a curve nearly loses rank without an end: a place of it at each least distance, of many the nearest.
pub(super) fn narrow_places<S: Closed>(curve: &Curve<S>) -> Vec<At<S>> {
    let norm = |k: usize| curve.nodes.get(k).map_or(0.0, |n| n.inverse_norm);
    let mut places: Vec<usize> = (0..curve.nodes.len())
        .filter(|&k| norm(k) > NARROW && norm(k) >= norm(k + 1) && (k == 0 || norm(k) >= norm(k - 1)))
        .collect();
    if places.len() > MOST_NARROW {
        places.sort_by(|&a, &b| norm(b).total_cmp(&norm(a)));
        places.truncate(MOST_NARROW);
    }
    places.into_iter().map(|k| curve.nodes[k].at).collect()
}

/// Whether a curve is one that an arc is part of.
pub(super) fn contains<S: Closed>(chain: &S, curve: &Curve<S>, arcs: &Arcs<S>) -> bool {
    arcs.arcs
        .iter()
        .any(|a| lies_on(chain, curve, a.curve.plainest()))
}
