//! Modes by search, where there is no algebraic way: Newton's method from many places.

use super::polish::{Settled, polish, polish_with_spare};
use crate::loops::equation::chain::{Chain, Configuration, Joint};
use crate::loops::equation::rotations::ball_rotation;
use crate::random::Random;

/// Starts of the search where there is no algebraic way.
const SEARCH_STARTS: usize = 1500;

/// Starts of the search for any pose, where all joints are free: a triangle is found from one start in two or three.
const ANY_STARTS: usize = 60;

/// Turns to each side within which a screw joint is searched.
pub(super) const SCREW_TURNS: f64 = 1.0;

/// Modes nearer than this in every joint [rad, or relative to the size] are one.
pub(crate) const SAME_MODE: f64 = 1e-7;

pub(crate) fn same(chain: &Chain, a: &Configuration, b: &Configuration) -> bool {
    chain.difference(a, b).iter().all(|d| d.abs() < SAME_MODE)
}

/// Any configuration with the input at a value; screws within [`SCREW_TURNS`].
pub(super) fn anywhere(chain: &Chain, input: usize, value: f64, random: &mut Random) -> Configuration {
    let mut rough = Configuration::ZERO;
    for (joint, &column) in chain.joints.iter().zip(&chain.first) {
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

/// A pose at any value of the input, from [`ANY_STARTS`] places.
pub(crate) fn any_pose(chain: &Chain, input: usize) -> Option<Configuration> {
    let mut random = Random(0x57a7e);
    (0..ANY_STARTS).find_map(|_| {
        let value = std::f64::consts::PI * (2.0 * random.uniform() - 1.0);
        let found = polish_with_spare(chain, None, &anywhere(chain, input, value, &mut random));
        found.filter(|at| chain.counts(at))
    })
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
