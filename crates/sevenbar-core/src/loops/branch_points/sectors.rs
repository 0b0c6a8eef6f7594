//! Counting between two inputs, by the phases of followed solutions: branch points, and poses with a joint at infinity.
//!
//! Source: docs/theory_many.md, (13), (14) and (20).

use super::locating::Branching;
use super::survey::{Infinite, Survey};
use crate::loops::equation::closure::{Slides, Solution, UNKNOWNS};
use crate::loops::equation::rotations::short_way;
use crate::loops::modes::circle::{Circle, InputClosure};
use crate::loops::modes::continuation::Place;
use crate::loops::modes::many_starts::SAME_MODE;
use crate::loops::modes::phases::FACTORS;
use crate::loops::modes::starts::distinct;
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};

/// Greatest distance of a count from a whole number; a greater one shows that a solution was lost on the way.
const WHOLE: f64 = 0.02;

/// Two solutions are the same if their distance is less than this part of the distance to the next nearest.
const NEARER: f64 = 0.1;

/// Where a range is divided, as parts of it: the first of these with no dead centre near.
const PARTINGS: [f64; 4] = [0.5, 0.43, 0.59, 0.36];

/// Least distance of a border from a dead centre [rad].
pub(super) const CLEAR: f64 = 1e-8;

/// The same from a singular pose, whose input is known to the root of rounding only.
const CLEAR_OF_SINGULAR: f64 = 1e-6;

/// Inputs of the zeros of the determinant that are known [rad].
#[derive(Clone, Debug, Default)]
pub(crate) struct Known {
    /// Dead centres of all curves.
    pub dead_centres: Vec<f64>,
    /// Where a curve meets one that exists only in the closure with added joints.
    pub meetings: Vec<f64>,
    /// Change points and isolated poses, each as often as it has zeros.
    pub singular: Vec<f64>,
}

/// Whether a complex branch point is so near to a way down at an angle that this passes it on either side.
pub(super) fn is_on_way(located: &[Branching], angle: f64) -> bool {
    located.iter().any(|b| !b.real && apart(b.tau.re, angle) < CLEAR)
}

impl Known {
    /// The simple zeros.
    pub fn simple(&self) -> impl Iterator<Item = &f64> {
        self.dead_centres.iter().chain(&self.meetings)
    }
}

/// A way from a circle down to the real input at an angle: from which height `ln |e^(i tau)|`, and the change of all phases on it.
#[derive(Clone, Copy)]
pub(super) struct Border {
    pub angle: f64,
    pub height: f64,
    pub down: [f64; FACTORS],
}

/// The range between two borders of a circle: the places of the circle above them, and two counts: zeros minus poles of the determinant,
/// and poses with a joint at infinity.
pub(super) struct Sector {
    pub places: [usize; 2],
    pub borders: [Border; 2],
    pub numbers: (i64, i64),
}

/// A border with the solutions at its top.
pub(super) struct Stand {
    pub border: Border,
    pub places: Vec<Place>,
}

/// Counts the zeros between borders by the change of phases on the way round them (the argument principle).
pub(super) struct Winding<'a> {
    pub survey: &'a Survey<'a>,
    pub closure: &'a InputClosure<'a>,
}

