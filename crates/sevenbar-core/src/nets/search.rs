//! Poses of any net from many places, with a column held: Newton's method over the tree's columns.

use super::sized::SizedNet;
use crate::loops::equation::closed::{At, Closed, input_row};
use crate::loops::modes::curves_at_input::runs_on;
use crate::loops::modes::many_starts::{anywhere, same};
use crate::loops::modes::polish::CLOSED;
use crate::loops::singular_values;
use crate::random::Random;
use crate::stopping;

/// Places from which modes at one value are searched, and at each of many values along which circuits are.
pub(super) const STARTS: usize = 600;
pub(super) const STARTS_OF_MANY: usize = 60;

/// Most steps of Newton's method, and the longest [rad, or relative to the size].
const MOST_STEPS: usize = 60;
const LONGEST: f64 = 1.0;

/// Below this part of the greatest a singular value is that of a pose where modes meet, or of one on a curve of poses: Newton's method ends
/// anywhere near by.
const ISOLATED: f64 = 1e-5;

/// Whether others are near a pose that closes with a column held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standing {
    /// None is near by.
    Isolated,
    /// Modes meet, or nearly.
    Meeting,
    /// A curve of them leads through it.
    OnCurve,
}

/// Whether others are near a pose that closes with a column held.
pub(super) fn standing<const C: usize, const R: usize, const B: usize>(
    net: &SizedNet<C, R, B>,
    held: usize,
    at: &At<SizedNet<C, R, B>>,
) -> Standing {
    let screws = |at: &At<SizedNet<C, R, B>>| -> Vec<Vec<f64>> {
        let screws = net.place(at).screws;
        let used = screws[..net.used()].iter();
        used.map(|screw| screw[..net.used() - 1].to_vec()).collect()
    };
    let mut passive = screws(at);
    passive.remove(held);
    let (values, _) = singular_values(&passive);
    let ends = values.first().zip(values.last());
    if ends.is_some_and(|(greatest, least)| *least > ISOLATED * greatest) {
        Standing::Isolated
    } else if runs_on(net, held, at, screws) {
        Standing::OnCurve
    } else {
        Standing::Meeting
    }
}

/// The closed pose that Newton's method leads to with a column held; `None` where it leads to none.
pub(super) fn settled<const C: usize, const R: usize, const B: usize>(
    net: &SizedNet<C, R, B>,
    held: usize,
    rough: &At<SizedNet<C, R, B>>,
) -> Option<At<SizedNet<C, R, B>>> {
    let mut at = *rough;
    let row: [f64; C] = input_row(held);
    let mut before = f64::INFINITY;
    for _ in 0..MOST_STEPS {
        stopping::piece();
        let placed = net.place(&at);
        let residual = net.residual(&placed);
        // one step beyond where it closes
        if residual < CLOSED && residual >= 0.5 * before {
            return Some(at);
        }
        before = residual;
        let mut by = net.inverse(&placed.screws, &row).times(&placed.error);
        by[held] = 0.0;
        let longest = by.iter().fold(0.0, |m: f64, b| m.max(b.abs()));
        if !longest.is_finite() {
            return None;
        }
        let factor = (LONGEST / longest).min(1.0);
        at = net.moved(&at, &by.map(|b| -b * factor));
    }
    (before < CLOSED).then_some(at)
}

/// The poses to which so many places lead, each once, with a column held at a value.
pub(super) fn searched<const C: usize, const R: usize, const B: usize>(
    net: &SizedNet<C, R, B>,
    held: usize,
    value: f64,
    starts: usize,
) -> Vec<At<SizedNet<C, R, B>>> {
    let mut random = Random(0x5ea4c4);
    let mut modes: Vec<At<SizedNet<C, R, B>>> = Vec::new();
    // the drawing may be a place to which others seldom lead
    let mut drawn = net.at(&net.net.drawn());
    drawn.values[held] = value;
    if net.residual(&net.place(&drawn)) < CLOSED {
        modes.push(drawn);
    }
    for _ in 0..starts {
        let mut rough = anywhere(net, held, value, &mut random);
        rough.values[net.used()..].fill(0.0);
        if let Some(mode) = settled(net, held, &rough)
            && modes.iter().all(|m| !same(net, m, &mode))
        {
            modes.push(mode);
        }
    }
    modes
}
