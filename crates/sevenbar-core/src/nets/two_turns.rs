//! Two turns through one place, one after the other, that take a vector to another as long, of numbers of any kind.
//!
//! Source: docs/theory_nets.md, (22).

use crate::loops::equation::rotations::dot3;
use crate::number::Number;
use crate::rigid::{Vec3, cross, dot};
use std::array::from_fn;

/// Where the vector is between the turns: as far along the second axis as before, and along the first as after.
pub(super) struct TwoTurns<N> {
    axes: [[N; 3]; 3],
    along: [N; 2],
    /// The square of how far it is across both axes: below zero where they do not lead there.
    pub square: N,
    /// The square of the sine of the angle between the axes.
    pub sine_square: f64,
}

impl<N: Number> TwoTurns<N> {
    /// About the first axis after the second.
    pub fn of([first, second]: [Vec3; 2], from: &[N; 3], to: &[N; 3]) -> Self {
        let across = cross(first, second);
        let (cosine, sine_square) = (N::splat(dot(first, second)), dot(across, across));
        let by = N::splat(sine_square);
        let axes = [first, second, across].map(|axis| axis.map(N::splat));
        let (along_first, along_second) = (dot3(&axes[0], to), dot3(&axes[1], from));
        let a = (along_first - cosine * along_second) / by;
        let b = (along_second - cosine * along_first) / by;
        let square = (dot3(from, from) - a * along_first - b * along_second) / by;
        Self { axes, along: [a, b], square, sine_square }
    }

    /// The vector between the turns, so far across both axes, by the length of their cross product.
    pub fn between(&self, height: N) -> [N; 3] {
        let ([first, second, across], [a, b]) = (&self.axes, self.along);
        from_fn(|i| a * first[i] + b * second[i] + height * across[i])
    }
}
