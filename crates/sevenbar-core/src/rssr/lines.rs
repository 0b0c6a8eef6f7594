//! Limits of a block of RSSRs in vector code: `rho^2 - K^2` as the product of two lines across the unit circle.
//!
//! With the driver's angle turned by half the phase of its second harmonic, `W = rho^2 - K^2` is
//! `2 e (C/2 + a cos + b sin + cos(2 .)/2)`, and the bracket is `(p cos + q sin + g1)(p cos - q sin + g2)` where
//! `p^2 = (1 - v)/2`, `q^2 = (1 + v)/2` with a root v in [-1, 1] of a cubic, and `p (g1 + g2) = a`,
//! `q (g2 - g1) = b`, `g1 g2 = (C + v)/2`. There is always such a root: the cubic is `-2 b^2` at -1 and `2 a^2` at 1. A line has
//! two zeros where `|g| < 1`, `acos(-g)` to both sides of its own direction, and none where `|g| > 1`: so the two
//! numbers count the limits. The root is sought by its distance w from an end, since p or q is the square root of half of it:
//! `w^3 - (k + 3) w^2 + (a^2 + b^2 + 2 + 2 k) w - 2 t^2 = 0`, with `k = C`, `t = a` at `v = 1 - w`, and with `k = -C`, `t = b` at
//! `v = w - 1`.
//!
//! How far the product misses W is measured, not assumed, and set beside the margins on which the count and the
//! zeros stand. A direction that does not stand clear is doubtful, and for the solver that counts by signs.
//!
//! Source: docs/theory_many.md, (1) to (6).

use super::linkage::Input;
use crate::simd::multiply_add;
use crate::vector_math::atan2;
use std::f64::consts::TAU;

/// Linkages handled together; the scratch arrays of a block stay in the nearest cache.
pub(crate) const BLOCK: usize = 64;

/// One number for each linkage of a block.
pub(crate) type Lane = [f64; BLOCK];

/// What a turning joint can do: every angle,
pub(crate) const FULL: f64 = 0.0;
/// none,
pub(crate) const EMPTY: f64 = 1.0;
/// those of one range,
pub(crate) const ARC: f64 = 2.0;
/// or of two.
pub(crate) const ARCS: f64 = 3.0;

/// Halley steps for the root w: of uniform dimensions one linkage in a thousand has not converged by then, and is doubtful.
const STEPS: usize = 7;

/// How far from 1 the number |g| of a line must be: two zeros, real or complex, are then 9e-3 rad apart, ten
/// thousand times as far as those that are called a change point.
const LINE_MARGIN: f64 = 1e-5;

/// The least value of one line at a zero of the other: such zeros are at least so many radians apart.
const CROSSING_MARGIN: f64 = 1e-3;

/// The greatest error of W relative to its slope at a zero [rad]: within it Newton's steps converge in two.
const ZERO_ERROR: f64 = 1e-8;

/// The greatest error of W relative to its own least size away from zeros.
const COUNT_ERROR: f64 = 1e-3;

/// Rounding of W relative to the sum of its terms, in generous measure: twice that of the other solver.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// A last Newton step [rad] greater than this has not converged.
const SETTLED: f64 = 1e-8;

/// M, N, L1, L2, L3 and D of each linkage, relative to a power of two near the greatest of its own; sine and cosine of the angle
/// between its axes.
pub(crate) type Dimensions = [Lane; 8];

/// A direction of the closure at one linkage: the driving ball is at `(d + r sin t, f + r c cos t)` in the plane of the follower and
/// at `m + r s cos t` along its axis. The crank's angle is t; the rocker's is a quarter turn less t.
pub(crate) struct Drive {
    d: f64,
    f: f64,
    m: f64,
    r: f64,
    /// The sine of the angle between the axes.
    s: f64,
    /// Minus the cosine of it.
    c: f64,
    radius: f64,
    coupler: f64,
}

/// `rho^2 - K^2 = c0 + c1 cos t + s1 sin t + c2 cos 2t + s2 sin 2t` of a direction, and the sum of its terms.
pub(crate) struct Square {
    pub(crate) c0: f64,
    pub(crate) c1: f64,
    pub(crate) s1: f64,
    pub(crate) c2: f64,
    pub(crate) s2: f64,
    terms: f64,
}

