//! What the joints of a net read where its links are, as series in time.
//!
//! Source: docs/theory_nets.md, (9).

use super::rows::On;
use super::series::Series;
use super::steps::Placement;
use crate::rigid::{Pose, turns_zyx};
use crate::taylor::Taylor;

/// A value and three derivatives, as coefficients of a series.
pub(super) const TERMS: usize = 4;

/// How a joint is read: the columns of its values, from the frame on the link before it to that on the link after it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reading {
    /// A turn about z.
    Turn,
    /// A slide along z.
    Slide,
    /// A turn about z and a slide along it.
    Cylinder,
    /// Turns about z of the one and of the other, z of which makes this angle with it.
    Cross(f64),
    /// Turns about z, y and x.
    Ball,
    /// Slides along x and y of the one, and a turn about z.
    Plane,
    /// A slide along y of the one, and a turn about z.
    Slot,
    /// A turn about z, and a slide along y of the other.
    SlotOnPin,
    /// Slides along x, y and z of the one, and turns about z, y and x: of a link that has no joint, against the ground.
    Anywhere,
}

impl Reading {
    /// Which of its columns are lengths.
    pub fn slides(self) -> &'static [bool] {
        match self {
            Self::Turn => &[false],
            Self::Slide => &[true],
            Self::Cylinder | Self::SlotOnPin => &[false, true],
            Self::Slot => &[true, false],
            Self::Cross(_) => &[false, false],
            Self::Ball => &[false, false, false],
            Self::Plane => &[true, true, false],
            Self::Anywhere => &[true, true, true, false, false, false],
        }
    }

    /// Whether its columns are read off its links even where they are followed, as those of all with three or more: a tree's three turns have
    /// two ways to one pose.
    pub(super) fn is_read_off(self) -> bool {
        self.slides().len() > 2
    }

    /// The values of its columns; none where they are not determined.
    fn values(self, entry: &dyn Fn(usize, usize) -> Taylor<TERMS>) -> Vec<Option<Taylor<TERMS>>> {
        let turn = || Some(Taylor::atan2(entry(1, 0), entry(0, 0)));
        let moved = |k: usize| Some(entry(k, 3));
        match self {
            Self::Turn => vec![turn()],
            Self::Slide => vec![moved(2)],
            Self::Cylinder => vec![turn(), moved(2)],
            // z of the link after it is Rz(q1) (0, -sin a, cos a), and z of the link before it in turn
            Self::Cross(angle) => {
                let side = angle.sin().signum();
                let first = Taylor::atan2(entry(0, 2).scale(side), entry(1, 2).scale(-side));
                let second = Taylor::atan2(entry(2, 0).scale(side), entry(2, 1).scale(side));
                vec![Some(first), Some(second)]
            }
            Self::Ball => any_turns(entry).to_vec(),
            Self::Anywhere => [0, 1, 2].map(moved).into_iter().chain(any_turns(entry)).collect(),
            Self::Plane => vec![moved(0), moved(1), turn()],
            Self::Slot => vec![moved(1), turn()],
            Self::SlotOnPin => {
                let along = entry(0, 1) * entry(0, 3) + entry(1, 1) * entry(1, 3);
                vec![turn(), Some(along)]
            }
        }
    }
}

/// Turns about z, y and x; none where they have no direction.
fn any_turns(entry: &dyn Fn(usize, usize) -> Taylor<TERMS>) -> [Option<Taylor<TERMS>>; 3] {
    turns_zyx(entry).map_or([None; 3], |turns| turns.map(Some))
}

/// A joint of a net.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NetJoint {
    /// How it is read.
    pub reading: Reading,
    /// The links before and after it.
    pub on: [On; 2],
    /// Its frames on them where it reads 0, of links as drawn.
    pub frames: [Pose; 2],
}

