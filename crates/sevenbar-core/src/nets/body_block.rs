//! A link that six rows hold at known links, some of them by legs: as a member of its family, and its poses from the solutions.
//!
//! A leg is a link with a joint of few freedoms at a known link and a ball at this one. What it leaves to its ball is a rod, planes, or both;
//! where the ball is gives the leg's own pose.
//!
//! Source: docs/theory_nets.md, (19) to (22).

use super::before::Before;
use super::body_family::{BodyFamily, Held, Holds};
use super::dual_quaternions::{Triple, UNKNOWNS, halves, pose};
use super::hinged::{OnStep, Ways, hinged};
use super::monodromy::{Ends, REAL};
use super::net::Net;
use super::rows::{On, Row};
use super::steps::{ComplexPose, Move, Placement};
use super::two_turns::TwoTurns;
use super::unfolded::turn_towards;
use crate::loops::equation::closure::Solution;
use crate::loops::equation::rotations::squared_up;
use crate::loops::modes::completeness::Completeness;
use crate::rigid::{Pose, Vec3, add, cross, dot, most_perpendicular_axis, scale, sub, unit};
use num_complex::Complex64;

/// A link between a known link and a ball.
#[derive(Clone, Debug, PartialEq)]
pub struct Leg {
    /// The steps that carry it from the known link outwards: one, or two turns about one place.
    pub steps: Vec<usize>,
    /// Its ball as drawn.
    pub ball: Vec3,
    /// The steps that carry the ball's two links, this one first.
    pub on: [On; 2],
}

/// A link, the rows that hold it and its legs.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyBlock {
    /// The steps that carry it from another link outwards.
    pub steps: Vec<usize>,
    /// The rows of each joint and rod between it and known links; of one step, those besides.
    pub rows: Vec<Vec<Row>>,
    /// Its legs.
    pub legs: Vec<Leg>,
}

/// All ways to put a block together: the poses of all steps, how complete they are, if they are not in closed form, and whether a curve of poses
/// closes, of which they are some.
pub(super) struct Placed {
    pub poses: Vec<Vec<Pose>>,
    pub completeness: Option<Completeness>,
    pub on_curve: bool,
}

/// A square that is below zero by less than this part of those that it comes from is zero.
const ROUNDING: f64 = 1e-14;

impl BodyBlock {
    /// The last of its steps.
    pub(super) fn own(&self) -> Option<usize> {
        self.steps.last().copied()
    }

    /// All ways to put it together; `None` where it has not as many rows as freedoms.
    pub(super) fn together(&self, net: &Net, before: &Before) -> Option<Placed> {
        let layout = self.layout(net, before)?;
        if let ([step], [row]) = (&self.steps[..], &layout.family.rows[..]) {
            let seen = |by: f64| layout.seen_on(net, *step, by);
            let Ways { by, at_rest } = hinged(net.steps[*step].moves, before.size, seen, row, &layout.member);
            let placed = |by| self.placed(net, before, &before.moved_by(net, *step, by));
            let poses = by.into_iter().flat_map(placed).collect();
            return Some(Placed { poses, completeness: None, on_curve: at_rest });
        }
        let Layout { family, member, middle, .. } = layout;
        if !family.is_square() {
            return None;
        }
        let starts = family.starts();
        let Ends { regular, left_over } = starts.ends(&family, &member);
        let real = regular.iter().filter_map(|z| real_pose(z, before.size, middle));
        let poses = real.flat_map(|pose| self.placed(net, before, &pose)).collect();
        let completeness = Some(starts.completeness(left_over));
        Some(Placed { poses, completeness, on_curve: false })
    }

    fn layout<'a>(&self, net: &Net, before: &'a Before<'a>) -> Option<Layout<'a>> {
        let mut layout = Layout::new(self.own()?, net, before);
        for rows in &self.rows {
            for row in rows {
                layout.add(row)?;
            }
            layout.shared.clear();
        }
        for leg in &self.legs {
            layout.stand(net, leg)?;
            layout.shared.clear();
        }
        layout.family.vectors = layout.member.len();
        Some(layout)
    }

    /// Its family, and which member it is; `None` where it has not as many rows as freedoms, or is in closed form.
    pub(super) fn member(&self, net: &Net, before: &Before) -> Option<(BodyFamily, Vec<Triple>)> {
        let Layout { family, member, .. } = self.layout(net, before)?;
        family.is_square().then_some((family, member))
    }

    /// Its one row on its one step; `None` of any other.
    pub(super) fn on_step(&self, net: &Net, before: &Before) -> Option<OnStep<f64>> {
        let layout = self.layout(net, before)?;
        let ([step], [row]) = (&self.steps[..], &layout.family.rows[..]) else {
            return None;
        };
        let seen = |by: f64| layout.seen_on(net, *step, by);
        Some(OnStep::of(
            net.steps[*step].moves,
            before.size,
            seen,
            row,
            &layout.member,
        ))
    }

