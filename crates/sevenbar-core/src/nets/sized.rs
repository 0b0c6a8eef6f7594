//! A net as it is followed: [`Closed`] over so many columns as the compiler knows, of which those past the net's own rest.
//!
//! Rows are as many as one freedom leaves: those that repeat others are left out. A row's series follows from that of the columns, since it
//! is written for numbers of any kind.
//!
//! Source: docs/theory_nets.md, (8).

use super::dyad_quads::made;
use super::dyad_rows::DyadRows;
use super::modes::Part;
use super::net::{MOST_COLUMNS, Net, on};
use super::rows::Row;
use super::series::{Series, rotating};
use super::square::Square;
use super::steps::{Move, Placement, Screw};
use crate::loops::equation::chain::AGREE;
use crate::loops::equation::closed::{At, Closed, Explicits, Inverse, Joint, Placed, Screws, Stretch};
use crate::loops::equation::rotations::{Rotation, dot3, product};
use crate::number::Number;
use crate::rigid::{Vec3, dot, norm, sub};
use crate::vectors::QUAD;
use std::fmt::Debug;

/// A cycle that is open by rounding reaches so much farther.
const BEYOND: f64 = 1.02;

/// A net of one freedom with at most so many columns and one row less; lengths relative to the size.
pub(super) struct SizedNet<const C: usize, const R: usize, const B: usize> {
    pub net: Net,
    joints: Vec<Joint>,
    first: Vec<usize>,
    cycles: Vec<Cycle>,
    /// Its rows in closed form, if it is made of dyads.
    explicit: Option<DyadRows>,
}

/// One size for all nets: each costs as much code as the chain's, and one of twice as many columns twice the time.
pub(super) type WholeNet = SizedNet<MOST_COLUMNS, { MOST_COLUMNS - 1 }, 5>;

/// What a row says of the cycle that it closes.
struct Cycle {
    /// The columns that move the one link, and those that move the other.
    sides: [Vec<usize>; 2],
    /// From joint to joint round the cycle as drawn.
    around: f64,
    /// The columns of slides in it, with how far each goes by a unit.
    slides: Vec<(usize, f64)>,
    kind: Bounded,
}

/// What a row's derivatives are bounded by.
enum Bounded {
    /// Directions: by 1.
    Angle,
    /// A place: by the distance within the cycle.
    Place,
    /// The same place as the row before.
    Counted,
    /// A rod of this length.
    Rod(f64),
}

impl Cycle {
    fn of(net: &Net, r: usize) -> Self {
        let row = &net.rows[r];
        let sides = net.sides(row);
        let ends: [Vec3; 2] = match *row {
            Row::Length { at, .. } => at,
            Row::Along { at, .. } => [at; 2],
            Row::Angle { .. } => [[0.0; 3]; 2],
        };
        // from the end on the one link inwards, and outwards to that on the other
        let origin = |&c: &usize| net.steps[c].origin;
        let mut way: Vec<Vec3> = vec![ends[0]];
        way.extend(sides[0].iter().rev().map(origin));
        way.extend(sides[1].iter().map(origin));
        way.push(ends[1]);
        let rod = norm(sub(ends[0], ends[1]));
        let around = way.windows(2).map(|p| norm(sub(p[1], p[0]))).sum::<f64>() + rod;
        let slides = sides.iter().flatten().filter_map(|&c| match net.steps[c].moves {
            Move::Turn => None,
            Move::Slide => Some((c, 1.0)),
            Move::Screw(advance) => Some((c, advance.abs())),
        });
        let slides = slides.collect();
        let place = |row: &Row| match *row {
            Row::Along { on, at, .. } => Some((on, at)),
            _ => None,
        };
        let kind = match *row {
            Row::Angle { .. } => Bounded::Angle,
            Row::Length { length, .. } => Bounded::Rod(length),
            // square directions, so that together they say what the distance says
            Row::Along { v, .. } => {
                let before = r.checked_sub(1).map(|k| &net.rows[k]);
                let same = before.filter(|b| place(b) == place(row));
                let square = |b: &Row| matches!(*b, Row::Along { v: w, .. } if dot(v, w).abs() < AGREE);
                if same.is_some_and(square) {
                    Bounded::Counted
                } else {
                    Bounded::Place
                }
            }
        };
        Self { sides, around, slides, kind }
    }

    fn columns(&self) -> impl Iterator<Item = usize> {
        self.sides.iter().flatten().copied()
    }

    /// How many columns move it.
    fn count(&self) -> f64 {
        (self.sides[0].len() + self.sides[1].len()) as f64
    }

