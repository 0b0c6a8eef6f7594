//! The wrenches on links from their motion and from what acts on them: inertia, weight, loads, springs.
//!
//! A station is what lies behind so many joints. With a and the angular velocity w of a body of mass m and inertia I about its
//! centre c, momentum changes by `H' = (c x m a + I w' + w x I w, m a)`, and station i gets `F_i = gravity, loads, springs - H'`.
//!
//! Source: docs/theory_forces.md, (1) and (2).

use super::acting::{Acting, Body, Place};
use crate::loops::equation::rotations::{Rotation, cross, dot3};
use crate::loops::equation::screws::Twist;
use crate::number::Number;
use crate::rigid::Vec3;

/// Where a station is and how it moves, by time: its twist, and the derivative of that.
#[derive(Clone, Copy, Debug)]
pub(super) struct Station<N> {
    pub rotation: Rotation<N>,
    pub place: [N; 3],
    pub twist: Twist<N>,
    pub change: Twist<N>,
}

/// What acts on a loop in one pose.
#[derive(Clone, Debug)]
pub(super) struct Acts<N> {
    /// On each station, (moment about the origin, force), inertia included.
    pub wrenches: Vec<Twist<N>>,
    /// What springs and dampers in joints add to the columns.
    pub in_joints: Vec<N>,
    /// The sum of `-H'`.
    pub shaking: Twist<N>,
    pub kinetic: N,
    /// Of weights and springs.
    pub potential: N,
    /// The power of loads and dampers.
    pub supplied: N,
}

/// Closer than this [relative to the size] the ends of a spring have no line between them.
const NO_LINE: f64 = 1e-12;

fn vector<N: Number>(v: Vec3) -> [N; 3] {
    v.map(N::splat)
}

fn plus<N: Number>(a: [N; 3], b: [N; 3]) -> [N; 3] {
    std::array::from_fn(|k| a[k] + b[k])
}

fn times<N: Number>(a: [N; 3], factor: N) -> [N; 3] {
    a.map(|x| x * factor)
}

impl<N: Number> Station<N> {
    fn turn(&self, v: &[N; 3]) -> [N; 3] {
        std::array::from_fn(|i| dot3(&self.rotation[i], v))
    }

    fn turn_back(&self, v: &[N; 3]) -> [N; 3] {
        std::array::from_fn(|j| {
            let column: [N; 3] = std::array::from_fn(|i| self.rotation[i][j]);
            dot3(&column, v)
        })
    }

    fn carry(&self, at: &[N; 3]) -> [N; 3] {
        plus(self.turn(at), self.place)
    }

    fn velocity(&self, at: &[N; 3]) -> [N; 3] {
        plus(
            cross(&self.twist[..3], at),
            [self.twist[3], self.twist[4], self.twist[5]],
        )
    }
}

/// The wrench (moment about the origin, force) of a force at a place and a torque.
fn wrench<N: Number>(at: &[N; 3], force: &[N; 3], torque: &[N; 3]) -> Twist<N> {
    let moment = plus(cross(at, force), *torque);
    [moment[0], moment[1], moment[2], force[0], force[1], force[2]]
}

fn add<N: Number>(sum: &mut Twist<N>, wrench: &Twist<N>) {
    for k in 0..6 {
        sum[k] = sum[k] + wrench[k];
    }
}

/// The product of a wrench and a twist: power.
pub(super) fn power<N: Number>(twist: &Twist<N>, wrench: &Twist<N>) -> N {
    dot3(&twist[..3], &wrench[..3]) + dot3(&twist[3..], &wrench[3..])
}

/// How numbers move what is fixed to a station: by a derivative, where there is one.
pub(super) trait Moved<N> {
    /// A place in its station's frame.
    fn place(&self, place: &Place) -> [N; 3];
    /// A direction that is fixed at a place.
    fn direction(&self, place: &Place, v: Vec3) -> [N; 3];
    /// A body's centre and inertia in its station's frame.
    fn body(&self, body: &Body) -> ([N; 3], Rotation<N>);
}

/// Numbers stay as they are.
pub(super) struct Still;

impl<N: Number> Moved<N> for Still {
    fn place(&self, place: &Place) -> [N; 3] {
        vector(place.at)
    }

    fn direction(&self, _: &Place, v: Vec3) -> [N; 3] {
        vector(v)
    }

    fn body(&self, body: &Body) -> ([N; 3], Rotation<N>) {
        (vector(body.centre), body.inertia.map(vector))
    }
}

