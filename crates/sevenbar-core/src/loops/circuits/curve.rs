//! One connected motion of a chain, followed by arc length in steps that cannot leave it.
//!
//! At a node `x0` let `A` be the screws, `t` the unit tangent, `A+` the pseudo-inverse, and `p(s)` the cubic whose rates
//! `t + u1 s + u2 s^2` solve the closure of velocities to that order (see [`velocities`]). On the plane `t (x - x0) = s` the
//! simplified Newton map about `p(s)` changes by at most
//!
//! `k = s |A+ A1| + s^2 |A+ A2| + |A+| (s^3 K3 / 6 + L r)`
//!
//! times the distance within the ball of radius `r`, where `A + s A1 + s^2 A2` is the series of the screws along `p`, `K3` bounds
//! its third derivative and `L` how the screws and the closure's coordinates change across. The closure error along `p` grows with
//! the fourth power of `s` but for `K5 s^5 / 120`, so the correction `d` measured at the end of a step bounds that in between. Where
//! `k <= 1/2` with `r` twice that bound, exactly one solution lies in each ball, for all `s` of the step, and moves continuously with
//! it (Newton and Kantorovich): it is the curve through `x0`. Only such steps are taken. And where `k < 1` with a larger `r`, no
//! other solution lies in the wider tube: what closes in there is a place of this curve.
//!
//! In a chain with redundant constraints the argument holds for the constraints that count, and that the others close as well
//! is checked in every node. A ball's three columns are the vector of its turn.
//!
//! Source: docs/theory.md, (7) to (12).

use crate::loops::equation::chain::Chain;
use crate::loops::equation::closed::{At, Closed, Inverse, Joint, Screws, copied, twist_of};
use crate::loops::equation::dense::{Array, combined, dot, length, singular_values};
use crate::loops::equation::rotations::{cross, short_way};
use crate::loops::rates::velocities::{self, Rates};
use crate::number::Number;

/// Longest step [rad, or relative to the size].
const LONGEST: f64 = 0.25;

/// Change of the Newton map that steps aim at, that they must not exceed, and that bounds the tube in which a curve is alone.
const AIMED: f64 = 0.34;
const CONTRACTING: f64 = 0.5;
const ALONE: f64 = 0.9;

/// A column that goes over less than this part of the curve's length stands still.
const STILL: f64 = 1e-9;

/// Guesses of a step's length, each from the one before.
const GUESSES: usize = 3;

/// A step changes no turn by more than this many times its length.
pub(super) const REACH: f64 = 2.0;

/// Corrections of a step with the inverse of the node before, each by so many terms of Neumann's series.
const NEUMANN: usize = 3;

/// What a step's second correction may leave.
const SETTLED: f64 = 1e-5;

/// A place of the curve: the joints, how they move on, and how far that can be trusted.
#[derive(Debug)]
pub(crate) struct Node<S: Closed = Chain, N: Number = f64> {
    pub at: At<S, N>,
    /// Series of the joints' rates by the distance from the plane across the unit tangent, which is the first.
    pub rates: Rates<S, N>,
    /// To the next node, measured along this node's tangent.
    pub step: N,
    /// Radius about the predicted places of the step within which the curve is alone.
    pub tube: N,
    /// Norm of the pseudo-inverse of the screws; zero in the node of a change point, which has none.
    pub inverse_norm: N,
    /// Norms of the first and second coefficient of the screws' series, seen through the pseudo-inverse.
    pub slopes: [N; 2],
    /// How fast the Newton map changes across the curve.
    pub across: N,
    /// No two points of a cycle are farther apart.
    pub far: S::Cycles<N>,
    /// Closure error of the constraints that do not count [rad, or relative to the size].
    pub open: N,
}

/// A node with what steps from it need.
pub(super) struct Stand<S: Closed, N: Number> {
    pub node: Node<S, N>,
    pub screws: Screws<S, N>,
    /// Of the screws with the tangent for the last row.
    pub inverse: Inverse<S, N>,
}

/// A step that was tried.
pub(super) struct Step<S: Closed, N: Number> {
    pub next: Stand<S, N>,
    /// Not negative where the argument allows the step.
    pub allowed: N,
    /// Radius within which the curve is alone.
    pub tube: N,
    /// The correction at its end by the fourth power of its length.
    pub growth: N,
}

copied!(Node<S, N>, Stand<S, N>);

/// Why a curve ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    /// It came back to its start.
    Closed,
    /// It runs into a place where it is not smooth.
    Singular,
    /// It nears such a place so slowly that it was followed no farther: curves touch there.
    Narrow,
    /// Its redundant constraints disagree: it does not move.
    Open,
    /// A slide or screw left the range, or there were too many nodes.
    Far,
}

