//! Where solutions of a general loop of seven turning joints run to infinity, in closed form.
//!
//! There two joints three places apart in the loop become infinite together. As dual two by two matrices the chain between them
//! must lose an entry, which is a quadratic equation for its two joints, and another gives the three joints on the other side.
//! So each pair of joints has sixteen such points, at which the input is known.
//!
//! Source: docs/theory_many.md, (17) and (18).

use crate::loops::equation::closure::{JOINTS, Parameters, Slides, UNKNOWNS};
use num_complex::Complex64;
use std::ops::{Add, Mul};

/// Below this part of its terms a number that special geometry makes zero counts as zero; what is nearer to it is worked out in
/// the way that holds for special geometry, too.
const SPECIAL: f64 = 1e-6;

/// A dual number `a + e b`, `e^2 = 0`.
#[derive(Clone, Copy)]
struct Dual {
    real: Complex64,
    dual: Complex64,
}

/// A rigid motion: a unit dual quaternion as a matrix, turns about z being diagonal.
type Motion = [[Dual; 2]; 2];

/// `a00 + a10 u + a01 v + a11 u v`
type Bilinear = [[Complex64; 2]; 2];

impl Mul for Dual {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        Self {
            real: self.real * b.real,
            dual: self.real * b.dual + self.dual * b.real,
        }
    }
}

impl Add for Dual {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        Self { real: self.real + b.real, dual: self.dual + b.dual }
    }
}

impl Dual {
    /// The dual part of its logarithm.
    fn advance(self) -> Complex64 {
        self.dual / self.real
    }
}

/// The transform after a joint.
fn transform(parameters: &Parameters, joint: usize) -> Motion {
    let i = Complex64::I;
    let half = parameters.twists[joint].sqrt();
    let (c, s) = ((half + half.inv()) * 0.5, (half - half.inv()) * (-0.5 * i));
    let turn = [[c, -i * s], [-i * s, c]];
    let [x, y, z] = parameters.shifts[joint];
    let shift = [[-i * z, -i * x - y], [-i * x + y, i * z]];
    std::array::from_fn(|r| {
        std::array::from_fn(|k| Dual {
            real: turn[r][k],
            dual: (shift[r][0] * turn[0][k] + shift[r][1] * turn[1][k]) * 0.5,
        })
    })
}

/// The values of the last joint, the input, at which solutions with finite input run to infinity, as its turn `z` stands in the
/// parameters; none where the geometry is special.
pub(super) fn poles(parameters: &Parameters) -> Option<Vec<Complex64>> {
    let links: [Motion; JOINTS] = std::array::from_fn(|k| transform(parameters, k));
    let link = |k: usize| &links[k % JOINTS];
    for k in 0..JOINTS {
        if is_special(link(k), link(k + 1)) {
            return None;
        }
    }
    let mut found = Vec::with_capacity(80);
    for j in (0..UNKNOWNS).filter(|j| (j + 3) % JOINTS != UNKNOWNS) {
        for (row, column) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let between = |row: usize, column: usize| entry((link(j), link(j + 1), link(j + 2)), row, column);
            let lost = between(row, column);
            let kept = between(row, 1 - column);
            let around = [0, 1].map(|to| entry((link(j + 3), link(j + 4), link(j + 5)), column, to));
            let last = link(j + 6);
            for (p, q) in common_zeros(&part(&lost, false), &part(&lost, true))? {
                let advance = value(&kept, p, q).advance();
                let conditions: [Bilinear; 2] = std::array::from_fn(|to| {
                    let wanted = advance + last[1 - to][row].advance();
                    let (real, dual) = (part(&around[to], false), part(&around[to], true));
                    std::array::from_fn(|m| std::array::from_fn(|n| dual[m][n] - wanted * real[m][n]))
                });
                for (r, s) in common_zeros(&conditions[0], &conditions[1])? {
                    let t = -(value(&around[0], r, s).real * last[0][row].real)
                        / (value(&around[1], r, s).real * last[1][row].real);
                    // the joints in order from the one after j, which and whose third are infinite
                    let turns = [p, q, Complex64::ZERO, r, s, t];
                    let input = turns[(UNKNOWNS + JOINTS - j - 1) % JOINTS];
                    if !(input.is_finite() && input.norm() > 0.0) {
                        return None;
                    }
                    found.push(input);
                }
            }
        }
    }
    Some(found)
}