impl Winding<'_> {
    /// The ranges between the borders of a circle, and the counts in each; `None` if a solution was lost on the way round.
    ///
    /// `own` are the paths of the circle that belong to this closure, `located` the complex branch points that are known.
    pub fn sectors(
        &self,
        known: &Known,
        located: &[Branching],
        circle: &Circle,
        own: &[usize],
    ) -> Option<Vec<Sector>> {
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
                && self.is_clear(known, angle, &ends)
                && !is_on_way(located, angle)
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
            // a count that is no whole number means a lost solution
            let numbers = self.numbers(&a, &b, &arc)?;
            sectors.push(Sector { places: [from, to], borders: [a, b], numbers });
        }
        Some(sectors)
    }

    /// Whether an angle can have a border: its real solutions are all distinct, and no dead centre or singular pose is near.
    fn is_clear(&self, known: &Known, angle: f64, ends: &[Place]) -> bool {
        let slides = &self.survey.finder.slides;
        let all_apart = distinct(slides, ends.iter().map(|p| *p.solution()), SAME_MODE).len() == ends.len();
        all_apart
            && known
                .simple()
                .copied()
                .chain(self.survey.afar.iter().map(|a| a.input))
                .all(|at| apart(at, angle) > CLEAR)
            && known
                .singular
                .iter()
                .all(|at| apart(*at, angle) > CLEAR_OF_SINGULAR)
    }

    /// Whether two lists hold the same solutions: each one has a partner in the other list, far nearer than all others and its own.
    pub fn are_same(&self, a: &[Place], b: &[Place]) -> bool {
        let slides = &self.survey.finder.slides;
        let mut taken = vec![false; b.len()];
        a.iter().all(|a| {
            let (mut nearest, mut least, mut next) = (0, f64::INFINITY, f64::INFINITY);
            for (k, b) in b.iter().enumerate() {
                let off = square_apart(slides, a.solution(), b.solution());
                if off < least {
                    (nearest, least, next) = (k, off, least);
                } else {
                    next = next.min(off);
                }
            }
            least < NEARER * NEARER * next && !std::mem::replace(&mut taken[nearest], true)
        })
    }

    /// The same border begun nearer to the real inputs, at this part of its height.
    pub fn lowered(&self, stand: &Stand, part: f64) -> Option<Stand> {
        let Border { angle, height, down } = stand.border;
        let places = self
            .closure
            .lowered(&stand.places, angle, (height, part * height))?;
        let gone = less(total(&places), total(&stand.places));
        let border = Border { angle, height: part * height, down: less(down, gone) };
        Some(Stand { border, places })
    }

    /// A border between two others of the same height.
    pub fn parted(&self, known: &Known, a: &Stand, b: &Stand) -> Option<Stand> {
        let Border { angle: from, height, .. } = a.border;
        PARTINGS.iter().find_map(|part| {
            let angle = from + part * (b.border.angle - from);
            let places = self.closure.along(&a.places, height, (from, angle))?;
            let ends = self.closure.lowered(&places, angle, (height, 0.0))?;
            let down = less(total(&ends), total(&places));
            self.is_clear(known, angle, &ends)
                .then_some(Stand { border: Border { angle, height, down }, places })
        })
    }

    /// Zeros minus poles of the determinant between two borders, and how many poses have a joint at infinity there; `None` if these are
    /// no whole numbers.
    ///
    /// Source: docs/theory_many.md, (13) and (14).
    pub fn numbers(&self, a: &Border, b: &Border, arc: &[f64; FACTORS]) -> Option<(i64, i64)> {
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
        // slides at infinity at a real input have been found apart
        let afar = self
            .survey
            .afar
            .iter()
            .filter(|at| within(at.input, a.angle, b.angle));
        let (order, slides) = afar.fold((0, 0), |sum, at| (sum.0 + at.order, sum.1 + at.slides));
        (infinite >= slides).then_some((zeros - order, infinite - slides))
    }
}

/// Whether an angle lies in a range, modulo whole turns.
pub(super) fn within(angle: f64, from: f64, to: f64) -> bool {
    (angle - from).rem_euclid(TAU) < to - from
}

/// Distance of two angles [rad], modulo whole turns.
pub(super) fn apart(a: f64, b: f64) -> f64 {
    short_way(a - b).abs()
}

/// Square of the distance of two solutions, the greatest of all unknowns' [relative to their values].
fn square_apart(slides: &Slides, a: &Solution, b: &Solution) -> f64 {
    let off = |i: usize| {
        let square = (a[i] - b[i]).norm_sqr();
        if slides[i] {
            square / (1.0 + a[i].norm_sqr())
        } else {
            square / b[i].norm_sqr()
        }
    };
    (0..UNKNOWNS).map(off).fold(0.0, f64::max)
}

/// The places of these paths; `None` if one is lost.
pub(super) fn all(own: &[usize], at: &[Option<Place>]) -> Option<Vec<Place>> {
    own.iter().map(|&path| at[path]).collect()
}

/// The sum of the phases of all places.
pub(super) fn total<'a>(places: impl IntoIterator<Item = &'a Place>) -> [f64; FACTORS] {
    let mut sum = [0.0; FACTORS];
    for place in places {
        for (s, x) in sum.iter_mut().zip(place.phases().0) {
            *s += x;
        }
    }
    sum
}

pub(super) fn less(a: [f64; FACTORS], b: [f64; FACTORS]) -> [f64; FACTORS] {
    std::array::from_fn(|k| a[k] - b[k])
}
