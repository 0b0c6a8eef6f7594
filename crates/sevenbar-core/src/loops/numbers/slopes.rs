//! Derivatives of a loop's values, rates and points by the numbers of its description: `numbered_loop` has the equations.

use super::numbered_loop::{Around, NumberedLoop};
use super::twists::{adjoined, carried, plus, sliding};
use crate::loops::equation::chain::Chain;
use crate::loops::equation::closed::Inverse;
use crate::loops::equation::rotations::cross;
use crate::loops::equation::screws::{Twist, bracket};
use crate::loops::rates::velocities::ORDERS;
use crate::rigid::add;
use crate::stopping;

/// Norm of the pseudo-inverse [per rad, or size] beyond which the input does not determine what follows: a dead centre.
const DEAD: f64 = 1e7;

/// What rows of a circuit have, and their derivatives by the numbers and, last, by the input: flat arrays, rows outermost.
#[derive(Clone, Debug)]
pub struct Slopes {
    /// First to third derivatives by the input (rows, 3, columns).
    pub rates: Vec<f64>,
    /// Derivatives of values and rates (rows, orders, numbers + 1, columns).
    pub by_number: Vec<f64>,
    /// Points and their derivative by the input (rows, points, 2, 3).
    pub points: Vec<f64>,
    /// Their derivatives (rows, points, 2, numbers + 1, 3).
    pub points_by_number: Vec<f64>,
    /// The part of each number that no joint can follow (rows, numbers) [rad, or relative to the size].
    pub aside: Vec<f64>,
    /// What moves with each idle joint that is held, for one of it (rows, held, columns).
    pub idle: Vec<f64>,
    /// The same of the points (rows, held, points, 3).
    pub points_idle: Vec<f64>,
}

/// A value for each column, and its rates.
pub(crate) type Orders = [Vec<f64>; ORDERS + 1];

/// What changes along the loop by one number: `carriers`, of what lies behind so many joints, are its
/// twist by the number (order 0) and the changes of the series of its twist along the motion; `screws` those of the screws.
#[derive(Clone, Debug, Default)]
pub(crate) struct Changes {
    pub carriers: [Vec<Twist>; ORDERS + 1],
    /// The twist by the number of the frame before each joint.
    pub before: Vec<Twist>,
    pub screws: [Vec<Twist>; ORDERS],
    moves: Vec<Twist>,
}

impl Changes {
    pub fn new(numbered: &NumberedLoop) -> Self {
        let joints = numbered.joints.len();
        Self {
            carriers: std::array::from_fn(|_| vec![[0.0; 6]; joints + 1]),
            before: vec![[0.0; 6]; joints],
            screws: std::array::from_fn(|_| vec![[0.0; 6]; numbered.columns]),
            moves: Vec::new(),
        }
    }
}

/// A number, or a column that is one.
#[derive(Clone, Copy)]
pub(crate) enum By {
    Number(usize),
    Column(usize),
}

/// A row with the power series of its rates.
pub(crate) struct Moving {
    /// Of the screws of the kept columns.
    pub inverse: Inverse<Chain>,
    pub around: Around,
    pub kept: Vec<usize>,
    pub values: Vec<f64>,
    pub rates: [Vec<f64>; ORDERS],
    /// Of what lies before each joint, and behind the last.
    pub twists: [Vec<Twist>; ORDERS],
    pub screws: [Vec<Twist>; ORDERS],
}

/// k factorial: the derivative of order k + 1 is this times coefficient k of the power series of the rates.
const FACTORIALS: [f64; ORDERS] = [1.0, 1.0, 2.0];

/// Rates by the input and derivatives up to an order (0 to 3) at closed poses (rows, columns); NaN at dead centres.
pub fn slopes(numbered: &NumberedLoop, values: &[f64], order: usize) -> Slopes {
    let (width, all, orders) = (numbered.columns, numbered.numbers + 1, order + 1);
    let (rows, points, idle) = (values.len() / width, numbered.points.len(), numbered.idle());
    let nan = |count: usize| vec![f64::NAN; rows * count];
    let mut out = Slopes {
        rates: nan(ORDERS * width),
        by_number: nan(orders * all * width),
        points: nan(points * 6),
        points_by_number: nan(points * 2 * all * 3),
        aside: nan(numbered.numbers),
        idle: nan(idle * width),
        points_idle: nan(idle * points * 3),
    };
    for (row, at) in values.chunks(width).enumerate() {
        stopping::piece();
        if !at.iter().all(|x| x.is_finite()) {
            continue;
        }
        let mut around = Around::default();
        numbered.walk(&numbered.nominal, &numbered.state(at), &mut around);
        for (i, point) in numbered.points.iter().enumerate() {
            let place = around.behind(point.joints).carry(point.at);
            out.points[(row * points + i) * 6..][..3].copy_from_slice(&place);
        }
        if let Some(found) = moving(numbered, around, at) {
            write_row(numbered, &found, row, orders, &mut out);
        }
    }
    out
}

