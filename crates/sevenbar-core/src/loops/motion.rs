//! The whole motion of a loop: every circuit found, over any input and output.

use super::chain::{Chain, Configuration, Joint};
use super::circuits::Passes;
use super::counting::{Count, Uncounted};
use super::curve::{Curve, End, Node};
use super::dense::{COLUMNS, Columns};
use super::description::Loop;
use super::extremes::{Ends, output_extremes};
use super::modes::Completeness;
use super::polish::{Settled, polish};
use super::rates::ORDERS;
use super::rotations::short_way;
use super::row::Row;
use super::rows::{self, Rows};
use super::search::{Curves, Found, curves};
use super::turnings;
use crate::outcome::{DeadCentre, DeadCentreKind, RowStatus};
use std::f64::consts::TAU;

/// How far a joint of a given pose [rad, or parts of the size] may be moved to close the loop.
const PUT_RIGHT: f64 = 0.05;

/// One connected motion over an input.
#[derive(Clone, Debug)]
pub struct Circuit {
    /// The rows.
    pub rows: Rows,
    /// Whether it comes back to its first pose.
    pub closed: bool,
    /// Whether it ends where it is not smooth.
    pub singular: bool,
    /// Turns that the input gains until it closes, be it with dead centres on the way; none where it rocks.
    pub turns: usize,
    /// Ranges of input and output; `None` for a joint that turns fully.
    pub input: Option<[f64; 2]>,
    /// The output's.
    pub output: Option<[f64; 2]>,
    /// In the order of the circuit.
    pub dead_centres: Vec<DeadCentre>,
    /// Lowest and highest velocity, acceleration and jerk of the output at unit speed of the input, each with the input.
    pub extremes: [Option<Ends>; ORDERS],
}

/// A pose at which curves meet, or one that stands alone.
#[derive(Clone, Debug)]
pub struct ChangePoint {
    /// The value of each column.
    pub values: Vec<f64>,
    /// The circuits that pass it or end there, by their number; none where it stands alone.
    pub circuits: Vec<usize>,
    /// How many ways lead out of it.
    pub ways: usize,
    /// The most freedoms of a motion out of it; none where it stands alone.
    pub freedoms: usize,
}

/// What a loop does.
#[derive(Clone, Debug)]
pub struct Motion {
    /// How many freedoms it has and how they were counted; `None` where it was not found in any pose.
    pub found: Option<Found>,
    /// How completely the modes at the seeds are known.
    pub completeness: Completeness,
    /// The account of the branch points of the first seed column, or why there is none.
    pub count: Result<Count, Uncounted>,
    /// Columns at whose values all modes were found.
    pub seed_columns: Vec<usize>,
    /// How many values of each.
    pub seeds: usize,
    /// Modes at the seeds that run into a place where the motion is not smooth, or do not move.
    pub still: usize,
    /// By how much redundant constraints keep other poses at the seeds open, least first [rad, or parts of the size].
    pub misfits: Vec<f64>,
    /// Modes at the input's value zero; `None` where that is no seed.
    pub modes_at_zero: Option<usize>,
    /// The circuits.
    pub circuits: Vec<Circuit>,
    /// Poses at which the motion is not smooth.
    pub change_points: Vec<ChangePoint>,
    /// Whether the loop moves somewhere with the input at rest.
    pub input_rests: bool,
    /// Columns that move with it at rest.
    pub moving: Vec<usize>,
}

/// What goes through a pose.
#[derive(Clone, Debug)]
pub enum Through {
    /// The loop closes near the pose, and moves.
    Circuit(Box<Circuit>),
    /// It does not close near it; how far it is from closing, in parts of the size or radians.
    Apart(f64),
    /// It closes and no motion could be followed.
    Still,
    /// It moves with the input at rest: the columns that do.
    InputRests(Vec<usize>),
}

