//! Modes by search, where there is no algebraic way: Newton's method from many places.

use super::polish::{Settled, polish, polish_with_spare};
use crate::loops::equation::chain::{Chain, Configuration};
use crate::loops::equation::closed::{At, Closed, Joint};
use crate::loops::equation::rotations::ball_rotation;
use crate::random::Random;

/// Starts of the search where there is no algebraic way.
const SEARCH_STARTS: usize = 1500;

/// A search for one pose from many places: its random numbers, and after how many places it gives up.
pub(crate) struct Starts {
    seed: u64,
    most: usize,
}

/// With all joints free: a triangle is found from one start in two or three.
pub(crate) const ALL_FREE: Starts = Starts { seed: 0x57a7e, most: 60 };

/// For a pose on a curve of them: a curve draws many starts, since Newton's method need not find one place on it.
pub(super) const ON_CURVE: Starts = Starts { seed: 0xc4a1e5, most: 40 };

/// Where paths were lost: most starts lead to a pose where there is one, and each costs more than one of [`SEARCH_STARTS`].
pub(super) const PATHS_LOST: Starts = Starts { seed: 0x5ea4c4, most: 300 };

/// Turns to each side within which a screw joint is searched.
pub(super) const SCREW_TURNS: f64 = 1.0;

/// Modes nearer than this in every joint [rad, or relative to the size] are one.
pub(crate) const SAME_MODE: f64 = 1e-7;

pub(crate) fn same<S: Closed>(chain: &S, a: &At<S>, b: &At<S>) -> bool {
    chain
        .difference(a, b)
        .as_ref()
        .iter()
        .all(|d| d.abs() < SAME_MODE)
}

/// Any configuration with the input at a value; screws within [`SCREW_TURNS`].
pub(crate) fn anywhere<S: Closed>(chain: &S, input: usize, value: f64, random: &mut Random) -> At<S> {
    let mut rough = At::<S>::zero();
    for (joint, &column) in chain.joints().iter().zip(chain.first()) {
        let centred = 2.0 * random.uniform() - 1.0;
        match joint {
            Joint::Slide => rough.values[column] = centred,
            Joint::Screw(_) => {
                rough.values[column] = centred * SCREW_TURNS * std::f64::consts::TAU;
            }
            Joint::Turn => rough.values[column] = centred * std::f64::consts::PI,
            Joint::Ball(b) => {
                let angle = |r: &mut Random| std::f64::consts::TAU * r.uniform();
                rough.balls[*b] = ball_rotation(&[angle(random), angle(random), angle(random)]);
            }
        }
    }
    rough.values[input] = value;
    rough
}

impl Starts {
    /// The poses to which its places lead, one after the other and some of them again, with the input held at a value, or at any value and
    /// free where none is given.
    pub fn poses<'a>(
        &self,
        chain: &'a Chain,
        input: usize,
        value: Option<f64>,
    ) -> impl Iterator<Item = Configuration> + 'a {
        let mut random = Random(self.seed);
        (0..self.most).filter_map(move |_| {
            let start = value.unwrap_or_else(|| std::f64::consts::PI * (2.0 * random.uniform() - 1.0));
            let rough = anywhere(chain, input, start, &mut random);
            let found = polish_with_spare(chain, value.map(|_| input), &rough);
            found.filter(|at| chain.counts(at))
        })
    }

    /// The first pose found that is `wanted`.
    pub fn first(
        &self,
        chain: &Chain,
        input: usize,
        value: Option<f64>,
        wanted: impl Fn(&Configuration) -> bool,
    ) -> Option<Configuration> {
        self.poses(chain, input, value).find(|at| wanted(at))
    }
}

/// Newton from many places; screws within [`SCREW_TURNS`]. Redundant constraints may keep some of them open.
pub(super) fn searched(chain: &Chain, input: usize, value: f64) -> Vec<Configuration> {
    let mut random = Random(0x5ea4c4);
    let mut modes: Vec<Configuration> = Vec::new();
    for _ in 0..SEARCH_STARTS {
        let rough = anywhere(chain, input, value, &mut random);
        let in_range = |m: &Configuration| {
            chain.joints.iter().zip(&chain.first).all(|(joint, &c)| {
                !matches!(joint, Joint::Screw(_))
                    || c == input
                    || m.values[c].abs() <= SCREW_TURNS * std::f64::consts::TAU
            })
        };
        if let Some(Settled { at: mode, .. }) = polish(chain, input, &rough, f64::INFINITY)
            && in_range(&mode)
            && modes.iter().all(|m| !same(chain, m, &mode))
        {
            modes.push(mode);
        }
    }
    modes
}
