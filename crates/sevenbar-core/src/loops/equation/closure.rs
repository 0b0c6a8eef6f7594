//! The closure over the complex numbers, eight solutions side by side: its unknowns, and the linear equations of a step.
//!
//! The closure is `Z1 T(p1) Rx(a1) Z2 .. Z7 T(p7) Rx(a7) = 1` with `Zi = Rz(ti) Tz(di)`. In a turning joint `ti` is unknown
//! and `di` is zero; in a sliding one `di` is unknown and `ti` given; in the last joint, the input, both are given. Turns and
//! twists enter as `e^(i t)` and `e^(i a)`, so that everything is rational.
//!
//! Source: docs/theory.md, (6).

use super::lanes::Lanes;
use crate::vectors::{LANES, Reals, Vector};
use num_complex::Complex64;

/// Unknown joints of the closure.
pub(crate) const UNKNOWNS: usize = 6;

/// Its joints: the unknown ones and the input.
pub(crate) const JOINTS: usize = 7;

/// Rows of the elimination are exchanged where an entry is so many times the pivot: seldom in all lanes, and a digit is lost at
/// most.
const EXCHANGED: f64 = 8.0;

/// `|e^(i t)|`, or a slide relative to the size, beyond which a path has left for infinity.
const INFINITE: f64 = 1e7;

/// Parameters of the closure.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Parameters {
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
pub(crate) type Solution<const N: usize = UNKNOWNS> = [Complex64; N];

/// Which joints slide.
pub(crate) type Slides<const N: usize = UNKNOWNS> = [bool; N];

/// The linearised closure in each lane: `J delta = -error`, `J rate = -drift`.
pub(crate) struct Linear<V: Vector, const N: usize = UNKNOWNS> {
    /// J, row by row.
    pub rows: [[Lanes<V>; N]; N],
    /// Minus the closure error, and minus its drift with the parameters.
    pub error: [Lanes<V>; N],
    pub drift: [Lanes<V>; N],
}

pub(crate) type Triple<V> = [Lanes<V>; 3];

#[inline(always)]
pub(crate) fn cross<V: Vector>(a: &Triple<V>, b: &Triple<V>) -> Triple<V> {
    [
        (a[1] * b[2]).minus_product(a[2], b[1]),
        (a[2] * b[0]).minus_product(a[0], b[2]),
        (a[0] * b[1]).minus_product(a[1], b[0]),
    ]
}

/// Turns the frame's axes `a`, `b` by the angle whose cosine and sine are given.
#[inline(always)]
pub(crate) fn turn<V: Vector>(a: &mut Triple<V>, b: &mut Triple<V>, cosine: Lanes<V>, sine: Lanes<V>) {
    for k in 0..3 {
        let (x, y) = (a[k], b[k]);
        a[k] = (x * cosine).plus_product(y, sine);
        b[k] = (y * cosine).minus_product(x, sine);
    }
}

/// Cosine and sine from `e^(i t)`, and its reciprocal.
#[inline(always)]
pub(crate) fn cosine_sine<V: Vector>(z: Lanes<V>) -> (Lanes<V>, Lanes<V>, Lanes<V>) {
    let inverse = z.recip();
    (
        (z + inverse).scale(V::splat(0.5)),
        (inverse - z).times_i().scale(V::splat(0.5)),
        inverse,
    )
}

/// The unknowns after a move.
#[inline(always)]
pub(crate) fn moved<V: Vector, const N: usize>(
    slides: &Slides<N>,
    x: &[Lanes<V>; N],
    by: &[Lanes<V>; N],
) -> [Lanes<V>; N] {
    let mut out = *x;
    for i in 0..N {
        out[i] = if slides[i] {
            x[i] + by[i]
        } else {
            x[i] * by[i].turn()
        };
    }
    out
}

/// The greatest part of a move: [rad], or slides relative to the size or to themselves.
#[inline(always)]
pub(crate) fn size<V: Vector, const N: usize>(
    slides: &Slides<N>,
    x: &[Lanes<V>; N],
    by: &[Lanes<V>; N],
) -> Reals {
    // a sum, so that what is not a number shows
    let mut sum = V::splat(0.0);
    for i in 0..N {
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
pub(crate) fn infinite<V: Vector, const N: usize>(slides: &Slides<N>, x: &[Lanes<V>; N]) -> [bool; LANES] {
    let (mut least, mut greatest) = (V::splat(1.0), V::splat(1.0));
    for i in 0..N {
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

impl<V: Vector, const N: usize> Linear<V, N> {
    /// The Newton correction, the rate with the parameters, and the determinant of the joints' columns, by elimination with row
    /// exchanges in each lane.
    #[inline(always)]
    pub fn solve(mut self) -> ([Lanes<V>; N], [Lanes<V>; N], Lanes<V>) {
        let (a, step, rate) = (&mut self.rows, &mut self.error, &mut self.drift);
        let (one, minus) = (V::splat(1.0), V::splat(-1.0));
        let greater = V::splat(EXCHANGED * EXCHANGED);
        let mut determinant = Lanes::<V>::one();
        let mut sign = one;
        for c in 0..N {
            for r in c + 1..N {
                let (upper, lower) = (a[c][c].square() * greater, a[r][c].square());
                if !lower.exceeds_somewhere(upper) {
                    continue;
                }
                for j in c..N {
                    let (x, y) = (a[c][j], a[r][j]);
                    a[c][j] = x.replaced_where(lower, upper, y);
                    a[r][j] = y.replaced_where(lower, upper, x);
                }
                let (x, y) = (step[c], step[r]);
                step[c] = x.replaced_where(lower, upper, y);
                step[r] = y.replaced_where(lower, upper, x);
                let (x, y) = (rate[c], rate[r]);
                rate[c] = x.replaced_where(lower, upper, y);
                rate[r] = y.replaced_where(lower, upper, x);
                sign = sign * lower.if_greater(upper, minus, one);
            }
            determinant = determinant * a[c][c];
            let inverse = a[c][c].recip();
            for j in c + 1..N {
                a[c][j] = a[c][j] * inverse;
            }
            step[c] = step[c] * inverse;
            rate[c] = rate[c] * inverse;
            for r in c + 1..N {
                let factor = a[r][c];
                for j in c + 1..N {
                    a[r][j] = a[r][j].minus_product(factor, a[c][j]);
                }
                step[r] = step[r].minus_product(factor, step[c]);
                rate[r] = rate[r].minus_product(factor, rate[c]);
            }
        }
        for c in (0..N).rev() {
            for j in c + 1..N {
                step[c] = step[c].minus_product(a[c][j], step[j]);
                rate[c] = rate[c].minus_product(a[c][j], rate[j]);
            }
        }
        (self.error, self.drift, determinant.scale(sign))
    }
}
