//! A chain with one of its unknowns as the input: where that unknown has a given complex value.

use crate::loops::equation::chain::Chain;
use crate::loops::equation::closed::Joint;
use crate::loops::equation::closure::{Solution, UNKNOWNS};
use crate::loops::modes::finder::{ModeFinder, Unknown};
use num_complex::Complex64;

/// The chain with the input first, balls as three turns, and no added joints.
pub(super) fn turned_out(finder: &ModeFinder) -> Chain {
    let mut joints = vec![Joint::Turn];
    let mut links = vec![finder.transforms[0]];
    for (i, unknown) in finder.unknowns.iter().enumerate() {
        let after = finder.transforms[i + 1];
        if matches!(unknown, Unknown::Added) {
            let last = links.len() - 1;
            links[last] = links[last].then(&after);
        } else {
            joints.push(if finder.slides[i] {
                Joint::Slide
            } else {
                Joint::Turn
            });
            links.push(after);
        }
    }
    Chain::new(joints, links)
}

/// The solutions with one unknown at a complex value, as the finder has them, and `e^(i tau)` of its input there.
pub(super) fn solutions_with(
    chain: &Chain,
    finder: &ModeFinder,
    zeros: &[Complex64; UNKNOWNS],
    (unknown, value): (usize, Complex64),
) -> Vec<(Solution, Complex64)> {
    let other = ModeFinder::new(chain, unknown + 1);
    let Some((solutions, shift)) = other.solutions_at(value) else {
        return Vec::new();
    };
    let mut out = Vec::with_capacity(solutions.len());
    'solutions: for solution in solutions {
        let mut values = [Complex64::ONE; 1 + UNKNOWNS];
        values[unknown + 1] = value;
        for (i, kind) in other.unknowns.iter().enumerate() {
            let z = if other.slides[i] {
                solution[i]
            } else {
                solution[i] / shift[i]
            };
            match *kind {
                Unknown::Column(c) => values[c] = z,
                _ if (z - 1.0).norm() > 1e-6 => continue 'solutions,
                _ => {}
            }
        }
        let x = std::array::from_fn(|i| {
            if finder.slides[i] {
                values[i + 1]
            } else {
                values[i + 1] * zeros[i]
            }
        });
        out.push((x, values[0]));
    }
    out
}
