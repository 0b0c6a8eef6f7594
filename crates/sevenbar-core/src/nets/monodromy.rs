//! All solutions of a family of systems by monodromy, whether they are all, and from them those of one system.
//!
//! One solution that closes by construction is carried round triangles of random parameters; solutions are exchanged until ten triangles bring
//! nothing new, and from another member and solution as many are found. The trace test certifies them: while what rests goes evenly, the sum over
//! all solutions of an unknown does so, too, and that over a part of them does not.
//!
//! Source: docs/theory_nets.md, (10) to (13).

use crate::loops::equation::closure::{Slides, Solution};
use crate::loops::modes::completeness::Completeness;
use crate::loops::modes::continuation::{
    BRISK, CAREFUL, FIRST_STEP, Homotopy, Pace, Place, Way, follow, one_step,
};
use crate::loops::modes::many_starts::SAME_MODE;
use crate::loops::modes::starts::{SAME_GENERAL, distinct};
use crate::random::Random;
use num_complex::Complex64;
use std::collections::HashMap;
use std::hash::Hash;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// How many measures there are of how far a solution is.
pub(super) const FAR: usize = 3;

/// Systems with the same N unknowns, whose numbers, vectors of D parts, may be any.
pub(super) trait Family<const N: usize, const D: usize> {
    /// The systems on the straight line between two members.
    type Way: Homotopy<N>;
    /// Which unknowns are numbers rather than turns `e^(i q)`.
    fn slides(&self) -> Slides<N>;
    /// A general member.
    fn random(&self, random: &mut Random) -> Vec<[Complex64; D]>;
    /// A member with one of its solutions.
    fn closed(&self, random: &mut Random) -> (Vec<[Complex64; D]>, Solution<N>);
    /// The straight line between two members.
    fn between(&self, from: &[[Complex64; D]], to: &[[Complex64; D]]) -> Self::Way;
    /// Changes of a member's constants by which the trace test may be made.
    fn ways_of_constants(&self, random: &mut Random) -> Vec<Vec<[Complex64; D]>>;
    /// What the trace test sums over all solutions.
    fn traced(&self, x: &Solution<N>) -> Vec<Complex64>;
    /// Of a solution where the rows' columns have this determinant: a number that vanishes where two solutions meet, and some that grow without
    /// bound wherever that one does. The product of it over all solutions, and the sums of the others, are real for a real member.
    fn measures(&self, x: &Solution<N>, determinant: Complex64) -> (Complex64, [Complex64; FAR]);
    /// How far a solution is, as a logarithm: it grows without bound along a path to infinity.
    fn far(&self, x: &Solution<N>) -> f64;
}

/// A general member with its solutions.
pub(super) struct Start<const N: usize, const D: usize> {
    member: Vec<[Complex64; D]>,
    pub solutions: Vec<Solution<N>>,
}

/// The starts of a family.
pub(super) struct Starts<const N: usize, const D: usize> {
    /// Found by themselves; they have as many solutions, unless `agree` is false.
    pub starts: [Start<N, D>; 2],
    agree: bool,
    /// Whether the trace test says that there are no others.
    pub certified: bool,
}

/// The starts of families that were met, by the pattern of each.
pub(super) struct Known<F, const N: usize, const D: usize>(Mutex<HashMap<F, Slot<N, D>>>);

/// Starts that are found once, or being found.
type Slot<const N: usize, const D: usize> = Arc<OnceLock<Arc<Starts<N, D>>>>;

impl<F, const N: usize, const D: usize> Default for Known<F, N, D> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<F: Family<N, D> + Clone + Eq + Hash, const N: usize, const D: usize> Known<F, N, D> {
    /// Those of a family.
    pub fn starts(&self, family: &F) -> Arc<Starts<N, D>> {
        let slot = {
            // nothing can go wrong while it is held
            let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            if known.len() >= MOST_FAMILIES {
                known.clear();
            }
            known.entry(family.clone()).or_default().clone()
        };
        slot.get_or_init(|| Arc::new(Starts::found(family))).clone()
    }
}

