//! The family of a link that six rows hold at known links: rods, planes and angles, with complex numbers for all its dimensions.
//!
//! Its pose is a dual quaternion `(x, y)` up to scale: `R v = x v x* / (x . x)`, `p = 2 y x* / (x . x)` with `x . y = 0`, so that all rows are
//! quadrics and a solution at infinity, `x . x = 0`, is a place like any other. One linear equation sets the scale.
//!
//! Source: docs/theory_nets.md, (19) to (21).

use super::dual_quaternions::{Triple, UNKNOWNS, dot, halves, pose, product};
use super::monodromy::{FAR, Family, Known, Starts};
use crate::loops::equation::closure::{Linear, Slides, Solution};
use crate::loops::equation::lanes::Lanes;
use crate::loops::modes::continuation::{Homotopy, Pace, ROUNDING};
use crate::random::Random;
use crate::vectors::Vector;
use num_complex::Complex64;
use std::array::from_fn;
use std::sync::{Arc, LazyLock};

/// Rows that hold a link.
const ROWS: usize = 6;

/// Most steps on one path.
const MOST_STEPS: usize = 4000;

/// How a row holds the link, with a the vector on the known link and b that on the link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Holds {
    /// `|p + R b - a|^2 = L^2`; the number is `|a|^2 + |b|^2 - L^2`.
    Rod,
    /// `a . (p + R b) = h`; the number is -h.
    Plane,
    /// `b . R^-1 (a - p) = h`; the number is -h.
    OwnPlane,
    /// `a . R b = c`; the number is -c.
    Angle,
}

/// A row: its kind, and which of the family's vectors it has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Held {
    pub holds: Holds,
    pub known: usize,
    pub own: usize,
    pub number: usize,
}

/// The pattern of a link's rows, without their dimensions.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct BodyFamily {
    /// How many vectors and numbers it has.
    pub vectors: usize,
    pub rows: Vec<Held>,
}

impl Holds {
    /// The factors of y . y, of y . (x b) and -y . (a x), and of (a x) . (x b) in the row.
    fn factors(self) -> [f64; 4] {
        match self {
            Self::Rod => [4.0, 4.0, 4.0, -2.0],
            Self::Plane => [0.0, 0.0, -2.0, 1.0],
            Self::OwnPlane => [0.0, -2.0, 0.0, 1.0],
            Self::Angle => [0.0, 0.0, 0.0, 1.0],
        }
    }
}

impl BodyFamily {
    /// Its starts, cached: constants that are computed, not written down.
    pub fn starts(&self) -> Arc<Starts<UNKNOWNS, 3>> {
        static KNOWN: LazyLock<Known<BodyFamily, UNKNOWNS, 3>> = LazyLock::new(Known::default);
        KNOWN.starts(self)
    }

    /// What vanishes for a solution at infinity, and is infinite where its measures have poles.
    pub fn at_infinity(&self, z: &Solution<UNKNOWNS>) -> Complex64 {
        let (x, _) = halves(z);
        dot(&x, &x) / weighted(z, &WEIGHTS[0])
    }

    /// Whether it has as many rows as a link has freedoms.
    pub fn is_square(&self) -> bool {
        self.rows.len() == ROWS
    }
}

/// What the squares of a solution's numbers weigh, each time otherwise.
const WEIGHTS: [[f64; UNKNOWNS]; 1 + FAR] = [
    [1.0, 0.6, 1.7, 0.4, 1.3, 0.8, 2.1, 0.5],
    [0.2, 3.1, 0.9, 5.0, 0.1, 1.1, 0.3, 2.4],
    [4.1, 0.3, 0.15, 1.2, 2.7, 0.08, 1.9, 0.6],
    [0.5, 0.12, 6.0, 0.25, 0.07, 3.3, 1.4, 0.9],
];

/// The sum of the squares of a solution's numbers, each with its weight.
fn weighted(z: &Solution<UNKNOWNS>, by: &[f64; UNKNOWNS]) -> Complex64 {
    (0..UNKNOWNS).map(|i| z[i] * z[i] * by[i]).sum()
}

/// What sets the scale: `c . (x, y) = 1`.
static SCALE: LazyLock<Solution<UNKNOWNS>> = LazyLock::new(|| {
    let mut random = Random(0x5ca1e);
    from_fn(|_| random.phase())
});

impl Family<UNKNOWNS, 3> for BodyFamily {
    type Way = Between;

    fn slides(&self) -> Slides<UNKNOWNS> {
        [true; UNKNOWNS]
    }

    fn random(&self, random: &mut Random) -> Vec<Triple> {
        (0..self.vectors).map(|_| from_fn(|_| random.number())).collect()
    }

