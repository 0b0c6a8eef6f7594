//! Planar dyads in closed form: two links, each joined to a known link and to the other by a hinge or a slide.
//!
//! Places in the plane are complex numbers; a link's pose is `x -> z x + t` with `|z| = 1`.
//!
//! Source: docs/theory_nets.md, (7).

use crate::rigid::{Pose, Vec3, cross, dot, most_perpendicular_axis, unit};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// A joint of a dyad, as drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pair {
    /// A hinge at a place.
    Hinge(Vec3),
    /// A slide along a direction.
    Slide(Vec3),
}

/// Two links in a plane across `normal`: the joint of the first with its known link, that between them, that of the second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dyad {
    /// Across the plane, of length 1.
    pub normal: Vec3,
    /// The joints.
    pub pairs: [Pair; 3],
}

/// Two circles, or a circle and a line, that miss each other by this part of the size touch: what is left of a square there is rounding.
const TOUCHING: f64 = 1e-14;

/// Two hinges that are nearer than this part of the links' lengths are in one place, and so are lines: rounding of the poses before.
const ONE_PLACE: f64 = 1e-9;

/// Poses of a curve of poses that are tried: what hangs at the dyad closes in some of them only.
const ON_CURVE: usize = 24;

/// Two directions whose sine is less are parallel.
const PARALLEL: f64 = 1e-12;

/// A pose in the plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flat {
    pub z: Complex64,
    pub t: Complex64,
}

impl Flat {
    /// The image of a place.
    pub fn carry(&self, x: Complex64) -> Complex64 {
        self.z * x + self.t
    }

    /// The pose with this turn that takes a place to another.
    pub fn through(z: Complex64, from: Complex64, to: Complex64) -> Self {
        Self { z, t: to - z * from }
    }
}

/// Directions x and y in the plane.
#[derive(Debug)]
pub(super) struct Plane {
    x: Vec3,
    y: Vec3,
    normal: Vec3,
}

impl Plane {
    /// Across a direction of length 1.
    pub fn across(normal: Vec3) -> Self {
        let x = unit(cross(normal, most_perpendicular_axis(normal)));
        Self { x, y: cross(normal, x), normal }
    }

    /// Its two directions, and that across it.
    pub fn axes(&self) -> [Vec3; 3] {
        [self.x, self.y, self.normal]
    }

    /// A place, or a direction, as a number.
    pub fn place(&self, v: Vec3) -> Complex64 {
        Complex64::new(dot(v, self.x), dot(v, self.y))
    }

    /// A number as a direction, or a place in the plane through the origin.
    pub fn direction(&self, z: Complex64) -> Vec3 {
        std::array::from_fn(|k| z.re * self.x[k] + z.im * self.y[k])
    }

    /// A pose of what moves in it.
    pub fn flat(&self, pose: &Pose) -> Flat {
        Flat { z: self.place(pose.turn(self.x)), t: self.place(pose.translation) }
    }

    /// The same in space.
    pub fn pose(&self, flat: &Flat) -> Pose {
        let [x, y, n] = [self.x, self.y, self.normal];
        let images = [
            std::array::from_fn::<f64, 3, _>(|k| flat.z.re * x[k] + flat.z.im * y[k]),
            std::array::from_fn(|k| flat.z.re * y[k] - flat.z.im * x[k]),
            n,
        ];
        Pose {
            rotation: std::array::from_fn(|i| {
                std::array::from_fn(|j| images[0][i] * x[j] + images[1][i] * y[j] + images[2][i] * n[j])
            }),
            translation: std::array::from_fn(|k| flat.t.re * x[k] + flat.t.im * y[k]),
        }
    }
}

