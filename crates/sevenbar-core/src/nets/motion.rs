//! Modes and the whole motion of a net of one freedom over any of its tree's columns.
//!
//! Modes at many values of the input, in closed form or searched for, are followed to curves as those of a single loop are.
//!
//! Source: docs/theory_nets.md, (8).

use super::described::DescribedNet;
use super::freedoms::{Freedoms, freedoms};
use super::modes::Part;
use super::net::MOST_COLUMNS;
use super::net_rows::NetRows;
use super::search::{STARTS, is_isolated, searched, settled};
use super::seeds::whole_curves;
use super::sized::SizedNet;
use crate::loops::circuits::change_points as curve_points;
use crate::loops::circuits::curve;
use crate::loops::circuits::found::Search;
use crate::loops::circuits::known_curves::Curves;
use crate::loops::description::described_loop::{Column, Described};
use crate::loops::equation::closed::{At, Closed};
use crate::loops::motions::circuit::{OverInput, Reach};
use crate::loops::motions::motion::{PUT_RIGHT, common_type, limits_meet, over_input, through};
use crate::loops::motions::passes::Passes;
use crate::outcome::CircuitMeasures;

/// A rate by the length of the curve below which a column rests: a dead centre is known to the root of rounding.
const RESTS: f64 = 1e-6;

/// Why a net has no motion that is followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotFollowed {
    /// It has so many freedoms, not one.
    Freedoms(usize),
    /// It has so many columns, too many.
    Columns(usize),
    /// The input or the output is no column of the tree.
    NoColumn,
}

/// What a motion is computed over.
#[derive(Clone, Copy, Debug)]
pub struct Over<'a> {
    /// The input, a column of the description.
    pub input: usize,
    /// The output.
    pub output: usize,
    /// Rows in a turn.
    pub samples: usize,
    /// d(input)/dt
    pub speed: f64,
    /// The input and its derivatives by time, instead of a grid.
    pub law: Option<&'a [[f64; 4]]>,
}

/// A circuit of a net.
#[derive(Clone, Debug)]
pub struct NetCircuit {
    /// Its rows.
    pub rows: NetRows,
    /// What it is measured by.
    pub measures: CircuitMeasures,
}

/// A pose at which curves meet, or that is isolated: the columns, the circuits by number, ways out, freedoms.
pub type NetChangePoint = (Vec<f64>, Vec<usize>, usize, usize);

/// The motion of a net.
#[derive(Clone, Debug)]
pub struct NetMotion {
    /// The circuits' common type or "mixed", or why there are none.
    pub motion_type: &'static str,
    /// Where modes were sought, and what was found out.
    pub search: Search,
    /// The circuits.
    pub circuits: Vec<NetCircuit>,
    /// Poses at which the motion is not smooth.
    pub change_points: Vec<NetChangePoint>,
    /// Columns that move where the input rests, if it does somewhere.
    pub moving: Option<Vec<usize>>,
}

/// What goes through a pose of a net.
#[derive(Clone, Debug)]
pub enum NetThrough {
    /// A circuit.
    Circuit(Box<NetCircuit>),
    /// It does not close near it; how far it is from closing [rad, or relative to the size].
    Apart(f64),
    /// It closes, and no motion could be followed.
    Still,
    /// It moves with the input at rest: the columns that do.
    InputRests(Vec<usize>),
}

/// Work on a net whose size the compiler knows.
trait Sized {
    type Out;
    /// What the net is made of over an input, where that is known.
    fn parts(&self) -> Option<(&[Part], usize)> {
        None
    }
    fn run<const C: usize, const R: usize, const B: usize>(self, net: &SizedNet<C, R, B>) -> Self::Out;
}

/// Does work on a net of one freedom, of the rows that repeat no others.
fn sized<W: Sized>(described: &DescribedNet, work: W) -> Result<W::Out, NotFollowed> {
    let Freedoms { rank, independent, .. } = freedoms(&described.net);
    let count = described.net.steps.len();
    if rank + 1 != count || independent.len() != rank {
        return Err(NotFollowed::Freedoms(count - rank));
    }
    let net = &described.net;
    // one size for all: each costs as much code as the chain's, and one of twice as many columns twice the time
    if count <= MOST_COLUMNS {
        let mut sized = SizedNet::<MOST_COLUMNS, 16, 5>::new(net, &independent);
        if let Some((parts, input)) = work.parts() {
            sized = sized.made_of(parts, input, net.size);
        }
        Ok(work.run(&sized))
    } else {
        Err(NotFollowed::Columns(count))
    }
}

