//! Rows of a circuit as the description's joints and links have them.

use super::row::Row;
use crate::loops::description::described_loop::Loop;
use crate::loops::description::holding::followed;
use crate::loops::description::joint_values::write_joint_rates;
use crate::loops::description::reduce::{Carrier, SpunLinks};
use crate::loops::equation::chain::{BALLS, Chain, Configuration};
use crate::loops::equation::dense::COLUMNS;
use crate::loops::equation::kinds::Kind;
use crate::loops::equation::rotations::short_way;
use crate::loops::mobility::at_rest::Still;
use crate::loops::rates::points::{in_report_frame, link_twist, point_rates};
use crate::loops::rates::turns::value_series;
use crate::loops::rates::velocities::{ORDERS, Rates};
use crate::outcome::RowStatus;
use crate::rigid::{Pose, Vec3, Vec3Taylor, scale};
use crate::stopping;
use crate::taylor::Taylor;

/// Numbers that a row is kept as: joint values, balls, rates, and status, pass, residual and condition.
pub const ROW_NUMBERS: usize = COLUMNS + 9 * BALLS + ORDERS * COLUMNS + 4;

/// The rows of one circuit, kept as the chain has them, so that any point of any link can be asked for later.
#[derive(Clone, Debug)]
pub struct Rows {
    pub(super) rows: Vec<Row>,
    /// Turns to be added to each column of the description.
    pub(super) offsets: Vec<f64>,
    /// d(input)/dt at which rates are given; the rows hold them at one, or by a law.
    pub(super) speed: f64,
    /// The joint of the loop that is held in them.
    pub(super) still: Option<Still>,
}

/// What may be said of rows that are not at hand.
#[derive(Clone, Debug)]
pub struct Tally {
    /// How many rows there are.
    pub rows: usize,
    /// How many there are of each status, by its number.
    pub statuses: [usize; RowStatus::COUNT],
    /// The greatest closure error, relative to the size or radians; none where no row has one.
    pub residual: Option<f64>,
}

impl Rows {
    /// What there is to say of them.
    pub(super) fn tally(&self, linkage: &Loop) -> Tally {
        let has_balls = (0..linkage.columns).any(|c| is_ball_turn(linkage, c));
        let mut table = vec![[0.0; 4]; linkage.columns];
        let mut statuses = [0; RowStatus::COUNT];
        for row in &self.rows {
            let mut status = row.status;
            if status == RowStatus::Ok && has_balls {
                write_joint_rates(linkage, &row.at, &row.rates, &mut table);
                if table.iter().any(|q| q[0].is_nan()) {
                    status = RowStatus::TurnsUndefined;
                }
            }
            statuses[status as usize] += 1;
        }
        let errors = self.rows.iter().map(|r| r.residual).filter(|r| r.is_finite());
        Tally { rows: self.len(), statuses, residual: errors.reduce(f64::max) }
    }

    /// How many rows.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Status of each row by its number.
    pub fn status(&self) -> Vec<i64> {
        self.rows.iter().map(|r| r.status as i64).collect()
    }

    /// Pass of each row.
    pub fn passes(&self) -> Vec<i64> {
        self.rows.iter().map(|r| r.pass as i64).collect()
    }

    /// Closure error of each row: radians, or parts of the size.
    pub fn residuals(&self) -> Vec<f64> {
        self.rows.iter().map(|r| r.residual).collect()
    }

    /// Condition number of each row's Jacobian.
    pub fn conditions(&self) -> Vec<f64> {
        self.rows.iter().map(|r| r.condition).collect()
    }

    /// Turns to be added to each column of the description.
    pub fn offsets(&self) -> &[f64] {
        &self.offsets
    }

    /// d(input)/dt at which rates are given.
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// The joint of the loop that is held in them, as it rests.
    pub fn still(&self) -> Option<Still> {
        self.still
    }

    /// Every row as `ROW_NUMBERS` numbers, from which `from_numbers` makes it again to the last bit.
    pub fn numbers(&self) -> Vec<f64> {
        let mut out = Vec::with_capacity(self.len() * ROW_NUMBERS);
        for row in &self.rows {
            out.extend(row.at.values);
            out.extend(row.at.balls.as_flattened().as_flattened());
            out.extend(row.rates.as_flattened());
            out.extend([
                f64::from(row.status as u8),
                row.pass as f64,
                row.residual,
                row.condition,
            ]);
        }
        out
    }

    /// Rows of what `numbers`, `offsets`, `speed` and `still` told; `None` where these are no such numbers.
    pub fn from_numbers(
        numbers: &[f64],
        offsets: Vec<f64>,
        speed: f64,
        still: Option<Still>,
    ) -> Option<Self> {
        let rows = numbers.chunks(ROW_NUMBERS).map(|row| {
            let (values, rest) = row.split_first_chunk::<COLUMNS>()?;
            let (balls, rest) = rest.split_at_checked(9 * BALLS)?;
            let (rates, rest) = rest.split_at_checked(ORDERS * COLUMNS)?;
            let &[status, pass, residual, condition] = rest else {
                return None;
            };
            Some(Row {
                at: Configuration {
                    values: *values,
                    balls: std::array::from_fn(|b| {
                        std::array::from_fn(|i| std::array::from_fn(|j| balls[9 * b + 3 * i + j]))
                    }),
                },
                rates: std::array::from_fn(|order| std::array::from_fn(|c| rates[order * COLUMNS + c])),
                status: RowStatus::numbered(status)?,
                pass: pass as usize,
                residual,
                condition,
            })
        });
        Some(Self { rows: rows.collect::<Option<_>>()?, offsets, speed, still })
    }

