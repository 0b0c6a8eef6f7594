//! The branch points of a turning input counted, so that no circuit is missed however narrow.
//!
//! A circuit on which the input does not go right round has dead centres of it, and these are branch points of the complex
//! solutions: zeros of the product of the solutions' determinants. The change of its phase along a path beside the real inputs
//! counts them. Where more are counted than known, the path is led nearer and the range halved, and Newton's method started
//! from the solutions on it.
//!
//! Source: docs/theory_many.md, (12) to (16), (20).

use super::locating::{Branching, branch_points};
use super::sectors::{
    Border, CLEAR, Known, Sector, Stand, Winding, all, apart, is_on_way, less, total, within,
};
use super::survey::Survey;
use crate::loops::equation::chain::Configuration;
use crate::loops::equation::closure::Solution;
use crate::loops::modes::circle::Circle;
use crate::loops::modes::continuation::{CAREFUL, Place};
use crate::loops::modes::finder::{CIRCLE, REAL as REAL_SOLUTION, Unknown};
use crate::loops::modes::starts::distinct;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Radii of the circles that are tried, where one loses a solution.
const RADII: [f64; 4] = [CIRCLE, 1.02, 1.1, 1.008];

/// How often a range that does not balance is halved, down to a millionth of a radian.
const MOST_HALVINGS: usize = 18;

/// The same where solutions run to infinity, or where a count fails: to a few ten thousandths and to some hundredths of a radian.
const MOST_HALVINGS_AT_POLES: usize = 9;
const MOST_HALVINGS_LOST: usize = 2;

/// Ranges that are looked into, all together.
const MOST_RANGES: usize = 300;

/// An open range wider than this [rad] is tried again from another circle.
const WIDE: f64 = 0.01;

/// Part of the circle's height to which the path of a range that does not balance is led first.
const LOWERED: f64 = 0.05;

/// A branch point this near the real inputs is real [rad], and two this near are one.
const REAL: f64 = 1e-9;
const SAME_POINT: f64 = 1e-8;

/// Cosine of a ball's middle turn below which its turns, and not its pose, are singular.
const GIMBAL: f64 = 1e-6;

/// A range of the input whose branch points are not accounted for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Open {
    /// Where it begins [rad, or length].
    pub from: f64,
    /// Its end.
    pub to: f64,
    /// Dead centres counted there and not known; none where the count itself failed, or solutions run to infinity.
    pub missing: Option<i64>,
}

impl Open {
    fn overlaps(&self, other: &Self) -> bool {
        self.has(other.from) || other.has(self.from)
    }

    /// Whether an input [rad] lies in it.
    pub(crate) fn has(&self, input: f64) -> bool {
        within(input, self.from, self.to)
    }
}

/// The account of an input's branch points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Count {
    /// The column of the input.
    pub column: usize,
    /// Real ones, dead centres of the circuits, or farther out than these are followed.
    pub dead_centres: usize,
    /// Complex ones that were located and counted off.
    pub complex_branch_points: usize,
    /// Joints, of those watched, that become infinite within the first circle; kept out by a path nearer to the real inputs.
    pub poles: usize,
    /// Circles that were tried, one after the other, up to the last that ranges were balanced on: another where a solution was lost, or
    /// a range did not balance.
    pub circles: usize,
    /// Ranges that do not balance, none where all do.
    pub open: Vec<Open>,
}

impl Count {
    /// A range that balances in another account is settled: open stay those that overlap one of that account's.
    pub fn settle_those_missing_in(&mut self, other: &[Open]) {
        self.open.retain(|a| other.iter().any(|b| a.overlaps(b)));
    }
}

/// Why nothing was counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Uncounted {
    /// The closure is not algebraic, or has no modes that stand alone.
    Searched,
    /// A solution was lost on every circle.
    Lost,
    /// There are motions with the input at rest.
    Still,
}

impl Uncounted {
    /// The word for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Searched => "searched",
            Self::Lost => "lost",
            Self::Still => "still",
        }
    }
}

struct Account<'a> {
    winding: Winding<'a>,
    known: Known,
    located: Vec<Branching>,
    open: Vec<Open>,
    ranges: usize,
    /// Follows the curve through a pose, and gives what is known then.
    seed: &'a mut dyn FnMut(&Configuration) -> Known,
}