    /// The bound of all derivatives of the row by columns, from that of the distance: the products of a rod's two factors are `splits`.
    fn bound<N: Number>(&self, far: N, splits: f64) -> N {
        match self.kind {
            Bounded::Angle => N::splat(1.0),
            Bounded::Place => far,
            Bounded::Counted => N::splat(0.0),
            Bounded::Rod(length) => far.plus_product(far * far, N::splat(splits / length)),
        }
    }
}

impl<const C: usize, const R: usize, const B: usize> SizedNet<C, R, B> {
    /// Of a net with some of its rows, one fewer than it has columns.
    pub fn new(net: &Net, rows: &[usize]) -> Self {
        let mut net = net.relative();
        net.rows = rows.iter().map(|&r| net.rows[r]).collect();
        let (mut joints, mut first) = (Vec::new(), Vec::new());
        let mut column = 0;
        while column < C {
            let joint = match net.steps.get(column).map(|s| s.moves) {
                Some(_) if net.balls.contains(&column) => {
                    let ball = net.balls.iter().position(|&b| b == column);
                    Joint::Ball(ball.unwrap_or_default())
                }
                Some(Move::Turn) => Joint::Turn,
                Some(Move::Screw(advance)) => Joint::Screw(advance),
                // what is past the net's own columns rests
                Some(Move::Slide) | None => Joint::Slide,
            };
            joints.push(joint);
            first.push(column);
            column += joint.columns();
        }
        let cycles = (0..net.rows.len()).map(|r| Cycle::of(&net, r)).collect();
        Self { joints, first, cycles, net, explicit: None }
    }

    /// The same with rows in closed form over an input, if its parts, as long as its size says, are all dyads.
    pub fn made_of(mut self, parts: &[Part], input: usize, size: f64) -> Self {
        let besides = (C - self.used()) as f64;
        self.explicit = DyadRows::of(&self.net, parts, input, size, besides);
        self
    }

    /// Its rows in closed form, where it is made up of dyads in one plane.
    pub fn dyads(&self) -> Option<&DyadRows> {
        self.explicit.as_ref()
    }

    /// The place of columns, a ball's three turns as its rotation.
    pub fn at(&self, values: &[f64]) -> At<Self> {
        let mut at = At::<Self>::zero();
        at.values[..values.len()].copy_from_slice(values);
        for (ball, &first) in at.balls.iter_mut().zip(&self.net.balls) {
            for k in first..first + 3 {
                let turned = self.net.steps[k].moved(values[k]);
                *ball = product(ball, &turned.rotation);
                at.values[k] = 0.0;
            }
        }
        at
    }

    /// The values of the columns in use at a place.
    pub fn values<'a>(&self, at: &'a At<Self>) -> &'a [f64] {
        &at.values[..self.used()]
    }

    /// The balls in use at a place.
    pub fn balls<'a>(&self, at: &'a At<Self>) -> &'a [Rotation] {
        &at.balls[..self.net.balls.len()]
    }

    /// How many columns are in use.
    pub fn used(&self) -> usize {
        self.net.steps.len()
    }

    /// Values of a slide beyond which a cycle through it, of turns and rods besides, does not close [relative to the size]; the cycle's two links
    /// share a place, of so many coordinates. `None` where no cycle bounds it.
    pub fn reach_of_slide(&self, column: usize, coordinates: usize) -> Option<[f64; 2]> {
        let is_bounded = |r: usize| match self.cycles[r].kind {
            Bounded::Rod(_) => true,
            Bounded::Place => {
                let others = self.cycles[r + 1..].iter();
                1 + others.take_while(|c| matches!(c.kind, Bounded::Counted)).count() >= coordinates
            }
            Bounded::Angle | Bounded::Counted => false,
        };
        let bounding = self.cycles.iter().enumerate().filter(|(r, cycle)| {
            let only = |slides: &[(usize, f64)]| matches!(slides, [(c, _)] if *c == column);
            only(&cycle.slides) && is_bounded(*r)
        });
        let far = bounding
            .map(|(_, cycle)| BEYOND * cycle.around)
            .min_by(f64::total_cmp)?;
        let drawn = self.net.drawn()[column];
        Some([drawn - far, drawn + far])
    }

    fn placed<N: Number>(&self, values: &[N; C], balls: &[Rotation<N>]) -> Placed<Self, N> {
        let zero = N::splat(0.0);
        let (mut poses, mut screws) = ([Placement::still(); C], [Screw::still(); C]);
        self.net.place(values, balls, &mut poses, &mut screws);
        let mut placed = Placed::<Self, N> {
            screws: [[zero; R]; C],
            error: [zero; R],
            closing_cosine: N::splat(1.0),
        };
        for (r, (row, cycle)) in self.net.rows.iter().zip(&self.cycles).enumerate() {
            let [a, b] = row.on();
            let (value, wrenches) = row.evaluated(&on(&poses, a), &on(&poses, b));
            placed.error[r] = value;
            for side in 0..2 {
                for &c in &cycle.sides[side] {
                    placed.screws[c][r] = wrenches[side].power(&screws[c]);
                }
            }
        }
        for facing in &self.net.facing {
            let [a, b] = facing.on.map(|step| on(&poses, step).turn(&facing.direction));
            let cosine = dot3(&a, &b);
            placed.closing_cosine = placed.closing_cosine.lesser(cosine);
        }
        for c in self.used()..C {
            placed.screws[c][c - 1] = N::splat(1.0);
            placed.error[c - 1] = values[c];
        }
        placed
    }
}

