//! The family of a planar block: turns and slides of its links, closed by pins, slides and rods, with complex numbers for all its dimensions.
//!
//! A vector `(x, y)` of the plane is the pair `(x + i y, x - i y)`, which a turn `Z = e^(i q)` takes to `(Z v+, v- / Z)`. In a real net the second
//! is the conjugate of the first; in the family both are any numbers. Links are turned and shifted in their plane only, so that none is turned over.
//!
//! Source: docs/theory_nets.md, (11) and (12).

use super::monodromy::{FAR, Family, Known, Starts};
use crate::loops::equation::closure::{Linear, Slides, Solution, UNKNOWNS};
use crate::loops::equation::lanes::Lanes;
use crate::loops::modes::continuation::{Homotopy, ROUNDING};
use crate::random::Random;
use crate::vectors::Vector;
use num_complex::Complex64;
use std::sync::{Arc, LazyLock};

/// A vector `(v+, v-)`, or a number and nothing.
pub(super) type Pair = [Complex64; 2];

/// A vector along a path from the ground to a place on a link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Term {
    /// Which of the family's vectors.
    pub vector: usize,
    /// The turn that carries it; `None` where it rests.
    pub turn: Option<usize>,
    /// The slide along it.
    pub slide: Option<usize>,
    /// Whether it is on the way back to the ground.
    pub back: bool,
}

/// How a chord closes, with the distance d between its places on the two links.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Closes {
    /// `d = 0`, by the vector of the last term.
    Pin,
    /// `d . n = h`: the normal with the turn that carries it, and the height.
    Slide { turn: Option<usize>, normal: usize, height: usize },
    /// `d . d = L^2`, the square in place of a vector.
    Rod { square: usize },
}

/// What closes a cycle: the terms of `d`.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Chord {
    pub closes: Closes,
    pub terms: Vec<Term>,
}

/// The pattern of a block: links and joints, without their dimensions.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct PlanarFamily {
    /// How many turns are unknown; slides are the unknowns after them.
    pub turns: usize,
    /// For each slide the turn of the link along which it goes.
    pub slides: Vec<Option<usize>>,
    /// How many vectors and numbers it has.
    pub vectors: usize,
    /// Those that rest: places on the links at which it hangs.
    pub at_rest: Vec<usize>,
    pub chords: Vec<Chord>,
}

impl PlanarFamily {
    /// Its starts, cached: constants that are computed, not written down.
    pub fn starts(&self) -> Arc<Starts<UNKNOWNS, 2>> {
        static KNOWN: LazyLock<Known<PlanarFamily, UNKNOWNS, 2>> = LazyLock::new(Known::default);
        KNOWN.starts(self)
    }

    /// Whether it has as many rows as unknowns, and no more than are followed.
    pub fn is_square(&self) -> bool {
        let rows = |chord: &Chord| if chord.closes == Closes::Pin { 2 } else { 1 };
        let count: usize = self.chords.iter().map(rows).sum();
        count == self.unknowns() && count <= UNKNOWNS && count > 0
    }

    /// How many unknowns it has.
    pub fn unknowns(&self) -> usize {
        self.turns + self.slides.len()
    }

    /// The sum of terms at a solution.
    pub fn sum(&self, terms: &[Term], member: &[Pair], x: &Solution) -> Pair {
        let mut sum = [Complex64::ZERO; 2];
        for term in terms {
            let turn = term.turn.map_or(Complex64::ONE, |g| x[g]);
            let factor = term.slide.map_or(Complex64::ONE, |s| x[self.turns + s]);
            let factor = if term.back { -factor } else { factor };
            let [plus, minus] = member[term.vector];
            sum[0] += plus * turn * factor;
            sum[1] += minus / turn * factor;
        }
        sum
    }

    /// Changes the numbers that close each chord, so that a solution is one.
    fn close(&self, member: &mut [Pair], x: &Solution) {
        for chord in &self.chords {
            let d = self.sum(&chord.terms, member, x);
            match chord.closes {
                Closes::Pin => {
                    let Some(last) = chord.terms.last() else {
                        continue;
                    };
                    let turn = last.turn.map_or(Complex64::ONE, |g| x[g]);
                    let sign = if last.back { 1.0 } else { -1.0 };
                    member[last.vector][0] += sign * d[0] / turn;
                    member[last.vector][1] += sign * d[1] * turn;
                }
                Closes::Slide { turn, normal, height } => {
                    let turn = turn.map_or(Complex64::ONE, |g| x[g]);
                    let n = member[normal];
                    member[height][0] = 0.5 * (d[0] * n[1] / turn + d[1] * n[0] * turn);
                }
                Closes::Rod { square } => member[square][0] = d[0] * d[1],
            }
        }
    }
}

