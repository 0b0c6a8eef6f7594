//! The whole motion of a loop: every circuit found, over any input and output.

use super::circuit::{Circuit, Limit, Limits, OverInput, Reach, Wanted, circuit, grid};
use super::met_twice::{Held, HeldMotions};
use super::passes::Passes;
use super::row::Row;
use super::row_store::RowStore;
use crate::loops::branch_points::counting::Uncounted;
use crate::loops::circuits::change_points as curve_points;
use crate::loops::circuits::curve::Curve;
use crate::loops::circuits::found::{Found, Search};
use crate::loops::circuits::known_curves::Curves;
use crate::loops::circuits::search::curves;
use crate::loops::description::described_loop::{Column, Described, Loop};
use crate::loops::description::holding::column_at_rest;
use crate::loops::description::joint_values::joint_values;
use crate::loops::equation::closed::Closed;
use crate::loops::equation::rotations::short_way;
use crate::loops::mobility::singular_place::SAME_LIMIT;
use crate::loops::modes::finder::Completeness;

/// A circuit of less extent [rad, or relative to the size] is nearly an isolated pose: its other joints move about as little as the one
/// whose limits meet.
const NEARLY_A_POSE: f64 = 1e-3;

/// A second derivative of a column by the length of the curve [1/rad, or relative to the size] below which it rests at a limit: where
/// curves part at a gap it is about half the gap, elsewhere about 1.
const RESTING: f64 = 1e-4;

/// A pose at which curves meet, or an isolated pose.
#[derive(Clone, Debug)]
pub struct ChangePoint {
    /// The value of each column.
    pub values: Vec<f64>,
    /// The circuits that pass it or end there, by their number; none if it is isolated.
    pub circuits: Vec<usize>,
    /// How many ways lead out of it.
    pub ways: usize,
    /// The greatest mobility of a motion out of it; 0 if it is isolated.
    pub freedoms: usize,
}

/// What a loop does.
#[derive(Clone, Debug)]
pub struct Motion {
    /// The circuits' common type or "mixed", or why there are none.
    pub motion_type: &'static str,
    /// Where circuits were looked for, and what was found out.
    pub search: Search,
    /// The circuits.
    pub circuits: Vec<Circuit>,
    /// Poses at which the motion is not smooth.
    pub change_points: Vec<ChangePoint>,
    /// Columns that move with the input at rest, if the loop moves somewhere so.
    pub moving: Option<Vec<usize>>,
}

/// What a motion is computed over.
#[derive(Clone, Copy)]
struct Asked<'a> {
    input: usize,
    output: usize,
    samples: usize,
    speed: f64,
    law: Option<&'a [[f64; 4]]>,
    keep: bool,
}

/// Every circuit over the inputs of one column, on a grid of `samples` a turn or at the inputs of a law.
///
/// Without `keep` the circuits of a grid have courses in place of rows. `None` where one of the columns is no joint of one freedom that
/// moves.
pub fn motion(
    linkage: &Loop,
    input: usize,
    output: usize,
    samples: usize,
    speed: f64,
    law: Option<&[[f64; 4]]>,
    keep: bool,
) -> Option<Motion> {
    let Some(chain) = &linkage.reduced.chain else {
        let search = Search::new(Completeness::Searched);
        return Some(Motion {
            motion_type: motion_type(linkage, &search, &[], &[], false),
            search,
            circuits: Vec::new(),
            change_points: Vec::new(),
            moving: None,
        });
    };
    let (driver, follower) = (linkage.inner(input)?, linkage.inner(output)?);
    let curves = curves(chain, &[driver.inner, follower.inner], false);
    let mut held = held_motions(linkage, &curves, &[input, output], false);
    let asked = Asked { input, output, samples, speed, law, keep };
    let mut motion = followed(linkage, curves, &asked)?;
    motion.search.unfollowed -= held.explained;
    if !held.motions.is_empty() {
        held.search(linkage, &[input, output]);
        motion.search.completeness = Completeness::Searched;
    }
    for one in held.motions {
        motion.add(one, &asked);
    }
    let turns = [driver, follower].map(|column| chain.is_turn(column.inner));
    let meeting = limits_meet(motion.circuits.iter().map(|c| &c.reach), turns);
    motion.motion_type = motion_type(
        linkage,
        &motion.search,
        &motion.circuits,
        &motion.change_points,
        meeting,
    );
    Some(motion)
}

/// The motions along which a constraint is met twice over, where there are no others.
fn held_motions(linkage: &Loop, curves: &Curves, wished: &[usize], first_only: bool) -> HeldMotions {
    let moves = curves.search.found.as_ref().is_some_and(|f| f.finite == 1);
    if moves && curves.curves.is_empty() {
        HeldMotions::through(linkage, &curves.lost, wished, first_only)
    } else {
        HeldMotions::default()
    }
}

