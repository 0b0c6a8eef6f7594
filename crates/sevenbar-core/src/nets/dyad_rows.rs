//! Rows of a planar net whose blocks are all dyads, in closed form: each dyad lies on one side all along a pass.
//!
//! The two ways to put a dyad together differ by the sign of its sine, which is zero only at a dead centre of the input. So the signs are read
//! at the ends of a stretch of a pass, and all orders of the motion between follow dyad by dyad in power series. Equations
//! are solved for the condition number alone.
//!
//! Source: docs/theory_nets.md, (14) to (17).

use super::dyad_sides::{Found, Joined, Poses, on};
use super::dyads::{Pair, Plane};
use super::in_plane::{Complex, InPlane};
use super::joints::TERMS;
use super::modes::{Part, Stage};
use super::net::{MOST_COLUMNS, Net};
use super::pin_rows::PinRows;
use super::rows::{On, Row};
use super::series::Series;
use super::square::Square;
use super::steps::Move;
use crate::loops::equation::closed::MOST_SIGNS;
use crate::number::Number;
use crate::rigid::{Vec3, dot};
use crate::vector_math::{ROUNDER, atan2_side_by_side};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Rows of a dyad with a sine of less are left to Newton's method: the closed form loses as many digits as the sine has zeros.
const LEAST: f64 = 0.02;

const _: () = assert!(MOST_COLUMNS / 2 == MOST_SIGNS);

/// A direction may lean out of the plane, or across it, by rounding.
const LEAN: f64 = 1e-12;

/// How a column moves its link against the link before it.
#[derive(Clone, Copy, Debug)]
enum Moves {
    /// About a place, to the left or to the right.
    Turn(Complex64, f64),
    Slide(Complex64),
}

#[derive(Clone, Copy, Debug)]
struct Column {
    parent: On,
    moves: Moves,
    reads: f64,
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    Along { at: Complex64, v: Complex64 },
    Angle { u: Complex64, v: Complex64, rest: f64 },
}

#[derive(Clone, Debug)]
struct PlanarRow {
    on: [On; 2],
    kind: Kind,
    /// The columns that move the one link and not the other, with a sign for each side.
    columns: Vec<(usize, f64)>,
}

/// A net of dyads over one input, lengths relative to the size.
#[derive(Clone, Debug)]
pub(super) struct DyadRows {
    driven: usize,
    columns: Vec<Column>,
    stages: Vec<Joined>,
    rows: Vec<PlanarRow>,
    /// What columns that are not in use add to the squares of `A`.
    besides: f64,
    /// The same where all joints are pins.
    pub pins: Option<PinRows>,
}

