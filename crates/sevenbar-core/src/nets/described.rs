//! A net with its joints: the columns of the description, and what they and points read on rows of a circuit.
//!
//! Source: docs/theory_nets.md, (9).

use super::joints::{NetJoint, TERMS};
use super::net::{Net, on};
use super::rows::On;
use super::series::{Series, rotating};
use super::steps::{Placement, Screw};
use crate::loops::description::described_loop::{Column, Described};
use crate::loops::equation::chain::AGREE;
use crate::loops::equation::rotations::{Rotation, short_way};
use crate::outcome::RowStatus;
use crate::rigid::Vec3;
use crate::stopping;
use crate::taylor::Taylor;

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
}

/// A row of a circuit: columns and their rates as they are followed, at unit speed of the input or by a law.
#[derive(Clone, Debug)]
pub struct NetRow {
    pub(super) values: Vec<f64>,
    pub(super) balls: Vec<Rotation>,
    pub(super) rates: [Vec<f64>; TERMS - 1],
    /// What it holds.
    pub status: RowStatus,
    /// Its pass between dead centres of the input.
    pub pass: usize,
    /// The closure error [rad, or relative to the size].
    pub residual: f64,
    /// The condition number of its Jacobian.
    pub condition: f64,
}

/// The rows of a circuit.
#[derive(Clone, Debug)]
pub struct NetRows {
    /// The rows.
    pub rows: Vec<NetRow>,
    /// Whole turns to be added to each column of the description.
    pub(super) offsets: Vec<f64>,
    pub(super) speed: f64,
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
        let joints = joints.into_iter().map(|(joint, _)| joint).collect();
        Self { relative: net.relative(), net, joints, columns }
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
                // of a ball it is read off, since a tree's three turns have two ways to one pose
                let value = match column.followed.filter(|_| described.reading.slides().len() < 3) {
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
        let (count, columns) = (rows.rows.len(), self.columns.len());
        let mut out = vec![f64::NAN; TERMS * count * columns];
        let mut before: Vec<Option<f64>> = vec![None; columns];
        for (n, row) in rows.rows.iter().enumerate() {
            stopping::piece();
            if row.status == RowStatus::NoSolution {
                continue;
            }
            for (c, series) in self.table(&row.series(&self.net, rows.speed)).iter().enumerate() {
                for order in 1..TERMS {
                    out[(order * count + n) * columns + c] = series.derivative(order);
                }
                let mut value = series.value() + rows.offsets[c];
                let column = self.columns[c];
                let read = column.followed.is_none() || self.joints[column.joint].reading.slides().len() == 3;
                if read && !column.slides && value.is_finite() {
                    if let Some(b) = before[c] {
                        value = b + short_way(value - b);
                    }
                    before[c] = Some(value);
                }
                out[n * columns + c] = value;
            }
        }
        out
    }

    /// Position, velocity, acceleration and jerk of a point of a link, `4 x rows x 3`, in the report frame; `at` is where it is drawn.
    /// Rows without a pose are NaN; at dead centres only the position is given.
    pub fn point(&self, rows: &NetRows, link: On, at: Vec3) -> Vec<f64> {
        let count = rows.rows.len();
        let mut out = vec![f64::NAN; TERMS * count * 3];
        let small = at.map(|x| x / self.net.size);
        for (n, row) in rows.rows.iter().enumerate() {
            stopping::piece();
            if row.status == RowStatus::NoSolution {
                continue;
            }
            let poses = self.poses(&row.series(&self.net, rows.speed));
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

impl NetRows {
    /// Every row as numbers, from which `from_numbers` makes it again to the last bit; how many columns and balls are followed, turns to be
    /// added to each column of the description, and the speed.
    pub fn numbers(&self) -> (Vec<f64>, [usize; 2], Vec<f64>, f64) {
        let sizes = self
            .rows
            .first()
            .map_or([0; 2], |row| [row.values.len(), row.balls.len()]);
        let mut numbers = Vec::with_capacity(self.rows.len() * Self::count(sizes));
        for row in &self.rows {
            numbers.extend(&row.values);
            numbers.extend(row.balls.as_flattened().as_flattened());
            numbers.extend(row.rates.iter().flatten());
            numbers.extend([
                f64::from(row.status as u8),
                row.pass as f64,
                row.residual,
                row.condition,
            ]);
        }
        (numbers, sizes, self.offsets.clone(), self.speed)
    }

    /// How many numbers a row is.
    fn count([columns, balls]: [usize; 2]) -> usize {
        TERMS * columns + 9 * balls + 4
    }

    /// Rows of what `numbers` gave; `None` where these are no such numbers.
    pub fn from_numbers(numbers: &[f64], sizes: [usize; 2], offsets: Vec<f64>, speed: f64) -> Option<Self> {
        let [columns, balls] = sizes;
        let rows = numbers.chunks(Self::count(sizes)).map(|row| {
            let (values, rest) = row.split_at_checked(columns)?;
            let (turned, rest) = rest.split_at_checked(9 * balls)?;
            let (rates, rest) = rest.split_at_checked((TERMS - 1) * columns)?;
            let &[status, pass, residual, condition] = rest else {
                return None;
            };
            let ball = |b: usize| std::array::from_fn(|i| std::array::from_fn(|j| turned[9 * b + 3 * i + j]));
            Some(NetRow {
                values: values.to_vec(),
                balls: (0..balls).map(ball).collect(),
                rates: std::array::from_fn(|order| rates[order * columns..][..columns].to_vec()),
                status: RowStatus::numbered(status)?,
                pass: pass as usize,
                residual,
                condition,
            })
        });
        Some(Self { rows: rows.collect::<Option<_>>()?, offsets, speed })
    }
}

impl NetRow {
    /// Its columns as series by time, the input at a speed.
    fn series(&self, net: &Net, speed: f64) -> Columns {
        let one = |(c, &value): (usize, &f64)| {
            let mut series = [value; TERMS];
            let mut factor = 1.0;
            for order in 1..TERMS {
                factor *= speed;
                series[order] = self.rates[order - 1][c] * factor / order as f64;
            }
            Series(series)
        };
        let values: Vec<Series<f64, TERMS>> = self.values.iter().enumerate().map(one).collect();
        let balls = net.balls.iter().zip(&self.balls).map(|(&first, ball)| {
            let spin: [[f64; 3]; TERMS - 1] =
                std::array::from_fn(|n| std::array::from_fn(|k| values[first + k].0[n + 1] * (n + 1) as f64));
            rotating(ball, &spin)
        });
        let balls = balls.collect();
        Columns { values, balls }
    }
}
