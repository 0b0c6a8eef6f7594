//! Following complex solutions of the closure while its parameters move: eight paths side by side.
//!
//! The closure is `Z1 T(p1) Rx(a1) Z2 .. Z7 T(p7) Rx(a7) = 1` with `Zi = Rz(ti) Tz(di)`. In a turning joint `ti` is unknown
//! and `di` is zero; in a sliding one `di` is unknown and `ti` given; in the last joint, the input, both are given. Turns and
//! twists enter as `e^(i t)` and `e^(i a)`, so that everything is rational; these, the `p` and the input's slide move on
//! straight lines from the start to the end parameters. Where only the input differs they stay within one linkage; but see
//! [`super::around`].
//!
//! Source: docs/theory.md, (6).

use super::lanes::Lanes;
use crate::vectors::{LANES, LaneKernel, Reals, Vector, dispatch};
use num_complex::Complex64;

/// Unknown joints of the closure.
pub(super) const UNKNOWNS: usize = 6;

/// Its joints: the unknown ones and the input.
pub(super) const JOINTS: usize = 7;

/// Most steps on one path; the longest of 10^5 random paths that arrive took 300.
const MOST_STEPS: usize = 800;

/// How short the steps are kept.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pace {
    /// First correction [rad, or parts of the size] that steps aim at, and that which they must not exceed.
    pub aimed: f64,
    pub largest: f64,
    /// Second correction that a step must not exceed; the next would be its square.
    pub second: f64,
}

/// Paths that keep apart, as between general parameters.
pub(super) const BRISK: Pace = Pace { aimed: 1e-2, largest: 8e-2, second: 2e-3 };

/// Paths that come near each other, as at the end beside a dead centre.
pub(super) const CAREFUL: Pace = Pace { aimed: 1e-4, largest: 1e-3, second: 1e-5 };

/// Second correction as a part of the first.
pub(super) const LEAST_CONTRACTION: f64 = 0.1;

/// Second correction at the end of a path, where the next would be rounding.
const LAST_SECOND: f64 = 1e-8;

/// The same for far solutions, `e^(i t)` in the hundreds, where rounding is that much greater; after so many corrections.
pub(super) const LAST_SECOND_FAR: f64 = 3e-5;
pub(super) const LAST_CORRECTIONS: usize = 4;

/// A longer predicted move of all joints together [rad] is made in shorter steps.
pub(super) const LONGEST_MOVE: f64 = 1.0;

/// Part of the way of the first step.
const FIRST_STEP: f64 = 0.02;

/// Steps shorter than this end a path: it runs to infinity or into a singular solution.
pub(super) const SHORTEST_STEP: f64 = 1e-9;

/// Rows of the elimination are exchanged where an entry is so many times the pivot: seldom in all lanes, and a digit is lost at
/// most.
const EXCHANGED: f64 = 8.0;

/// `|e^(i t)|`, or a slide in parts of the size, beyond which a path has left for infinity.
const INFINITE: f64 = 1e7;

/// The closure is known to this times one to six [rad, or parts of the size]. Added to it, so that paths seldom arrive at a solution that
/// does not stand alone: where numbers are exact, as in special geometry, nothing else would move one along its continuum.
const ROUNDING: f64 = 2e-16;

/// Parameters of the closure.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parameters {
    /// `e^(i a)` of each twist.
    pub twists: [Complex64; JOINTS],
    /// The translation after each joint.
    pub shifts: [[Complex64; 3]; JOINTS],
    /// `e^(i t)` of the given turn of each sliding joint, and of the input.
    pub turns: [Complex64; JOINTS],
    /// The slide of the input.
    pub slide: Complex64,
}

/// `e^(i t)` of each turning joint, `d` of each sliding one.
pub(super) type Solution = [Complex64; UNKNOWNS];

/// Which joints slide.
pub(super) type Slides = [bool; UNKNOWNS];

/// Where each path ends; `None` where it does not arrive at a finite regular solution.
pub(super) fn follow(
    slides: &Slides,
    from: &Parameters,
    to: &Parameters,
    starts: &[Solution],
    pace: Pace,
) -> Vec<Option<Solution>> {
    let mut ends = vec![None; starts.len()];
    dispatch(Follow { slides, from, to, starts, pace, ends: &mut ends });
    ends
}

