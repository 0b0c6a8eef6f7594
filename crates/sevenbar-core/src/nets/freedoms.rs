//! The freedoms of a net: the rank of `A` at a general pose, and the rows that repeat others, `W^T A = 0`.
//!
//! The drawn pose serves where it is general. Moves along random free directions, closed again, lead to other poses; the greatest rank counts.
//!
//! Source: docs/theory_nets.md, (5).

use super::net::{NO_RANK, Net};
use super::rows::Row;
use crate::loops::singular_values;
use crate::random::Random;
use std::f64::consts::PI;

/// Moves from the drawn pose, each as long [rad, or relative to the size] as all columns together, and how often a move is halved that does not
/// close again.
const MOVES: usize = 6;
const MOVE: f64 = 0.15;
const HALVED: usize = 4;

/// Places anywhere from which other poses are sought where the net seems not to move with one freedom.
const ANYWHERE: usize = 40;

/// A row repeats others where less than this part of it is square to them.
const REPEATS: f64 = 1e-6;

/// Numbers of the random moves, the same in each run.
const SEED: u64 = 0x5EED;

/// How freely a net moves near the pose that is drawn.
#[derive(Clone, Debug)]
pub struct Freedoms {
    /// The greatest rank of `A` that was found.
    pub rank: usize,
    /// A basis of the rows' combinations that no column moves there, of unit length.
    pub repeated: Vec<Vec<f64>>,
    /// How each column moves in each of the motions that are free there to first order, of unit length.
    pub free: Vec<Vec<f64>>,
    /// Rows none of which repeats others, as many as the rank.
    pub independent: Vec<usize>,
}

/// The freedoms of a net about the pose that is drawn.
pub fn freedoms(net: &Net) -> Freedoms {
    let drawn = net.drawn();
    let mut best = Moving::at(net, drawn.clone());
    let mut random = Random(SEED);
    let (mut here, mut free) = (drawn.clone(), best.free.clone());
    for _ in 0..MOVES {
        if free.is_empty() {
            break;
        }
        let Some(next) = moved(net, &here, &free, &mut random) else {
            continue;
        };
        let there = Moving::at(net, next);
        free.clone_from(&there.free);
        here.clone_from(&there.pose);
        if there.rank > best.rank {
            best = there;
        }
    }
    // a net that is drawn at a change point may stay at such poses: others from anywhere
    for _ in 0..ANYWHERE {
        if best.free.len() == 1 {
            break;
        }
        let rough: Vec<f64> = drawn
            .iter()
            .map(|x| x + PI * (2.0 * random.uniform() - 1.0))
            .collect();
        if let Some(pose) = net.closed(&rough) {
            let there = Moving::at(net, pose);
            if there.rank > best.rank {
                best = there;
            }
        }
    }
    best.freedoms(net)
}

/// How freely the net moves at a pose.
struct Moving {
    pose: Vec<f64>,
    rank: usize,
    free: Vec<Vec<f64>>,
}

impl Moving {
    fn at(net: &Net, pose: Vec<f64>) -> Self {
        let (values, vectors) = singular_values(&net.closure(&pose).1);
        let greatest = values.first().copied().unwrap_or(0.0);
        let rank = values
            .iter()
            .filter(|&&v| v > NO_RANK * greatest && v > 0.0)
            .count();
        Self { pose, rank, free: vectors[rank..].to_vec() }
    }

    /// The same with the rows that repeat others.
    fn freedoms(self, net: &Net) -> Freedoms {
        let Self { pose, rank, free } = self;
        let (errors, columns) = net.closure(&pose);
        // of as many columns as there are rows, so that a row that nothing moves has a direction of its own
        let rows: Vec<Vec<f64>> = (0..errors.len())
            .map(|r| {
                let mut row: Vec<f64> = columns.iter().map(|c| c[r]).collect();
                row.resize(row.len().max(errors.len()), 0.0);
                row
            })
            .collect();
        let repeated = singular_values(&rows).1.split_off(rank.min(rows.len()));
        let independent = independent(net, &columns, rank);
        Freedoms { rank, repeated, free, independent }
    }
}

/// The rows that repeat no others, as many as a rank.
fn independent(net: &Net, columns: &[Vec<f64>], rank: usize) -> Vec<usize> {
    // angles first: of joints about one point they hold it all, and places, which then repeat them, do not at every pose
    let mut order: Vec<usize> = (0..net.rows.len()).collect();
    order.sort_by_key(|&r| !matches!(net.rows[r], Row::Angle { .. }));
    let mut repeats = REPEATS;
    loop {
        let mut selected = apart(columns, &order, rank, repeats);
        // where rows nearly repeat others, what is left of them counts
        if selected.len() == rank || repeats < f64::EPSILON {
            selected.sort_unstable();
            return selected;
        }
        repeats *= 0.1;
    }
}

/// Of rows in an order, up to a rank, those of which more than this part is square to all before them (Gram and Schmidt).
fn apart(columns: &[Vec<f64>], order: &[usize], rank: usize, repeats: f64) -> Vec<usize> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let (mut selected, mut square): (Vec<usize>, Vec<Vec<f64>>) = (Vec::new(), Vec::new());
    for &r in order {
        let row: Vec<f64> = columns.iter().map(|c| c[r]).collect();
        let mut rest = row.clone();
        // twice, for what rounding leaves of the first time
        for _ in 0..2 {
            for unit in &square {
                let along = dot(&rest, unit);
                for (x, u) in rest.iter_mut().zip(unit) {
                    *x -= along * u;
                }
            }
        }
        let (length, whole) = (dot(&rest, &rest).sqrt(), dot(&row, &row).sqrt());
        if selected.len() < rank && length > repeats * whole && whole > NO_RANK {
            square.push(rest.iter().map(|x| x / length).collect());
            selected.push(r);
        }
    }
    selected
}