/// The account, from the circle that was followed and what is known. `seed` follows the curve through a pose that was found, and
/// gives what is known then.
pub(crate) fn count(
    survey: &Survey,
    circle: Circle,
    known: Known,
    seed: &mut dyn FnMut(&Configuration) -> Known,
) -> Result<Count, Uncounted> {
    if survey.still {
        return Err(Uncounted::Still);
    }
    let closure = survey.algebraic.closure(Some(&survey.watch));
    let own = survey.algebraic.own();
    let places = circle.count;
    let mut account = Account {
        winding: Winding { survey, closure: &closure },
        known,
        located: Vec::new(),
        open: Vec::new(),
        ranges: 0,
        seed,
    };
    let mut followed = Some(circle);
    let mut count: Option<Count> = None;
    for (before, &radius) in RADII.iter().enumerate() {
        let circle = followed
            .take()
            .unwrap_or_else(|| survey.algebraic.circle(&closure, radius, places, CAREFUL));
        let Some(poles) = account.balance(&circle, &own) else {
            continue;
        };
        let open = std::mem::take(&mut account.open);
        let count = count.get_or_insert_with(|| Count { open: open.clone(), ..Count::default() });
        count.settle_those_missing_in(&open);
        count.column = survey.finder.input;
        count.dead_centres = account.known.dead_centres.len();
        count.complex_branch_points = account.located.iter().filter(|b| !b.real).count();
        count.poles = count.poles.max(poles as usize);
        count.circles = before + 1;
        // with what was located the ways down of the next circle are others
        let on_way = |o: &Open| [o.from, o.to].iter().any(|at| is_on_way(&account.located, *at));
        if count.open.iter().all(|o| o.to - o.from < WIDE && !on_way(o)) {
            break;
        }
    }
    count.ok_or(Uncounted::Lost)
}

