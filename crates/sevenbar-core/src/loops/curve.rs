//! One connected motion of a chain, followed by arc length in steps that cannot leave it.
//!
//! At a node `x0` with the bordered Jacobian `J = [A; c]` (`A` the screws, `c` the direction before) let
//! `w >= |J^-1 D2F|` bound the curvature of the closure, as seen through `J`, in the neighbourhood. On each plane
//! `c (x - x0) = s c t` with `0 <= s <= 1 / (2 w)` the simplified Newton map contracts a ball of radius `1 / (2 w)` about the
//! point `x0 + s t` of the tangent into itself (Newton and Kantorovich), so exactly one solution lies in each of these balls, and
//! it moves continuously with `s`: it is the curve through `x0`. A step is taken only to a solution inside its ball. The
//! bound adds to the second derivative at the node, formed exactly, what the third can change it by within the ball.
//! In a chain with redundant constraints `J^-1` is the pseudo-inverse: the argument holds for the constraints that count, and
//! that the others close as well is looked at in every node.

use super::chain::{COLUMNS, Chain, Columns, Configuration, Joint, Twist, squared_up};
use super::dense::{Factored, ROWS, singular_values};
use crate::rigid::cross;
use crate::simd::{Kernel, dispatch};

/// Longest step [rad, or parts of the size].
const LONGEST: f64 = 0.25;

/// Shorter steps mean a place where the curve is not smooth: a change point.
const SHORTEST: f64 = 1e-6;

/// Most nodes of a curve; an ordinary circuit has some hundreds.
const MOST_NODES: usize = 400_000;

/// Slides [parts of the size] and screws [rad] are not followed farther than this.
const FARTHEST: f64 = 50.0;

/// The closure error of a node above which redundant constraints have stopped to agree.
const OPEN: f64 = 1e-9;

/// The closure error of a step that did not arrive.
const NOT_CLOSED: f64 = 1e-7;

/// Back at the start when nearer than this in every column.
const RETURNED: f64 = 1e-7;

/// A place of the curve: the joints, the direction, and how it bends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub at: Configuration,
    /// The unit tangent.
    pub tangent: Columns,
    /// Second derivative by arc length.
    pub bend: Columns,
    /// To the next node, measured along this node's tangent.
    pub step: f64,
    /// Certified length of a step.
    pub reach: f64,
    /// Norm of the inverse of the bordered Jacobian.
    pub inverse_norm: f64,
    /// Closure error [rad, or parts of the size], where the node was stepped to.
    pub residual: f64,
}

/// Why a curve ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    /// It came back to its start.
    Closed,
    /// It runs into a place where it is not smooth.
    Singular,
    /// Its redundant constraints disagree: it does not move.
    Open,
    /// A slide or screw left the range, or there were too many nodes.
    Far,
}

/// A followed motion. A closed one ends with the node it began with, its turns counted on.
#[derive(Clone, Debug)]
pub(super) struct Curve {
    pub nodes: Vec<Node>,
    pub end: End,
}

#[inline(always)]
pub(super) fn dot(a: &Columns, b: &Columns) -> f64 {
    let mut sum = 0.0;
    for k in 0..COLUMNS {
        sum += a[k] * b[k];
    }
    sum
}

#[inline(always)]
pub(super) fn combined(a: &Columns, x: f64, b: &Columns, y: f64) -> Columns {
    std::array::from_fn(|k| a[k] * x + b[k] * y)
}

fn length(a: &Columns) -> f64 {
    dot(a, a).sqrt()
}

/// The closure with one more row, reduced; and minus the closure error.
#[inline(always)]
pub(super) fn bordered(
    screws: &[Twist; COLUMNS],
    error: &Twist,
    count: usize,
    row: &Columns,
) -> (Factored, [f64; ROWS]) {
    let mut columns = [[0.0; ROWS]; COLUMNS];
    for c in 0..count {
        columns[c][..6].copy_from_slice(&screws[c]);
        columns[c][6] = row[c];
    }
    let mut right = [0.0; ROWS];
    for k in 0..6 {
        right[k] = -error[k];
    }
    (Factored::new(columns, count), right)
}

/// How the closure bends: the second derivative by columns `i <= j`, where `same_ball` tells columns of one ball.
#[inline(always)]
fn second_derivative(a: &Twist, b: &Twist, same_ball: bool) -> Twist {
    let part = |t: &Twist, i: usize| [t[i], t[i + 1], t[i + 2]];
    let shift = cross(part(a, 0), part(b, 3));
    if same_ball {
        // the turn of a ball is one rotation, in which its columns are alike
        let other = cross(part(b, 0), part(a, 3));
        return [
            0.0,
            0.0,
            0.0,
            0.5 * (shift[0] + other[0]),
            0.5 * (shift[1] + other[1]),
            0.5 * (shift[2] + other[2]),
        ];
    }
    let turn = cross(part(a, 0), part(b, 0));
    [
        0.5 * turn[0],
        0.5 * turn[1],
        0.5 * turn[2],
        shift[0],
        shift[1],
        shift[2],
    ]
}

