//! From the joints of a description to the chain that is followed: idle freedoms held, balls made one joint.

use super::spin_axis::{Way, spin_axis};
use super::spun::{Spun, away_from_line};
use crate::loops::equation::chain::{BALLS, Chain, Half};
use crate::loops::equation::closed::Joint;
use crate::loops::equation::dense::COLUMNS;
use crate::loops::equation::kinds::Kind;
use crate::loops::equation::rotations::{Rotation, Z_TO_X, transposed};
use crate::loops::mobility::idle::{Idle, idle_freedoms};
use crate::rigid::{Pose, Vec3, add, cross, dot, most_perpendicular_axis, norm, scale, sub, unit};

/// Where the values of a joint of the description come from.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Source {
    /// A joint of the chain.
    Joint(usize),
    /// Held at a value [rad, or relative to the size].
    Held(f64),
    /// A ball that is held from spinning idly: two turns of the chain, in a frame whose z is the first axis and x the second.
    Universal(usize, Rotation),
    /// The same for a ball before links that spin together, whose place on the chain's links depends on their joint.
    BeforeSpun(usize, Rotation),
    /// The ball after them: a joint of the chain.
    AfterSpun(usize),
}

/// What moves a link of the description, and its frame there.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Carrier {
    /// Nothing: only held joints lie between it and the ground.
    Ground(Pose),
    /// A joint of the chain.
    Joint(usize, Pose),
    /// It spins between two balls, before the joint there.
    Spun(Pose),
    /// The same, after that joint.
    SpunBeyond(Pose),
}

/// A joint of the description in the chain, and the link after it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part {
    pub kind: Kind,
    pub source: Source,
    pub link: Carrier,
}

/// Links that spin together, in the chain.
#[derive(Clone, Debug)]
pub(crate) struct SpunLinks {
    pub spun: Spun,
    /// The chain's joint that is the second turn of the first ball, and the frame of the links after it.
    pub carrier: (usize, Pose),
    /// The chain's joint among the links.
    pub joint: usize,
}

/// A description brought into the form that is followed.
#[derive(Clone, Debug)]
pub(crate) struct Reduced {
    pub parts: Vec<Part>,
    pub idle: Vec<Idle>,
    /// `None` where more than seven freedoms remain, or a spin is not held.
    pub chain: Option<Chain>,
    /// Freedoms that remain.
    pub freedoms: usize,
    /// The frame of the chain's first joint in the report frame.
    pub base: Pose,
    pub spun: Option<SpunLinks>,
}

/// The frame of the two turns that stand for a ball whose link's spin is held: z along the axis before, x across it and the
/// line to the next ball.
fn spin_frame(axis: Vec3, line: Vec3) -> Rotation {
    let x = unit(line);
    let across = |v: Vec3| sub(v, scale(x, dot(v, x)));
    let z = if norm(across(axis)) > 1e-8 {
        unit(across(axis))
    } else {
        unit(across(most_perpendicular_axis(x)))
    };
    let second = cross(z, x);
    // the rule's second axis is at right angles to the axis before
    let second = unit(add(second, scale(axis, -dot(second, axis))));
    transposed(&[second, cross(axis, second), axis])
}

/// The second turn at which the link's line is at right angles to the axis before: the rule's z lies along that axis, and is
/// nearest to it within a quarter turn.
fn spin_middle(axis: Vec3, line: Vec3, frame: &Rotation) -> f64 {
    let x = unit(line);
    let second = std::array::from_fn(|k| frame[k][0]);
    let z = cross(x, second);
    dot(axis, x).atan2(dot(axis, z))
}

/// How the spin about the line of two balls is held.
enum Hold {
    /// By this ball, which comes before one link, or before the ground; the line as that link has it.
    Line(usize, Vec3),
    /// By this ball, before several links with this joint among them.
    Spun(usize, usize),
    /// Not.
    Free,
}

/// A loop as described, at the zero of its joints.
struct Described<'a> {
    kinds: &'a [Kind],
    held: Vec<bool>,
    /// The fixed transforms, the ground's last.
    around: Vec<Pose>,
}