/// A mode that is found: the columns of the description, its closure error, whether it is isolated.
pub type FoundMode = (Vec<f64>, f64, bool);

/// The modes that are found from many places with a column at a value [rad, or length].
pub fn searched_modes(
    described: &DescribedNet,
    column: usize,
    value: f64,
) -> Result<Vec<FoundMode>, NotFollowed> {
    struct Modes<'a>(&'a DescribedNet, usize, f64);
    impl Sized for Modes<'_> {
        type Out = Vec<FoundMode>;
        fn run<const C: usize, const R: usize, const B: usize>(self, net: &SizedNet<C, R, B>) -> Self::Out {
            let mut found = searched(net, self.1, self.2, STARTS);
            found.retain(|at| self.0.closes(net.values(at), net.balls(at)));
            let values_of = |at: &At<SizedNet<C, R, B>>| {
                let values = self.0.outer_values(net.values(at), net.balls(at));
                (values, net.residual(&net.place(at)), is_isolated(net, self.1, at))
            };
            found.iter().map(values_of).collect()
        }
    }
    let held = described.followed(column).ok_or(NotFollowed::NoColumn)?;
    sized(
        described,
        Modes(described, held.inner, value * described.inward(column)),
    )
}

/// The whole motion of a net; its modes are those of its `parts` where these are given.
pub fn net_motion(
    described: &DescribedNet,
    parts: Option<&[Part]>,
    over: &Over,
) -> Result<NetMotion, NotFollowed> {
    struct Motion<'a>(Asked<'a>, Option<&'a [Part]>);
    impl Sized for Motion<'_> {
        type Out = NetMotion;
        fn parts(&self) -> Option<(&[Part], usize)> {
            Some((self.1?, self.0.ends.0.inner))
        }
        fn run<const C: usize, const R: usize, const B: usize>(self, net: &SizedNet<C, R, B>) -> NetMotion {
            self.0.motion(net, self.1)
        }
    }
    sized(described, Motion(Asked::new(described, over)?, parts))
}

/// The one circuit through a pose of a net, given by the columns of the description; its rows have a closed form where its `parts`, if these are given, do.
pub fn net_circuit_through(
    described: &DescribedNet,
    parts: Option<&[Part]>,
    pose: &[f64],
    over: &Over,
) -> Result<NetThrough, NotFollowed> {
    struct Circuit<'a>(Asked<'a>, Option<&'a [Part]>, Vec<f64>);
    impl Sized for Circuit<'_> {
        type Out = NetThrough;
        fn parts(&self) -> Option<(&[Part], usize)> {
            Some((self.1?, self.0.ends.0.inner))
        }
        fn run<const C: usize, const R: usize, const B: usize>(self, net: &SizedNet<C, R, B>) -> NetThrough {
            self.0.through(net, &self.2)
        }
    }
    let pose = described.inner_values(pose);
    sized(described, Circuit(Asked::new(described, over)?, parts, pose))
}

/// d(output)/d(input) at a pose, given by the columns of the description, where both rest; `None` where one of them moves.
pub fn ratio_at_rest(
    described: &DescribedNet,
    pose: &[f64],
    input: usize,
    output: usize,
) -> Result<Option<f64>, NotFollowed> {
    struct Ratio(Vec<f64>, [usize; 2]);
    impl Sized for Ratio {
        type Out = Option<f64>;
        fn run<const C: usize, const R: usize, const B: usize>(self, net: &SizedNet<C, R, B>) -> Option<f64> {
            let node = curve::node_at(net, &net.at(&self.0))?;
            let [input, output] = self.1;
            let rests = |c: usize| node.rates[0][c].abs() < RESTS;
            (rests(input) && rests(output)).then(|| node.rates[1][output] / node.rates[1][input])
        }
    }
    let column = |outer| described.followed(outer).ok_or(NotFollowed::NoColumn);
    let ends = [column(input)?.inner, column(output)?.inner];
    let factor = described.inward(input) / described.inward(output);
    let ratio = sized(described, Ratio(described.inner_values(pose), ends))?;
    Ok(ratio.map(|ratio| ratio * factor))
}

/// A motion of a net that is wanted.
struct Asked<'a> {
    described: &'a DescribedNet,
    ends: (Column, Column),
    over: Over<'a>,
}

