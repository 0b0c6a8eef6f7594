//! Modes and the whole motion of a net of one freedom over any of its tree's columns.
//!
//! Modes at many values of the input, in closed form or searched for, are followed to curves as those of a single loop are.
//!
//! Source: docs/theory_nets.md, (8).

use super::described::DescribedNet;
use super::freedoms::Freedoms;
use super::modes::Part;
use super::net::MOST_COLUMNS;
use super::net_rows::NetRows;
use super::search::{STARTS, Standing, searched, settled, standing};
use super::seeds::whole_curves;
use super::sized::WholeNet;
use crate::loops::circuits::change_points as curve_points;
use crate::loops::circuits::curve;
use crate::loops::circuits::found::Search;
use crate::loops::description::described_loop::{Column, Described};
use crate::loops::equation::closed::{At, Closed};
use crate::loops::motions::circuit::{Kept, OverInput, Reach};
use crate::loops::motions::motion::{How, common_type, limits_meet, over_input};
use crate::loops::motions::passes::Passes;
use crate::loops::motions::through::{Along, PUT_RIGHT, again, through};
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

impl<'a> Over<'a> {
    fn how(&self) -> How<'a> {
        (self.samples, self.speed, self.law)
    }
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

/// A circuit as its net followed it.
pub struct NetFollowed {
    net: WholeNet,
    kept: Kept<WholeNet>,
}

/// What goes through a pose of a net.
pub enum NetThrough {
    /// A circuit, and what makes rows of it at other inputs.
    Circuit(Box<NetCircuit>, Box<NetFollowed>),
    /// It does not close near it; how far it is from closing [rad, or relative to the size].
    Apart(f64),
    /// It closes, and no motion could be followed.
    Still,
    /// It moves with the input at rest: the columns that do.
    InputRests(Vec<usize>),
}

/// A net of one freedom as it is followed over an input, of the rows that repeat no others; it has rows in closed form where its `parts`, if
/// these are given, do.
fn whole(described: &DescribedNet, parts: Option<&[Part]>, input: Column) -> Result<WholeNet, NotFollowed> {
    let Freedoms { rank, independent, .. } = described.freedoms();
    let net = &described.net;
    let count = net.steps.len();
    if rank + 1 != count || independent.len() != *rank {
        return Err(NotFollowed::Freedoms(count - rank));
    }
    if count > MOST_COLUMNS {
        return Err(NotFollowed::Columns(count));
    }
    let whole = WholeNet::new(net, independent);
    Ok(match parts {
        Some(parts) => whole.made_of(parts, input.inner, net.size),
        None => whole,
    })
}

/// A column of the description as it is followed.
fn followed(described: &DescribedNet, column: usize) -> Result<Column, NotFollowed> {
    described.followed(column).ok_or(NotFollowed::NoColumn)
}

/// A mode that is found: the columns of the description, its closure error, whether others are near it.
pub type FoundMode = (Vec<f64>, f64, Standing);

/// The modes that are found from many places with a column at a value [rad, or length].
pub fn searched_modes(
    described: &DescribedNet,
    column: usize,
    value: f64,
) -> Result<Vec<FoundMode>, NotFollowed> {
    let held = followed(described, column)?;
    let net = whole(described, None, held)?;
    let mut found = searched(&net, held.inner, value * described.inward(column), STARTS);
    found.retain(|at| described.closes(net.values(at), net.balls(at)));
    let values_of = |at: &At<WholeNet>| {
        let values = described.outer_values(net.values(at), net.balls(at));
        (
            values,
            net.residual(&net.place(at)),
            standing(&net, held.inner, at),
        )
    };
    Ok(found.iter().map(values_of).collect())
}

