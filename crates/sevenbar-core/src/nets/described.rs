//! A net with its joints: the columns of the description, and what they and points read on rows of a circuit.
//!
//! Source: docs/theory_nets.md, (9).

use super::freedoms::{Freedoms, freedoms};
use super::joints::{NetJoint, Reading, TERMS};
use super::net::{Net, on};
use super::net_rows::{NetRow, NetRows};
use super::plane_points::PlanePoint;
use super::rows::On;
use super::series::{Series, rotating};
use super::steps::{Move, Placement, Screw};
use crate::loops::description::described_loop::{Column, Described};
use crate::loops::equation::chain::AGREE;
use crate::loops::equation::rotations::{Rotation, short_way};
use crate::outcome::RowStatus;
use crate::rigid::{Vec3, cross, dot, norm, sub};
use crate::stopping;
use crate::taylor::Taylor;
use std::f64::consts::{PI, TAU};
use std::sync::OnceLock;

/// Directions whose sine is less are parallel: rounding.
const PARALLEL: f64 = 1e-12;

/// A column of the description.
#[derive(Clone, Copy, Debug)]
struct Outer {
    joint: usize,
    slides: bool,
    /// The column that is followed for it, if its joint is in the tree.
    followed: Option<usize>,
}

/// Columns as they are followed, as series by time.
struct Columns {
    values: Vec<Series<f64, TERMS>>,
    balls: Vec<Rotation<Series<f64, TERMS>>>,
}

/// A net, and its joints as they are described.
#[derive(Clone, Debug)]
pub struct DescribedNet {
    pub(super) net: Net,
    /// The same with lengths relative to the size.
    relative: Net,
    joints: Vec<NetJoint>,
    columns: Vec<Outer>,
    /// What all columns of the description are the sums of, where all are: hinges that turn about one direction with all between their links.
    sums: Option<Vec<Sum>>,
    /// Its freedoms, which it takes longer to find than to follow a circuit.
    freedoms: OnceLock<Freedoms>,
}

/// The sum of columns times numbers, and what it reads where these are zero.
#[derive(Clone, Debug)]
struct Sum {
    of: Vec<(usize, f64)>,
    rest: f64,
    slides: bool,
}

impl Described for DescribedNet {
    fn size(&self) -> f64 {
        self.net.size
    }

    fn columns(&self) -> usize {
        self.columns.len()
    }

    fn followed_column(&self, column: usize) -> Option<usize> {
        self.columns[column].followed
    }

    fn is_slide(&self, column: usize) -> bool {
        self.columns[column].slides
    }
}

impl DescribedNet {
    /// A net with its joints; for each of them the steps of its columns, of one that is not in the tree none.
    pub fn new(net: Net, joints: Vec<(NetJoint, Vec<usize>)>) -> Self {
        let mut columns = Vec::new();
        for (joint, (described, steps)) in joints.iter().enumerate() {
            for (place, &slides) in described.reading.slides().iter().enumerate() {
                let followed = steps.get(place).copied();
                columns.push(Outer { joint, slides, followed });
            }
        }
        let joints: Vec<NetJoint> = joints.into_iter().map(|(joint, _)| joint).collect();
        let sum = |column: &Outer| match (column.followed, &joints[column.joint]) {
            (_, joint) if joint.reading.is_read_off() => None,
            (Some(inner), _) => Some(Sum { of: vec![(inner, 1.0)], rest: 0.0, slides: column.slides }),
            (None, joint) => turned_by(&net, joint),
        };
        let sums = columns.iter().map(sum).collect();
        Self {
            relative: net.relative(),
            net,
            joints,
            columns,
            sums,
            freedoms: OnceLock::new(),
        }
    }

    /// The net.
    pub fn net(&self) -> &Net {
        &self.net
    }

    /// Its freedoms about the pose that is drawn.
    pub fn freedoms(&self) -> &Freedoms {
        self.freedoms.get_or_init(|| freedoms(&self.net))
    }

    /// A column as it is followed; `None` of a joint that is not in the tree.
    pub(super) fn followed(&self, outer: usize) -> Option<Column> {
        Some(Column { outer, inner: self.columns.get(outer)?.followed? })
    }

    /// Whether all rows close, to what agrees, at values of the columns that are followed.
    pub(super) fn closes(&self, values: &[f64], balls: &[Rotation]) -> bool {
        self.net.errors(values, balls).iter().all(|e| e.abs() < AGREE)
    }

    /// How many columns the description has.
    pub fn column_count(&self) -> usize {
        self.columns.len()
    }

    /// The columns that are followed, from those of the description [rad, or length]; as drawn where the description has none.
    pub(super) fn inner_values(&self, outer: &[f64]) -> Vec<f64> {
        let mut values = self.net.drawn();
        for (c, (column, value)) in self.columns.iter().zip(outer).enumerate() {
            if let Some(inner) = column.followed {
                values[inner] = value * self.inward(c);
            }
        }
        values
    }

