//! Every curve of a chain: those through all its modes at many values of some joints.

use super::follow;
use super::join;
use super::known_curves::{Curves, MOST_MODES};
use super::meetings;
use super::on_curve::not_on_any;
use super::turnings;
use crate::loops::branch_points::counting::{self, Count, Uncounted};
use crate::loops::branch_points::sectors::Known;
use crate::loops::branch_points::survey::Survey;
use crate::loops::equation::chain::{Chain, Configuration};
use crate::loops::equation::closed::{Closed, Joint};
use crate::loops::modes::circle::Circle;
use crate::loops::modes::finder::{Completeness, ModeFinder, REAL};
use crate::loops::modes::many_starts::ALL_FREE;
use crate::loops::modes::polish::CLOSED;
use std::f64::consts::TAU;

/// Values of a joint at which the modes are found, all of which must lie on the circuits.
const SEEDS: usize = 24;

/// The same where modes are searched for.
const SEARCHED_SEEDS: usize = 4;

/// Before the modes are followed one after another, curves through many of them are followed piece by piece, side by side: in rounds, each
/// through the modes at every so many of the seeds, from the first of them on. A few seeds have most curves; the last round takes all.
const AHEAD: [(usize, usize); 2] = [(0, 4), (1, 1)];

/// Joints whose values are seeds: a circuit that is narrow over one is wide over another.
const SEED_JOINTS: usize = 2;

/// Where the loop closes at fewer values of the first joints than this, other joints have seeds, too: the first may stand still while others
/// move, at a value that is a seed by chance.
const MOVING_SEEDS: usize = 2;

/// An open range narrower than this [rad] in which two branch points are missing is that of one singular pose, and open with any
/// joint. About solutions that run to infinity at one value of a joint ranges are wider, and of a circuit nearly as narrow the count
/// fails: another joint may have an account of them.
const WIDE_RANGE: f64 = 1e-4;

/// Imaginary parts [rad] that solutions which are real at one input may have next to it, as a part of the distance.
const NEARLY_REAL: f64 = 20.0;

/// Two branch points, one on each side of the real inputs, become one in an isolated pose.
const BRANCH_POINTS_OF_POSE: i64 = 2;

/// The columns whose values may be seeds, in the order in which they are asked: the wished ones if they turn, and all others that do; screws
/// where none turns and no pose is drawn.
fn seed_columns(chain: &Chain, wished: &[usize], drawn: bool) -> Vec<usize> {
    let first = |fits: &dyn Fn(usize) -> bool| {
        let mut seeds: Vec<usize> = Vec::new();
        for c in wished.iter().copied().chain(0..chain.columns) {
            if fits(c) && !seeds.contains(&c) {
                seeds.push(c);
            }
        }
        seeds
    };
    let turning = first(&|c| chain.is_turn(c));
    // where only screws turn, modes come from long searches and again for each turn of a screw: a drawn pose will do
    if turning.is_empty() && !drawn {
        first(&|c| matches!(chain.joints[chain.joint_of(c)], Joint::Screw(_)))
    } else {
        turning
    }
}