/// A followed motion. A closed one ends with the node it began with, its turns counted on.
#[derive(Debug)]
pub(crate) struct Curve<S: Closed = Chain> {
    pub nodes: Vec<Node<S>>,
    /// Why it goes no farther at its first node, and at its last.
    pub why: [End; 2],
}

impl<S: Closed> Clone for Curve<S> {
    fn clone(&self) -> Self {
        Self { nodes: self.nodes.clone(), why: self.why }
    }
}

impl<S: Closed> Curve<S> {
    /// Its first place and its last.
    pub fn ends(&self) -> [&At<S>; 2] {
        [&self.nodes[0].at, &self.nodes[self.nodes.len() - 1].at]
    }

    /// Whether it comes back to its start.
    pub fn is_closed(&self) -> bool {
        self.why == [End::Closed; 2]
    }

    /// Whether one of its ends, or both, has a reason.
    pub fn ends_by(&self, reason: End) -> bool {
        self.why.contains(&reason)
    }

    /// The ends at which it runs into a place where it is not smooth.
    pub fn singular_ends(&self) -> impl Iterator<Item = &At<S>> {
        let ends = self.ends().into_iter().zip(self.why);
        ends.filter_map(|(at, why)| matches!(why, End::Singular | End::Narrow).then_some(at))
    }

    /// Whether it runs into a place where it is not smooth.
    pub fn is_stuck(&self) -> bool {
        self.singular_ends().next().is_some()
    }

    /// The place at which it is distinguished from others best: the farthest from any where it is not smooth.
    pub fn plainest(&self) -> &At<S> {
        let regular = self.nodes.iter().filter(|n| !n.is_crossing());
        let best = regular.min_by(|a, b| a.inverse_norm.total_cmp(&b.inverse_norm));
        &best.unwrap_or(&self.nodes[0]).at
    }

    /// How far it leads [rad, and parts of the size].
    pub fn length(&self) -> f64 {
        self.nodes.iter().map(|n| n.step).sum()
    }

    /// Whether it passes change points.
    pub fn crosses(&self) -> bool {
        self.nodes.iter().any(Node::is_crossing)
    }

    /// Whether a column stands still, up to rounding, all along. The place of a change point is known to the root of rounding only.
    pub fn rests(&self, column: usize) -> bool {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for node in self.nodes.iter().filter(|n| !n.is_crossing()) {
            low = low.min(node.at.values[column]);
            high = high.max(node.at.values[column]);
        }
        high - low < STILL * self.length()
    }

    /// What each column gains from the first node to the last.
    pub fn gained(&self) -> S::Columns<f64> {
        let (first, last) = (&self.nodes[0], &self.nodes[self.nodes.len() - 1]);
        combined(&last.at.values, 1.0, &first.at.values, -1.0)
    }

    /// Whether a column comes back whole turns on, be it with dead centres on the way.
    pub fn goes_round(&self, chain: &S, column: usize) -> bool {
        self.is_closed() && chain.is_turn(column) && self.gained()[column].abs() > 1.0
    }
}

impl<S: Closed> Node<S> {
    /// The change point between two arcs that pass it smoothly: the tangent is known, and how the curve bends is not.
    pub fn crossing(at: At<S>, tangent: S::Columns<f64>, reach: f64) -> Self {
        let still = S::Columns::filled(0.0);
        Self {
            at,
            // a rate that is zero is that of a column that turns back, and is set where this is known
            rates: [
                tangent.map(|t| if t == 0.0 { f64::MIN_POSITIVE } else { t }),
                still,
                still,
            ],
            step: 0.0,
            tube: reach,
            inverse_norm: 0.0,
            slopes: [0.0; 2],
            across: ALONE / reach,
            far: S::Cycles::filled(0.0),
            open: 0.0,
        }
    }

    /// Whether it is a change point.
    pub fn is_crossing(&self) -> bool {
        self.inverse_norm == 0.0
    }

    /// The rate of a column by the distance along the tangent.
    #[inline(always)]
    pub fn rate(&self, column: usize, s: f64) -> f64 {
        self.rates[0][column] + s * (self.rates[1][column] + s * self.rates[2][column])
    }

    /// How far a column has moved a distance along the tangent.
    #[inline(always)]
    pub fn gone(&self, column: usize, s: f64) -> f64 {
        s * (self.rates[0][column] + s * (self.rates[1][column] / 2.0 + s * self.rates[2][column] / 3.0))
    }
}

/// A correction below this [rad, or relative to the size] leaves less than `stand` takes off.
const NEARLY_CLOSED: f64 = 1e-6;