/// Where the paths to one system end.
pub(super) struct Ends<const N: usize> {
    /// Isolated solutions, each once.
    pub regular: Vec<Solution<N>>,
    /// How many paths arrive at none of them and do not run to infinity: solutions meet, or a curve of them closes.
    pub left_over: usize,
}

/// Families whose starts are cached.
const MOST_FAMILIES: usize = 500;

/// Triangles in a row that bring nothing new before all is believed to be found, and most triangles.
pub(super) const IDLE_TRIANGLES: usize = 10;
const MOST_TRIANGLES: usize = 200;

/// Where the trace is compared [in the parameter], and to what part of it.
const TRACED_AT: [(f64, f64); 4] = [(0.5, 0.0), (-0.4, 0.3), (0.2, -0.6), (0.1, 0.7)];
const SAME_TRACE: f64 = 1e-6;

/// A sum that changes by less than this part of itself is taken to rest.
const MOVES: f64 = 1e-3;

/// Where it is seen whether a path runs to infinity, from the end of a way [in the parameter], and by how much the logarithm of an unknown grows
/// in between if it does.
const NEAR_THE_END: [f64; 2] = [1e-3, 1e-5];
const GROWS: f64 = 0.5;

/// What arrives farther than this, as a logarithm, is at infinity, and so is what is lost a thousandth before the end, farther than that.
const AT_INFINITY: f64 = 18.0;
const LOST_FAR_OUT: f64 = 12.0;

/// A solution whose turns, slides or quaternion have larger imaginary parts than this is not real: where two meet, rounding parts them by its root, and a pose
/// may keep a closure error of about the square of this.
pub(super) const REAL: f64 = 3e-6;

/// Ways to one system that are tried: from which start, at which pace.
const TRIES: [(usize, Pace); 4] = [(0, BRISK), (1, BRISK), (0, CAREFUL), (1, CAREFUL)];

impl<const N: usize, const D: usize> Starts<N, D> {
    /// Those of a family.
    pub fn found<F: Family<N, D>>(family: &F) -> Self {
        let mut random = [Random(0x5ee_d01), Random(0x5ee_d02)];
        let mut starts = [0, 1].map(|k: usize| Start::found(family, &mut random[k]));
        // the one that has fewer is sought anew
        for _ in 0..2 {
            let counts = [0, 1].map(|k: usize| starts[k].solutions.len());
            if counts[0] == counts[1] {
                break;
            }
            let fewer = usize::from(counts[1] < counts[0]);
            starts[fewer] = Start::found(family, &mut random[fewer]);
        }
        let agree = starts[0].solutions.len() == starts[1].solutions.len();
        // a path that is lost says nothing, so the other start is tried, too
        let passes = |k: usize| starts[k].passes_trace_test(family, &mut random[k]);
        let certified = agree && [0, 1].into_iter().any(passes);
        Self { starts, agree, certified }
    }

    /// How many solutions a general member has, as far as is known.
    pub fn count(&self) -> usize {
        self.starts[0].solutions.len().max(self.starts[1].solutions.len())
    }

    /// What is known of the solutions of a member of which so many paths are left over.
    pub fn completeness(&self, left_over: usize) -> Completeness {
        match (left_over, self.certified) {
            (0, true) => Completeness::Algebraic,
            (0, false) if self.agree => Completeness::Monodromy,
            _ => Completeness::Searched,
        }
    }

