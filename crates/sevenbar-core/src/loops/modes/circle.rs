//! All complex solutions of one linkage at many values of a turning input.
//!
//! The solutions are analytic in the input's angle `tau`. Pairs of them meet at real angles, so they are followed once round a circle of
//! complex angles `theta + i h` next to the real ones, and from places of it straight down to the real values. The first step of a way
//! down is predicted from the circle. All other parameters are real and constant, so a step costs a third of one between any two closures.
//!
//! Source: docs/theory_many.md, (7) and (8).

use super::continuation::{BRISK, CAREFUL, Homotopy, LEAST_CONTRACTION, Pace, Place, Way, follow};
use super::phases::Watch;
use crate::loops::equation::closure::{
    JOINTS, Linear, Parameters, Slides, Solution, Triple, UNKNOWNS, cosine_sine, cross, turn,
};
use crate::loops::equation::lanes::Lanes;
use crate::vectors::{LANES, Reals, Vector};
use num_complex::Complex64;

/// Most steps on the way to one value; a path that needs more runs into a place where two solutions meet.
const MOST_STEPS: usize = 60;

/// The same at a careful pace.
const MOST_SHORT_STEPS: usize = 400;

/// Greatest error of a solution at the end of a way [rad, or relative to the size], estimated from its last two corrections.
const ARRIVED: f64 = 1e-9;

/// The real constants of a linkage's closure: cosines and sines of twists and of fixed turns, and shifts.
pub(crate) struct InputClosure<'a> {
    slides: &'a Slides,
    /// Whose phases are summed along all ways, if any are.
    watch: Option<Watch>,
    twists: [[f64; 2]; JOINTS],
    shifts: [[f64; 3]; JOINTS],
    turns: [[f64; 2]; JOINTS],
}

/// Solutions followed round a circle of complex inputs, and from places of it down to the real values below.
pub(crate) struct Circle {
    /// Its radius `|e^(i tau)|`.
    pub radius: f64,
    /// The angle of its first place [rad], and how many there are in a turn.
    pub first: f64,
    pub count: usize,
    /// For each place of the circle the solutions on all paths, `None` for a lost path. The last place is the first one after a turn.
    pub places: Vec<Vec<Option<Place>>>,
    /// The same at the end of the way down from each place.
    pub ends: Vec<Vec<Option<Place>>>,
}

impl<'a> InputClosure<'a> {
    /// From the closure's parameters at the input zero.
    pub fn new(slides: &'a Slides, parameters: &Parameters, watch: Option<Watch>) -> Self {
        let pair = |z: Complex64| [z.re, z.im];
        Self {
            slides,
            watch,
            twists: parameters.twists.map(pair),
            shifts: parameters.shifts.map(|s| s.map(|x| x.re)),
            turns: parameters.turns.map(pair),
        }
    }

