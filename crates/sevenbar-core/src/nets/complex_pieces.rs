//! A piece of a net at complex poses of the links at which it hangs: all of its solutions, with what vanishes where two of them meet.
//!
//! A piece is a dyad, a link on one step with one row, a block that is a member of a family, a leg of a link, or a loop.
//!
//! Source: docs/theory_nets.md, (14), (22) to (24), (27) and (29).

use super::before::Before;
use super::body_block::BodyBlock;
use super::body_family::BodyFamily;
use super::branch_ranges::turned;
use super::complex_known::{Held, Known, Own, Solved};
use super::complex_legs::ComplexLeg;
use super::complex_loops::ComplexLoop;
use super::complex_members::{CarriedMembers, Member, ReadByInput, are_quadrics, at_poses};
use super::dual_quaternions::UNKNOWNS as BODY;
use super::dyad_sides::{Joined, Poses};
use super::dyads::Plane;
use super::hinged::OnStep;
use super::in_plane::InPlane;
use super::loop_block::LoopBlock;
use super::modes::{Part, Stage};
use super::monodromy::Family;
use super::net::{MOST_COLUMNS, Net};
use super::planar_block::{Layout, PlanarBlock};
use super::planar_family::{Pair, PlanarFamily};
use super::rows::{On, Row};
use super::steps::{ComplexPose, Move, Placement};
use crate::loops::equation::closure::{Solution, UNKNOWNS};
use num_complex::Complex64;

