//! What the phases of followed solutions count between two inputs: branch points, and joints that become infinite.
//!
//! Source: docs/theory_many.md, (13), (14) and (20).

use super::locating::Branching;
use super::survey::{Infinite, Survey};
use crate::loops::equation::closure::{Slides, Solution, UNKNOWNS};
use crate::loops::modes::circle::{Circle, InputClosure};
use crate::loops::modes::continuation::Place;
use crate::loops::modes::many_starts::SAME_MODE;
use crate::loops::modes::phases::FACTORS;
use crate::loops::modes::starts::distinct;
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};

/// What a count may be off a whole number before something was lost on the way.
const WHOLE: f64 = 0.02;

/// A solution is the same as another if it is nearer to it than this part of the distance to the next.
const NEARER: f64 = 0.1;

/// Where a range is parted, as parts of it, if a dead centre is in the way.
const PARTINGS: [f64; 4] = [0.5, 0.43, 0.59, 0.36];

/// No border stands nearer to a dead centre than this [rad].
pub(super) const CLEAR: f64 = 1e-8;

/// Inputs of the zeros of the determinant that are known [rad].
#[derive(Clone, Debug, Default)]
pub(crate) struct Known {
    /// Dead centres of all curves.
    pub dead_centres: Vec<f64>,
    /// Where a curve meets one that only the filled-up closure has.
    pub meetings: Vec<f64>,
    /// Poses at which curves are not smooth: two zeros each.
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

/// A way down to a real input: where it begins, and the change of the phases on it.
#[derive(Clone, Copy)]
pub(super) struct Border {
    pub angle: f64,
    pub height: f64,
    pub down: [f64; FACTORS],
}

/// The range between two borders of a circle, the places at which they stand, and its zeros less poles and infinite joints.
pub(super) struct Sector {
    pub places: [usize; 2],
    pub borders: [Border; 2],
    pub numbers: (i64, i64),
}

/// A border with the places at its top.
pub(super) struct Stand {
    pub border: Border,
    pub places: Vec<Place>,
}

/// The zeros between borders, counted by the change of phases on the way round them.
pub(super) struct Winding<'a> {
    pub survey: &'a Survey<'a>,
    pub closure: &'a InputClosure<'a>,
}

impl Winding<'_> {
    /// The ranges between the borders of a circle, and what is counted in each; none where a solution was lost on the way round.
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
            // each lost count is a lost solution
            let numbers = self.numbers(&a, &b, &arc)?;
            sectors.push(Sector { places: [from, to], borders: [a, b], numbers });
        }
        Some(sectors)
    }

    /// Whether a border at an angle may be: its real solutions are all apart, and no dead centre is near.
    fn is_clear(&self, known: &Known, angle: f64, ends: &[Place]) -> bool {
        let slides = &self.survey.finder.slides;
        let all_apart = distinct(slides, ends.iter().map(|p| *p.solution()), SAME_MODE).len() == ends.len();
        all_apart
            && known
                .simple()
                .copied()
                .chain(self.survey.afar.iter().map(|a| a.input))
                .all(|at| apart(at, angle) > CLEAR)
    }

    /// Whether two lists hold the same solutions: each has one in the other that is far nearer than all others, and no two have one.
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

    /// The same border from nearer to the real inputs.
    pub fn lowered(&self, stand: &Stand, part: f64) -> Option<Stand> {
        let Border { angle, height, down } = stand.border;
        let places = self
            .closure
            .lowered(&stand.places, angle, (height, part * height))?;
        let gone = less(total(&places), total(&stand.places));
        let border = Border { angle, height: part * height, down: less(down, gone) };
        Some(Stand { border, places })
    }

    /// A border between two at one height.
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

    /// Zeros less poles of the determinant between two borders, and how many joints are infinite there; none where these are no
    /// whole numbers.
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
        // slides infinite at a real input are known
        let afar = self
            .survey
            .afar
            .iter()
            .filter(|at| within(at.input, a.angle, b.angle));
        let (order, slides) = afar.fold((0, 0), |sum, at| (sum.0 + at.order, sum.1 + at.slides));
        (infinite >= slides).then_some((zeros - order, infinite - slides))
    }
}

/// Whether an angle lies in a range, whole turns aside.
pub(super) fn within(angle: f64, from: f64, to: f64) -> bool {
    (angle - from).rem_euclid(TAU) < to - from
}

/// How far two angles are apart [rad], whole turns aside.
pub(super) fn apart(a: f64, b: f64) -> f64 {
    let off = (a - b).rem_euclid(TAU);
    off.min(TAU - off)
}

/// The square of how far two solutions are apart [parts of their values, or of the size].
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

/// The places of some of the paths; none where one is lost.
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
