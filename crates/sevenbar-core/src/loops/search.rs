//! Every curve of a chain: those through all its modes at many values of some joints.

use super::arcs::{Arcs, contains, narrow_places};
use super::chain::{Chain, Configuration, Joint};
use super::change_points::ChangePoint;
use super::circle::Circle;
use super::counting::{self, Count, Known, Uncounted};
use super::curve::{Curve, End, Node};
use super::dense::{COLUMNS, dot, length, singular_values};
use super::follow::{self, Start};
use super::join;
use super::meetings;
use super::modes::{Completeness, ModeFinder, REAL};
use super::on_curve::{lies_on, lies_on_any, not_on_any, place_on};
use super::polish::{CLOSED, NO_RANK, rank, unyielding};
use super::survey::Survey;
use super::turnings;
use std::f64::consts::TAU;

/// Values of a joint at which the modes are found, all of which must lie on the circuits.
const SEEDS: usize = 24;

/// The same where modes are searched for.
const SEARCHED_SEEDS: usize = 4;

/// Curves are followed piece by piece between the modes at every so many of the seeds, if they can be; then those that are left
/// between the modes at all: the first of the seeds, and each how many.
const AHEAD: [(usize, usize); 2] = [(0, 4), (1, 1)];

/// Modes of a loop without screws at an input; where more are found, curves of them are, and few are followed at once.
const MOST_MODES: usize = 16;

/// Joints whose values are seeds: a circuit that is narrow over one is wide over another.
const SEED_JOINTS: usize = 2;

/// An open range narrower than this [rad] is that of one singular pose, and open with any joint. About solutions that run to infinity at
/// one value of a joint ranges are wider, and another joint may have an account of them.
const WIDE_RANGE: f64 = 1e-4;

/// Imaginary parts [rad] that solutions which are real at one input may have beside it, as a part of the distance.
const NEARLY_REAL: f64 = 20.0;

/// Two branch points become one in a pose that stands alone, one on each side of the real inputs.
const BRANCH_POINTS_OF_POSE: i64 = 2;

/// Norm of the screws' inverse from which rounding leaves nothing to follow.
const LOST: f64 = 1e6;

/// A mode whose screws have a singular value below this part of the greatest lies at a sharp bend.
const NARROW: f64 = 1e-5;

/// Norm of the screws' inverse at a sharp bend, and how many of its radii from a node of it a mode may be that lies there.
const SHARP: f64 = 1e4;
const BESIDE_BEND: f64 = 30.0;

/// How freely a loop moves, as found in its poses.
#[derive(Clone, Debug)]
pub struct Found {
    /// Rank of the joints' screws, idle freedoms aside.
    pub rank: usize,
    /// Wrenches that the redundant constraints bear, a basis: force and moment in the frame of the first joint.
    pub redundant: Vec<[f64; 6]>,
    /// Freedoms of the motion as found.
    pub finite: usize,
}

/// All curves of a chain.
pub(super) struct Curves {
    pub curves: Vec<Curve>,
    pub found: Option<Found>,
    pub completeness: Completeness,
    /// The account of the branch points of the first seed column, or why there is none.
    pub count: Result<Count, Uncounted>,
    pub seed_columns: Vec<usize>,
    pub seeds: usize,
    pub still: usize,
    pub misfits: Vec<f64>,
    /// Modes at the zero of the first of the wished joints.
    pub modes_at_zero: Option<usize>,
    /// Poses at which curves are not smooth, or that stand alone, once all curves are known.
    pub change_points: Vec<ChangePoint>,
    arcs: Arcs,
    /// Modes at sharp bends, left for the last; and whether they are followed now.
    unfollowed: Vec<Configuration>,
    last: bool,
    /// Columns whose limits say what is a change point.
    wished: Vec<usize>,
    /// Curves through some of the modes to come.
    ahead: Vec<Curve>,
}