/// The whole motion of a net; its modes are those of its `parts` where these are given.
pub fn net_motion(
    described: &DescribedNet,
    parts: Option<&[Part]>,
    over: &Over,
) -> Result<NetMotion, NotFollowed> {
    let ends = ends(described, over)?;
    let net = whole(described, parts, ends.0)?;
    let curves = whole_curves(described, &net, parts, [ends.0.inner, ends.1.inner]);
    let selected = |_: &Passes<WholeNet>, circuit, _: (f64, f64)| circuit_of(circuit);
    let found = over_input(described, &net, curves, ends, over.how(), &selected);
    let values_of = |(point, circuits): (curve_points::ChangePoint<WholeNet>, Vec<usize>)| {
        let values = described.outer_values(net.values(&point.at), net.balls(&point.at));
        (values, circuits, point.rays.len() + point.lost, point.finite)
    };
    let change_points = found.change_points.into_iter().map(values_of).collect();
    let (circuits, reaches): (Vec<NetCircuit>, Vec<Reach>) = found.circuits.into_iter().unzip();
    let turns = [ends.0, ends.1].map(|column| net.is_turn(column.inner));
    let meeting = limits_meet(reaches.iter(), turns);
    let mut motion = NetMotion {
        motion_type: "",
        search: found.search,
        circuits,
        change_points,
        moving: found.moving,
    };
    motion.motion_type = motion_type(&motion, meeting);
    Ok(motion)
}

/// The one circuit through a pose of a net, given by the columns of the description; its rows have a closed form where its `parts`, if these are given, do.
pub fn net_circuit_through(
    described: &DescribedNet,
    parts: Option<&[Part]>,
    pose: &[f64],
    over: &Over,
) -> Result<NetThrough, NotFollowed> {
    let ends = ends(described, over)?;
    let net = whole(described, parts, ends.0)?;
    let rough = net.at(&described.inner_values(pose));
    let near = |at: &At<WholeNet>| {
        let moved = net.difference(&rough, at);
        moved.iter().all(|d| d.abs() < PUT_RIGHT) && described.closes(net.values(at), net.balls(at))
    };
    let Some(at) = settled(&net, ends.0.inner, &rough).filter(near) else {
        return Ok(NetThrough::Apart(net.residual(&net.place(&rough))));
    };
    Ok(
        match through::<_, _, NetRows>(described, &net, &at, ends, over.how()) {
            // a pose so far out that the net hardly closes leaves nothing to tell
            Some(Along::Circuit(circuit, kept)) if !circuit.rows.is_empty() => NetThrough::Circuit(
                Box::new(circuit_of(*circuit).0),
                Box::new(NetFollowed { net, kept }),
            ),
            Some(Along::InputRests(moving)) => NetThrough::InputRests(moving),
            _ => NetThrough::Still,
        },
    )
}

/// A circuit that was followed over this input and output, once more at other inputs; `None` where none of them is in it.
pub fn net_circuit_again(
    described: &DescribedNet,
    known: &NetFollowed,
    over: &Over,
) -> Result<Option<NetCircuit>, NotFollowed> {
    let NetFollowed { net, kept } = known;
    let circuit = again(described, net, kept, ends(described, over)?, over.how());
    Ok(Some(circuit_of(circuit).0).filter(|circuit| !circuit.rows.is_empty()))
}

/// d(output)/d(input) at a pose, given by the columns of the description, where both rest; `None` where one of them moves.
pub fn ratio_at_rest(
    described: &DescribedNet,
    pose: &[f64],
    input: usize,
    output: usize,
) -> Result<Option<f64>, NotFollowed> {
    let ends = [followed(described, input)?, followed(described, output)?];
    let net = whole(described, None, ends[0])?;
    let Some(node) = curve::node_at(&net, &net.at(&described.inner_values(pose))) else {
        return Ok(None);
    };
    let [first, last] = ends.map(|column| column.inner);
    let rests = |c: usize| node.rates[0][c].abs() < RESTS;
    let factor = described.inward(input) / described.inward(output);
    Ok((rests(first) && rests(last)).then(|| node.rates[1][last] / node.rates[1][first] * factor))
}

/// The input and the output as they are followed.
fn ends(described: &DescribedNet, over: &Over) -> Result<(Column, Column), NotFollowed> {
    Ok((
        followed(described, over.input)?,
        followed(described, over.output)?,
    ))
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
