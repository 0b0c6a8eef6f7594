//! From the joints of a description to the chain that is followed: idle freedoms held, balls made one joint.

use super::chain::{BALLS, COLUMNS, Chain, Joint, Rotation, transposed};
use super::dense::singular_values;
use super::starts::Random;
use crate::rigid::{Pose, Vec3, add, cross, dot, most_perpendicular_axis, norm, scale, sub, unit};

/// A joint of the description; C and U are two of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// R
    Turn,
    /// P
    Slide,
    /// H, with its advance for a radian [length].
    Screw(f64),
    /// S
    Ball,
}

impl Kind {
    /// How many columns of joint values it has.
    pub fn columns(self) -> usize {
        self.joint(0).columns()
    }

    /// The chain's joint; a ball is the one of this number.
    fn joint(self, ball: usize) -> Joint {
        match self {
            Self::Turn => Joint::Turn,
            Self::Slide => Joint::Slide,
            Self::Screw(advance) => Joint::Screw(advance),
            Self::Ball => Joint::Ball(ball),
        }
    }
}

/// A freedom that moves nothing but the link between two neighbouring joints, counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Idle {
    /// The link between two balls spins about their line.
    BetweenBalls(usize),
    /// The link spins about an axis on which the neighbouring ball lies: (the joint that is held, the ball).
    BallOnAxis(usize, usize),
    /// Two turns about one axis: (the joint that is held, the other).
    OneAxis(usize, usize),
    /// Two slides in one direction: (the joint that is held, the other).
    OneDirection(usize, usize),
}

/// Where the values of a joint of the description come from.
#[derive(Clone, Copy, Debug)]
pub(super) enum Source {
    /// A joint of the chain.
    Joint(usize),
    /// Held at its zero.
    Held,
    /// A ball that is held from spinning idly: two turns of the chain, in a frame whose z is the first axis and x the second.
    Universal(usize, Rotation),
}

/// A joint of the description in the chain, and the link after it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    pub kind: Kind,
    pub source: Source,
    /// The chain's joint that moves the link (none where only held joints lie between it and the ground), and the link's
    /// frame after that joint.
    pub link: (Option<usize>, Pose),
}

/// A description brought into the form that is followed.
#[derive(Clone, Debug)]
pub(super) struct Reduced {
    pub parts: Vec<Part>,
    pub idle: Vec<Idle>,
    /// `None` where more than seven freedoms remain.
    pub chain: Option<Chain>,
    /// Freedoms that remain.
    pub freedoms: usize,
    /// The frame of the chain's first joint in the report frame.
    pub base: Pose,
}

/// Takes z to x, and x to minus z.
pub(super) const Z_TO_X: Rotation = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]];

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