impl Drive {
    #[inline(always)]
    pub(crate) fn new([m, n, l1, l2, l3, d, s, c]: &Dimensions, input: Input, i: usize) -> Self {
        let (m, n, d, coupler) = (m[i], n[i], d[i], l2[i]);
        let (s, c) = (s[i], -c[i]);
        match input {
            Input::Crank => Self { d: -d, f: n * s, m: -n * c - m, r: l1[i], s, c, radius: l3[i], coupler },
            Input::Rocker => Self { d, f: m * s, m: -m * c - n, r: l3[i], s, c, radius: l1[i], coupler },
        }
    }

    /// The trigonometric polynomial whose zeros are the limits.
    #[inline(always)]
    pub(crate) fn square<const FUSED: bool>(&self) -> Square {
        let Self { d, f, m, r, s, c, radius, coupler } = *self;
        let squares = multiply_add::<FUSED>(d, d, f * f) + multiply_add::<FUSED>(m, m, r * r);
        let difference = (radius - coupler) * (radius + coupler);
        let k0 = 0.5 * (squares + difference);
        let (p, q) = (r * multiply_add::<FUSED>(f, c, m * s), r * d);
        let square = radius * radius;
        let ring = 0.5 * r * r;
        let plane = multiply_add::<FUSED>(
            d,
            d,
            multiply_add::<FUSED>(f, f, multiply_add::<FUSED>(ring * c, c, ring)),
        );
        let reach = d.abs() + r;
        let height = multiply_add::<FUSED>(r, c.abs(), f.abs());
        let k = 0.5 * (squares + difference.abs()) + p.abs() + q.abs();
        Square {
            c0: square * plane - k0 * k0 - 0.5 * multiply_add::<FUSED>(p, p, q * q),
            c1: 2.0 * multiply_add::<FUSED>(square * f, r * c, -k0 * p),
            s1: 2.0 * multiply_add::<FUSED>(square * d, r, -k0 * q),
            c2: -0.5 * multiply_add::<FUSED>(square * r * s, r * s, (p - q) * (p + q)),
            s2: -p * q,
            terms: multiply_add::<FUSED>(
                square,
                multiply_add::<FUSED>(reach, reach, height * height),
                k * k,
            ),
        }
    }
}

/// The two lines of each linkage for one direction.
pub(crate) struct Lines {
    /// Cosine and sine of the angle by which the driver's is turned.
    turn: [Lane; 2],
    /// `p` and `q`
    normal: [Lane; 2],
    /// `g1` and `g2`
    offset: [Lane; 2],
    /// One of [`FULL`], [`EMPTY`], [`ARC`], [`ARCS`].
    pub(crate) reach: Lane,
    /// 0 where the answer stands clear, else greater.
    pub(crate) doubt: Lane,
}

/// W of each linkage, and the root w that is sought, in its bracket.
struct Cubic {
    c: Lane,
    a: Lane,
    b: Lane,
    noise: Lane,
    low: Lane,
    high: Lane,
    w: Lane,
}

impl Lines {
    pub(crate) const fn new() -> Self {
        let zero = [0.0; BLOCK];
        Self {
            turn: [zero; 2],
            normal: [zero; 2],
            offset: [zero; 2],
            reach: zero,
            doubt: zero,
        }
    }

    /// The lines of a block, how far the driver reaches, and whether that stands clear.
    #[inline(always)]
    pub(crate) fn find<const FUSED: bool>(&mut self, dimensions: &Dimensions, input: Input) {
        let zero = [0.0; BLOCK];
        let mut cubic = Cubic {
            c: zero,
            a: zero,
            b: zero,
            noise: zero,
            low: zero,
            high: [1.0; BLOCK],
            w: zero,
        };
        for i in 0..BLOCK {
            self.set_up::<FUSED>(&mut cubic, &Drive::new(dimensions, input, i), i);
        }
        for _ in 0..STEPS {
            for i in 0..BLOCK {
                halley_step::<FUSED>(&mut cubic, i);
            }
        }
        for i in 0..BLOCK {
            self.split::<FUSED>(&cubic, i);
        }
    }

