//! Every assembly mode at one input.
//!
//! Where all passive joints turn or slide, the closure is algebraic. Its solutions are carried from a general closure with all
//! its solutions known (see [`super::starts`]) to this chain with its input at a general complex value, once; from there to
//! any real input only the input moves. Chains with fewer than six passive freedoms close although they have too few; joints
//! about axes in general position are added, and the solutions kept in which these stay at zero.

use super::chain_closure::{Closure, Input};
use super::circle::{Circle, InputClosure};
pub use super::completeness::Completeness;
use super::continuation::{BRISK, CAREFUL, Pace};
use super::many_starts::{PATHS_LOST, SAME_MODE, same, searched};
use super::phases::Watch;
use super::poles::{poles, unwatched_three};
use super::polish::{Settled, polish};
use super::starts::{distinct, general_count, random_pose};
use super::straight::carried;
use crate::loops::equation::chain::{BALLS, Chain, Configuration};
use crate::loops::equation::closed::{Closed, Joint};
use crate::loops::equation::closure::{JOINTS, Parameters, Slides, Solution, UNKNOWNS};
use crate::loops::equation::rotations::{Rotation, Z_TO_X, ball_rotation, product, short_way, transposed};
use crate::random::Random;
use crate::rigid::Pose;
use num_complex::Complex64;
use std::cell::OnceCell;

/// Rough modes closed as well as they can be.
pub(crate) struct Polished {
    /// Those that close, in order.
    pub modes: Vec<Configuration>,
    /// By how much redundant constraints keep the others open [rad, or relative to the size].
    pub open_by: Vec<f64>,
}

/// A solution whose turns or slides have larger imaginary parts than this is not tried as a real one.
pub(crate) const REAL: f64 = 1e-5;

/// A real solution may move by this much [rad, or relative to the size] when it is polished on the chain itself.
const POLISHED_MOVE: f64 = 1e-3;

/// By how much farther than a solution is from real it may move.
const FARTHER: f64 = 5.0;

/// `|e^(i t)|` of the general value of an input that turns: near the real ones, and beside the places on them where solutions
/// meet.
pub(crate) const CIRCLE: f64 = 1.05;

/// What an unknown of the closure stands for.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Unknown {
    Column(usize),
    /// The first, second or third turn of a ball, about z, y and x.
    BallTurn(usize, usize),
    Added,
}

/// Finds the modes of one chain at any value of one input.
pub(crate) struct ModeFinder<'a> {
    pub chain: &'a Chain,
    pub input: usize,
    pub unknowns: Vec<Unknown>,
    pub slides: Slides,
    /// The fixed transforms: after the input, and after each unknown.
    pub transforms: Vec<Pose>,
    /// The axes of the balls' turns, in the frame of each ball.
    ball_axes: Rotation,
    /// The closure and the class of its geometry; `None` where there is no algebraic way.
    closure: Option<Closure>,
    /// Found when it is first asked for.
    generic: OnceCell<Generic>,
}

/// All solutions at a general complex value of the input.
struct Generic {
    input: Input,
    solutions: Vec<Solution>,
}

/// Takes z to y, and y to minus z.
const Z_TO_Y: Rotation = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]];

impl<'a> ModeFinder<'a> {
    pub fn new(chain: &'a Chain, input: usize) -> Self {
        Self::with_axes(chain, input, Pose::STILL.rotation, 0x5eed)
    }

    /// One with the turns of balls about other axes, if solutions are lost with these and are not with those: on some circuits a ball may
    /// stand in a gimbal throughout.
    pub fn better_placed(&self) -> Option<Self> {
        // the added joints are about axes in general position: what is lost about these is about any others
        let is_lossy = self.chain.ball_count() > 0 && self.is_degenerate();
        let other = is_lossy.then(|| Self::about_other_axes(self.chain, self.input));
        other.filter(|o| !o.is_degenerate())
    }

    /// With the turns of balls, and the added joints, about other axes: where those about one choice are singular, as in a gimbal, these
    /// are not.
    pub fn about_other_axes(chain: &'a Chain, input: usize) -> Self {
        Self::with_axes(chain, input, random_pose(&mut Random(0x7117)).rotation, 0xadded)
    }