impl NetJoint {
    /// The values of its columns where its two links are, lengths relative to the size as the links' places are.
    pub(super) fn values(
        &self,
        size: f64,
        links: [&Placement<Series<f64, TERMS>>; 2],
    ) -> Vec<Option<Taylor<TERMS>>> {
        // columns x, y, z and the place of the frame on each link
        let frame = |side: usize| {
            let (link, frame) = (links[side], self.frames[side]);
            let small = frame.translation.map(|x| x / size);
            let [x, y, z] = [0, 1, 2].map(|j| link.turn(&frame.column(j)));
            [x, y, z, link.carry(&small)].map(|v| v.map(|s| Taylor(s.0)))
        };
        let (before, after) = (frame(0), frame(1));
        let entry = |i: usize, j: usize| {
            let seen = |k: usize| {
                let x = if j == 3 {
                    after[3][k] - before[3][k]
                } else {
                    after[j][k]
                };
                before[i][k] * x
            };
            seen(0) + seen(1) + seen(2)
        };
        self.reading.values(&entry)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigid::Vec3;

    fn about(axis: usize, angle: f64) -> Pose {
        let (s, c) = angle.sin_cos();
        let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut pose = Pose::STILL;
        pose.rotation[a][a] = c;
        pose.rotation[b][b] = c;
        pose.rotation[a][b] = -s;
        pose.rotation[b][a] = s;
        pose
    }

    fn along(shift: Vec3) -> Pose {
        Pose { translation: shift, ..Pose::STILL }
    }

    fn still(pose: &Pose) -> Placement<Series<f64, TERMS>> {
        let number = |x| Series([x, 0.0, 0.0, 0.0]);
        Placement {
            rotation: pose.rotation.map(|row| row.map(number)),
            translation: pose.translation.map(number),
        }
    }

    #[test]
    fn a_joint_reads_what_it_was_moved_by() {
        let tilt = 1.1;
        let cases: [(Reading, Pose, &[f64]); 9] = [
            (Reading::Turn, about(2, 0.3), &[0.3]),
            (Reading::Slide, along([0.0, 0.0, 0.4]), &[0.4]),
            (
                Reading::Cylinder,
                about(2, 0.3).then(&along([0.0, 0.0, 0.4])),
                &[0.3, 0.4],
            ),
            (
                Reading::Cross(tilt),
                about(2, 0.3).then(&about(0, tilt)).then(&about(2, -0.8)),
                &[0.3, -0.8],
            ),
            (
                Reading::Ball,
                about(2, 0.3).then(&about(1, -0.5)).then(&about(0, 0.9)),
                &[0.3, -0.5, 0.9],
            ),
            (
                Reading::Plane,
                along([0.2, 0.4, 0.0]).then(&about(2, 0.3)),
                &[0.2, 0.4, 0.3],
            ),
            (
                Reading::Slot,
                along([0.0, 0.4, 0.0]).then(&about(2, 0.3)),
                &[0.4, 0.3],
            ),
            (
                Reading::Anywhere,
                along([0.2, 0.4, -0.6])
                    .then(&about(2, 0.3))
                    .then(&about(1, -0.5))
                    .then(&about(0, 0.9)),
                &[0.2, 0.4, -0.6, 0.3, -0.5, 0.9],
            ),
            (
                Reading::SlotOnPin,
                about(2, 0.3).then(&along([0.0, 0.4, 0.0])),
                &[0.3, 0.4],
            ),
        ];
        let frame = about(1, 0.7).then(&along([1.0, 2.0, 3.0]));
        for (reading, moved, want) in cases {
            assert_eq!(reading.slides().len(), want.len());
            let joint = NetJoint { reading, on: [None; 2], frames: [frame; 2] };
            // the link after it is moved as the joint is
            let link = frame.then(&moved).then(&frame.inverse());
            let values = joint.values(1.0, [&still(&Pose::STILL), &still(&link)]);
            for (value, want) in values.iter().zip(want) {
                assert!((value.unwrap().value() - want).abs() < 1e-14, "{reading:?}");
            }
        }
    }
}