/// The curves through all modes at the seeds, or the first.
pub(crate) fn curves(chain: &Chain, wished: &[usize], first_only: bool) -> Curves {
    let rising = wished[0];
    let drawn = chain.residual(&chain.place(&chain.drawn)) < CLOSED;
    let seeds = seed_columns(chain, wished, drawn);
    // the pose of a drawing first
    let mut drawings = if drawn { vec![chain.drawn] } else { Vec::new() };
    let mut out = Curves::new(wished);
    out.search.columns = seeds.iter().copied().take(SEED_JOINTS).collect();
    let mut met = 0;
    for (asked, seed) in seeds.into_iter().enumerate() {
        let further = asked >= SEED_JOINTS;
        if further && (first_only || met >= MOVING_SEEDS) {
            break;
        }
        let usual = ModeFinder::new(chain, seed);
        let finder = usual.better_placed().unwrap_or(usual);
        let searched = finder.completeness() == Completeness::Searched;
        if further {
            // a search takes long, and from places with all joints free it is made below
            if searched {
                break;
            }
            out.search.columns.push(seed);
        }
        if searched {
            out.search.completeness = Completeness::Searched;
        }
        let count = if searched { SEARCHED_SEEDS } else { SEEDS };
        out.search.values = count;
        if first_only {
            out.take(chain, &std::mem::take(&mut drawings), rising);
            for k in 0..count {
                if out.is_empty() {
                    out.take(chain, &finder.at(TAU * k as f64 / count as f64).modes, rising);
                }
            }
            continue;
        }
        let survey = if is_doubtful(&out) {
            Survey::new(&finder)
        } else {
            None
        };
        let (rough, circle) = finder.around(count, survey.as_ref().map(|s| &s.watch));
        met += rough.iter().filter(|modes| !modes.is_empty()).count();
        look_ahead(&mut out, &finder, &rough, &drawings);
        out.take(chain, &std::mem::take(&mut drawings), rising);
        for modes in &rough {
            let polished = finder.polished(&out.unknown(chain, modes));
            out.search.open_by.extend(polished.open_by);
            out.take(chain, &polished.modes, rising);
        }
        out.ahead.clear();
        for value in survey.iter().flat_map(|s| s.unseeded(count)) {
            let modes = finder.at(value).modes;
            out.take(chain, &modes, rising);
        }
        if let (Some(survey), Some(circle)) = (survey, circle) {
            let mut count = counted(&mut out, &survey, circle, rising);
            if finder.has_free_axes() && is_open(&count) {
                let other = ModeFinder::about_other_axes(chain, seed);
                count = counted_again(&mut out, &other, rising, count);
            }
            if seed == out.search.columns[0] || !is_open(&count) {
                out.search.count = count;
            }
            // where motions leave this joint at rest the count fails, so after one that succeeds no other need be asked
            if seed == out.search.columns[0] && out.search.is_counted() && !chain.is_redundant() {
                out.search.columns.truncate(1);
                break;
            }
        }
    }
    // where nothing turns
    out.take(chain, &drawings, rising);
    // the first joints' account says nothing of a pose that a seed of a further one is by chance
    if out.search.columns.len() > SEED_JOINTS && out.is_empty() && out.search.found.is_some() {
        out.search.completeness = Completeness::Searched;
        out.search.count = Err(Uncounted::Searched);
    }
    if out.search.found.is_none() && !out.search.columns.is_empty() {
        look_where_paths_were_lost(&mut out, chain);
        if out.search.found.is_none() {
            look_for_a_structure(&mut out, chain);
        }
    }
    out.finish(chain);
    out.search.open_by.sort_by(f64::total_cmp);
    if out.search.columns.is_empty() {
        out.search.completeness = Completeness::Searched;
    }
    out
}

/// Searches where no mode is isolated but paths to others were lost.
fn look_where_paths_were_lost(curves: &mut Curves, chain: &Chain) {
    let finder = ModeFinder::new(chain, curves.search.columns[0]);
    if !finder.is_degenerate() {
        return;
    }
    curves.search.completeness = Completeness::Searched;
    curves.search.count = Err(Uncounted::Searched);
    curves.search.columns.truncate(1);
    curves.search.values = SEARCHED_SEEDS;
    for k in 0..SEARCHED_SEEDS {
        if let Some(mode) = finder.one_by_search(TAU * k as f64 / SEARCHED_SEEDS as f64) {
            curves.take(chain, &[mode], curves.wished[0]);
            return;
        }
    }
}

/// Searches for poses where the loop closes at no general input, real or not: a structure closes at inputs that no seed has, and so does a
/// loop in which the input stands still while other joints move, or one whose circuits are all next to nothing wide. One pose of a structure
/// will do; where the loop moves, each may lie on a circuit of its own.
fn look_for_a_structure(curves: &mut Curves, chain: &Chain) {
    let column = curves.search.columns[0];
    let finder = ModeFinder::new(chain, column);
    // where paths were lost the solutions that are left say nothing of the others
    let closes = finder.algebraic().is_none_or(|a| !a.own().is_empty());
    if closes && !finder.is_degenerate() {
        return;
    }
    for pose in ALL_FREE.poses(chain, column, None) {
        curves.search.completeness = Completeness::Searched;
        curves.search.count = Err(Uncounted::Searched);
        curves.take(chain, &[pose], curves.wished[0]);
        if curves.is_empty() {
            return;
        }
    }
}

/// Whether nothing was counted yet, or a range is left open of which another joint may have an account.
fn is_doubtful(curves: &Curves) -> bool {
    match &curves.search.count {
        Ok(count) => count
            .open
            .iter()
            .any(|o| o.to - o.from > WIDE_RANGE || o.missing != Some(BRANCH_POINTS_OF_POSE)),
        Err(why) => *why != Uncounted::Still,
    }
}

/// Whether branch points are not all accounted for.
fn is_open(count: &Result<Count, Uncounted>) -> bool {
    !count.as_ref().is_ok_and(|c| c.open.is_empty())
}