/// The move that the rates of a node lead to.
#[inline(always)]
pub(crate) fn predicted<S: Closed, N: Number>(chain: &S, node: &Node<S, N>, s: N) -> S::Columns<N> {
    let (half, third) = (N::splat(0.5), N::splat(1.0 / 3.0));
    let [u0, u1, u2] = &node.rates;
    let mut by = S::Columns::filled(N::splat(0.0));
    for c in 0..chain.columns() {
        let inner = (u1[c] * half).plus_product(u2[c] * third, s);
        by[c] = s * u0[c].plus_product(inner, s);
    }
    for (joint, &c) in chain.joints().iter().zip(chain.first()) {
        if let Joint::Ball(_) = *joint {
            // Magnus: turns of a changing axis do not simply add
            let lean = cross(&u1.as_ref()[c..c + 3], &u0.as_ref()[c..c + 3]);
            let cube = s * s * s * N::splat(1.0 / 12.0);
            for k in 0..3 {
                by[c + k] = by[c + k].plus_product(lean[k], cube);
            }
        }
    }
    by
}

/// The configuration near a closed one, along a direction; the node itself is corrected to rounding.
#[inline(always)]
pub(super) fn stand<S: Closed, N: Number>(
    chain: &S,
    rough: &At<S, N>,
    before: &S::Columns<N>,
) -> Stand<S, N> {
    let (zero, one) = (N::splat(0.0), N::splat(1.0));
    let placed = chain.place(rough);
    let mut inverse = chain.inverse(&placed.screws, before);
    let scale = one / length(&inverse.0[S::ROWS]);
    for x in inverse.0[S::ROWS].as_mut() {
        *x = *x * scale;
    }
    let tangent = inverse.0[S::ROWS];
    for column in &mut inverse.0.as_mut()[..S::ROWS] {
        let along = dot(column, &tangent);
        for c in 0..S::COLUMNS {
            column[c] = column[c].minus_product(tangent[c], along);
        }
    }
    let mut by = inverse.times(placed.error.as_ref());
    for x in by.as_mut() {
        *x = -*x;
    }
    let reached: S::Rows<N> = twist_of(&placed.screws, &by);
    let mut open = zero;
    let mut square = zero;
    for k in 0..S::ROWS {
        let left = placed.error[k] + reached[k];
        open = open.plus_product(left, left);
        for screw in placed.screws.as_ref() {
            square = square.plus_product(screw[k], screw[k]);
        }
    }
    let (rates, screws) = velocities::rates(chain, (rough, &placed), &inverse, &[one, zero, zero], None);
    let mut slopes = [zero; 2];
    for order in 0..2 {
        for screw in &screws[order + 1].as_ref()[..chain.columns()] {
            let seen = inverse.times(screw.as_ref());
            slopes[order] = slopes[order] + dot(&seen, &seen);
        }
        slopes[order] = slopes[order].sqrt();
    }
    let far = chain.farthest(rough);
    let inverse_norm = inverse.square(S::ROWS).sqrt();
    let across = inverse_norm * chain.across(&far, square);
    let mut at = chain.moved(rough, &by);
    at.square_up(chain.ball_count());
    Stand {
        node: Node {
            at,
            rates,
            step: zero,
            tube: zero,
            inverse_norm,
            slopes,
            across,
            far,
            // not closed at all if turned right round
            open: placed.closing_cosine.if_greater(zero, open.sqrt(), one),
        },
        screws: placed.screws,
        inverse,
    }
}

/// The node at a closed configuration; `None` where its tangent is not known.
pub(crate) fn node_at<S: Closed>(chain: &S, at: &At<S>) -> Option<Node<S>> {
    let (_, vectors) = singular_values(&chain.screws(at));
    let tangent: S::Columns<f64> = Array::padded(vectors.last()?, 0.0);
    let node = stand(chain, at, &tangent).node;
    node.inverse_norm.is_finite().then_some(node)
}

/// `k` of the argument on the curve itself, a step ahead, and `|A+| K5 s^5 / 120`.
///
/// Source: docs/theory.md, (8) to (11).
#[inline(always)]
fn change<S: Closed, N: Number>(chain: &S, node: &Node<S, N>, s: N) -> (N, N) {
    let [third, fifth] = chain.bounds(node.inverse_norm, &node.far, &node.rates, s);
    let square = s * s;
    let third = third * s * square * N::splat(1.0 / 6.0);
    let k = (s * node.slopes[0]).plus_product(square, node.slopes[1]) + third;
    (k, fifth * square * square * s * N::splat(1.0 / 120.0))
}

/// `k` of the argument with the radius that a closure error growing by `growth` times the fourth power asks for.
#[inline(always)]
fn asked<S: Closed, N: Number>(chain: &S, node: &Node<S, N>, s: N, growth: N) -> N {
    let (k, rest) = change(chain, node, s);
    let error = (s * s * s * s * growth).plus_product(N::splat(2.0), rest);
    k.plus_product(N::splat(2.0) * node.across, error)
}

