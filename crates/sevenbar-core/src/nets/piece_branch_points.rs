//! The functions by which branch points of any net are counted: inputs at which two solutions of one of its pieces meet.
//!
//! With complex inputs every piece has all of its solutions, so what vanishes where two meet, multiplied over the ways of those before it, is one
//! function of the input.
//!
//! Source: docs/theory_nets.md, (29).

use super::branch_ranges::{Counted, FUNCTIONS, Functions, Inputs, SUMS, Values, turned};
use super::complex_known::{Held, Known, Own, Solved};
use super::complex_pieces::{Piece, Solver};
use super::modes::Part;
use super::monodromy::{FAR, REAL};
use super::net::Net;
use num_complex::Complex64;
use std::cell::RefCell;

/// A complex input at which solutions are found first.
const FIRST: Complex64 = Complex64::new(0.713, 0.31);

/// Most solutions of all ways of all pieces.
const MOST_SOLUTIONS: usize = 400;

/// A link whose pose has smaller imaginary parts may be where a real one is [relative to the size].
const NEARLY_REAL: f64 = 1e-3;

/// Solutions that are farther apart [relative to the size] do not meet within a millionth of a radian.
const NEAR: f64 = 0.03;

/// Two solutions are real, or each the conjugate of the other, if what is imaginary of their difference, or real, is a smaller part of it.
const CLEAR: f64 = 0.01;

/// The solution that was selected of a piece, in one of its ways.
#[derive(Clone, Copy)]
struct Selected {
    piece: usize,
    way: usize,
    solution: usize,
}

/// One way of all pieces before one on which that depends.
type Way = Vec<Selected>;

/// A piece with the ways of those before it.
struct Placed<'a> {
    solver: Solver<'a>,
    links: Vec<usize>,
    /// The pieces on which it depends, in order.
    before: Vec<usize>,
    ways: Vec<Way>,
    /// Which functions it has, if it has any, and which sums.
    functions: Option<usize>,
    sums: Option<usize>,
    /// Whether others hang at it.
    carries: bool,
    /// Where the two solutions in closed form were last, in each way.
    last: RefCell<Vec<Vec<Own>>>,
}

/// The pieces of a net.
struct Pieces<'a> {
    held: Held<'a>,
    placed: Vec<Placed<'a>>,
    /// The functions of those at which nothing hangs, if they are not all.
    last: Vec<usize>,
}

/// Two solutions of a piece that are near to each other, the one of them, and whether both are real.
struct Pair {
    piece: usize,
    own: Own,
    is_real: bool,
}

/// The account of the branch points of an input of a net; `None` where not all of its solutions are known over the complex numbers.
pub(super) fn counted(net: &Net, parts: &[Part], driven: usize, inputs: Inputs) -> Option<Counted> {
    let held = Held { net, driven, inputs };
    Some(Counted::of(&Pieces::of(held, parts)?, inputs))
}

impl Placed<'_> {
    /// Lists two solutions of a root in the order of those that were last: a root is taken with either sign.
    fn keep_in_order(&self, way: usize, solutions: &mut [Own]) {
        if self.sums.is_some() || solutions.len() != 2 {
            return;
        }
        let mut last = self.last.borrow_mut();
        match last.get_mut(way) {
            Some(last) => {
                let apart = |k: usize, j: usize| distance(&solutions[k], &last[j]);
                if apart(0, 1) + apart(1, 0) < apart(0, 0) + apart(1, 1) {
                    solutions.swap(0, 1);
                }
                last.clone_from_slice(solutions);
            }
            None => last.push(solutions.to_vec()),
        }
    }
}

/// By how much the links of two solutions differ in all numbers of their poses.
fn differences<'a>(a: &'a Own, b: &'a Own) -> impl Iterator<Item = Complex64> + 'a {
    a.iter().zip(b).flat_map(|((_, a), (_, b))| {
        let turned = a.rotation.iter().flatten().zip(b.rotation.iter().flatten());
        let all = turned.chain(a.translation.iter().zip(&b.translation));
        all.map(|(a, b)| a - b)
    })
}

/// How far apart two solutions are, all together, and in their real and imaginary parts.
fn distance(a: &Own, b: &Own) -> f64 {
    differences(a, b).map(Complex64::norm).sum()
}

fn apart(a: &Own, b: &Own) -> [f64; 2] {
    let add = |[re, im]: [f64; 2], by: Complex64| [re + by.re.abs(), im + by.im.abs()];
    differences(a, b).fold([0.0; 2], add)
}