    fn closed(&self, random: &mut Random) -> (Vec<Triple>, Solution<UNKNOWNS>) {
        let mut member = self.random(random);
        let mut z: Solution<UNKNOWNS> = from_fn(|_| random.phase());
        z[4] = -(z[1] * z[5] + z[2] * z[6] + z[3] * z[7]) / z[0];
        let scale = dot(&SCALE, &z);
        z = z.map(|z| z / scale);
        let (x, y) = halves(&z);
        for row in &self.rows {
            let pure = |v: usize| {
                let [a, b, c] = member[v];
                [Complex64::ZERO, a, b, c]
            };
            let (known, own) = (product(&pure(row.known), &x), product(&x, &pure(row.own)));
            let [squares, on_own, on_known, both] = row.holds.factors();
            let value = dot(&y, &y) * squares + dot(&y, &own) * on_own - dot(&y, &known) * on_known
                + dot(&known, &own) * both;
            member[row.number][0] = -value / dot(&x, &x);
        }
        (member, z)
    }

    fn between(&self, from: &[Triple], to: &[Triple]) -> Between {
        let part = |k: usize| Moving { from: from[k], rate: from_fn(|i| to[k][i] - from[k][i]) };
        let row = |row: &Held| Row {
            factors: row.holds.factors(),
            known: part(row.known),
            own: part(row.own),
            number: part(row.number),
        };
        Between {
            rows: self.rows.iter().map(row).collect(),
            slides: self.slides(),
            scale: *SCALE,
        }
    }

    /// The number of each row.
    fn ways_of_constants(&self, random: &mut Random) -> Vec<Vec<Triple>> {
        let change = |row: &Held| {
            let mut change = vec![[Complex64::ZERO; 3]; self.vectors];
            change[row.number][0] = random.number();
            change
        };
        self.rows.iter().map(change).collect()
    }

    /// Where the axes and the origin are.
    fn traced(&self, z: &Solution<UNKNOWNS>) -> Vec<Complex64> {
        pose(z).concat()
    }

    /// By squares that vanish for no real solution: so neither depends on the scale.
    fn measures(&self, z: &Solution<UNKNOWNS>, determinant: Complex64) -> (Complex64, [Complex64; FAR]) {
        let [first, others @ ..] = WEIGHTS.each_ref().map(|by| weighted(z, by));
        // the determinant goes with the sixth power of the scale
        (determinant / first.powu(3), others.map(|other| other / first))
    }

    fn far(&self, z: &Solution<UNKNOWNS>) -> f64 {
        let (x, _) = halves(z);
        let size: f64 = z.iter().map(Complex64::norm_sqr).sum();
        (size / dot(&x, &x).norm()).ln()
    }
}

/// A vector or a number where a way begins, and how it changes along it.
#[derive(Clone, Copy)]
struct Moving {
    from: Triple,
    rate: Triple,
}

impl Moving {
    /// As it is now, and its rate.
    #[inline(always)]
    fn at<V: Vector>(&self, t: V) -> [[Lanes<V>; 3]; 2] {
        let mut out = [[Lanes::zero(); 3]; 2];
        for i in 0..3 {
            out[1][i] = Lanes::splat(self.rate[i]);
            out[0][i] = Lanes::splat(self.from[i]).plus_scaled(out[1][i], t);
        }
        out
    }
}

/// A row along a way.
struct Row {
    factors: [f64; 4],
    known: Moving,
    own: Moving,
    number: Moving,
}

/// The members of the family on the straight line from one to another, while the parameter goes from 0 to 1.
pub(super) struct Between {
    rows: Vec<Row>,
    slides: Slides<UNKNOWNS>,
    scale: Solution<UNKNOWNS>,
}

type Four<V> = [Lanes<V>; 4];

/// `a x` of a vector and a quaternion.
#[inline(always)]
fn before<V: Vector>(a: &[Lanes<V>; 3], x: &Four<V>) -> Four<V> {
    [
        -(a[0] * x[1]).plus_product(a[1], x[2]).plus_product(a[2], x[3]),
        (a[0] * x[0]).plus_product(a[1], x[3]).minus_product(a[2], x[2]),
        (a[1] * x[0]).plus_product(a[2], x[1]).minus_product(a[0], x[3]),
        (a[2] * x[0]).plus_product(a[0], x[2]).minus_product(a[1], x[1]),
    ]
}

/// `x b`
#[inline(always)]
fn behind<V: Vector>(x: &Four<V>, b: &[Lanes<V>; 3]) -> Four<V> {
    [
        -(b[0] * x[1]).plus_product(b[1], x[2]).plus_product(b[2], x[3]),
        (b[0] * x[0]).plus_product(b[2], x[2]).minus_product(b[1], x[3]),
        (b[1] * x[0]).plus_product(b[0], x[3]).minus_product(b[2], x[1]),
        (b[2] * x[0]).plus_product(b[1], x[1]).minus_product(b[0], x[2]),
    ]
}

