//! The input's torque and the wrench in every joint, row by row; with derivatives by the numbers of the description.
//!
//! With W the wrench that the link before the first joint puts on the link after it, and C_i what acts on the links from there to joint i,
//! this bears `W_i = W + C_i`. Along each of its freedoms c it passes on `S_c . W_i = Q_c` alone: what a spring in the joint gives, and
//! at the input the torque. So
//!
//! `A^T W = Q - c,   c_c = S_c . C_i`
//!
//! with the screws A of the columns that follow the input, whose inverse is that of the rates. Where redundant constraints leave W
//! open, this is the shortest one, and `free` spans what is open. Columns that are held from spinning idly bear what the rule needs.
//!
//! Source: docs/theory_forces.md, (3) to (6).

use super::acting::{Acting, Body, Place};
use super::stations::{Acts, Moved, Station, Still, acts, power};
use crate::loops::equation::dense::singular_values;
use crate::loops::equation::rotations::{Rotation, cross};
use crate::loops::equation::screws::Twist;
use crate::loops::numbers::numbered_loop::{Around, NumberedLoop};
use crate::loops::numbers::slopes::{By, Changes, Moving, Orders, derived, moving};
use crate::loops::rates::velocities::ORDERS;
use crate::rigid::{Pose, Vec3, add, sub};
use crate::stopping;
use crate::taylor::Taylor;

/// Where a joint's wrench is counted: a frame against that before one of the loop's joints.
#[derive(Clone, Copy, Debug)]
pub struct Seat {
    /// The joint before which.
    pub joint: usize,
    /// Its frame in that before the joint.
    pub frame: Pose,
}

/// Row by row, flat arrays, rows outermost; NaN at dead centres of the input.
#[derive(Clone, Debug)]
pub struct Reactions {
    /// Of the input (rows,).
    pub torque: Vec<f64>,
    /// What holds each idle freedom (rows, held).
    pub spin: Vec<f64>,
    /// Kinetic and potential energy, and the power of loads and dampers (rows, 3).
    pub energies: Vec<f64>,
    /// Moment and force in each seat, in its own frame (rows, seats, 6).
    pub wrenches: Vec<f64>,
    /// The seats (rows, seats, 12): rotation row by row, place.
    pub seats: Vec<f64>,
    /// Moment about the report's origin and force of all inertia (rows, 6).
    pub shaking: Vec<f64>,
    /// Wrenches of length one in the loop that nothing determines (rows, redundant, 6).
    pub free: Vec<f64>,
    /// How many of these a row has.
    pub redundant: usize,
    /// Derivatives of the torque (rows, numbers) and below of the wrenches (rows, numbers, seats, 6); empty where not wanted.
    pub torque_by_number: Vec<f64>,
    /// Of the wrenches, their frames moving along.
    pub wrenches_by_number: Vec<f64>,
    /// Of the shaking (rows, numbers, 6).
    pub shaking_by_number: Vec<f64>,
}

/// Corrections of the wrench by what it leaves over.
const REFINEMENTS: usize = 1;

/// What a number moves, as a derivative.
struct ByNumber(usize);

type Dual = Taylor<2>;

fn dual(x: f64, by: f64) -> Dual {
    Taylor([x, by])
}

impl ByNumber {
    /// The twist by this number, of all.
    fn of(&self, ways: &[(usize, Twist)]) -> (Vec3, Vec3) {
        let way = ways.iter().find(|w| w.0 == self.0).map_or([0.0; 6], |w| w.1);
        parts(&way)
    }
}

impl Moved<Dual> for ByNumber {
    fn place(&self, place: &Place) -> [Dual; 3] {
        let (spin, slide) = self.of(&place.ways);
        let way = add(cross(&spin, &place.at), slide);
        std::array::from_fn(|k| dual(place.at[k], way[k]))
    }

    fn direction(&self, place: &Place, v: Vec3) -> [Dual; 3] {
        let way = cross(&self.of(&place.ways).0, &v);
        std::array::from_fn(|k| dual(v[k], way[k]))
    }