    /// The solutions of a member.
    pub fn ends<F: Family<N, D>>(&self, family: &F, to: &[[Complex64; D]]) -> Ends<N> {
        let (total, slides) = (self.count(), family.slides());
        let mut regular: Vec<Solution<N>> = Vec::new();
        let mut infinite = total;
        let mut idle = false;
        for (attempt, (start, pace)) in TRIES.into_iter().enumerate() {
            let start = &self.starts[start];
            let way = family.between(&start.member, to);
            let (ends, gone) = start.arriving(family, &way, pace);
            let before = regular.len();
            regular = distinct(&slides, regular.into_iter().chain(ends), SAME_MODE);
            infinite = infinite.min(gone);
            if regular.len() >= total {
                break;
            }
            // a path may have jumped to another: what one start finds is what the other does
            let as_before = attempt > 0 && regular.len() == before;
            if as_before && (idle || regular.len() + infinite >= total) {
                break;
            }
            idle = as_before;
        }
        let infinite = infinite.min(total.saturating_sub(regular.len()));
        let left_over = total.saturating_sub(regular.len() + infinite);
        Ends { regular, left_over }
    }
}

impl<const N: usize, const D: usize> Start<N, D> {
    /// All solutions that triangles bring of a random member.
    fn found<F: Family<N, D>>(family: &F, random: &mut Random) -> Self {
        let slides = family.slides();
        let (member, solution) = family.closed(random);
        let mut solutions = vec![solution];
        let mut idle = 0;
        for _ in 0..MOST_TRIANGLES {
            let corners = [family.random(random), family.random(random)];
            let [a, b] = [&corners[0], &corners[1]];
            let mut carried = solutions.clone();
            for (from, to) in [(&member, a), (a, b), (b, &member)] {
                carried = arriving(&family.between(from, to), &carried);
            }
            let before = solutions.len();
            solutions = distinct(&slides, solutions.into_iter().chain(carried), SAME_GENERAL);
            idle = if solutions.len() == before { idle + 1 } else { 0 };
            if idle == IDLE_TRIANGLES {
                break;
            }
        }
        Self { member, solutions }
    }

    /// Whether the sum of some unknown over all solutions changes evenly while constants do.
    fn passes_trace_test<F: Family<N, D>>(&self, family: &F, random: &mut Random) -> bool {
        let ways = family.ways_of_constants(random);
        ways.iter().any(|change| self.is_even_along(family, change))
    }

    fn is_even_along<F: Family<N, D>>(&self, family: &F, change: &[[Complex64; D]]) -> bool {
        let start = sums(family, &self.solutions);
        let mut slopes = Vec::new();
        for (re, im) in TRACED_AT {
            let by = Complex64::new(re, im);
            let to: Vec<[Complex64; D]> = self
                .member
                .iter()
                .zip(change)
                .map(|(v, c)| std::array::from_fn(|s| v[s] + by * c[s]))
                .collect();
            let there = arriving(&family.between(&self.member, &to), &self.solutions);
            if there.len() < self.solutions.len() {
                return false;
            }
            let there = sums(family, &there);
            let slope: Vec<Complex64> = there.iter().zip(&start).map(|(b, a)| (b - a) / by).collect();
            slopes.push(slope);
        }
        // a sum that rests says nothing, and one has poles where another has none
        (0..start.len()).any(|i| {
            let most = slopes
                .iter()
                .fold(start[i].norm(), |m: f64, s| m.max(s[i].norm()));
            let even = |s: &Vec<Complex64>| (s[i] - slopes[0][i]).norm() < SAME_TRACE * most;
            slopes[0][i].norm() > MOVES * most && slopes.iter().all(even)
        })
    }

    /// The solutions that arrive, and how many paths run to infinity.
    fn arriving<F: Family<N, D>>(&self, family: &F, way: &F::Way, pace: Pace) -> (Vec<Solution<N>>, usize) {
        let [first, second] = NEAR_THE_END;
        let ways = [
            straight(0.0, 1.0 - first, false),
            straight(1.0 - first, 1.0 - second, false),
            straight(1.0 - second, 1.0, true),
        ];
        let places: Vec<Place<N>> = self
            .solutions
            .iter()
            .map(|x| Place::start(x, Complex64::ZERO))
            .collect();
        let reached = follow(way, &places, &[&ways], pace);
        let (mut arrived, mut infinite) = (Vec::new(), 0);
        for path in reached.chunks(ways.len()) {
            let size = |place: &Option<Place<N>>| place.as_ref().map(|p| family.far(p.solution()));
            match (size(&path[0]), size(&path[1]), &path[2]) {
                (_, _, Some(place)) if family.far(place.solution()) < AT_INFINITY => {
                    arrived.push(*place.solution())
                }
                (_, _, Some(_)) => infinite += 1,
                (Some(before), Some(after), None) if after - before > GROWS => infinite += 1,
                (Some(before), None, None) if before > LOST_FAR_OUT => infinite += 1,
                _ => (),
            }
        }
        (arrived, infinite)
    }
}

