//! The branch points of a turning input counted, so that no circuit is missed however narrow.
//!
//! A circuit on which the input does not go right round has dead centres of it, and these are branch points of the complex
//! solutions: zeros of the product of the solutions' determinants. The change of its phase along a path beside the real inputs
//! counts them. Where more are counted than known, the path is led nearer and the range halved, and Newton's method started
//! from the solutions on it.
//!
//! Source: docs/theory_many.md, (12) to (16).

use super::around::{Around, Circle, Place};
use super::chain::{Chain, Configuration, Joint};
use super::locating::{Branching, branch_points, still};
use super::modes::{CIRCLE, ModeFinder, SAME_MODE, Unknown};
use super::paths::{BRISK, CAREFUL, Solution, UNKNOWNS};
use super::phases::{FACTORS, Watch};
use super::starts::{Random, distinct};
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};

/// Radii of the circles that are tried, where one loses a solution.
const RADII: [f64; 4] = [CIRCLE, 1.02, 1.1, 1.008];

/// What a count may be off a whole number before something was lost on the way.
const WHOLE: f64 = 0.02;

/// How often a range that does not balance is halved, down to a millionth of a radian.
const MOST_HALVINGS: usize = 18;

/// Part of the circle's height to which the path of a range that does not balance is led first.
const LOWERED: f64 = 0.05;

/// Where a range is parted, as parts of it, if a dead centre is in the way.
const PARTINGS: [f64; 4] = [0.5, 0.43, 0.59, 0.36];

/// No border stands nearer to a dead centre than this [rad].
const CLEAR: f64 = 1e-8;

/// A branch point this near the real inputs is real [rad], and two this near are one.
const REAL: f64 = 1e-9;
const SAME_POINT: f64 = 1e-8;

/// Cosine of a ball's middle turn below which its turns, and not its pose, are singular.
const GIMBAL: f64 = 1e-6;

/// `ln |e^(i tau)|` below which an input at which another joint moves alone counts as real.
const REAL_INPUT: f64 = 1e-6;

/// A range of the input whose branch points are not accounted for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Open {
    /// Where it begins and ends [rad].
    pub from: f64,
    /// Its end.
    pub to: f64,
    /// Dead centres counted there and not known; none where the count itself failed, or solutions run to infinity.
    pub missing: Option<i64>,
}

/// The account of an input's branch points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Count {
    /// The column of the input.
    pub column: usize,
    /// Real ones, dead centres of the circuits.
    pub dead_centres: usize,
    /// Complex ones that were located and counted off.
    pub complex_branch_points: usize,
    /// Solutions that run to infinity within the first circle, kept out by a path nearer to the real inputs.
    pub poles: usize,
    /// Ranges that do not balance, none where all do.
    pub open: Vec<Open>,
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

/// What is watched on the way round, and where the watched joints have their values.
pub(super) struct Survey<'a> {
    finder: &'a ModeFinder<'a>,
    pub watch: Watch,
    infinite: Infinite,
    /// Of how many solutions each pose has one: those with a ball's turns, or an idle coupler, turned over.
    flips: i64,
    still: bool,
}

/// What tells of solutions that run to infinity.
enum Infinite {
    /// `e^(i tau)` where they do, one at infinity being one at zero in the mirror of the real inputs.
    At(Vec<Complex64>),
    /// `e^(i tau)` of the solutions at which each joint has its watched value.
    Watched([Vec<Complex64>; UNKNOWNS]),
}

/// A way down to a real input: where it begins, and the change of the phases on it.
#[derive(Clone, Copy)]
struct Border {
    angle: f64,
    height: f64,
    down: [f64; FACTORS],
}

/// The range between two borders of a circle, the places at which they stand, and its zeros less poles and infinite joints.
struct Sector {
    places: [usize; 2],
    borders: [Border; 2],
    numbers: (i64, i64),
}

/// A border with the places at its top.
struct Stand {
    border: Border,
    places: Vec<Place>,
}

struct Account<'a> {
    survey: &'a Survey<'a>,
    closure: &'a Around<'a>,
    /// Inputs of the dead centres of all curves, and of poses at which they are not smooth.
    known: Vec<f64>,
    singular: &'a [f64],
    located: Vec<Branching>,
    open: Vec<Open>,
    /// Follows the curve through a pose; gives the inputs of its dead centres if it is new.
    seed: &'a mut dyn FnMut(&Configuration) -> Vec<f64>,
}