impl Described<'_> {
    /// From the frame after one joint, in loop order, to that before another.
    fn way(&self, from: usize, to: usize) -> Pose {
        let count = self.kinds.len();
        let steps = (to + count - from - 1) % count + 1;
        (0..steps).fold(Pose::STILL, |way, k| way.then(&self.around[(from + k) % count]))
    }

    /// The joints that move between two, in loop order.
    fn moving(&self, from: usize, to: usize) -> Vec<usize> {
        let count = self.kinds.len();
        (1..(to + count - from - 1) % count + 1)
            .map(|k| (from + k) % count)
            .filter(|&i| !self.held[i])
            .collect()
    }

    fn hold(&self, idle: Idle) -> Option<Hold> {
        let (a, b) = match idle {
            Idle::BetweenBalls(a) => (a, a + 1),
            Idle::ChainBetweenBalls(a, b) => (a, b),
            _ => return None,
        };
        let (inside, outside) = (self.moving(a, b), self.moving(b, a));
        Some(match (&inside[..], &outside[..]) {
            ([], _) => Hold::Line(a, self.way(a, b).translation),
            (_, []) => Hold::Line(b, self.way(b, a).translation),
            ([joint], [_]) if matches!(self.kinds[*joint], Kind::Turn | Kind::Slide) => Hold::Spun(a, *joint),
            _ => Hold::Free,
        })
    }

    /// The first axis of a ball that holds a spin: that of the joint before, or one that the line keeps away from.
    fn spin_axis(&self, ball: usize, line: Vec3) -> Vec3 {
        let before = if ball > 0 && self.kinds[ball - 1] != Kind::Ball {
            self.around[ball - 1].turn_back([0.0, 0.0, 1.0])
        } else {
            most_perpendicular_axis(line)
        };
        let count = self.kinds.len();
        let others = (1..count).map(|k| (ball + k) % count);
        let mut ways = others
            .filter(|&other| self.kinds[other] == Kind::Ball)
            .filter_map(|other| {
                let &[first, second] = &self.moving(other, ball)[..] else {
                    return None;
                };
                let poses = [
                    self.way(other, first),
                    self.way(first, second),
                    self.way(second, ball),
                ];
                Some(Way { kinds: [self.kinds[first], self.kinds[second]], poses })
            });
        ways.next()
            .map_or(before, |way| spin_axis(before, &way, norm(line)))
    }

    /// The same before links that spin together: a direction that the line to the other ball keeps away from.
    fn axis_away(&self, ball: usize, other: usize) -> Vec3 {
        let Some(&joint) = self.moving(other, ball).first() else {
            return [0.0, 0.0, 1.0];
        };
        let (here, back) = (self.way(joint, ball), self.way(other, joint).inverse());
        here.turn_back(away_from_line(
            self.kinds[joint],
            here.translation,
            back.translation,
        ))
    }
}

/// The chain as it is put together, joint by joint.
struct Building {
    joints: Vec<Joint>,
    transforms: Vec<Pose>,
    halves: Vec<Half>,
    balls: usize,
    /// What leads up to the first joint, and from the last one on.
    lead: Pose,
    pending: Pose,
}

impl Building {
    /// Adds a joint, and gives its number.
    fn push(&mut self, joint: Joint) -> usize {
        if self.joints.is_empty() {
            self.lead = self.pending;
        } else {
            self.transforms.push(self.pending);
        }
        self.pending = Pose::STILL;
        self.balls += usize::from(matches!(joint, Joint::Ball(_)));
        self.joints.push(joint);
        self.joints.len() - 1
    }

    /// Adds the two turns of a ball that holds a spin, and gives the number of the first.
    fn push_universal(&mut self, frame: &Rotation) -> usize {
        self.pending = self.pending.then(&Pose::turning(*frame));
        let first = self.push(Joint::Turn);
        self.pending = Pose::turning(Z_TO_X);
        self.push(Joint::Turn);
        self.pending = Pose::turning(Z_TO_X)
            .inverse()
            .then(&Pose::turning(*frame).inverse());
        first
    }
}

