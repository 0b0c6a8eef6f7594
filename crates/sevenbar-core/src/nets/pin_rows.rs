//! Rows of a net whose joints are pins all over: dyads of two links between pins, hung on each other, driven by a link that turns.
//!
//! What `dyad_rows` does for every kind of dyad in power series is done here link by link with angular velocities, for a third of the
//! work: each order of a dyad is two linear equations with the matrix of the first. The matrix `A` falls into blocks of two by two along
//! the dyads, so its inverse needs no factorisation. Angles are counted from those of a place near by.
//!
//! Source: docs/theory_nets.md, (14) to (18).

use super::dyad_sides::Found;
use super::dyads::{Pair, Plane};
use super::in_plane::{Complex, Moving, minus_product, plus_product};
use super::joints::TERMS;
use super::modes::Stage;
use super::net::{MOST_COLUMNS, Net};
use super::rows::{On, Row};
use super::steps::Move;
use crate::loops::equation::closed::MOST_SIGNS;
use crate::number::Number;
use crate::rigid::{dot, norm, sub};
use crate::vector_math::{TAN_EIGHTH, arctangent};
use num_complex::Complex64;

/// Places nearer than this, relative to the size, are one, and directions so near a right angle are at one.
const SAME: f64 = 1e-12;

/// A pin of a dyad: on the first known link, between its links, on the second known link.
const FIRST: usize = 0;
const MIDDLE: usize = 1;
const SECOND: usize = 2;

/// A place on a link, against the pin about which that turns; on the ground, where it is.
#[derive(Clone, Copy, Debug)]
struct Place {
    on: On,
    off: Complex64,
}

/// A column: the pin about which it turns, to which side, and the link before it.
#[derive(Clone, Copy, Debug)]
struct Column {
    parent: On,
    side: f64,
    reads: f64,
    /// Its dyad, and the pin of that; none of the driven one.
    pin: Option<(usize, usize)>,
}

#[derive(Clone, Debug)]
struct Pinned {
    links: [usize; 2],
    /// The pins on the known links.
    outer: [Place; 2],
    /// The links from them to the pin between: what turns them to the drawn direction, length and square of the length.
    arms: [(Complex64, f64, f64); 2],
    /// The pin that is no step of the tree.
    chord: usize,
    /// How its own columns move the chord, and the sign of their determinant against that of the links.
    own: [f64; 2],
    turned: f64,
    /// How those of earlier dyads do, and the driven one.
    others: Vec<(usize, f64)>,
    driven: f64,
}

/// A net of pins over one input that turns, lengths relative to the size.
#[derive(Clone, Debug)]
pub(super) struct PinRows {
    driven: usize,
    /// The pin of the driven link.
    base: Complex64,
    columns: Vec<Column>,
    dyads: Vec<Pinned>,
    besides: f64,
}