impl<'a> Survey<'a> {
    /// For an input that turns; `None` where its modes are not algebraic.
    pub fn new(finder: &'a ModeFinder<'a>) -> Option<Self> {
        if !finder.is_algebraic() {
            return None;
        }
        let zeros = finder.zeros();
        let mut watch = Watch { values: [None; UNKNOWNS], middles: Vec::new() };
        for (i, unknown) in finder.unknowns.iter().enumerate() {
            match *unknown {
                Unknown::BallTurn(_, 1) => watch.middles.push((i, zeros[i])),
                Unknown::Column(c) => {
                    let half = finder.chain.halves.iter().find(|h| h.0 == c);
                    let middle = half.map(|h| (i, zeros[i] * Complex64::from_polar(1.0, h.1)));
                    watch.middles.extend(middle);
                }
                _ => {}
            }
        }
        let flips = 1 << watch.middles.len();
        // the columns of a general loop of seven turning joints
        let general = watch.middles.is_empty()
            && !finder.slides.contains(&true)
            && finder.unknowns.iter().all(|u| matches!(u, Unknown::Column(_)))
            && finder.is_general();
        let known = if general { finder.poles() } else { None };
        if let Some(at) = known {
            // solutions infinite at a real input may be those of a motion with the input at rest
            let still = at.iter().any(|x| x.norm().ln().abs() < REAL_INPUT);
            return Some(Self { finder, watch, infinite: Infinite::At(at), flips, still });
        }
        Some(Self::watching_all(finder, watch))
    }

    /// With every passive joint watched, as special geometry asks for.
    fn watching_all(finder: &'a ModeFinder<'a>, mut watch: Watch) -> Self {
        let zeros = finder.zeros();
        let mut random = Random(0xb0b);
        let mut met: [Vec<Complex64>; UNKNOWNS] = Default::default();
        let mut rests = false;
        let chain = turned_out(finder);
        let closure = finder.closure(None);
        for i in 0..UNKNOWNS {
            if matches!(finder.unknowns[i], Unknown::Added) {
                continue;
            }
            let value = Complex64::from_polar(0.45 + 0.35 * random.uniform(), TAU * random.uniform());
            let solutions = solutions_with(&chain, finder, i, value);
            let at: Vec<(Solution, Complex64)> = solutions
                .iter()
                .map(|(x, input)| (*x, closure.zero() * input))
                .collect();
            for ((_, input), alone) in solutions.iter().zip(still(&closure, &at)) {
                if alone {
                    rests |= input.norm().ln().abs() < REAL_INPUT;
                } else {
                    met[i].push(*input);
                }
            }
            let zero = if finder.slides[i] {
                Complex64::ONE
            } else {
                zeros[i]
            };
            watch.values[i] = Some(value * zero);
        }
        let flips = 1 << watch.middles.len();
        Self { finder, watch, infinite: Infinite::Watched(met), flips, still: rests }
    }

    /// The account, from the circle that was followed and the inputs of the dead centres that are known, and of singular poses.
    /// `seed` follows the curve through a pose that was found, and gives the inputs of its dead centres if it is new.
    pub fn count(
        &self,
        circle: Circle,
        known: Vec<f64>,
        singular: &[f64],
        seed: &mut dyn FnMut(&Configuration) -> Vec<f64>,
    ) -> Result<Count, Uncounted> {
        if self.still {
            return Err(Uncounted::Still);
        }
        let closure = self.finder.closure(Some(&self.watch));
        let own = self.finder.own();
        let places = circle.count;
        let mut account = Account {
            survey: self,
            closure: &closure,
            known,
            singular,
            located: Vec::new(),
            open: Vec::new(),
            seed,
        };
        let mut followed = Some(circle);
        for (n, &radius) in RADII.iter().enumerate() {
            let pace = if n == 0 { BRISK } else { CAREFUL };
            let circle = followed
                .take()
                .unwrap_or_else(|| self.finder.circle(&closure, radius, places, pace));
            if let Some(poles) = account.balance(&circle, &own) {
                return Ok(Count {
                    column: self.finder.input,
                    dead_centres: account.known.len(),
                    complex_branch_points: account.located.iter().filter(|b| !is_real(b)).count(),
                    poles: poles as usize,
                    open: account.open,
                });
            }
        }
        Err(Uncounted::Lost)
    }
}