impl Family<UNKNOWNS, 2> for PlanarFamily {
    type Way = Between;

    fn slides(&self) -> Slides {
        std::array::from_fn(|i| (self.turns..self.unknowns()).contains(&i))
    }

    fn random(&self, random: &mut Random) -> Vec<Pair> {
        (0..self.vectors)
            .map(|_| [random.number(), random.number()])
            .collect()
    }

    fn closed(&self, random: &mut Random) -> (Vec<Pair>, Solution) {
        let mut member = self.random(random);
        let mut x = [Complex64::ONE; UNKNOWNS];
        for (i, x) in x.iter_mut().enumerate().take(self.unknowns()) {
            *x = if i < self.turns {
                random.phase()
            } else {
                random.number()
            };
        }
        self.close(&mut member, &x);
        (member, x)
    }

    fn between(&self, from: &[Pair], to: &[Pair]) -> Between {
        Between::new(self, from, to)
    }

    /// Where what rests goes one way: all such places together, or one of them, or the height of a slide or the square of a rod.
    fn ways_of_constants(&self, random: &mut Random) -> Vec<Vec<Pair>> {
        let still = || vec![[Complex64::ZERO; 2]; self.vectors];
        let mut together = still();
        for &k in &self.at_rest {
            together[k][0] = random.number();
        }
        let mut ways = vec![together];
        let own = self.chords.iter().filter_map(|chord| match chord.closes {
            Closes::Pin => None,
            Closes::Slide { height, .. } => Some(height),
            Closes::Rod { square } => Some(square),
        });
        for k in self.at_rest.iter().copied().chain(own) {
            let mut one = still();
            one[k][0] = random.number();
            ways.push(one);
        }
        ways
    }

    fn traced(&self, x: &Solution) -> Vec<Complex64> {
        x[..self.unknowns()].to_vec()
    }

    /// The others are sums of all unknowns, of turns twice their cosines, with weights.
    fn measures(&self, x: &Solution, determinant: Complex64) -> (Complex64, [Complex64; FAR]) {
        let sum = |by: [f64; UNKNOWNS]| -> Complex64 {
            let own = |i: usize| if i < self.turns { x[i] + x[i].inv() } else { x[i] };
            (0..self.unknowns()).map(|i| own(i) * by[i]).sum()
        };
        (determinant, WEIGHTS.map(sum))
    }

    /// Of the unknown that is farthest from where it began.
    fn far(&self, x: &Solution) -> f64 {
        let slides = self.slides();
        (0..UNKNOWNS).fold(0.0, |most: f64, i| {
            let size = x[i].norm();
            most.max(if slides[i] {
                (1.0 + size).ln()
            } else {
                size.ln().abs()
            })
        })
    }
}

/// What unknowns weigh in sums, each time otherwise.
const WEIGHTS: [[f64; UNKNOWNS]; FAR] = [
    [1.0, 0.6, 1.7, 0.4, 1.3, 0.8],
    [0.2, 3.1, 0.9, 5.0, 0.1, 1.1],
    [4.1, 0.3, 0.15, 1.2, 2.7, 0.08],
];

/// Signs of the exponents of `v+` and `v-`.
const SIGNS: [f64; 2] = [1.0, -1.0];

/// The coefficient that goes with one turn and one slide in d+, d-, n+ or n-, where a way begins and how it changes along it.
#[derive(Clone, Copy, Debug)]
struct Part {
    side: usize,
    turn: Option<usize>,
    slide: Option<usize>,
    from: Complex64,
    rate: Complex64,
}

/// A chord along a way.
#[derive(Clone, Debug)]
struct Moving {
    closes: Closes,
    parts: Vec<Part>,
    /// The height or square, and how it changes.
    number: Pair,
}

/// The members of the family on the straight line from one to another, while the parameter goes from 0 to 1.
pub(super) struct Between {
    slides: Slides,
    turns: usize,
    unknowns: usize,
    chords: Vec<Moving>,
}

impl Between {
    fn new(family: &PlanarFamily, from: &[Pair], to: &[Pair]) -> Self {
        let chord = |chord: &Chord| {
            let mut parts: Vec<Part> = Vec::new();
            let mut add = |side: usize, turn, slide, [from, to]: [Complex64; 2]| {
                let same = |p: &&mut Part| p.side == side && p.turn == turn && p.slide == slide;
                if let Some(part) = parts.iter_mut().find(same) {
                    part.from += from;
                    part.rate += to - from;
                } else {
                    parts.push(Part { side, turn, slide, from, rate: to - from });
                }
            };
            for term in &chord.terms {
                let sign = if term.back { -1.0 } else { 1.0 };
                for s in 0..2 {
                    let ends = [from, to].map(|member| sign * member[term.vector][s]);
                    add(s, term.turn, term.slide, ends);
                }
            }
            let number = |k: usize| [from[k][0], to[k][0] - from[k][0]];
            let number = match chord.closes {
                Closes::Pin => [Complex64::ZERO; 2],
                Closes::Slide { turn, normal, height } => {
                    for s in 0..2 {
                        add(2 + s, turn, None, [from[normal][s], to[normal][s]]);
                    }
                    number(height)
                }
                Closes::Rod { square } => number(square),
            };
            Moving { closes: chord.closes, parts, number }
        };
        Self {
            slides: family.slides(),
            turns: family.turns,
            unknowns: family.unknowns(),
            chords: family.chords.iter().map(chord).collect(),
        }
    }
}