    fn with_axes(chain: &'a Chain, input: usize, ball_axes: Rotation, added: u64) -> Self {
        let mut finder = Self {
            chain,
            input,
            unknowns: Vec::new(),
            slides: [false; UNKNOWNS],
            transforms: Vec::new(),
            ball_axes,
            closure: None,
            generic: OnceCell::new(),
        };
        let input_joint = chain.joint_of(input);
        let count = chain.joints.len();
        // the transform that leads up to the next unknown
        let mut lead = chain.links[input_joint];
        let mut algebraic = true;
        let mut before = Vec::new();
        for step in 1..count {
            let joint = (input_joint + step) % count;
            match chain.joints[joint] {
                Joint::Ball(b) => {
                    let (y, x) = (Pose::turning(Z_TO_Y), Pose::turning(Z_TO_X));
                    let axes = Pose::turning(ball_axes);
                    before.push(lead.then(&axes));
                    before.push(y);
                    before.push(y.inverse().then(&x));
                    finder.unknowns.extend((0..3).map(|k| Unknown::BallTurn(b, k)));
                    lead = x.inverse().then(&axes.inverse()).then(&chain.links[joint]);
                }
                kind => {
                    algebraic &= !matches!(kind, Joint::Screw(_));
                    before.push(lead);
                    finder.unknowns.push(Unknown::Column(chain.first[joint]));
                    lead = chain.links[joint];
                }
            }
        }
        let mut random = Random(added);
        while finder.unknowns.len() < UNKNOWNS {
            let pose = random_pose(&mut random);
            before.push(lead.then(&pose));
            finder.unknowns.push(Unknown::Added);
            lead = pose.inverse();
        }
        before.push(lead);
        for (slide, unknown) in finder.slides.iter_mut().zip(&finder.unknowns) {
            *slide =
                matches!(unknown, Unknown::Column(c) if chain.joints[chain.joint_of(*c)] == Joint::Slide);
        }
        algebraic &= finder.unknowns.len() == UNKNOWNS && general_count(&finder.slides) > 0;
        finder.transforms = before.clone();
        // from the first unknown on; the last transform comes before it
        before.rotate_left(1);
        if let (true, Ok(transforms)) = (algebraic, <&[Pose; JOINTS]>::try_from(&before[..])) {
            finder.closure = Some(Closure::of(transforms, &finder.slides, chain.joints[input_joint]));
        }
        finder
    }

    /// Whether the axes of some unknowns are of its own choice: those of a ball's turns, and of added joints.
    pub fn has_free_axes(&self) -> bool {
        self.unknowns.iter().any(|u| !matches!(u, Unknown::Column(_)))
    }

    pub fn completeness(&self) -> Completeness {
        if self.closure.is_some() {
            Completeness::Algebraic
        } else {
            Completeness::Searched
        }
    }

    /// Whether fewer solutions stand alone than the geometry has: others lie on curves or surfaces, to which no path leads, as those of
    /// a loop with two freedoms do.
    pub fn is_degenerate(&self) -> bool {
        let fewer = |c: &Closure| self.generic(c).solutions.len() < c.class.count();
        self.closure.as_ref().is_some_and(fewer)
    }

    /// A mode by search, also where there is an algebraic way and the passive joints have freedoms to spare; none where none is found.
    pub fn one_by_search(&self, value: f64) -> Option<Configuration> {
        let found = PATHS_LOST.first(self.chain, self.input, Some(value), |_| true);
        self.in_order(found.into_iter().collect()).pop()
    }

    /// One that follows all paths of a general closure, whatever the geometry.
    #[cfg(test)]
    pub fn from_general_starts(chain: &'a Chain, input: usize) -> Self {
        let mut finder = Self::new(chain, input);
        if let Some(closure) = &mut finder.closure {
            closure.class = super::starts::Class::of(&finder.slides, None);
        }
        finder
    }

    /// How many solutions there are over the complex numbers at a general input.
    #[cfg(test)]
    pub fn complex_count(&self) -> Option<usize> {
        self.closure.as_ref().map(|c| self.generic(c).solutions.len())
    }