/// The chain with the input first, balls as three turns, and no added joints.
fn turned_out(finder: &ModeFinder) -> Chain {
    let mut joints = vec![Joint::Turn];
    let mut links = vec![finder.transforms[0]];
    for (i, unknown) in finder.unknowns.iter().enumerate() {
        let after = finder.transforms[i + 1];
        if matches!(unknown, Unknown::Added) {
            let last = links.len() - 1;
            links[last] = links[last].then(&after);
        } else {
            joints.push(if finder.slides[i] {
                Joint::Slide
            } else {
                Joint::Turn
            });
            links.push(after);
        }
    }
    Chain::new(joints, links)
}

/// The solutions with one unknown at a complex value, as the finder has them, and `e^(i tau)` of its input there.
fn solutions_with(
    chain: &Chain,
    finder: &ModeFinder,
    unknown: usize,
    value: Complex64,
) -> Vec<(Solution, Complex64)> {
    let zeros = finder.zeros();
    let other = ModeFinder::new(chain, unknown + 1);
    let (solutions, shift) = other.solutions_at(value);
    let mut out = Vec::with_capacity(solutions.len());
    'solutions: for solution in solutions {
        let mut values = [Complex64::ONE; 1 + UNKNOWNS];
        values[unknown + 1] = value;
        for (i, kind) in other.unknowns.iter().enumerate() {
            let z = if other.slides[i] {
                solution[i]
            } else {
                solution[i] / shift[i]
            };
            match *kind {
                Unknown::Column(c) => values[c] = z,
                _ if (z - 1.0).norm() > 1e-6 => continue 'solutions,
                _ => {}
            }
        }
        let x = std::array::from_fn(|i| {
            if finder.slides[i] {
                values[i + 1]
            } else {
                values[i + 1] * zeros[i]
            }
        });
        out.push((x, values[0]));
    }
    out
}

fn is_real(b: &Branching) -> bool {
    b.tau.im.abs() < REAL
}

/// Whether an angle lies in a range, whole turns aside.
fn within(angle: f64, from: f64, to: f64) -> bool {
    (angle - from).rem_euclid(TAU) < to - from
}

/// The places of some of the paths; none where one is lost.
fn all(own: &[usize], at: &[Option<Place>]) -> Option<Vec<Place>> {
    own.iter().map(|&path| at[path]).collect()
}

/// The sum of the phases of all places.
fn total<'a>(places: impl IntoIterator<Item = &'a Place>) -> [f64; FACTORS] {
    let mut sum = [0.0; FACTORS];
    for place in places {
        for (s, x) in sum.iter_mut().zip(place.phases().0) {
            *s += x;
        }
    }
    sum
}

fn less(a: [f64; FACTORS], b: [f64; FACTORS]) -> [f64; FACTORS] {
    std::array::from_fn(|k| a[k] - b[k])
}