struct Follow<'a> {
    slides: &'a Slides,
    from: &'a Parameters,
    to: &'a Parameters,
    starts: &'a [Solution],
    pace: Pace,
    ends: &'a mut [Option<Solution>],
}

/// The linearised closure in each lane: `J delta = -error`, `J rate = -drift`.
pub(super) struct Linear<V: Vector> {
    /// Six joint columns, then minus the closure error, then minus its drift with the parameters.
    pub rows: [[Lanes<V>; UNKNOWNS + 2]; 6],
}

pub(super) type Triple<V> = [Lanes<V>; 3];

#[inline(always)]
pub(super) fn cross<V: Vector>(a: &Triple<V>, b: &Triple<V>) -> Triple<V> {
    [
        (a[1] * b[2]).minus_product(a[2], b[1]),
        (a[2] * b[0]).minus_product(a[0], b[2]),
        (a[0] * b[1]).minus_product(a[1], b[0]),
    ]
}

/// Turns the frame's axes `a`, `b` by the angle whose cosine and sine are given.
#[inline(always)]
pub(super) fn turn<V: Vector>(a: &mut Triple<V>, b: &mut Triple<V>, cosine: Lanes<V>, sine: Lanes<V>) {
    for k in 0..3 {
        let (x, y) = (a[k], b[k]);
        a[k] = (x * cosine).plus_product(y, sine);
        b[k] = (y * cosine).minus_product(x, sine);
    }
}

/// Cosine and sine from `e^(i t)`, and its reciprocal.
#[inline(always)]
pub(super) fn cosine_sine<V: Vector>(z: Lanes<V>) -> (Lanes<V>, Lanes<V>, Lanes<V>) {
    let inverse = z.recip();
    (
        (z + inverse).scale(V::splat(0.5)),
        (inverse - z).times_i().scale(V::splat(0.5)),
        inverse,
    )
}

impl Follow<'_> {
    /// Without the drift where no rate is asked for; what stands still or is zero is left out.
    #[inline(always)]
    fn linearise<V: Vector, const DRIFT: bool>(&self, x: &[Lanes<V>; UNKNOWNS], t: V) -> Linear<V> {
        let zero = Lanes::<V>::zero();
        let one = Lanes::<V>::one();
        let mut rows = [[zero; UNKNOWNS + 2]; 6];
        let mut ex = [one, zero, zero];
        let mut ey = [zero, one, zero];
        let mut ez = [zero, zero, one];
        let mut place = [zero; 3];
        let mut drift_turn = [zero; 3];
        let mut drift_shift = [zero; 3];
        let moving = |a: Complex64, b: Complex64| {
            let rate = Lanes::<V>::splat(b - a);
            (Lanes::splat(a).plus_scaled(rate, t), rate)
        };
        for i in 0..JOINTS {
            let moment = cross(&place, &ez);
            let given = i == UNKNOWNS || self.slides[i];
            let turn_now = if given {
                if i < UNKNOWNS {
                    for k in 0..3 {
                        rows[k + 3][i] = ez[k];
                    }
                }
                let (z, rate) = moving(self.from.turns[i], self.to.turns[i]);
                if DRIFT && self.from.turns[i] != self.to.turns[i] {
                    let angular = (rate * z.recip()).times_i();
                    for k in 0..3 {
                        drift_turn[k] = drift_turn[k].minus_product(ez[k], angular);
                        drift_shift[k] = drift_shift[k].minus_product(moment[k], angular);
                    }
                }
                z
            } else {
                for k in 0..3 {
                    rows[k][i] = ez[k];
                    rows[k + 3][i] = moment[k];
                }
                x[i]
            };
            let (cosine, sine, _) = cosine_sine(turn_now);
            turn(&mut ex, &mut ey, cosine, sine);
            if i == UNKNOWNS {
                let (slide, rate) = moving(self.from.slide, self.to.slide);
                for k in 0..3 {
                    place[k] = place[k].plus_product(ez[k], slide);
                    drift_shift[k] = drift_shift[k].plus_product(ez[k], rate);
                }
            } else if self.slides[i] {
                for k in 0..3 {
                    place[k] = place[k].plus_product(ez[k], x[i]);
                }
            }
            for (j, axis) in [&ex, &ey, &ez].into_iter().enumerate() {
                let (from, to) = (self.from.shifts[i][j], self.to.shifts[i][j]);
                if from == to && from == Complex64::ZERO {
                    continue;
                }
                let (shift, rate) = moving(from, to);
                for k in 0..3 {
                    place[k] = place[k].plus_product(axis[k], shift);
                }
                if DRIFT && from != to {
                    for k in 0..3 {
                        drift_shift[k] = drift_shift[k].plus_product(axis[k], rate);
                    }
                }
            }
            let (w, rate) = moving(self.from.twists[i], self.to.twists[i]);
            let (cosine, sine, inverse) = cosine_sine(w);
            if DRIFT && self.from.twists[i] != self.to.twists[i] {
                let angular = (rate * inverse).times_i();
                let moment = cross(&place, &ex);
                for k in 0..3 {
                    drift_turn[k] = drift_turn[k].minus_product(ex[k], angular);
                    drift_shift[k] = drift_shift[k].minus_product(moment[k], angular);
                }
            }
            turn(&mut ey, &mut ez, cosine, sine);
        }
        let error = [
            (ey[2] - ez[1]).scale(V::splat(0.5)),
            (ez[0] - ex[2]).scale(V::splat(0.5)),
            (ex[1] - ey[0]).scale(V::splat(0.5)),
            place[0],
            place[1],
            place[2],
        ];
        for k in 0..3 {
            rows[k][UNKNOWNS + 1] = -drift_turn[k];
            rows[k + 3][UNKNOWNS + 1] = -drift_shift[k];
        }
        for k in 0..6 {
            let unknown = Lanes { re: V::splat(ROUNDING * (k + 1) as f64), im: V::splat(0.0) };
            rows[k][UNKNOWNS] = unknown - error[k];
        }
        Linear { rows }
    }
}