/// What is solved together, or follows from what is.
#[derive(Clone, Copy)]
enum What<'a> {
    Dyad(&'a Stage),
    Planar(&'a PlanarBlock),
    Body(&'a BodyBlock),
    Leg(ComplexLeg<'a>),
    Loop(&'a LoopBlock),
}

/// A piece, the links that it places, and those at which it hangs.
pub(super) struct Piece<'a> {
    what: What<'a>,
    pub links: Vec<usize>,
    pub at: Vec<usize>,
}

/// What solves a piece.
pub(super) enum Solver<'a> {
    Dyad(Joined, Plane),
    OnStep(&'a BodyBlock),
    Planar(&'a PlanarBlock, Layout, Members<PlanarFamily, UNKNOWNS, 2>),
    Body(&'a BodyBlock, BodyFamily, Members<BodyFamily, BODY, 3>),
    Leg(ComplexLeg<'a>),
    Loop(Box<ComplexLoop<'a>>),
}

/// Members of a family: by the input where no other piece comes before, or by the poses of known links.
pub(super) struct Members<F, const N: usize, const D: usize> {
    carried: CarriedMembers<F, N, D>,
    by_input: Option<ReadByInput<D>>,
}

impl<F: Family<N, D>, const N: usize, const D: usize> Members<F, N, D> {
    /// Of a block that is this member for what is known before it; `None` where its numbers are no polynomials.
    fn of(
        held: &Held,
        known: Option<&Known>,
        carried: CarriedMembers<F, N, D>,
        at: impl Fn(&Before) -> Option<Member<D>>,
    ) -> Option<Self> {
        let by_input = match known {
            None => Some(ReadByInput::of(held.inputs, |value| held.at_first(value, &at))?),
            Some(known) => {
                are_quadrics(&known.poses, |poses| at(&held.before(poses))).then_some(())?;
                None
            }
        };
        Some(Self { carried, by_input })
    }

    /// All solutions where the links are that are known; `own` says where the piece's are, and a number that vanishes where they are nowhere.
    fn solved(
        &self,
        (held, known, way): (&Held, &Known, usize),
        at: impl Fn(&Before) -> Option<Member<D>>,
        own: impl Fn(&Member<D>, &Solution<N>) -> Option<(Own, Complex64)>,
    ) -> Option<Solved> {
        let member = match &self.by_input {
            Some(read) => read.at(known.input),
            None => at_poses(&known.poses, |poses| at(&held.before(poses)))?,
        };
        let all = self.carried.solved(way, &member)?;
        let (meets, sums) = self.carried.measured(&member, &all);
        let mut finite = Complex64::ONE;
        let mut solutions = Vec::with_capacity(all.len());
        for x in &all {
            let (mut own, factor) = own(&member, x)?;
            finite = turned(finite, factor);
            held.weld(known, &mut own);
            solutions.push(own);
        }
        Some(Solved { solutions, meets, finite, sums })
    }
}

impl<'a> Piece<'a> {
    /// The pieces of parts of a net, each after those at whose links it hangs; `None` where a part is solved otherwise.
    pub fn all(held: &Held<'a>, parts: &'a [Part]) -> Option<Vec<Self>> {
        let parent = |steps: &[usize]| steps.first().and_then(|&first| held.net.steps[first].parent);
        let mut out = Vec::new();
        let mut add = |what, mut links: Vec<usize>, at: Vec<On>| {
            links.extend(held.welded(&links).map(|[_, other]| other));
            let at = at
                .into_iter()
                .flatten()
                .filter(|on| !links.contains(on))
                .collect();
            out.push(Self { what, links, at });
        };
        for part in parts {
            match part {
                Part::Dyad(stage) => add(What::Dyad(stage), stage.links.to_vec(), stage.known.to_vec()),
                Part::Planar(block) => {
                    let at = block.joints.iter().flat_map(|(_, on)| *on).collect();
                    add(What::Planar(block), block.links.clone(), at);
                }
                Part::Body(block) => {
                    let link = block.own()?;
                    let mut at: Vec<On> = block.rows.iter().flatten().flat_map(Row::on).collect();
                    if block.steps.len() == 1 {
                        at.push(parent(&block.steps));
                    }
                    at.extend(block.legs.iter().map(|leg| parent(&leg.steps)));
                    add(What::Body(block), vec![link], at);
                    for leg in &block.legs {
                        let (at, last) = (vec![parent(&leg.steps), Some(link)], *leg.steps.last()?);
                        add(What::Leg(ComplexLeg { leg, link }), vec![last], at);
                    }
                }
                Part::Loop(block) => {
                    let links = block.links.iter().map(|link| link.on[0]).collect();
                    add(What::Loop(block), links, block.ends.to_vec());
                }
            }
        }
        Some(out)
    }

    /// Whether it always has one solution.
    pub fn is_single(&self) -> bool {
        matches!(self.what, What::Leg(leg) if leg.is_single())
    }

    /// What solves it, the `first` one or after others; `None` where it is no polynomial of what is known before it.
    pub fn solver(&self, held: &Held<'a>, known: &Known, is_first: bool) -> Option<Solver<'a>> {
        let from = known;
        let known = (!is_first).then_some(known);
        // what the held step moves within a block is a polynomial of the input alone
        let welds = |count: usize| self.links.len() > count;
        match self.what {
            What::Leg(leg) => Some(Solver::Leg(leg)),
            What::Loop(block) => ComplexLoop::of(block, held, from).map(|own| Solver::Loop(Box::new(own))),
            What::Dyad(stage) => {
                let plane = Plane::across(stage.dyad.normal);
                (!welds(2)).then(|| Solver::Dyad(Joined::of(stage, &plane, held.net.size), plane))
            }
            What::Planar(block) => {
                let layout = held.at_first(0.0, |before| block.layout(before))?;
                let carried = CarriedMembers::of(layout.family.clone(), layout.family.starts())?;
                let at = |before: &Before| planar_numbers(block, before, &layout.family);
                let allowed = is_first || !welds(block.links.len());
                let members = allowed.then(|| Members::of(held, known, carried, at))??;
                Some(Solver::Planar(block, layout, members))
            }
            What::Body(block)
                if held
                    .at_first(0.0, |before| block.on_step(held.net, before))
                    .is_some() =>
            {
                let is_screw = block
                    .steps
                    .iter()
                    .any(|&s| matches!(held.net.steps[s].moves, Move::Screw(_)));
                (!is_screw && !welds(1)).then_some(Solver::OnStep(block))
            }
            What::Body(block) => {
                let (family, _) = held.at_first(0.0, |before| block.member(held.net, before))?;
                let carried = CarriedMembers::of(family.clone(), family.starts())?;
                let at = |before: &Before| body_numbers(block, held.net, before, &family);
                let allowed = is_first || !welds(1);
                let members = allowed.then(|| Members::of(held, known, carried, at))??;
                Some(Solver::Body(block, family, members))
            }
        }
    }
}

fn planar_numbers(block: &PlanarBlock, before: &Before, family: &PlanarFamily) -> Option<Vec<Pair>> {
    let layout = block.layout(before)?;
    (layout.family == *family).then(|| layout.numbers())
}

fn body_numbers(block: &BodyBlock, net: &Net, before: &Before, family: &BodyFamily) -> Option<Member<3>> {
    let (own, member) = block.member(net, before)?;
    (own == *family).then_some(member)
}

impl Solver<'_> {
    /// Whether it has functions: not where it has one solution, which is never at infinity by itself.
    pub fn has_functions(&self) -> bool {
        !matches!(self, Self::Leg(leg) if leg.is_single())
    }

    /// Whether it is a member of a family.
    pub fn is_member(&self) -> bool {
        matches!(self, Self::Planar(..) | Self::Body(..) | Self::Loop(_))
    }

    /// How often its solutions were found anew, in another order.
    pub fn restarts(&self) -> usize {
        match self {
            Self::Planar(_, _, members) => members.carried.restarts(),
            Self::Body(_, _, members) => members.carried.restarts(),
            Self::Loop(own) => own.restarts(),
            Self::Dyad(..) | Self::OnStep(_) | Self::Leg(_) => 0,
        }
    }

    /// All solutions where the links are that are known, in one of the ways of these; `None` where some are lost.
    pub fn solved(&self, held: &Held, known: &Known, way: usize) -> Option<Solved> {
        match self {
            Self::Leg(leg) => leg.solved(held, known),
            Self::Loop(own) => own.solved(held, known, way),
            Self::Dyad(joined, plane) => Some(dyad(joined, plane, held.net.size, &known.poses)),
            Self::OnStep(block) => on_step(block, held, known),
            Self::Planar(block, layout, members) => members.solved(
                (held, known, way),
                |before| planar_numbers(block, before, &layout.family),
                |numbers, x| {
                    let poses = layout.complex_poses(numbers, x);
                    Some((block.links.iter().copied().zip(poses).collect(), Complex64::ONE))
                },
            ),
            Self::Body(block, family, members) => members.solved(
                (held, known, way),
                |before| body_numbers(block, held.net, before, family),
                |_, x| {
                    let pose = block.complex_pose(held.net, x)?;
                    Some((vec![(block.own()?, pose)], family.at_infinity(x)))
                },
            ),
        }
    }
}

fn dyad(joined: &Joined, plane: &Plane, size: f64, known: &[ComplexPose]) -> Solved {
    let mut poses: Poses<Complex64> = [InPlane::still(); MOST_COLUMNS];
    for &on in joined.known.iter().flatten() {
        poses[on] = InPlane::of(&known[on], plane, size);
    }
    let [root, line] = joined.radicand(&poses);
    let put = |side: f64| {
        let both = joined.put(&poses, side).map(|flat| flat.in_space(plane, size));
        joined.links.into_iter().zip(both).collect()
    };
    let sides: &[f64] = if joined.is_single() { &[1.0] } else { &[1.0, -1.0] };
    Solved::in_closed_form(sides.iter().map(|side| put(*side)).collect(), root, line)
}

/// A link on one step with one row, (23).
fn on_step(block: &BodyBlock, held: &Held, known: &Known) -> Option<Solved> {
    let own = block.own()?;
    let step = &held.net.steps[own];
    let numbers = at_poses(&known.poses, |poses| {
        Some(vec![
            block
                .on_step(held.net, &held.before(poses))?
                .0
                .map(Complex64::from),
        ])
    })?;
    let row = OnStep(numbers[0]);
    let (by, root, line) = if step.moves == Move::Slide {
        let [a, b, c] = row.quadratic();
        let root = (b * b - 4.0 * a * c).sqrt();
        let by = [-b + root, -b - root].map(|x| 0.5 * x / a * held.net.size);
        // lengths are relative to the size
        (by, root * root, a)
    } else {
        let [a, b, c] = row.wave();
        let square = a * a + b * b;
        let root = (c * c - square).sqrt();
        let turn = |root: Complex64| (root - c) / (a - Complex64::I * b);
        let by = [root, -root].map(|root| -Complex64::I * turn(root).ln());
        // no part of its own size, which is zero somewhere
        (by, -root * root, square)
    };
    let base = step.parent.map_or(Placement::still(), |p| known.poses[p]);
    let placed = |by: Complex64| vec![(own, base.then(&step.moved(by + step.reads)))];
    Some(Solved::in_closed_form(by.map(placed).into(), root, line))
}
