//! Start systems: closures with general complex parameters, all of whose solutions are known.
//!
//! A general closure of six joints has 16 solutions with no or one sliding joint, 8 with two, 2 with three (Tsai and Morgan
//! 1985; Raghavan and Roth 1993). They are found once for each pattern of joints, from one solution that closes by construction:
//! carried round loops in the space of the parameters, the solutions are exchanged until all have been seen. The numbers
//! come from a fixed seed, so every machine has the same starts.

use super::continuation::BRISK;
use super::geometry::Pattern;
use super::straight::carried;
use crate::loops::equation::closure::{JOINTS, Parameters, Slides, Solution, UNKNOWNS};
use crate::loops::equation::complex_frame::Frame;
use crate::loops::equation::rotations::{rotation, squared_up};
use crate::random::Random;
use crate::rigid::Pose;
use num_complex::Complex64;
use std::collections::HashMap;
use std::sync::{Arc, LazyLock, Mutex, OnceLock, PoisonError};

/// A closure with general parameters, and all its solutions.
pub(super) struct Start {
    pub parameters: Parameters,
    pub solutions: Vec<Solution>,
}

/// Different starts of one class; their paths meet trouble, if at all, in different places.
pub(super) const STARTS: usize = 6;

/// How many solutions a general closure has; none where more than three joints slide, since it then has none that stand alone.
pub(super) fn general_count(slides: &Slides) -> usize {
    match slides.iter().filter(|&&s| s).count() {
        0 | 1 => 16,
        2 => 8,
        3 => 2,
        _ => 0,
    }
}

/// Classes that are kept; there are seldom more than a few. The starts of others are found anew each time.
const MOST_CLASSES: usize = 2000;

/// Members of a special class that are tried until all solutions arrive.
const TRIES: usize = 8;

/// Starts that must find no new solution before a special closure's are believed to be all.
const CONFIRMING_STARTS: usize = 2;

/// Closures of one geometry, with the starts that lead to any of them. General ones have no pattern.
pub(super) struct Class {
    slides: Slides,
    pattern: Option<Pattern>,
    starts: [OnceLock<Start>; STARTS],
}

impl Class {
    /// A class of closures. Its starts are kept once found: constants that are computed, not written down.
    pub fn of(slides: &Slides, pattern: Option<Pattern>) -> Arc<Self> {
        type Known = HashMap<(Slides, Option<Pattern>), Arc<Class>>;
        static KNOWN: LazyLock<Mutex<Known>> = LazyLock::new(Mutex::default);
        // nothing can go wrong while it is held
        let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
        let key = (*slides, pattern);
        if let Some(class) = known.get(&key) {
            return class.clone();
        }
        let starts = [const { OnceLock::new() }; STARTS];
        let class = Arc::new(Self { slides: *slides, pattern, starts });
        if known.len() < MOST_CLASSES {
            known.insert(key, class.clone());
        }
        class
    }

    /// How many solutions a general member has.
    pub fn count(&self) -> usize {
        self.start(0).solutions.len()
    }

    /// The `n`-th start. The numbers do not hang on what was asked for before.
    pub fn start(&self, n: usize) -> &Start {
        self.starts[n].get_or_init(|| {
            let slides = &self.slides;
            let index = slides
                .iter()
                .enumerate()
                .map(|(i, &s)| usize::from(s) << i)
                .sum::<usize>();
            let mut random = Random(1 + (index * STARTS + n) as u64);
            match &self.pattern {
                None if n == 0 => by_monodromy(slides, &mut random),
                Some(pattern) if n == 0 => {
                    let parameters = pattern.imposed_on(general_parameters(&mut random));
                    let solutions = Self::of(slides, None).solutions(&parameters);
                    Start { parameters, solutions }
                }
                _ => self.another(&mut random),
            }
        })
    }

    /// Another member to which all solutions of the first lead.
    fn another(&self, random: &mut Random) -> Start {
        let first = self.start(0);
        let mut best: Option<Start> = None;
        for _ in 0..TRIES {
            let parameters = general_parameters(random);
            let parameters = self.pattern.map_or(parameters, |p| p.imposed_on(parameters));
            let ends = carried(
                &self.slides,
                &first.parameters,
                &parameters,
                &first.solutions,
                BRISK,
            );
            let solutions = distinct(&self.slides, ends.into_iter().flatten(), SAME_GENERAL);
            let all = solutions.len() == first.solutions.len();
            if best.as_ref().is_none_or(|b| solutions.len() > b.solutions.len()) {
                best = Some(Start { parameters, solutions });
            }
            if all {
                break;
            }
        }
        best.unwrap_or_else(|| unreachable!())
    }