    /// The pose of the link at a solution, complex ones too.
    pub(super) fn complex_pose(&self, net: &Net, z: &Solution<UNKNOWNS>) -> Option<ComplexPose> {
        let [a, b, c, place] = pose(z);
        let turned = Placement {
            rotation: std::array::from_fn(|i| [a[i], b[i], c[i]]),
            translation: [Complex64::ZERO; 3],
        };
        let middle = net.steps[self.own()?].origin;
        let from = turned.carry(&middle);
        let translation = std::array::from_fn(|i| middle[i] + place[i] * net.size - from[i]);
        Some(Placement { translation, ..turned })
    }

    /// The poses of all steps where the link has a pose, for each pose of its legs.
    fn placed(&self, net: &Net, before: &Before, own: &Pose) -> Vec<Vec<Pose>> {
        let Some(link) = self.own() else {
            return Vec::new();
        };
        let mut ways = vec![before.poses.to_vec()];
        ways[0][link] = *own;
        for leg in &self.legs {
            let mut longer = Vec::new();
            for poses in ways {
                for values in leg.reaching(net, before, own, link) {
                    let mut poses = poses.clone();
                    net.follow(&mut poses, &leg.steps, &values);
                    before.weld(&mut poses, &leg.steps);
                    longer.push(poses);
                }
            }
            ways = longer;
        }
        ways.retain_mut(|poses| {
            net.unfold(poses, &self.steps, own);
            before.weld(poses, &[link]);
            // rows of angles hold with a turned axis, too, to which no steps lead
            dot(poses[link].rotation[0], own.rotation[0]) > 0.0
                && dot(poses[link].rotation[1], own.rotation[1]) > 0.0
        });
        ways
    }
}

impl Leg {
    /// Its ball in its own numbers, and the pose of the known link that carries it.
    fn ends(&self, net: &Net, before: &Before) -> Option<(Vec3, Pose)> {
        let (first, last) = (*self.steps.first()?, *self.steps.last()?);
        let offset = before.offset(self.on[0], last)?;
        let parent = net.steps[first].parent;
        Some((
            offset.carry(self.ball),
            parent.map_or(Pose::STILL, |p| before.poses[p]),
        ))
    }

    /// By how much its steps move, in each way, where its ball is where the link has it.
    fn reaching(&self, net: &Net, before: &Before, own: &Pose, link: usize) -> Vec<Vec<f64>> {
        let ends = self.ends(net, before).zip(before.offset(self.on[1], link));
        let Some(((ball, base), on_link)) = ends else {
            return Vec::new();
        };
        let goal = base.inverse().carry(own.then(&on_link).carry(self.ball));
        let first = &net.steps[self.steps[0]];
        let (from, to) = (sub(ball, first.origin), sub(goal, first.origin));
        match self.steps[..] {
            [_] if first.moves == Move::Slide => vec![vec![dot(first.axis, sub(goal, ball))]],
            [_] => vec![vec![turn_towards(first.axis, from, to)]],
            [_, second] => two_turns([first.axis, net.steps[second].axis], from, to),
            _ => Vec::new(),
        }
    }
}

/// The turns about a first axis after a second, through one place, that take a vector to another as long: two ways, one where they meet.
fn two_turns(axes: [Vec3; 2], from: Vec3, to: Vec3) -> Vec<Vec<f64>> {
    let turns = TwoTurns::of(axes, &from, &to);
    if turns.square < -ROUNDING * dot(from, from) / turns.sine_square {
        return Vec::new();
    }
    let height = turns.square.max(0.0).sqrt();
    let heights = if height > 0.0 {
        vec![height, -height]
    } else {
        vec![0.0]
    };
    let way = |height: f64| {
        let between = turns.between(height);
        vec![
            turn_towards(axes[0], between, to),
            turn_towards(axes[1], from, between),
        ]
    };
    heights.into_iter().map(way).collect()
}

/// The pose of a solution, whose lengths count from `middle`; `None` where it is not real.
fn real_pose(z: &Solution<UNKNOWNS>, size: f64, middle: Vec3) -> Option<Pose> {
    let (x, _) = halves(z);
    let greatest = x.iter().copied().max_by(|a, b| a.norm().total_cmp(&b.norm()))?;
    let phase = greatest.conj() / greatest.norm();
    let length = x.iter().map(Complex64::norm_sqr).sum::<f64>().sqrt();
    let real = z.map(|z| z * phase / length);
    if real.iter().any(|z| z.im.abs() > REAL * (1.0 + z.re.abs())) {
        return None;
    }
    let [a, b, c, place] = pose(&real.map(|z| z.re.into())).map(|v| v.map(|z| z.re));
    let rotation = std::array::from_fn(|i| [a[i], b[i], c[i]]);
    let turned = Pose::turning(squared_up(&rotation));
    let translation = sub(add(middle, scale(place, size)), turned.turn(middle));
    Some(Pose { translation, ..turned })
}

/// A block as a member of its family.
struct Layout<'a> {
    link: usize,
    before: &'a Before<'a>,
    /// A place on the link as drawn, from which lengths count: far from the report frame digits would be lost.
    middle: Vec3,
    family: BodyFamily,
    member: Vec<Triple>,
    /// The vectors of one joint, each with its place among all: rows share them.
    shared: Vec<(bool, Vec3, usize)>,
}