    fn generic(&self, closure: &Closure) -> &Generic {
        self.generic.get_or_init(|| {
            let input = self.generic_input(&mut Random(0xa110));
            let (target, _) = closure.parameters(input);
            Generic { input, solutions: closure.class.solutions(&target) }
        })
    }

    /// All solutions at one general complex value of an input that turns (`e^(i t)`) or slides, and `e^(i t)` of the unknowns' zeros;
    /// `None` where there is no algebraic way.
    pub fn solutions_at(&self, value: Complex64) -> Option<(Vec<Solution>, [Complex64; UNKNOWNS])> {
        let closure = self.closure.as_ref()?;
        let input = match self.chain.joints[self.chain.joint_of(self.input)] {
            Joint::Slide => Input { turn: Complex64::ONE, slide: value },
            _ => Input { turn: value, slide: Complex64::ZERO },
        };
        let (target, zeros) = closure.parameters(input);
        Some((closure.class.solutions(&target), zeros))
    }

    /// What the count asks of a closure that is algebraic.
    pub fn algebraic(&self) -> Option<Algebraic<'_>> {
        let closure = self.closure.as_ref()?;
        let (parameters, zeros) = closure.parameters(self.input_at(0.0));
        Some(Algebraic { finder: self, generic: self.generic(closure), parameters, zeros })
    }

    /// All modes at the one value that is asked for [rad, or relative to the size], and whether fewer solutions stand alone there than at
    /// a general one.
    pub fn once(&self, value: f64) -> (Polished, bool) {
        let Some(closure) = &self.closure else {
            return (self.polished(&searched(self.chain, self.input, value)), false);
        };
        // straight there: where as many arrive as there can be, none is missing
        let (to, shift) = closure.parameters(self.input_at(value));
        let start = closure.class.start(0);
        let found = carried(&self.slides, &start.parameters, &to, &start.solutions, BRISK);
        let ends = distinct(&self.slides, found.into_iter().flatten(), SAME_MODE);
        if ends.len() == closure.class.count() {
            return (self.polished(&self.real_ones(&ends, &shift, value, REAL)), false);
        }
        let ends = self.ends_at(closure, value);
        let fewer = ends.len() < self.generic(closure).solutions.len() || self.is_degenerate();
        (self.polished(&self.real_ones(&ends, &shift, value, REAL)), fewer)
    }

    /// All modes with the input at this value [rad, or relative to the size].
    pub fn at(&self, value: f64) -> Polished {
        self.polished(&self.rough_at(value, REAL))
    }

    /// The same, some of them rough to [`POLISHED_MOVE`]: solutions whose imaginary parts are below `real` [rad, or relative to the size].
    pub fn rough_at(&self, value: f64, real: f64) -> Vec<Configuration> {
        let Some(closure) = &self.closure else {
            return searched(self.chain, self.input, value);
        };
        let (_, shift) = closure.parameters(self.input_at(value));
        self.real_ones(&self.ends_at(closure, value), &shift, value, real)
    }

    /// The solutions that stand alone with the input at this value [rad, or relative to the size].
    fn ends_at(&self, closure: &Closure, value: f64) -> Vec<Solution> {
        let generic = self.generic(closure);
        let (from, _) = closure.parameters(generic.input);
        let (to, _) = closure.parameters(self.input_at(value));
        let mut ends: Vec<Solution> = Vec::new();
        let mut random = Random(0xde70);
        for attempt in 0..3 {
            let found = match attempt {
                0 => carried(&self.slides, &from, &to, &generic.solutions, BRISK),
                // two paths that end near each other may have become one
                1 => carried(&self.slides, &from, &to, &generic.solutions, CAREFUL),
                // another way round whatever the straight way came too near to
                _ => {
                    let (aside, _) = closure.parameters(self.generic_input(&mut random));
                    let first = carried(&self.slides, &from, &aside, &generic.solutions, CAREFUL);
                    let first: Vec<Solution> = first.into_iter().flatten().collect();
                    carried(&self.slides, &aside, &to, &first, CAREFUL)
                }
            };
            ends = distinct(
                &self.slides,
                ends.into_iter().chain(found.into_iter().flatten()),
                SAME_MODE,
            );
            if ends.len() >= generic.solutions.len() {
                break;
            }
        }
        ends
    }

    /// All modes at the values `2 pi k / count` of an input that turns, some of them rough to [`POLISHED_MOVE`], and the paths by
    /// which they were found, if they are algebraic.
    pub fn around(&self, count: usize, watch: Option<&Watch>) -> (Vec<Vec<Configuration>>, Option<Circle>) {
        let value = |k: usize| std::f64::consts::TAU * k as f64 / count as f64;
        let Some(algebraic) = self.algebraic() else {
            return (
                (0..count)
                    .map(|k| searched(self.chain, self.input, value(k)))
                    .collect(),
                None,
            );
        };
        let want = algebraic.generic.solutions.len();
        let shift = algebraic.zeros;
        let circle = algebraic.circle(&algebraic.closure(watch), CIRCLE, count, BRISK);
        let first = (circle.first * count as f64 / std::f64::consts::TAU).round() as i64;
        let modes = (0..count)
            .map(|k| {
                let place = (k as i64 - first).rem_euclid(count as i64) as usize;
                let ends = circle.ends[place].iter().flatten().map(|p| *p.solution());
                let ends = distinct(&self.slides, ends, SAME_MODE);
                // two paths that end near each other may have become one
                if ends.len() < want {
                    return self.rough_at(value(k), REAL);
                }
                self.real_ones(&ends, &shift, value(k), REAL)
            })
            .collect();
        (modes, Some(circle))
    }

    /// The modes among solutions, rough to [`POLISHED_MOVE`].
    fn real_ones(
        &self,
        ends: &[Solution],
        shift: &[Complex64; UNKNOWNS],
        value: f64,
        real: f64,
    ) -> Vec<Configuration> {
        let real = real.max(self.chain.looseness());
        ends.iter()
            .filter_map(|end| self.configuration(end, shift, value, real))
            .collect()
    }

    /// Rough modes closed, each once; without those that do not close near by.
    pub fn polished(&self, rough: &[Configuration]) -> Polished {
        let (closed, open): (Vec<Settled>, Vec<Settled>) =
            self.settled(rough).into_iter().partition(|s| s.agrees);
        let open = open.iter().filter(|s| self.chain.counts(&s.at));
        Polished {
            open_by: open.map(|s| s.error).collect(),
            modes: self.in_order(closed.into_iter().map(|s| s.at).collect()),
        }
    }

    /// The poses nearest to rough modes at which the loop closes as well as it can, each once.
    fn settled(&self, rough: &[Configuration]) -> Vec<Settled> {
        let mut out: Vec<Settled> = Vec::new();
        let reach = POLISHED_MOVE.max(FARTHER * self.chain.looseness());
        for rough in rough {
            if let Some(settled) = polish(self.chain, self.input, rough, reach)
                && out.iter().all(|s| !same(self.chain, &s.at, &settled.at))
            {
                out.push(settled);
            }
        }
        out
    }

    fn input_at(&self, value: f64) -> Input {
        let turn = Complex64::from_polar(1.0, value);
        match self.chain.joints[self.chain.joint_of(self.input)] {
            Joint::Slide => Input { turn: Complex64::ONE, slide: value.into() },
            Joint::Screw(advance) => Input { turn, slide: (advance * value).into() },
            _ => Input { turn, slide: Complex64::ZERO },
        }
    }

    fn generic_input(&self, random: &mut Random) -> Input {
        let (turn, slide) = (random.phase(), random.phase());
        match self.chain.joints[self.chain.joint_of(self.input)] {
            Joint::Slide => Input { turn: Complex64::ONE, slide },
            Joint::Screw(_) => Input { turn, slide },
            _ => Input { turn: turn * (CIRCLE / turn.norm()), slide: Complex64::ZERO },
        }
    }

    fn in_order(&self, mut modes: Vec<Configuration>) -> Vec<Configuration> {
        modes.retain(|m| self.chain.counts(m));
        for mode in &mut modes {
            for column in 0..self.chain.columns {
                if self.chain.is_turn(column) {
                    mode.values[column] = short_way(mode.values[column]);
                }
            }
        }
        let key = |m: &Configuration| -> Vec<f64> {
            let balls = m.balls.iter().flatten().flatten();
            m.values.iter().chain(balls).map(|x| (x * 1e6).round()).collect()
        };
        modes.sort_by(|a, b| key(a).partial_cmp(&key(b)).unwrap_or(std::cmp::Ordering::Equal));
        modes
    }

    /// The joints of a solution that is real within so much [rad, or relative to the size]; `None` for another, or where an added joint moved.
    pub fn configuration(
        &self,
        solution: &Solution,
        shift: &[Complex64; UNKNOWNS],
        value: f64,
        within: f64,
    ) -> Option<Configuration> {
        let mut out = Configuration::zero();
        out.values[self.input] = value;
        let mut turns = [[0.0; 3]; BALLS];
        for (i, unknown) in self.unknowns.iter().enumerate() {
            let real = if self.slides[i] {
                let x = solution[i];
                (x.im.abs() < within * (1.0 + x.re.abs())).then_some(x.re)?
            } else {
                let size = solution[i].norm_sqr().sqrt();
                ((size - 1.0).abs() < within).then_some((solution[i] * shift[i].conj()).arg())?
            };
            match *unknown {
                Unknown::Column(c) => out.values[c] = real,
                Unknown::BallTurn(b, k) => turns[b][k] = real,
                Unknown::Added => {
                    if real.abs() > within {
                        return None;
                    }
                }
            }
        }
        for (ball, t) in out.balls.iter_mut().zip(&turns) {
            let turned = product(&self.ball_axes, &ball_rotation(t));
            *ball = product(&turned, &transposed(&self.ball_axes));
        }
        Some(out)
    }
}