impl Chain {
    /// For each column the ball it belongs to.
    fn balls(&self) -> [Option<usize>; COLUMNS] {
        let mut out = [None; COLUMNS];
        for (joint, &column) in self.joints.iter().zip(&self.first) {
            if let Joint::Ball(b) = *joint {
                out[column..column + 3].fill(Some(b));
            }
        }
        out
    }

    /// A bound of the third derivative of the closure: no point is farther than the sum of the links, one, and of the slides.
    fn third_derivative(&self, at: &Configuration) -> f64 {
        let joints = self.joints.len() as f64;
        let mut farthest = 1.0;
        for (joint, &c) in self.joints.iter().zip(&self.first) {
            farthest += match *joint {
                Joint::Slide => at.values[c].abs(),
                Joint::Screw(advance) => (advance * at.values[c]).abs(),
                _ => 0.0,
            };
        }
        2.0 * farthest * joints * joints.sqrt()
    }

    /// The node at a closed configuration, with the direction that goes along `before`.
    #[inline(always)]
    pub fn node(&self, rough: &Configuration, before: &Columns) -> Option<Node> {
        let placed = self.place(rough);
        let n = self.columns;
        let (factored, right) = bordered(&placed.screws, &placed.error, n, before);
        let correction = factored.solve(right);
        let mut unit = [0.0; ROWS];
        unit[6] = 1.0;
        let along = factored.solve(unit);
        let size = length(&along);
        if !(size.is_finite() && size > 0.0 && correction.iter().all(|c| c.is_finite())) {
            return None;
        }
        let tangent = along.map(|x| x / size);
        let inverse = factored.inverse();
        let mut inverse_square = 0.0;
        for row in &inverse {
            inverse_square += dot(row, row);
        }
        let balls = self.balls();
        let mut bend = [0.0; COLUMNS];
        let mut square = 0.0;
        for i in 0..n {
            for j in i..n {
                let together = balls[i].is_some() && balls[i] == balls[j];
                let second = second_derivative(&placed.screws[i], &placed.screws[j], together);
                let mut seen = [0.0; COLUMNS];
                for (row, x) in inverse.iter().zip(&second) {
                    for k in 0..COLUMNS {
                        seen[k] += row[k] * x;
                    }
                }
                let twice = if i == j { 1.0 } else { 2.0 };
                square += twice * dot(&seen, &seen);
                let weight = twice * tangent[i] * tangent[j];
                for k in 0..COLUMNS {
                    bend[k] -= weight * seen[k];
                }
            }
        }
        let inverse_norm = inverse_square.sqrt();
        let curvature = square.sqrt();
        // w = curvature + third / w: within the ball of radius 1 / (2 w) about points up to 1 / (2 w) away
        let third = inverse_norm * self.third_derivative(rough);
        let bound = 0.5 * (curvature + (curvature * curvature + 4.0 * third).sqrt());
        let mut at = self.moved(rough, &correction);
        for ball in &mut at.balls {
            *ball = squared_up(ball);
        }
        // a bend along the tangent is only a change of pace
        let pace = dot(&bend, &tangent);
        Some(Node {
            at,
            tangent,
            bend: combined(&bend, 1.0, &tangent, -pace),
            step: 0.0,
            reach: 0.5 / bound,
            inverse_norm,
            residual: 0.0,
        })
    }

    /// The node a step farther along the curve, if its solution lies in the ball of the argument.
    #[inline(always)]
    pub fn ahead(&self, from: &Node, step: f64) -> Option<Node> {
        let guess = combined(&from.tangent, step, &from.bend, 0.5 * step * step);
        let (near, correction) = self.corrected(&self.moved(&from.at, &guess), from)?;
        // from the tangent's point, bend and correction together
        let off = combined(&from.bend, 0.5 * step * step, &correction, 1.0);
        if length(&off) > from.reach || length(&off).is_nan() {
            return None;
        }
        let mut node = self.node(&near, &from.tangent)?;
        node.residual = self.residual(&self.place(&node.at));
        (node.residual < NOT_CLOSED).then_some(node)
    }

    /// One Newton step in the plane across the tangent of a node.
    #[inline(always)]
    fn corrected(&self, rough: &Configuration, from: &Node) -> Option<(Configuration, Columns)> {
        let placed = self.place(rough);
        let (factored, right) = bordered(&placed.screws, &placed.error, self.columns, &from.tangent);
        let correction = factored.solve(right);
        correction
            .iter()
            .all(|c| c.is_finite())
            .then(|| (self.moved(rough, &correction), correction))
    }