    /// The row's rates at the speed asked for.
    fn rates(&self, row: &Row) -> Rates {
        row.rates_at(self.speed)
    }
}

/// Values and three derivatives of every column, order by order: `4 x rows x columns`; angles unwrapped along the rows.
pub fn joint_table(linkage: &Loop, rows: &Rows) -> Vec<f64> {
    let linkage = &*followed(linkage, rows.still);
    let (count, columns) = (rows.len(), linkage.columns);
    let mut out = vec![f64::NAN; 4 * count * columns];
    let mut before: Vec<Option<f64>> = vec![None; columns];
    let ball_turn: Vec<bool> = (0..columns).map(|c| is_ball_turn(linkage, c)).collect();
    let mut table = vec![[0.0; 4]; columns];
    for (n, row) in rows.rows.iter().enumerate() {
        stopping::piece();
        if row.status == RowStatus::NoSolution {
            continue;
        }
        write_joint_rates(linkage, &row.at, &rows.rates(row), &mut table);
        for (c, q) in table.iter().enumerate() {
            for (order, value) in q.iter().enumerate() {
                out[(order * count + n) * columns + c] = *value;
            }
            let mut value = q[0] + rows.offsets[c];
            if ball_turn[c] && value.is_finite() {
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

fn is_ball_turn(linkage: &Loop, column: usize) -> bool {
    let joint = linkage.joint_of(column);
    linkage.reduced.parts[joint].kind == Kind::Ball
}

/// Position, velocity, acceleration and jerk of a point, `4 x rows x 3`, in the report frame.
///
/// `link` counts from 0 the joint before it; `at` is in the frame after that joint. Rows without a pose are NaN; at dead
/// centres only the position is given.
pub fn point(linkage: &Loop, rows: &Rows, link: usize, at: Vec3) -> Vec<f64> {
    let linkage = &*followed(linkage, rows.still);
    let count = rows.len();
    let mut out = vec![f64::NAN; 12 * count];
    for (n, row) in rows.rows.iter().enumerate() {
        stopping::piece();
        let Some(moved) = carried_point(linkage, rows, row, link, scale(at, 1.0 / linkage.size)) else {
            continue;
        };
        let placed = in_report_frame(&linkage.reduced.base, moved[0], moved);
        for (order, value) in placed.iter().enumerate() {
            for k in 0..3 {
                out[(order * count + n) * 3 + k] = value[k] * linkage.size;
            }
        }
    }
    out
}

/// A point of a link in the chain's frame, with three derivatives.
fn carried_point(linkage: &Loop, rows: &Rows, row: &Row, link: usize, at: Vec3) -> Option<[Vec3; 4]> {
    let chain = linkage.reduced.chain.as_ref()?;
    if row.status == RowStatus::NoSolution {
        return None;
    }
    let rates = rows.rates(row);
    let carried = |joint: usize, pose: &Pose, at: Vec3| {
        let frame = chain.frames(&row.at)[joint];
        let twist = link_twist(chain, &row.at, &rates, joint);
        point_rates(frame.carry(pose.carry(at)), &twist)
    };
    match linkage.reduced.parts[link].link {
        Carrier::Ground(pose) => {
            let fixed = linkage.reduced.base.inverse().carry(pose.carry(at));
            Some([fixed, [0.0; 3], [0.0; 3], [0.0; 3]])
        }
        Carrier::Joint(joint, pose) => Some(carried(joint, &pose, at)),
        Carrier::Spun(pose) => {
            let links = linkage.reduced.spun.as_ref()?;
            Some(moved(
                links,
                chain,
                row,
                &rates,
                pose.carry(at).map(Taylor::constant),
                carried,
            ))
        }
        Carrier::SpunBeyond(pose) => {
            let links = linkage.reduced.spun.as_ref()?;
            let value = value_series(chain, links.joint, &row.at, &rates);
            let place = links.spun.beyond(value, pose.carry(at));
            Some(moved(links, chain, row, &rates, place, carried))
        }
    }
}

/// A point that moves against the first of the links, carried on by the chain.
fn moved(
    links: &SpunLinks,
    chain: &Chain,
    row: &Row,
    rates: &Rates,
    place: Vec3Taylor<4>,
    carried: impl Fn(usize, &Pose, Vec3) -> [Vec3; 4],
) -> [Vec3; 4] {
    let (joint, pose) = &links.carrier;
    let lie = links.spun.lie(value_series(chain, links.joint, &row.at, rates));
    // the chain's frame as three points that it carries, and the point in that frame
    let origin = carried(*joint, pose, [0.0; 3]);
    let series = |v: &[Vec3; 4], i: usize| Taylor::<4>::from_derivatives(&v.map(|order| order[i]));
    let mut out: Vec3Taylor<4> = std::array::from_fn(|i| series(&origin, i));
    for k in 0..3 {
        let own = lie[k][0] * place[0] + lie[k][1] * place[1] + lie[k][2] * place[2];
        let axis = carried(
            *joint,
            pose,
            std::array::from_fn(|i| if i == k { 1.0 } else { 0.0 }),
        );
        for i in 0..3 {
            out[i] = out[i] + own * (series(&axis, i) - series(&origin, i));
        }
    }
    std::array::from_fn(|order| out.map(|x| x.derivative(order)))
}
