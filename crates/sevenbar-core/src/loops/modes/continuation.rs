//! Following complex solutions of the closure while a parameter moves: one predictor and corrector, eight paths side by side.
//!
//! A step is predicted by a cubic through the last two places and their rates, and corrected twice by Newton's method. It is accepted
//! if both corrections are small and the second is far smaller than the first, so that one path is not mistaken for another.
//!
//! Source: docs/theory.md, (6); docs/theory_many.md, (7) and (8).

use super::phases::{FACTORS, PhaseLanes, Phases, Watch};
use crate::loops::equation::closure::{Linear, Slides, Solution, UNKNOWNS, infinite, moved, size};
use crate::loops::equation::lanes::Lanes;
use crate::stopping;
use crate::vectors::{LANES, LaneKernel, Plain, Reals, Vector, dispatch};
use num_complex::Complex64;
use std::array::from_fn;

/// The limits that set the length of steps.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pace {
    /// First correction that steps aim at, and the greatest accepted [rad, or relative to the size].
    pub aimed: f64,
    pub largest: f64,
    /// Greatest accepted second correction; the next would be about its square.
    pub second: f64,
}

/// For paths that stay well apart, as between general parameters.
pub(crate) const BRISK: Pace = Pace { aimed: 1e-2, largest: 8e-2, second: 2e-3 };

/// For paths that come near each other, as at the end of a path near a dead centre.
pub(crate) const CAREFUL: Pace = Pace { aimed: 1e-4, largest: 1e-3, second: 1e-5 };

/// Greatest accepted ratio of the second correction to the first.
pub(super) const LEAST_CONTRACTION: f64 = 0.1;

/// Most steps on one path; the longest of 10^5 random paths that arrive took 300.
const MOST_STEPS: usize = 800;

/// Second correction at the end of a path, where the next would be rounding.
const LAST_SECOND: f64 = 1e-8;

/// A closure is known to this times one to six [rad, or relative to the size]. Added to it, so that paths seldom arrive at a solution that
/// does not stand alone: where numbers are exact, as in special geometry, nothing else would move one along its continuum.
pub(crate) const ROUNDING: f64 = 2e-16;

/// Second correction that is accepted for far solutions, `e^(i t)` in the hundreds, where rounding is greater in proportion; at the end
/// of a way only after this many corrections.
const LAST_SECOND_FAR: f64 = 3e-5;
const LAST_CORRECTIONS: usize = 4;

/// Longest predicted move of all joints together [rad]; the next step aims at this part of it.
const LONGEST_MOVE: f64 = 1.0;
const AIMED_MOVE: f64 = 0.8 * LONGEST_MOVE;

/// Factors by which a step may change: after one that was rejected, and after one that was accepted.
const SHORTER: (f64, f64) = (0.1, 0.5);
const CHANGED: (f64, f64) = (0.5, 2.0);

/// Moves and first corrections below these are no measure of the next step [rad, or relative to the size].
const LEAST_MOVE: f64 = 1e-3;
const LEAST_CORRECTION: f64 = 1e-9;

/// Length of the first step [in the parameter].
pub(crate) const FIRST_STEP: f64 = 0.02;

/// A path ends where its steps become shorter than this [in the parameter]: it runs to infinity or into a singular solution.
const SHORTEST_STEP: f64 = 1e-9;

/// A closure whose parameter moves.
pub(crate) trait Homotopy<const N: usize = UNKNOWNS> {
    /// Which joints slide.
    fn slides(&self) -> &Slides<N>;
    /// Whose phases are summed along all ways, if any are.
    #[inline(always)]
    fn watch(&self) -> Option<&Watch> {
        None
    }
    /// Most steps on one way.
    fn most_steps(&self, _pace: Pace) -> usize {
        MOST_STEPS
    }
    /// Whether the end of a way is accurate enough after corrections of these sizes [rad, or relative to the size].
    #[inline(always)]
    fn settled(&self, _first: f64, second: f64) -> bool {
        second <= LAST_SECOND
    }
    /// The parameter after a step of `by` along a way.
    #[inline(always)]
    fn ahead<V: Vector>(&self, at: Lanes<V>, by: Lanes<V>) -> Lanes<V> {
        at + by
    }
    /// The closure linearised in the unknowns; its derivative by the parameter only if `DRIFT`.
    fn linearise<V: Vector, const DRIFT: bool>(&self, x: &[Lanes<V>; N], at: Lanes<V>) -> Linear<V, N>;
}