/// Another closed pose, a random move along free directions away; `None` where none of its lengths closes.
fn moved(net: &Net, from: &[f64], free: &[Vec<f64>], random: &mut Random) -> Option<Vec<f64>> {
    let parts: Vec<f64> = free.iter().map(|_| 2.0 * random.uniform() - 1.0).collect();
    let size = parts.iter().map(|x| x * x).sum::<f64>().sqrt();
    let mut length = MOVE;
    for _ in 0..=HALVED {
        let along = |c: usize| free.iter().zip(&parts).map(|(v, p)| v[c] * p).sum::<f64>() * length / size;
        let rough: Vec<f64> = from.iter().enumerate().map(|(c, x)| x + along(c)).collect();
        if let Some(pose) = net.closed(&rough) {
            return Some(pose);
        }
        length *= 0.5;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::super::rows::Row;
    use super::super::steps::{Move, Step};
    use super::*;
    use crate::rigid::{Vec3, norm, sub};

    const Z: Vec3 = [0.0, 0.0, 1.0];

    fn pin(parent: Option<usize>, x: f64, y: f64) -> Step {
        Step { parent, moves: Move::Turn, origin: [x, y, 0.0], axis: Z, reads: 0.0 }
    }

    /// The two rows of a pin of a planar cycle.
    fn closing(a: usize, b: Option<usize>, x: f64, y: f64) -> [Row; 2] {
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(|v| Row::Along { on: [Some(a), b], at: [x, y, 0.0], v })
    }

    fn rod(a: usize, b: Option<usize>, from: Vec3, to: Vec3) -> Row {
        Row::Length { on: [Some(a), b], at: [from, to], length: norm(sub(from, to)) }
    }

    #[test]
    fn a_planar_four_bar_has_one_freedom_as_pins_and_as_a_rod() {
        let steps = vec![pin(None, 0.0, 0.0), pin(Some(0), 0.3, 1.0), pin(None, 4.0, 0.0)];
        let rows = closing(1, Some(2), 4.5, 2.0).to_vec();
        let pins = freedoms(&Net { steps, rows, facing: Vec::new(), balls: Vec::new(), size: 8.0 });
        assert_eq!((pins.rank, pins.free.len(), pins.repeated.len()), (2, 1, 0));
        let steps = vec![pin(None, 0.0, 0.0), pin(None, 4.0, 0.0)];
        let rows = vec![rod(0, Some(1), [0.3, 1.0, 0.0], [4.5, 2.0, 0.0])];
        assert_eq!(
            freedoms(&Net { steps, rows, facing: Vec::new(), balls: Vec::new(), size: 8.0 }).rank,
            1
        );
    }

    #[test]
    fn three_equal_cranks_repeat_one_constraint() {
        // a coupler on three parallel cranks
        let steps = vec![
            pin(None, 0.0, 0.0),
            pin(Some(0), 0.6, 1.0),
            pin(None, 2.0, 0.0),
            pin(None, 5.0, 0.0),
        ];
        let mut rows = closing(1, Some(2), 2.6, 1.0).to_vec();
        rows.extend(closing(1, Some(3), 5.6, 1.0));
        let found = freedoms(&Net { steps, rows, facing: Vec::new(), balls: Vec::new(), size: 8.0 });
        assert_eq!((found.rank, found.free.len(), found.repeated.len()), (3, 1, 1));
    }

    #[test]
    fn the_gradient_of_every_row_is_its_difference() {
        let tilted = {
            let n = norm([1.0, 2.0, -0.5]);
            [1.0 / n, 2.0 / n, -0.5 / n]
        };
        let steps = vec![
            pin(None, 0.1, -0.2),
            Step {
                parent: Some(0),
                moves: Move::Screw(0.4),
                origin: [1.0, 0.3, 0.2],
                axis: tilted,
                reads: 0.0,
            },
            Step {
                parent: None,
                moves: Move::Slide,
                origin: [0.0; 3],
                axis: tilted,
                reads: 0.0,
            },
            Step {
                parent: Some(2),
                moves: Move::Turn,
                origin: [0.5, 2.0, 1.0],
                axis: [1.0, 0.0, 0.0],
                reads: 0.0,
            },
        ];
        let on = [Some(1), Some(3)];
        let rows = vec![
            Row::Length { on, at: [[1.0, 2.0, 0.5], [0.0, 1.0, 2.0]], length: 2.0 },
            Row::Along { on, at: [0.7, 0.2, -1.0], v: tilted },
            Row::Angle { on, u: Z, v: tilted, cosine: 0.3 },
        ];
        let net = Net { steps, rows, facing: Vec::new(), balls: Vec::new(), size: 3.0 };
        let pose = [0.3, -0.7, 0.2, 1.1];
        let (_, columns) = net.closure(&pose);
        let h = 1e-5;
        for c in 0..4 {
            let moved = |by: f64| {
                let mut at = pose;
                at[c] += by;
                net.closure(&at).0
            };
            let (up, down) = (moved(h), moved(-h));
            for r in 0..3 {
                let slope = (up[r] - down[r]) / (2.0 * h);
                assert!((slope - columns[c][r]).abs() < 1e-9, "{c} {r}");
            }
        }
    }
}
