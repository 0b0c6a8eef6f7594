//! Rigid motions, and vectors whose coordinates are numbers or Taylor series.

use crate::taylor::Taylor;

/// A vector or a point in space.
pub type Vec3 = [f64; 3];

/// A moving vector with its derivatives.
pub type Vec3Taylor<const N: usize> = [Taylor<N>; 3];

/// `a . b`
pub fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `a x b`
pub fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// `a + b`
pub fn add(a: Vec3, b: Vec3) -> Vec3 {
    std::array::from_fn(|i| a[i] + b[i])
}

/// `a - b`
pub fn sub(a: Vec3, b: Vec3) -> Vec3 {
    std::array::from_fn(|i| a[i] - b[i])
}

/// `factor a`
pub fn scale(a: Vec3, factor: f64) -> Vec3 {
    a.map(|x| x * factor)
}

/// `|a|`, without overflow for the lengths of any linkage.
pub fn norm(a: Vec3) -> f64 {
    a[0].hypot(a[1]).hypot(a[2])
}

/// `a / |a|`
pub fn unit(a: Vec3) -> Vec3 {
    let length = norm(a);
    a.map(|x| x / length)
}

/// The coordinate axis that is most nearly perpendicular to `a`.
pub fn most_perpendicular_axis(a: Vec3) -> Vec3 {
    let least = (0..3).min_by(|&i, &j| a[i].abs().total_cmp(&a[j].abs()));
    std::array::from_fn(|i| if Some(i) == least { 1.0 } else { 0.0 })
}

/// `a . b` of moving vectors
pub fn dot_taylor<const N: usize>(a: Vec3Taylor<N>, b: Vec3Taylor<N>) -> Taylor<N> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `a x b` of moving vectors
pub fn cross_taylor<const N: usize>(a: Vec3Taylor<N>, b: Vec3Taylor<N>) -> Vec3Taylor<N> {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// `a factor` of a moving vector and a moving number
pub fn scale_taylor<const N: usize>(a: Vec3Taylor<N>, factor: Taylor<N>) -> Vec3Taylor<N> {
    a.map(|x| x * factor)
}

/// A vector that does not move.
pub fn still<const N: usize>(a: Vec3) -> Vec3Taylor<N> {
    a.map(Taylor::constant)
}

/// Below this cosine of the middle turn the two others act about one line, and none is named.
const TURNS_UNDEFINED: f64 = 1e-8;

/// The turns about z, y and x, one after the other, that make up a rotation whose entries are asked for by row and column.
///
/// The third is that which the first leaves to do: near a middle turn of a quarter both have few digits, and their product all.
pub fn turns_zyx<const N: usize>(entry: impl Fn(usize, usize) -> Taylor<N>) -> Option<[Taylor<N>; 3]> {
    let (x, y) = (entry(0, 0), entry(1, 0));
    let square = x * x + y * y;
    if square.value() < TURNS_UNDEFINED * TURNS_UNDEFINED {
        return None;
    }
    let level = square.sqrt();
    let turned_back = |j: usize| x * entry(1, j) - y * entry(0, j);
    Some([
        Taylor::atan2(y, x),
        Taylor::atan2(-entry(2, 0), level),
        Taylor::atan2(-turned_back(2), turned_back(1)),
    ])
}

/// A rigid motion `x -> rotation x + translation`; `rotation[i][j]` is row i, column j.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// The rotation matrix.
    pub rotation: [[f64; 3]; 3],
    /// The image of the origin.
    pub translation: Vec3,
}

impl Pose {
    /// The motion that leaves all where it is.
    pub const STILL: Self = Self::turning([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);

    /// A rotation about the origin.
    pub const fn turning(rotation: [[f64; 3]; 3]) -> Self {
        Self { rotation, translation: [0.0; 3] }
    }

    /// From a homogeneous matrix, row by row; its last row is not read.
    pub fn from_rows(m: [[f64; 4]; 4]) -> Self {
        Self {
            rotation: std::array::from_fn(|i| std::array::from_fn(|j| m[i][j])),
            translation: std::array::from_fn(|i| m[i][3]),
        }
    }

    /// The image of a direction.
    pub fn turn(&self, v: Vec3) -> Vec3 {
        self.rotation.map(|row| dot(row, v))
    }

    /// The direction whose image is `v`.
    pub fn turn_back(&self, v: Vec3) -> Vec3 {
        std::array::from_fn(|j| (0..3).map(|i| self.rotation[i][j] * v[i]).sum())
    }

    /// The image of a point.
    pub fn carry(&self, p: Vec3) -> Vec3 {
        add(self.turn(p), self.translation)
    }

    /// `self` after `other`: `T_ac = T_ab.then(T_bc)`.
    pub fn then(&self, other: &Self) -> Self {
        let columns: [Vec3; 3] = std::array::from_fn(|j| self.turn(other.column(j)));
        Self {
            rotation: std::array::from_fn(|i| std::array::from_fn(|j| columns[j][i])),
            translation: self.carry(other.translation),
        }
    }

    /// The inverse motion.
    pub fn inverse(&self) -> Self {
        let rotation = std::array::from_fn(|i| std::array::from_fn(|j| self.rotation[j][i]));
        let back = Self { rotation, translation: [0.0; 3] };
        Self { rotation, translation: scale(back.turn(self.translation), -1.0) }
    }

    /// Column `j` of the rotation: the image of the j-th coordinate axis.
    pub fn column(&self, j: usize) -> Vec3 {
        std::array::from_fn(|i| self.rotation[i][j])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_motion_after_its_inverse_rests() {
        let (s, c) = 0.4_f64.sin_cos();
        let pose = Pose {
            rotation: [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]],
            translation: [1.0, -2.0, 3.0],
        };
        let rest = pose.then(&pose.inverse());
        let point = rest.carry([0.3, 0.5, -0.7]);
        assert!(norm(sub(point, [0.3, 0.5, -0.7])) < 1e-15);
    }
}