    fn body(&self, body: &Body) -> ([Dual; 3], Rotation<Dual>) {
        let (spin, slide) = self.of(&body.ways);
        let moved = add(cross(&spin, &body.centre), slide);
        // [w x] I - I [w x], column by column
        let turned: [Vec3; 3] = std::array::from_fn(|j| {
            let axis: Vec3 = std::array::from_fn(|k| if k == j { 1.0 } else { 0.0 });
            let of = |v: Vec3| -> Vec3 { body.inertia.map(|row| crate::rigid::dot(row, v)) };
            sub(cross(&spin, &of(axis)), of(cross(&spin, &axis)))
        });
        (
            std::array::from_fn(|k| dual(body.centre[k], moved[k])),
            std::array::from_fn(|i| std::array::from_fn(|j| dual(body.inertia[i][j], turned[j][i]))),
        )
    }
}

/// What acts and what follows from it at closed poses (rows, columns), at speeds and accelerations of the input (rows, 2), with
/// the factors of the loads (rows, loads).
pub fn reactions(
    numbered: &NumberedLoop,
    values: &[f64],
    speeds: &[f64],
    acting: &Acting,
    factors: &[f64],
    seats: &[Seat],
    with_numbers: bool,
) -> Reactions {
    let width = numbered.columns;
    let (rows, loads) = (values.len() / width, acting.loads.len());
    let redundant = 6_usize.saturating_sub(numbered.free.len() - numbered.spins);
    let numbers = if with_numbers { numbered.numbers } else { 0 };
    let nan = |count: usize| vec![f64::NAN; rows * count];
    let mut out = Reactions {
        torque: nan(1),
        spin: nan(numbered.idle()),
        energies: nan(3),
        wrenches: nan(seats.len() * 6),
        seats: nan(seats.len() * 12),
        shaking: nan(6),
        free: nan(redundant * 6),
        redundant,
        torque_by_number: nan(numbers),
        wrenches_by_number: nan(numbers * seats.len() * 6),
        shaking_by_number: nan(numbers * 6),
    };
    for (row, at) in values.chunks(width).enumerate() {
        stopping::piece();
        let (speed, acceleration) = (speeds[2 * row], speeds[2 * row + 1]);
        if !(at.iter().all(|x| x.is_finite()) && speed.is_finite() && acceleration.is_finite()) {
            continue;
        }
        let mut around = Around::default();
        numbered.walk(&numbered.nominal, &numbered.state(at), &mut around);
        let Some(moving) = moving(numbered, around, at) else {
            continue;
        };
        let pose = Driven { numbered, moving, speed, acceleration };
        pose.write(acting, &factors[row * loads..][..loads], seats, row, &mut out);
        if with_numbers {
            pose.write_slopes(acting, &factors[row * loads..][..loads], seats, row, &mut out);
        }
    }
    out
}

/// A row at the speed of its input.
struct Driven<'a> {
    numbered: &'a NumberedLoop,
    moving: Moving,
    speed: f64,
    acceleration: f64,
}

/// The sum of what acts on the stations behind the first, up to that before each joint.
fn carried_on<N: crate::number::Number>(wrenches: &[Twist<N>]) -> Vec<Twist<N>> {
    let mut sum = [N::splat(0.0); 6];
    let mut out = vec![sum];
    for wrench in &wrenches[1..] {
        for k in 0..6 {
            sum[k] = sum[k] + wrench[k];
        }
        out.push(sum);
    }
    out
}

fn parts(twist: &Twist) -> (Vec3, Vec3) {
    ([twist[0], twist[1], twist[2]], [twist[3], twist[4], twist[5]])
}

/// A wrench about the origin in the frame of a seat.
fn seen(frame: &Pose, wrench: &Twist) -> Twist {
    let (moment, force) = parts(wrench);
    let moment = frame.turn_back(sub(moment, cross(&frame.translation, &force)));
    let force = frame.turn_back(force);
    [moment[0], moment[1], moment[2], force[0], force[1], force[2]]
}