impl<const C: usize, const R: usize, const B: usize> Closed for SizedNet<C, R, B> {
    const SIDE_BY_SIDE: bool = false;

    const EXPLICIT: bool = true;

    type Columns<T: Copy + Debug> = [T; C];
    type Rows<T: Copy + Debug> = [T; R];
    type Bordered<T: Copy + Debug> = [T; C];
    type Balls<T: Copy + Debug> = [T; B];
    type Cycles<T: Copy + Debug> = [T; R];

    fn joints(&self) -> &[Joint] {
        &self.joints
    }

    fn first(&self) -> &[usize] {
        &self.first
    }

    fn columns(&self) -> usize {
        C
    }

    fn agree(&self) -> f64 {
        AGREE
    }

    fn place<N: Number>(&self, at: &At<Self, N>) -> Placed<Self, N> {
        self.placed(&at.values, &at.balls[..self.net.balls.len()])
    }

    fn residual<N: Number>(&self, placed: &Placed<Self, N>) -> N {
        let mut square = N::splat(0.0);
        for x in placed.error {
            square = square.plus_product(x, x);
        }
        let error = square.sqrt();
        // where axes point against each other it does not close
        N::splat(0.0).if_greater(placed.closing_cosine, error + N::splat(1.0), error)
    }

    fn inverse<N: Number>(&self, screws: &Screws<Self, N>, row: &[N; C]) -> Inverse<Self, N> {
        let zero = N::splat(0.0);
        let used = self.used();
        let mut columns = [[zero; C]; C];
        for c in 0..used {
            columns[c][..used - 1].copy_from_slice(&screws[c][..used - 1]);
            columns[c][used - 1] = row[c];
        }
        let square = Square::new(columns, used);
        let mut inverse = [[zero; C]; C];
        for r in 0..used {
            let mut unit = [zero; C];
            unit[r] = N::splat(1.0);
            // the row that borders them is the last, however many are in use
            inverse[if r + 1 == used { R } else { r }] = square.solve(unit);
        }
        Inverse(inverse)
    }

    fn carry<N: Number, const TERMS: usize>(
        &self,
        at: &At<Self, N>,
        screws: &mut [Screws<Self, N>; TERMS],
        rates: &[[N; C]; TERMS],
        order: usize,
    ) {
        let mut values = [Series::<N, TERMS>::splat(0.0); C];
        for c in 0..self.used() {
            values[c].0[0] = at.values[c];
            for k in 1..=order {
                values[c].0[k] = rates[k - 1][c] * N::splat(1.0 / k as f64);
            }
        }
        let mut balls = [[[Series::<N, TERMS>::splat(0.0); 3]; 3]; B];
        let mut spin = [[N::splat(0.0); 3]; TERMS];
        for (b, &first) in self.net.balls.iter().enumerate() {
            for k in 0..order {
                spin[k].copy_from_slice(&rates[k][first..first + 3]);
            }
            balls[b] = rotating(&at.balls[b], &spin[..order]);
        }
        let placed = self.placed(&values, &balls[..self.net.balls.len()]);
        for c in 0..C {
            for r in 0..R {
                screws[order][c][r] = placed.screws[c][r].0[order];
            }
        }
    }

    fn farthest<N: Number>(&self, at: &At<Self, N>) -> [N; R] {
        let mut far = [N::splat(0.0); R];
        for (far, cycle) in far.iter_mut().zip(&self.cycles) {
            // half the way round, and a little more where it does not quite close
            let mut around = N::splat(BEYOND * cycle.around);
            let mut least = N::splat(0.0);
            for &(c, advance) in &cycle.slides {
                around = around + (at.values[c] * N::splat(advance)).size();
                least = N::splat(1.0);
            }
            let half = around * N::splat(0.5);
            *far = half.if_greater(least, half, least);
        }
        far
    }

