//! How a loop follows the numbers of its description: a dimension is a joint that is held.
//!
//! The loop `F0 Z1 F1 .. Zn Fn = 1` has joints Z and fixed transforms F, and a number that changes moves all behind an F by a
//! twist, as a joint there would. With S the screws of the joints and B those of one number p, in the order of the loop, u the
//! rates of the joints by the input, V the twist of what lies before a joint, all power series along the input, and D the
//! derivative by p,
//!
//! `A Dq = -sum B`, `DS_0 = [Vp, S_0]`, `A Du_k = -DS_0 u_k - sum (a >= 1) DS_a u_(k-a) + S_a Du_(k-a)`,
//! `k DS_k = sum [DV_a, S_(k-1-a)] + [V_a, DS_(k-1-a)]`
//!
//! where A holds the screws of the joints that follow, and Vp the parts of joints and of B before a place. The input is one number
//! more, whose B is its own screw; so is an idle joint that is held.
//!
//! Source: docs/theory_design.md, (1) to (5).

use super::chain::Joint;
use super::dense::{COLUMNS, Factored, Inverse, ROWS, singular_values};
use super::rates::ORDERS;
use super::rotations::{Rotation, cross, product, rotation, short_way};
use super::screws::{Twist, bracket};
use crate::rigid::{Pose, Vec3, add};

/// Newton's steps on the closure: the most, the longest [rad, or parts of the size], and one after which only rounding is left.
const MOST_STEPS: usize = 20;
const LONGEST: f64 = 0.3;
const LAST: f64 = 1e-8;

/// A closure error [rad, or parts of the size] that rounding leaves where the loop is ill conditioned.
const NEARLY_CLOSED: f64 = 1e-9;

/// Norm of the pseudo-inverse [per rad, or size] beyond which the input does not determine what follows: a dead centre.
const DEAD: f64 = 1e7;

/// A twist of what lies behind a fixed transform, by one of a number.
#[derive(Clone, Copy, Debug)]
pub struct Move {
    /// Which number.
    pub number: usize,
    /// The fixed transform, counted from 0, in whose frame behind it the twist is.
    pub place: usize,
    /// Angular and linear part.
    pub twist: [f64; 6],
}

/// The advance of a screw, by one of a number.
#[derive(Clone, Copy, Debug)]
pub struct Advance {
    /// Which number.
    pub number: usize,
    /// The joint, counted from 0.
    pub joint: usize,
    /// What it adds to the advance for a radian.
    pub rate: f64,
}

/// A point of the link behind so many joints, in the frame there (of the report behind none: the ground's), and what one of each
/// number moves it by.
#[derive(Clone, Debug)]
pub struct NumberedPoint {
    /// How many joints are before it.
    pub joints: usize,
    /// Where it is.
    pub at: Vec3,
    /// By number, what one of it adds.
    pub ways: Vec<(usize, Vec3)>,
}

/// The fixed transforms of a loop for some values of its numbers, and the advances of its joints for a radian.
#[derive(Clone, Debug)]
pub struct Design {
    /// Before, between and behind the joints.
    pub fixed: Vec<Pose>,
    /// Of each joint; only those of screws count.
    pub advances: Vec<f64>,
}

/// A loop of turns (R), slides (P), screws (H) and balls (S) with its numbers; lengths in parts of the size.
///
/// Columns are the joints' values, three of a ball: on the way in and out its turns about z, y and x, and in derivatives its
/// rotation about x, y and z of the frame before it.
#[derive(Clone, Debug)]
pub struct NumberedLoop {
    joints: Vec<Joint>,
    first: Vec<usize>,
    columns: usize,
    nominal: Design,
    input: usize,
    /// Columns that stay where they are since they move no other link.
    held: Vec<usize>,
    /// The other passive columns.
    free: Vec<usize>,
    /// Idle freedoms that no column stands for; at each pose one more column is held for each.
    spins: usize,
    numbers: usize,
    moves: Vec<Vec<(usize, Twist)>>,
    advances: Vec<Option<(usize, f64)>>,
    points: Vec<NumberedPoint>,
}

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
    /// The part of each number that no joint can follow (rows, numbers) [rad, or parts of the size].
    pub aside: Vec<f64>,
    /// What moves with each idle joint that is held, for one of it (rows, held, columns).
    pub idle: Vec<f64>,
    /// The same of the points (rows, held, points, 3).
    pub points_idle: Vec<f64>,
}