impl Dyad {
    /// Poses all along a curve of poses at which the dyad closes: its outer hinges are in one place, about which both links turn; none where
    /// there is no such curve.
    pub fn on_curve(&self, known: [&Pose; 2]) -> Vec<[Pose; 2]> {
        let plane = Plane::across(self.normal);
        let [first, second] = known.map(|pose| plane.flat(pose));
        let [Pair::Hinge(p), inner, Pair::Hinge(q)] = self.pairs else {
            return Vec::new();
        };
        let (p, q) = (plane.place(p), plane.place(q));
        let (a, b) = (first.carry(p), second.carry(q));
        let z = first.z;
        let (w, off, size) = match inner {
            Pair::Hinge(c) => {
                let (one, two) = (plane.place(c) - p, plane.place(c) - q);
                let w = z * one / two;
                (w / w.norm(), one.norm() - two.norm(), one.norm() + two.norm())
            }
            Pair::Slide(s) => {
                let reach = q - p;
                (z, (reach * plane.place(s).conj()).im, reach.norm())
            }
        };
        let meet = (b - a).norm() < ONE_PLACE * size && off.abs() < ONE_PLACE * size && w.is_finite();
        let turns = (0..if meet { ON_CURVE } else { 0 }).map(|k| TAU * k as f64 / ON_CURVE as f64);
        turns
            .map(|angle| {
                let turn = Complex64::from_polar(1.0, angle);
                [Flat::through(z * turn, p, a), Flat::through(w * turn, q, b)].map(|flat| plane.pose(&flat))
            })
            .collect()
    }

    /// The isolated poses of both links, each way they can be put together, for those of the known links.
    pub fn poses(&self, known: [&Pose; 2]) -> Vec<[Pose; 2]> {
        let plane = Plane::across(self.normal);
        let [first, second] = known.map(|pose| plane.flat(pose));
        let hinge = |pair: Pair| match pair {
            Pair::Hinge(at) => Ok(plane.place(at)),
            Pair::Slide(along) => Err(plane.place(along)),
        };
        let turned = |poses: Vec<[Flat; 2]>| poses.into_iter().map(|[a, b]| [b, a]).collect();
        let poses = match self.pairs.map(hinge) {
            [Ok(p), Ok(c), Ok(q)] => three_hinges(&first, &second, p, c, q),
            [Ok(p), Ok(c), Err(s)] => hinge_and_slide(&first, &second, p, c, s),
            [Err(s), Ok(c), Ok(q)] => turned(hinge_and_slide(&second, &first, q, c, s)),
            [Ok(p), Err(s), Ok(q)] => slide_between(&first, &second, p, s, q),
            [Err(r), Ok(c), Err(s)] => two_slides(&first, &second, r, c, s),
            [Ok(p), Err(s), Err(r)] => slides_in_a_row(&first, &second, p, s, r),
            [Err(r), Err(s), Ok(q)] => turned(slides_in_a_row(&second, &first, q, s, r)),
            // three slides turn nothing: where they are is not determined
            [Err(_), Err(_), Err(_)] => Vec::new(),
        };
        poses
            .iter()
            .map(|both| both.map(|flat| plane.pose(&flat)))
            .collect()
    }
}

/// The two square roots of a number that may be below zero by rounding; none where it is below.
fn roots(square: f64, scale: f64) -> Vec<f64> {
    if square > TOUCHING * scale {
        let root = square.sqrt();
        vec![root, -root]
    } else if square > -TOUCHING * scale {
        vec![0.0]
    } else {
        Vec::new()
    }
}

fn three_hinges(first: &Flat, second: &Flat, p: Complex64, c: Complex64, q: Complex64) -> Vec<[Flat; 2]> {
    let (a, b) = (first.carry(p), second.carry(q));
    let (one, two) = ((c - p).norm(), (c - q).norm());
    let line = b - a;
    let distance = line.norm();
    if distance < ONE_PLACE * (one + two) || one == 0.0 || two == 0.0 {
        return Vec::new();
    }
    let along = (distance * distance + (one - two) * (one + two)) / (2.0 * distance);
    roots((one - along) * (one + along), one * one)
        .into_iter()
        .map(|across| {
            let arm = line / distance * Complex64::new(along, across);
            let place = a + arm;
            let z = arm / arm.norm() * one / (c - p);
            let back = place - b;
            let w = back / back.norm() * two / (c - q);
            [Flat::through(z, p, a), Flat::through(w, q, b)]
        })
        .collect()
}