/// What is traced, summed over solutions.
fn sums<F: Family<N, D>, const N: usize, const D: usize>(
    family: &F,
    solutions: &[Solution<N>],
) -> Vec<Complex64> {
    let mut sums = Vec::new();
    for x in solutions {
        let own = family.traced(x);
        sums.resize(own.len(), Complex64::ZERO);
        for (sum, value) in sums.iter_mut().zip(own) {
            *sum += value;
        }
    }
    sums
}

/// A stretch of the way from 0 to 1.
fn straight(from: f64, to: f64, settle: bool) -> Way {
    Way { direction: Complex64::ONE, length: to - from, end: to.into(), settle }
}

/// The solutions of a member that those of another near by lead to: in one step, where that will do.
pub(super) fn carried<F: Family<N, D>, const N: usize, const D: usize>(
    family: &F,
    (from, solutions): (&[[Complex64; D]], &[Solution<N>]),
    to: &[[Complex64; D]],
) -> Vec<Solution<N>> {
    let far: Vec<[Complex64; D]> = from
        .iter()
        .zip(to)
        .map(|(a, b)| std::array::from_fn(|d| a[d] + (b[d] - a[d]) / FIRST_STEP))
        .collect();
    one_step(&family.between(from, &far), solutions)
}

/// The solutions that arrive at the end of a way between general members.
fn arriving<H: Homotopy<N>, const N: usize>(way: &H, starts: &[Solution<N>]) -> Vec<Solution<N>> {
    let places: Vec<Place<N>> = starts.iter().map(|x| Place::start(x, Complex64::ZERO)).collect();
    let ends = follow(way, &places, &[&[straight(0.0, 1.0, true)]], BRISK);
    ends.iter().flatten().map(|place| *place.solution()).collect()
}

#[cfg(test)]
mod tests {
    use super::super::planar_family::{Chord, Closes, PlanarFamily, Term};
    use super::*;

    /// Two ternary links on the ground, and two links between them: the turns of the one and of one between, and so on.
    fn stephenson() -> PlanarFamily {
        let at = |vector, turn, back| Term { vector, turn, slide: None, back };
        // the ground's places 0 and 1; links 0 and 1 on it, link 2 from one to the other, link 3 likewise
        let way = |first: usize, link: usize| {
            let terms = vec![
                at(0, None, false),
                at(first, Some(0), false),
                at(first + 1, Some(link), false),
                at(1, None, true),
                at(first + 2, Some(1), true),
            ];
            Chord { closes: Closes::Pin, terms }
        };
        PlanarFamily {
            turns: 4,
            slides: Vec::new(),
            vectors: 8,
            at_rest: vec![0, 1],
            chords: vec![way(2, 2), way(5, 3)],
        }
    }

    #[test]
    fn the_trace_test_fails_where_one_solution_is_missing() {
        let family = stephenson();
        let mut random = Random(7);
        let mut start = Start::found(&family, &mut random);
        assert_eq!(start.solutions.len(), 6);
        assert!(start.passes_trace_test(&family, &mut random));
        for k in 0..6 {
            let solution = start.solutions.remove(k);
            assert!(!start.passes_trace_test(&family, &mut random));
            start.solutions.insert(k, solution);
        }
    }

    #[test]
    fn paths_lead_to_all_solutions_of_another_general_member() {
        let family = stephenson();
        let starts = Starts::found(&family);
        let ends = starts.ends(&family, &family.random(&mut Random(9)));
        assert_eq!((ends.regular.len(), ends.left_over), (6, 0));
    }
}
