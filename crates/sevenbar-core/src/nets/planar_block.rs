//! Planar links that are solved together and are no dyad: as a member of their family, and their poses from its solutions.
//!
//! Source: docs/theory_nets.md, (11) and (12).

use super::before::Before;
use super::dyads::{Flat, Plane};
use super::in_plane::{Complex, InPlane};
use super::monodromy::{Ends, REAL};
use super::planar_family::{Chord, Closes, Pair, PlanarFamily, Term};
use super::rows::On;
use super::steps::Placement;
use crate::loops::equation::closure::Solution;
use crate::loops::modes::completeness::Completeness;
use crate::rigid::{Pose, Vec3, scale};
use num_complex::Complex64;

/// A joint of a block, or a rod, as drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BlockJoint {
    /// A hinge at a place.
    Hinge(Vec3),
    /// A slide at a place along a direction.
    Slide(Vec3, Vec3),
    /// A pin of the first link at a place, in a slot of the second along a direction.
    Slot(Vec3, Vec3),
    /// A rod from a place on the one link to one on the other.
    Rod([Vec3; 2]),
}

/// Links in a plane across `normal`: the steps that carry them, their joints, and the steps that carry the two links of each.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanarBlock {
    /// Across the plane, of length 1.
    pub normal: Vec3,
    /// The links.
    pub links: Vec<usize>,
    /// The joints.
    pub joints: Vec<(BlockJoint, [On; 2])>,
}

/// All ways to put a block together, and how complete they are.
pub(super) struct Together {
    /// The poses of its links.
    pub poses: Vec<Vec<Pose>>,
    /// "searched" where some paths end neither at an isolated solution nor at infinity.
    pub completeness: Completeness,
}

impl PlanarBlock {
    /// All ways to put it together; `None` where it has more unknowns than are followed.
    pub(super) fn together(&self, before: &Before) -> Option<Together> {
        let layout = Layout::of(self, before)?;
        let starts = layout.family.starts();
        let Ends { regular, left_over } = starts.ends(&layout.family, &layout.member);
        let poses = regular.iter().filter_map(|x| layout.poses(x)).collect();
        Some(Together { poses, completeness: starts.completeness(left_over) })
    }

    /// How it is a member of its family; `None` where it has more unknowns than are followed.
    pub(super) fn layout(&self, before: &Before) -> Option<Layout> {
        Layout::of(self, before)
    }
}

/// An end of a joint: on a link of the block, which another is welded to, or on one that is known.
#[derive(Clone, Copy)]
enum End {
    Body(usize, Pose),
    Known(Flat),
}

/// How a link of a block turns: which unknown, and the turn by which it is ahead of it.
type Turning = (Option<usize>, Complex64);

/// A block as a member of its family.
pub(super) struct Layout {
    plane: Plane,
    size: f64,
    pub family: PlanarFamily,
    member: Vec<Pair>,
    turning: Vec<Turning>,
    /// For each link a place on it, in its own numbers, and the terms that lead there.
    origins: Vec<(Complex64, Vec<Term>)>,
}

/// A layout under way.
struct Builder<'a> {
    block: &'a PlanarBlock,
    plane: Plane,
    size: f64,
    ends: Vec<[End; 2]>,
    turning: Vec<Turning>,
    origins: Vec<Option<(Complex64, Vec<Term>)>>,
    family: PlanarFamily,
    member: Vec<Pair>,
}

impl Layout {
    /// The layout of a block; `None` where it is not square, or has more unknowns than are followed.
    fn of(block: &PlanarBlock, before: &Before) -> Option<Self> {
        let plane = Plane::across(block.normal);
        let end = |on: On| {
            let offset = |(k, &link): (usize, &usize)| Some((k, before.offset(on, link)?));
            if let Some((k, offset)) = block.links.iter().enumerate().find_map(offset) {
                return End::Body(k, offset);
            }
            let pose = on.map_or(Pose::STILL, |s| before.poses[s]);
            End::Known(plane.flat(&Pose { translation: scale(pose.translation, 1.0 / before.size), ..pose }))
        };
        let mut builder = Builder {
            ends: block.joints.iter().map(|(_, on)| on.map(end)).collect(),
            turning: Vec::new(),
            origins: vec![None; block.links.len()],
            family: PlanarFamily {
                turns: 0,
                slides: Vec::new(),
                vectors: 0,
                at_rest: Vec::new(),
                chords: Vec::new(),
            },
            member: Vec::new(),
            block,
            size: before.size,
            plane,
        };
        builder.turn();
        let chords = builder.grow();
        for joint in chords {
            builder.close(joint);
        }
        builder.family.vectors = builder.member.len();
        let origins = builder.origins.into_iter().collect::<Option<Vec<_>>>()?;
        builder.family.is_square().then_some(Self {
            plane: builder.plane,
            size: builder.size,
            family: builder.family,
            member: builder.member,
            turning: builder.turning,
            origins,
        })
    }