impl DyadRows {
    /// Of a net with lengths relative to a size, of which `parts` have them as they are, with a column driven; `besides` is what columns not in
    /// use add to the squares of `A`. `None` where not all is made up of dyads in one plane.
    pub fn of(net: &Net, parts: &[Part], driven: usize, size: f64, besides: f64) -> Option<Self> {
        let stages: Option<Vec<&Stage>> = parts
            .iter()
            .map(|part| match part {
                Part::Dyad(stage) => Some(stage),
                Part::Planar(_) | Part::Body(_) | Part::Loop(_) => None,
            })
            .collect();
        let stages = stages?;
        let normal = stages.first()?.dyad.normal;
        let plane = Plane::across(normal);
        let is_across = |v: Vec3| dot(v, normal).abs() < LEAN;
        let side = |v: Vec3| dot(v, normal).signum();
        let is_along = |v: Vec3| (dot(v, normal).abs() - 1.0).abs() < LEAN && plane.place(v).norm() < LEAN;
        let mut known = vec![false; net.steps.len()];
        known[driven] = true;
        for stage in &stages {
            let slides = stage.dyad.pairs.iter().all(|pair| match pair {
                Pair::Hinge(_) => true,
                Pair::Slide(along) => is_across(*along),
            });
            let hangs = stage.known.iter().flatten().all(|&k| known[k]);
            if !(slides && hangs && is_along(stage.dyad.normal)) {
                return None;
            }
            for k in stage.links {
                known[k] = true;
            }
        }
        let counts = net.steps.len() == 1 + 2 * stages.len() && net.steps.len() <= MOST_COLUMNS;
        if !counts || !known.iter().all(|&k| k) || net.steps[driven].parent.is_some() {
            return None;
        }
        let columns: Option<Vec<Column>> = net
            .steps
            .iter()
            .map(|step| {
                let moves = match step.moves {
                    Move::Turn if is_along(step.axis) => {
                        Moves::Turn(plane.place(step.origin), side(step.axis))
                    }
                    Move::Slide if is_across(step.axis) => Moves::Slide(plane.place(step.axis)),
                    _ => return None,
                };
                Some(Column { parent: step.parent, moves, reads: step.reads })
            })
            .collect();
        let rows: Option<Vec<PlanarRow>> = net
            .rows
            .iter()
            .map(|row| {
                let kind = match *row {
                    Row::Along { at, v, .. } => Kind::Along { at: plane.place(at), v: plane.place(v) },
                    Row::Angle { u, v, cosine, .. } => Kind::Angle {
                        u: plane.place(u),
                        v: plane.place(v),
                        rest: dot(u, normal) * dot(v, normal) - cosine,
                    },
                    Row::Length { .. } => return None,
                };
                let [first, second] = net.sides(row);
                let signed = |columns: Vec<usize>, sign| columns.into_iter().map(move |c| (c, sign));
                let columns = signed(first, 1.0).chain(signed(second, -1.0)).collect();
                Some(PlanarRow { on: row.on(), kind, columns })
            })
            .collect();
        let pins = PinRows::of(net, &stages, &plane, driven, (size, besides));
        Some(Self {
            pins,
            driven,
            columns: columns?,
            stages: stages
                .iter()
                .map(|stage| Joined::of(stage, &plane, size))
                .collect(),
            rows: rows?,
            besides,
        })
    }

    /// How many columns there are.
    #[inline(always)]
    pub fn columns(&self) -> usize {
        self.columns.len()
    }

    /// The column that is driven.
    pub fn driven(&self) -> usize {
        self.driven
    }

    /// The dyads, in the order in which they are put together.
    pub fn stages(&self) -> &[Joined] {
        &self.stages
    }

    /// The pose of the driven link at a value of the input.
    #[inline(always)]
    pub fn begin<N: Number>(&self, input: N, poses: &mut Poses<N>) {
        let driven = self.columns[self.driven];
        let z = match driven.moves {
            Moves::Turn(_, side) => {
                let (im, re) = (input - N::splat(driven.reads)).sin_cos();
                Complex { re, im: im.scaled(side) }
            }
            Moves::Slide(_) => Complex::constant(Complex64::ONE),
        };
        poses[self.driven] = driven.moved(&InPlane::still(), z, input);
    }

    /// The sines of all dyads at values of the columns.
    pub fn sines(&self, values: &[f64]) -> [f64; MOST_SIGNS] {
        let mut poses = [InPlane::still(); MOST_COLUMNS];
        for (c, column) in self.columns.iter().enumerate() {
            let before = on(&poses, column.parent);
            let turned = match column.moves {
                Moves::Turn(_, side) => Complex::constant(Complex64::cis(side * (values[c] - column.reads))),
                Moves::Slide(_) => Complex::constant(Complex64::ONE),
            };
            poses[c] = column.moved(&before, before.z.times(turned), values[c]);
        }
        let mut sines = [0.0; MOST_SIGNS];
        for (sine, stage) in sines.iter_mut().zip(&self.stages) {
            *sine = stage.sine(&poses);
        }
        sines
    }