    /// Follows solutions at a complex input to a circle of this radius, once round it, and from `count` places of it straight down to
    /// the real values `2 pi k / count`.
    pub fn circle(
        &self,
        from: Complex64,
        solutions: &[Solution],
        (radius, count): (f64, usize),
        pace: Pace,
    ) -> Circle {
        let spacing = std::f64::consts::TAU / count as f64;
        let zero = self.zero();
        let first = (from.arg() / spacing).ceil() * spacing;
        let at = |k: usize| first + k as f64 * spacing;
        let inward = (from.norm() / radius).ln();
        let mut ways = vec![Way {
            direction: Complex64::I * inward.signum(),
            length: inward.abs(),
            end: zero * Complex64::from_polar(radius, from.arg()),
            settle: false,
        }];
        // the first place once more at the end
        ways.extend((0..=count).map(|k| Way {
            direction: Complex64::ONE,
            length: at(k) - if k == 0 { from.arg() } else { at(k - 1) },
            end: zero * Complex64::from_polar(radius, at(k)),
            settle: k == 0 || k == count,
        }));
        let starts: Vec<Place> = solutions.iter().map(|x| Place::start(x, zero * from)).collect();
        let reached = follow(self, &starts, &[ways.as_slice()], pace);
        let each = ways.len();
        let places = (0..=count)
            .map(|k| {
                (0..solutions.len())
                    .map(|path| reached[path * each + k + 1])
                    .collect()
            })
            .collect();
        let mut circle = Circle { radius, first, count, places, ends: Vec::new() };
        let mut starts = Vec::with_capacity(reached.len());
        // of each start, which place of the circle it is and on which path
        let mut indices = Vec::with_capacity(reached.len());
        // value by value, so that neighbours in the lanes are likely to take as long
        for k in 0..count {
            for (path, place) in circle.places[k].iter().enumerate() {
                if let Some(place) = place {
                    starts.push(*place);
                    indices.push((k, path));
                }
            }
        }
        let downward: Vec<Way> = (0..count).map(|k| self.down(at(k), radius.ln(), 0.0)).collect();
        let ways: Vec<&[Way]> = indices
            .iter()
            .map(|&(k, _)| std::slice::from_ref(&downward[k]))
            .collect();
        circle.ends = vec![vec![None; solutions.len()]; count];
        for (end, (k, path)) in follow(self, &starts, &ways, pace).into_iter().zip(indices) {
            circle.ends[k][path] = end;
        }
        circle
    }

    /// Where places above an angle arrive straight below, at a height that is less; both as `ln |e^(i tau)|`.
    pub fn lowered(&self, places: &[Place], angle: f64, (height, to): (f64, f64)) -> Option<Vec<Place>> {
        self.arrivals(places, self.down(angle, height, to))
    }

    /// Where places at a height arrive after an arc from one angle to another.
    pub fn along(&self, places: &[Place], height: f64, (from, to): (f64, f64)) -> Option<Vec<Place>> {
        let way = Way {
            direction: Complex64::ONE,
            length: to - from,
            end: self.zero() * Complex64::from_polar(height.exp(), to),
            settle: true,
        };
        self.arrivals(places, way)
    }

    /// Where all places arrive by a way; in short steps if one is lost in long ones.
    fn arrivals(&self, places: &[Place], way: Way) -> Option<Vec<Place>> {
        let at = |pace| -> Option<Vec<Place>> { follow(self, places, &[&[way]], pace).into_iter().collect() };
        at(BRISK).or_else(|| at(CAREFUL))
    }

    /// The way at an angle from a height straight to another, both as `ln |e^(i tau)|`.
    fn down(&self, angle: f64, height: f64, to: f64) -> Way {
        Way {
            direction: Complex64::I * (height - to).signum(),
            length: (height - to).abs(),
            end: self.zero() * Complex64::from_polar(to.exp(), angle),
            settle: true,
        }
    }

    /// The same with links that have no length.
    pub fn without_lengths(&self) -> Self {
        Self { shifts: [[0.0; 3]; JOINTS], watch: None, ..*self }
    }

    /// `e^(i t)` of the given turn of the last joint at the input's zero.
    pub fn zero(&self) -> Complex64 {
        Complex64::new(self.turns[UNKNOWNS][0], self.turns[UNKNOWNS][1])
    }
}