/// Poses of changed designs: joint values (designs, rows, columns), NaN where they do not close on the same pass, and the
/// determinants (designs, rows) that change their sign at a dead centre.
#[derive(Clone, Debug)]
pub struct Followed {
    pub values: Vec<f64>,
    pub sides: Vec<f64>,
}

/// Where the joints stand.
#[derive(Clone, Debug, Default)]
struct State {
    values: Vec<f64>,
    balls: Vec<Rotation>,
}

/// The loop once round.
#[derive(Clone, Debug, Default)]
struct Around {
    /// Behind each fixed transform but the last, and behind each joint.
    before: Vec<Pose>,
    after: Vec<Pose>,
    screws: Vec<Twist>,
    error: Twist,
}

/// Directions of the kept screws at a pose, by which another is on the same side of dead centres.
struct Side {
    kept: Vec<usize>,
    basis: Vec<Twist>,
}

/// A value for each column, and its rates.
type Orders = [Vec<f64>; ORDERS + 1];

/// What changes along the loop by one number: where what lies behind each joint (from 1) moves to, the twists before each joint
/// and behind the last as series, and the series of the screws.
#[derive(Clone, Debug, Default)]
struct Changes {
    carriers: [Vec<Twist>; ORDERS + 1],
    screws: [Vec<Twist>; ORDERS],
    moves: Vec<Twist>,
}

/// A number, or a column that is one.
#[derive(Clone, Copy)]
enum By {
    Number(usize),
    Column(usize),
}

/// A row with the power series of its rates.
struct Moving {
    inverse: Inverse,
    around: Around,
    kept: Vec<usize>,
    values: Vec<f64>,
    rates: [Vec<f64>; ORDERS],
    /// Of what lies before each joint, and behind the last.
    twists: [Vec<Twist>; ORDERS],
    screws: [Vec<Twist>; ORDERS],
}

/// What a coefficient of a power series is as a derivative.
const FACTORIALS: [f64; ORDERS] = [1.0, 1.0, 2.0];

impl Around {
    /// The frame behind so many joints.
    fn behind(&self, joints: usize) -> Pose {
        joints.checked_sub(1).map_or(Pose::STILL, |last| self.after[last])
    }
}

fn plus(sum: &mut Twist, twist: &Twist, factor: f64) {
    for k in 0..6 {
        sum[k] += factor * twist[k];
    }
}

/// What a twist does to a point.
fn carried(twist: &Twist, at: Vec3) -> Vec3 {
    add(cross(&twist[..3], &at), [twist[3], twist[4], twist[5]])
}

/// A twist of a frame in that in which the frame's pose is given.
fn adjoined(pose: &Pose, twist: &Twist) -> Twist {
    let spin = pose.turn([twist[0], twist[1], twist[2]]);
    let slide = add(
        pose.turn([twist[3], twist[4], twist[5]]),
        cross(&pose.translation, &spin),
    );
    [spin[0], spin[1], spin[2], slide[0], slide[1], slide[2]]
}

fn turning(axis: Vec3, at: Vec3) -> Twist {
    let moment = cross(&at, &axis);
    [axis[0], axis[1], axis[2], moment[0], moment[1], moment[2]]
}

fn sliding(axis: Vec3) -> Twist {
    [0.0, 0.0, 0.0, axis[0], axis[1], axis[2]]
}

/// The rotation of turns about z, y and x.
fn turned(angles: &[f64]) -> Rotation {
    let about = |axis: usize, angle: f64| {
        let mut v = [0.0; 3];
        v[axis] = angle;
        rotation(v)
    };
    product(
        &product(&about(2, angles[0]), &about(1, angles[1])),
        &about(0, angles[2]),
    )
}