impl Account<'_> {
    /// The ranges between the borders of a circle, and what is counted in each; none where a solution was lost on the way round.
    fn sectors(&self, circle: &Circle, own: &[usize]) -> Option<Vec<Sector>> {
        let count = circle.count;
        let all = |at: &[Option<Place>]| all(own, at);
        let lost = |at: &Vec<Option<Place>>| own.iter().any(|&path| at[path].is_none());
        if circle.places.iter().any(lost)
            || !self.are_same(&all(&circle.places[0])?, &all(&circle.places[count])?)
        {
            return None;
        }
        let sum = |at: &[Option<Place>]| total(own.iter().filter_map(|&path| at[path].as_ref()));
        let phases: Vec<[f64; FACTORS]> = circle.places.iter().map(|at| sum(at)).collect();
        let spacing = TAU / count as f64;
        let mut borders: Vec<(usize, Border)> = Vec::with_capacity(count + 1);
        for k in 0..count {
            let angle = circle.first + k as f64 * spacing;
            if let Some(ends) = all(&circle.ends[k])
                && self.is_clear(angle, &ends)
            {
                let down = less(total(&ends), phases[k]);
                borders.push((k, Border { angle, height: circle.radius.ln(), down }));
            }
        }
        let mut end = *borders.first()?;
        end.1.angle += TAU;
        borders.push(end);
        let mut sectors = Vec::with_capacity(count);
        for w in borders.windows(2) {
            let ((from, a), (to, b)) = (w[0], w[1]);
            let mut arc = less(phases[to], phases[from]);
            if to <= from {
                let round = less(phases[count], phases[0]);
                arc = std::array::from_fn(|k| arc[k] + round[k]);
            }
            // each lost count is a lost solution
            let numbers = self.numbers(&a, &b, &arc)?;
            sectors.push(Sector { places: [from, to], borders: [a, b], numbers });
        }
        Some(sectors)
    }

    /// Settles all ranges of a circle; gives how many solutions run to infinity within it, or nothing where a solution was lost on
    /// the way round.
    fn balance(&mut self, circle: &Circle, own: &[usize]) -> Option<i64> {
        let sectors = self.sectors(circle, own)?;
        for Sector { places, borders: [a, b], numbers } in &sectors {
            if self.missing(Some(*numbers), a, b) == Some(0) {
                continue;
            }
            let stand = |border: &Border, k: usize| {
                let places = all(own, &circle.places[k])?;
                self.lowered(&Stand { border: *border, places }, LOWERED)
            };
            match (stand(a, places[0]), stand(b, places[1])) {
                (Some(a), Some(b)) => self.settle(&a, &b, 0),
                _ => self.open(a, b, None),
            }
        }
        Some(sectors.iter().map(|s| s.numbers.1).sum())
    }

    /// Whether a border at an angle may be: its real solutions are all apart, and no dead centre is near.
    fn is_clear(&self, angle: f64, ends: &[Place]) -> bool {
        let slides = &self.survey.finder.slides;
        let apart = distinct(slides, ends.iter().map(|p| *p.solution()), SAME_MODE).len() == ends.len();
        apart
            && self.known.iter().all(|&at| {
                let off = (at - angle).rem_euclid(TAU);
                off.min(TAU - off) > CLEAR
            })
    }

    fn are_same(&self, a: &[Place], b: &[Place]) -> bool {
        let slides = &self.survey.finder.slides;
        let count = |places: &mut dyn Iterator<Item = &Place>| {
            distinct(slides, places.map(|p| *p.solution()), SAME_MODE).len()
        };
        [a.len(); 3]
            == [
                count(&mut a.iter()),
                count(&mut b.iter()),
                count(&mut a.iter().chain(b)),
            ]
    }

    /// The same border from nearer to the real inputs.
    fn lowered(&self, stand: &Stand, part: f64) -> Option<Stand> {
        let Border { angle, height, down } = stand.border;
        let places = self
            .closure
            .lowered(&stand.places, angle, (height, part * height))?;
        let gone = less(total(&places), total(&stand.places));
        let border = Border { angle, height: part * height, down: less(down, gone) };
        Some(Stand { border, places })
    }

    /// A border between two at one height.
    fn parted(&self, a: &Stand, b: &Stand) -> Option<Stand> {
        let Border { angle: from, height, .. } = a.border;
        PARTINGS.iter().find_map(|part| {
            let angle = from + part * (b.border.angle - from);
            let places = self.closure.along(&a.places, height, (from, angle))?;
            let ends = self.closure.lowered(&places, angle, (height, 0.0))?;
            let down = less(total(&ends), total(&places));
            self.is_clear(angle, &ends)
                .then_some(Stand { border: Border { angle, height, down }, places })
        })
    }

    /// Zeros less poles of the determinant between two borders, and how many joints are infinite there; none where these are no
    /// whole numbers.
    ///
    /// Source: docs/theory_many.md, (13) and (14).
    fn numbers(&self, a: &Border, b: &Border, arc: &[f64; FACTORS]) -> Option<(i64, i64)> {
        let change: [f64; FACTORS] = std::array::from_fn(|k| arc[k] + b.down[k] - a.down[k]);
        let whole = |x: f64| ((x - x.round()).abs() < WHOLE).then_some(x.round() as i64);
        let inside = |x: &&Complex64| within(x.arg(), a.angle, b.angle) && x.norm().ln().abs() < a.height;
        let zeros = whole(change[0] / PI)?;
        let infinite = match &self.survey.infinite {
            Infinite::At(at) => at.iter().filter(inside).count() as i64,
            Infinite::Watched(met) => {
                let mut sum = 0;
                for (i, met) in met.iter().enumerate() {
                    if self.survey.watch.values[i].is_some() {
                        let winding = whole((change[1 + 2 * i] + change[2 + 2 * i]) / TAU)?;
                        let poles = met.iter().filter(inside).count() as i64 - winding;
                        if poles < 0 {
                            return None;
                        }
                        sum += poles;
                    }
                }
                sum
            }
        };
        Some((zeros, infinite))
    }

    /// How many branch points are counted between two borders and not known.
    fn missing(&self, numbers: Option<(i64, i64)>, a: &Border, b: &Border) -> Option<i64> {
        let (zeros, poles) = numbers?;
        if poles > 0 || zeros % self.survey.flips != 0 {
            return None;
        }
        let between = |at: &f64| within(*at, a.angle, b.angle);
        let known = self.known.iter().filter(|at| between(at)).count() as i64;
        let singular = 2 * self.singular.iter().filter(|at| between(at)).count() as i64;
        let complex = self.located.iter().filter(|b| !is_real(b));
        let complex = complex
            .filter(|p| between(&p.tau.re) && p.tau.im.abs() < a.height)
            .count() as i64;
        Some(zeros / self.survey.flips - known - singular - complex)
    }

    /// Looks for what is missing between two borders, in ever smaller ranges.
    fn settle(&mut self, a: &Stand, b: &Stand, halved: usize) {
        let (from, to) = (&a.border, &b.border);
        let numbers = self
            .closure
            .along(&a.places, from.height, (from.angle, to.angle))
            .filter(|places| self.are_same(places, &b.places))
            .and_then(|places| self.numbers(from, to, &less(total(&places), total(&a.places))));
        if self.missing(numbers, from, to) == Some(0) {
            return;
        }
        let middle = self.parted(a, b);
        if let Some(middle) = &middle {
            self.locate(&[a, middle, b]);
        }
        let missing = self.missing(numbers, from, to);
        if missing == Some(0) {
            return;
        }
        if halved < MOST_HALVINGS
            && let Some(middle) = middle
        {
            let lower = |stand: &Stand| self.lowered(stand, 0.5);
            if let (Some(a), Some(middle), Some(b)) = (lower(a), lower(&middle), lower(b)) {
                self.settle(&a, &middle, halved + 1);
                self.settle(&middle, &b, halved + 1);
                return;
            }
        }
        self.open(from, to, missing);
    }

    fn open(&mut self, a: &Border, b: &Border, missing: Option<i64>) {
        self.open.push(Open { from: a.angle, to: b.angle, missing });
    }

    /// Branch points to which the places at the borders of a range lead; the curves through real ones are followed.
    fn locate(&mut self, borders: &[&Stand]) {
        let finder = self.survey.finder;
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
        for found in branch_points(self.closure, slides, &starts, wanted) {
            let gimbal = |&(i, zero): &(usize, Complex64)| {
                let z = found.at[i] / zero;
                (z + 1.0 / z).norm() < 2.0 * GIMBAL
            };
            let known = |b: &&Branching| {
                let turned = (found.tau - b.tau) / TAU;
                let near = (turned - turned.re.round()).norm() * TAU < SAME_POINT;
                // flips of one pose are one point
                near && (self.survey.flips > 1
                    || distinct(slides, [b.at, found.at].into_iter(), SAME_POINT.sqrt()).len() == 1)
            };
            if self.survey.watch.middles.iter().any(gimbal) || self.located.iter().any(|b| known(&b)) {
                continue;
            }
            self.located.push(found);
            if !is_real(&found) {
                let mirrored = std::array::from_fn(|i| {
                    if slides[i] {
                        found.at[i].conj()
                    } else {
                        1.0 / found.at[i].conj()
                    }
                });
                self.located
                    .push(Branching { tau: found.tau.conj(), at: mirrored });
            } else if let Some(pose) = finder.configuration(&found.at, &finder.zeros(), found.tau.re) {
                let new = (self.seed)(&pose);
                self.known.extend(new);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::modes::random_pose;
    use super::*;
    use crate::rigid::Pose;

    /// What is counted between the places of the first circle.
    fn numbers(finder: &ModeFinder, survey: &Survey) -> Vec<(f64, (i64, i64))> {
        let closure = finder.closure(Some(&survey.watch));
        let circle = finder.circle(&closure, CIRCLE, 24, CAREFUL);
        let account = Account {
            survey,
            closure: &closure,
            known: Vec::new(),
            singular: &[],
            located: Vec::new(),
            open: Vec::new(),
            seed: &mut |_| Vec::new(),
        };
        let sectors = account.sectors(&circle, &finder.own()).unwrap();
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
            let watched = Survey::watching_all(&finder, closed.watch.clone());
            let (a, b) = (numbers(&finder, &closed), numbers(&finder, &watched));
            assert_eq!(a, b);
            seen += a.iter().map(|(_, n)| n.1).sum::<i64>();
        }
        assert!(seen > 10);
    }
}