#[inline(always)]
fn inner<V: Vector>(a: &Four<V>, b: &Four<V>) -> Lanes<V> {
    (a[0] * b[0])
        .plus_product(a[1], b[1])
        .plus_product(a[2], b[2])
        .plus_product(a[3], b[3])
}

impl Homotopy<UNKNOWNS> for Between {
    #[inline(always)]
    fn slides(&self) -> &Slides<UNKNOWNS> {
        &self.slides
    }

    /// Paths to infinity are followed to their ends, where solutions meet.
    fn most_steps(&self, _pace: Pace) -> usize {
        MOST_STEPS
    }

    #[inline(always)]
    fn linearise<V: Vector, const DRIFT: bool>(
        &self,
        z: &[Lanes<V>; UNKNOWNS],
        at: Lanes<V>,
    ) -> Linear<V, UNKNOWNS> {
        let zero = Lanes::<V>::zero();
        let mut linear = Linear {
            rows: [[zero; UNKNOWNS]; UNKNOWNS],
            error: [zero; UNKNOWNS],
            drift: [zero; UNKNOWNS],
        };
        let (x, y) = ([z[0], z[1], z[2], z[3]], [z[4], z[5], z[6], z[7]]);
        let square = inner(&x, &x);
        for (r, row) in self.rows.iter().enumerate().take(ROWS) {
            let [a, a_rate] = row.known.at(at.re);
            let [b, b_rate] = row.own.at(at.re);
            let [[number, ..], [number_rate, ..]] = row.number.at(at.re);
            let [squares, on_own, on_known, both] = row.factors;
            let (squares, both) = (V::splat(squares), V::splat(both));
            let (on_own, on_known) = (V::splat(on_own), V::splat(on_known));
            let (ax, xb) = (before(&a, &x), behind(&x, &b));
            let (ay, yb, axb) = (before(&a, &y), behind(&y, &b), behind(&ax, &b));
            let two = V::splat(2.0);
            // a quadratic form is half its gradient times its place
            let mut twice = zero;
            for i in 0..4 {
                let by_y = y[i]
                    .scale(two * squares)
                    .plus_scaled(xb[i], on_own)
                    .plus_scaled(ax[i], -on_known);
                let by_x = (number * x[i])
                    .plus_scaled(axb[i], -both)
                    .scale(two)
                    .plus_scaled(yb[i], -on_own)
                    .plus_scaled(ay[i], on_known);
                linear.rows[r][i] = by_x;
                linear.rows[r][i + 4] = by_y;
                twice = twice.plus_product(by_x, x[i]).plus_product(by_y, y[i]);
            }
            let unknown = Lanes { re: V::splat(ROUNDING * (r + 1) as f64), im: V::splat(0.0) };
            linear.error[r] = unknown - twice.scale(V::splat(0.5));
            if DRIFT {
                let (ax_rate, xb_rate) = (before(&a_rate, &x), behind(&x, &b_rate));
                let turned = inner(&ax_rate, &xb) + inner(&ax, &xb_rate);
                linear.drift[r] = -(number_rate * square)
                    .plus_scaled(inner(&y, &xb_rate), on_own)
                    .plus_scaled(inner(&y, &ax_rate), -on_known)
                    .plus_scaled(turned, both);
            }
        }
        let mut scaled = -Lanes::<V>::one();
        linear.rows[ROWS] = [y[0], y[1], y[2], y[3], x[0], x[1], x[2], x[3]];
        for i in 0..UNKNOWNS {
            let c = Lanes::splat(self.scale[i]);
            linear.rows[ROWS + 1][i] = c;
            scaled = scaled.plus_product(c, z[i]);
        }
        linear.error[ROWS] = -inner(&x, &y);
        linear.error[ROWS + 1] = -scaled;
        linear
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows each with vectors of its own.
    fn apart(holds: [Holds; ROWS]) -> BodyFamily {
        let row =
            |(r, holds): (usize, Holds)| Held { holds, known: 3 * r, own: 3 * r + 1, number: 3 * r + 2 };
        BodyFamily {
            vectors: 3 * ROWS,
            rows: holds.into_iter().enumerate().map(row).collect(),
        }
    }

    #[test]
    fn a_general_member_has_as_many_solutions_as_theory_says() {
        use Holds::{Plane, Rod};
        for family in [apart([Rod; 6]), apart([Rod, Rod, Rod, Rod, Rod, Plane])] {
            let starts = family.starts();
            assert_eq!(starts.starts.each_ref().map(|s| s.solutions.len()), [40; 2]);
            assert!(starts.certified);
        }
    }

    /// A real platform as drawn: six places on the ground and six on the link, with rods between them.
    fn platform(known: [[f64; 3]; ROWS], own: [[f64; 3]; ROWS]) -> Vec<Triple> {
        let square = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>();
        let rod = |(a, b): ([f64; 3], [f64; 3])| {
            let apart = from_fn(|i| a[i] - b[i]);
            let number = square(a) + square(b) - square(apart);
            [a, b, [number, 0.0, 0.0]].map(|v| v.map(Complex64::from))
        };
        known.into_iter().zip(own).flat_map(rod).collect()
    }

    #[test]
    fn random_platforms_have_forty_poses_each() {
        let family = apart([Holds::Rod; ROWS]);
        let mut random = Random(11);
        let mut place = |height: f64| {
            from_fn(|_| {
                let mut own = || 2.0 * random.uniform() - 1.0;
                [own(), own(), height + 0.3 * own()]
            })
        };
        let starts = family.starts();
        for n in 0..1000 {
            let ends = starts.ends(&family, &platform(place(0.0), place(1.0)));
            assert_eq!((ends.regular.len(), ends.left_over), (40, 0), "{n}");
        }
    }

    #[test]
    fn special_platforms_have_as_many_as_theory_says_and_the_others_are_at_infinity() {
        let round = |radius: f64, turned: f64, height: f64, shared: bool| {
            from_fn(|k| {
                let corner = if shared { 2 * (k / 2) } else { k };
                let wide = if shared || k % 2 == 0 { 0.0 } else { 0.3 };
                let angle = turned + corner as f64 * std::f64::consts::FRAC_PI_3 + wide;
                [radius * angle.cos(), radius * angle.sin(), height]
            })
        };
        let family = apart([Holds::Rod; ROWS]);
        let starts = family.starts();
        let any_in_a_plane = |seed| {
            let mut random = Random(seed);
            from_fn(|_| [random.uniform(), random.uniform(), (seed % 2) as f64])
        };
        let shifted = |mut places: [[f64; 3]; ROWS]| {
            places.rotate_left(1);
            places
        };
        let cases = [
            ("in two planes", any_in_a_plane(4), any_in_a_plane(7), 40),
            ("on a triangle", any_in_a_plane(4), round(0.6, 0.2, 1.1, true), 16),
            (
                "two triangles",
                round(1.0, 0.0, 0.0, true),
                shifted(round(0.6, 0.2, 1.1, true)),
                16,
            ),
        ];
        for (name, known, own, count) in cases {
            let ends = starts.ends(&family, &platform(known, own));
            assert_eq!((ends.regular.len(), ends.left_over), (count, 0), "{name}");
        }
    }

    #[test]
    fn three_legs_that_turn_each_a_plane_and_a_rod_at_one_place_have_sixteen() {
        let rows = (0..3).flat_map(|leg| {
            let first = 6 * leg;
            let row =
                |holds, k: usize| Held { holds, known: first + k, own: first + 4, number: first + k + 1 };
            [row(Holds::Plane, 0), row(Holds::Rod, 2)]
        });
        let family = BodyFamily { vectors: 18, rows: rows.collect() };
        let starts = family.starts();
        assert_eq!(starts.starts.each_ref().map(|s| s.solutions.len()), [16; 2]);
    }

    #[test]
    fn an_upright_on_a_ball_a_leg_and_a_rod() {
        let row = |holds, known, own, number| Held { holds, known, own, number };
        let mut rows: Vec<Held> = (0..3).map(|k| row(Holds::OwnPlane, 0, 1 + k, 4 + k)).collect();
        rows.push(row(Holds::Plane, 7, 8, 9));
        rows.push(row(Holds::Rod, 10, 8, 11));
        rows.push(row(Holds::Rod, 12, 13, 14));
        let family = BodyFamily { vectors: 15, rows };
        let starts = family.starts();
        assert_eq!(starts.starts.each_ref().map(|s| s.solutions.len()), [4; 2]);
        assert!(starts.certified);
    }

    #[test]
    fn a_plane_joint_with_three_rods_is_certain_from_either_side() {
        let row = |holds, known, own, number| Held { holds, known, own, number };
        for holds in [Holds::Plane, Holds::OwnPlane] {
            // the normal is one vector of all three rows
            let (known, own) = if holds == Holds::Plane {
                ([0, 0, 0], [1, 2, 3])
            } else {
                ([1, 2, 3], [0, 0, 0])
            };
            let mut rows = vec![
                row(holds, known[0], own[0], 4),
                row(Holds::Angle, known[1], own[1], 5),
                row(Holds::Angle, known[2], own[2], 6),
            ];
            rows.extend((7..16).step_by(3).map(|k| row(Holds::Rod, k, k + 1, k + 2)));
            let starts = BodyFamily { vectors: 16, rows }.starts();
            assert_eq!(starts.starts.each_ref().map(|s| s.solutions.len()), [12; 2]);
            assert!(starts.certified);
        }
    }
}
