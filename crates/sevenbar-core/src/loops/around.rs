//! All complex solutions of one linkage at many values of a turning input.
//!
//! The solutions are analytic in the input's angle `tau`. They are followed once round a circle of complex angles `theta + i h`,
//! beside the real ones, on which pairs of solutions meet; and from places of it straight down to the real values. What was
//! learnt along the circle predicts the first step of the way down. Everything but the input stands still and is real, so a
//! step costs a third of one in [`super::paths`], whose rules of acceptance it shares.
//!
//! Source: docs/theory_many.md, (7) and (8).

use super::lanes::Lanes;
use super::paths::{
    BRISK, CAREFUL, JOINTS, LAST_CORRECTIONS, LAST_SECOND_FAR, LEAST_CONTRACTION, LONGEST_MOVE, Linear, Pace,
    Parameters, SHORTEST_STEP, Slides, Solution, Triple, UNKNOWNS, cosine_sine, cross, infinite, moved, size,
    turn,
};
use super::phases::{FACTORS, PhaseLanes, Phases, Watch};
use crate::vectors::{LANES, LaneKernel, Reals, Vector, dispatch};
use num_complex::Complex64;

/// Most steps on the way to one value; a path that needs more runs into a place where two solutions meet.
const MOST_STEPS: usize = 60;

/// The same where steps are kept short.
const MOST_SHORT_STEPS: usize = 400;

/// First steps along the circle [rad].
const FIRST_STEP: f64 = 0.02;

/// What a solution at the end of a way may be off [rad, or parts of the size] as its last two corrections have it.
const ARRIVED: f64 = 1e-9;

/// A linkage as its closure has it, all constants real: cosines and sines of twists and of given turns, and shifts.
pub(super) struct Around<'a> {
    slides: &'a Slides,
    /// What is watched on all ways, if anything is.
    watch: Option<Watch>,
    twists: [[f64; 2]; JOINTS],
    shifts: [[f64; 3]; JOINTS],
    turns: [[f64; 2]; JOINTS],
}

/// A solution under way, and what its next step is predicted from.
#[derive(Clone, Copy)]
pub(super) struct Place {
    x: Solution,
    /// `e^(i tau)`
    input: Complex64,
    /// d x / d tau here and at the place before, the move between and its `d tau`; zero where there was none.
    rate: Solution,
    rate_before: Solution,
    moved_before: Solution,
    before: Complex64,
    /// Length of the step that is likely to be allowed next.
    step: f64,
    phases: Phases,
}

/// A straight way in `tau`: its direction, its length, and `e^(i tau)` at its end.
#[derive(Clone, Copy)]
struct Way {
    direction: Complex64,
    length: f64,
    end: Complex64,
    /// Whether its end is corrected to rounding.
    settle: bool,
}

/// What was followed round a circle of complex inputs, and from places of it down to the real values beneath.
pub(super) struct Circle {
    /// `|e^(i tau)|` of it.
    pub radius: f64,
    /// The angle of its first place [rad], and how many there are in a turn.
    pub first: f64,
    pub count: usize,
    /// The places of each path, that after the last being the first again, a turn on, and the ends of the ways down; a path that
    /// is lost has none.
    pub places: Vec<Vec<Option<Place>>>,
    pub ends: Vec<Vec<Option<Place>>>,
}