impl<'a> Pieces<'a> {
    fn of(held: Held<'a>, parts: &'a [Part]) -> Option<Self> {
        let pieces = Piece::all(&held, parts)?;
        let carries = |k: usize| {
            let mut after = pieces[k + 1..].iter();
            after.any(|later| later.at.iter().any(|on| pieces[k].links.contains(on)))
        };
        let carries: Vec<bool> = (0..pieces.len()).map(carries).collect();
        let known = held.known(FIRST);
        let mut own = Self { held, placed: Vec::new(), last: Vec::new() };
        let (mut solved, mut functions, mut sums, mut count) = (Vec::new(), 0, 0, 0);
        for (piece, carries) in pieces.iter().zip(carries) {
            // a leg that carries nothing is where it is
            if piece.is_single() && !carries {
                continue;
            }
            let before = own.before(piece)?;
            let ways = own.ways(&before, &solved);
            let first = own.known(&known, &ways[0], &solved);
            let solver = piece.solver(&held, &first, before.is_empty())?;
            let (has_functions, is_member) = (solver.has_functions(), solver.is_member());
            let k = own.placed.len();
            own.placed.push(Placed {
                solver,
                links: piece.links.clone(),
                before,
                ways,
                functions: has_functions.then_some(functions),
                sums: is_member.then_some(sums),
                carries,
                last: RefCell::default(),
            });
            functions += if has_functions { 2 } else { 0 };
            sums += if is_member { FAR } else { 0 };
            if functions > FUNCTIONS || sums > SUMS {
                return None;
            }
            let results = own.solved(k, &known, &solved)?;
            count += results.iter().map(|all| all.solutions.len()).sum::<usize>();
            if count > MOST_SOLUTIONS || !results.iter().all(Solved::is_regular) {
                return None;
            }
            solved.push(results);
        }
        let last = own
            .placed
            .iter()
            .filter(|placed| !placed.carries && !placed.before.is_empty());
        own.last = last.filter_map(|placed| placed.functions).collect();
        Some(own)
    }

    /// The pieces on which one depends; `None` where a link at which it hangs is not placed.
    fn before(&self, piece: &Piece) -> Option<Vec<usize>> {
        let mut before = Vec::new();
        for on in &piece.at {
            match self.placed.iter().position(|placed| placed.links.contains(on)) {
                Some(k) => before.extend(self.placed[k].before.iter().copied().chain([k])),
                None if self.held.is_driven(*on) => (),
                None => return None,
            }
        }
        before.sort_unstable();
        before.dedup();
        Some(before)
    }

    /// All ways of some pieces, each with all on which it depends.
    fn ways(&self, before: &[usize], solved: &[Vec<Solved>]) -> Vec<Way> {
        let mut ways = vec![Way::new()];
        for &piece in before {
            let longer = ways.iter().flat_map(|way| {
                let earlier: Vec<[usize; 2]> = way
                    .iter()
                    .filter(|selected| self.placed[piece].before.contains(&selected.piece))
                    .map(|selected| [selected.piece, selected.solution])
                    .collect();
                let is_own = |other: &Way| {
                    other
                        .iter()
                        .map(|s| [s.piece, s.solution])
                        .eq(earlier.iter().copied())
                };
                let at = self.placed[piece]
                    .ways
                    .iter()
                    .position(is_own)
                    .unwrap_or_default();
                (0..solved[piece][at].solutions.len()).map(move |solution| {
                    let mut next = way.clone();
                    next.push(Selected { piece, way: at, solution });
                    next
                })
            });
            ways = longer.collect();
        }
        ways
    }

    /// What is known in one way.
    fn known(&self, first: &Known, way: &Way, solved: &[Vec<Solved>]) -> Known {
        let mut known = first.clone();
        for selected in way {
            let steps = &solved[selected.piece][selected.way].solutions[selected.solution];
            for (step, pose) in steps {
                known.poses[*step] = *pose;
            }
        }
        known
    }

    /// The solutions of a piece in all of its ways.
    fn solved(&self, k: usize, first: &Known, solved: &[Vec<Solved>]) -> Option<Vec<Solved>> {
        let placed = &self.placed[k];
        let ways = placed.ways.iter().enumerate();
        let all = ways.map(|(n, way)| {
            let known = self.known(first, way, solved);
            let mut all = placed.solver.solved(&self.held, &known, n)?;
            placed.keep_in_order(n, &mut all.solutions);
            Some(all)
        });
        all.collect()
    }