    /// All solutions of a closure of the class at general values of its input, or of another class within it.
    pub fn solutions(&self, target: &Parameters) -> Vec<Solution> {
        let mut solutions = Vec::new();
        let mut idle = 0;
        for n in 0..STARTS {
            let start = self.start(n);
            let ends = carried(&self.slides, &start.parameters, target, &start.solutions, BRISK);
            let before = solutions.len();
            solutions = distinct(
                &self.slides,
                solutions.into_iter().chain(ends.into_iter().flatten()),
                SAME_GENERAL,
            );
            idle = if solutions.len() == before { idle + 1 } else { 0 };
            // most have all; a more special one is believed when further starts find nothing new
            if solutions.len() >= self.count() || idle == CONFIRMING_STARTS {
                break;
            }
        }
        solutions
    }
}

fn by_monodromy(slides: &Slides, random: &mut Random) -> Start {
    let want = general_count(slides);
    loop {
        let (parameters, solution) = closed(random, slides);
        let mut known = vec![solution];
        for _ in 0..60 {
            let (a, b) = (general_parameters(random), general_parameters(random));
            let there = carried(slides, &parameters, &a, &known, BRISK);
            let across = carried(
                slides,
                &a,
                &b,
                &there.into_iter().flatten().collect::<Vec<_>>(),
                BRISK,
            );
            let back = carried(
                slides,
                &b,
                &parameters,
                &across.into_iter().flatten().collect::<Vec<_>>(),
                BRISK,
            );
            known = distinct(
                slides,
                known.into_iter().chain(back.into_iter().flatten()),
                SAME_GENERAL,
            );
            if known.len() >= want {
                break;
            }
        }
        if known.len() == want {
            return Start { parameters, solutions: known };
        }
    }
}

/// Each solution once; those nearer than `apart` [rad, or relative to the size] are one.
pub(crate) fn distinct<const N: usize>(
    slides: &Slides<N>,
    solutions: impl Iterator<Item = Solution<N>>,
    apart: f64,
) -> Vec<Solution<N>> {
    let mut kept: Vec<Solution<N>> = Vec::new();
    for solution in solutions {
        if kept.iter().all(|k| !same(slides, k, &solution, apart)) {
            kept.push(solution);
        }
    }
    kept
}

/// Solutions at general parameters lie farther apart than this; far ones are not known better.
pub(crate) const SAME_GENERAL: f64 = 1e-4;

/// Whether two solutions are nearer to each other than `apart`.
pub(crate) fn same<const N: usize>(slides: &Slides<N>, a: &Solution<N>, b: &Solution<N>, apart: f64) -> bool {
    (0..N).all(|i| {
        if slides[i] {
            (a[i] - b[i]).norm() < apart * (1.0 + a[i].norm())
        } else {
            (a[i] - b[i]).norm_sqr() < apart * apart * b[i].norm_sqr()
        }
    })
}

/// General parameters of a closure.
pub(super) fn general_parameters(random: &mut Random) -> Parameters {
    Parameters {
        twists: std::array::from_fn(|_| random.phase()),
        shifts: std::array::from_fn(|_| std::array::from_fn(|_| random.number())),
        turns: std::array::from_fn(|_| random.phase()),
        slide: random.number(),
    }
}

/// Parameters with one solution: the last transform is what closes the chain.
fn closed(random: &mut Random, slides: &Slides) -> (Parameters, Solution) {
    let mut parameters = general_parameters(random);
    let mut solution: Solution = std::array::from_fn(|i| {
        if slides[i] {
            random.number()
        } else {
            random.phase()
        }
    });
    let mut frame = Frame::IDENTITY;
    for i in 0..UNKNOWNS {
        let (turn, slide) = if slides[i] {
            (parameters.turns[i], solution[i])
        } else {
            (solution[i], Complex64::ZERO)
        };
        let [x, y, z] = parameters.shifts[i];
        frame = frame
            .turned_z(turn)
            .shifted([Complex64::ZERO, Complex64::ZERO, slide])
            .shifted([x, y, z])
            .turned_x(parameters.twists[i]);
    }
    let normal = frame.inverse().normal_form();
    let last = JOINTS - 1;
    parameters.twists[last] = normal.twist;
    let [x, y, z] = normal.shift;
    parameters.shifts[last] = [x, y, z - parameters.slide];
    parameters.turns[last] = normal.before;
    // what is left over turns the first joint
    if slides[0] {
        parameters.turns[0] *= normal.after;
    } else {
        solution[0] *= normal.after;
    }
    (parameters, solution)
}

/// A pose in general position.
pub(crate) fn random_pose(random: &mut Random) -> Pose {
    let v = std::array::from_fn(|_| 2.0 * random.uniform() - 1.0);
    Pose {
        rotation: squared_up(&rotation(crate::rigid::scale(v, 2.0))),
        translation: std::array::from_fn(|_| 1.2 * random.uniform() - 0.6),
    }
}
