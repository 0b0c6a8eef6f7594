//! A point of a link that only turns about one direction carry: its place with three derivatives, by angular velocities.

use super::dyads::Plane;
use super::in_plane::{Complex, Moving};
use super::joints::TERMS;
use super::net::Net;
use super::net_rows::NetRow;
use super::rows::On;
use super::steps::Move;
use crate::rigid::{Vec3, cross, dot, norm};
use num_complex::Complex64;

/// Directions whose sine is less are parallel: rounding.
const PARALLEL: f64 = 1e-12;

/// A step on the way to a link: its column, to which side it turns, what it reads as drawn, and the next pin or the point against its own.
#[derive(Clone, Copy, Debug)]
struct Turn {
    column: usize,
    side: f64,
    reads: f64,
    off: Complex64,
}

/// A point that some turns carry.
#[derive(Debug)]
pub(super) struct PlanePoint {
    plane: Plane,
    /// Across the plane.
    off: Vec3,
    base: Complex64,
    turns: Vec<Turn>,
}

impl PlanePoint {
    /// Of a point of a link of a net, as drawn; `None` where other steps than turns about one direction carry it.
    pub fn of(net: &Net, link: On, at: Vec3) -> Option<Self> {
        let mut way = Vec::new();
        let mut on = link;
        while let Some(step) = on {
            way.push(step);
            on = net.steps[step].parent;
        }
        let normal = net.steps[*way.first()?].axis;
        let plane = Plane::across(normal);
        let mut next = plane.place(at);
        let mut turns = Vec::new();
        for column in way {
            let step = &net.steps[column];
            if step.moves != Move::Turn || norm(cross(step.axis, normal)) > PARALLEL {
                return None;
            }
            let pin = plane.place(step.origin);
            let side = dot(step.axis, normal).signum();
            turns.push(Turn { column, side, reads: step.reads, off: next - pin });
            next = pin;
        }
        turns.reverse();
        let height = dot(at, normal);
        Some(Self { plane, off: normal.map(|x| x * height), base: next, turns })
    }

    /// Its place on a row and three derivatives, at a speed of the input.
    pub fn on(&self, row: NetRow<'_>, speed: f64) -> [Vec3; TERMS] {
        let still = Complex::constant(Complex64::ZERO);
        let mut place = [Complex::constant(self.base), still, still, still];
        let mut angle = 0.0;
        let mut spin = [0.0; TERMS - 1];
        let factors = [speed, speed * speed, 2.0 * speed * speed * speed];
        for turn in &self.turns {
            angle += turn.side * (row.values()[turn.column] - turn.reads);
            for (order, spin) in spin.iter_mut().enumerate() {
                *spin += turn.side * factors[order] * row.rates(order)[turn.column];
            }
            let (im, re) = angle.sin_cos();
            place = Moving::new(Complex { re, im }, place, spin).carry(turn.off);
        }
        let mut out = place.map(|place| self.plane.direction(Complex64::new(place.re, place.im)));
        for (x, off) in out[0].iter_mut().zip(self.off) {
            *x += off;
        }
        out
    }
}