/// Turns about z, y and x that make up a rotation.
fn turns(r: &Rotation) -> [f64; 3] {
    let level = r[0][0].hypot(r[1][0]);
    let z = r[1][0].atan2(r[0][0]);
    let (s, c) = z.sin_cos();
    [
        z,
        (-r[2][0]).atan2(level),
        (s * r[0][2] - c * r[1][2]).atan2(c * r[1][1] - s * r[0][1]),
    ]
}

/// The same, as near as can be to others: all may go round, and with the outer ones half round the middle one is mirrored.
fn turns_near(r: &Rotation, near: &[f64]) -> [f64; 3] {
    let half = std::f64::consts::PI;
    let [z, y, x] = turns(r);
    let each = [[z, y, x], [z + half, half - y, x + half]]
        .map(|own| std::array::from_fn(|k| near[k] + short_way(own[k] - near[k])));
    let apart = |own: &[f64; 3]| (0..3).map(|k| (own[k] - near[k]).powi(2)).sum::<f64>();
    if apart(&each[1]) < apart(&each[0]) {
        each[1]
    } else {
        each[0]
    }
}

fn determinant(mut a: Vec<Vec<f64>>) -> f64 {
    let n = a.len();
    let mut out = 1.0;
    for k in 0..n {
        let pivot = (k..n)
            .max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs()))
            .unwrap_or(k);
        if pivot != k {
            a.swap(pivot, k);
            out = -out;
        }
        out *= a[k][k];
        if a[k][k] == 0.0 {
            return 0.0;
        }
        for i in k + 1..n {
            let factor = a[i][k] / a[k][k];
            for j in k..n {
                a[i][j] -= factor * a[k][j];
            }
        }
    }
    out
}

impl NumberedLoop {
    /// From the joints by their letters, the transforms before, between and behind them, the driving column, the columns that are
    /// held, how many idle freedoms more there are, the count of numbers, and what each moves. `None` where these do not fit.
    #[expect(clippy::too_many_arguments)]
    pub fn new(
        letters: &str,
        nominal: Design,
        input: usize,
        held: Vec<usize>,
        spins: usize,
        numbers: usize,
        moves: &[Move],
        advances: &[Advance],
        points: Vec<NumberedPoint>,
    ) -> Option<Self> {
        let mut balls = 0;
        let mut joints = Vec::new();
        for (letter, &advance) in letters.chars().zip(&nominal.advances) {
            joints.push(match letter {
                'R' => Joint::Turn,
                'P' => Joint::Slide,
                'H' => Joint::Screw(advance),
                'S' => Joint::Ball(balls),
                _ => return None,
            });
            balls += usize::from(letter == 'S');
        }
        let count = joints.len();
        let mut first = Vec::with_capacity(count);
        let mut columns = 0;
        for joint in &joints {
            first.push(columns);
            columns += joint.columns();
        }
        let mut by_place = vec![Vec::new(); numbers * (count + 1)];
        for m in moves.iter().filter(|m| m.number < numbers && m.place <= count) {
            by_place[m.number * (count + 1) + m.place].push((m.place, m.twist));
        }
        let moves: Vec<Vec<(usize, Twist)>> = by_place.chunks(count + 1).map(|one| one.concat()).collect();
        let mut by_number = vec![None; numbers];
        for a in advances.iter().filter(|a| a.number < numbers && a.joint < count) {
            by_number[a.number] = Some((a.joint, a.rate));
        }
        let free: Vec<usize> = (0..columns)
            .filter(|c| *c != input && !held.contains(c))
            .collect();
        let fits = nominal.fixed.len() == count + 1
            && nominal.advances.len() == letters.len()
            && letters.len() == count
            && count > 0
            && input < columns
            && free.len() >= spins
            && free.len() - spins <= COLUMNS
            && points
                .iter()
                .all(|p| p.joints <= count && p.ways.iter().all(|w| w.0 < numbers));
        fits.then_some(Self {
            joints,
            first,
            columns,
            nominal,
            input,
            held,
            free,
            spins,
            numbers,
            moves,
            advances: by_number,
            points,
        })
    }

    /// How many columns of joint values there are.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// How many joints there are.
    pub fn joints(&self) -> usize {
        self.joints.len()
    }

    /// How many numbers there are.
    pub fn numbers(&self) -> usize {
        self.numbers
    }