impl PinRows {
    /// Of stages that are known to be dyads in a plane, each after those at which it hangs; `None` where something slides, or the net
    /// has other rows than two for each pin.
    pub fn of(
        net: &Net,
        stages: &[&Stage],
        plane: &Plane,
        driven: usize,
        (size, besides): (f64, f64),
    ) -> Option<Self> {
        let normal = stages.first()?.dyad.normal;
        let count = net.steps.len();
        // the pin about which each link turns, on the link before it
        let base = plane.place(net.steps[driven].origin);
        let mut pins = vec![base; count];
        let mut places = Vec::new();
        for stage in stages {
            let mut hinges = [Complex64::ZERO; 3];
            for (hinge, pair) in hinges.iter_mut().zip(stage.dyad.pairs) {
                let Pair::Hinge(at) = pair else { return None };
                *hinge = plane.place(at) / size;
            }
            pins[stage.links[0]] = hinges[FIRST];
            pins[stage.links[1]] = hinges[SECOND];
            places.push(hinges);
        }
        let mut columns: Vec<Column> = Vec::with_capacity(count);
        for (c, step) in net.steps.iter().enumerate() {
            if step.moves != Move::Turn {
                return None;
            }
            let dyad = stages.iter().position(|stage| stage.links.contains(&c));
            let pin = match dyad {
                None => None,
                Some(k) => {
                    let stage = stages[k];
                    let own = usize::from(stage.links[1] == c);
                    let outer = if own == 0 { FIRST } else { SECOND };
                    // by the place, since a dyad may hang at one link with both its ends
                    let at = plane.place(step.origin);
                    let is_at = |pin: usize| (places[k][pin] - at).norm() < SAME;
                    if step.parent == Some(stage.links[1 - own]) && is_at(MIDDLE) {
                        Some((k, MIDDLE))
                    } else if step.parent == stage.known[own] && is_at(outer) {
                        Some((k, outer))
                    } else {
                        return None;
                    }
                }
            };
            let side = dot(step.axis, normal).signum();
            columns.push(Column { parent: step.parent, side, reads: step.reads, pin });
        }
        let mut dyads: Vec<Pinned> = Vec::new();
        for (k, stage) in stages.iter().enumerate() {
            let [p, c, q] = places[k];
            let used = stage
                .links
                .map(|link| columns[link].pin.map_or(usize::MAX, |(_, pin)| pin));
            let chord = (0..3).find(|pin| !used.contains(pin))?;
            let between = match chord {
                FIRST => [Some(stage.links[0]), stage.known[0]],
                MIDDLE => stage.links.map(Some),
                _ => [Some(stage.links[1]), stage.known[1]],
            };
            let is_own = |row: &&Row| {
                let [a, b] = row.on();
                [a, b] == between || [b, a] == between
            };
            let rows: Vec<&Row> = net.rows.iter().filter(is_own).collect();
            let [first, second] = rows[..] else { return None };
            let (Row::Along { at, v, .. }, Row::Along { at: other, v: w, .. }) = (first, second) else {
                return None;
            };
            let is_square = dot(*v, *w).abs() < SAME && (plane.place(*v).norm() - 1.0).abs() < SAME;
            let is_there =
                (plane.place(*at) - places[k][chord]).norm() < SAME && norm(sub(*at, *other)) < SAME;
            if !(is_square && (plane.place(*w).norm() - 1.0).abs() < SAME && is_there) {
                return None;
            }
            let [one, two] = net.sides(first);
            let mut moved = vec![0.0; count];
            for (side, sign) in [(one, 1.0), (two, -1.0)] {
                for c in side {
                    moved[c] += sign * columns[c].side;
                }
            }
            let own = stage.links.map(|link| std::mem::take(&mut moved[link]));
            let driven = std::mem::take(&mut moved[driven]);
            let others: Vec<(usize, f64)> = moved
                .into_iter()
                .enumerate()
                .filter(|(_, by)| *by != 0.0)
                .collect();
            let known = |c: usize| stages[..k].iter().any(|before| before.links.contains(&c));
            if own.contains(&0.0) || !others.iter().all(|&(c, _)| known(c)) {
                return None;
            }
            let off = |on: On, at: Complex64| Place { on, off: on.map_or(at, |link| at - pins[link]) };
            let arm = |from: Complex64| ((c - from).inv(), (c - from).norm(), (c - from).norm_sqr());
            dyads.push(Pinned {
                links: stage.links,
                outer: [off(stage.known[0], p), off(stage.known[1], q)],
                arms: [arm(p), arm(q)],
                chord,
                own,
                turned: own[0] * own[1] * if chord == MIDDLE { 1.0 } else { -1.0 },
                others,
                driven,
            });
        }
        (net.rows.len() + 1 == count).then_some(Self { driven, base, columns, dyads, besides })
    }

