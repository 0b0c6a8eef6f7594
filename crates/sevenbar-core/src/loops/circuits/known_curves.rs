//! The curves of a chain that are known, and how more of them are taken up.

use super::arcs::{Arcs, contains, narrow_places};
use super::change_points::ChangePoint;
use super::curve::{Curve, End, Node};
use super::follow::{self, Start};
use super::found::{Found, Search};
use super::on_curve::{lies_on, lies_on_any, not_on_any, place_on};
use super::walked_again;
use crate::loops::equation::chain::Chain;
use crate::loops::equation::closed::{At, Closed};
use crate::loops::equation::dense::{Array, dot, length, singular_values};
use crate::loops::mobility::rank::{rank, unyielding};
use crate::loops::modes::finder::Completeness;

/// Modes of a loop without screws at an input; where more are found, curves of them are, and few are followed at once.
pub(super) const MOST_MODES: usize = 16;

/// Norm of the screws' inverse from which rounding leaves nothing to follow.
const LOST: f64 = 1e6;

/// A mode whose screws have a singular value below this part of the greatest lies at a sharp bend.
const NARROW: f64 = 1e-5;

/// Norm of the screws' inverse at a sharp bend, and how many of its radii from a node of it a mode may be that lies there.
const SHARP: f64 = 1e4;
const BESIDE_BEND: f64 = 30.0;

/// All curves of a chain.
pub(crate) struct Curves<S: Closed = Chain> {
    pub curves: Vec<Curve<S>>,
    /// What was searched, and what was found.
    pub search: Search,
    /// Poses at which curves are not smooth, or that stand alone, once all curves are known.
    pub change_points: Vec<ChangePoint<S>>,
    pub arcs: Arcs<S>,
    /// Modes at sharp bends, left for the last; and whether they are followed now.
    sharp: Vec<At<S>>,
    /// Modes from which no motion was followed when they were met.
    not_followed: Vec<At<S>>,
    /// Those of them that lie on no curve, nor at a change point with a way out, once all curves are known.
    pub lost: Vec<At<S>>,
    pub last: bool,
    /// Columns whose limits say what is a change point.
    pub wished: Vec<usize>,
    /// Curves through some of the modes to come.
    pub ahead: Vec<Curve<S>>,
}

impl<S: Closed> Curves<S> {
    /// None yet; limits of the wished columns say what is a change point.
    pub fn new(wished: &[usize]) -> Self {
        Self {
            curves: Vec::new(),
            search: Search::new(Completeness::Algebraic),
            change_points: Vec::new(),
            arcs: Arcs::new(),
            sharp: Vec::new(),
            not_followed: Vec::new(),
            lost: Vec::new(),
            last: false,
            wished: wished.to_vec(),
            ahead: Vec::new(),
        }
    }

    /// Whether some motion is known.
    pub fn is_empty(&self) -> bool {
        self.curves.is_empty() && self.arcs.is_empty()
    }

    /// Those modes that lie on no curve yet.
    pub fn unknown(&self, chain: &S, modes: &[At<S>]) -> Vec<At<S>> {
        let mut modes = not_on_any(chain, &self.curves, modes.to_vec());
        modes.retain(|m| !self.arcs.hold(chain, m));
        modes
    }

    /// Whether a mode is a place of a known curve.
    pub fn holds(&self, chain: &S, mode: &At<S>) -> bool {
        self.curves.iter().any(|c| lies_on(chain, c, mode)) || self.arcs.hold(chain, mode)
    }

    /// Which of the curves ahead leads over a mode, and the rates there.
    fn foreseen(&self, chain: &S, mode: &At<S>) -> Option<(usize, Node<S>)> {
        let mut ahead = self.ahead.iter().enumerate();
        ahead.find_map(|(k, curve)| Some((k, *place_on(chain, curve, mode)?)))
    }

    /// One of the curves ahead, turned round if `backwards`.
    fn taken_ahead(&mut self, chain: &S, which: usize, backwards: bool) -> Curve<S> {
        let curve = self.ahead.swap_remove(which);
        if backwards {
            walked_again::turned_round(chain, &curve, &[])
        } else {
            curve
        }
    }

    /// Follows the motions through modes, those aside that lie on one already followed; the given column rises at first.
    pub fn take(&mut self, chain: &S, modes: &[At<S>], rising: usize) {
        for modes in modes.chunks(MOST_MODES) {
            self.take_together(chain, modes, rising);
        }
    }