    /// The trigonometric polynomial of a linkage: turned, and relative to its second harmonic.
    #[inline(always)]
    fn set_up<const FUSED: bool>(&mut self, cubic: &mut Cubic, drive: &Drive, i: usize) {
        let Square { c0, c1, s1, c2, s2, terms } = drive.square::<FUSED>();
        let e = multiply_add::<FUSED>(c2, c2, s2 * s2).sqrt();
        // half the phase of (c2, s2), from the half-angle formula that does not cancel
        let large = (0.5 * (1.0 + c2.abs() / e)).sqrt();
        let small = 0.5 * s2 / (e * large);
        let flipped = if s2 < 0.0 { -large } else { large };
        let (cosine, sine) = if c2 < 0.0 {
            (small.abs(), flipped)
        } else {
            (large, small)
        };
        let half = 0.5 / e;
        let c = c0 / e;
        let a = half * multiply_add::<FUSED>(c1, cosine, s1 * sine);
        let b = half * multiply_add::<FUSED>(s1, cosine, -c1 * sine);
        (cubic.c[i], cubic.a[i], cubic.b[i]) = (c, a, b);
        cubic.w[i] = start::<FUSED>(c, a, b);
        cubic.noise[i] = ROUNDING * terms * half;
        self.turn[0][i] = cosine;
        self.turn[1][i] = sine;
    }

    /// The lines that a root gives, and how clear they stand.
    #[inline(always)]
    fn split<const FUSED: bool>(&mut self, cubic: &Cubic, i: usize) {
        let (c, a, b, w, noise) = (cubic.c[i], cubic.a[i], cubic.b[i], cubic.w[i], cubic.noise[i]);
        let upper = is_upper(c, a, b);
        let (small, large) = ((0.5 * w).sqrt(), (1.0 - 0.5 * w).sqrt());
        let (p, q) = if upper { (small, large) } else { (large, small) };
        let product = 0.5 * (c + if upper { 1.0 - w } else { w - 1.0 });
        // the sum or the difference of g1 and g2, whichever is not a ratio of small numbers; the other from the product
        let known = if upper { b / q } else { a / p };
        let rest = multiply_add::<FUSED>(known, known, if upper { 4.0 } else { -4.0 } * product);
        let other = rest.max(0.0).sqrt().copysign(if upper { a } else { b });
        let miss = if upper { p * other - a } else { q * other - b };
        let (sum, difference) = if upper { (other, known) } else { (known, other) };
        let alike = (sum >= 0.0) == (difference >= 0.0);
        let large = 0.5 * if alike { sum + difference } else { sum - difference };
        let small = product / if large == 0.0 { 1.0 } else { large };
        let (g1, g2) = if alike { (small, large) } else { (large, small) };

        let (m1, m2) = (g1.abs() - 1.0, g2.abs() - 1.0);
        let error = noise + miss.abs() + (-rest).max(0.0);
        let least = m1.abs() * m2.abs();
        let far = (m1.abs() > LINE_MARGIN) & (m2.abs() > LINE_MARGIN) & (error < COUNT_ERROR * least);
        let first = zeros_stand::<FUSED>(p, q, g1, g2, error);
        let second = zeros_stand::<FUSED>(p, -q, g2, g1, error);
        let (crossed, missed) = ((m1 < 0.0) & (m2 < 0.0), (m1 > 0.0) & (m2 > 0.0));

        // no zero where the constant is greater than both harmonics together
        let rule = 0.5 * c.abs() - (multiply_add::<FUSED>(a, a, b * b).sqrt() + 0.5);
        let constant = (rule > LINE_MARGIN * c.abs()) & (noise < COUNT_ERROR * rule);

        let positive = if constant {
            c > 0.0
        } else {
            (g1 > 0.0) == (g2 > 0.0)
        };
        let whole = if positive { FULL } else { EMPTY };
        let parts = if crossed { ARCS } else { ARC };
        self.reach[i] = if constant | missed { whole } else { parts };
        self.doubt[i] = if constant | (far & first & second) {
            0.0
        } else {
            1.0
        };
        self.normal[0][i] = p;
        self.normal[1][i] = q;
        self.offset[0][i] = if constant { 2.0 } else { g1 };
        self.offset[1][i] = if constant { 2.0 } else { g2 };
    }