/// What acts in a pose: stations, values and rates of the columns, and the factor of each load.
pub(super) fn acts<N: Number>(
    acting: &Acting,
    stations: &[Station<N>],
    values: &[N],
    rates: &[N],
    factors: &[f64],
    moved: &impl Moved<N>,
) -> Acts<N> {
    let zero = N::splat(0.0);
    let mut out = Acts {
        wrenches: vec![[zero; 6]; stations.len()],
        in_joints: vec![zero; values.len()],
        shaking: [zero; 6],
        kinetic: zero,
        potential: zero,
        supplied: zero,
    };
    let gravity: [N; 3] = vector(acting.gravity);
    for body in &acting.bodies {
        let station = &stations[body.joints];
        let (centre, inertia) = moved.body(body);
        let mass = N::splat(body.mass);
        let arm = station.carry(&centre);
        let spin = [station.twist[0], station.twist[1], station.twist[2]];
        let turning = [station.change[0], station.change[1], station.change[2]];
        let speed = station.velocity(&arm);
        let acceleration = plus(
            plus(
                cross(&turning, &arm),
                [station.change[3], station.change[4], station.change[5]],
            ),
            cross(&spin, &speed),
        );
        let through = |v: &[N; 3]| {
            let own = station.turn_back(v);
            station.turn(&std::array::from_fn(|i| dot3(&inertia[i], &own)))
        };
        let angular = through(&spin);
        let torque = plus(through(&turning), cross(&spin, &angular));
        let inertial = wrench(&arm, &times(acceleration, -mass), &times(torque, -N::splat(1.0)));
        add(&mut out.shaking, &inertial);
        add(&mut out.wrenches[body.joints], &inertial);
        let weight = times(gravity, mass);
        add(&mut out.wrenches[body.joints], &wrench(&arm, &weight, &[zero; 3]));
        let half = N::splat(0.5);
        out.kinetic = out.kinetic + half * (mass * dot3(&speed, &speed) + dot3(&spin, &angular));
        out.potential = out.potential - dot3(&weight, &arm);
    }
    for (load, &factor) in acting.loads.iter().zip(factors) {
        let station = &stations[load.place.joints];
        let at = station.carry(&moved.place(&load.place));
        let seen = |v: Vec3| {
            let own = if load.turns {
                station.turn(&moved.direction(&load.place, v))
            } else {
                vector(v)
            };
            times(own, N::splat(factor))
        };
        let own = wrench(&at, &seen(load.force), &seen(load.torque));
        out.supplied = out.supplied + power(&station.twist, &own);
        add(&mut out.wrenches[load.place.joints], &own);
    }
    for spring in &acting.springs {
        let ends = spring.ends.each_ref().map(|end| {
            let station = &stations[end.joints];
            let at = station.carry(&moved.place(end));
            (at, station.velocity(&at))
        });
        let apart: [N; 3] = std::array::from_fn(|k| ends[1].0[k] - ends[0].0[k]);
        let parting: [N; 3] = std::array::from_fn(|k| ends[1].1[k] - ends[0].1[k]);
        let stiffness = N::splat(spring.stiffness);
        let near = N::splat(NO_LINE);
        let square = dot3(&apart, &apart);
        // without a line between its ends a spring pulls nowhere
        let least = near * near;
        let length = square.if_greater(least, square, least).sqrt();
        let along = times(apart, N::splat(1.0) / length);
        let longer = dot3(&along, &parting);
        let stretch = length - N::splat(spring.length);
        let damped = N::splat(spring.damping) * longer;
        let force = times(along, stiffness * stretch + damped);
        add(
            &mut out.wrenches[spring.ends[0].joints],
            &wrench(&ends[0].0, &force, &[zero; 3]),
        );
        add(
            &mut out.wrenches[spring.ends[1].joints],
            &wrench(&ends[1].0, &times(force, -N::splat(1.0)), &[zero; 3]),
        );
        out.potential = out.potential + N::splat(0.5) * stiffness * stretch * stretch;
        out.supplied = out.supplied - damped * longer;
    }
    for spring in &acting.joint_springs {
        let (stiffness, damping) = (N::splat(spring.stiffness), N::splat(spring.damping));
        let stretch = values[spring.column] - N::splat(spring.slack);
        let rate = rates[spring.column];
        out.in_joints[spring.column] = out.in_joints[spring.column] - stiffness * stretch - damping * rate;
        out.potential = out.potential + N::splat(0.5) * stiffness * stretch * stretch;
        out.supplied = out.supplied - damping * rate * rate;
    }
    out
}
