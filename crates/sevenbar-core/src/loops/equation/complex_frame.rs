//! Rigid motions with complex entries, and their Euler angles.

use crate::rigid::Pose;
use num_complex::Complex64;

/// A rigid motion with complex entries: the images of the axes, and of the origin.
#[derive(Clone, Copy)]
pub(crate) struct Frame {
    pub axes: [[Complex64; 3]; 3],
    pub origin: [Complex64; 3],
}

/// `Rz(before) T(shift) Rx(twist) Rz(after)`, each angle `t` as `e^(i t)`.
#[derive(Clone, Copy)]
pub(crate) struct NormalForm {
    pub before: Complex64,
    pub shift: [Complex64; 3],
    pub twist: Complex64,
    pub after: Complex64,
}

/// Below this sine of its twist a transform counts as a turn about z; the rest is rounding.
pub(crate) const NO_TWIST: f64 = 1e-13;

impl NormalForm {
    /// The same motion by turns that differ by half ones, if these are nearer to those of another.
    pub fn near(self, other: &Self) -> Self {
        if (self.before - other.before).norm() <= (self.before + other.before).norm() {
            return self;
        }
        let [x, y, z] = self.shift;
        Self {
            before: -self.before,
            shift: [-x, -y, z],
            twist: self.twist.inv(),
            after: -self.after,
        }
    }
}

fn cosine_sine(z: Complex64) -> (Complex64, Complex64) {
    let inverse = z.inv();
    ((z + inverse) * 0.5, (z - inverse) * Complex64::new(0.0, -0.5))
}

impl Frame {
    pub const IDENTITY: Self = {
        let (o, l) = (Complex64::ZERO, Complex64::ONE);
        Self { axes: [[l, o, o], [o, l, o], [o, o, l]], origin: [o, o, o] }
    };

    fn turned(mut self, i: usize, j: usize, z: Complex64) -> Self {
        let (c, s) = cosine_sine(z);
        for k in 0..3 {
            let (x, y) = (self.axes[i][k], self.axes[j][k]);
            self.axes[i][k] = x * c + y * s;
            self.axes[j][k] = y * c - x * s;
        }
        self
    }

    pub fn from_pose(pose: &Pose) -> Self {
        Self {
            axes: std::array::from_fn(|j| pose.column(j).map(Complex64::from)),
            origin: pose.translation.map(Complex64::from),
        }
    }

    pub fn turned_z(self, z: Complex64) -> Self {
        self.turned(0, 1, z)
    }

    pub fn turned_x(self, z: Complex64) -> Self {
        self.turned(1, 2, z)
    }

    pub fn shifted(mut self, by: [Complex64; 3]) -> Self {
        for k in 0..3 {
            for (j, step) in by.iter().enumerate() {
                self.origin[k] += self.axes[j][k] * step;
            }
        }
        self
    }

    pub fn inverse(&self) -> Self {
        let axes = std::array::from_fn(|j| std::array::from_fn(|k| self.axes[k][j]));
        let origin = std::array::from_fn(|j| {
            -(0..3)
                .map(|k| self.axes[j][k] * self.origin[k])
                .sum::<Complex64>()
        });
        Self { axes, origin }
    }

    /// The Euler angles z, x, z of the turn, and the shift as seen after the first.
    pub fn normal_form(&self) -> NormalForm {
        let i = Complex64::I;
        let [ex, ey, ez] = self.axes;
        // the third column is (sin before, -cos before, 0) sin twist + cos twist z
        let square = ez[0] * ez[0] + ez[1] * ez[1];
        let sine = square.sqrt();
        let before = if sine.norm() < NO_TWIST {
            Complex64::ONE
        } else {
            (-ez[1] + i * ez[0]) / sine
        };
        let (c, s) = cosine_sine(before);
        let across = |v: [Complex64; 3]| (v[0] * c + v[1] * s, v[1] * c - v[0] * s);
        let (px, py) = across(self.origin);
        let after = across(ex).0 - i * across(ey).0;
        NormalForm {
            before,
            shift: [px, py, self.origin[2]],
            twist: ez[2] - i * across(ez).1,
            after,
        }
    }
}