    /// Follows what leads out of a pose at which the motion may not be smooth; returns whether it is a change point or isolated.
    pub fn branches(&mut self, chain: &S, pose: &At<S>, stuck: bool) -> bool {
        if self.arcs.is_endless() || self.arcs.learn(chain, pose, &self.wished, stuck).is_none() {
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
    pub fn finish(&mut self, chain: &S) {
        self.last = true;
        for mode in std::mem::take(&mut self.sharp) {
            let near = |n: &Node<S>| length(&chain.difference(&n.at, &mode)) * n.inverse_norm < BESIDE_BEND;
            let beside_bend = |c: &Curve<S>| c.nodes.iter().any(|n| n.inverse_norm > SHARP && near(n));
            if self.curves.iter().any(beside_bend) {
                continue;
            }
            self.take_together(chain, &[mode], self.wished[0]);
        }
        self.curves.extend(self.arcs.joined(chain, self.wished[0]));
        self.search.bound = self.arcs.bound();
        self.arcs.forget();
        self.forget_parts(chain);
        self.change_points = std::mem::take(&mut self.arcs.points);
        // on a change point, or on a curve that another mode has led to
        let mut lost = std::mem::take(&mut self.not_followed);
        lost.retain(|m| {
            !lies_on_any(chain, &self.curves, m) && !self.change_points.iter().any(|p| p.is_at(chain, m))
        });
        self.search.unfollowed += lost.len();
        self.lost = lost;
        self.search.unfollowed += self.arcs.not_followed();
        self.name_ends(chain);
        let missing = |p: &ChangePoint<S>| p.lost + usize::from(p.blurred);
        self.search.unfollowed += self.change_points.iter().map(missing).sum::<usize>();
        let finite = if self.curves.is_empty() {
            self.arcs.finite
        } else {
            1
        };
        // all modes may have been change points, or of full rank within what redundant constraints may miss each other by
        let one = self
            .search
            .found
            .as_ref()
            .is_some_and(|f| f.rank + 1 == chain.columns());
        if let Some(curve) = self.curves.first().filter(|_| !one) {
            let rank = chain.columns() - 1;
            let redundant = unyielding(&chain.screws(curve.plainest()), S::ROWS, rank);
            self.search.found = Some(Found { rank, redundant, finite });
        }
        if let Some(found) = &mut self.search.found {
            found.finite = found.finite.min(finite);
        }
    }

    /// Calls the ends of curves change points where these were not found: more may begin there than was followed.
    fn name_ends(&mut self, chain: &S) {
        for curve in &self.curves {
            for end in curve.singular_ends() {
                if let Some(known) = self.change_points.iter_mut().find(|p| p.is_at(chain, end)) {
                    known.lost += usize::from(known.rays.is_empty());
                    // every way out goes on by another, and yet this one ends
                    known.blurred |= known.is_smooth();
                } else {
                    self.change_points.push(ChangePoint::of_end(end));
                }
            }
        }
    }

    /// Looks at the rank of a pose.
    pub fn find_at(&mut self, chain: &S, pose: &At<S>) {
        let columns = chain.screws(pose);
        let rank = rank(&singular_values(&columns).0, S::ROWS, chain.no_rank());
        self.find(chain, &columns, rank);
    }

    /// Holds the greatest rank of all poses, and what goes with it.
    fn find(&mut self, chain: &S, columns: &[Vec<f64>], rank: usize) {
        if self.search.found.as_ref().is_none_or(|f| rank > f.rank) {
            self.search.found = Some(Found {
                rank,
                redundant: unyielding(columns, S::ROWS, rank),
                finite: chain.columns() - rank,
            });
        }
    }

    fn take_together(&mut self, chain: &S, modes: &[At<S>], rising: usize) {
        let mut starts: Vec<Start<S>> = Vec::new();
        let mut curves: Vec<Option<Curve<S>>> = Vec::new();
        for mode in modes {
            let known = |c: &Curve<S>| lies_on(chain, c, mode);
            if self.holds(chain, mode) || curves.iter().flatten().any(known) {
                continue;
            }
            if follow::is_far(chain, mode) {
                self.not_followed.push(*mode);
                continue;
            }
            let foreseen = self.foreseen(chain, mode);
            let whole = self
                .search
                .found
                .as_ref()
                .is_some_and(|f| f.rank + 1 == chain.columns());
            if let Some((which, node)) = foreseen.filter(|(_, n)| whole && n.inverse_norm < SHARP) {
                starts.push((*mode, node.rates[0]));
                curves.push(Some(self.taken_ahead(chain, which, node.rates[0][rising] < 0.0)));
                continue;
            }
            let columns = chain.screws(mode);
            let (values, vectors) = singular_values(&columns);
            let rank = rank(&values, S::ROWS, chain.no_rank());
            if chain.columns() - rank != 1 {
                // on a surface every pose is like this one
                let isolated =
                    chain.columns() > rank + 1 && self.arcs.finite < 2 && self.branches(chain, mode, false);
                if !isolated {
                    self.not_followed.push(*mode);
                }
                // a mode next to an isolated pose has a greater rank
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
                    self.sharp.push(*mode);
                }
                continue;
            }
            if foreseen.is_none() && self.arcs.is_endless() {
                self.not_followed.push(*mode);
                continue;
            }
            let mut direction: S::Columns<f64> = Array::padded(&vectors[chain.columns() - 1], 0.0);
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
        let left: Vec<Start<S>> = starts
            .iter()
            .zip(&curves)
            .filter(|(_, c)| c.is_none())
            .map(|(s, _)| *s)
            .collect();
        let mut followed = follow::follow(chain, &left, &self.arcs.stops()).into_iter();
        let mut fresh: Vec<Curve<S>> = Vec::new();
        for (curve, start) in curves.into_iter().zip(&starts) {
            let Some(mut curve) = curve.or_else(|| followed.next()) else {
                unreachable!()
            };
            let known_endless = follow::is_endless(chain, &curve);
            self.arcs.endless += usize::from(known_endless);
            // two modes may lie on one circuit
            if lies_on_any(chain, &fresh, &start.0)
                || lies_on_any(chain, &fresh, curve.plainest())
                || self.arcs.hold(chain, &start.0)
            {
                continue;
            }
            // one that could not be begun may lie on a curve that can be followed
            let mut patience = self.arcs.patience;
            let branches = walked_again::follow_on(chain, *start, &mut curve, &mut patience, &mut |curve| {
                (self.led_to(chain, curve), self.arcs.stops())
            });
            self.arcs.patience = self.arcs.patience.min(patience);
            self.arcs.endless += usize::from(!known_endless && follow::is_endless(chain, &curve));
            let stuck = curve.is_stuck() && curve.nodes.len() > 2;
            // a way into a change point that none of its ways out leads back is kept as it is
            let held = |at: &At<S>| self.arcs.hold(chain, at);
            let by_arcs = || stuck && (chain.is_redundant() || held(&start.0) || held(curve.plainest()));
            if branches && (by_arcs() || contains(chain, &curve, &self.arcs)) {
                continue;
            }
            let lost = curve.ends_by(End::Singular) && curve.nodes.iter().all(|n| n.inverse_norm > LOST);
            if curve.nodes.len() < 3 || curve.ends_by(End::Open) || lost {
                self.not_followed.push(start.0);
            } else if !self.is_known(chain, &curve) {
                fresh.push(curve);
            }
        }
        // one that was followed over a change point that another has led to is known by its arcs, too
        fresh.retain(|c| !contains(chain, c, &self.arcs));
        self.curves.extend(fresh);
    }

    /// Whether a curve leads to change points, all branches of which are followed then.
    fn led_to(&mut self, chain: &S, curve: &Curve<S>) -> bool {
        let stuck = curve.is_stuck() && curve.nodes.len() > 2;
        let mut places = narrow_places(curve);
        places.extend(curve.singular_ends());
        let mut branches = false;
        for place in places {
            branches |= self.branches(chain, &place, stuck);
        }
        branches
    }

    /// Whether a curve with ends is known, though its start was not seen on one that is: beside a change point no step of a curve
    /// tells that a mode is on it, and a curve of too many nodes is known in part.
    fn is_known(&self, chain: &S, curve: &Curve<S>) -> bool {
        let overlap =
            |one: &Curve<S>, other: &Curve<S>| other.ends().into_iter().any(|at| lies_on(chain, one, at));
        let mut far = self.curves.iter().filter(|c| c.ends_by(End::Far));
        lies_on_any(chain, &self.curves, curve.plainest())
            || (curve.ends_by(End::Far) && far.any(|c| overlap(c, curve) || overlap(curve, c)))
    }

    /// Forgets the curves between change points that are parts of others: those led on where these ended, within rounding.
    fn forget_parts(&mut self, chain: &S) {
        let mut k = 0;
        while k < self.curves.len() {
            let curve = &self.curves[k];
            let mut others = self.curves[..k].iter().chain(&self.curves[k + 1..]);
            // of two that are parts of each other, as they end at change points a rounding apart, the longer stays
            let part_of = |c: &Curve<S>| c.length() >= curve.length() && lies_on(chain, c, curve.plainest());
            if !curve.is_closed() && others.any(part_of) {
                self.curves.remove(k);
            } else {
                k += 1;
            }
        }
    }
}
