//! The word of a description: joints between fixed transforms that depend on its numbers.

use super::factors::{Product, Three};
use super::twists::carried;
use crate::loops::equation::screws::Twist;
use crate::rigid::{Pose, Vec3, add, scale};
use std::f64::consts::TAU;

/// A word `F0 Z1 F1 .. Zn Fn = 1`, whose numbers come in the units of the description.
#[derive(Clone, Debug)]
pub struct Word {
    /// The joints by their letters.
    pub letters: String,
    /// By joint, the number that is its advance for a turn.
    pub pitches: Vec<Option<usize>>,
    /// The transforms before, between and behind them.
    pub fixed: Vec<Product>,
    /// Columns that are held.
    pub held: Vec<usize>,
    /// How many idle freedoms more there are.
    pub spins: usize,
    /// What one of each number is in radians or lengths.
    pub scales: Vec<f64>,
    /// The length to which lengths are relative.
    pub size: f64,
}

/// A point that the link behind so many joints carries; its coordinates stand at a place, or are given.
#[derive(Clone, Debug, PartialEq)]
pub struct Carried {
    /// How many joints are before it.
    pub joints: usize,
    /// The frame there in which it is written.
    pub frame: Product,
    /// The numbers that are its coordinates.
    pub place: Option<Three>,
    /// The coordinates of a point that no number moves.
    pub at: Vec3,
}

/// The fixed transforms of a loop for some values of its numbers, and the advances of its joints for a radian; lengths relative
/// to the size.
#[derive(Clone, Debug)]
pub struct Design {
    /// Before, between and behind the joints.
    pub fixed: Vec<Pose>,
    /// Of each joint; only those of screws count.
    pub advances: Vec<f64>,
}

/// A point of the link behind so many joints, in the frame there (of the report behind none: the ground's), and what one of each
/// number moves it by.
#[derive(Clone, Debug)]
pub(crate) struct NumberedPoint {
    pub joints: usize,
    pub at: Vec3,
    pub ways: Vec<(usize, Vec3)>,
}

impl Word {
    /// Whether its parts belong together, and those of points with them.
    pub fn fits(&self, points: &[Carried]) -> bool {
        let (joints, count) = (self.letters.len(), self.scales.len());
        let known = |product: &Product| product.numbers().all(|k| k < count);
        joints > 0
            && self.pitches.len() == joints
            && self.fixed.len() == joints + 1
            && self.pitches.iter().flatten().all(|&k| k < count)
            && self.fixed.iter().all(known)
            && points.iter().all(|point| {
                point.joints <= joints
                    && known(&point.frame)
                    && point.place.into_iter().flatten().all(|k| k < count)
            })
    }

    /// The numbers in radians and lengths.
    pub(super) fn values(&self, numbers: &[f64]) -> Vec<f64> {
        numbers
            .iter()
            .zip(&self.scales)
            .map(|(x, scale)| x * scale)
            .collect()
    }

    /// What it is at values of its numbers.
    pub(super) fn design(&self, values: &[f64]) -> Design {
        let fixed = self.fixed.iter().map(|product| {
            let pose = product.pose(values);
            Pose { translation: pose.translation.map(|x| x / self.size), ..pose }
        });
        let advance = |pitch: &Option<usize>| pitch.map_or(0.0, |k| values[k] / TAU / self.size);
        Design {
            fixed: fixed.collect(),
            advances: self.pitches.iter().map(advance).collect(),
        }
    }

    /// By each of `only` some numbers, the fixed transforms behind which it moves all, in order, with the twists there.
    pub(super) fn moves(&self, values: &[f64], only: &[usize]) -> Vec<Vec<(usize, Twist)>> {
        let mut found = vec![Vec::new(); only.len()];
        for (place, product) in self.fixed.iter().enumerate().filter(|_| !only.is_empty()) {
            for (number, twist) in self.twists(product, values, only) {
                found[number].push((place, twist));
            }
        }
        found
    }

    /// The twists behind a product by one of each of `only` some numbers.
    pub(super) fn twists(&self, product: &Product, values: &[f64], only: &[usize]) -> Vec<(usize, Twist)> {
        let mut found = product.moves(values, only);
        for (number, twist) in &mut found {
            let unit = self.scales[only[*number]];
            for (k, x) in twist.iter_mut().enumerate() {
                *x *= if k < 3 { unit } else { unit / self.size };
            }
        }
        found
    }

    /// By each of `only` some numbers, the joint whose advance it is, and what one of it adds.
    pub(super) fn advances(&self, only: &[usize]) -> Vec<Option<(usize, f64)>> {
        let joint = |number: &usize| {
            self.pitches
                .iter()
                .position(|pitch| pitch.as_ref() == Some(number))
        };
        only.iter()
            .map(|number| joint(number).map(|own| (own, self.scales[*number] / TAU / self.size)))
            .collect()
    }

    pub(super) fn point(&self, point: &Carried, values: &[f64], only: &[usize]) -> NumberedPoint {
        let frame = point.frame.pose(values);
        let at = point.place.map_or(point.at, |place| place.map(|k| values[k]));
        let own = scale(at, 1.0 / self.size);
        let twists = self.twists(&point.frame, values, only);
        let mut ways: Vec<(usize, Vec3)> = twists
            .iter()
            .map(|(number, twist)| (*number, frame.turn(carried(twist, own))))
            .collect();
        for (k, number) in point.place.into_iter().flatten().enumerate() {
            let Some(mine) = only.iter().position(|&n| n == number) else {
                continue;
            };
            let way = scale(frame.column(k), self.scales[number] / self.size);
            match ways.iter_mut().find(|known| known.0 == mine) {
                Some(known) => known.1 = add(known.1, way),
                None => ways.push((mine, way)),
            }
        }
        NumberedPoint { joints: point.joints, at: frame.carry(at).map(|x| x / self.size), ways }
    }
}