/// The chain of a description: lengths relative to the size.
pub(super) fn reduce(kinds: &[Kind], base: &Pose, ground: &Pose, links: &[Pose]) -> Reduced {
    let count = kinds.len();
    let (idle, held) = idle_freedoms(kinds, links);
    let mut around = links.to_vec();
    around.push(ground.inverse().then(base));
    let described = Described { kinds, held, around };
    let holds: Vec<Hold> = idle.iter().filter_map(|i| described.hold(*i)).collect();
    let line_of = |ball: usize| {
        holds.iter().find_map(|h| match h {
            Hold::Line(b, line) if *b == ball => Some(*line),
            _ => None,
        })
    };
    let several = holds.iter().find_map(|h| match h {
        Hold::Spun(a, joint) => Some((*a, *joint)),
        _ => None,
    });
    let mut built = Building {
        joints: Vec::new(),
        transforms: Vec::new(),
        halves: Vec::new(),
        balls: 0,
        lead: Pose::STILL,
        pending: Pose::STILL,
    };
    let mut parts = Vec::with_capacity(count);
    let mut spun: Option<SpunLinks> = None;
    // from the first ball of links that spin together, or from their joint on, while among them
    let mut among: Option<Pose> = None;
    for i in 0..count {
        let mut after_spun = false;
        if kinds[i] == Kind::Ball && among.take().is_some() {
            after_spun = true;
        }
        let source = if let Some(line) = line_of(i) {
            let axis = described.spin_axis(i, line);
            let frame = spin_frame(axis, line);
            let first = built.push_universal(&frame);
            built
                .halves
                .push(Half { joint: first + 1, middle: spin_middle(axis, line, &frame), line: None });
            Source::Universal(first, frame)
        } else if let Some((_, joint)) = several.filter(|s| s.0 == i) {
            let (links, frame, middle) = spun_links(&described, i, joint, &mut built);
            built.halves.push(Half {
                joint: links.carrier.0,
                middle,
                line: Some((links.joint, links.spun.flat())),
            });
            among = Some(Pose::STILL);
            let first = links.carrier.0 - 1;
            spun = Some(links);
            Source::BeforeSpun(first, frame)
        } else if described.held[i] {
            Source::Held(0.0)
        } else {
            let number = built.push(kinds[i].joint(built.balls));
            if let (Some(way), Some(links)) = (&mut among, &spun) {
                *way = Pose::STILL;
                built.pending = links.spun.flat_joint().1;
            }
            if after_spun {
                Source::AfterSpun(number)
            } else {
                Source::Joint(number)
            }
        };
        parts.push(Part { kind: kinds[i], source, link: Carrier::Ground(Pose::STILL) });
        let beyond = spun.as_ref().is_some_and(|l| l.joint < built.joints.len());
        parts[i].link = match (&among, built.joints.len().checked_sub(1)) {
            (Some(way), _) if beyond => Carrier::SpunBeyond(*way),
            (Some(way), _) => Carrier::Spun(*way),
            (None, Some(last)) => Carrier::Joint(last, built.pending),
            // before the chain's first joint
            (None, None) => Carrier::Ground(base.then(&built.pending)),
        };
        if i + 1 < count {
            let way = among.as_mut().unwrap_or(&mut built.pending);
            *way = way.then(&links[i]);
        }
    }
    let Building { joints, mut transforms, halves, balls, lead, pending } = built;
    let freedoms = joints.iter().map(Joint::columns).sum::<usize>() - unheld(&holds);
    transforms.push(pending.then(&ground.inverse()).then(base).then(&lead));
    let fits = freedoms <= COLUMNS && balls <= BALLS && !joints.is_empty() && unheld(&holds) == 0;
    Reduced {
        parts,
        idle,
        chain: fits.then(|| {
            let mut chain = Chain::new(joints, transforms);
            chain.halves = halves;
            chain
        }),
        freedoms,
        base: base.then(&lead),
        spun,
    }
}

/// How many spins are idle and not held.
fn unheld(holds: &[Hold]) -> usize {
    holds.iter().filter(|h| matches!(h, Hold::Free)).count()
}

/// Adds the two turns of a ball before links that spin together, and what leads to the joint among them.
fn spun_links(
    described: &Described,
    ball: usize,
    joint: usize,
    built: &mut Building,
) -> (SpunLinks, Rotation, f64) {
    let count = described.kinds.len();
    let other = (1..count)
        .map(|k| (joint + k) % count)
        .find(|&i| described.kinds[i] == Kind::Ball)
        .unwrap_or(ball);
    let (to, rest) = (described.way(ball, joint), described.way(joint, other));
    let axis = described.axis_away(ball, other);
    let line = to.carry(rest.translation);
    let line = if norm(line) > 0.0 {
        line
    } else {
        most_perpendicular_axis(axis)
    };
    let frame = spin_frame(axis, line);
    let normal = std::array::from_fn(|k| frame[k][0]);
    let spun = Spun::new(described.kinds[joint], &to, &rest, normal);
    let first = built.push_universal(&frame);
    let links = SpunLinks { carrier: (first + 1, built.pending), joint: first + 2, spun };
    built.pending = built.pending.then(&links.spun.flat_joint().0);
    (links, frame, spin_middle(axis, line, &frame))
}