impl<'a> Layout<'a> {
    fn new(link: usize, net: &Net, before: &'a Before<'a>) -> Self {
        let family = BodyFamily { vectors: 0, rows: Vec::new() };
        let middle = net.steps[link].origin;
        Self { link, before, middle, family, member: Vec::new(), shared: Vec::new() }
    }

    /// The pose of its link where its one step moves it, with lengths as the rows have them.
    fn seen_on(&self, net: &Net, step: usize, by: f64) -> Pose {
        let pose = self.before.moved_by(net, step, by);
        let translation = self.seen(pose.carry(self.middle));
        Pose { translation, ..pose }
    }

    /// A place from the middle, relative to the size.
    fn seen(&self, place: Vec3) -> Vec3 {
        scale(sub(place, self.middle), 1.0 / self.before.size)
    }

    fn vector(&mut self, own: bool, vector: Vec3) -> usize {
        let same = |s: &&(bool, Vec3, usize)| s.0 == own && s.1 == vector;
        if let Some((.., place)) = self.shared.iter().find(same) {
            return *place;
        }
        self.member.push(vector.map(Complex64::from));
        self.shared.push((own, vector, self.member.len() - 1));
        self.member.len() - 1
    }

    fn hold(&mut self, holds: Holds, known: Vec3, own: Vec3, number: f64) {
        let (known, own) = (self.vector(false, known), self.vector(true, own));
        self.member
            .push([number.into(), Complex64::ZERO, Complex64::ZERO]);
        self.family
            .rows
            .push(Held { holds, known, own, number: self.member.len() - 1 });
    }

    /// The ball of a leg, which its own steps leave on a circle, a line or a sphere.
    fn stand(&mut self, net: &Net, leg: &Leg) -> Option<()> {
        let (ball, base) = leg.ends(net, self.before)?;
        let own = self.seen(self.before.offset(leg.on[1], self.link)?.carry(leg.ball));
        let first = &net.steps[*leg.steps.first()?];
        let moves: Vec<Move> = leg.steps.iter().map(|&s| net.steps[s].moves).collect();
        let arm = scale(sub(ball, first.origin), 1.0 / self.before.size);
        let along = base.turn(first.axis);
        let origin = self.seen(base.carry(first.origin));
        match moves[..] {
            [Move::Slide] => {
                let across = unit(cross(first.axis, most_perpendicular_axis(first.axis)));
                for normal in [across, cross(first.axis, across)].map(|own| base.turn(own)) {
                    let height = dot(normal, self.seen(base.carry(ball)));
                    self.hold(Holds::Plane, normal, own, -height);
                }
            }
            [Move::Turn] => {
                let up = dot(first.axis, arm);
                let centre: Vec3 = std::array::from_fn(|i| origin[i] + up * along[i]);
                let square = dot(arm, arm) - up * up;
                self.hold(Holds::Plane, along, own, -dot(along, centre));
                self.hold(
                    Holds::Rod,
                    centre,
                    own,
                    dot(centre, centre) + dot(own, own) - square,
                );
            }
            [Move::Turn, Move::Turn] if net.steps[leg.steps[1]].origin == first.origin => {
                let number = dot(origin, origin) + dot(own, own) - dot(arm, arm);
                self.hold(Holds::Rod, origin, own, number);
            }
            _ => return None,
        }
        Some(())
    }

    /// A row between the link and a known one; `None` where it is between others.
    fn add(&mut self, row: &Row) -> Option<()> {
        let on = row.on();
        // which side is the link's, how it is ahead of it, and where the other is
        let side = (0..2).find(|&s| self.before.offset(on[s], self.link).is_some())?;
        let offset = self.before.offset(on[side], self.link)?;
        let known = on[1 - side].map_or(Pose::STILL, |s| self.before.poses[s]);
        match *row {
            Row::Length { at, length, .. } => {
                let (a, b) = (
                    self.seen(known.carry(at[1 - side])),
                    self.seen(offset.carry(at[side])),
                );
                let length = length / self.before.size;
                self.hold(Holds::Rod, a, b, dot(a, a) + dot(b, b) - length * length);
            }
            Row::Along { at, v, .. } if side == 0 => {
                let (a, b) = (known.turn(v), self.seen(offset.carry(at)));
                self.hold(Holds::Plane, a, b, -dot(a, self.seen(known.carry(at))));
            }
            Row::Along { at, v, .. } => {
                let (a, b) = (self.seen(known.carry(at)), offset.turn(v));
                self.hold(Holds::OwnPlane, a, b, -dot(b, self.seen(offset.carry(at))));
            }
            Row::Angle { u, v, cosine, .. } => {
                let [a, b] = if side == 1 { [u, v] } else { [v, u] };
                self.hold(Holds::Angle, known.turn(a), offset.turn(b), -cosine);
            }
        }
        Some(())
    }
}