/// A solution under way, and what its next step is predicted from.
#[derive(Clone, Copy)]
pub(crate) struct Place<const N: usize = UNKNOWNS> {
    x: Solution<N>,
    /// The parameter.
    at: Complex64,
    /// The solution's rate here and at the place before, the move between and its step; zero where there was none.
    rate: Solution<N>,
    rate_before: Solution<N>,
    moved_before: Solution<N>,
    before: Complex64,
    /// Length of the next step: it should just be accepted.
    step: f64,
    phases: Phases,
}

/// A straight stretch of the parameter's path: its direction, its length, and the parameter at its end.
#[derive(Clone, Copy)]
pub(crate) struct Way {
    pub direction: Complex64,
    pub length: f64,
    pub end: Complex64,
    /// Whether the solution at its end is corrected until only rounding is left.
    pub settle: bool,
}

/// The places at the end of each way of each start, way by way; `ways` is one list for all, or one for each. `None` where a path
/// does not arrive at a finite regular solution.
pub(crate) fn follow<H: Homotopy<N>, const N: usize>(
    homotopy: &H,
    starts: &[Place<N>],
    ways: &[&[Way]],
    pace: Pace,
) -> Vec<Option<Place<N>>> {
    let each = ways.first().map_or(0, |w| w.len());
    let mut ends = vec![None; starts.len() * each];
    if !ends.is_empty() {
        dispatch(Follow { homotopy, starts, ways, each, pace, ends: &mut ends });
    }
    ends
}

/// The solutions that arrive after the first step of a way from 0 to 1: in one step, where that will do.
pub(crate) fn one_step<H: Homotopy<N>, const N: usize>(way: &H, starts: &[Solution<N>]) -> Vec<Solution<N>> {
    let step = Way {
        direction: Complex64::ONE,
        length: FIRST_STEP,
        end: FIRST_STEP.into(),
        settle: true,
    };
    let places: Vec<Place<N>> = starts.iter().map(|x| Place::start(x, Complex64::ZERO)).collect();
    let ends = follow(way, &places, &[&[step]], BRISK);
    ends.iter().flatten().map(|place| *place.solution()).collect()
}

/// The determinants of the joints' columns at solutions where a way ends.
pub(crate) fn determinants<H: Homotopy<N>, const N: usize>(
    way: &H,
    solutions: &[Solution<N>],
) -> Vec<Complex64> {
    let mut out = Vec::with_capacity(solutions.len());
    for some in solutions.chunks(LANES) {
        let lanes: [Lanes<Plain>; N] = from_fn(|i| {
            let part = |part: fn(&Complex64) -> f64| -> Reals {
                from_fn(|k| part(&some.get(k).unwrap_or(&some[0])[i]))
            };
            Lanes::load(&part(|z| z.re), &part(|z| z.im))
        });
        let (.., determinant) = way.linearise::<Plain, false>(&lanes, Lanes::one()).solve();
        let [re, im] = [determinant.re, determinant.im].map(|v| v.store());
        out.extend((0..some.len()).map(|k| Complex64::new(re[k], im[k])));
    }
    out
}

impl<const N: usize> Place<N> {
    /// Where a way begins.
    pub fn start(x: &Solution<N>, at: Complex64) -> Self {
        let zero = [Complex64::ZERO; N];
        Self {
            x: *x,
            at,
            rate: zero,
            rate_before: zero,
            moved_before: zero,
            before: Complex64::ZERO,
            step: 0.0,
            phases: Phases::NONE,
        }
    }

    pub fn solution(&self) -> &Solution<N> {
        &self.x
    }

    /// The solution's rate along the way.
    pub fn rate(&self) -> &Solution<N> {
        &self.rate
    }

    /// Its phases.
    pub fn phases(&self) -> &Phases {
        &self.phases
    }
}