/// The account once more by a finder about other axes: a range that balances by either is settled.
fn counted_again(
    curves: &mut Curves,
    finder: &ModeFinder,
    rising: usize,
    before: Result<Count, Uncounted>,
) -> Result<Count, Uncounted> {
    let Some(survey) = Survey::new(finder) else {
        return before;
    };
    let Some(circle) = finder.around(SEEDS, Some(&survey.watch)).1 else {
        return before;
    };
    let count = counted(curves, &survey, circle, rising);
    match (before, count) {
        (Ok(mut before), Ok(count)) => {
            before.settle_those_missing_in(&count.open);
            Ok(before)
        }
        (Err(_), Ok(count)) => Ok(count),
        (before, Err(_)) => before,
    }
}

/// The account of a column's branch points; curves that it leads to are followed.
fn counted(curves: &mut Curves, survey: &Survey, circle: Circle, rising: usize) -> Result<Count, Uncounted> {
    let (chain, column) = (survey.finder.chain, survey.finder.input);
    let known = known_zeros(curves, chain, survey, column);
    let mut far: Vec<f64> = Vec::new();
    let mut count = counting::count(survey, circle, known, &mut |pose| {
        if follow::is_far(chain, pose) {
            // a curve is not followed so far, but may turn back there
            far.push(pose.values[column]);
        } else {
            // a circuit so narrow that it was missed bends sharply all along
            let last = std::mem::replace(&mut curves.last, true);
            curves.take(chain, &[*pose], rising);
            curves.last = last;
        }
        let mut known = known_zeros(curves, chain, survey, column);
        known.dead_centres.extend(&far);
        known
    });
    if let Ok(count) = &mut count {
        look_into(curves, chain, survey.finder, count);
    }
    count
}

/// Searches ranges too narrow to be counted, where solutions meet: in an isolated pose they are real at one input only.
fn look_into(curves: &mut Curves, chain: &Chain, finder: &ModeFinder, count: &mut Count) {
    count.open.retain(|open| {
        if open.to - open.from > WIDE_RANGE {
            return true;
        }
        let mut met = 0;
        let (middle, wide) = (0.5 * (open.from + open.to), open.to - open.from);
        // solutions that meet at one real input are complex beside it
        for place in finder.rough_at(middle, REAL.max(NEARLY_REAL * wide)) {
            // turned over with an idle link it is the same pose
            if !chain.counts(&place) || curves.holds(chain, &place) || !curves.branches(chain, &place, false)
            {
                continue;
            }
            if let Some(point) = curves.arcs.at(chain, &place) {
                let pose = curves.arcs.points[point].at;
                curves.find_at(chain, &pose);
                met += BRANCH_POINTS_OF_POSE;
            }
        }
        open.missing != Some(met) || met == 0
    });
}

/// The zeros of the determinant that the curves tell of.
fn known_zeros(curves: &Curves, chain: &Chain, survey: &Survey, column: usize) -> Known {
    let points = curves.arcs.points.iter();
    let singular = points.flat_map(|p| std::iter::repeat_n(p.at.values[column], p.zeros()));
    let mut known = Known { singular: singular.collect(), ..Known::default() };
    let joined = curves.arcs.joined(chain, curves.wished[0]);
    for curve in curves.curves.iter().chain(&joined) {
        let turnings = turnings::turnings(curve, chain, column);
        let smooth = turnings.iter().filter(|t| !t.node.is_crossing());
        known
            .dead_centres
            .extend(smooth.map(|t| t.node.at.values[column]));
        known.meetings.extend(meetings::meetings(survey, chain, curve));
    }
    known
}

/// Those modes that lie on no curve yet, nor on one of those ahead.
fn unforeseen(curves: &Curves, chain: &Chain, modes: &[Configuration]) -> Vec<Configuration> {
    not_on_any(chain, &curves.ahead, curves.unknown(chain, modes))
}

/// Follows the closed curves through what is to come, many pieces side by side.
fn look_ahead(
    curves: &mut Curves,
    finder: &ModeFinder,
    rough: &[Vec<Configuration>],
    drawings: &[Configuration],
) {
    let chain = finder.chain;
    for (first, every) in AHEAD {
        let mut places = unforeseen(curves, chain, drawings);
        for modes in rough.iter().skip(first).step_by(every) {
            if modes.len() <= MOST_MODES {
                places.extend(finder.polished(&unforeseen(curves, chain, modes)).modes);
            }
        }
        curves.ahead.extend(join::closed_curves(chain, &places));
    }
}