/// Every circuit over the inputs of one column, on a grid of `samples` a turn or at the inputs of a law.
///
/// `None` where one of the columns is no joint of one freedom that moves.
pub fn motion(
    linkage: &Loop,
    input: usize,
    output: usize,
    samples: usize,
    speed: f64,
    law: Option<&[[f64; 4]]>,
) -> Option<Motion> {
    let Some(chain) = &linkage.reduced.chain else {
        return Some(Motion {
            found: None,
            completeness: Completeness::Searched,
            count: Err(Uncounted::Searched),
            seed_columns: Vec::new(),
            seeds: 0,
            still: 0,
            misfits: Vec::new(),
            modes_at_zero: None,
            circuits: Vec::new(),
            change_points: Vec::new(),
            input_rests: false,
            moving: Vec::new(),
        });
    };
    let (a, b) = (linkage.chain_column(input)?, linkage.chain_column(output)?);
    let mut curves = curves(chain, &[a, b], false);
    let followed = std::mem::take(&mut curves.curves);
    let input_rests = followed.iter().any(|c| c.rests(a));
    let moving = if input_rests {
        moving(linkage, &followed)
    } else {
        Vec::new()
    };
    let passes: Vec<Passes> = followed
        .into_iter()
        .filter(|c| !c.rests(a))
        .filter_map(|c| Passes::new(chain, c, a))
        .collect();
    let (origin, step) = grid(chain, &passes, a, samples);
    // a pose so far out that the loop hardly closes leaves nothing to tell
    let (passes, circuits): (Vec<&Passes>, Vec<Circuit>) = passes
        .iter()
        .map(|p| {
            (
                p,
                circuit(linkage, p, (input, output), (a, b), (origin, step), speed, law),
            )
        })
        .filter(|(_, c)| !c.rows.is_empty())
        .unzip();
    let change_points = curves
        .change_points
        .iter()
        .map(|point| ChangePoint {
            values: rows::joint_values(linkage, &point.at),
            circuits: (0..passes.len())
                .filter(|&k| point.is_on(chain, &passes[k].curve))
                .collect(),
            ways: point.rays.len(),
            freedoms: point.finite,
        })
        .collect();
    let outer = |inner: usize| (0..linkage.columns).find(|&c| linkage.chain_column(c) == Some(inner));
    let mut seed_columns: Vec<usize> = curves.seed_columns.iter().filter_map(|&c| outer(c)).collect();
    seed_columns.sort_unstable();
    let count = curves.count.and_then(|mut count| {
        count.column = outer(count.column).ok_or(Uncounted::Searched)?;
        Ok(count)
    });
    Some(Motion {
        found: curves.found,
        completeness: curves.completeness,
        count,
        seed_columns,
        seeds: curves.seeds,
        still: curves.still,
        misfits: curves.misfits,
        modes_at_zero: curves.modes_at_zero,
        circuits,
        change_points,
        input_rests,
        moving,
    })
}

/// The one circuit through a pose, given by its joint values and closed by Newton's method with the input held.
///
/// `None` where one of the columns is no joint of one freedom that moves.
pub fn circuit_through(
    linkage: &Loop,
    values: &[f64],
    input: usize,
    output: usize,
    samples: usize,
    speed: f64,
    law: Option<&[[f64; 4]]>,
) -> Option<Through> {
    let chain = linkage.reduced.chain.as_ref()?;
    let (a, b) = (linkage.chain_column(input)?, linkage.chain_column(output)?);
    let rough = rows::configuration(linkage, values);
    let Some(Settled { at: pose, .. }) = polish(chain, a, &rough, PUT_RIGHT).filter(Settled::agrees) else {
        return Some(Through::Apart(chain.residual(&chain.place(&rough))));
    };
    let mut curves = Curves::new(&[a, b]);
    curves.take(chain, &[pose], a);
    curves.finish(chain);
    let Some(curve) = curves.curves.pop() else {
        return Some(Through::Still);
    };
    if curve.rests(a) {
        return Some(Through::InputRests(moving(linkage, &[curve])));
    }
    let Some(passes) = Passes::new(chain, curve, a) else {
        return Some(Through::Still);
    };
    let grid = grid(chain, std::slice::from_ref(&passes), a, samples);
    let circuit = circuit(linkage, &passes, (input, output), (a, b), grid, speed, law);
    Some(Through::Circuit(Box::new(circuit)))
}

/// The columns that move along some of the curves.
fn moving(linkage: &Loop, curves: &[Curve]) -> Vec<usize> {
    let moves = |c: usize| curves.iter().any(|curve| !curve.rests(c));
    (0..linkage.columns)
        .filter(|&column| linkage.chain_column(column).is_some_and(moves))
        .collect()
}

/// How freely the loop moves, from the first poses found over the values of a column.
pub fn mobility(linkage: &Loop, column: usize) -> Option<Found> {
    let chain = linkage.reduced.chain.as_ref()?;
    curves(chain, &[linkage.chain_column(column)?], true).found
}

