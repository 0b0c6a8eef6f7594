//! Start systems: closures with general complex parameters, all of whose solutions are known.
//!
//! A general closure of six joints has 16 solutions with no or one sliding joint, 8 with two, 2 with three (Tsai and Morgan
//! 1985; Raghavan and Roth 1993). They are found once for each pattern of joints, from one solution that closes by construction:
//! carried round loops in the space of the parameters, the solutions are exchanged until all have been seen. The numbers
//! come from a fixed seed, so every machine has the same starts.

use super::closure::{JOINTS, Parameters, Slides, Solution, UNKNOWNS};
use super::continuation::BRISK;
use super::geometry::Pattern;
use super::straight::carried;
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
                    let parameters = pattern.imposed_on(random.parameters());
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
            let parameters = random.parameters();
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
        let (parameters, solution) = random.closed(slides);
        let mut known = vec![solution];
        for _ in 0..60 {
            let (a, b) = (random.parameters(), random.parameters());
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

/// Each solution once; those nearer than `apart` [rad, or parts of the size] are one.
pub(super) fn distinct(
    slides: &Slides,
    solutions: impl Iterator<Item = Solution>,
    apart: f64,
) -> Vec<Solution> {
    let mut kept: Vec<Solution> = Vec::new();
    for solution in solutions {
        if kept.iter().all(|k| !same(slides, k, &solution, apart)) {
            kept.push(solution);
        }
    }
    kept
}

/// Solutions at general parameters lie farther apart than this; far ones are not known better.
pub(super) const SAME_GENERAL: f64 = 1e-4;

fn same(slides: &Slides, a: &Solution, b: &Solution, apart: f64) -> bool {
    (0..UNKNOWNS).all(|i| {
        if slides[i] {
            (a[i] - b[i]).norm() < apart * (1.0 + a[i].norm())
        } else {
            (a[i] - b[i]).norm_sqr() < apart * apart * b[i].norm_sqr()
        }
    })
}

/// Numbers that look random and are the same everywhere (Steele, Lea and Flood's SplitMix64).
pub(super) struct Random(pub u64);

impl Random {
    pub fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 * 2.0_f64.powi(-53)
    }

    /// A complex number of about unit size.
    pub fn phase(&mut self) -> Complex64 {
        Complex64::from_polar(0.7 + 0.7 * self.uniform(), std::f64::consts::TAU * self.uniform())
    }

    fn number(&mut self) -> Complex64 {
        Complex64::from_polar(0.2 + 0.6 * self.uniform(), std::f64::consts::TAU * self.uniform())
    }

    pub fn parameters(&mut self) -> Parameters {
        Parameters {
            twists: std::array::from_fn(|_| self.phase()),
            shifts: std::array::from_fn(|_| std::array::from_fn(|_| self.number())),
            turns: std::array::from_fn(|_| self.phase()),
            slide: self.number(),
        }
    }

    /// Parameters with one solution: the last transform is what closes the chain.
    fn closed(&mut self, slides: &Slides) -> (Parameters, Solution) {
        let mut parameters = self.parameters();
        let mut solution: Solution =
            std::array::from_fn(|i| if slides[i] { self.number() } else { self.phase() });
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
}

/// A rigid motion with complex entries: the images of the axes, and of the origin.
#[derive(Clone, Copy)]
pub(super) struct Frame {
    axes: [[Complex64; 3]; 3],
    origin: [Complex64; 3],
}

/// `Rz(before) T(shift) Rx(twist) Rz(after)`, each angle `t` as `e^(i t)`.
pub(super) struct NormalForm {
    pub before: Complex64,
    pub shift: [Complex64; 3],
    pub twist: Complex64,
    pub after: Complex64,
}

/// Below this sine of its twist a transform counts as a turn about z; the rest is rounding.
pub(super) const NO_TWIST: f64 = 1e-13;

fn cosine_sine(z: Complex64) -> (Complex64, Complex64) {
    let inverse = z.inv();
    ((z + inverse) * 0.5, (z - inverse) * Complex64::new(0.0, -0.5))
}

impl Frame {
    pub const IDENTITY: Self = {
        let (o, l) = (Complex64::ZERO, Complex64::ONE);
        Self { axes: [[l, o, o], [o, l, o], [o, o, l]], origin: [o, o, o] }
    };

    fn turned(mut self, i: usize, j: usize, z: Complex64) -> Self {
        let (c, s) = cosine_sine(z);
        for k in 0..3 {
            let (x, y) = (self.axes[i][k], self.axes[j][k]);
            self.axes[i][k] = x * c + y * s;
            self.axes[j][k] = y * c - x * s;
        }
        self
    }

    pub fn from_pose(pose: &Pose) -> Self {
        Self {
            axes: std::array::from_fn(|j| pose.column(j).map(Complex64::from)),
            origin: pose.translation.map(Complex64::from),
        }
    }

    fn turned_z(self, z: Complex64) -> Self {
        self.turned(0, 1, z)
    }

    fn turned_x(self, z: Complex64) -> Self {
        self.turned(1, 2, z)
    }

    fn shifted(mut self, by: [Complex64; 3]) -> Self {
        for k in 0..3 {
            for (j, step) in by.iter().enumerate() {
                self.origin[k] += self.axes[j][k] * step;
            }
        }
        self
    }

    fn inverse(&self) -> Self {
        let axes = std::array::from_fn(|j| std::array::from_fn(|k| self.axes[k][j]));
        let origin = std::array::from_fn(|j| {
            -(0..3)
                .map(|k| self.axes[j][k] * self.origin[k])
                .sum::<Complex64>()
        });
        Self { axes, origin }
    }

    /// The Euler angles z, x, z of the turn, and the shift as seen after the first.
    pub fn normal_form(&self) -> NormalForm {
        let i = Complex64::I;
        let [ex, ey, ez] = self.axes;
        // the third column is (sin before, -cos before, 0) sin twist + cos twist z
        let square = ez[0] * ez[0] + ez[1] * ez[1];
        let sine = square.sqrt();
        let before = if sine.norm() < NO_TWIST {
            Complex64::ONE
        } else {
            (-ez[1] + i * ez[0]) / sine
        };
        let (c, s) = cosine_sine(before);
        let across = |v: [Complex64; 3]| (v[0] * c + v[1] * s, v[1] * c - v[0] * s);
        let (px, py) = across(self.origin);
        let after = across(ex).0 - i * across(ey).0;
        NormalForm {
            before,
            shift: [px, py, self.origin[2]],
            twist: ez[2] - i * across(ez).1,
            after,
        }
    }
}
