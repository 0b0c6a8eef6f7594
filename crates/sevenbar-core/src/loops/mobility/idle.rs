//! Idle freedoms: those that move some links and no joint elsewhere.

use crate::loops::equation::chain::{Chain, Configuration};
use crate::loops::equation::closed::Closed;
use crate::loops::equation::dense::singular_values;
use crate::loops::equation::kinds::Kind;
use crate::loops::equation::rotations::ball_rotation;
use crate::random::Random;
use crate::rigid::Pose;
use std::ops::Range;

/// A freedom in which no joint but those of its own links takes part, joints counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Idle {
    /// The link between two balls spins about their line.
    BetweenBalls(usize),
    /// All links from one ball to the other spin together about their line.
    ChainBetweenBalls(usize, usize),
    /// The link spins about an axis on which the neighbouring ball lies: (the joint that is held, the ball).
    BallOnAxis(usize, usize),
    /// Two turns about one axis: (the joint that is held, the other).
    OneAxis(usize, usize),
    /// Two slides in one direction: (the joint that is held, the other).
    OneDirection(usize, usize),
    /// The links between a ball and the turn of a plate spin about the plate's normal through the ball, wherever in the plate its turn is:
    /// (the turn that is held, the ball).
    OnPlate(usize, usize),
}

impl Idle {
    /// The joint that is held at its zero.
    fn held(self) -> Option<usize> {
        match self {
            Self::BallOnAxis(held, _)
            | Self::OneAxis(held, _)
            | Self::OneDirection(held, _)
            | Self::OnPlate(held, _) => Some(held),
            Self::BetweenBalls(_) | Self::ChainBetweenBalls(..) => None,
        }
    }
}

/// With more balls than these, joints between two of them take part when all links there spin about their line.
const MOST_SPINNING_BALLS: usize = 3;

/// Axes are parallel whose sine is below this, and screws depend on each other to this part of the greatest.
const PARALLEL: f64 = 1e-9;

/// All idle freedoms, and which joints are held at zero by them.
pub(crate) fn idle_freedoms(kinds: &[Kind], links: &[Pose]) -> (Vec<Idle>, Vec<bool>) {
    let mut idle = beside_each_other(kinds, links);
    let mut held = vec![false; kinds.len()];
    for joint in idle.iter().filter_map(|i| i.held()) {
        held[joint] = true;
    }
    idle.extend(on_plates(kinds, links, &mut held));
    idle.extend(chains(kinds, &held, &idle));
    (idle, held)
}

/// The spins of all links between two balls. Whatever joints they have among them, those outside feel the balls' distance only.
fn chains(kinds: &[Kind], held: &[bool], known: &[Idle]) -> Vec<Idle> {
    let balls: Vec<usize> = (0..kinds.len()).filter(|&i| kinds[i] == Kind::Ball).collect();
    let few = balls.len() <= MOST_SPINNING_BALLS;
    let mut pairs: Vec<(usize, usize)> = balls.windows(2).map(|p| (p[0], p[1])).collect();
    if balls.len() == MOST_SPINNING_BALLS {
        pairs.push((balls[0], balls[2]));
    }
    pairs
        .into_iter()
        .filter(|&(a, b)| few || (a + 1..b).all(|i| held[i]))
        .filter(|&(a, b)| b > a + 1 || !known.contains(&Idle::BetweenBalls(a)))
        .map(|(a, b)| Idle::ChainBetweenBalls(a, b))
        .collect()
}