impl<'a> Around<'a> {
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
        let starts: Vec<Place> = solutions.iter().map(|x| Place::begun(x, zero * from)).collect();
        let reached = self.follow(&starts, &[ways.as_slice()], pace);
        let each = ways.len();
        let places = (0..=count)
            .map(|k| {
                (0..solutions.len())
                    .map(|path| reached[path * each + k + 1])
                    .collect()
            })
            .collect();
        let mut circle = Circle { radius, first, count, places, ends: Vec::new() };
        let mut begun = Vec::with_capacity(reached.len());
        let mut owner = Vec::with_capacity(reached.len());
        // value by value, so that neighbours in the lanes are likely to take as long
        for k in 0..count {
            for (path, place) in circle.places[k].iter().enumerate() {
                if let Some(place) = place {
                    begun.push(*place);
                    owner.push((k, path));
                }
            }
        }
        let downward: Vec<Way> = (0..count).map(|k| self.down(at(k), radius.ln(), 0.0)).collect();
        let ways: Vec<&[Way]> = owner
            .iter()
            .map(|&(k, _)| std::slice::from_ref(&downward[k]))
            .collect();
        circle.ends = vec![vec![None; solutions.len()]; count];
        for (end, (k, path)) in self.follow(&begun, &ways, pace).into_iter().zip(owner) {
            circle.ends[k][path] = end;
        }
        circle
    }

    /// Where places above an angle arrive straight below, at a height that is less; both as `ln |e^(i tau)|`.
    pub fn lowered(&self, places: &[Place], angle: f64, (height, to): (f64, f64)) -> Option<Vec<Place>> {
        self.all(places, self.down(angle, height, to))
    }

    /// Where places at a height arrive after an arc from one angle to another.
    pub fn along(&self, places: &[Place], height: f64, (from, to): (f64, f64)) -> Option<Vec<Place>> {
        let way = Way {
            direction: Complex64::ONE,
            length: to - from,
            end: self.zero() * Complex64::from_polar(height.exp(), to),
            settle: true,
        };
        self.all(places, way)
    }

    /// Where all places arrive by a way; in short steps if one is lost in long ones.
    fn all(&self, places: &[Place], way: Way) -> Option<Vec<Place>> {
        let at = |pace| -> Option<Vec<Place>> { self.follow(places, &[&[way]], pace).into_iter().collect() };
        at(BRISK).or_else(|| at(CAREFUL))
    }

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

    /// The places at the end of each way of each start, way by way; `ways` is one list for all, or one for each.
    fn follow(&self, starts: &[Place], ways: &[&[Way]], pace: Pace) -> Vec<Option<Place>> {
        let each = ways.first().map_or(0, |w| w.len());
        let mut ends = vec![None; starts.len() * each];
        if !ends.is_empty() {
            dispatch(Follow { linkage: self, starts, ways, each, pace, ends: &mut ends });
        }
        ends
    }

    /// The closure linearised in the unknowns, with the input's screw for the drift.
    #[inline(always)]
    pub fn linearise<V: Vector>(&self, x: &[Lanes<V>; UNKNOWNS], input: Lanes<V>) -> Linear<V> {
        let (zero, one) = (Lanes::<V>::zero(), Lanes::<V>::one());
        let mut rows = [[zero; UNKNOWNS + 2]; 6];
        let mut ex = [one, zero, zero];
        let mut ey = [zero, one, zero];
        let mut ez = [zero, zero, one];
        let mut place = [zero; 3];
        for i in 0..JOINTS {
            let moment = cross(&place, &ez);
            if i == UNKNOWNS {
                for k in 0..3 {
                    rows[k][UNKNOWNS + 1] = -ez[k];
                    rows[k + 3][UNKNOWNS + 1] = -moment[k];
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
        rows[0][UNKNOWNS] = (ey[2] - ez[1]).scale(half);
        rows[1][UNKNOWNS] = (ez[0] - ex[2]).scale(half);
        rows[2][UNKNOWNS] = (ex[1] - ey[0]).scale(half);
        for k in 0..3 {
            rows[k + 3][UNKNOWNS] = -place[k];
        }
        Linear { rows }
    }
}

/// Up to eight solutions with `e^(i tau)` of their inputs, side by side; a lane without one has the last.
#[inline(always)]
pub(super) fn side_by_side<V: Vector>(at: &[(Solution, Complex64)]) -> ([Lanes<V>; UNKNOWNS], Lanes<V>) {
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

impl Place {
    /// Where a way begins.
    pub fn begun(x: &Solution, input: Complex64) -> Self {
        let zero = [Complex64::ZERO; UNKNOWNS];
        Self {
            x: *x,
            input,
            rate: zero,
            rate_before: zero,
            moved_before: zero,
            before: Complex64::ZERO,
            step: 0.0,
            phases: Phases::NONE,
        }
    }

    pub fn solution(&self) -> &Solution {
        &self.x
    }

    /// The solution's rate with `tau`.
    pub fn rate(&self) -> &Solution {
        &self.rate
    }

    /// Its phases.
    pub fn phases(&self) -> &Phases {
        &self.phases
    }
}

struct Follow<'a> {
    linkage: &'a Around<'a>,
    starts: &'a [Place],
    ways: &'a [&'a [Way]],
    each: usize,
    pace: Pace,
    ends: &'a mut [Option<Place>],
}

/// What the lanes hold between steps.
struct Walk<V> {
    x: [Lanes<V>; UNKNOWNS],
    rate: [Lanes<V>; UNKNOWNS],
    rate_before: [Lanes<V>; UNKNOWNS],
    moved_before: [Lanes<V>; UNKNOWNS],
    input: Lanes<V>,
    before: Lanes<V>,
    phases: PhaseLanes<V>,
    /// Length of the way that is left, and of the step that is likely to be allowed.
    left: Reals,
    step: Reals,
    /// The path in each lane, and its way; past the last path the lane rests.
    path: [usize; LANES],
    way: [usize; LANES],
    count: [usize; LANES],
    settling: [usize; LANES],
}

impl LaneKernel for Follow<'_> {
    #[inline(always)]
    fn run<V: Vector>(mut self) {
        let zero = [Lanes::zero(); UNKNOWNS];
        let mut walk = Walk::<V> {
            x: zero,
            rate: zero,
            rate_before: zero,
            moved_before: zero,
            input: Lanes::one(),
            before: Lanes::zero(),
            phases: PhaseLanes::none(),
            left: [0.0; LANES],
            step: [0.0; LANES],
            path: [usize::MAX; LANES],
            way: [0; LANES],
            count: [0; LANES],
            settling: [0; LANES],
        };
        let mut next = 0;
        self.load(&mut walk, [true; LANES], &mut next);
        while walk.path.iter().any(|&p| p < self.starts.len()) {
            let finished = self.advance(&mut walk);
            if finished.contains(&true) {
                self.load(&mut walk, finished, &mut next);
            }
        }
    }
}