    /// The columns of the description [rad, or length] at a mode's values of those that are followed, turns the short way.
    pub fn columns_at(&self, values: &[f64]) -> Vec<f64> {
        let outer = self.outer_values(values, &[]);
        let short = |(value, column): (f64, &Outer)| if column.slides { value } else { short_way(value) };
        outer.into_iter().zip(&self.columns).map(short).collect()
    }

    /// The columns of the description [rad, or length] at values of those that are followed; NaN where they are not determined.
    pub(super) fn outer_values(&self, values: &[f64], balls: &[Rotation]) -> Vec<f64> {
        let still = |value: &f64| Series([*value, 0.0, 0.0, 0.0]);
        let series = Columns {
            values: values.iter().map(still).collect(),
            balls: balls
                .iter()
                .map(|ball| ball.map(|row| row.map(|x| still(&x))))
                .collect(),
        };
        self.table(&series).iter().map(Taylor::value).collect()
    }

    /// Where each step leads, as series by time, lengths relative to the size.
    fn poses(&self, columns: &Columns) -> Vec<Placement<Series<f64, TERMS>>> {
        let count = self.net.steps.len();
        let mut poses = vec![Placement::still(); count];
        let mut screws = vec![Screw::still(); count];
        self.relative
            .place(&columns.values, &columns.balls, &mut poses, &mut screws);
        poses
    }

    /// Each column of the description as a series by time [rad, or length].
    fn table(&self, columns: &Columns) -> Vec<Taylor<TERMS>> {
        let poses = self.poses(columns);
        let undetermined = Taylor([f64::NAN; TERMS]);
        let mut out = Vec::with_capacity(self.columns.len());
        for (joint, described) in self.joints.iter().enumerate() {
            let links = described.on.map(|step| on(&poses, step));
            let read = described.values(self.net.size, [&links[0], &links[1]]);
            let own = self.columns.iter().filter(|c| c.joint == joint);
            for (column, read) in own.zip(read) {
                let value = match column.followed.filter(|_| !self.is_read_off(*column)) {
                    Some(inner) => Taylor(columns.values[inner].0),
                    None => read.unwrap_or(undetermined),
                };
                out.push(value.scale(if column.slides { self.net.size } else { 1.0 }));
            }
        }
        out
    }

    /// Values and three derivatives of every column of the description, order by order: `4 x rows x columns`; turns go on along the rows.
    pub fn joint_table(&self, rows: &NetRows) -> Vec<f64> {
        let (count, columns) = (rows.len(), self.columns.len());
        let mut out = vec![0.0; TERMS * count * columns];
        if out.is_empty() {
            return out;
        }
        match &self.sums {
            Some(sums) => {
                let speed = rows.speed;
                let factors = [1.0, speed, speed * speed, 2.0 * speed * speed * speed];
                let terms = factors.map(|factor| Terms::of(sums, factor, self.net.size));
                let orders = out.chunks_exact_mut(count * columns);
                let mut orders: Vec<_> = orders.map(|order| order.chunks_exact_mut(columns)).collect();
                // row by row, so that memory is gone through once
                for row in rows.rows() {
                    stopping::piece();
                    for (order, (out, terms)) in orders.iter_mut().zip(&terms).enumerate() {
                        let from = match order {
                            0 => row.values(),
                            _ => row.rates(order - 1),
                        };
                        if let Some(values) = out.next() {
                            terms.add_up(from, values);
                        }
                    }
                }
                let mut rests = vec![0.0; columns];
                for (rest, sum) in rests.iter_mut().zip(sums) {
                    *rest = sum.rest;
                }
                add(&rests, &mut out[..count * columns]);
            }
            None => {
                for (n, row) in rows.rows().enumerate() {
                    stopping::piece();
                    let undetermined = vec![Taylor([f64::NAN; TERMS]); columns];
                    let table = match row.status() {
                        RowStatus::NoSolution => undetermined,
                        _ => self.table(&series(row, &self.net, rows.speed)),
                    };
                    for (c, series) in table.iter().enumerate() {
                        for order in 0..TERMS {
                            out[(order * count + n) * columns + c] = series.derivative(order);
                        }
                    }
                }
            }
        }
        add(&rows.offsets, &mut out[..count * columns]);
        for (c, column) in self.columns.iter().enumerate() {
            if (column.followed.is_none() || self.is_read_off(*column)) && !column.slides {
                go_on(out[..count * columns].iter_mut().skip(c).step_by(columns));
            }
        }
        out
    }

    /// Whether a column is read off the links even where it is followed.
    fn is_read_off(&self, column: Outer) -> bool {
        self.joints[column.joint].reading.is_read_off()
    }