/// Freedoms of the link between two neighbouring joints that nothing else takes part in, in every pose.
fn beside_each_other(kinds: &[Kind], links: &[Pose]) -> Vec<Idle> {
    let count = kinds.len();
    let mut found: Vec<Idle> = Vec::new();
    let mut taken = vec![false; count];
    // the ground cannot spin, so the last joint and the first are no such pair
    let neighbours = (0..count.saturating_sub(1)).map(|i| (i, i + 1));
    let across = (2..count).flat_map(|apart| (0..count - apart).map(move |i| (i, i + apart)));
    for (i, next) in neighbours.chain(across) {
        if taken[i] || taken[next] || !pass_on(&kinds[i..=next], &links[i..next], &taken[i..=next]) {
            continue;
        }
        let link = links[i + 1..next]
            .iter()
            .fold(links[i], |way, link| way.then(link));
        if !dependent(&[kinds[i], kinds[next]], &[link]) {
            continue;
        }
        let idle = match (kinds[i], kinds[next]) {
            (Kind::Ball, Kind::Ball) => Idle::BetweenBalls(i),
            (Kind::Ball, _) => Idle::BallOnAxis(next, i),
            (_, Kind::Ball) => Idle::BallOnAxis(i, next),
            // the last joint is read, so that it moves
            (Kind::Slide, Kind::Slide) if next + 1 == count => Idle::OneDirection(i, next),
            (Kind::Slide, Kind::Slide) => Idle::OneDirection(next, i),
            _ if next + 1 == count => Idle::OneAxis(i, next),
            _ => Idle::OneAxis(next, i),
        };
        taken[idle.held().unwrap_or(i)] = true;
        found.push(idle);
    }
    found
}

/// Whether the joints between the first and the last carry an axis of theirs into itself, as the slide of a cylindrical joint does, and
/// turns about parallel axes do a slide's, and one of their own kind that is held already, of three on one axis: they take no part in what
/// the two do.
fn pass_on(kinds: &[Kind], links: &[Pose], held: &[bool]) -> bool {
    let last = kinds.len() - 1;
    if last == 1 {
        return true;
    }
    // the axes of the two are one where their screws depend
    let backwards = kinds[0] == Kind::Ball;
    let own = kinds[if backwards { last } else { 0 }];
    let other = match own {
        Kind::Turn => Kind::Slide,
        Kind::Slide => Kind::Turn,
        _ => return false,
    };
    let between = if backwards {
        &links[1..]
    } else {
        &links[..last - 1]
    };
    let parallel = |link: &Pose| {
        let [x, y, _] = link.turn([0.0, 0.0, 1.0]);
        x.hypot(y) < PARALLEL
    };
    (1..last).all(|k| kinds[k] == other || (held[k] && kinds[k] == own)) && between.iter().all(parallel)
}

/// Spins between a ball and a plate next to it, which is a turn and two slides square to it in any order; the turns are held from now on.
fn on_plates(kinds: &[Kind], links: &[Pose], held: &mut [bool]) -> Vec<Idle> {
    let mut found = Vec::new();
    if kinds.len() == 4 {
        // the whole loop
        return found;
    }
    for (first, four) in kinds.windows(4).enumerate() {
        let (ball, plate) = match (four[0], four[3]) {
            (Kind::Ball, _) => (first, first + 1..first + 4),
            (_, Kind::Ball) => (first + 3, first..first + 3),
            _ => continue,
        };
        let turns: Vec<usize> = plate.clone().filter(|&k| kinds[k] == Kind::Turn).collect();
        let slides = plate.clone().filter(|&k| kinds[k] == Kind::Slide).count();
        let (&[turn], 2) = (&turns[..], slides) else {
            continue;
        };
        let depend = |row: Range<usize>| dependent(&kinds[row.clone()], &links[row.start..row.end - 1]);
        let all = first..first + 4;
        if !all.clone().any(|k| held[k]) && !depend(plate) && depend(all) {
            held[turn] = true;
            found.push(Idle::OnPlate(turn, ball));
        }
    }
    found
}

/// Whether the screws of joints in a row depend on each other in every pose: looked at in a few poses at random.
fn dependent(kinds: &[Kind], links: &[Pose]) -> bool {
    let mut random = Random(0x1d1e);
    (0..3).all(|_| {
        let mut balls = 0..;
        let joints = kinds.iter().map(|kind| {
            let ball = if *kind == Kind::Ball { balls.next() } else { None };
            kind.joint(ball.unwrap_or(0))
        });
        let chain = Chain::new(joints.collect(), [links, &[Pose::STILL]].concat());
        let mut at = Configuration::zero();
        for value in &mut at.values {
            *value = 2.0 * random.uniform() - 1.0;
        }
        for ball in &mut at.balls {
            *ball = ball_rotation(&std::array::from_fn(|_| 3.0 * random.uniform()));
        }
        let (values, _) = singular_values(&chain.screws(&at));
        values[values.len() - 1] < PARALLEL * values[0]
    })
}
