//! The smallest cone that holds directions: `cos(angle) = max over seats of min over directions of seat . direction`.
//!
//! As the smallest circle round points of a plane: two or three of the directions lie on the cone. Each direction
//! outside the cone so far must lie on that of all up to it.

use crate::rigid::{Vec3, add, cross, dot, norm, scale, sub, unit};

/// Rounding of a cosine, in generous measure: a direction so little outside is inside.
const ROUNDING: f64 = 1e-14;

/// An axis and the cosine of the half angle.
pub(super) type Cone = (Vec3, f64);

/// The smallest cone of unit vectors that lie within less than a quarter turn of one seat; else one of more than that.
pub(super) fn smallest(directions: &[Vec3]) -> Cone {
    let mut cone = (directions[0], 1.0);
    for (i, &p) in directions.iter().enumerate() {
        if outside(cone, p) {
            cone = through_one(&directions[..i], p);
        }
    }
    // a cone of a quarter turn or more is found by none of the steps
    let least = directions.iter().map(|&p| dot(cone.0, p)).fold(1.0, f64::min);
    (cone.0, least.min(cone.1))
}

/// The greatest angle from a seat that is given, as its cosine.
pub(super) fn from_seat(seat: Vec3, directions: &[Vec3]) -> f64 {
    directions.iter().map(|&p| dot(seat, p)).fold(1.0, f64::min)
}

fn outside((axis, cosine): Cone, p: Vec3) -> bool {
    dot(axis, p) < cosine - ROUNDING
}

fn through_one(before: &[Vec3], p: Vec3) -> Cone {
    let mut cone = (p, 1.0);
    for (j, &q) in before.iter().enumerate() {
        if outside(cone, q) {
            cone = through_two(&before[..j], p, q);
        }
    }
    cone
}

fn through_two(before: &[Vec3], p: Vec3, q: Vec3) -> Cone {
    let axis = unit(add(p, q));
    let mut cone = (axis, dot(axis, p));
    for &r in before {
        if outside(cone, r) {
            let normal = cross(sub(q, p), sub(r, p));
            let size = norm(normal);
            if size < ROUNDING {
                continue;
            }
            let axis = scale(normal, (1.0 / size).copysign(dot(normal, p)));
            cone = (axis, dot(axis, p));
        }
    }
    cone
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn no_seat_among_many_has_a_smaller_cone() {
        let mut random = Random(1);
        let mut vector = |spread: f64| -> Vec3 {
            let mut part = || 2.0 * random.uniform() - 1.0;
            unit([spread * part(), spread * part(), 1.0])
        };
        for count in [1, 2, 3, 5, 25] {
            for _ in 0..50 {
                let directions: Vec<Vec3> = (0..count).map(|_| vector(1.5)).collect();
                let (axis, cosine) = smallest(&directions);
                assert!((from_seat(axis, &directions) - cosine).abs() < 1e-13);
                let better = |size: f64, seat: Vec3| {
                    let tried = unit(add(axis, scale(sub(seat, axis), size)));
                    from_seat(tried, &directions) > cosine + 1e-12
                };
                for size in [1.0, 1e-2, 1e-5] {
                    assert!(!(0..200).any(|_| better(size, vector(2.0))), "{count} {size}");
                }
            }
        }
    }
}