struct Follow<'a, H, const N: usize> {
    homotopy: &'a H,
    starts: &'a [Place<N>],
    ways: &'a [&'a [Way]],
    each: usize,
    pace: Pace,
    ends: &'a mut [Option<Place<N>>],
}

/// The state of all lanes between steps.
struct Walk<V, const N: usize> {
    x: [Lanes<V>; N],
    rate: [Lanes<V>; N],
    rate_before: [Lanes<V>; N],
    moved_before: [Lanes<V>; N],
    at: Lanes<V>,
    before: Lanes<V>,
    phases: PhaseLanes<V>,
    /// Length that is left of the way, and of the next step.
    left: Reals,
    step: Reals,
    /// The path in each lane, and its way; a lane without a path has `usize::MAX` and rests.
    path: [usize; LANES],
    way: [usize; LANES],
    /// Steps on the way so far, and corrections at its end.
    count: [usize; LANES],
    settling: [usize; LANES],
}

impl<H: Homotopy<N>, const N: usize> LaneKernel for Follow<'_, H, N> {
    #[inline(always)]
    fn run<V: Vector>(mut self) {
        let zero = [Lanes::zero(); N];
        let mut walk = Walk::<V, N> {
            x: zero,
            rate: zero,
            rate_before: zero,
            moved_before: zero,
            at: Lanes::one(),
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
            stopping::piece();
            let finished = self.advance(&mut walk);
            if finished.contains(&true) {
                self.load(&mut walk, finished, &mut next);
            }
        }
    }
}