impl Follow<'_> {
    #[inline(always)]
    fn way(&self, path: usize, way: usize) -> Way {
        let ways = if self.ways.len() == 1 {
            self.ways[0]
        } else {
            self.ways[path]
        };
        ways[way]
    }

    /// Puts the next paths into free lanes; a lane without one rests on a copy of the first.
    #[inline(always)]
    fn load<V: Vector>(&self, walk: &mut Walk<V>, free: [bool; LANES], next: &mut usize) {
        for lane in (0..LANES).filter(|&k| free[k]) {
            let more = *next < self.starts.len();
            walk.path[lane] = if more { *next } else { usize::MAX };
            *next += usize::from(more);
            let start = &self.starts[if more { walk.path[lane] } else { 0 }];
            walk.way[lane] = 0;
            walk.count[lane] = 0;
            walk.settling[lane] = 0;
            walk.step[lane] = start.step;
            walk.left[lane] = if more {
                self.way(walk.path[lane], 0).length
            } else {
                0.0
            };
            for i in 0..UNKNOWNS {
                put(&mut walk.x[i], lane, start.x[i]);
                put(&mut walk.rate[i], lane, start.rate[i]);
                put(&mut walk.rate_before[i], lane, start.rate_before[i]);
                put(&mut walk.moved_before[i], lane, start.moved_before[i]);
            }
            put(&mut walk.input, lane, start.input);
            put(&mut walk.before, lane, start.before);
            if let Some(watch) = &self.linkage.watch {
                walk.phases.put(lane, &start.phases, watch);
            }
        }
    }

    /// One step in each lane; tells which lanes are done with their paths.
    #[inline(always)]
    fn advance<V: Vector>(&mut self, walk: &mut Walk<V>) -> [bool; LANES] {
        let count = self.starts.len();
        let mut step = [0.0; LANES];
        let (mut ahead_re, mut ahead_im) = ([0.0; LANES], [0.0; LANES]);
        let (mut end_re, mut end_im, mut ends) = ([1.0; LANES], [0.0; LANES], [0.0; LANES]);
        for k in (0..LANES).filter(|&k| walk.path[k] < count) {
            let way = self.way(walk.path[k], walk.way[k]);
            // equal steps to the end
            let steps = (walk.left[k] / walk.step[k]).ceil();
            step[k] = if walk.step[k] > 0.0 {
                walk.left[k] / steps.max(1.0)
            } else {
                0.0
            };
            ahead_re[k] = step[k] * way.direction.re;
            ahead_im[k] = step[k] * way.direction.im;
            if steps <= 1.0 && walk.step[k] > 0.0 {
                ends[k] = 1.0;
                (end_re[k], end_im[k]) = (way.end.re, way.end.im);
            }
        }
        let (half, zero) = (V::splat(0.5), V::splat(0.0));
        let ahead = Lanes { re: V::load(&ahead_re), im: V::load(&ahead_im) };
        let at_end = V::load(&ends);
        let input = (walk.input * ahead.turn()).replaced_where(at_end, half, Lanes::load(&end_re, &end_im));
        // a cubic through two places and their rates; a straight line on the first step
        let known = walk.before.square();
        let pace = Lanes::zero().replaced_where(known, zero, walk.before.recip());
        let second = ahead * ahead * pace;
        let third = second * (ahead + walk.before) * pace;
        let mut predicted = [Lanes::<V>::zero(); UNKNOWNS];
        for i in 0..UNKNOWNS {
            let (rate, rate_before) = (walk.rate[i], walk.rate_before[i]);
            let mean = walk.moved_before[i] * pace;
            predicted[i] = (rate * ahead)
                .plus_product(rate - mean, second)
                .plus_product(rate + rate_before - mean - mean, third);
        }
        let slides = self.linkage.slides;
        let reach = size(slides, &walk.x, &predicted);
        let x1 = moved(slides, &walk.x, &predicted);
        let (first_correction, ..) = self.linkage.linearise(&x1, input).solve();
        let first = size(slides, &x1, &first_correction);
        let x2 = moved(slides, &x1, &first_correction);
        let (second_correction, rate, determinant) = self.linkage.linearise(&x2, input).solve();
        let last = size(slides, &x2, &second_correction);
        let x3 = moved(slides, &x2, &second_correction);
        let (mut factors, mut steady) = ([Lanes::<V>::zero(); FACTORS], [0.0; LANES]);
        if let Some(watch) = &self.linkage.watch {
            factors = watch.factors(slides, &x2, determinant);
            steady = walk.phases.steady(&factors, watch);
        }

        let mut accepted = [0.0; LANES];
        for k in 0..LANES {
            let good = reach[k] <= LONGEST_MOVE
                && first[k] <= self.pace.largest
                && last[k] <= self.pace.second
                && last[k] <= (LEAST_CONTRACTION * first[k]).max(LAST_SECOND_FAR)
                && steady[k] >= 0.0;
            accepted[k] = f64::from(u8::from(good));
            walk.count[k] += 1;
            let room = LONGEST_MOVE * 0.8 / reach[k].max(1e-3);
            if !good {
                walk.step[k] = step[k] * room.clamp(0.1, 0.5);
                continue;
            }
            walk.left[k] = if ends[k] > 0.0 {
                0.0
            } else {
                walk.left[k] - step[k]
            };
            let factor = (self.pace.aimed / first[k].max(1e-9))
                .sqrt()
                .sqrt()
                .clamp(0.5, 2.0);
            walk.step[k] = if step[k] > 0.0 {
                step[k] * factor.min(room)
            } else {
                walk.step[k].max(FIRST_STEP)
            };
        }
        let taken = V::load(&accepted);
        let mut gone = [0.0; LANES];
        for k in 0..LANES {
            gone[k] = accepted[k] * step[k];
        }
        let gone = V::load(&gone);
        walk.input = walk.input.replaced_where(taken, half, input);
        if let Some(watch) = &self.linkage.watch {
            walk.phases.go_on(&factors, taken, watch);
        }
        walk.before = walk.before.replaced_where(gone, zero, ahead);
        for i in 0..UNKNOWNS {
            let by = predicted[i] + first_correction[i] + second_correction[i];
            walk.rate_before[i] = walk.rate_before[i].replaced_where(gone, zero, walk.rate[i]);
            walk.moved_before[i] = walk.moved_before[i].replaced_where(gone, zero, by);
            walk.rate[i] = walk.rate[i].replaced_where(taken, half, rate[i]);
            walk.x[i] = walk.x[i].replaced_where(taken, half, x3[i]);
        }
        self.finished(walk, &accepted, (&first, &last))
    }

    /// Records the ends of ways; tells which lanes are done with their paths or have lost them.
    #[inline(always)]
    fn finished<V: Vector>(
        &mut self,
        walk: &mut Walk<V>,
        accepted: &Reals,
        (first, last): (&Reals, &Reals),
    ) -> [bool; LANES] {
        let infinite = infinite(self.linkage.slides, &walk.x);
        let most_steps = if self.pace.aimed < BRISK.aimed {
            MOST_SHORT_STEPS
        } else {
            MOST_STEPS
        };
        let mut done = [false; LANES];
        for k in 0..LANES {
            if walk.path[k] >= self.starts.len() {
                walk.step[k] = 0.0;
                continue;
            }
            let at_end = accepted[k] > 0.0 && walk.left[k] <= 0.0;
            walk.settling[k] += usize::from(at_end);
            // Newton's corrections square: the third from the first two
            let ratio = last[k] / first[k].max(f64::MIN_POSITIVE);
            let off = last[k] * ratio * ratio;
            let settled = !self.way(walk.path[k], walk.way[k]).settle
                || (off <= ARRIVED && ratio <= LEAST_CONTRACTION)
                || last[k] <= ARRIVED
                || (walk.settling[k] > LAST_CORRECTIONS && last[k] <= LAST_SECOND_FAR);
            let stuck = (accepted[k] == 0.0 && walk.step[k] < SHORTEST_STEP) || walk.count[k] > most_steps;
            if at_end && settled {
                let mut end = walk.place(k);
                if let Some(watch) = &self.linkage.watch {
                    end.phases = walk.phases.get(k, watch);
                }
                self.ends[walk.path[k] * self.each + walk.way[k]] = Some(end);
                walk.way[k] += 1;
                walk.count[k] = 0;
                walk.settling[k] = 0;
                done[k] = walk.way[k] == self.each;
                if !done[k] {
                    walk.left[k] = self.way(walk.path[k], walk.way[k]).length;
                }
            } else {
                done[k] = infinite[k] || stuck;
            }
        }
        done
    }
}

impl<V: Vector> Walk<V> {
    /// The place of a lane.
    #[inline(always)]
    fn place(&self, lane: usize) -> Place {
        let mut out = Place::begun(&[Complex64::ZERO; UNKNOWNS], get(self.input, lane));
        for i in 0..UNKNOWNS {
            out.x[i] = get(self.x[i], lane);
            out.rate[i] = get(self.rate[i], lane);
            out.rate_before[i] = get(self.rate_before[i], lane);
            out.moved_before[i] = get(self.moved_before[i], lane);
        }
        out.before = get(self.before, lane);
        out.step = self.step[lane];
        out
    }
}

#[inline(always)]
fn get<V: Vector>(lanes: Lanes<V>, lane: usize) -> Complex64 {
    Complex64::new(lanes.re.store()[lane], lanes.im.store()[lane])
}

#[inline(always)]
fn put<V: Vector>(lanes: &mut Lanes<V>, lane: usize, value: Complex64) {
    let (mut re, mut im) = (lanes.re.store(), lanes.im.store());
    (re[lane], im[lane]) = (value.re, value.im);
    *lanes = Lanes::load(&re, &im);
}