/// The length of a step that is likely to be allowed, where the closure error grew like this on the last one.
#[inline(always)]
pub(super) fn likely<S: Closed, N: Number>(chain: &S, node: &Node<S, N>, growth: N) -> N {
    let aim = N::splat(AIMED);
    let mut s = (aim / node.slopes[0]).lesser(N::splat(LONGEST));
    for _ in 0..GUESSES {
        s = s * (aim / asked(chain, node, s, growth)).sqrt();
    }
    s.lesser(N::splat(LONGEST))
}

/// Radius about the predicted places of a step within which the curve is alone; not positive where that is not known.
pub(crate) fn tube<S: Closed>(chain: &S, node: &Node<S>, step: f64) -> f64 {
    (ALONE - change(chain, node, step.abs()).0) / node.across
}

/// The stand a step farther along the curve, and what the argument says of the step.
#[inline(always)]
pub(super) fn step<S: Closed, N: Number>(chain: &S, from: &Stand<S, N>, s: N) -> Step<S, N> {
    let node = &from.node;
    let start = chain.moved(&node.at, &predicted(chain, node, s));
    let placed = chain.place(&start);
    let (d, first) = from
        .inverse
        .correction((&from.screws, &placed.screws), &placed.error, NEUMANN);
    let rough = chain.moved(&start, &d);
    let again = chain.place(&rough);
    let (d, _) = from
        .inverse
        .correction((&from.screws, &again.screws), &again.error, NEUMANN);
    let next = stand(chain, &chain.moved(&rough, &d), &node.rates[0]);
    let (k, rest) = change(chain, node, s);
    let error = length(&first);
    let radius = N::splat(2.0) * error.plus_product(N::splat(2.0), rest);
    let settled = N::splat(SETTLED) - length(&d);
    let close = placed.closing_cosine.lesser(settled);
    Step {
        next,
        allowed: (N::splat(CONTRACTING) - k.plus_product(node.across, radius)).lesser(close),
        tube: (N::splat(ALONE) - k) / node.across,
        growth: error / (s * s * s * s),
    }
}

/// The node a step ahead (or behind), for steps within a certified one.
pub(crate) fn ahead<S: Closed>(chain: &S, from: &Node<S>, s: f64) -> Option<Node<S>> {
    let start = chain.moved(&from.at, &predicted(chain, from, s));
    let mut at = start;
    for _ in 0..3 {
        let placed = chain.place(&at);
        let inverse = chain.inverse(&placed.screws, &from.rates[0]);
        let d = inverse.times(placed.error.as_ref()).map(|x| -x);
        at = chain.moved(&at, &d);
        if length(&d) < NEARLY_CLOSED {
            break;
        }
    }
    let off = length(&chain.difference(&start, &at));
    let node = stand(chain, &at, &from.rates[0]).node;
    (off <= tube(chain, from, s) && node.inverse_norm.is_finite()).then_some(node)
}

/// Whether the turns of a configuration are near enough for [`passes_through`]: it distinguishes most nodes at once.
pub(super) fn may_pass<S: Closed>(chain: &S, node: &Node<S>, at: &At<S>) -> bool {
    chain.joints().iter().zip(chain.first()).all(|(joint, &c)| {
        *joint != Joint::Turn || short_way(at.values[c] - node.at.values[c]).abs() <= REACH * node.step
    })
}

/// The turn that two configurations differ by most [rad].
pub(super) fn farthest_turn<S: Closed>(chain: &S, a: &At<S>, b: &At<S>) -> f64 {
    let turns = chain
        .joints()
        .iter()
        .zip(chain.first())
        .filter(|(j, _)| **j == Joint::Turn);
    turns.fold(0.0, |most, (_, &c)| {
        most.max(short_way(b.values[c] - a.values[c]).abs())
    })
}

/// Whether a closed configuration lies in the tube of a node's step: it is then a place of the curve.
pub(crate) fn passes_through<S: Closed>(chain: &S, node: &Node<S>, at: &At<S>) -> Option<f64> {
    let off = chain.difference(&node.at, at);
    let along = dot(&off, &node.rates[0]);
    let slack = 1e-9 * node.step;
    if along < -slack || along > node.step + slack {
        return None;
    }
    let aside = length(&combined(&off, 1.0, &predicted(chain, node, along), -1.0));
    (aside <= node.tube).then_some(along)
}

/// Steps between nodes, measured along the tangent of the first of each two.
pub(super) fn measure<S: Closed>(chain: &S, nodes: &mut [Node<S>]) {
    for k in 1..nodes.len() {
        let by = chain.difference(&nodes[k - 1].at, &nodes[k].at);
        let step = dot(&by, &nodes[k - 1].rates[0]);
        nodes[k - 1].step = step;
        nodes[k - 1].tube = tube(chain, &nodes[k - 1], step);
    }
}
