//! Branch points of the input, by Newton's method on the closure and the determinant of the passive screws.
//!
//! Where that determinant J is zero two solutions meet. It enters by its bordered form, which is as regular as the branch point is.
//! Unknown are the passive joints and the input together, complex.
//!
//! Source: docs/theory_many.md, (15) and (16).

use crate::loops::equation::closure::{Slides, Solution, UNKNOWNS};
use crate::loops::equation::lanes::Lanes;
use crate::loops::modes::circle::{InputClosure, side_by_side};
use crate::loops::modes::continuation::{Homotopy, Place};
use crate::vectors::{LANES, LaneKernel, Reals, Vector, dispatch};
use num_complex::Complex64;

/// Most corrections: where two branch points look like one they halve the distance only.
const MOST_CORRECTIONS: usize = 40;

/// A correction [rad, or relative to the size] after which the next is rounding.
const SETTLED: f64 = 1e-11;

/// The longest correction, and how far all may lead together [rad, or relative to the size].
const LONGEST: f64 = 0.3;
const FARTHEST: f64 = 3.0;

/// The borders are renewed after so many corrections.
const RENEWED: usize = 4;

/// A pivot below this part of the greatest is zero.
const NO_PIVOT: f64 = 1e-9;

type Six = [Complex64; 6];

/// A branch point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Branching {
    /// The input [rad].
    pub tau: Complex64,
    pub at: Solution,
    /// Whether it is a real pose: at a real input two complex ones may meet, too.
    pub real: bool,
}

/// The closure linearised at a solution: `columns q' + input tau' = -error`.
pub(super) struct Local {
    pub columns: [Six; UNKNOWNS],
    pub input: Six,
    pub error: Six,
}

/// The closure at up to eight solutions.
struct Linearise<'a> {
    closure: &'a InputClosure<'a>,
    at: &'a [(Solution, Complex64)],
    out: &'a mut Vec<Local>,
}

impl LaneKernel for Linearise<'_> {
    #[inline(always)]
    fn run<V: Vector>(self) {
        let (x, input) = side_by_side::<V>(self.at);
        let linear = self.closure.linearise::<V, true>(&x, input);
        let stored = |x: Lanes<V>| (x.re.store(), x.im.store());
        let rows = linear.rows.map(|row| row.map(stored));
        let (error, drift) = (linear.error.map(stored), linear.drift.map(stored));
        for k in 0..self.at.len() {
            let get = |x: &(Reals, Reals)| Complex64::new(x.0[k], x.1[k]);
            self.out.push(Local {
                columns: std::array::from_fn(|c| std::array::from_fn(|r| get(&rows[r][c]))),
                input: std::array::from_fn(|r| -get(&drift[r])),
                error: std::array::from_fn(|r| -get(&error[r])),
            });
        }
    }
}

pub(super) fn linearised(closure: &InputClosure, at: &[(Solution, Complex64)]) -> Vec<Local> {
    let mut out = Vec::with_capacity(at.len());
    for block in at.chunks(LANES) {
        dispatch(Linearise { closure, at: block, out: &mut out });
    }
    out
}

/// How many of the solutions, each with its input's `e^(i tau)`, could move with the input at rest.
pub(super) fn still<'a>(
    closure: &InputClosure,
    at: &'a [(Solution, Complex64)],
) -> impl Iterator<Item = bool> + 'a {
    let local = linearised(closure, at);
    local.into_iter().map(|local| {
        let mut a: [[Complex64; 6]; 6] =
            std::array::from_fn(|r| std::array::from_fn(|c| local.columns[c][r]));
        let mut b = [Complex64::ZERO; 6];
        solve(&mut a, &mut b).is_none()
    })
}

/// A branch point that the root law leads to from a place: `|e - e0|` falls with the root of `|tau - tau0|`.
fn foretold(slides: &Slides, place: &Place, local: &Local, tau: Complex64) -> Option<(Solution, Complex64)> {
    let rate = place.rate();
    let mut a: [[Complex64; 6]; 6] = std::array::from_fn(|r| std::array::from_fn(|c| local.columns[c][r]));
    // the trace of the inverse times the screws' rates
    let mut moved = [Complex64::ZERO; 6];
    let mut slope = Complex64::ZERO;
    let inverse = inverted(&mut a)?;
    for (j, column) in local.columns.iter().enumerate() {
        let change = bracket(&moved, column);
        slope += (0..6).map(|k| inverse[j][k] * change[k]).sum::<Complex64>();
        for k in 0..6 {
            moved[k] += column[k] * rate[j];
        }
    }
    let ahead = -0.5 / slope;
    let mut at = *place.solution();
    move_on(slides, &mut at, rate, 2.0 * ahead);
    (ahead.is_finite() && at.iter().all(|z| z.is_finite())).then_some((at, tau + ahead))
}

/// The branch points to which Newton's method leads from places at `tau` whose own branch point is foretold to be wanted.
pub(super) fn branch_points(
    closure: &InputClosure,
    slides: &Slides,
    from: &[(&Place, Complex64)],
    wanted: impl Fn(Complex64) -> bool,
) -> Vec<Branching> {
    let zero = closure.zero();
    let input = |tau: Complex64| zero * (Complex64::I * tau).exp();
    let at: Vec<(Solution, Complex64)> = from
        .iter()
        .map(|(place, tau)| (*place.solution(), input(*tau)))
        .collect();
    linearised(closure, &at)
        .iter()
        .zip(from)
        .filter_map(|(local, (place, tau))| foretold(slides, place, local, *tau))
        .filter(|(_, tau)| wanted(*tau))
        .filter_map(|(at, tau)| newton(closure, slides, at, tau))
        .collect()
}