    /// How many points there are.
    pub fn points(&self) -> usize {
        self.points.len()
    }

    /// How many columns are held at a pose.
    pub fn idle(&self) -> usize {
        self.held.len() + self.spins
    }

    fn state(&self, values: &[f64]) -> State {
        let balls = self
            .joints
            .iter()
            .zip(&self.first)
            .filter(|(joint, _)| matches!(joint, Joint::Ball(_)))
            .map(|(_, &c)| turned(&values[c..c + 3]))
            .collect();
        State { values: values.to_vec(), balls }
    }

    fn move_by(&self, at: &mut State, columns: impl Iterator<Item = (usize, f64)>) {
        let mut spins = vec![[0.0; 3]; at.balls.len()];
        for (column, by) in columns {
            let joint = self.joint_of(column);
            match self.joints[joint] {
                Joint::Ball(b) => spins[b][column - self.first[joint]] += by,
                _ => at.values[column] += by,
            }
        }
        for (ball, spin) in at.balls.iter_mut().zip(spins) {
            *ball = product(&rotation(spin), ball);
        }
    }

    fn joint_of(&self, column: usize) -> usize {
        self.first.partition_point(|&f| f <= column) - 1
    }

    /// The values of a state, into one row; a ball's turns as near as can be to those of another row.
    fn write(&self, at: &State, near: &[f64], out: &mut [f64]) {
        out.copy_from_slice(&at.values);
        for (joint, &c) in self.joints.iter().zip(&self.first) {
            if let Joint::Ball(b) = *joint {
                out[c..c + 3].copy_from_slice(&turns_near(&at.balls[b], &near[c..c + 3]));
            }
        }
    }