/// A row with its rates; `None` at a dead centre.
pub(crate) fn moving(numbered: &NumberedLoop, around: Around, values: &[f64]) -> Option<Moving> {
    let kept = numbered.kept(&around);
    let inverse: Inverse<Chain> = Inverse(numbered.factored(&around, &kept).inverse());
    let size = inverse.square(6).sqrt();
    if size.is_nan() || size >= DEAD {
        return None;
    }
    let still = vec![[0.0; 6]; numbered.columns];
    let screws = [around.screws.clone(), still.clone(), still];
    let mut moving = Moving {
        inverse,
        around,
        kept,
        values: values.to_vec(),
        rates: std::array::from_fn(|_| vec![0.0; numbered.columns]),
        twists: std::array::from_fn(|_| vec![[0.0; 6]; numbered.joints.len() + 1]),
        screws,
    };
    // coefficient k of `A u = -S_input`, then those of V and of the screws that follow from it
    for k in 0..ORDERS {
        let mut right = [0.0; 6];
        if k == 0 {
            plus(&mut right, &moving.screws[0][numbered.input], 1.0);
        }
        for a in 1..=k {
            for c in 0..numbered.columns {
                plus(&mut right, &moving.screws[a][c], moving.rates[k - a][c]);
            }
        }
        let mut rates = std::mem::take(&mut moving.rates[k]);
        moving.solve(&right, &mut rates);
        rates[numbered.input] = if k == 0 { 1.0 } else { 0.0 };
        moving.rates[k] = rates;
        let mut twist = [0.0; 6];
        for (i, joint) in numbered.joints.iter().enumerate() {
            moving.twists[k][i] = twist;
            for c in numbered.first[i]..numbered.first[i] + joint.columns() {
                for a in 0..=k {
                    plus(&mut twist, &moving.screws[a][c], moving.rates[k - a][c]);
                }
                if k + 1 < ORDERS {
                    let mut sum = [0.0; 6];
                    for a in 0..=k {
                        let part = bracket(&moving.twists[a][i], &moving.screws[k - a][c]);
                        plus(&mut sum, &part, 1.0 / (k + 1) as f64);
                    }
                    moving.screws[k + 1][c] = sum;
                }
            }
        }
        moving.twists[k][numbered.joints.len()] = twist;
    }
    Some(moving)
}

fn write_row(numbered: &NumberedLoop, moving: &Moving, row: usize, orders: usize, out: &mut Slopes) {
    let (width, all, points) = (numbered.columns, numbered.numbers + 1, numbered.points.len());
    for k in 0..ORDERS {
        let part = &mut out.rates[(row * ORDERS + k) * width..][..width];
        for (to, rate) in part.iter_mut().zip(&moving.rates[k]) {
            *to = FACTORIALS[k] * rate;
        }
    }
    let mut places = Vec::with_capacity(points);
    for (i, point) in numbered.points.iter().enumerate() {
        let place = moving.around.behind(point.joints).carry(point.at);
        let velocity = carried(&moving.twists[0][point.joints], place);
        out.points[(row * points + i) * 6 + 3..][..3].copy_from_slice(&velocity);
        places.push(place);
    }
    let block = &mut out.by_number[row * orders * all * width..][..orders * all * width];
    let mut slopes: Orders = std::array::from_fn(|_| vec![0.0; width]);
    let mut changes = Changes::new(numbered);
    for number in 0..all {
        let own = (number < numbered.numbers).then_some(number);
        let by = own.map_or(By::Column(numbered.input), By::Number);
        let aside = derived(numbered, moving, by, orders, &mut slopes, &mut changes);
        if let Some(own) = own {
            out.aside[row * numbered.numbers + own] = aside;
        }
        for (order, part) in slopes.iter().enumerate().take(orders) {
            // order 0 is the value itself; of order k the series of the rates has coefficient k - 1
            let factor = FACTORIALS[order.saturating_sub(1)];
            let to = &mut block[(order * all + number) * width..][..width];
            for (to, slope) in to.iter_mut().zip(part) {
                *to = factor * slope;
            }
        }
        for (i, point) in numbered.points.iter().enumerate() {
            let way = own
                .and_then(|n| point.ways.iter().find(|w| w.0 == n))
                .map_or([0.0; 3], |w| moving.around.behind(point.joints).turn(w.1));
            let behind = point.joints;
            let moved = add(carried(&changes.carriers[0][behind], places[i]), way);
            let to = ((row * points + i) * 2 * all + number) * 3;
            out.points_by_number[to..][..3].copy_from_slice(&moved);
            if orders > 1 {
                let spin = &moving.twists[0][behind][..3];
                let velocity = add(
                    carried(&changes.carriers[1][behind], places[i]),
                    cross(spin, &moved),
                );
                out.points_by_number[to + all * 3..][..3].copy_from_slice(&velocity);
            }
        }
    }
    let spun = numbered.free.iter().filter(|c| !moving.kept.contains(c));
    for (i, &column) in numbered.held.iter().chain(spun).enumerate() {
        derived(numbered, moving, By::Column(column), 1, &mut slopes, &mut changes);
        let place = row * numbered.idle() + i;
        out.idle[place * width..][..width].copy_from_slice(&slopes[0]);
        for (k, point) in numbered.points.iter().enumerate() {
            let way = carried(&changes.carriers[0][point.joints], places[k]);
            out.points_idle[(place * points + k) * 3..][..3].copy_from_slice(&way);
        }
    }
}