impl<H: Homotopy<N>, const N: usize> Follow<'_, H, N> {
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
    fn load<V: Vector>(&self, walk: &mut Walk<V, N>, free: [bool; LANES], next: &mut usize) {
        let mut from = [&self.starts[0]; LANES];
        for lane in (0..LANES).filter(|&k| free[k]) {
            let more = *next < self.starts.len();
            walk.path[lane] = if more { *next } else { usize::MAX };
            *next += usize::from(more);
            walk.way[lane] = 0;
            walk.count[lane] = 0;
            walk.settling[lane] = 0;
            walk.left[lane] = 0.0;
            if more {
                from[lane] = &self.starts[walk.path[lane]];
                walk.left[lane] = self.way(walk.path[lane], 0).length;
            }
            walk.step[lane] = from[lane].step;
            if let Some(watch) = self.homotopy.watch() {
                walk.phases.put(lane, &from[lane].phases, watch);
            }
        }
        for i in 0..N {
            put(&mut walk.x[i], &free, from.map(|p| p.x[i]));
            // a first step is predicted from nothing
            if from.iter().any(|p| p.step > 0.0) {
                put(&mut walk.rate[i], &free, from.map(|p| p.rate[i]));
                put(&mut walk.rate_before[i], &free, from.map(|p| p.rate_before[i]));
                put(&mut walk.moved_before[i], &free, from.map(|p| p.moved_before[i]));
            }
        }
        put(&mut walk.at, &free, from.map(|p| p.at));
        put(&mut walk.before, &free, from.map(|p| p.before));
    }

    /// One step in each lane; returns which lanes are done with their paths.
    #[inline(always)]
    fn advance<V: Vector>(&mut self, walk: &mut Walk<V, N>) -> [bool; LANES] {
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
        let end = Lanes::load(&end_re, &end_im);
        let at = self
            .homotopy
            .ahead(walk.at, ahead)
            .replaced_where(at_end, half, end);
        // a cubic through two places and their rates; a straight line on the first step
        let known = walk.before.square();
        let pace = Lanes::zero().replaced_where(known, zero, walk.before.recip());
        let second = ahead * ahead * pace;
        let third = second * (ahead + walk.before) * pace;
        let mut predicted = [Lanes::<V>::zero(); N];
        for i in 0..N {
            let (rate, rate_before) = (walk.rate[i], walk.rate_before[i]);
            let mean = walk.moved_before[i] * pace;
            predicted[i] = (rate * ahead)
                .plus_product(rate - mean, second)
                .plus_product(rate + rate_before - mean - mean, third);
        }
        let slides = self.homotopy.slides();
        let reach = size(slides, &walk.x, &predicted);
        let x1 = moved(slides, &walk.x, &predicted);
        let (first_correction, ..) = self.homotopy.linearise::<V, false>(&x1, at).solve();
        let first = size(slides, &x1, &first_correction);
        let x2 = moved(slides, &x1, &first_correction);
        let (second_correction, rate, determinant) = self.homotopy.linearise::<V, true>(&x2, at).solve();
        let last = size(slides, &x2, &second_correction);
        let x3 = moved(slides, &x2, &second_correction);
        let (mut factors, mut steady) = ([Lanes::<V>::zero(); FACTORS], [0.0; LANES]);
        if let Some(watch) = self.homotopy.watch() {
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
            let room = AIMED_MOVE / reach[k].max(LEAST_MOVE);
            if !good {
                walk.step[k] = step[k] * room.clamp(SHORTER.0, SHORTER.1);
                continue;
            }
            walk.left[k] = if ends[k] > 0.0 {
                0.0
            } else {
                walk.left[k] - step[k]
            };
            // the prediction's error grows as the fourth power of the step
            let factor = (self.pace.aimed / first[k].max(LEAST_CORRECTION))
                .sqrt()
                .sqrt()
                .clamp(CHANGED.0, CHANGED.1);
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
        walk.at = walk.at.replaced_where(taken, half, at);
        if let Some(watch) = self.homotopy.watch() {
            walk.phases.go_on(&factors, taken, watch);
        }
        walk.before = walk.before.replaced_where(gone, zero, ahead);
        for i in 0..N {
            let by = predicted[i] + first_correction[i] + second_correction[i];
            walk.rate_before[i] = walk.rate_before[i].replaced_where(gone, zero, walk.rate[i]);
            walk.moved_before[i] = walk.moved_before[i].replaced_where(gone, zero, by);
            walk.rate[i] = walk.rate[i].replaced_where(taken, half, rate[i]);
            walk.x[i] = walk.x[i].replaced_where(taken, half, x3[i]);
        }
        self.finished(walk, &accepted, (&first, &last))
    }

    /// Records the ends of ways; returns which lanes are done with their paths or have lost them.
    #[inline(always)]
    fn finished<V: Vector>(
        &mut self,
        walk: &mut Walk<V, N>,
        accepted: &Reals,
        (first, last): (&Reals, &Reals),
    ) -> [bool; LANES] {
        let infinite = infinite(self.homotopy.slides(), &walk.x);
        let most_steps = self.homotopy.most_steps(self.pace);
        let mut done = [false; LANES];
        for k in 0..LANES {
            if walk.path[k] >= self.starts.len() {
                walk.step[k] = 0.0;
                continue;
            }
            let at_end = accepted[k] > 0.0 && walk.left[k] <= 0.0;
            walk.settling[k] += usize::from(at_end);
            let settled = !self.way(walk.path[k], walk.way[k]).settle
                || self.homotopy.settled(first[k], last[k])
                || (walk.settling[k] > LAST_CORRECTIONS && last[k] <= LAST_SECOND_FAR);
            let stuck = (accepted[k] == 0.0 && walk.step[k] < SHORTEST_STEP) || walk.count[k] > most_steps;
            if at_end && settled {
                let mut end = walk.place(k);
                if let Some(watch) = self.homotopy.watch() {
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

impl<V: Vector, const N: usize> Walk<V, N> {
    /// The place of a lane.
    #[inline(always)]
    fn place(&self, lane: usize) -> Place<N> {
        let mut out = Place::start(&[Complex64::ZERO; N], get(self.at, lane));
        for i in 0..N {
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

/// Puts values into the lanes that are free.
#[inline(always)]
fn put<V: Vector>(lanes: &mut Lanes<V>, free: &[bool; LANES], values: [Complex64; LANES]) {
    let (mut re, mut im) = (lanes.re.store(), lanes.im.store());
    for k in (0..LANES).filter(|&k| free[k]) {
        (re[k], im[k]) = (values[k].re, values[k].im);
    }
    *lanes = Lanes::load(&re, &im);
}