    /// The poses of the links at a solution; `None` where it is not real.
    fn poses(&self, x: &Solution) -> Option<Vec<Pose>> {
        let unknowns = self.family.unknowns();
        let real = |i: usize| {
            if i < self.family.turns {
                (x[i].norm() - 1.0).abs() < REAL
            } else {
                x[i].im.abs() < REAL * (1.0 + x[i].re.abs())
            }
        };
        if !(0..unknowns).all(real) {
            return None;
        }
        let mut on_circle = *x;
        for i in 0..unknowns {
            on_circle[i] = if i < self.family.turns {
                x[i] / x[i].norm()
            } else {
                x[i].re.into()
            };
        }
        let pose = |((turn, ahead), (origin, terms)): (&Turning, &(Complex64, Vec<Term>))| {
            let z = turn.map_or(Complex64::ONE, |g| on_circle[g]) * ahead;
            let [place, _] = self.family.sum(terms, &self.member, &on_circle);
            let mut flat = Flat::through(z, *origin, place);
            flat.t *= self.size;
            self.plane.pose(&flat)
        };
        Some(self.turning.iter().zip(&self.origins).map(pose).collect())
    }

    /// The numbers of the member, and after them for each link the turn by which it is ahead, and the place on it.
    pub(super) fn numbers(&self) -> Vec<Pair> {
        let pair = |z: Complex64| [z, z.conj()];
        let own = self.turning.iter().zip(&self.origins);
        let placing = own.flat_map(|((_, ahead), (origin, _))| [pair(*ahead), pair(*origin)]);
        self.member.iter().copied().chain(placing).collect()
    }

    /// The poses of the links at a solution, complex ones too, by a member's numbers.
    pub(super) fn complex_poses(&self, numbers: &[Pair], x: &Solution) -> Vec<Placement<Complex64>> {
        let (member, placing) = numbers.split_at(self.member.len());
        let vector = |[plus, minus]: Pair| Complex {
            re: 0.5 * (plus + minus),
            im: Complex64::new(0.0, -0.5) * (plus - minus),
        };
        let pose = |(k, both): (usize, &[Pair])| {
            let turn = self.turning[k].0.map_or(Complex64::ONE, |g| x[g]);
            let (ahead, origin) = (both[0], both[1]);
            let z = [ahead[0] * turn, ahead[1] / turn];
            let place = self.family.sum(&self.origins[k].1, member, x);
            let t = [place[0] - z[0] * origin[0], place[1] - z[1] * origin[1]];
            InPlane { z: vector(z), t: vector(t) }.in_space(&self.plane, self.size)
        };
        placing.chunks_exact(2).enumerate().map(pose).collect()
    }
}