/// The columns whose values are seeds: the wished ones if they turn, else the first that do; screws where none turns and no
/// pose is drawn.
fn seed_columns(chain: &Chain, wished: &[usize], drawn: bool) -> Vec<usize> {
    let first = |fits: &dyn Fn(usize) -> bool| {
        let mut seeds: Vec<usize> = Vec::new();
        for c in wished.iter().copied().chain(0..chain.columns) {
            if fits(c) && !seeds.contains(&c) && seeds.len() < SEED_JOINTS {
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
pub(super) fn curves(chain: &Chain, wished: &[usize], first_only: bool) -> Curves {
    let drawn = chain.residual(&chain.place(&Configuration::ZERO)) < CLOSED;
    let seeds = seed_columns(chain, wished, drawn);
    // the pose of a drawing first: the joints are zero there
    let mut drawings = if drawn {
        vec![Configuration::ZERO]
    } else {
        Vec::new()
    };
    let mut out = Curves { seed_columns: seeds.clone(), ..Curves::new(wished) };
    for seed in seeds {
        let finder = ModeFinder::new(chain, seed);
        let searched = finder.completeness() == Completeness::Searched;
        if searched {
            out.completeness = Completeness::Searched;
        }
        let count = if searched { SEARCHED_SEEDS } else { SEEDS };
        out.seeds = count;
        if first_only {
            out.take(chain, &std::mem::take(&mut drawings), wished[0]);
            for k in 0..count {
                if out.is_empty() {
                    out.take(chain, &finder.at(TAU * k as f64 / count as f64).modes, wished[0]);
                }
            }
            continue;
        }
        let survey = if out.is_doubtful() {
            Survey::new(&finder)
        } else {
            None
        };
        let (rough, circle) = finder.around(count, survey.as_ref().map(|s| &s.watch));
        if seed == wished[0] {
            out.modes_at_zero = Some(finder.polished(&rough[0]).modes.len());
        }
        out.look_ahead(&finder, &rough, &drawings);
        out.take(chain, &std::mem::take(&mut drawings), wished[0]);
        for modes in &rough {
            let polished = finder.polished(&out.unknown(chain, modes));
            out.misfits.extend(polished.misfits);
            out.take(chain, &polished.modes, wished[0]);
        }
        out.ahead.clear();
        for value in survey.iter().flat_map(|s| s.unseeded(count)) {
            let modes = finder.at(value).modes;
            out.take(chain, &modes, wished[0]);
        }
        if let (Some(survey), Some(circle)) = (survey, circle) {
            let mut count = out.counted(chain, &survey, circle, (seed, wished[0]));
            if let Ok(count) = &mut count {
                out.look_into(chain, &finder, count);
            }
            if seed == out.seed_columns[0] || count.as_ref().is_ok_and(|c| c.open.is_empty()) {
                out.count = count;
            }
            // a joint that stands still on some is told of, so that another need not be asked
            if seed == out.seed_columns[0] && out.is_counted() && !chain.is_redundant() {
                out.seed_columns.truncate(1);
                break;
            }
        }
    }
    // where nothing turns
    out.take(chain, &drawings, wished[0]);
    if out.found.is_none() && !out.seed_columns.is_empty() {
        out.look_beside_paths(chain);
    }
    out.finish(chain);
    out.misfits.sort_by(f64::total_cmp);
    if out.seed_columns.is_empty() {
        out.completeness = Completeness::Searched;
    }
    out
}

impl Curves {
    /// None yet; limits of the wished columns say what is a change point.
    pub fn new(wished: &[usize]) -> Self {
        Self {
            curves: Vec::new(),
            found: None,
            completeness: Completeness::Algebraic,
            count: Err(Uncounted::Searched),
            seed_columns: Vec::new(),
            seeds: 0,
            still: 0,
            misfits: Vec::new(),
            modes_at_zero: None,
            change_points: Vec::new(),
            arcs: Arcs::default(),
            unfollowed: Vec::new(),
            last: false,
            wished: wished.to_vec(),
            ahead: Vec::new(),
        }
    }

    /// Searches where no mode stands alone but paths to others were lost.
    fn look_beside_paths(&mut self, chain: &Chain) {
        let finder = ModeFinder::new(chain, self.seed_columns[0]);
        if !finder.is_degenerate() {
            return;
        }
        self.completeness = Completeness::Searched;
        self.count = Err(Uncounted::Searched);
        self.seed_columns.truncate(1);
        self.seeds = SEARCHED_SEEDS;
        for k in 0..SEARCHED_SEEDS {
            if let Some(mode) = finder.one_by_search(TAU * k as f64 / SEARCHED_SEEDS as f64) {
                self.take(chain, &[mode], self.wished[0]);
                return;
            }
        }
    }

    /// Whether all branch points of the first seed column are accounted for.
    pub fn is_counted(&self) -> bool {
        self.count.as_ref().is_ok_and(|c| c.open.is_empty())
    }

    /// Whether nothing was counted yet, or so wide a range is left open that another joint may have an account of it.
    fn is_doubtful(&self) -> bool {
        match &self.count {
            Ok(count) => count.open.iter().any(|o| o.to - o.from > WIDE_RANGE),
            Err(why) => *why != Uncounted::Still,
        }
    }

    /// The account of a column's branch points; curves that it leads to are followed.
    fn counted(
        &mut self,
        chain: &Chain,
        survey: &Survey,
        circle: Circle,
        (column, rising): (usize, usize),
    ) -> Result<Count, Uncounted> {
        let known = self.known(chain, survey, column);
        let mut far: Vec<f64> = Vec::new();
        counting::count(survey, circle, known, &mut |pose| {
            if follow::is_far(chain, pose) {
                // a curve is not followed so far, but may turn back there
                far.push(pose.values[column]);
            } else {
                // a circuit so narrow that it was missed bends sharply all along
                let last = std::mem::replace(&mut self.last, true);
                self.take(chain, &[*pose], rising);
                self.last = last;
            }
            let mut known = self.known(chain, survey, column);
            known.dead_centres.extend(&far);
            known
        })
    }

    /// Looks where solutions meet within ranges too narrow to be counted: in a pose that stands alone they are real at one input only.
    fn look_into(&mut self, chain: &Chain, finder: &ModeFinder, count: &mut Count) {
        count.open.retain(|open| {
            if open.to - open.from > WIDE_RANGE {
                return true;
            }
            let mut met = 0;
            let (middle, wide) = (0.5 * (open.from + open.to), open.to - open.from);
            // solutions that meet at one real input are complex beside it
            for place in finder.rough_at(middle, REAL.max(NEARLY_REAL * wide)) {
                if self.holds(chain, &place) || !self.branches(chain, &place, false) {
                    continue;
                }
                if let Some(point) = self.arcs.at(chain, &place) {
                    let pose = self.arcs.points[point].at;
                    self.find_at(chain, &pose);
                    met += BRANCH_POINTS_OF_POSE;
                }
            }
            open.missing != Some(met) || met == 0
        });
    }

    /// The zeros of the determinant that the curves tell of.
    fn known(&self, chain: &Chain, survey: &Survey, column: usize) -> Known {
        let singular = self.arcs.points.iter().map(|p| p.at.values[column]);
        let mut known = Known { singular: singular.collect(), ..Known::default() };
        let joined = self.arcs.joined(chain, self.wished[0]);
        for curve in self.curves.iter().chain(&joined) {
            let turnings = turnings::turnings(curve, chain, column);
            let smooth = turnings.iter().filter(|t| !t.node.is_crossing());
            known
                .dead_centres
                .extend(smooth.map(|t| t.node.at.values[column]));
            known.meetings.extend(meetings::meetings(survey, chain, curve));
        }
        known
    }

    /// Whether some motion is known.
    fn is_empty(&self) -> bool {
        self.curves.is_empty() && self.arcs.is_empty()
    }

    /// Those modes that lie on no curve yet.
    fn unknown(&self, chain: &Chain, modes: &[Configuration]) -> Vec<Configuration> {
        let mut modes = not_on_any(chain, &self.curves, modes.to_vec());
        modes.retain(|m| !self.arcs.hold(chain, m));
        modes
    }

    /// The same, the curves ahead aside too.
    fn unforeseen(&self, chain: &Chain, modes: &[Configuration]) -> Vec<Configuration> {
        not_on_any(chain, &self.ahead, self.unknown(chain, modes))
    }

    /// Follows the closed curves through what is to come, many pieces side by side.
    fn look_ahead(&mut self, finder: &ModeFinder, rough: &[Vec<Configuration>], drawings: &[Configuration]) {
        let chain = finder.chain;
        for (first, every) in AHEAD {
            let mut places = self.unforeseen(chain, drawings);
            for modes in rough.iter().skip(first).step_by(every) {
                if modes.len() <= MOST_MODES {
                    places.extend(finder.polished(&self.unforeseen(chain, modes)).modes);
                }
            }
            self.ahead.extend(join::closed_curves(chain, &places));
        }
    }

    /// Whether a mode is a place of a known curve.
    fn holds(&self, chain: &Chain, mode: &Configuration) -> bool {
        self.curves.iter().any(|c| lies_on(chain, c, mode)) || self.arcs.hold(chain, mode)
    }

    /// Which of the curves ahead leads over a mode, and the rates there.
    fn foreseen(&self, chain: &Chain, mode: &Configuration) -> Option<(usize, Node)> {
        let mut ahead = self.ahead.iter().enumerate();
        ahead.find_map(|(k, curve)| Some((k, *place_on(chain, curve, mode)?)))
    }

    /// One of the curves ahead, turned round if `backwards`.
    fn taken_ahead(&mut self, chain: &Chain, which: usize, backwards: bool) -> Curve {
        let curve = self.ahead.swap_remove(which);
        if backwards {
            follow::turned_round(chain, &curve, &[])
        } else {
            curve
        }
    }

    /// Follows the motions through modes, those aside that lie on one already followed; the given column rises at first.
    pub fn take(&mut self, chain: &Chain, modes: &[Configuration], rising: usize) {
        for modes in modes.chunks(MOST_MODES) {
            self.take_together(chain, modes, rising);
        }
    }

    /// Follows what leads out of a pose at which the motion may not be smooth; tells whether it is a change point or stands alone.
    fn branches(&mut self, chain: &Chain, pose: &Configuration, stuck: bool) -> bool {
        if self.arcs.learn(chain, pose, &self.wished, stuck).is_none() {
            return false;
        }
        let passing = self.arcs.complete(chain, &self.wished);
        // what was followed over the point by rounding is known by its arcs
        self.curves.retain(|c| !contains(chain, c, &self.arcs));
        for curve in passing {
            if !lies_on_any(chain, &self.curves, curve.plainest()) {
                self.curves.push(curve);
            }
        }
        true
    }

    /// Follows what was left for the last, joins the arcs between change points, and says how freely the loop moves.
    pub fn finish(&mut self, chain: &Chain) {
        self.last = true;
        for mode in std::mem::take(&mut self.unfollowed) {
            let near = |n: &Node| length(&chain.difference(&n.at, &mode)) * n.inverse_norm < BESIDE_BEND;
            let beside_bend = |c: &Curve| c.nodes.iter().any(|n| n.inverse_norm > SHARP && near(n));
            if !self.curves.iter().any(beside_bend) {
                self.take_together(chain, &[mode], self.wished[0]);
            }
        }
        self.curves.extend(self.arcs.joined(chain, self.wished[0]));
        self.forget_parts(chain);
        self.change_points = std::mem::take(&mut self.arcs.points);
        let finite = if self.curves.is_empty() {
            self.arcs.finite
        } else {
            1
        };
        // all modes may have been change points, or of full rank within what redundant constraints may miss each other by
        let one = self.found.as_ref().is_some_and(|f| f.rank + 1 == chain.columns);
        if let Some(curve) = self.curves.first().filter(|_| !one) {
            let rank = chain.columns - 1;
            let redundant = wrenches(&chain.screws(curve.plainest()), rank);
            self.found = Some(Found { rank, redundant, finite });
        }
        if let Some(found) = &mut self.found {
            found.finite = found.finite.min(finite);
        }
    }

    /// Looks at the rank of a pose.
    fn find_at(&mut self, chain: &Chain, pose: &Configuration) {
        let columns = chain.screws(pose);
        let rank = rank(&singular_values(&columns).0, NO_RANK);
        self.find(chain, &columns, rank);
    }

    /// Holds the greatest rank of all poses, and what goes with it.
    fn find(&mut self, chain: &Chain, columns: &[Vec<f64>], rank: usize) {
        if self.found.as_ref().is_none_or(|f| rank > f.rank) {
            self.found =
                Some(Found { rank, redundant: wrenches(columns, rank), finite: chain.columns - rank });
        }
    }

    fn take_together(&mut self, chain: &Chain, modes: &[Configuration], rising: usize) {
        let mut starts: Vec<Start> = Vec::new();
        let mut curves: Vec<Option<Curve>> = Vec::new();
        for mode in modes {
            let known = |c: &Curve| lies_on(chain, c, mode);
            if self.holds(chain, mode) || curves.iter().flatten().any(known) {
                continue;
            }
            if follow::is_far(chain, mode) {
                self.still += 1;
                continue;
            }
            let foreseen = self.foreseen(chain, mode);
            let whole = self.found.as_ref().is_some_and(|f| f.rank + 1 == chain.columns);
            if let Some((which, node)) = foreseen.filter(|(_, n)| whole && n.inverse_norm < SHARP) {
                starts.push((*mode, node.rates[0]));
                curves.push(Some(self.taken_ahead(chain, which, node.rates[0][rising] < 0.0)));
                continue;
            }
            let columns = chain.screws(mode);
            let (values, vectors) = singular_values(&columns);
            let rank = rank(&values, NO_RANK);
            if chain.columns - rank != 1 {
                // on a surface every pose is like this one
                let isolated =
                    chain.columns > rank + 1 && self.arcs.finite < 2 && self.branches(chain, mode, false);
                self.still += usize::from(!isolated);
                // a mode beside a pose that stands alone has a greater rank
                let pose = self
                    .arcs
                    .at(chain, mode)
                    .map_or(*mode, |p| self.arcs.points[p].at);
                self.find_at(chain, &pose);
                continue;
            }
            self.find(chain, &columns, rank);
            if values[rank - 1] < NARROW * values[0] && !self.last {
                // where a curve bends sharply a start is not known well enough to be met again: from elsewhere first
                if !self.branches(chain, mode, false) {
                    self.unfollowed.push(*mode);
                }
                continue;
            }
            let mut direction = [0.0; COLUMNS];
            direction[..chain.columns].copy_from_slice(&vectors[chain.columns - 1]);
            if direction[rising] < 0.0 {
                direction = direction.map(|d| -d);
            }
            starts.push((*mode, direction));
            curves.push(
                foreseen.map(|(which, node)| {
                    self.taken_ahead(chain, which, dot(&node.rates[0], &direction) < 0.0)
                }),
            );
        }
        let left: Vec<Start> = starts
            .iter()
            .zip(&curves)
            .filter(|(_, c)| c.is_none())
            .map(|(s, _)| *s)
            .collect();
        let mut followed = follow::follow(chain, &left, &self.arcs.stops()).into_iter();
        let mut fresh: Vec<Curve> = Vec::new();
        for (curve, start) in curves.into_iter().zip(&starts) {
            let Some(curve) = curve.or_else(|| followed.next()) else {
                unreachable!()
            };
            // two modes may lie on one circuit
            if lies_on_any(chain, &fresh, &start.0)
                || lies_on_any(chain, &fresh, curve.plainest())
                || self.arcs.hold(chain, &start.0)
            {
                continue;
            }
            // one that could not be begun may lie on a curve that can be followed
            let stuck = curve.end == End::Singular && curve.nodes.len() > 2;
            let mut places = narrow_places(&curve);
            if curve.end == End::Singular {
                places.extend(curve.ends());
            }
            let mut branches = false;
            for place in places {
                branches |= self.branches(chain, &place, stuck);
            }
            if branches && (stuck || contains(chain, &curve, &self.arcs)) {
                continue;
            }
            let lost = curve.end == End::Singular && curve.nodes.iter().all(|n| n.inverse_norm > LOST);
            if curve.nodes.len() < 3 || curve.end == End::Open || lost {
                self.still += 1;
            } else if !self.is_known(chain, &curve) {
                fresh.push(curve);
            }
        }
        self.curves.extend(fresh);
    }

    /// Whether a curve with ends is known, though its start was not seen on one that is: beside a change point no step of a curve
    /// tells that a mode is on it, and a curve of too many nodes is known in part.
    fn is_known(&self, chain: &Chain, curve: &Curve) -> bool {
        if curve.end == End::Far {
            let overlap =
                |one: &Curve, other: &Curve| other.ends().into_iter().any(|at| lies_on(chain, one, at));
            let mut far = self.curves.iter().filter(|c| c.end == End::Far);
            return far.any(|c| overlap(c, curve) || overlap(curve, c));
        }
        lies_on_any(chain, &self.curves, curve.plainest())
    }

    /// Forgets the curves between change points that are parts of others: those led on where these ended, within rounding.
    fn forget_parts(&mut self, chain: &Chain) {
        let mut k = 0;
        while k < self.curves.len() {
            let curve = &self.curves[k];
            let mut others = self.curves[..k].iter().chain(&self.curves[k + 1..]);
            // of two that are parts of each other, as they end at change points a rounding apart, the longer stays
            let part_of = |c: &Curve| c.length() >= curve.length() && lies_on(chain, c, curve.plainest());
            if curve.end == End::Singular && others.any(part_of) {
                self.curves.remove(k);
            } else {
                k += 1;
            }
        }
    }
}

/// A basis of the wrenches that no joint yields to: force and moment with zero power on every screw.
fn wrenches(columns: &[Vec<f64>], rank: usize) -> Vec<[f64; 6]> {
    unyielding(columns, rank)
        .iter()
        // the power of force f and moment m on (w, v) is m w + f v
        .map(|v| [v[3], v[4], v[5], v[0], v[1], v[2]])
        .collect()
}