impl Account<'_> {
    /// Settles all ranges of a circle; gives how many solutions run to infinity within it, or nothing where a solution was lost on
    /// the way round.
    fn balance(&mut self, circle: &Circle, own: &[usize]) -> Option<i64> {
        let sectors = self.winding.sectors(&self.known, &self.located, circle, own)?;
        for Sector { places, borders: [a, b], numbers } in &sectors {
            if self.missing(Some(*numbers), a, b) == Some(0) {
                continue;
            }
            let stand = |border: &Border, k: usize| {
                let places = all(own, &circle.places[k])?;
                self.winding.lowered(&Stand { border: *border, places }, LOWERED)
            };
            match (stand(a, places[0]), stand(b, places[1])) {
                (Some(a), Some(b)) => self.settle(&a, &b, 0),
                _ => self.open(a, b, None),
            }
        }
        Some(sectors.iter().map(|s| s.numbers.1).sum())
    }

    /// How many branch points are counted between two borders and not known.
    fn missing(&self, numbers: Option<(i64, i64)>, a: &Border, b: &Border) -> Option<i64> {
        let (zeros, poles) = numbers?;
        if poles > 0 || zeros % self.winding.survey.flips != 0 {
            return None;
        }
        let between = |at: &f64| within(*at, a.angle, b.angle);
        let known = self.known.simple().filter(|at| between(at)).count() as i64;
        let singular = self.known.singular.iter().filter(|at| between(at)).count() as i64;
        let complex = self.located.iter().filter(|b| !b.real);
        let complex = complex
            .filter(|p| between(&p.tau.re) && p.tau.im.abs() < a.height)
            .count() as i64;
        Some(zeros / self.winding.survey.flips - known - singular - complex)
    }

    /// Looks for what is missing between two borders, in ever smaller ranges.
    fn settle(&mut self, a: &Stand, b: &Stand, halved: usize) {
        let (from, to) = (&a.border, &b.border);
        let numbers = self
            .winding
            .closure
            .along(&a.places, from.height, (from.angle, to.angle))
            .filter(|places| self.winding.are_same(places, &b.places))
            .and_then(|places| {
                self.winding
                    .numbers(from, to, &less(total(&places), total(&a.places)))
            });
        if self.missing(numbers, from, to) == Some(0) {
            return;
        }
        let middle = self.winding.parted(&self.known, a, b);
        let most = match numbers {
            None => MOST_HALVINGS_LOST,
            Some((_, 0)) => MOST_HALVINGS,
            Some(_) => MOST_HALVINGS_AT_POLES,
        };
        if most == MOST_HALVINGS
            && let Some(middle) = &middle
        {
            self.locate(&[a, middle, b]);
        }
        let missing = self.missing(numbers, from, to);
        if missing == Some(0) {
            return;
        }
        self.ranges += 1;
        if halved < most
            && self.ranges < MOST_RANGES
            && let Some(middle) = middle
        {
            let lower = |stand: &Stand| self.winding.lowered(stand, 0.5);
            if let (Some(a), Some(middle), Some(b)) = (lower(a), lower(&middle), lower(b)) {
                self.settle(&a, &middle, halved + 1);
                self.settle(&middle, &b, halved + 1);
                return;
            }
        }
        self.open(from, to, missing);
    }

    fn open(&mut self, a: &Border, b: &Border, missing: Option<i64>) {
        // neighbours are one
        if let Some(last) = self.open.last_mut()
            && last.to == a.angle
        {
            last.to = b.angle;
            last.missing = last.missing.zip(missing).map(|(x, y)| x + y);
            // one on the border itself is counted on one side, and known on the other
            let on_border = |b: &Branching| apart(b.tau.re, a.angle) < CLEAR;
            if last.missing == Some(0) && self.located.iter().any(on_border) {
                self.open.pop();
            }
        } else {
            self.open.push(Open { from: a.angle, to: b.angle, missing });
        }
    }

    /// Branch points to which the places at the borders of a range lead; the curves through real ones are followed.
    fn locate(&mut self, borders: &[&Stand]) {
        let finder = self.winding.survey.finder;
        let slides = &finder.slides;
        let (from, to) = (borders[0].border.angle, borders[borders.len() - 1].border.angle);
        let (height, wide) = (borders[0].border.height, to - from);
        let starts: Vec<(&Place, Complex64)> = borders
            .iter()
            .flat_map(|b| {
                b.places
                    .iter()
                    .map(|p| (p, Complex64::new(b.border.angle, -height)))
            })
            .collect();
        let wanted = |tau: Complex64| {
            tau.im.abs() < 2.5 * height && tau.re > from - 0.5 * wide && tau.re < to + 0.5 * wide
        };
        let idle = !finder.chain.halves.is_empty();
        // the other joints are the same with a ball's turns turned over
        let plain = |mut x: Solution| {
            for (x, unknown) in x.iter_mut().zip(&finder.unknowns) {
                if matches!(unknown, Unknown::BallTurn(..)) {
                    *x = Complex64::ONE;
                }
            }
            x
        };
        for found in branch_points(self.winding.closure, slides, &starts, wanted) {
            let gimbal = |&(i, zero): &(usize, Complex64)| {
                let z = found.at[i] / zero;
                (z + 1.0 / z).norm() < 2.0 * GIMBAL
            };
            let known = |b: &&Branching| {
                let turned = (found.tau - b.tau) / TAU;
                let near = (turned - turned.re.round()).norm() * TAU < SAME_POINT;
                // flips of one pose are one point
                near && (idle
                    || distinct(slides, [b.at, found.at].map(plain).into_iter(), SAME_POINT.sqrt()).len()
                        == 1)
            };
            if self.winding.survey.watch.middles.iter().any(gimbal) || self.located.iter().any(|b| known(&b))
            {
                continue;
            }
            let pose = (found.tau.im.abs() < REAL)
                .then(|| {
                    finder.configuration(
                        &found.at,
                        &self.winding.survey.algebraic.zeros,
                        found.tau.re,
                        REAL_SOLUTION,
                    )
                })
                .flatten();
            // with an idle link turned over it is no pose of a curve; the one that is will be found, too
            if pose.as_ref().is_some_and(|p| !finder.chain.counts(p)) {
                continue;
            }
            self.located.push(Branching { real: pose.is_some(), ..found });
            if let Some(pose) = pose {
                self.known = (self.seed)(&pose);
            } else {
                let mirrored = std::array::from_fn(|i| {
                    if slides[i] {
                        found.at[i].conj()
                    } else {
                        1.0 / found.at[i].conj()
                    }
                });
                let tau = found.tau.conj();
                self.located.push(Branching { tau, at: mirrored, real: false });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::survey::Infinite;
    use super::*;
    use crate::loops::equation::chain::Chain;
    use crate::loops::equation::closed::Joint;
    use crate::loops::modes::finder::ModeFinder;
    use crate::loops::modes::starts::random_pose;
    use crate::random::Random;
    use crate::rigid::Pose;

    /// What is counted between the places of the first circle.
    fn numbers(survey: &Survey) -> Vec<(f64, (i64, i64))> {
        let closure = survey.algebraic.closure(Some(&survey.watch));
        let circle = survey.algebraic.circle(&closure, CIRCLE, 24, CAREFUL);
        let winding = Winding { survey, closure: &closure };
        let sectors = winding
            .sectors(&Known::default(), &[], &circle, &survey.algebraic.own())
            .unwrap();
        sectors.iter().map(|s| (s.borders[0].angle, s.numbers)).collect()
    }

    #[test]
    fn the_poles_in_closed_form_are_those_that_the_phases_tell_of() {
        let mut random = Random(3);
        let mut seen = 0;
        for _ in 0..12 {
            let mut links: Vec<Pose> = (0..6).map(|_| random_pose(&mut random)).collect();
            let all = links.iter().fold(Pose::STILL, |a, b| a.then(b));
            links.push(all.inverse());
            let chain = Chain::new(vec![Joint::Turn; 7], links);
            let finder = ModeFinder::new(&chain, 0);
            let closed = Survey::new(&finder).unwrap();
            assert!(matches!(closed.infinite, Infinite::At(_)));
            let algebraic = finder.algebraic().unwrap();
            let watched = Survey::watching(&finder, algebraic, closed.watch.clone(), None);
            let (a, b) = (numbers(&closed), numbers(&watched));
            assert_eq!(a, b);
            seen += a.iter().map(|(_, n)| n.1).sum::<i64>();
        }
        assert!(seen > 10);
    }

    /// The account of a loop by rows of length and twist [deg], from dead centres that are known.
    fn count_of(length: &[f64], twist_deg: &[f64], known: &[f64]) -> Count {
        let links = length.iter().zip(twist_deg).map(|(&a, t)| {
            let (s, c) = t.to_radians().sin_cos();
            Pose {
                rotation: [[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]],
                translation: [a, 0.0, 0.0],
            }
        });
        let chain = Chain::new(vec![Joint::Turn; length.len()], links.collect());
        let finder = ModeFinder::new(&chain, 0);
        let survey = Survey::new(&finder).unwrap();
        let circle = finder.around(24, Some(&survey.watch)).1.unwrap();
        let known = Known { dead_centres: known.to_vec(), ..Known::default() };
        count(&survey, circle, known.clone(), &mut |_| known.clone()).unwrap()
    }

    #[test]
    fn a_planar_four_bar_has_its_limits_and_no_other_branch_points() {
        // the coupler and the rocker in line, by the cosine rule; the last row is the ground
        let [a, b, c, d] = [2.0, 1.0, 2.2, 2.9];
        let limit = |sum: f64| {
            let x: f64 = (a * a + d * d - sum * sum) / (2.0 * a * d);
            (x.abs() < 1.0).then(|| x.acos())
        };
        let limits: Vec<f64> = [limit(b + c), limit(c - b)]
            .into_iter()
            .flatten()
            .flat_map(|x| [std::f64::consts::PI - x, x - std::f64::consts::PI])
            .collect();
        assert_eq!(limits.len(), 4);
        let whole = count_of(&[a, b, c, d], &[0.0; 4], &limits);
        assert_eq!((whole.dead_centres, whole.open), (4, vec![]));
        // one that is not known is searched for, in a range that holds it
        let lacking = count_of(&[a, b, c, d], &[0.0; 4], &limits[1..]);
        assert!(!lacking.open.is_empty());
        assert!(
            lacking
                .open
                .iter()
                .any(|o| within(limits[0], o.from - 1e-9, o.to + 1e-9))
        );
    }

    #[test]
    fn a_crank_has_no_branch_points() {
        for twist in [[0.0; 4], [20.0, 50.0, 60.0, 70.0]] {
            let count = count_of(
                if twist[0] == 0.0 {
                    &[1.0, 3.0, 2.5, 2.0]
                } else {
                    &[0.0; 4]
                },
                &twist,
                &[],
            );
            assert_eq!(
                (count.dead_centres, count.complex_branch_points, count.open),
                (0, 0, vec![])
            );
        }
    }
}