/// The unknowns after a move.
#[inline(always)]
pub(super) fn moved<V: Vector>(
    slides: &Slides,
    x: &[Lanes<V>; UNKNOWNS],
    by: &[Lanes<V>; UNKNOWNS],
) -> [Lanes<V>; UNKNOWNS] {
    let mut out = *x;
    for i in 0..UNKNOWNS {
        out[i] = if slides[i] {
            x[i] + by[i]
        } else {
            x[i] * by[i].turn()
        };
    }
    out
}

/// The greatest part of a move: [rad], or slides in parts of the size or of themselves.
#[inline(always)]
pub(super) fn size<V: Vector>(slides: &Slides, x: &[Lanes<V>; UNKNOWNS], by: &[Lanes<V>; UNKNOWNS]) -> Reals {
    // a sum, so that what is not a number shows
    let mut sum = V::splat(0.0);
    for i in 0..UNKNOWNS {
        let square = by[i].square();
        sum = sum
            + if slides[i] {
                square / (V::splat(1.0) + x[i].square())
            } else {
                square
            };
    }
    sum.sqrt().store()
}

/// Whether a path has left for infinity.
#[inline(always)]
pub(super) fn infinite<V: Vector>(slides: &Slides, x: &[Lanes<V>; UNKNOWNS]) -> [bool; LANES] {
    let (mut least, mut greatest) = (V::splat(1.0), V::splat(1.0));
    for i in 0..UNKNOWNS {
        let size = x[i].square();
        greatest = size.if_greater(greatest, size, greatest);
        if !slides[i] {
            least = size.lesser(least);
        }
    }
    let (least, greatest) = (least.store(), greatest.store());
    let mut out = [false; LANES];
    for k in 0..LANES {
        out[k] = greatest[k] > INFINITE * INFINITE || least[k] * INFINITE * INFINITE < 1.0;
    }
    out
}