    /// The limits of each linkage in [0, 2 pi), rising, NaN after the last; raises the doubt where Newton's steps do not settle.
    #[inline(always)]
    pub(crate) fn limits<const FUSED: bool>(
        &mut self,
        dimensions: &Dimensions,
        input: Input,
        limits: &mut [Lane; 4],
    ) {
        for (slot, lane) in limits.iter_mut().enumerate() {
            let (line, side) = (slot / 2, if slot % 2 == 0 { 1.0 } else { -1.0 });
            for (i, limit) in lane.iter_mut().enumerate() {
                *limit = self.limit::<FUSED>(&Drive::new(dimensions, input, i), input, line, side, i);
            }
        }
        let [a, b, c, d] = &mut *limits;
        order(a, b);
        order(c, d);
        order(a, c);
        order(b, d);
        order(b, c);
        for lane in limits {
            for x in lane {
                *x = if *x < f64::INFINITY { *x } else { f64::NAN };
            }
        }
    }

    /// A zero of a line, moved onto that of the reach; infinity where the line has none.
    #[inline(always)]
    fn limit<const FUSED: bool>(
        &mut self,
        drive: &Drive,
        input: Input,
        line: usize,
        side: f64,
        i: usize,
    ) -> f64 {
        let Drive { d, f, m, r, s: sine, c: cosine, radius, coupler } = *drive;
        let (along, aside) = (r * sine, r * cosine);
        let (p, q) = (self.normal[0][i], self.normal[1][i]);
        let q = if line == 0 { q } else { -q };
        let g = self.offset[line][i];
        let (mut c, mut s) = zero_of_line::<FUSED>(p, q, g, side);
        let (turn_c, turn_s) = (self.turn[0][i], self.turn[1][i]);
        (c, s) = (
            multiply_add::<FUSED>(c, turn_c, -s * turn_s),
            multiply_add::<FUSED>(s, turn_c, c * turn_s),
        );
        let unit = multiply_add::<FUSED>(-0.5, multiply_add::<FUSED>(c, c, s * s), 1.5);
        (c, s) = (c * unit, s * unit);
        let mut step = 0.0;
        for _ in 0..2 {
            let (x, y) = (multiply_add::<FUSED>(r, s, d), multiply_add::<FUSED>(aside, c, f));
            let z = multiply_add::<FUSED>(along, c, m);
            let height = multiply_add::<FUSED>(x, x, y * y).sqrt();
            let (inner, outer) = (height - radius, height + radius);
            let axial = (coupler - z) * (coupler + z);
            let near = multiply_add::<FUSED>(-inner, inner, axial);
            let far = multiply_add::<FUSED>(outer, outer, -axial);
            let nearest = near.abs() < far.abs();
            let climb = multiply_add::<FUSED>(x, r * c, -y * aside * s) / height;
            let slope = multiply_add::<FUSED>(if nearest { inner } else { outer }, climb, -z * along * s);
            step = 0.5 * if nearest { near } else { -far } / slope;
            let shrunk = multiply_add::<FUSED>(-0.5 * step, step, 1.0);
            (c, s) = (
                multiply_add::<FUSED>(c, shrunk, -s * step),
                multiply_add::<FUSED>(s, shrunk, c * step),
            );
        }
        let there = g.abs() < 1.0;
        let settled = step.abs() <= SETTLED;
        self.doubt[i] += if there & !settled { 1.0 } else { 0.0 };
        let (s, c) = match input {
            Input::Crank => (s, c),
            Input::Rocker => (c, s),
        };
        let angle = atan2::<FUSED>(s, c);
        let angle = if angle < 0.0 { angle + TAU } else { angle };
        let angle = if angle < TAU { angle } else { 0.0 };
        if there { angle } else { f64::INFINITY }
    }
}