/// A hinge on the first known link, one between, and a slide on the second.
fn hinge_and_slide(first: &Flat, second: &Flat, p: Complex64, c: Complex64, s: Complex64) -> Vec<[Flat; 2]> {
    let a = first.carry(p);
    let (start, direction) = (second.carry(c), second.z * s);
    let radius = (c - p).norm();
    if radius == 0.0 {
        return Vec::new();
    }
    let local = (a - start) * direction.conj();
    roots((radius - local.im) * (radius + local.im), radius * radius)
        .into_iter()
        .map(|half| {
            let shift = direction * (local.re + half);
            let arm = start + shift - a;
            let z = arm / arm.norm() * radius / (c - p);
            [Flat::through(z, p, a), Flat { z: second.z, t: second.t + shift }]
        })
        .collect()
}

/// Hinges on both known links, a slide between.
fn slide_between(first: &Flat, second: &Flat, p: Complex64, s: Complex64, q: Complex64) -> Vec<[Flat; 2]> {
    let (a, b) = (first.carry(p), second.carry(q));
    let line = b - a;
    // from one hinge to the other as drawn, slid by u along s, has the length of the line
    let local = (q - p) * s.conj();
    let size = line.norm_sqr().max(local.norm_sqr());
    if line.norm() <= ONE_PLACE * (q - p).norm() {
        return Vec::new();
    }
    roots(line.norm_sqr() - local.im * local.im, size)
        .into_iter()
        .filter_map(|along| {
            let reach = s * Complex64::new(along, local.im);
            let z = line / reach;
            let z = z / z.norm();
            z.is_finite()
                .then(|| [Flat::through(z, p, a), Flat::through(z, q, b)])
        })
        .collect()
}

/// Slides on both known links, a hinge between.
fn two_slides(first: &Flat, second: &Flat, r: Complex64, c: Complex64, s: Complex64) -> Vec<[Flat; 2]> {
    let (one, two) = (first.z * r, second.z * s);
    let off = second.carry(c) - first.carry(c);
    let sine = (one.conj() * two).im;
    if sine.abs() < PARALLEL {
        return Vec::new();
    }
    // one u - two v = off
    let u = (off.conj() * two).im / sine;
    let v = (off.conj() * one).im / sine;
    let moved = |known: &Flat, shift: Complex64| Flat { z: known.z, t: known.t + shift };
    vec![[moved(first, one * u), moved(second, two * v)]]
}