impl<V: Vector> Linear<V> {
    /// The Newton correction, the rate with the parameters, and the determinant of the joints' columns, by elimination with row
    /// exchanges in each lane.
    #[inline(always)]
    pub fn solve(mut self) -> ([Lanes<V>; UNKNOWNS], [Lanes<V>; UNKNOWNS], Lanes<V>) {
        let a = &mut self.rows;
        let (one, minus) = (V::splat(1.0), V::splat(-1.0));
        let greater = V::splat(EXCHANGED * EXCHANGED);
        let mut determinant = Lanes::<V>::one();
        let mut sign = one;
        for c in 0..6 {
            for r in c + 1..6 {
                let (upper, lower) = (a[c][c].square() * greater, a[r][c].square());
                if !lower.exceeds_somewhere(upper) {
                    continue;
                }
                for j in c..UNKNOWNS + 2 {
                    let (x, y) = (a[c][j], a[r][j]);
                    a[c][j] = x.replaced_where(lower, upper, y);
                    a[r][j] = y.replaced_where(lower, upper, x);
                }
                sign = sign * lower.if_greater(upper, minus, one);
            }
            determinant = determinant * a[c][c];
            let inverse = a[c][c].recip();
            for j in c + 1..UNKNOWNS + 2 {
                a[c][j] = a[c][j] * inverse;
            }
            for r in c + 1..6 {
                let factor = a[r][c];
                for j in c + 1..UNKNOWNS + 2 {
                    a[r][j] = a[r][j].minus_product(factor, a[c][j]);
                }
            }
        }
        let mut step = [Lanes::zero(); UNKNOWNS];
        let mut rate = [Lanes::zero(); UNKNOWNS];
        for c in (0..6).rev() {
            let (mut s, mut t) = (a[c][UNKNOWNS], a[c][UNKNOWNS + 1]);
            for j in c + 1..6 {
                s = s.minus_product(a[c][j], step[j]);
                t = t.minus_product(a[c][j], rate[j]);
            }
            step[c] = s;
            rate[c] = t;
        }
        (step, rate, determinant.scale(sign))
    }
}

/// What the lanes hold between steps.
struct Walk<V> {
    x: [Lanes<V>; UNKNOWNS],
    /// d x / d t now and at the step before, and the move between.
    rate: [Lanes<V>; UNKNOWNS],
    rate_before: [Lanes<V>; UNKNOWNS],
    moved_before: [Lanes<V>; UNKNOWNS],
    t: Reals,
    step: Reals,
    step_before: Reals,
    /// The path in each lane; past the last one the lane rests.
    path: [usize; LANES],
    count: [usize; LANES],
    /// Corrections at the end of the path.
    settling: [usize; LANES],
}