/// The motion along curves, its type aside.
fn followed(linkage: &Loop, curves: Curves, asked: &Asked) -> Option<Motion> {
    let Asked { samples, speed, law, keep, .. } = *asked;
    let chain = linkage.reduced.chain.as_ref()?;
    let ends = ends(linkage, asked.input, asked.output)?;
    // one after the other, since the rows of all may not fit into memory
    let selected = |passes: &Passes, circuit: OverInput<Vec<Row>>, grid| {
        let circuit = Circuit::from(circuit);
        if keep || law.is_some() {
            circuit
        } else {
            circuit.on_course(linkage, passes, grid)
        }
    };
    let how = (samples, speed, law);
    let over = over_input(linkage, chain, curves, ends, how, &selected);
    let change_points = over.change_points.into_iter().map(|(at, circuits)| ChangePoint {
        values: joint_values(linkage, &at.at),
        circuits,
        ways: at.rays.len() + at.lost,
        freedoms: at.finite,
    });
    Some(Motion {
        motion_type: "",
        search: over.search,
        circuits: over.circuits,
        change_points: change_points.collect(),
        moving: over.moving,
    })
}

/// Curves over an input.
pub(crate) struct Over<S: Closed, C> {
    pub circuits: Vec<C>,
    /// Each with the circuits that pass it or end there.
    pub change_points: Vec<(curve_points::ChangePoint<S>, Vec<usize>)>,
    /// As the curves have it, with columns of the description.
    pub search: Search,
    /// Columns of the description that move where the input rests, if it does somewhere.
    pub moving: Option<Vec<usize>>,
}

/// Rows: so many samples a turn, at a speed, or by a law.
pub(crate) type How<'a> = (usize, f64, Option<&'a [[f64; 4]]>);

/// What is kept of a circuit, by its passes and the origin and step of the inputs of its rows.
type Selected<'a, S, K, C> = dyn 'a + Fn(&Passes<S>, OverInput<K>, (f64, f64)) -> C;

/// Curves over an input; `selected` is what is kept of each circuit, by its passes and the origin and step of the inputs of its rows.
pub(crate) fn over_input<S: Closed, D: Described, K: RowStore<S>, C>(
    linkage: &D,
    chain: &S,
    mut curves: Curves<S>,
    (driver, follower): (Column, Column),
    (samples, speed, law): How,
    selected: &Selected<'_, S, K, C>,
) -> Over<S, C> {
    let own = std::mem::take(&mut curves.curves);
    let rests = |c: &Curve<S>| c.rests(driver.inner);
    let moving = own.iter().any(rests).then(|| moving(linkage, &own));
    let passes: Vec<Passes<S>> = own
        .into_iter()
        .filter(|c| !rests(c))
        .filter_map(|c| Passes::new(chain, c, driver.inner))
        .collect();
    let grid = grid(chain, &passes, samples);
    let wanted = Wanted { driver, follower, grid, speed, law };
    // a pose so far out that the loop hardly closes leaves nothing to tell
    let (passes, circuits): (Vec<Passes<S>>, Vec<C>) = passes
        .into_iter()
        .filter_map(|p| {
            let circuit: OverInput<K> = circuit(linkage, &p, &wanted);
            (circuit.rows.count() > 0).then(|| {
                let circuit = selected(&p, circuit, grid);
                (p, circuit)
            })
        })
        .unzip();
    let on_circuits = |point: &curve_points::ChangePoint<S>| {
        let numbers = 0..passes.len();
        numbers
            .filter(|&k| point.is_on(chain, &passes[k].curve))
            .collect()
    };
    let change_points = curves.change_points.into_iter();
    let change_points = change_points
        .map(|point| {
            let on = on_circuits(&point);
            (point, on)
        })
        .collect();
    let outer = |inner: usize| (0..linkage.columns()).find(|&c| linkage.followed_column(c) == Some(inner));
    let mut search = curves.search;
    search.columns = search.columns.iter().filter_map(|&c| outer(c)).collect();
    search.columns.sort_unstable();
    search.count = search.count.and_then(|mut count| {
        count.column = outer(count.column).ok_or(Uncounted::Searched)?;
        let inward = linkage.inward(count.column);
        for open in &mut count.open {
            (open.from, open.to) = (open.from / inward, open.to / inward);
        }
        Ok(count)
    });
    Over { circuits, change_points, search, moving }
}

impl Motion {
    /// Takes in the circuits of the loop with a joint held that rests along them.
    fn add(&mut self, held: Held, asked: &Asked) {
        let Held { still, linkage, curves } = held;
        // no claim is made of isolated solutions where others are double
        self.search.count = Err(Uncounted::Lost);
        self.search.found.clone_from(&curves.search.found);
        if linkage.inner(asked.input).is_none() {
            self.moving = Some(moving(&linkage, &curves.curves));
            return;
        }
        let Some(more) = followed(&linkage, curves, asked) else {
            return;
        };
        if more.search.completeness == Completeness::Searched {
            self.search.completeness = Completeness::Searched;
        }
        self.search.unfollowed += more.search.unfollowed;
        let before = self.circuits.len();
        self.circuits.extend(
            more.circuits
                .into_iter()
                .map(|c| c.holding(still, &linkage, asked.output)),
        );
        self.change_points
            .extend(more.change_points.into_iter().map(|mut point| {
                point.circuits.iter_mut().for_each(|k| *k += before);
                point
            }));
        self.moving = more.moving.or(self.moving.take());
    }
}