/// A number on the way: its value, its derivatives by the unknowns, and that by the parameter.
#[derive(Clone, Copy)]
struct Half<V> {
    value: Lanes<V>,
    columns: [Lanes<V>; UNKNOWNS],
    drift: Lanes<V>,
}

impl Homotopy for Between {
    #[inline(always)]
    fn slides(&self) -> &Slides {
        &self.slides
    }

    #[inline(always)]
    fn linearise<V: Vector, const DRIFT: bool>(&self, x: &[Lanes<V>; UNKNOWNS], at: Lanes<V>) -> Linear<V> {
        let t = at.re;
        let zero = Lanes::<V>::zero();
        let one = Lanes::<V>::one();
        let half = V::splat(0.5);
        let none = Half::<V> { value: zero, columns: [zero; UNKNOWNS], drift: zero };
        let mut rows = [[zero; UNKNOWNS]; UNKNOWNS];
        let (mut error, mut drift) = ([zero; UNKNOWNS], [zero; UNKNOWNS]);
        let mut turned = [[one; UNKNOWNS]; 2];
        for g in 0..self.turns {
            turned[0][g] = x[g];
            turned[1][g] = x[g].recip();
        }
        let mut r = 0;
        for chord in &self.chords {
            // d+, d-, and those of the normal
            let mut sides = [none; 4];
            for part in &chord.parts {
                let side = &mut sides[part.side];
                let mut rate = Lanes::splat(part.rate);
                let mut value = Lanes::splat(part.from).plus_scaled(rate, t);
                if let Some(g) = part.turn {
                    let z = turned[part.side % 2][g];
                    value = value * z;
                    rate = rate * z;
                }
                if let Some(k) = part.slide {
                    let k = self.turns + k;
                    side.columns[k] = side.columns[k] + value;
                    value = value * x[k];
                    rate = rate * x[k];
                }
                if let Some(g) = part.turn {
                    // the derivative of Z by its angle is i Z, of its inverse -i times that
                    let by = value.times_i().scale(V::splat(SIGNS[part.side % 2]));
                    side.columns[g] = side.columns[g] + by;
                }
                side.value = side.value + value;
                side.drift = side.drift + rate;
            }
            if chord.closes == Closes::Pin {
                for side in &sides[..2] {
                    let unknown = Lanes { re: V::splat(ROUNDING * (r + 1) as f64), im: V::splat(0.0) };
                    for c in 0..self.unknowns {
                        rows[r][c] = side.columns[c];
                    }
                    error[r] = unknown - side.value;
                    drift[r] = -side.drift;
                    r += 1;
                }
                continue;
            }
            // d . n, of a rod d . d
            let (d, n) = sides.split_at(2);
            let n = if matches!(chord.closes, Closes::Rod { .. }) {
                d
            } else {
                n
            };
            let rate = Lanes::splat(chord.number[1]);
            let number = Lanes::splat(chord.number[0]).plus_scaled(rate, t);
            let unknown = Lanes { re: V::splat(ROUNDING * (r + 1) as f64), im: V::splat(0.0) };
            let value = (d[0].value * n[1].value).plus_product(d[1].value, n[0].value);
            for c in 0..self.unknowns {
                rows[r][c] = (d[0].columns[c] * n[1].value)
                    .plus_product(d[0].value, n[1].columns[c])
                    .plus_product(d[1].columns[c], n[0].value)
                    .plus_product(d[1].value, n[0].columns[c])
                    .scale(half);
            }
            let moving = (d[0].drift * n[1].value)
                .plus_product(d[0].value, n[1].drift)
                .plus_product(d[1].drift, n[0].value)
                .plus_product(d[1].value, n[0].drift);
            error[r] = unknown + number - value.scale(half);
            drift[r] = rate - moving.scale(half);
            r += 1;
        }
        // unknowns that it has not rest
        for k in self.unknowns..UNKNOWNS {
            rows[k][k] = one;
        }
        Linear { rows, error, drift }
    }
}