    /// The sides on which all dyads lie between two places; `None` where one of them is not known.
    pub fn sides(&self, ends: [&[f64]; 2]) -> Option<[f64; MOST_SIGNS]> {
        let [first, second] = ends.map(|values| self.sines(values));
        let mut sides = [0.0; MOST_SIGNS];
        for (k, _) in self.stages.iter().enumerate() {
            let [lesser, greater] = if first[k].abs() < second[k].abs() {
                [first[k], second[k]]
            } else {
                [second[k], first[k]]
            };
            // one that lies on either side has passed a change point
            let changes = lesser.abs() > LEAST && lesser * greater < 0.0;
            if changes || greater.abs() <= LEAST {
                return None;
            }
            sides[k] = greater.signum();
        }
        Some(sides)
    }

    /// Cosine and sine of what columns turn by at values, where these are wanted.
    pub fn turns(&self, values: &[f64], turns: &mut [[f64; 2]]) {
        if self.pins.is_some() {
            for ((column, value), turn) in self.columns.iter().zip(values).zip(turns) {
                let (sine, cosine) = (value - column.reads).sin_cos();
                *turn = [cosine, sine];
            }
        }
    }

    /// Whether a row with such a least sine is sure.
    #[inline(always)]
    pub fn is_sure(sine: f64) -> bool {
        sine > LEAST
    }

    /// The row with the input's series, with turns of columns counted on from those of a place near by.
    #[inline(always)]
    pub fn row<M: Number>(&self, sides: &[f64; MOST_SIGNS], input: [M; TERMS], near: &[f64]) -> Found<M> {
        let mut poses: Poses<Series<M, TERMS>> = [InPlane::still(); MOST_COLUMNS];
        self.begin(Series(input), &mut poses);
        for (k, stage) in self.stages.iter().enumerate() {
            let both = stage.put(&poses, sides[k]);
            poses[stage.links[0]] = both[0];
            poses[stage.links[1]] = both[1];
        }
        let mut found = Found::nothing();
        self.read(&poses, near, &mut found);
        found.values[self.driven] = input[0];
        for order in 1..TERMS {
            found.rates[order - 1][self.driven] = input[order].scaled(order as f64);
        }
        // links put where the columns say, so that the rows show how well all closes
        let mut placed: Poses<M> = [InPlane::still(); MOST_COLUMNS];
        for (c, column) in self.columns.iter().enumerate() {
            let before = on(&placed, column.parent);
            let z = match column.moves {
                Moves::Turn(..) => value_of(poses[c].z),
                Moves::Slide(_) => before.z,
            };
            placed[c] = column.moved(&before, z, found.values[c]);
        }
        for (k, stage) in self.stages.iter().enumerate() {
            found.sine = found.sine.lesser(stage.sine(&placed).scaled(sides[k]));
        }
        self.close(&placed, &mut found);
        found
    }

    /// What columns read where all links are.
    #[inline(always)]
    fn read<M: Number>(&self, poses: &Poses<Series<M, TERMS>>, near: &[f64], found: &mut Found<M>) {
        let mut spins = [[M::splat(0.0); TERMS - 1]; MOST_COLUMNS];
        for (c, column) in self.columns.iter().enumerate() {
            let link = poses[c];
            let before = on(poses, column.parent);
            match column.moves {
                Moves::Turn(_, side) => {
                    // the rate of a direction on the unit circle, z' = i w z
                    for order in 1..TERMS {
                        for i in 1..=order {
                            let turned = (link.z.re.0[order - i] * link.z.im.0[i])
                                .minus_product(link.z.im.0[order - i], link.z.re.0[i]);
                            spins[c][order - 1] = spins[c][order - 1] + turned.scaled(i as f64);
                        }
                    }
                    for order in 0..TERMS - 1 {
                        let mut spin = spins[c][order];
                        if let Some(k) = column.parent {
                            spin = spin - spins[k][order];
                        }
                        found.rates[order][c] = spin.scaled(side);
                    }
                    let turned = value_of(before.z).towards(value_of(link.z));
                    let angle = atan2_side_by_side(turned.im.scaled(side), turned.re);
                    found.values[c] = counted_on(angle + M::splat(column.reads), near[c]);
                }
                Moves::Slide(axis) => {
                    if let Some(k) = column.parent {
                        spins[c] = spins[k];
                    }
                    let slid = before.z.by(axis).dot(link.t.minus(before.t));
                    found.values[c] = slid.0[0] + M::splat(column.reads);
                    for order in 1..TERMS {
                        found.rates[order - 1][c] = slid.0[order].scaled(order as f64);
                    }
                }
            }
        }
    }