/// The first of three passive joints in a row that neither become infinite nor move alone, the others at rest: where solutions run to
/// infinity, or move with the input at rest, another joint does so, too. `None` where special geometry leaves no such three.
pub(super) fn unwatched_three(parameters: &Parameters, slides: &Slides) -> Option<usize> {
    let links: [Motion; JOINTS] = std::array::from_fn(|k| transform(parameters, k));
    (0..UNKNOWNS - 2).find(|&j| !slides[j..j + 3].contains(&true) && !is_special(&links[j], &links[j + 1]))
}

/// Whether two transforms with a joint between let the joints before and after become infinite, or one does.
fn is_special(a: &Motion, b: &Motion) -> bool {
    let small = |x: Complex64, of: f64| x.norm() <= SPECIAL * of;
    let flat = a.iter().flatten().any(|x| small(x.real, 1.0));
    flat || (0..2).any(|r| {
        (0..2).any(|c| {
            let (x, y) = (a[r][0] * b[0][c], a[r][1] * b[1][c]);
            let (p, q) = (x.real * y.dual, y.real * x.dual);
            small(p - q, p.norm().max(q.norm()).max(x.real.norm() * y.real.norm()))
        })
    })
}

/// An entry of three transforms with a joint between each two, by `e^(i t)` of these.
fn entry((a, b, c): (&Motion, &Motion, &Motion), row: usize, column: usize) -> [[Dual; 2]; 2] {
    std::array::from_fn(|m| std::array::from_fn(|n| a[row][m] * b[m][n] * c[n][column]))
}

fn part(entry: &[[Dual; 2]; 2], dual: bool) -> Bilinear {
    entry.map(|row| row.map(|x| if dual { x.dual } else { x.real }))
}

fn value(entry: &[[Dual; 2]; 2], u: Complex64, v: Complex64) -> Dual {
    let real = |z: Complex64| Dual { real: z, dual: Complex64::ZERO };
    let row = |m: usize| entry[m][0] + entry[m][1] * real(v);
    row(0) + row(1) * real(u)
}

/// The two common zeros of two bilinear forms; none where one is missing or both are one.
fn common_zeros(f: &Bilinear, g: &Bilinear) -> Option<[(Complex64, Complex64); 2]> {
    // both give v by u
    let product = |a: Complex64, b: Complex64, c: Complex64, d: Complex64| {
        let (x, y) = (a * b, c * d);
        (x - y, x.norm().max(y.norm()))
    };
    let (c0, s0) = product(f[0][0], g[0][1], g[0][0], f[0][1]);
    let (c2, s2) = product(f[1][0], g[1][1], g[1][0], f[1][1]);
    let (x, sx) = product(f[0][0], g[1][1], g[0][0], f[1][1]);
    let (y, sy) = product(f[1][0], g[0][1], g[1][0], f[0][1]);
    let c1 = x + y;
    if c0.norm() <= SPECIAL * s0 || c2.norm() <= SPECIAL * s2 {
        return None;
    }
    let root = (c1 * c1 - 4.0 * c0 * c2).sqrt();
    if root.norm() <= SPECIAL * (sx + sy) {
        return None;
    }
    let far = if (c1.conj() * root).re < 0.0 {
        c1 - root
    } else {
        c1 + root
    };
    let zeros = [-2.0 * c0 / far, -far / (2.0 * c2)];
    let pair = |u: Complex64| {
        let (above, below) = (f[0][0] + f[1][0] * u, f[0][1] + f[1][1] * u);
        let (other, under) = (g[0][0] + g[1][0] * u, g[0][1] + g[1][1] * u);
        (
            u,
            if below.norm() > under.norm() {
                -above / below
            } else {
                -other / under
            },
        )
    };
    Some(zeros.map(pair))
}

#[cfg(test)]
mod tests {
    use super::super::starts::general_parameters;
    use super::*;
    use crate::random::Random;

    #[test]
    fn a_general_loop_has_eighty_poles_the_sixteen_between_two_near_joints_in_pairs() {
        let parameters = general_parameters(&mut Random(7));
        let found = poles(&parameters).unwrap();
        assert_eq!(found.len(), 80);
        let twins = |a: &Complex64| found.iter().filter(|b| (a / *b - 1.0).norm() < 1e-9).count();
        let paired = found.iter().filter(|a| twins(a) == 2).count();
        assert_eq!(found.iter().filter(|a| twins(a) == 1).count() + paired, 80);
        assert_eq!(paired, 32);
    }
}