/// The chain of a description: lengths in parts of the size.
pub(super) fn reduce(kinds: &[Kind], base: &Pose, ground: &Pose, links: &[Pose]) -> Reduced {
    let count = kinds.len();
    let idle = idle_freedoms(kinds, links);
    let held = |i: usize| {
        idle.iter().any(|f| {
            matches!(f, Idle::BallOnAxis(h, _) | Idle::OneAxis(h, _) | Idle::OneDirection(h, _) if *h == i)
        })
    };
    let mut joints = Vec::new();
    let mut transforms: Vec<Pose> = Vec::new();
    let mut parts = Vec::with_capacity(count);
    let mut lead = Pose::STILL;
    let mut pending = Pose::STILL;
    let mut balls = 0;
    let mut halves = Vec::new();
    let push = |joint: Joint,
                pending: &mut Pose,
                lead: &mut Pose,
                joints: &mut Vec<Joint>,
                transforms: &mut Vec<Pose>| {
        if joints.is_empty() {
            *lead = *pending;
        } else {
            transforms.push(*pending);
        }
        joints.push(joint);
        *pending = Pose::STILL;
    };
    for i in 0..count {
        let source = if idle.contains(&Idle::BetweenBalls(i)) {
            // the axis of the joint before, as the ball's frame has it
            let axis = if i > 0 && kinds[i - 1] != Kind::Ball {
                links[i - 1].turn_back([0.0, 0.0, 1.0])
            } else {
                most_perpendicular_axis(links[i].translation)
            };
            let frame = spin_frame(axis, links[i].translation);
            pending = pending.then(&Pose::turning(frame));
            push(Joint::Turn, &mut pending, &mut lead, &mut joints, &mut transforms);
            pending = Pose::turning(Z_TO_X);
            push(Joint::Turn, &mut pending, &mut lead, &mut joints, &mut transforms);
            pending = Pose::turning(Z_TO_X)
                .inverse()
                .then(&Pose::turning(frame).inverse());
            halves.push((joints.len() - 1, spin_middle(axis, links[i].translation, &frame)));
            Source::Universal(joints.len() - 2, frame)
        } else if held(i) {
            Source::Held
        } else {
            let joint = kinds[i].joint(balls);
            balls += usize::from(kinds[i] == Kind::Ball);
            push(joint, &mut pending, &mut lead, &mut joints, &mut transforms);
            Source::Joint(joints.len() - 1)
        };
        parts.push(Part { kind: kinds[i], source, link: (joints.len().checked_sub(1), pending) });
        if i + 1 < count {
            pending = pending.then(&links[i]);
        }
    }
    for part in &mut parts {
        if part.link.0.is_none() {
            // before the chain's first joint: fixed to the ground
            part.link.1 = base.then(&part.link.1);
        }
    }
    let freedoms = joints.iter().map(Joint::columns).sum();
    transforms.push(pending.then(&ground.inverse()).then(base).then(&lead));
    let fits = freedoms <= COLUMNS && balls <= BALLS && !joints.is_empty();
    Reduced {
        parts,
        idle,
        chain: fits.then(|| {
            let mut chain = Chain::new(joints, transforms);
            chain.halves = halves
                .iter()
                .map(|&(j, middle)| (chain.first[j], middle))
                .collect();
            chain
        }),
        freedoms,
        base: base.then(&lead),
    }
}

/// Freedoms of the link between two neighbouring joints that nothing else takes part in, in every pose.
fn idle_freedoms(kinds: &[Kind], links: &[Pose]) -> Vec<Idle> {
    let count = kinds.len();
    let mut found: Vec<Idle> = Vec::new();
    let mut taken = vec![false; count];
    // the ground cannot spin, so the last joint and the first are no such pair
    for i in 0..count.saturating_sub(1) {
        let next = i + 1;
        if taken[i] || taken[next] || !dependent(kinds[i], kinds[next], &links[i]) {
            continue;
        }
        let idle = match (kinds[i], kinds[next]) {
            (Kind::Ball, Kind::Ball) => Idle::BetweenBalls(i),
            (Kind::Ball, _) => Idle::BallOnAxis(next, i),
            (_, Kind::Ball) => Idle::BallOnAxis(i, next),
            (Kind::Slide, Kind::Slide) => Idle::OneDirection(next, i),
            _ => Idle::OneAxis(next, i),
        };
        match idle {
            Idle::BetweenBalls(a) => taken[a] = true,
            Idle::BallOnAxis(h, _) | Idle::OneAxis(h, _) | Idle::OneDirection(h, _) => taken[h] = true,
        }
        found.push(idle);
    }
    found
}

/// Whether the screws of two neighbours depend on each other in every pose: looked at in a few poses at random.
fn dependent(first: Kind, second: Kind, link: &Pose) -> bool {
    let mut random = Random(0x1d1e);
    (0..3).all(|_| {
        let chain = Chain::new(
            [first, second]
                .iter()
                .enumerate()
                .map(|(b, kind)| kind.joint(b))
                .collect(),
            vec![*link, Pose::STILL],
        );
        let mut at = super::chain::Configuration::ZERO;
        for value in &mut at.values {
            *value = 2.0 * random.uniform() - 1.0;
        }
        for ball in &mut at.balls {
            *ball = super::modes::ball_rotation(&std::array::from_fn(|_| 3.0 * random.uniform()));
        }
        let (values, _) = singular_values(&chain.screws(&at));
        values[values.len() - 1] < 1e-9 * values[0]
    })
}