    /// How well all rows close where links are, and the condition number of `A` with the driven column as one more row.
    #[inline(always)]
    fn close<M: Number>(&self, poses: &Poses<M>, found: &mut Found<M>) {
        let zero = M::splat(0.0);
        let count = self.columns.len() - 1;
        let mut a = [[zero; MOST_COLUMNS - 1]; MOST_COLUMNS - 1];
        let mut driven = [zero; MOST_COLUMNS - 1];
        let (mut residual, mut squares) = (zero, M::splat(1.0 + self.besides));
        for (r, row) in self.rows.iter().enumerate() {
            let (first, second) = (on(poses, row.on[0]), on(poses, row.on[1]));
            let (error, place, force) = match row.kind {
                Kind::Along { at, v } => {
                    let (place, v) = (first.carry(at), second.z.by(v));
                    (v.dot(place.minus(second.carry(at))), place, v)
                }
                Kind::Angle { u, v, rest } => {
                    let (u, v) = (first.z.by(u), second.z.by(v));
                    (u.dot(v) + M::splat(rest), u, v)
                }
            };
            residual = residual.plus_product(error, error);
            for &(c, sign) in &row.columns {
                let before = on(poses, self.columns[c].parent);
                let entry = match (self.columns[c].moves, row.kind) {
                    (Moves::Turn(at, side), Kind::Along { .. }) => {
                        place.minus(before.carry(at)).cross(force).scaled(side * sign)
                    }
                    (Moves::Turn(_, side), Kind::Angle { .. }) => place.cross(force).scaled(side * sign),
                    (Moves::Slide(axis), Kind::Along { .. }) => before.z.by(axis).dot(force).scaled(sign),
                    (Moves::Slide(_), Kind::Angle { .. }) => zero,
                };
                squares = squares.plus_product(entry, entry);
                if c == self.driven {
                    driven[r] = entry;
                } else {
                    a[c - usize::from(c > self.driven)][r] = entry;
                }
            }
        }
        // the inverse of the bordered matrix: that of the block without the driven column, and the free motion
        let block = Square::new(a, count);
        let mut inverse = block.inverse_square() + M::splat(1.0);
        let free = block.solve(driven);
        for x in &free[..count] {
            inverse = inverse.plus_product(*x, *x);
        }
        found.residual = residual.sqrt();
        found.condition = (squares * inverse).sqrt();
    }
}

/// Where a series begins.
#[inline(always)]
fn value_of<M: Number>(z: Complex<Series<M, TERMS>>) -> Complex<M> {
    Complex { re: z.re.0[0], im: z.im.0[0] }
}

/// An angle with the whole turns that bring it next to another.
#[inline(always)]
fn counted_on<M: Number>(angle: M, near: f64) -> M {
    let off = angle - M::splat(near);
    let turns = M::splat(ROUNDER).plus_product(off, M::splat(1.0 / TAU)) - M::splat(ROUNDER);
    angle.minus_product(turns, M::splat(TAU))
}

impl Column {
    /// The pose of its link, with this turn, or slid to a value.
    #[inline(always)]
    fn moved<N: Number>(&self, before: &InPlane<N>, z: Complex<N>, value: N) -> InPlane<N> {
        match self.moves {
            Moves::Turn(at, _) => InPlane::through(z, at, before.carry(at)),
            Moves::Slide(axis) => {
                let by = value - N::splat(self.reads);
                before.shifted(before.z.by(axis).stretched(by))
            }
        }
    }
}