/// Exchanges numbers so that none of the first lane is greater than that of the second.
#[inline(always)]
fn order(first: &mut Lane, second: &mut Lane) {
    for (x, y) in first.iter_mut().zip(second) {
        let (a, b) = (*x, *y);
        (*x, *y) = if a < b { (a, b) } else { (b, a) };
    }
}

/// True where a root v is sought from 1 downwards, else from -1 upwards: by the sign of the cubic at 0.
#[inline(always)]
fn is_upper(c: f64, a: f64, b: f64) -> bool {
    a * a - b * b < c
}

/// The root w of the parabola through the cubic's ends that leaves w = 0 with its slope.
#[inline(always)]
fn start<const FUSED: bool>(c: f64, a: f64, b: f64) -> f64 {
    let (tt, square, linear) = powers::<FUSED>(c, a, b);
    let bend = square + 1.0;
    let root = multiply_add::<FUSED>(linear, linear, 8.0 * tt * bend).sqrt();
    let rising = linear > 0.0;
    let top = if rising { 4.0 * tt } else { root - linear };
    let w = top / if rising { linear + root } else { 2.0 * bend };
    if (0.0..=1.0).contains(&w) { w } else { 0.5 }
}

/// A step of Halley's for the root w, or half the bracket where the step leaves it.
#[inline(always)]
fn halley_step<const FUSED: bool>(cubic: &mut Cubic, i: usize) {
    let w = cubic.w[i];
    let (tt, square, linear) = powers::<FUSED>(cubic.c[i], cubic.a[i], cubic.b[i]);
    let value = multiply_add::<FUSED>(multiply_add::<FUSED>(w + square, w, linear), w, -2.0 * tt);
    let slope = multiply_add::<FUSED>(multiply_add::<FUSED>(3.0, w, 2.0 * square), w, linear);
    let half_curvature = multiply_add::<FUSED>(3.0, w, square);
    let low = if value < 0.0 { w } else { cubic.low[i] };
    let high = if value < 0.0 { cubic.high[i] } else { w };
    let next = w - value * slope / multiply_add::<FUSED>(slope, slope, -value * half_curvature);
    let inside = (next >= low) & (next <= high);
    cubic.w[i] = if inside { next } else { 0.5 * (low + high) };
    cubic.low[i] = low;
    cubic.high[i] = high;
}

/// `t^2` and the factors of `w^2` and `w` in the cubic of the end that is sought from.
#[inline(always)]
fn powers<const FUSED: bool>(c: f64, a: f64, b: f64) -> (f64, f64, f64) {
    let (aa, bb) = (a * a, b * b);
    let upper = is_upper(c, a, b);
    let (k, tt) = if upper { (c, aa) } else { (-c, bb) };
    (tt, -(k + 3.0), multiply_add::<FUSED>(2.0, k, aa + bb + 2.0))
}

/// Cosine and sine of a zero of `p cos + q sin + g`; NaN where there is none.
#[inline(always)]
fn zero_of_line<const FUSED: bool>(p: f64, q: f64, g: f64, side: f64) -> (f64, f64) {
    let across = side * ((1.0 - g) * (1.0 + g)).sqrt();
    (
        multiply_add::<FUSED>(-g, p, -across * q),
        multiply_add::<FUSED>(-g, q, across * p),
    )
}

/// True where the zeros of a line, if it has any, are clear of those of the other line, `p cos - q sin + other`, and of the
/// error of W.
#[inline(always)]
fn zeros_stand<const FUSED: bool>(p: f64, q: f64, g: f64, other: f64, error: f64) -> bool {
    let steepness = ((1.0 - g) * (1.0 + g)).max(0.0).sqrt();
    let (c, s) = zero_of_line::<FUSED>(p, q, g, 1.0);
    let one = multiply_add::<FUSED>(p, c, multiply_add::<FUSED>(-q, s, other)).abs();
    let (c, s) = zero_of_line::<FUSED>(p, q, g, -1.0);
    let two = multiply_add::<FUSED>(p, c, multiply_add::<FUSED>(-q, s, other)).abs();
    let least = if one < two { one } else { two };
    (g.abs() > 1.0) | ((least > CROSSING_MARGIN) & (error < ZERO_ERROR * steepness * least))
}