    /// Whether the poses of a way are real to this [relative to the size].
    fn is_real(&self, way: &Way, solved: &[Vec<Solved>], part: f64) -> bool {
        way.iter().all(|selected| {
            let steps = &solved[selected.piece][selected.way].solutions[selected.solution];
            steps.iter().all(|(_, pose)| self.held.is_nearly_real(pose, part))
        })
    }

    /// The pairs of these pieces that might be real at an input; `None` where it is not known whether one is.
    fn near_pairs(&self, input: f64, of: &[bool; FUNCTIONS]) -> Option<Vec<Pair>> {
        let solved = self.all(input.into())?;
        let mut pairs = Vec::new();
        let is_near_real = |own: &Own| own.iter().all(|(_, pose)| self.held.is_nearly_real(pose, NEAR));
        for (piece, (placed, all)) in self.placed.iter().zip(&solved).enumerate() {
            if !placed.functions.is_some_and(|k| of[k]) {
                continue;
            }
            let real_ways = placed
                .ways
                .iter()
                .zip(all)
                .filter(|(way, _)| self.is_real(way, &solved, NEARLY_REAL));
            for (_, Solved { solutions, .. }) in real_ways {
                for (k, one) in solutions.iter().enumerate().filter(|(_, one)| is_near_real(one)) {
                    for other in solutions[k + 1..]
                        .iter()
                        .filter(|other| self.held.are_near(one, other, NEAR))
                    {
                        let [re, im] = apart(one, other);
                        let is_real = if im < CLEAR * re {
                            true
                        } else if re < CLEAR * im {
                            false
                        } else {
                            return None;
                        };
                        pairs.push(Pair { piece, own: one.clone(), is_real });
                    }
                }
            }
        }
        Some(pairs)
    }

    /// The solutions of all pieces.
    fn all(&self, at: Complex64) -> Option<Vec<Vec<Solved>>> {
        let first = self.held.known(at);
        let mut solved: Vec<Vec<Solved>> = Vec::new();
        for k in 0..self.placed.len() {
            let piece = self.solved(k, &first, &solved)?;
            solved.push(piece);
        }
        Some(solved)
    }
}

impl Functions for Pieces<'_> {
    /// The products of both functions over the ways, of each piece, and its sums.
    fn values(&self, at: Complex64) -> Option<Values> {
        let solved = self.all(at)?;
        let mut values = Values::NONE;
        for (placed, all) in self.placed.iter().zip(&solved) {
            for own in all {
                if let Some(k) = placed.functions {
                    values.phases[k] = turned(values.phases[k], own.meets);
                    if placed.carries {
                        values.phases[k + 1] = turned(values.phases[k + 1], own.finite);
                    }
                }
                if let Some(k) = placed.sums {
                    for (sum, far) in values.sums[k..k + FAR].iter_mut().zip(own.sums) {
                        *sum += far;
                    }
                }
            }
        }
        Some(values)
    }

    fn last(&self) -> &[usize] {
        &self.last
    }

    fn factors(&self, at: Complex64) -> Option<Vec<(Complex64, bool)>> {
        let restarts = || -> usize { self.placed.iter().map(|placed| placed.solver.restarts()).sum() };
        let before = restarts();
        let solved = self.all(at)?;
        if restarts() > before {
            return None;
        }
        let is_last = |placed: &Placed| placed.functions.is_some_and(|k| self.last.contains(&k));
        // those of the others turn steadily, too, so that their solutions stay in order
        let factors = self.placed.iter().zip(&solved).flat_map(|(placed, all)| {
            let ways = placed.ways.iter().zip(all);
            ways.map(|(way, own)| (own.meets, is_last(placed) && self.is_real(way, &solved, REAL)))
        });
        Some(factors.collect())
    }

    /// Of pairs that are near to each other at both inputs, and real at one of them.
    fn meeting(&self, ends: [f64; 2], of: &[bool; FUNCTIONS]) -> Option<usize> {
        let [first, last] = ends.map(|input| self.near_pairs(input, of));
        let (first, last) = (first?, last?);
        let meets = |pair: &Pair| {
            let mut same = last
                .iter()
                .filter(|other| other.piece == pair.piece && self.held.are_near(&other.own, &pair.own, NEAR));
            let other = same.next()?;
            (same.next().is_none() && other.is_real != pair.is_real).then_some(())
        };
        let all: Option<Vec<()>> = first.iter().map(meets).collect();
        all.filter(|all| all.len() == last.len()).map(|all| all.len())
    }
}