    fn bounds<N: Number>(&self, inverse_norm: N, far: &[N; R], rates: &[[N; C]; 3], s: N) -> [N; 2] {
        let [mut third, mut fifth] = [N::splat(0.0); 2];
        for (cycle, &far) in self.cycles.iter().zip(far) {
            let [mut u, mut v, mut w] = [N::splat(0.0); 3];
            for c in cycle.columns() {
                let [a, b, c] = [rates[0][c].size(), rates[1][c].size(), rates[2][c].size()];
                let slope = b.plus_product(c, s);
                u = u + a.plus_product(slope, s);
                v = v + slope.plus_product(c, s);
                w = w + N::splat(2.0) * c;
            }
            // a product's factors share four derivatives in 7 ways, and five in 15
            let one = cycle.bound(far, 7.0) * ((u * u * u).plus_product(N::splat(3.0) * u, v) + w);
            third = third.plus_product(one * one, N::splat(cycle.count()));
            let one = cycle.bound(far, 15.0)
                * (u * u * u * (u * u + N::splat(10.0) * v)
                    + N::splat(15.0) * u * v * v
                    + N::splat(10.0) * w * (u * u + v));
            fifth = fifth.plus_product(one, one);
        }
        [inverse_norm * third.sqrt(), inverse_norm * fifth.sqrt()]
    }

    fn stretch(&self, input: usize, ends: [&At<Self>; 2]) -> Option<Stretch<Self>> {
        let explicit = self.explicit.as_ref().filter(|e| e.driven() == input)?;
        let signs = explicit.sides(ends.map(|at| self.values(at)))?;
        let from = ends[0].values;
        let mut turns = [[0.0; 2]; C];
        explicit.turns(&from, &mut turns);
        Some(Stretch { signs, from, turns })
    }

    fn explicit(
        &self,
        on: &Stretch<Self>,
        values: &[f64; QUAD],
        given: &[f64; 3],
        rows: &mut Explicits<Self>,
    ) {
        if let Some(dyads) = &self.explicit {
            made(dyads, on, values, given, rows);
        }
    }

    fn across<N: Number>(&self, far: &[N; R], _square: N) -> N {
        let mut square = N::splat(0.0);
        for (cycle, &far) in self.cycles.iter().zip(far) {
            let one = cycle.bound(far, 1.0) * N::splat(cycle.count());
            square = square.plus_product(one, one);
        }
        square.sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::super::steps::Step;
    use super::*;

    fn four_bar() -> SizedNet<5, 4, 1> {
        let z = [0.0, 0.0, 1.0];
        let pin = |parent, x: f64, y: f64| Step {
            parent,
            moves: Move::Turn,
            origin: [x, y, 0.0],
            axis: z,
            reads: 0.0,
        };
        let on = [Some(1), Some(2)];
        let along = |v| Row::Along { on, at: [3.5, 2.0, 0.0], v };
        let net = Net {
            steps: vec![pin(None, 0.0, 0.0), pin(Some(0), 0.3, 1.0), pin(None, 4.0, 0.0)],
            rows: vec![along([1.0, 0.0, 0.0]), along([0.0, 1.0, 0.0])],
            facing: Vec::new(),
            balls: Vec::new(),
            size: 4.0,
        };
        SizedNet::new(&net, &[0, 1])
    }

    #[test]
    fn the_series_of_the_screws_is_that_of_their_places() {
        let net = four_bar();
        let rates = [[0.3, -0.5, 0.8, 0.0, 0.0], [0.2, 0.1, -0.4, 0.0, 0.0], [0.0; 5]];
        let at = |t: f64| {
            let mut at = net.at(&[0.1, 0.4, -0.2]);
            for c in 0..3 {
                at.values[c] += t * (rates[0][c] + t * rates[1][c] / 2.0);
            }
            at
        };
        let mut screws = [net.place(&at(0.0)).screws; 3];
        net.carry(&at(0.0), &mut screws, &rates, 1);
        net.carry(&at(0.0), &mut screws, &rates, 2);
        let h = 1e-3;
        let (up, here, down) = (net.place(&at(h)), net.place(&at(0.0)), net.place(&at(-h)));
        for c in 0..5 {
            for r in 0..4 {
                let first = (up.screws[c][r] - down.screws[c][r]) / (2.0 * h);
                let second = (up.screws[c][r] - 2.0 * here.screws[c][r] + down.screws[c][r]) / (2.0 * h * h);
                assert!((screws[1][c][r] - first).abs() < 1e-6, "{c} {r}");
                assert!((screws[2][c][r] - second).abs() < 1e-6, "{c} {r}");
            }
        }
    }

    #[test]
    fn columns_past_its_own_rest() {
        let net = four_bar();
        let placed = net.place(&net.at(&[0.1, 0.4, -0.2]));
        assert_eq!(placed.screws[3], [0.0, 0.0, 1.0, 0.0]);
        let inverse = net.inverse(&placed.screws, &[1.0, 0.0, 0.0, 0.0, 0.0]);
        // it is driven by its first
        let free = inverse.0[4];
        assert!((free[0] - 1.0).abs() < 1e-15);
        assert_eq!(free[3..], [0.0; 2]);
    }
}
