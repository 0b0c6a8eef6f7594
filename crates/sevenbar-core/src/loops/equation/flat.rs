//! The line of two balls whose distance one joint between them keeps, in a plane.

use crate::taylor::Taylor;

/// The balls' line in the plane across the second turn, as the joint between them has it.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Flat {
    /// Two arms: the first ball's, as it lies, and the second's at the joint's zero. The line is their difference.
    Arms([f64; 2], [f64; 2]),
    /// Where a slide begins, and where to it leads.
    Path([f64; 2], [f64; 2]),
}

impl Flat {
    /// The line along its direction at zero, and across.
    pub fn line<const N: usize>(&self, value: Taylor<N>) -> [Taylor<N>; 2] {
        match *self {
            Self::Arms(near, far) => {
                let (s, c) = value.sin_cos();
                [
                    c.scale(far[0]) - s.scale(far[1]) - Taylor::constant(near[0]),
                    s.scale(far[0]) + c.scale(far[1]) - Taylor::constant(near[1]),
                ]
            }
            Self::Path(start, way) => {
                std::array::from_fn(|k| Taylor::constant(start[k]) + value.scale(way[k]))
            }
        }
    }

    /// The angle of the line.
    pub fn angle(&self, value: f64) -> f64 {
        let [x, y] = self.line(Taylor::<1>::constant(value));
        y.value().atan2(x.value())
    }
}
