//! Pseudorandom numbers, the same on every machine.

use num_complex::Complex64;

/// SplitMix64 by Steele, Lea and Flood, begun at a seed.
pub(crate) struct Random(pub u64);

impl Random {
    /// Evenly in [0, 1).
    pub fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 * 2.0_f64.powi(-53)
    }

    /// A complex number of size 0.7 to 1.4, in any direction.
    pub fn phase(&mut self) -> Complex64 {
        Complex64::from_polar(0.7 + 0.7 * self.uniform(), std::f64::consts::TAU * self.uniform())
    }

    /// A complex number of size 0.2 to 0.8, in any direction.
    pub fn number(&mut self) -> Complex64 {
        Complex64::from_polar(0.2 + 0.6 * self.uniform(), std::f64::consts::TAU * self.uniform())
    }
}