/// Whether a gap of less than `SAME_LIMIT` parts two limits of the input, or of the output, at both of which it hardly moves while other
/// joints do, or a circuit is as narrow; `turns` says which of the two turn.
///
/// Next to a kite folded flat the other joints nearly move with the input at rest, from one limit to the other, and it takes next to nothing
/// to join these. Limits that are equal otherwise, as by symmetry, or overlap where an output dwells, join nothing.
pub(crate) fn limits_meet<'a>(circuits: impl Iterator<Item = &'a Reach> + Clone, turns: [bool; 2]) -> bool {
    (0..2).any(|k| {
        let all = || circuits.clone().map(|c| &c.limits[k]);
        let resting = |limit: &&Limit| limit.bend.abs() < RESTING;
        let gap = |upper: f64, lower: f64| {
            let apart = lower - upper;
            if turns[k] { short_way(apart) } else { apart }
        };
        let nearly_joined = all().flat_map(|l| &l.upper).filter(resting).any(|upper| {
            all()
                .flat_map(|l| &l.lower)
                .filter(resting)
                .any(|lower| (0.0..SAME_LIMIT).contains(&gap(upper.value, lower.value)))
        });
        let nearly_nothing = circuits.clone().filter(|c| c.extent < NEARLY_A_POSE).any(|c| {
            let Limits { upper, lower } = &c.limits[k];
            matches!((upper.as_slice(), lower.as_slice()), (&[up, ..], &[low, ..]) if up.value - low.value < SAME_LIMIT)
        });
        nearly_joined || nearly_nothing
    })
}

/// What the circuits have in common, or why there are none; `meeting` says that two limits of a joint nearly do.
fn motion_type(
    linkage: &Loop,
    search: &Search,
    circuits: &[Circuit],
    change_points: &[ChangePoint],
    meeting: bool,
) -> &'static str {
    let types = circuits.iter().map(|c| c.measures.motion_type);
    let points = change_points.iter().map(|p| (p.circuits.len(), p.ways));
    common_type(types, points, meeting).unwrap_or_else(|| {
        match &search.found {
            Some(found) if found.finite > 1 => "two-inputs",
            // a motion was seen beside a pose, and could not be followed
            Some(found) if found.finite == 1 => "not-followed",
            Some(_) => "rigid",
            None if !change_points.is_empty() => "rigid",
            // rank six at most
            None if !linkage.can_be_driven() && linkage.freedoms() > 7 => "two-inputs",
            None => "cannot-assemble",
        }
    })
}

/// The common type of circuits of these types, or "mixed"; none where there are no circuits. Of each change point it takes how many circuits
/// meet there, and how many ways lead out.
pub(crate) fn common_type(
    mut types: impl Iterator<Item = &'static str>,
    mut change_points: impl Iterator<Item = (usize, usize)>,
    meeting: bool,
) -> Option<&'static str> {
    let one = types.next()?;
    // from an isolated pose, too, a circuit may grow
    let changes = |(circuits, ways)| ways == 0 || circuits > 0;
    Some(if meeting || change_points.any(changes) {
        "change-point"
    } else if types.all(|other| other == one) {
        one
    } else {
        "mixed"
    })
}

/// Input and output as the chain has them; an output that rests where a joint is held is the next.
pub(super) fn ends(linkage: &Loop, input: usize, output: usize) -> Option<(Column, Column)> {
    let follower = linkage
        .inner(output)
        .or_else(|| column_at_rest(linkage, output))?;
    Some((linkage.inner(input)?, follower))
}

/// The columns that move along some of the curves.
pub(super) fn moving<S: Closed, D: Described>(linkage: &D, curves: &[Curve<S>]) -> Vec<usize> {
    let moves = |c: usize| curves.iter().any(|curve| !curve.rests(c));
    (0..linkage.columns())
        .filter(|&column| linkage.followed_column(column).is_some_and(moves))
        .collect()
}

/// How freely the loop moves, from the first poses found over the values of a column.
pub fn mobility(linkage: &Loop, column: usize) -> Option<Found> {
    let chain = linkage.reduced.chain.as_ref()?;
    let curves = curves(chain, &[linkage.chain_column(column)?], true);
    let held = held_motions(linkage, &curves, &[column], true).motions;
    let search = held.into_iter().next().map_or(curves.search, |h| h.curves.search);
    search.found
}