impl LaneKernel for Follow<'_> {
    #[inline(always)]
    fn run<V: Vector>(mut self) {
        let mut walk = Walk::<V> {
            x: [Lanes::one(); UNKNOWNS],
            rate: [Lanes::zero(); UNKNOWNS],
            rate_before: [Lanes::zero(); UNKNOWNS],
            moved_before: [Lanes::zero(); UNKNOWNS],
            t: [0.0; LANES],
            step: [0.0; LANES],
            step_before: [0.0; LANES],
            path: [usize::MAX; LANES],
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
    /// Puts the next paths into free lanes; a lane without one rests on a copy of the first.
    #[inline(always)]
    fn load<V: Vector>(&self, walk: &mut Walk<V>, free: [bool; LANES], next: &mut usize) {
        for lane in (0..LANES).filter(|&k| free[k]) {
            walk.path[lane] = if *next < self.starts.len() {
                *next
            } else {
                usize::MAX
            };
            *next += usize::from(walk.path[lane] != usize::MAX);
            walk.count[lane] = 0;
            walk.settling[lane] = 0;
            walk.t[lane] = 0.0;
            walk.step[lane] = 0.0;
            walk.step_before[lane] = 0.0;
        }
        for i in 0..UNKNOWNS {
            let (mut re, mut im) = (walk.x[i].re.store(), walk.x[i].im.store());
            for lane in (0..LANES).filter(|&k| free[k]) {
                if let Some(start) = self.starts.get(walk.path[lane]).or(self.starts.first()) {
                    (re[lane], im[lane]) = (start[i].re, start[i].im);
                }
            }
            walk.x[i] = Lanes::load(&re, &im);
        }
    }

    /// One step in each lane; tells which lanes are done with their paths.
    #[inline(always)]
    fn advance<V: Vector>(&mut self, walk: &mut Walk<V>) -> [bool; LANES] {
        let mut t = [0.0; LANES];
        let mut step = [0.0; LANES];
        let (mut second, mut third, mut pace) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for k in 0..LANES {
            step[k] = walk.step[k].min(1.0 - walk.t[k]);
            t[k] = if step[k] < walk.step[k] {
                1.0
            } else {
                walk.t[k] + step[k]
            };
            // a cubic through two places and their rates; a straight line on the first step
            let before = walk.step_before[k];
            if before > 0.0 {
                pace[k] = 1.0 / before;
                second[k] = step[k] * step[k] / before;
                third[k] = second[k] * (step[k] + before) / before;
            }
        }
        let (now, ahead) = (V::load(&t), V::load(&step));
        let (second, third, pace) = (V::load(&second), V::load(&third), V::load(&pace));
        let mut predicted = [Lanes::<V>::zero(); UNKNOWNS];
        for i in 0..UNKNOWNS {
            let (rate, rate_before) = (walk.rate[i], walk.rate_before[i]);
            let mean = walk.moved_before[i].scale(pace);
            predicted[i] = Lanes::zero()
                .plus_scaled(rate, ahead)
                .plus_scaled(rate - mean, second)
                .plus_scaled(rate + rate_before - mean - mean, third);
        }
        let reach = size(self.slides, &walk.x, &predicted);
        let x1 = moved(self.slides, &walk.x, &predicted);
        let (first_correction, ..) = self.linearise::<V, false>(&x1, now).solve();
        let first = size(self.slides, &x1, &first_correction);
        let x2 = moved(self.slides, &x1, &first_correction);
        let (second_correction, rate, _) = self.linearise::<V, true>(&x2, now).solve();
        let last = size(self.slides, &x2, &second_correction);
        let x3 = moved(self.slides, &x2, &second_correction);

        let mut accepted = [0.0; LANES];
        for k in 0..LANES {
            let good = reach[k] <= LONGEST_MOVE
                && first[k] <= self.pace.largest
                && last[k] <= self.pace.second
                && last[k] <= (LEAST_CONTRACTION * first[k]).max(LAST_SECOND_FAR);
            accepted[k] = f64::from(u8::from(good));
            walk.count[k] += 1;
            let room = LONGEST_MOVE * 0.8 / reach[k].max(1e-3);
            if good {
                walk.t[k] = t[k];
                if step[k] > 0.0 {
                    walk.step_before[k] = step[k];
                }
                let factor = (self.pace.aimed / first[k].max(1e-9))
                    .sqrt()
                    .sqrt()
                    .clamp(0.5, 2.0);
                walk.step[k] = if step[k] > 0.0 {
                    step[k] * factor.min(room)
                } else {
                    FIRST_STEP
                };
            } else {
                walk.step[k] = step[k] * room.clamp(0.1, 0.5);
            }
        }
        let (accepted_lanes, half) = (V::load(&accepted), V::splat(0.5));
        for i in 0..UNKNOWNS {
            let moved = predicted[i] + first_correction[i] + second_correction[i];
            let take = |old: Lanes<V>, new: Lanes<V>| old.replaced_where(accepted_lanes, half, new);
            walk.rate_before[i] = take(walk.rate_before[i], walk.rate[i]);
            walk.moved_before[i] = take(walk.moved_before[i], moved);
            walk.rate[i] = take(walk.rate[i], rate[i]);
            walk.x[i] = take(walk.x[i], x3[i]);
        }
        self.finished(walk, &accepted, &last)
    }

    /// Records the ends of paths that arrived or are lost.
    #[inline(always)]
    fn finished<V: Vector>(&mut self, walk: &mut Walk<V>, accepted: &Reals, last: &Reals) -> [bool; LANES] {
        let infinite = infinite(self.slides, &walk.x);
        let (mut done, mut ends_here) = ([false; LANES], [false; LANES]);
        for k in 0..LANES {
            if walk.path[k] >= self.starts.len() {
                walk.step[k] = 0.0;
                walk.t[k] = 0.0;
                continue;
            }
            let stuck = (accepted[k] == 0.0 && walk.step[k] < SHORTEST_STEP) || walk.count[k] > MOST_STEPS;
            let at_end = walk.t[k] >= 1.0 && accepted[k] > 0.0;
            walk.settling[k] += usize::from(at_end);
            let settled =
                last[k] <= LAST_SECOND || (walk.settling[k] > LAST_CORRECTIONS && last[k] <= LAST_SECOND_FAR);
            let arrived = at_end && settled;
            done[k] = arrived || infinite[k] || stuck;
            ends_here[k] = arrived;
        }
        if done.contains(&true) {
            let x = walk.x.map(|x| (x.re.store(), x.im.store()));
            for k in (0..LANES).filter(|&k| ends_here[k]) {
                self.ends[walk.path[k]] = Some(std::array::from_fn(|i| Complex64::new(x[i].0[k], x[i].1[k])));
            }
        }
        done
    }
}