impl Driven<'_> {
    fn joint_of(&self, column: usize) -> usize {
        self.numbered.first.partition_point(|&f| f <= column) - 1
    }

    /// Stations as they are.
    fn stations(&self) -> Vec<Station<f64>> {
        let twists = &self.moving.twists;
        (0..=self.numbered.joints.len())
            .map(|i| {
                let pose = self.moving.around.behind(i);
                Station {
                    rotation: pose.rotation,
                    place: pose.translation,
                    twist: twists[0][i].map(|x| x * self.speed),
                    change: std::array::from_fn(|k| {
                        twists[1][i][k] * self.speed * self.speed + twists[0][i][k] * self.acceleration
                    }),
                }
            })
            .collect()
    }

    /// Stations with their derivatives by a number.
    fn dual_stations(&self, changes: &Changes) -> Vec<Station<Dual>> {
        let still = self.stations();
        still
            .iter()
            .enumerate()
            .map(|(i, station)| {
                let (spin, slide) = parts(&changes.carriers[0][i]);
                let place = add(cross(&spin, &station.place), slide);
                let columns: [Vec3; 3] = std::array::from_fn(|j| {
                    cross(
                        &spin,
                        &std::array::from_fn::<f64, 3, _>(|k| station.rotation[k][j]),
                    )
                });
                let by = [&changes.carriers[1][i], &changes.carriers[2][i]];
                Station {
                    rotation: std::array::from_fn(|k| {
                        std::array::from_fn(|j| dual(station.rotation[k][j], columns[j][k]))
                    }),
                    place: std::array::from_fn(|k| dual(station.place[k], place[k])),
                    twist: std::array::from_fn(|k| dual(station.twist[k], by[0][k] * self.speed)),
                    change: std::array::from_fn(|k| {
                        let more = by[1][k] * self.speed * self.speed + by[0][k] * self.acceleration;
                        dual(station.change[k], more)
                    }),
                }
            })
            .collect()
    }

    fn rates(&self) -> Vec<f64> {
        self.moving.rates[0]
            .iter()
            .map(|rate| rate * self.speed)
            .collect()
    }

    /// The shortest W of `S_c . W = right` for the kept columns c.
    fn solved(&self, right: &[f64]) -> Twist {
        let inverse = &self.moving.inverse.0;
        std::array::from_fn(|k| right.iter().zip(&inverse[k]).map(|(r, x)| r * x).sum())
    }

    /// The wrench before the first joint, from what acts.
    fn wrench(&self, right: &[f64]) -> Twist {
        let screws = &self.moving.screws[0];
        let mut wrench = self.solved(right);
        for _ in 0..REFINEMENTS {
            let left: Vec<f64> = self
                .moving
                .kept
                .iter()
                .zip(right)
                .map(|(&c, r)| r - power(&screws[c], &wrench))
                .collect();
            let more = self.solved(&left);
            for k in 0..6 {
                wrench[k] += more[k];
            }
        }
        wrench
    }

    /// What the joints before the kept columns have still to pass on: `Q - c`.
    fn right(&self, acts: &Acts<f64>, passed: &[Twist]) -> Vec<f64> {
        let screws = &self.moving.screws[0];
        self.moving
            .kept
            .iter()
            .map(|&c| acts.in_joints[c] - power(&screws[c], &passed[self.joint_of(c)]))
            .collect()
    }

    fn write(&self, acting: &Acting, factors: &[f64], seats: &[Seat], row: usize, out: &mut Reactions) {
        let (numbered, screws) = (self.numbered, &self.moving.screws[0]);
        let acts = acts(
            acting,
            &self.stations(),
            &self.moving.values,
            &self.rates(),
            factors,
            &Still,
        );
        let passed = carried_on(&acts.wrenches);
        let first = self.wrench(&self.right(&acts, &passed));
        let before = |joint: usize| -> Twist { std::array::from_fn(|k| first[k] + passed[joint][k]) };
        let given = |c: usize| power(&screws[c], &before(self.joint_of(c))) - acts.in_joints[c];
        out.torque[row] = given(numbered.input);
        let spun = numbered.free.iter().filter(|c| !self.moving.kept.contains(c));
        for (i, &column) in numbered.held.iter().chain(spun).enumerate() {
            out.spin[row * numbered.idle() + i] = given(column);
        }
        out.energies[3 * row..][..3].copy_from_slice(&[acts.kinetic, acts.potential, acts.supplied]);
        out.shaking[6 * row..][..6].copy_from_slice(&acts.shaking);
        for (i, seat) in seats.iter().enumerate() {
            let frame = self.moving.around.before[seat.joint].then(&seat.frame);
            let place = row * seats.len() + i;
            out.wrenches[6 * place..][..6].copy_from_slice(&seen(&frame, &before(seat.joint)));
            let to = &mut out.seats[12 * place..][..12];
            for k in 0..3 {
                to[3 * k..][..3].copy_from_slice(&frame.rotation[k]);
            }
            to[9..].copy_from_slice(&frame.translation);
        }
        if out.redundant > 0 {
            // what is square to all kept screws: right singular vectors of their rows to zero
            let rows: Vec<Vec<f64>> = (0..6)
                .map(|k| self.moving.kept.iter().map(|&c| screws[c][k]).collect())
                .collect();
            let (_, vectors) = singular_values(&rows);
            for (i, vector) in vectors[6 - out.redundant..].iter().enumerate() {
                out.free[(row * out.redundant + i) * 6..][..6].copy_from_slice(vector);
            }
        }
    }

    fn write_slopes(
        &self,
        acting: &Acting,
        factors: &[f64],
        seats: &[Seat],
        row: usize,
        out: &mut Reactions,
    ) {
        let (numbered, moving) = (self.numbered, &self.moving);
        let screws = &moving.screws[0];
        let mut slopes: Orders = std::array::from_fn(|_| vec![0.0; numbered.columns]);
        let mut changes = Changes::new(numbered);
        let rates = self.rates();
        for number in 0..numbered.numbers {
            derived(
                numbered,
                moving,
                By::Number(number),
                ORDERS,
                &mut slopes,
                &mut changes,
            );
            let values: Vec<Dual> = (0..numbered.columns)
                .map(|c| dual(moving.values[c], slopes[0][c]))
                .collect();
            let moved: Vec<Dual> = (0..numbered.columns)
                .map(|c| dual(rates[c], slopes[1][c] * self.speed))
                .collect();
            let acts = acts(
                acting,
                &self.dual_stations(&changes),
                &values,
                &moved,
                factors,
                &ByNumber(number),
            );
            let passed = carried_on(&acts.wrenches);
            let screw = |c: usize| -> Twist<Dual> {
                std::array::from_fn(|k| dual(screws[c][k], changes.screws[0][c][k]))
            };
            let right: Vec<Dual> = moving
                .kept
                .iter()
                .map(|&c| acts.in_joints[c] - power(&screw(c), &passed[self.joint_of(c)]))
                .collect();
            let first = self.wrench(&right.iter().map(Taylor::value).collect::<Vec<_>>());
            let left: Vec<f64> = right
                .iter()
                .zip(&moving.kept)
                .map(|(r, &c)| r.0[1] - power(&changes.screws[0][c], &first))
                .collect();
            let by = self.wrench(&left);
            let before = |joint: usize| -> Twist<Dual> {
                std::array::from_fn(|k| dual(first[k], by[k]) + passed[joint][k])
            };
            let input = numbered.input;
            let torque = power(&screw(input), &before(self.joint_of(input))) - acts.in_joints[input];
            let place = row * numbered.numbers + number;
            out.torque_by_number[place] = torque.0[1];
            out.shaking_by_number[6 * place..][..6].copy_from_slice(&acts.shaking.map(|x| x.0[1]));
            for (i, seat) in seats.iter().enumerate() {
                let frame = moving.around.before[seat.joint].then(&seat.frame);
                let (spin, slide) = parts(&changes.before[seat.joint]);
                let wrench = before(seat.joint);
                let (value, slope) = (wrench.map(|x| x.0[0]), wrench.map(|x| x.0[1]));
                let (moment, force) = parts(&value);
                // the frame moves: what it sees changes by the wrench's own change less that of a wrench carried along
                let turned = cross(&spin, &force);
                let carried = add(cross(&spin, &moment), cross(&slide, &force));
                let own: Twist =
                    std::array::from_fn(|k| slope[k] - if k < 3 { carried[k] } else { turned[k - 3] });
                let place = place * seats.len() + i;
                out.wrenches_by_number[6 * place..][..6].copy_from_slice(&seen(&frame, &own));
            }
        }
    }
}