    /// Position, velocity, acceleration and jerk of a point of a link, `4 x rows x 3`, in the report frame; `at` is where it is drawn.
    /// Rows without a pose are NaN; at dead centres only the position is given.
    pub fn point(&self, rows: &NetRows, link: On, at: Vec3) -> Vec<f64> {
        let count = rows.len();
        let mut out = vec![f64::NAN; TERMS * count * 3];
        let small = at.map(|x| x / self.net.size);
        let in_plane = PlanePoint::of(&self.relative, link, small);
        for (n, row) in rows.rows().enumerate() {
            stopping::piece();
            if row.status() == RowStatus::NoSolution {
                continue;
            }
            if let Some(point) = &in_plane {
                for (order, place) in point.on(row, rows.speed).into_iter().enumerate() {
                    for k in 0..3 {
                        out[(order * count + n) * 3 + k] = place[k] * self.net.size;
                    }
                }
                continue;
            }
            let poses = self.poses(&series(row, &self.net, rows.speed));
            let place = on(&poses, link).carry(&small);
            for k in 0..3 {
                let series = Taylor(place[k].0);
                for order in 0..TERMS {
                    out[(order * count + n) * 3 + k] = series.derivative(order) * self.net.size;
                }
            }
        }
        out
    }
}

/// Sums of columns, one after the other.
struct Terms {
    /// Where the terms of each end.
    ends: Vec<usize>,
    of: Vec<(usize, f64)>,
}

impl Terms {
    /// Sums of an order, which has such a factor; of slides relative to the size.
    fn of(sums: &[Sum], factor: f64, size: f64) -> Self {
        let (mut ends, mut of) = (Vec::new(), Vec::new());
        for sum in sums {
            let factor = if sum.slides { factor * size } else { factor };
            of.extend(sum.of.iter().map(|&(c, part)| (c, part * factor)));
            ends.push(of.len());
        }
        Self { ends, of }
    }

    #[inline]
    fn add_up(&self, from: &[f64], out: &mut [f64]) {
        let mut first = 0;
        for (value, &end) in out.iter_mut().zip(&self.ends) {
            let mut total = 0.0;
            for &(c, part) in &self.of[first..end] {
                total += from[c] * part;
            }
            *value = total;
            first = end;
        }
    }
}

/// Adds one row to each.
fn add(row: &[f64], out: &mut [f64]) {
    if row.iter().any(|by| *by != 0.0) {
        for values in out.chunks_exact_mut(row.len()) {
            for (value, by) in values.iter_mut().zip(row) {
                *value += by;
            }
        }
    }
}

/// Adds whole turns to the angles of a column, the first of which is at most half a turn, so that each is next to the one before.
fn go_on<'a>(angles: impl Iterator<Item = &'a mut f64>) {
    let (mut last, mut turns) = (0.0, 0.0);
    for angle in angles {
        let own = *angle;
        if (own + turns - last).abs() >= PI {
            turns = TAU * ((last + short_way(own - last) - own) / TAU).round();
        }
        if own.is_finite() {
            last = own + turns;
            *angle = last;
        }
    }
}

/// What a hinge off the tree reads as a sum of columns, if all that turn its links against each other turn about its direction, which then
/// stays.
fn turned_by(net: &Net, joint: &NetJoint) -> Option<Sum> {
    let [before, after] = joint.frames;
    let axis = before.column(2);
    if joint.reading != Reading::Turn || norm(sub(axis, after.column(2))) > PARALLEL {
        return None;
    }
    let mut of = Vec::new();
    let mut rest = dot(before.column(1), after.column(0)).atan2(dot(before.column(0), after.column(0)));
    for (columns, side) in net.moving(joint.on).into_iter().zip([-1.0, 1.0]) {
        for c in columns {
            let step = &net.steps[c];
            let along = dot(axis, step.axis);
            match step.moves {
                Move::Slide => {}
                Move::Turn if norm(cross(axis, step.axis)) < PARALLEL => {
                    of.push((c, side * along.signum()));
                    rest -= side * along.signum() * step.reads;
                }
                _ => return None,
            }
        }
    }
    Some(Sum { of, rest, slides: false })
}

/// The columns of a row as series by time, the input at a speed.
fn series(row: NetRow<'_>, net: &Net, speed: f64) -> Columns {
    let one = |(c, &value): (usize, &f64)| {
        let mut series = [value; TERMS];
        let mut factor = 1.0;
        for order in 1..TERMS {
            factor *= speed;
            series[order] = row.rates(order - 1)[c] * factor / order as f64;
        }
        Series(series)
    };
    let values: Vec<Series<f64, TERMS>> = row.values().iter().enumerate().map(one).collect();
    let balls = net.balls.iter().zip(row.balls()).map(|(&first, ball)| {
        let spin: [[f64; 3]; TERMS - 1] =
            std::array::from_fn(|n| std::array::from_fn(|k| values[first + k].0[n + 1] * (n + 1) as f64));
        rotating(&ball, &spin)
    });
    let balls = balls.collect();
    Columns { values, balls }
}