/// A hinge on the first known link, a slide along s between, a slide along r on the second.
fn slides_in_a_row(first: &Flat, second: &Flat, p: Complex64, s: Complex64, r: Complex64) -> Vec<[Flat; 2]> {
    let z = second.z;
    let near = Flat::through(z, p, first.carry(p));
    let (one, two) = (z * s, z * r);
    let sine = (one.conj() * two).im;
    if sine.abs() < PARALLEL {
        return Vec::new();
    }
    // the second link is slid from its known link by v along r, and from the first by u along s: near + one u = second + two v
    let off = second.t - near.t;
    let v = (off.conj() * one).im / sine;
    vec![[near, Flat { z, t: second.t + two * v }]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigid::{norm, sub};

    const Z: Vec3 = [0.0, 0.0, 1.0];

    fn moved(angle: f64, x: f64, y: f64) -> Pose {
        let (s, c) = angle.sin_cos();
        Pose {
            rotation: [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]],
            translation: [x, y, 0.0],
        }
    }

    /// How far a joint is from joining two links: its places apart and turned, or the slide off its line.
    fn off(pair: Pair, a: &Pose, b: &Pose) -> f64 {
        match pair {
            Pair::Hinge(at) => norm(sub(a.carry(at), b.carry(at))),
            Pair::Slide(along) => {
                let turned = norm(sub(a.turn(along), b.turn(along)));
                let d = sub(a.translation, b.translation);
                // a link that slides has the same turn, so its translation is along the slide
                turned + norm(cross(d, a.turn(along)))
            }
        }
    }

    #[test]
    fn every_kind_of_dyad_is_put_together_in_all_its_modes() {
        let places = [[0.2, -0.1, 0.0], [1.9, 1.3, 0.0], [3.4, -0.2, 0.0]];
        let along = [[-0.6, 0.8, 0.0], [0.96, 0.28, 0.0], [0.8, 0.6, 0.0]];
        let known = [moved(0.21, 0.1, -0.05), moved(-0.13, -0.15, 0.22)];
        for (kinds, count) in [
            ("RRR", 2),
            ("RRP", 2),
            ("PRR", 2),
            ("RPR", 2),
            ("PRP", 1),
            ("RPP", 1),
            ("PPR", 1),
        ] {
            let mut pairs = [Pair::Hinge([0.0; 3]); 3];
            for (k, kind) in kinds.chars().enumerate() {
                pairs[k] = if kind == 'R' {
                    Pair::Hinge(places[k])
                } else {
                    Pair::Slide(along[k])
                };
            }
            let dyad = Dyad { normal: Z, pairs };
            let found = dyad.poses([&known[0], &known[1]]);
            assert_eq!(found.len(), count, "{kinds}");
            for [a, b] in &found {
                let errors = [
                    off(pairs[0], &known[0], a),
                    off(pairs[1], a, b),
                    off(pairs[2], b, &known[1]),
                ];
                assert!(errors.iter().all(|e| *e < 1e-14), "{kinds} {errors:?}");
            }
        }
    }

    #[test]
    fn circles_that_touch_meet_once_and_those_apart_never() {
        let dyad = Dyad {
            normal: Z,
            pairs: [
                Pair::Hinge([0.0; 3]),
                Pair::Hinge([1.0, 0.0, 0.0]),
                Pair::Hinge([3.0, 0.0, 0.0]),
            ],
        };
        assert_eq!(dyad.poses([&Pose::STILL, &Pose::STILL]).len(), 1);
        assert_eq!(dyad.poses([&Pose::STILL, &moved(0.0, 0.1, 0.0)]).len(), 0);
        assert_eq!(dyad.poses([&Pose::STILL, &moved(0.0, -0.1, 0.0)]).len(), 2);
    }

    #[test]
    fn hinges_in_one_place_leave_a_curve_of_poses_where_both_links_are_as_long() {
        let middle = [1.0, 2.0, 0.0];
        let end = [0.0, 4.0, 0.0];
        for (inner, apart) in [
            (Pair::Hinge(middle), 0.0),
            (Pair::Slide([0.0, 1.0, 0.0]), 0.0),
            (Pair::Hinge(middle), 1e-3),
        ] {
            let dyad = Dyad { normal: Z, pairs: [Pair::Hinge([0.0; 3]), inner, Pair::Hinge(end)] };
            // the second known link brings its hinge to that of the first
            for rounding in [0.0, 1e-16, -1e-13] {
                let known = [Pose::STILL, moved(0.0, apart, -4.0 + rounding)];
                let found = dyad.on_curve([&known[0], &known[1]]);
                assert_eq!(found.len(), if apart == 0.0 { ON_CURVE } else { 0 });
                assert_eq!(
                    dyad.poses([&known[0], &known[1]]).len(),
                    if apart == 0.0 { 0 } else { 2 }
                );
                for [a, b] in found {
                    assert!(off(dyad.pairs[0], &known[0], &a) < 1e-12);
                    assert!(off(inner, &a, &b) < 1e-12 && off(dyad.pairs[2], &b, &known[1]) < 1e-12);
                }
            }
        }
    }

    #[test]
    fn the_plane_may_lie_any_way() {
        let normal = unit([0.3, -0.5, 0.8]);
        let plane = Plane::across(normal);
        let at = |x: f64, y: f64| std::array::from_fn(|k| x * plane.x[k] + y * plane.y[k] + 0.7 * normal[k]);
        let pairs = [
            Pair::Hinge(at(0.0, 0.0)),
            Pair::Hinge(at(1.0, 2.0)),
            Pair::Hinge(at(3.0, 0.5)),
        ];
        let dyad = Dyad { normal, pairs };
        let found = dyad.poses([&Pose::STILL, &Pose::STILL]);
        assert_eq!(found.len(), 2);
        for [a, b] in &found {
            assert!(off(pairs[1], a, b) < 1e-14);
            assert!(off(pairs[0], a, &Pose::STILL) < 1e-14);
        }
    }
}