impl<'a> Asked<'a> {
    fn new(described: &'a DescribedNet, over: &Over<'a>) -> Result<Self, NotFollowed> {
        let column = |outer| described.followed(outer).ok_or(NotFollowed::NoColumn);
        let ends = (column(over.input)?, column(over.output)?);
        Ok(Self { described, ends, over: *over })
    }

    fn motion<const C: usize, const R: usize, const B: usize>(
        &self,
        net: &SizedNet<C, R, B>,
        parts: Option<&[Part]>,
    ) -> NetMotion {
        let curves = whole_curves(self.described, net, parts, [self.ends.0.inner, self.ends.1.inner]);
        let turns = [self.ends.0, self.ends.1].map(|column| net.is_turn(column.inner));
        let (mut motion, reaches) = self.over(net, curves);
        let meeting = limits_meet(reaches.iter(), turns);
        motion.motion_type = motion_type(&motion, meeting);
        motion
    }

    /// The circuits of curves, their common type aside, and how far each goes.
    fn over<const C: usize, const R: usize, const B: usize>(
        &self,
        net: &SizedNet<C, R, B>,
        curves: Curves<SizedNet<C, R, B>>,
    ) -> (NetMotion, Vec<Reach>) {
        let Over { samples, speed, law, .. } = self.over;
        let selected = |_: &Passes<SizedNet<C, R, B>>, circuit, _: (f64, f64)| circuit_of(circuit);
        let how = (samples, speed, law);
        let over = over_input(self.described, net, curves, self.ends, how, &selected);
        let values_of = |(point, circuits): (curve_points::ChangePoint<SizedNet<C, R, B>>, Vec<usize>)| {
            let values = self
                .described
                .outer_values(net.values(&point.at), net.balls(&point.at));
            (values, circuits, point.rays.len() + point.lost, point.finite)
        };
        let change_points = over.change_points.into_iter().map(values_of).collect();
        let (circuits, reaches) = over.circuits.into_iter().unzip();
        let motion = NetMotion {
            motion_type: "",
            search: over.search,
            circuits,
            change_points,
            moving: over.moving,
        };
        (motion, reaches)
    }

    fn through<const C: usize, const R: usize, const B: usize>(
        &self,
        net: &SizedNet<C, R, B>,
        pose: &[f64],
    ) -> NetThrough {
        let input = self.ends.0.inner;
        let rough = net.at(pose);
        let near = |at: &At<SizedNet<C, R, B>>| {
            let moved = net.difference(&rough, at);
            moved.iter().all(|d| d.abs() < PUT_RIGHT) && self.described.closes(net.values(at), net.balls(at))
        };
        let Some(at) = settled(net, input, &rough).filter(near) else {
            return NetThrough::Apart(net.residual(&net.place(&rough)));
        };
        let mut curves = Curves::new(&[input, self.ends.1.inner]);
        curves.take(net, &[at], input);
        curves.finish(net);
        let own = std::mem::take(&mut curves.curves);
        let Some(curve) = through(net, own, &at, input) else {
            return NetThrough::Still;
        };
        curves.curves = vec![curve];
        let (motion, _) = self.over(net, curves);
        match (motion.circuits.into_iter().next(), motion.moving) {
            (Some(circuit), _) => NetThrough::Circuit(Box::new(circuit)),
            (None, Some(moving)) => NetThrough::InputRests(moving),
            (None, None) => NetThrough::Still,
        }
    }
}

/// A circuit, and how far it goes.
fn circuit_of(circuit: OverInput<NetRows>) -> (NetCircuit, Reach) {
    let rows = circuit.rows.at_speed(circuit.offsets, circuit.speed);
    (NetCircuit { rows, measures: circuit.measures }, circuit.reach)
}

/// What the circuits have in common, or why there are none; `meeting` says that two limits of a column nearly do.
fn motion_type(motion: &NetMotion, meeting: bool) -> &'static str {
    let types = motion.circuits.iter().map(|c| c.measures.motion_type);
    let points = motion.change_points.iter();
    let points = points.map(|(_, circuits, ways, _)| (circuits.len(), *ways));
    common_type(types, points, meeting).unwrap_or(match &motion.search.found {
        Some(found) if found.finite == 1 => "not-followed",
        Some(_) => "rigid",
        None if !motion.change_points.is_empty() => "rigid",
        None => "cannot-assemble",
    })
}