    /// Makes the row with the input's series, with cosine and sine of each column at a place near by; `sine` is zero where that is too far.
    #[inline(always)]
    pub fn row<N: Number>(
        &self,
        sides: &[f64; MOST_SIGNS],
        input: [N; TERMS],
        (near, turns): (&[f64], &[[f64; 2]]),
        found: &mut Found<N>,
    ) {
        let zero = N::splat(0.0);
        let still = Complex { re: zero, im: zero };
        let ground = Moving::new(
            Complex::constant(Complex64::ONE),
            [still; TERMS],
            [zero; TERMS - 1],
        );
        let mut links = [ground; MOST_COLUMNS];
        found.sine = N::splat(1.0);
        let column = self.columns[self.driven];
        let (im, re) = (input[0] - N::splat(column.reads)).sin_cos();
        let spin = [
            input[1].scaled(column.side),
            input[2].scaled(2.0 * column.side),
            input[3].scaled(6.0 * column.side),
        ];
        let base = [Complex::constant(self.base), still, still, still];
        links[self.driven] = Moving::new(Complex { re, im: im.scaled(column.side) }, base, spin);
        let mut places = [[still; 3]; MOST_SIGNS];
        let mut inverses = [zero; MOST_SIGNS];
        let mut residual = zero;
        for (k, dyad) in self.dyads.iter().enumerate() {
            let [first, second] = dyad.outer;
            let a = carried(&links, first);
            let b = carried(&links, second);
            let [(turn, length, long), (back_turn, back_length, short)] = dyad.arms;
            let line = b[0].minus(a[0]);
            let inverse = N::splat(1.0) / line.dot(line);
            let re = inverse.scaled(0.5 * (long - short)) + N::splat(0.5);
            let im = inverse.scaled(long).minus_product(re, re).sqrt().scaled(sides[k]);
            let arm = line.times(Complex { re, im });
            let back = arm.minus(line);
            let area = arm.cross(back);
            found.sine = found.sine.lesser(area.scaled(sides[k] / (length * back_length)));
            let inverse = N::splat(1.0) / area;
            // how far the links are from their lengths is how far the dyad is from closing
            let off = (arm.dot(arm) - N::splat(long)).scaled(0.5 / length);
            let back_off = (back.dot(back) - N::splat(short)).scaled(0.5 / back_length);
            residual = residual.plus_product(off, off).plus_product(back_off, back_off);
            let first = b[1].minus(a[1]);
            let (w, v) = (first.dot(back) * inverse, first.dot(arm) * inverse);
            let (ww, vv) = (w * w, v * v);
            let second = b[2].minus(a[2]).plus(arm.stretched(ww)).minus(back.stretched(vv));
            let (dw, dv) = (second.dot(back) * inverse, second.dot(arm) * inverse);
            let third = plus_product(
                b[3].minus(a[3]),
                Complex { re: (w * dw).scaled(3.0), im: ww * w },
                arm,
            );
            let third = minus_product(third, Complex { re: (v * dv).scaled(3.0), im: vv * v }, back);
            let (ddw, ddv) = (third.dot(back) * inverse, third.dot(arm) * inverse);
            links[dyad.links[0]] = Moving::new(arm.by(turn), a, [w, dw, ddw]);
            links[dyad.links[1]] = Moving::new(back.by(back_turn), b, [v, dv, ddv]);
            places[k] = [a[0], a[0].plus(arm), b[0]];
            inverses[k] = inverse.scaled(dyad.turned);
        }
        found.residual = residual.sqrt();
        let mut farthest = zero;
        for (c, column) in self.columns.iter().enumerate() {
            let link = links[c];
            let (mut z, mut spin) = (link.z, link.spin);
            if let Some(parent) = column.parent {
                let before = links[parent];
                z = before.z.towards(z);
                for order in 0..TERMS - 1 {
                    spin[order] = spin[order] - before.spin[order];
                }
            }
            let factors = [column.side, column.side, 0.5 * column.side];
            for order in 0..TERMS - 1 {
                found.rates[order][c] = spin[order].scaled(factors[order]);
            }
            if c == self.driven {
                found.values[c] = input[0];
                continue;
            }
            // the tangent of half the angle, to the side of the column
            let [re, im] = turns[c];
            let along = z.re.scaled(re) + z.im.scaled(im * column.side);
            let across = z.im.scaled(re * column.side) - z.re.scaled(im);
            let half = across / (along + N::splat(1.0));
            let size = half.size();
            farthest = size.if_greater(farthest, size, farthest);
            found.values[c] = N::splat(near[c]).plus_product(arctangent(half), N::splat(2.0));
        }
        found.sine = N::splat(TAN_EIGHTH).if_greater(farthest, found.sine, zero);
        found.condition = self.condition(&places, &inverses);
    }