impl Builder<'_> {
    /// Finds which links turn alike: those that slide along each other, or along one that is known.
    fn turn(&mut self) {
        let mut turning: Vec<Option<Turning>> = vec![None; self.block.links.len()];
        let slides: Vec<[End; 2]> = self
            .block
            .joints
            .iter()
            .zip(&self.ends)
            .filter(|((joint, _), _)| matches!(joint, BlockJoint::Slide(..)))
            .map(|(_, ends)| *ends)
            .collect();
        for next in 0..=turning.len() {
            let mut more = true;
            while more {
                more = false;
                for ends in &slides {
                    for [a, b] in [*ends, [ends[1], ends[0]]] {
                        let End::Body(k, offset) = b else { continue };
                        let known = match a {
                            End::Known(flat) => Some((None, flat.z)),
                            End::Body(j, offset) => {
                                turning[j].map(|(g, ahead)| (g, ahead * self.plane.flat(&offset).z))
                            }
                        };
                        if let (None, Some((g, z))) = (turning[k], known) {
                            turning[k] = Some((g, z / self.plane.flat(&offset).z));
                            more = true;
                        }
                    }
                }
            }
            if next < turning.len() && turning[next].is_none() {
                turning[next] = Some((Some(self.family.turns), Complex64::ONE));
                self.family.turns += 1;
            }
        }
        self.turning = turning
            .into_iter()
            .map(|t| t.unwrap_or((None, Complex64::ONE)))
            .collect();
    }

    /// A place on the link at an end of a joint, in the link's own numbers.
    fn place(&self, end: &End, at: Vec3) -> Complex64 {
        let small = scale(at, 1.0 / self.size);
        match end {
            End::Known(_) => self.plane.place(small),
            End::Body(_, offset) => {
                let offset = Pose { translation: scale(offset.translation, 1.0 / self.size), ..*offset };
                self.plane.place(offset.carry(small))
            }
        }
    }

    /// A direction likewise, with the turn that carries it.
    fn direction(&self, end: &End, along: Vec3) -> (Complex64, Option<usize>) {
        match end {
            End::Known(flat) => (flat.z * self.plane.place(along), None),
            End::Body(k, offset) => {
                let (turn, ahead) = self.turning[*k];
                (ahead * self.plane.place(offset.turn(along)), turn)
            }
        }
    }

    fn vector(&mut self, value: Complex64) -> usize {
        self.member.push([value, value.conj()]);
        self.member.len() - 1
    }

    /// The terms that lead to a place on the link at an end of a joint; `None` while the link is not reached.
    fn path(&mut self, end: &End, at: Vec3) -> Option<Vec<Term>> {
        let place = self.place(end, at);
        match end {
            End::Known(flat) => {
                let vector = self.vector(flat.carry(place));
                self.family.at_rest.push(vector);
                Some(vec![Term { vector, turn: None, slide: None, back: false }])
            }
            End::Body(k, _) => {
                let (origin, mut path) = self.origins[*k].clone()?;
                let (turn, ahead) = self.turning[*k];
                let vector = self.vector((place - origin) * ahead);
                path.push(Term { vector, turn, slide: None, back: false });
                Some(path)
            }
        }
    }

    fn is_reached(&self, end: &End) -> bool {
        match end {
            End::Known(_) => true,
            End::Body(k, _) => self.origins[*k].is_some(),
        }
    }

    /// Reaches one link after the other by hinges and slides; the joints that are left close cycles.
    fn grow(&mut self) -> Vec<usize> {
        let mut left: Vec<usize> = (0..self.block.joints.len()).collect();
        loop {
            let next = left.iter().position(|&j| {
                let reached = self.ends[j].map(|end| self.is_reached(&end));
                let leads = matches!(
                    self.block.joints[j].0,
                    BlockJoint::Hinge(_) | BlockJoint::Slide(..)
                );
                leads && reached[0] != reached[1]
            });
            let Some(place) = next else {
                return left;
            };
            self.reach(left.remove(place));
        }
    }

    fn reach(&mut self, joint: usize) {
        let ends = self.ends[joint];
        let [from, to] = if self.is_reached(&ends[0]) {
            ends
        } else {
            [ends[1], ends[0]]
        };
        let End::Body(k, _) = to else { return };
        let (at, along) = match self.block.joints[joint].0 {
            BlockJoint::Hinge(at) => (at, None),
            BlockJoint::Slide(at, along) => (at, Some(along)),
            BlockJoint::Slot(..) | BlockJoint::Rod(_) => return,
        };
        let Some(mut path) = self.path(&from, at) else {
            return;
        };
        if let Some(along) = along {
            let (direction, turn) = self.direction(&from, along);
            let vector = self.vector(direction);
            let slide = Some(self.family.slides.len());
            self.family.slides.push(turn);
            path.push(Term { vector, turn, slide, back: false });
        }
        self.origins[k] = Some((self.place(&to, at), path));
    }

    /// Closes a cycle by a joint whose links are both reached.
    fn close(&mut self, joint: usize) {
        let ends = self.ends[joint];
        let shape = self.block.joints[joint].0;
        let at = match shape {
            BlockJoint::Hinge(at) | BlockJoint::Slide(at, _) | BlockJoint::Slot(at, _) => [at; 2],
            BlockJoint::Rod(at) => at,
        };
        let paths = [0, 1].map(|s: usize| self.path(&ends[s], at[s]));
        let [Some(first), Some(second)] = paths else {
            return;
        };
        // what both paths share goes out and back again
        let shared: Vec<Term> = first.iter().filter(|t| second.contains(t)).copied().collect();
        let back = second.iter().map(|t| Term { back: true, ..*t });
        let terms: Vec<Term> = first
            .iter()
            .copied()
            .chain(back)
            .filter(|t| !shared.contains(&Term { back: false, ..*t }))
            .collect();
        let closes = match shape {
            BlockJoint::Hinge(_) => Closes::Pin,
            BlockJoint::Slide(_, along) | BlockJoint::Slot(_, along) => {
                let (direction, turn) = self.direction(&ends[1], along);
                let normal = self.vector(Complex64::I * direction);
                self.member.push([Complex64::ZERO; 2]);
                Closes::Slide { turn, normal, height: normal + 1 }
            }
            BlockJoint::Rod([p, q]) => {
                let length = (self.plane.place(p) - self.plane.place(q)).norm() / self.size;
                self.member
                    .push([Complex64::from(length * length), Complex64::ZERO]);
                Closes::Rod { square: self.member.len() - 1 }
            }
        };
        self.family.chords.push(Chord { closes, terms });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    const Z: Vec3 = [0.0, 0.0, 1.0];

    fn any(random: &mut Random) -> Vec3 {
        [4.0 * random.uniform(), 4.0 * random.uniform(), 0.0]
    }

    fn step(link: usize) -> On {
        link.checked_sub(1)
    }

    /// Pins between links, the ground 0, at random places.
    fn pinned(between: &[[usize; 2]], random: &mut Random) -> PlanarBlock {
        let count = between.iter().flatten().max().copied().unwrap_or(0);
        PlanarBlock {
            normal: Z,
            links: (0..count).collect(),
            joints: between
                .iter()
                .map(|pair| (BlockJoint::Hinge(any(random)), pair.map(step)))
                .collect(),
        }
    }

    /// How many solutions a general member of a block's family has, and whether the trace test passes.
    fn counted(block: &PlanarBlock) -> (usize, bool) {
        let poses = vec![Pose::STILL; block.links.len() + 1];
        let held = block.links.len();
        let before = Before { poses: &poses, held, from: None, moved: Pose::STILL, size: 1.0 };
        let starts = Layout::of(block, &before).unwrap().family.starts();
        assert_ne!(starts.completeness(0), Completeness::Searched);
        (starts.count(), starts.certified)
    }

    #[test]
    fn blocks_of_pins_have_as_many_modes_as_theory_says() {
        let mut random = Random(1);
        let mut count = |between: &[[usize; 2]]| counted(&pinned(between, &mut random));
        assert_eq!(count(&[[0, 1], [1, 2], [2, 0]]), (2, true));
        // two ternary links on the ground, between them two others
        assert_eq!(
            count(&[[0, 1], [0, 2], [1, 3], [3, 2], [1, 4], [4, 2]]),
            (6, true)
        );
        // a platform on three cranks
        assert_eq!(
            count(&[[0, 1], [0, 2], [0, 3], [1, 4], [2, 4], [3, 4]]),
            (6, true)
        );
        // the three trusses of seven links
        let star = [
            [0, 1],
            [0, 2],
            [0, 3],
            [1, 4],
            [4, 2],
            [2, 5],
            [5, 3],
            [3, 6],
            [6, 1],
        ];
        let path = [
            [0, 1],
            [1, 2],
            [2, 3],
            [0, 4],
            [4, 2],
            [1, 5],
            [5, 3],
            [0, 6],
            [6, 3],
        ];
        let four = [
            [1, 2],
            [0, 3],
            [3, 1],
            [0, 4],
            [4, 1],
            [0, 5],
            [5, 2],
            [0, 6],
            [6, 2],
        ];
        assert_eq!(
            [&star, &path, &four].map(|between| count(between)),
            [(14, true), (16, true), (18, true)]
        );
    }
}