fn newton(
    closure: &InputClosure,
    slides: &Slides,
    mut at: Solution,
    mut tau: Complex64,
) -> Option<Branching> {
    let zero = closure.zero();
    let general: Six = std::array::from_fn(|k| Complex64::from_polar(1.0, 1.0 + 2.3 * k as f64));
    let (mut right, mut left) = (general, general);
    let mut gone = 0.0;
    for n in 0..MOST_CORRECTIONS {
        let local = linearised(closure, &[(at, zero * (Complex64::I * tau).exp())]).pop()?;
        // (v, g) of the bordered matrix, and w of its transpose
        let mut bordered: [[Complex64; 7]; 7] = std::array::from_fn(|r| {
            std::array::from_fn(|c| match (r, c) {
                (6, 6) => Complex64::ZERO,
                (6, c) => right[c],
                (r, 6) => left[r],
                (r, c) => local.columns[c][r],
            })
        });
        let mut turned: [[Complex64; 7]; 7] =
            std::array::from_fn(|r| std::array::from_fn(|c| bordered[c][r]));
        let unit: [Complex64; 7] =
            std::array::from_fn(|k| if k == 6 { Complex64::ONE } else { Complex64::ZERO });
        let (mut v, mut w) = (unit, unit);
        solve(&mut bordered, &mut v)?;
        solve(&mut turned, &mut w)?;
        let mut system = [[Complex64::ZERO; 7]; 7];
        let mut by = [Complex64::ZERO; 7];
        for r in 0..6 {
            for c in 0..6 {
                system[r][c] = local.columns[c][r];
            }
            system[r][6] = local.input[r];
            by[r] = -local.error[r];
        }
        // a joint carries the screws after it
        let mut carried = [Complex64::ZERO; 6];
        for k in (0..6).rev() {
            let change = bracket(&local.columns[k], &carried);
            system[6][k] = -(0..6).map(|r| w[r] * change[r]).sum::<Complex64>();
            for r in 0..6 {
                carried[r] += local.columns[k][r] * v[k];
            }
        }
        by[6] = -v[6];
        solve(&mut system, &mut by)?;
        let size = by.iter().map(|z| z.norm_sqr()).sum::<f64>().sqrt();
        if !size.is_finite() {
            return None;
        }
        let part = (LONGEST / size).min(1.0);
        gone += size * part;
        if gone > FARTHEST {
            return None;
        }
        let rate: Solution = std::array::from_fn(|k| by[k]);
        move_on(slides, &mut at, &rate, part.into());
        tau += by[6] * part;
        if size < SETTLED {
            return Some(Branching { tau, at, real: false });
        }
        if n % RENEWED == 0 {
            right = unit_conjugate(&v);
            left = unit_conjugate(&w);
        }
    }
    None
}

fn unit_conjugate(v: &[Complex64; 7]) -> Six {
    let length = v[..6].iter().map(|z| z.norm_sqr()).sum::<f64>().sqrt();
    std::array::from_fn(|k| v[k].conj() / length)
}

fn move_on(slides: &Slides, at: &mut Solution, rate: &Solution, by: Complex64) {
    for i in 0..UNKNOWNS {
        if slides[i] {
            at[i] += rate[i] * by;
        } else {
            at[i] *= (Complex64::I * rate[i] * by).exp();
        }
    }
}

/// How the screw `b` changes while its body moves with the twist `a`.
fn bracket(a: &Six, b: &Six) -> Six {
    let cross = |a: &[Complex64], b: &[Complex64], k: usize| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        a[i] * b[j] - a[j] * b[i]
    };
    std::array::from_fn(|k| {
        if k < 3 {
            cross(&a[..3], &b[..3], k)
        } else {
            cross(&a[..3], &b[3..], k - 3) + cross(&a[3..], &b[..3], k - 3)
        }
    })
}

/// Solves `a x = b` in place, by elimination with row exchanges; none where a pivot is zero.
pub(super) fn solve<const N: usize>(a: &mut [[Complex64; N]; N], b: &mut [Complex64; N]) -> Option<()> {
    let mut greatest = 0.0;
    for c in 0..N {
        let row = (c..N).max_by(|&i, &j| a[i][c].norm_sqr().total_cmp(&a[j][c].norm_sqr()))?;
        a.swap(c, row);
        b.swap(c, row);
        let size = a[c][c].norm();
        greatest = f64::max(greatest, size);
        if size.is_nan() || size <= NO_PIVOT * greatest {
            return None;
        }
        let inverse = a[c][c].inv();
        for r in c + 1..N {
            let factor = a[r][c] * inverse;
            for j in c + 1..N {
                let x = a[c][j];
                a[r][j] -= factor * x;
            }
            let x = b[c];
            b[r] -= factor * x;
        }
    }
    for c in (0..N).rev() {
        for j in c + 1..N {
            let x = b[j];
            b[c] -= a[c][j] * x;
        }
        b[c] /= a[c][c];
    }
    Some(())
}

fn inverted(a: &mut [[Complex64; 6]; 6]) -> Option<[[Complex64; 6]; 6]> {
    let mut out = [[Complex64::ZERO; 6]; 6];
    for c in 0..6 {
        let mut b: Six = std::array::from_fn(|r| if r == c { Complex64::ONE } else { Complex64::ZERO });
        solve(&mut a.clone(), &mut b)?;
        for r in 0..6 {
            out[r][c] = b[r];
        }
    }
    Some(out)
}