impl Homotopy for InputClosure<'_> {
    #[inline(always)]
    fn slides(&self) -> &Slides {
        self.slides
    }

    #[inline(always)]
    fn watch(&self) -> Option<&Watch> {
        self.watch.as_ref()
    }

    fn most_steps(&self, pace: Pace) -> usize {
        if pace.aimed < BRISK.aimed {
            MOST_SHORT_STEPS
        } else {
            MOST_STEPS
        }
    }

    #[inline(always)]
    fn settled(&self, first: f64, second: f64) -> bool {
        // Newton's corrections square: the third from the first two
        let ratio = second / first.max(f64::MIN_POSITIVE);
        let third = second * ratio * ratio;
        (third <= ARRIVED && ratio <= LEAST_CONTRACTION) || second <= ARRIVED
    }

    /// The parameter is `e^(i tau)`, a step one of `tau`.
    #[inline(always)]
    fn ahead<V: Vector>(&self, at: Lanes<V>, by: Lanes<V>) -> Lanes<V> {
        at * by.turn()
    }

    /// With the input's screw for the drift, which costs next to nothing.
    #[inline(always)]
    fn linearise<V: Vector, const DRIFT: bool>(
        &self,
        x: &[Lanes<V>; UNKNOWNS],
        input: Lanes<V>,
    ) -> Linear<V> {
        let (zero, one) = (Lanes::<V>::zero(), Lanes::<V>::one());
        let mut rows = [[zero; UNKNOWNS]; UNKNOWNS];
        let (mut error, mut drift) = ([zero; UNKNOWNS], [zero; UNKNOWNS]);
        let mut ex = [one, zero, zero];
        let mut ey = [zero, one, zero];
        let mut ez = [zero, zero, one];
        let mut place = [zero; 3];
        for i in 0..JOINTS {
            let moment = cross(&place, &ez);
            if i == UNKNOWNS {
                for k in 0..3 {
                    drift[k] = -ez[k];
                    drift[k + 3] = -moment[k];
                }
                let (cosine, sine, _) = cosine_sine(input);
                turn(&mut ex, &mut ey, cosine, sine);
            } else if self.slides[i] {
                for k in 0..3 {
                    rows[k + 3][i] = ez[k];
                    place[k] = place[k].plus_product(ez[k], x[i]);
                }
                turn_real(&mut ex, &mut ey, self.turns[i]);
            } else {
                for k in 0..3 {
                    rows[k][i] = ez[k];
                    rows[k + 3][i] = moment[k];
                }
                let (cosine, sine, _) = cosine_sine(x[i]);
                turn(&mut ex, &mut ey, cosine, sine);
            }
            let [a, b, c] = self.shifts[i];
            let (a, b, c) = (V::splat(a), V::splat(b), V::splat(c));
            for k in 0..3 {
                place[k] = place[k]
                    .plus_scaled(ex[k], a)
                    .plus_scaled(ey[k], b)
                    .plus_scaled(ez[k], c);
            }
            turn_real(&mut ey, &mut ez, self.twists[i]);
        }
        let half = V::splat(-0.5);
        error[0] = (ey[2] - ez[1]).scale(half);
        error[1] = (ez[0] - ex[2]).scale(half);
        error[2] = (ex[1] - ey[0]).scale(half);
        for k in 0..3 {
            error[k + 3] = -place[k];
        }
        Linear { rows, error, drift }
    }
}

/// Up to eight solutions with `e^(i tau)` of their inputs, side by side; a lane without one has the last.
#[inline(always)]
pub(crate) fn side_by_side<V: Vector>(at: &[(Solution, Complex64)]) -> ([Lanes<V>; UNKNOWNS], Lanes<V>) {
    let lanes = |pick: &dyn Fn(&(Solution, Complex64)) -> Complex64| {
        let (mut re, mut im): (Reals, Reals) = ([0.0; LANES], [0.0; LANES]);
        for k in 0..LANES {
            let z = pick(&at[k.min(at.len() - 1)]);
            (re[k], im[k]) = (z.re, z.im);
        }
        Lanes::<V>::load(&re, &im)
    };
    (std::array::from_fn(|i| lanes(&|at| at.0[i])), lanes(&|at| at.1))
}

/// Turns the frame's axes `a`, `b` by the angle whose cosine and sine are given.
#[inline(always)]
fn turn_real<V: Vector>(a: &mut Triple<V>, b: &mut Triple<V>, [cosine, sine]: [f64; 2]) {
    let (c, s, minus) = (V::splat(cosine), V::splat(sine), V::splat(-sine));
    for k in 0..3 {
        let (x, y) = (a[k], b[k]);
        a[k] = x.scale(c).plus_scaled(y, s);
        b[k] = y.scale(c).plus_scaled(x, minus);
    }
}