    /// Any direction in which a closed configuration can move: the null vector of its screws.
    pub fn direction(&self, at: &Configuration) -> Columns {
        let (_, vectors) = singular_values(&self.screws(at));
        let mut out = [0.0; COLUMNS];
        if let Some(last) = vectors.last() {
            out[..last.len()].copy_from_slice(last);
        }
        out
    }

    /// Follows the motion through a closed configuration until it comes back, in both directions where it does not.
    pub fn follow(&self, start: &Configuration) -> Curve {
        let direction = self.direction(start);
        let Some(first) = self.node(start, &direction) else {
            return Curve { nodes: Vec::new(), end: End::Singular };
        };
        let forward = self.walk(first);
        if forward.end == End::Closed || forward.end == End::Open {
            return forward;
        }
        let mut back = first;
        back.tangent = back.tangent.map(|t| -t);
        let backward = self.walk(back);
        let mut nodes = reversed(self, &backward).nodes;
        nodes.pop();
        nodes.extend(forward.nodes);
        Curve { nodes, end: forward.end }
    }

    fn walk(&self, first: Node) -> Curve {
        let mut curve = Curve { nodes: Vec::new(), end: End::Far };
        dispatch(Walk { chain: self, first, curve: &mut curve });
        curve
    }

    #[inline(always)]
    fn walk_on(&self, first: Node) -> Curve {
        let mut nodes = vec![first];
        let mut gone = 0.0;
        loop {
            let last = nodes.len() - 1;
            let node = nodes[last];
            let mut step = node.reach.min(LONGEST);
            let next = loop {
                if step < SHORTEST {
                    return Curve { nodes, end: End::Singular };
                }
                if let Some(next) = self.ahead(&node, step) {
                    break next;
                }
                step *= 0.5;
            };
            if next.residual > OPEN {
                return Curve { nodes, end: End::Open };
            }
            gone += step;
            nodes[last].step = step;
            if gone > 3.0 * (first.reach.min(LONGEST) + step)
                && let Some(end) = self.returned(&first, &node, &next)
            {
                nodes[last].step = end.0;
                nodes.push(end.1);
                return Curve { nodes, end: End::Closed };
            }
            let far = self.joints.iter().zip(&self.first).any(|(joint, &c)| {
                !matches!(joint, Joint::Turn | Joint::Ball(_)) && next.at.values[c].abs() > FARTHEST
            });
            nodes.push(next);
            if far || nodes.len() > MOST_NODES {
                return Curve { nodes, end: End::Far };
            }
        }
    }

    /// The start, its turns counted on, where it lies between two nodes: with the step that leads there.
    fn returned(&self, first: &Node, from: &Node, to: &Node) -> Option<(f64, Node)> {
        let ahead = self.difference(&from.at, &first.at);
        let along = dot(&ahead, &from.tangent);
        let span = dot(&self.difference(&from.at, &to.at), &from.tangent);
        if along < 0.0 || along > span || dot(&first.tangent, &from.tangent) < 0.5 {
            return None;
        }
        if length(&ahead) > 2.0 * span + 1e-3 {
            return None;
        }
        let here = self.ahead(from, along)?;
        let left = self.difference(&here.at, &first.at);
        if left.iter().any(|d| d.abs() > RETURNED) {
            return None;
        }
        // the start itself, with the turns made on the way
        let mut end = *first;
        for c in 0..self.columns {
            if self.is_turn(c) {
                let turn = std::f64::consts::TAU;
                end.at.values[c] += turn * ((here.at.values[c] - first.at.values[c]) / turn).round();
            }
        }
        Some((along, end))
    }
}

/// The curve walked the other way.
pub(super) fn reversed(chain: &Chain, curve: &Curve) -> Curve {
    let mut nodes: Vec<Node> = curve.nodes.iter().rev().copied().collect();
    for node in &mut nodes {
        node.tangent = node.tangent.map(|t| -t);
    }
    measure(chain, &mut nodes);
    Curve { nodes, end: curve.end }
}

/// Steps between nodes, measured along the tangent of the first of each two.
pub(super) fn measure(chain: &Chain, nodes: &mut [Node]) {
    for k in 1..nodes.len() {
        let by = chain.difference(&nodes[k - 1].at, &nodes[k].at);
        nodes[k - 1].step = dot(&by, &nodes[k - 1].tangent);
    }
}

/// [`Chain::walk`], compiled for each vector unit.
struct Walk<'a> {
    chain: &'a Chain,
    first: Node,
    curve: &'a mut Curve,
}

impl Kernel for Walk<'_> {
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        *self.curve = self.chain.walk_on(self.first);
    }
}