fn circuit(
    linkage: &Loop,
    passes: &Passes,
    columns: (usize, usize),
    inner: (usize, usize),
    grid: (f64, f64),
    speed: f64,
    law: Option<&[[f64; 4]]>,
) -> Circuit {
    let chain = linkage.reduced.chain.as_ref().unwrap_or_else(|| unreachable!());
    let (a, b) = inner;
    let (first, last) = (
        &passes.curve.nodes[0],
        &passes.curve.nodes[passes.curve.nodes.len() - 1],
    );
    let gained = passes.curve.gained();
    let closed = passes.curve.end == End::Closed;
    let turning = |c: usize| passes.curve.goes_round(chain, c);
    // never stopped by a dead centre
    let driven_round = turning(a) && !passes.turns_back();
    let mut rows = passes.rows(grid.0, grid.1);
    if !closed {
        // an input of the grid may touch an end at which the motion is not smooth, and nothing closes there
        let lost = |r: &Row| r.status == RowStatus::NoSolution;
        rows.truncate(rows.len() - rows.iter().rev().take_while(|r| lost(r)).count());
        rows.drain(..rows.iter().take_while(|r| lost(r)).count());
    }
    if driven_round {
        begin_at_zero(chain, &mut rows, a, &gained, grid.1);
    }
    let crosses = passes.curve.crosses();
    let extremes = if driven_round && !crosses && law.is_none() {
        output_extremes(passes, &rows, b, &gained, grid.1)
    } else {
        [None; ORDERS]
    };
    // whole turns that bring the first row into (-pi, pi]
    let mut shift = [0.0; COLUMNS];
    if let Some(row) = rows.iter().find(|r| r.status != RowStatus::NoSolution) {
        for (c, s) in shift.iter_mut().enumerate() {
            if chain.is_turn(c) {
                *s = -TAU * ((row.at.values[c] - short_way(row.at.values[c])) / TAU).round();
            }
        }
    }
    let scale = |column: usize| 1.0 / linkage.inward(column);
    let outward = |c: usize, column: usize, v: f64| (v + shift[c]) * scale(column);
    let place = |n: &Configuration| {
        (
            outward(a, columns.0, n.values[a]),
            outward(b, columns.1, n.values[b]),
        )
    };
    let mut dead_centres: Vec<DeadCentre> = Vec::new();
    for (n, limit) in passes.limits.iter().enumerate() {
        if closed && n + 1 == passes.limits.len() && n > 0 {
            break;
        }
        let (input, output) = place(&limit.at);
        dead_centres.push(DeadCentre {
            kind: DeadCentreKind::Input,
            input,
            output,
            branch: n.min(passes.passes.len() - 1),
            condition: limit.inverse_norm,
        });
    }
    let turnings = turnings::turnings(&passes.curve, chain, b);
    for t in &turnings {
        let (input, output) = place(&t.node.at);
        let branch = passes.passes.iter().position(|p| t.segment < p.to).unwrap_or(0);
        dead_centres.push(DeadCentre {
            kind: DeadCentreKind::Output,
            input,
            output,
            branch,
            condition: t.node.inverse_norm,
        });
    }
    let range = |c: usize, column: usize, nodes: &mut dyn Iterator<Item = &Node>| {
        nodes
            .map(|n| outward(c, column, n.at.values[c]))
            .fold([f64::INFINITY, f64::NEG_INFINITY], |m, v| {
                [m[0].min(v), m[1].max(v)]
            })
    };
    let ends = [first, last];
    // a closed circuit has its extremes where it turns back, an open one perhaps at its ends
    let open_ends = if closed && !turnings.is_empty() {
        &ends[..0]
    } else {
        &ends[..]
    };
    let input_range = (!turning(a)).then(|| range(a, columns.0, &mut passes.limits.iter().chain(ends)));
    let output_range = (!turning(b)).then(|| {
        let turned = turnings.iter().map(|t| &t.node);
        range(b, columns.1, &mut turned.chain(open_ends.iter().copied()))
    });
    if let Some(law) = law {
        let inner_law: Vec<[f64; 4]> = law
            .iter()
            .map(|q| q.map(|x| x * linkage.inward(columns.0)))
            .collect();
        rows = passes.law_rows(&inner_law, chain.is_turn(a), shift[a]);
    }
    let mut offsets = vec![0.0; linkage.columns];
    for (column, offset) in offsets.iter_mut().enumerate() {
        if let Some(c) = linkage.chain_column(column) {
            *offset = shift[c];
        }
    }
    Circuit {
        rows: Rows {
            rows,
            offsets,
            speed: if law.is_some() {
                1.0
            } else {
                speed * linkage.inward(columns.0)
            },
        },
        closed,
        singular: passes.curve.end == End::Singular || crosses,
        turns: if turning(a) {
            (gained[a] / TAU).abs().round() as usize
        } else {
            0
        },
        input: input_range,
        output: output_range,
        dead_centres,
        extremes: extremes
            .map(|e| e.map(|ends| ends.map(|[value, at]| [value * scale(columns.1), at + shift[a]]))),
    }
}

/// Origin and step of the inputs of rows.
fn grid(chain: &Chain, passes: &[Passes], input: usize, samples: usize) -> (f64, f64) {
    if chain.joints[chain.joint_of(input)] != Joint::Slide {
        return (0.0, TAU / samples as f64);
    }
    let mut ends = [f64::INFINITY, f64::NEG_INFINITY];
    for pass in passes.iter().flat_map(|p| &p.passes) {
        ends = [
            ends[0].min(pass.start).min(pass.end),
            ends[1].max(pass.start).max(pass.end),
        ];
    }
    let span = ends[1] - ends[0];
    if span > 0.0 {
        (ends[0], span / samples as f64)
    } else {
        (0.0, 1.0)
    }
}

/// Rows of a circuit that goes round, begun at the input zero.
fn begin_at_zero(chain: &Chain, rows: &mut [Row], input: usize, gained: &Columns, step: f64) {
    let whole =
        |r: &Row| (r.at.values[input] / TAU - (r.at.values[input] / TAU).round()).abs() * TAU < 0.5 * step;
    let Some(first) = rows.iter().position(whole) else {
        return;
    };
    for row in &mut rows[..first] {
        for c in 0..chain.columns {
            row.at.values[c] += gained[c];
        }
    }
    rows.rotate_left(first);
}