/// A closure that is algebraic, with its solutions at a general input.
pub(crate) struct Algebraic<'a> {
    finder: &'a ModeFinder<'a>,
    generic: &'a Generic,
    /// At the input zero.
    parameters: Parameters,
    /// `e^(i t)` of the unknowns' zeros.
    pub zeros: [Complex64; UNKNOWNS],
}

impl<'a> Algebraic<'a> {
    /// Whether it has all the solutions that a general one has.
    pub fn is_general(&self) -> bool {
        self.generic.solutions.len() == general_count(&self.finder.slides)
    }

    /// The closure with everything but the input fixed.
    pub fn closure(&self, watch: Option<&Watch>) -> InputClosure<'a> {
        InputClosure::new(&self.finder.slides, &self.parameters, watch.cloned())
    }

    /// `e^(i tau)` of the inputs at which solutions run to infinity, if the geometry is general.
    pub fn poles(&self) -> Option<Vec<Complex64>> {
        let zero = self.parameters.turns[UNKNOWNS];
        Some(poles(&self.parameters)?.into_iter().map(|z| z / zero).collect())
    }

    /// The first of three passive joints in a row that need not be watched, if there are such.
    pub fn unwatched_three(&self) -> Option<usize> {
        unwatched_three(&self.parameters, &self.finder.slides)
    }

    /// All solutions followed round a circle and down to the real values beneath.
    pub fn circle(&self, closure: &InputClosure, radius: f64, count: usize, pace: Pace) -> Circle {
        closure.circle(
            self.generic.input.turn,
            &self.generic.solutions,
            (radius, count),
            pace,
        )
    }

    /// Which of the solutions leave the added joints at zero.
    pub fn own(&self) -> Vec<usize> {
        let own = |x: &Solution| {
            let unknowns = self.finder.unknowns.iter().enumerate();
            let mut added = unknowns.filter(|(_, u)| matches!(u, Unknown::Added));
            added.all(|(i, _)| (x[i] / self.zeros[i] - 1.0).norm() < REAL)
        };
        let solutions = &self.generic.solutions;
        (0..solutions.len()).filter(|&k| own(&solutions[k])).collect()
    }
}