    fn walk(&self, design: &Design, at: &State, out: &mut Around) {
        out.before.clear();
        out.after.clear();
        out.screws.clear();
        let mut frame = design.fixed[0];
        for (i, joint) in self.joints.iter().enumerate() {
            let c = self.first[i];
            out.before.push(frame);
            let z = frame.column(2);
            let value = at.values[c];
            let (advance, angle) = match *joint {
                Joint::Slide => (1.0, None),
                Joint::Ball(b) => {
                    for k in 0..3 {
                        out.screws.push(turning(frame.column(k), frame.translation));
                    }
                    frame.rotation = product(&frame.rotation, &at.balls[b]);
                    (0.0, None)
                }
                Joint::Turn => (0.0, Some(value)),
                Joint::Screw(_) => (design.advances[i], Some(value)),
            };
            if let Some(angle) = angle {
                let mut screw = turning(z, frame.translation);
                plus(&mut screw, &sliding(z), advance);
                out.screws.push(screw);
                let (s, cosine) = angle.sin_cos();
                for row in &mut frame.rotation {
                    (row[0], row[1]) = (row[0] * cosine + row[1] * s, row[1] * cosine - row[0] * s);
                }
            } else if *joint == Joint::Slide {
                out.screws.push(sliding(z));
            }
            if advance != 0.0 {
                for k in 0..3 {
                    frame.translation[k] += advance * value * z[k];
                }
            }
            out.after.push(frame);
            frame = frame.then(&design.fixed[i + 1]);
        }
        let r = &frame.rotation;
        // turned right round the antisymmetric part is small again
        let far = r[0][0] + r[1][1] + r[2][2] < 1.0;
        let skew = [r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]]
            .map(|x| if far { 1.0 } else { x / 2.0 });
        let t = frame.translation;
        out.error = [skew[0], skew[1], skew[2], t[0], t[1], t[2]];
    }

    /// The columns that follow the input at a pose: the free ones without as many as spin idly there.
    fn kept(&self, around: &Around) -> Vec<usize> {
        if self.spins == 0 {
            return self.free.clone();
        }
        let columns: Vec<Vec<f64>> = self.free.iter().map(|&c| around.screws[c].to_vec()).collect();
        let (_, vectors) = singular_values(&columns);
        let mut idle: Vec<Vec<f64>> = vectors[vectors.len() - self.spins..].to_vec();
        let mut kept = self.free.clone();
        while let Some(mut vector) = idle.pop() {
            let most = (0..vector.len())
                .max_by(|&i, &j| vector[i].abs().total_cmp(&vector[j].abs()))
                .unwrap_or(0);
            let pivot = vector[most];
            vector.remove(most);
            kept.remove(most);
            for other in &mut idle {
                let share = other.remove(most) / pivot;
                for (x, v) in other.iter_mut().zip(&vector) {
                    *x -= share * v;
                }
            }
        }
        kept
    }

    fn factored(&self, around: &Around, kept: &[usize]) -> Factored {
        let mut columns = [[0.0; ROWS]; COLUMNS];
        for (column, &c) in columns.iter_mut().zip(kept) {
            column[..6].copy_from_slice(&around.screws[c]);
        }
        Factored::new(columns, kept.len())
    }

    /// The kept screws' directions, by Gram and Schmidt.
    fn side(&self, around: &Around) -> Side {
        let kept = self.kept(around);
        let mut basis: Vec<Twist> = Vec::with_capacity(kept.len());
        for &c in &kept {
            let mut direction = around.screws[c];
            // twice is enough
            for _ in 0..2 {
                for other in &basis {
                    let along: f64 = (0..6).map(|k| direction[k] * other[k]).sum();
                    plus(&mut direction, other, -along);
                }
            }
            let length = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
            basis.push(direction.map(|x| x / length));
        }
        Side { kept, basis }
    }

    /// The determinant of the kept screws along directions of another pose, positive there.
    fn beside(&self, side: &Side, around: &Around) -> f64 {
        determinant(
            side.basis
                .iter()
                .map(|b| {
                    side.kept
                        .iter()
                        .map(|&c| (0..6).map(|k| b[k] * around.screws[c][k]).sum())
                        .collect()
                })
                .collect(),
        )
    }

    /// Closed poses of designs at inputs (rows,), by Newton's method from poses (rows, columns) of this loop nearby, moved by
    /// `steps` (designs, rows, columns) at first. One that comes out beyond a dead centre of the input, where the determinant of
    /// the screws changes its sign, is on another pass and so NaN, as is one that does not close.
    pub fn follow(
        &self,
        values: &[f64],
        inputs: &[f64],
        steps: Option<&[f64]>,
        designs: &[Design],
    ) -> Followed {
        let (rows, width) = (inputs.len(), self.columns);
        let mut out = Followed {
            values: vec![f64::NAN; designs.len() * rows * width],
            sides: vec![f64::NAN; designs.len() * rows],
        };
        let mut around = Around::default();
        for (row, (near, &input)) in values.chunks(width).zip(inputs).enumerate() {
            if !(input.is_finite() && near.iter().all(|x| x.is_finite())) {
                continue;
            }
            let start = self.state(near);
            self.walk(&self.nominal, &start, &mut around);
            let side = self.side(&around);
            for (number, design) in designs.iter().enumerate() {
                let place = number * rows + row;
                let mut at = start.clone();
                if let Some(steps) = steps {
                    let step = &steps[place * width..][..width];
                    if step.iter().all(|x| x.is_finite()) {
                        self.move_by(&mut at, step.iter().copied().enumerate());
                    }
                }
                at.values[self.input] = input;
                if let Some(det) = self.close(design, &side, &mut at, &mut around) {
                    self.write(&at, near, &mut out.values[place * width..][..width]);
                    out.sides[place] = det;
                }
            }
        }
        out
    }

    fn close(&self, design: &Design, side: &Side, at: &mut State, around: &mut Around) -> Option<f64> {
        for _ in 0..MOST_STEPS {
            self.walk(design, at, around);
            let e = around.error;
            let step = self
                .factored(around, &side.kept)
                .solve([e[0], e[1], e[2], e[3], e[4], e[5], 0.0]);
            let longest = step.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
            if !longest.is_finite() {
                return None;
            }
            let factor = -(LONGEST / longest.max(LONGEST));
            self.move_by(at, side.kept.iter().zip(step).map(|(&c, x)| (c, factor * x)));
            if longest < LAST {
                break;
            }
        }
        self.walk(design, at, around);
        let det = self.beside(side, around);
        (around.error.iter().all(|x| x.abs() < NEARLY_CLOSED) && det > 0.0).then_some(det)
    }

    /// Rates by the input and derivatives up to an order (0 to 3) at closed poses (rows, columns); NaN at dead centres.
    pub fn slopes(&self, values: &[f64], order: usize) -> Slopes {
        let (width, all, orders) = (self.columns, self.numbers + 1, order + 1);
        let (rows, points, idle) = (values.len() / width, self.points.len(), self.idle());
        let nan = |count: usize| vec![f64::NAN; rows * count];
        let mut out = Slopes {
            rates: nan(ORDERS * width),
            by_number: nan(orders * all * width),
            points: nan(points * 6),
            points_by_number: nan(points * 2 * all * 3),
            aside: nan(self.numbers),
            idle: nan(idle * width),
            points_idle: nan(idle * points * 3),
        };
        for (row, at) in values.chunks(width).enumerate() {
            if !at.iter().all(|x| x.is_finite()) {
                continue;
            }
            let mut around = Around::default();
            self.walk(&self.nominal, &self.state(at), &mut around);
            for (i, point) in self.points.iter().enumerate() {
                let place = around.behind(point.joints).carry(point.at);
                out.points[(row * points + i) * 6..][..3].copy_from_slice(&place);
            }
            if let Some(moving) = self.moving(around, at) {
                self.row(&moving, row, orders, &mut out);
            }
        }
        out
    }

    /// A row with its rates; `None` at a dead centre.
    fn moving(&self, around: Around, values: &[f64]) -> Option<Moving> {
        let kept = self.kept(&around);
        let inverse = self.factored(&around, &kept).inverse();
        let size = inverse.square(6).sqrt();
        if size.is_nan() || size >= DEAD {
            return None;
        }
        let still = vec![[0.0; 6]; self.columns];
        let screws = [around.screws.clone(), still.clone(), still];
        let mut moving = Moving {
            inverse,
            around,
            kept,
            values: values.to_vec(),
            rates: std::array::from_fn(|_| vec![0.0; self.columns]),
            twists: std::array::from_fn(|_| vec![[0.0; 6]; self.joints.len() + 1]),
            screws,
        };
        for k in 0..ORDERS {
            let mut right = [0.0; 6];
            if k == 0 {
                plus(&mut right, &moving.screws[0][self.input], 1.0);
            }
            for a in 1..=k {
                for c in 0..self.columns {
                    plus(&mut right, &moving.screws[a][c], moving.rates[k - a][c]);
                }
            }
            let mut rates = std::mem::take(&mut moving.rates[k]);
            moving.solve(&right, &mut rates);
            rates[self.input] = if k == 0 { 1.0 } else { 0.0 };
            moving.rates[k] = rates;
            let mut twist = [0.0; 6];
            for (i, joint) in self.joints.iter().enumerate() {
                moving.twists[k][i] = twist;
                for c in self.first[i]..self.first[i] + joint.columns() {
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
            moving.twists[k][self.joints.len()] = twist;
        }
        Some(moving)
    }

    fn row(&self, moving: &Moving, row: usize, orders: usize, out: &mut Slopes) {
        let (width, all, points) = (self.columns, self.numbers + 1, self.points.len());
        for k in 0..ORDERS {
            let part = &mut out.rates[(row * ORDERS + k) * width..][..width];
            for (to, rate) in part.iter_mut().zip(&moving.rates[k]) {
                *to = FACTORIALS[k] * rate;
            }
        }
        let mut places = Vec::with_capacity(points);
        for (i, point) in self.points.iter().enumerate() {
            let place = moving.around.behind(point.joints).carry(point.at);
            let velocity = carried(&moving.twists[0][point.joints], place);
            out.points[(row * points + i) * 6 + 3..][..3].copy_from_slice(&velocity);
            places.push(place);
        }
        let block = &mut out.by_number[row * orders * all * width..][..orders * all * width];
        let mut slopes: Orders = std::array::from_fn(|_| vec![0.0; width]);
        let mut changes = Changes {
            carriers: std::array::from_fn(|_| vec![[0.0; 6]; self.joints.len() + 1]),
            screws: std::array::from_fn(|_| vec![[0.0; 6]; width]),
            moves: Vec::new(),
        };
        for number in 0..all {
            let own = (number < self.numbers).then_some(number);
            let by = own.map_or(By::Column(self.input), By::Number);
            let aside = self.derived(moving, by, orders, &mut slopes, &mut changes);
            if let Some(own) = own {
                out.aside[row * self.numbers + own] = aside;
            }
            for (order, part) in slopes.iter().enumerate().take(orders) {
                let factor = FACTORIALS[order.saturating_sub(1)];
                let to = &mut block[(order * all + number) * width..][..width];
                for (to, slope) in to.iter_mut().zip(part) {
                    *to = factor * slope;
                }
            }
            for (i, point) in self.points.iter().enumerate() {
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
        let spun = self.free.iter().filter(|c| !moving.kept.contains(c));
        for (i, &column) in self.held.iter().chain(spun).enumerate() {
            self.derived(moving, By::Column(column), 1, &mut slopes, &mut changes);
            let place = row * self.idle() + i;
            out.idle[place * width..][..width].copy_from_slice(&slopes[0]);
            for (k, point) in self.points.iter().enumerate() {
                let way = carried(&changes.carriers[0][point.joints], places[k]);
                out.points_idle[(place * points + k) * 3..][..3].copy_from_slice(&way);
            }
        }
    }

    /// The derivatives of values and rates by one number, and the part of it that no joint can follow.
    fn derived(
        &self,
        moving: &Moving,
        by: By,
        orders: usize,
        slopes: &mut Orders,
        changes: &mut Changes,
    ) -> f64 {
        let screws = &moving.screws;
        let (moves, advance, column) = match by {
            By::Number(n) => (&self.moves[n][..], self.advances[n], None),
            By::Column(c) => (&[][..], None, Some(c)),
        };
        // the advance of a screw: its part of the screw, and where it has slid to
        let slid = advance.map(|(joint, rate)| {
            let part = sliding(moving.around.before[joint].column(2)).map(|x| rate * x);
            (joint, part, moving.values[self.first[joint]])
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
        // corrected once by what it leaves over, where a dead centre is near
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
        for (i, joint) in self.joints.iter().enumerate() {
            while next < moves.len() && moves[next].0 <= i {
                plus(&mut carrier, &changes.moves[next], 1.0);
                next += 1;
            }
            let before = carrier;
            let direct = slid.as_ref().filter(|s| s.0 == i);
            for c in self.first[i]..self.first[i] + joint.columns() {
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
        for k in 0..orders - 1 {
            let mut right = [0.0; 6];
            for a in 0..=k {
                for c in 0..self.columns {
                    plus(&mut right, &changes.screws[a][c], moving.rates[k - a][c]);
                    if a > 0 {
                        plus(&mut right, &screws[a][c], slopes[k - a + 1][c]);
                    }
                }
            }
            moving.solve(&right, &mut slopes[k + 1]);
            let mut carrier = [0.0; 6];
            for (i, joint) in self.joints.iter().enumerate() {
                changes.carriers[k + 1][i] = carrier;
                for c in self.first[i]..self.first[i] + joint.columns() {
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
            changes.carriers[k + 1][self.joints.len()] = carrier;
        }
        aside
    }
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

#[cfg(test)]
mod tests {
    use super::super::rotations::transposed;
    use super::*;
    use crate::rigid::norm;

    #[test]
    fn turns_make_up_their_rotation_again() {
        for angles in [
            [0.3, -0.8, 2.0],
            [3.0, std::f64::consts::FRAC_PI_2, 0.4],
            [-2.0, 0.0, 0.0],
        ] {
            let r = turned(&angles);
            let again = turned(&turns(&r));
            let apart = product(&r, &transposed(&again));
            assert!((0..3).all(|i| (apart[i][i] - 1.0).abs() < 1e-14), "{angles:?}");
        }
    }

    #[test]
    fn a_determinant_is_signed() {
        let a = vec![vec![0.0, 2.0], vec![3.0, 1.0]];
        assert_eq!(determinant(a), -6.0);
        assert!(norm(carried(&[0.0, 0.0, 1.0, 0.0, 0.0, 0.0], [2.0, 0.0, 5.0])) == 2.0);
    }
}