    /// The condition number of `A` with the driven column as one more row: by blocks along the dyads.
    #[inline(always)]
    fn condition<N: Number>(&self, places: &[[Complex<N>; 3]; MOST_SIGNS], inverses: &[N; MOST_SIGNS]) -> N {
        let zero = N::splat(0.0);
        let still = Complex { re: zero, im: zero };
        let (mut squares, mut inverse) = (N::splat(1.0 + self.besides), N::splat(1.0));
        let mut entries = [[still; MOST_COLUMNS]; MOST_SIGNS];
        let mut free = [zero; MOST_COLUMNS];
        for (k, dyad) in self.dyads.iter().enumerate() {
            let at = places[k][dyad.chord];
            for (link, by) in dyad.links.into_iter().zip(dyad.own) {
                entries[k][link] = self.entry(places, at, link, by);
                squares = squares + entries[k][link].dot(entries[k][link]);
            }
            let moved = self.entry(places, at, self.driven, dyad.driven);
            squares = squares + moved.dot(moved);
            let mut right = still.minus(moved);
            for &(c, by) in &dyad.others {
                let entry = self.entry(places, at, c, by);
                entries[k][c] = entry;
                squares = squares + entry.dot(entry);
                right = right.minus(entry.stretched(free[c]));
            }
            let (one, two) = (entries[k][dyad.links[0]], entries[k][dyad.links[1]]);
            let (x, y) = (right.cross(two) * inverses[k], one.cross(right) * inverses[k]);
            (free[dyad.links[0]], free[dyad.links[1]]) = (x, y);
            inverse = inverse.plus_product(x, x).plus_product(y, y);
        }
        for first in 0..self.dyads.len() {
            let links = self.dyads[first].links;
            let (one, two) = (entries[first][links[0]], entries[first][links[1]]);
            // both columns of the inverse side by side
            let mut columns = [[still; 2]; MOST_SIGNS];
            columns[first] = [
                Complex { re: two.im, im: -two.re }.stretched(inverses[first]),
                Complex { re: -one.im, im: one.re }.stretched(inverses[first]),
            ];
            inverse = inverse + columns[first][0].dot(columns[first][0]);
            inverse = inverse + columns[first][1].dot(columns[first][1]);
            for k in first + 1..self.dyads.len() {
                let dyad = &self.dyads[k];
                let mut right = [still; 2];
                let mut is_moved = false;
                for &(c, _) in &dyad.others {
                    let Some((before, own)) = self.dyad_of(c) else {
                        continue;
                    };
                    if before < first {
                        continue;
                    }
                    is_moved = true;
                    let (x, entry) = (columns[before][own], entries[k][c]);
                    right[0] = right[0].minus(entry.stretched(x.re));
                    right[1] = right[1].minus(entry.stretched(x.im));
                }
                if !is_moved {
                    continue;
                }
                let (one, two) = (entries[k][dyad.links[0]], entries[k][dyad.links[1]]);
                let x = Complex { re: right[0].cross(two), im: right[1].cross(two) };
                let y = Complex { re: one.cross(right[0]), im: one.cross(right[1]) };
                columns[k] = [x.stretched(inverses[k]), y.stretched(inverses[k])];
                inverse = inverse + columns[k][0].dot(columns[k][0]);
                inverse = inverse + columns[k][1].dot(columns[k][1]);
            }
        }
        (squares * inverse).sqrt()
    }

    /// The dyad of a column, and which of its two.
    #[inline(always)]
    fn dyad_of(&self, c: usize) -> Option<(usize, usize)> {
        let (dyad, _) = self.columns[c].pin?;
        Some((dyad, usize::from(self.dyads[dyad].links[1] == c)))
    }

    /// How a column moves a place, a quarter turn back, to a side.
    #[inline(always)]
    fn entry<N: Number>(
        &self,
        places: &[[Complex<N>; 3]; MOST_SIGNS],
        at: Complex<N>,
        c: usize,
        by: f64,
    ) -> Complex<N> {
        let pin = match self.columns[c].pin {
            Some((dyad, pin)) => places[dyad][pin],
            None => Complex::constant(self.base),
        };
        at.minus(pin).stretched(N::splat(by))
    }
}

/// A place with three derivatives.
#[inline(always)]
fn carried<N: Number>(links: &[Moving<N>; MOST_COLUMNS], place: Place) -> [Complex<N>; TERMS] {
    match place.on {
        Some(link) => links[link].carry(place.off),
        None => {
            let still = Complex::constant(Complex64::ZERO);
            [Complex::constant(place.off), still, still, still]
        }
    }
}