/// The derivatives of values and rates by one number, and the part of it that no joint can follow.
pub(crate) fn derived(
    numbered: &NumberedLoop,
    moving: &Moving,
    by: By,
    orders: usize,
    slopes: &mut Orders,
    changes: &mut Changes,
) -> f64 {
    let screws = &moving.screws;
    let (moves, advance, column) = match by {
        By::Number(n) => (&numbered.moves[n][..], numbered.advances[n], None),
        By::Column(c) => (&[][..], None, Some(c)),
    };
    // the advance of a screw: its part of the screw, and where it has slid to
    let slid = advance.map(|(joint, rate)| {
        let part = sliding(moving.around.before[joint].column(2)).map(|x| rate * x);
        (joint, part, moving.values[numbered.first[joint]])
    });
    changes.moves.clear();
    changes.moves.extend(
        moves
            .iter()
            .map(|(place, twist)| match moving.around.before.get(*place) {
                Some(frame) => adjoined(frame, twist),
                // behind the last fixed transform the loop is closed
                None => *twist,
            }),
    );
    let mut right = [0.0; 6];
    for twist in &changes.moves {
        plus(&mut right, twist, 1.0);
    }
    if let Some((_, part, value)) = &slid {
        plus(&mut right, part, *value);
    }
    if let Some(column) = column {
        plus(&mut right, &screws[0][column], 1.0);
    }
    slopes[0].fill(0.0);
    // once more for the residual, which counts where a dead centre is near
    for _ in 0..2 {
        let solved = moving.inverse.times(&right);
        for (&c, x) in moving.kept.iter().zip(solved) {
            slopes[0][c] -= x;
            plus(&mut right, &screws[0][c], -x);
        }
    }
    let aside = right.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    if let Some(column) = column {
        slopes[0][column] = 1.0;
    }
    let (mut carrier, mut next) = ([0.0; 6], 0);
    for (i, joint) in numbered.joints.iter().enumerate() {
        while next < moves.len() && moves[next].0 <= i {
            plus(&mut carrier, &changes.moves[next], 1.0);
            next += 1;
        }
        let before = carrier;
        changes.before[i] = before;
        let direct = slid.as_ref().filter(|s| s.0 == i);
        for c in numbered.first[i]..numbered.first[i] + joint.columns() {
            plus(&mut carrier, &screws[0][c], slopes[0][c]);
            if orders > 1 {
                let mut change = bracket(&before, &screws[0][c]);
                if let Some((_, part, _)) = direct {
                    plus(&mut change, part, 1.0);
                }
                changes.screws[0][c] = change;
            }
        }
        if let Some((_, part, value)) = direct {
            plus(&mut carrier, part, *value);
        }
        changes.carriers[0][i + 1] = carrier;
    }
    // coefficient k of `Du`, then those of `DV` and `DS`
    for k in 0..orders - 1 {
        let mut right = [0.0; 6];
        for a in 0..=k {
            for c in 0..numbered.columns {
                plus(&mut right, &changes.screws[a][c], moving.rates[k - a][c]);
                if a > 0 {
                    plus(&mut right, &screws[a][c], slopes[k - a + 1][c]);
                }
            }
        }
        moving.solve(&right, &mut slopes[k + 1]);
        let mut carrier = [0.0; 6];
        for (i, joint) in numbered.joints.iter().enumerate() {
            changes.carriers[k + 1][i] = carrier;
            for c in numbered.first[i]..numbered.first[i] + joint.columns() {
                for a in 0..=k {
                    plus(&mut carrier, &changes.screws[a][c], moving.rates[k - a][c]);
                    plus(&mut carrier, &screws[a][c], slopes[k - a + 1][c]);
                }
                if k + 2 < orders {
                    let mut sum = [0.0; 6];
                    for a in 0..=k {
                        let factor = 1.0 / (k + 1) as f64;
                        let by = bracket(&changes.carriers[a + 1][i], &screws[k - a][c]);
                        let of = bracket(&moving.twists[a][i], &changes.screws[k - a][c]);
                        plus(&mut sum, &by, factor);
                        plus(&mut sum, &of, factor);
                    }
                    changes.screws[k + 1][c] = sum;
                }
            }
        }
        changes.carriers[k + 1][numbered.joints.len()] = carrier;
    }
    aside
}

impl Moving {
    /// The x of `A x = -right`, of least squares, zero in the columns that do not follow.
    fn solve(&self, right: &Twist, x: &mut [f64]) {
        x.fill(0.0);
        let solved = self.inverse.times(right);
        for (&c, value) in self.kept.iter().zip(solved) {
            x[c] = -value;
        }
    }
}
