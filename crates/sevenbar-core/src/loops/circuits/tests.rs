//! Nets of links in a plane, followed by the code that follows chains: `e(q)` are the gaps of the pins that close a tree of links.
//!
//! A four-bar so written has the circuits, dead centres, rates and change points of its chain; of a Watt six-bar all modes are known by
//! dyads: a circle on a circle, twice.

use super::curve::{self, Curve};
use super::follow;
use super::join;
use super::known_curves::Curves;
use crate::loops::equation::chain::{AGREE, Chain};
use crate::loops::equation::closed::{At, Closed, Inverse, Joint, Placed, Screws};
use crate::loops::equation::dense::{Array, COLUMNS, Factored, ROWS};
use crate::loops::equation::free_direction::free_direction;
use crate::loops::equation::rotations::short_way;
use crate::loops::motions::passes::Passes;
use crate::number::Number;
use crate::outcome::RowStatus;
use crate::rigid::Pose;
use std::f64::consts::{PI, TAU};
use std::fmt::Debug;

type Point<N = f64> = [N; 2];

/// A tree of links with C turning joints in a plane, closed by K pins, R = 2 K = C - 1. All turns are zero as drawn.
struct PlanarNet<const C: usize, const R: usize, const K: usize> {
    joints: Vec<Joint>,
    first: Vec<usize>,
    /// The link before each joint; the ground is 0, and the link after joint c is c + 1.
    before: [usize; C],
    /// Where the joints were drawn.
    places: [Point; C],
    /// The links of each pin, and where it was drawn.
    pins: [([usize; 2], Point); K],
}

/// A link that moves, as power series: its turn as cosine and sine, and where the ground's origin goes with it.
struct Link<N> {
    turn: Vec<Point<N>>,
    origin: Vec<Point<N>>,
}

/// `w a`, complex.
fn turned<N: Number>(w: &Point<N>, a: &Point) -> Point<N> {
    let [x, y] = a.map(N::splat);
    [
        (w[0] * x).minus_product(w[1], y),
        (w[0] * y).plus_product(w[1], x),
    ]
}

impl<N: Number> Link<N> {
    /// An order of the place of a point.
    fn place(&self, order: usize, a: &Point) -> Point<N> {
        let [x, y] = turned(&self.turn[order], a);
        [self.origin[order][0] + x, self.origin[order][1] + y]
    }
}

impl<const C: usize, const R: usize, const K: usize> PlanarNet<C, R, K> {
    fn new(before: [usize; C], places: [Point; C], pins: [([usize; 2], Point); K]) -> Self {
        let (joints, first) = (vec![Joint::Turn; C], (0..C).collect());
        Self { joints, first, before, places, pins }
    }

    /// The joints from a link to the ground.
    fn path(&self, mut link: usize) -> Vec<usize> {
        let mut path = Vec::new();
        while link > 0 {
            path.push(link - 1);
            link = self.before[link - 1];
        }
        path
    }

    /// The joints of a pin's cycle on the side of each of its links.
    fn cycle(&self, pin: usize) -> [Vec<usize>; 2] {
        let sides = self.pins[pin].0.map(|link| self.path(link));
        let own = |k: usize| {
            let other = &sides[1 - k];
            sides[k].iter().copied().filter(|c| !other.contains(c)).collect()
        };
        [own(0), own(1)]
    }

    /// The links as series up to an order.
    fn links<N: Number>(&self, at: &At<Self, N>, rates: &[[N; C]], order: usize) -> Vec<Link<N>> {
        let (zero, one) = (N::splat(0.0), N::splat(1.0));
        let still = vec![[zero; 2]; order + 1];
        let mut turn = still.clone();
        turn[0] = [one, zero];
        let mut links = vec![Link { turn, origin: still }];
        let mut angles = vec![(zero, vec![zero; order])];
        for c in 0..C {
            let (mut angle, mut spin) = angles[self.before[c]].clone();
            angle = angle + at.values[c];
            for n in 0..order {
                spin[n] = spin[n] + rates[n][c];
            }
            let (sine, cosine) = angle.sin_cos();
            let mut turn = vec![[cosine, sine]];
            // w' = i spin w
            for n in 0..order {
                let part = N::splat(1.0 / (n + 1) as f64);
                let (mut x, mut y) = (zero, zero);
                for m in 0..=n {
                    x = x.minus_product(spin[m], turn[n - m][1]);
                    y = y.plus_product(spin[m], turn[n - m][0]);
                }
                turn.push([x * part, y * part]);
            }
            let link = &links[self.before[c]];
            let origin = (0..=order).map(|n| {
                let (here, own) = (link.place(n, &self.places[c]), turned(&turn[n], &self.places[c]));
                [here[0] - own[0], here[1] - own[1]]
            });
            let origin = origin.collect();
            links.push(Link { turn, origin });
            angles.push((angle, spin));
        }
        links
    }

    /// An order of the series of `A`: what a joint turns is square to the arm.
    fn slopes<N: Number>(&self, links: &[Link<N>], order: usize) -> [[N; R]; C] {
        let mut out = [[N::splat(0.0); R]; C];
        for (k, (ends, place)) in self.pins.iter().enumerate() {
            for (side, joints) in self.cycle(k).iter().enumerate() {
                let sign = N::splat(if side == 0 { 1.0 } else { -1.0 });
                let end = links[ends[side]].place(order, place);
                for &c in joints {
                    let own = links[c + 1].place(order, &self.places[c]);
                    out[c][2 * k] = sign * (own[1] - end[1]);
                    out[c][2 * k + 1] = sign * (end[0] - own[0]);
                }
            }
        }
        out
    }

    /// The configuration of links with such turns.
    fn with_turns(&self, turns: [f64; C]) -> At<Self> {
        let turn = |link: usize| if link == 0 { 0.0 } else { turns[link - 1] };
        At {
            values: Array::from_fn(|c| short_way(turn(c + 1) - turn(self.before[c]))),
            balls: [],
        }
    }
}

impl<const C: usize, const R: usize, const K: usize> Closed for PlanarNet<C, R, K> {
    type Columns<T: Copy + Debug> = [T; C];
    type Rows<T: Copy + Debug> = [T; R];
    type Bordered<T: Copy + Debug> = [T; C];
    type Balls<T: Copy + Debug> = [T; 0];
    type Cycles<T: Copy + Debug> = [T; K];

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
        let links = self.links(at, &[], 0);
        let mut error = [N::splat(0.0); R];
        for (k, ([a, b], place)) in self.pins.iter().enumerate() {
            let [a, b] = [a, b].map(|link| links[*link].place(0, place));
            error[2 * k] = a[0] - b[0];
            error[2 * k + 1] = a[1] - b[1];
        }
        Placed { screws: self.slopes(&links, 0), error, closing_cosine: N::splat(1.0) }
    }

    fn residual<N: Number>(&self, placed: &Placed<Self, N>) -> N {
        let gaps = placed.error.iter();
        gaps.fold(N::splat(0.0), |square, x| square.plus_product(*x, *x))
            .sqrt()
    }

    fn inverse<N: Number>(&self, screws: &Screws<Self, N>, row: &[N; C]) -> Inverse<Self, N> {
        let mut columns = [[N::splat(0.0); ROWS]; COLUMNS];
        for c in 0..C {
            columns[c][..R].copy_from_slice(&screws[c]);
            columns[c][R] = row[c];
        }
        let inverse = Factored::new(columns, C).inverse();
        Inverse(std::array::from_fn(|r| std::array::from_fn(|c| inverse[r][c])))
    }

    fn carry<N: Number, const TERMS: usize>(
        &self,
        at: &At<Self, N>,
        screws: &mut [Screws<Self, N>; TERMS],
        rates: &[[N; C]; TERMS],
        order: usize,
    ) {
        screws[order] = self.slopes(&self.links(at, rates, order), order);
    }

    fn farthest<N: Number>(&self, _at: &At<Self, N>) -> [N; K] {
        std::array::from_fn(|k| {
            let [near, far] = self.cycle(k);
            let mut round = vec![self.pins[k].1];
            round.extend(near.iter().chain(far.iter().rev()).map(|&c| self.places[c]));
            round.push(round[0]);
            let around: f64 = round
                .windows(2)
                .map(|p| (p[1][0] - p[0][0]).hypot(p[1][1] - p[0][1]))
                .sum();
            N::splat(0.51 * around)
        })
    }

    fn bounds<N: Number>(&self, inverse_norm: N, far: &[N; K], rates: &[[N; C]; 3], s: N) -> [N; 2] {
        let [mut third, mut fifth] = [N::splat(0.0); 2];
        for k in 0..K {
            let joints = self.cycle(k).concat();
            let [mut u, mut v, mut w] = [N::splat(0.0); 3];
            for &c in &joints {
                let [a, b, c] = [rates[0][c].size(), rates[1][c].size(), rates[2][c].size()];
                u = u + a + (b + c * s) * s;
                v = v + b + N::splat(2.0) * c * s;
                w = w + N::splat(2.0) * c;
            }
            // the cycle's links, one after the other, are twice as long as any two of its points are apart
            let long = N::splat(2.0) * far[k];
            let one = long * (u * u * u + N::splat(3.0) * u * v + w);
            third = third + N::splat(joints.len() as f64) * one * one;
            let one = long
                * (u * u * u * (u * u + N::splat(10.0) * v)
                    + N::splat(15.0) * u * v * v
                    + N::splat(10.0) * w * (u * u + v));
            fifth = fifth + one * one;
        }
        [inverse_norm * third.sqrt(), inverse_norm * fifth.sqrt()]
    }

    fn across<N: Number>(&self, far: &[N; K], _square: N) -> N {
        let mut square = N::splat(0.0);
        for k in 0..K {
            let one = N::splat(self.cycle(k).concat().len() as f64) * far[k];
            square = square + one * one;
        }
        square.sqrt()
    }
}

fn apart(a: &Point, b: &Point) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

fn angle(from: &Point, to: &Point) -> f64 {
    (to[1] - from[1]).atan2(to[0] - from[0])
}

/// Where circles about two points meet, on the left of the way from one to the other, or on the right.
fn circles(a: &Point, long: f64, b: &Point, other: f64, left: bool) -> Option<Point> {
    let far = apart(a, b);
    let along = (far * far + long * long - other * other) / (2.0 * far);
    let square = long * long - along * along;
    let across = if left { square.sqrt() } else { -square.sqrt() };
    let [x, y] = [(b[0] - a[0]) / far, (b[1] - a[1]) / far];
    (square >= 0.0).then(|| [a[0] + along * x - across * y, a[1] + along * y + across * x])
}

/// A four-bar as it is drawn: the ground's pins, the crank's and the rocker's.
#[derive(Clone, Copy)]
struct FourBar {
    o: Point,
    a: Point,
    b: Point,
    c: Point,
}

impl FourBar {
    /// With the ground along x, drawn with the crank at an angle.
    fn new([crank, coupler, rocker, ground]: [f64; 4], drawn: f64) -> Self {
        let (a, c) = ([crank * drawn.cos(), crank * drawn.sin()], [ground, 0.0]);
        let b = circles(&a, coupler, &c, rocker, true).unwrap();
        Self { o: [0.0; 2], a, b, c }
    }

    fn net(&self) -> PlanarNet<3, 2, 1> {
        PlanarNet::new([0, 1, 0], [self.o, self.a, self.c], [([2, 3], self.b)])
    }

    fn chain(&self) -> Chain {
        let sides = [
            apart(&self.o, &self.a),
            apart(&self.a, &self.b),
            apart(&self.b, &self.c),
            apart(&self.c, &self.o),
        ];
        let link = |long: f64| Pose { translation: [long, 0.0, 0.0], ..Pose::STILL };
        Chain::new(vec![Joint::Turn; 4], sides.map(link).to_vec())
    }

    /// Where the four-bar's pins are with the crank turned on from the drawing.
    fn at(&self, turn: f64, left: bool) -> Option<Self> {
        let crank = angle(&self.o, &self.a) + turn;
        let long = apart(&self.o, &self.a);
        let a = [self.o[0] + long * crank.cos(), self.o[1] + long * crank.sin()];
        let (coupler, rocker) = (apart(&self.a, &self.b), apart(&self.b, &self.c));
        let b = circles(&a, coupler, &self.c, rocker, left)?;
        Some(Self { a, b, ..*self })
    }

    /// The turns of crank, coupler and rocker from the drawing.
    fn turns(&self, drawn: &Self) -> [f64; 3] {
        [
            angle(&self.o, &self.a) - angle(&drawn.o, &drawn.a),
            angle(&self.a, &self.b) - angle(&drawn.a, &drawn.b),
            angle(&self.c, &self.b) - angle(&drawn.c, &drawn.b),
        ]
    }

    fn modes(&self, turn: f64) -> Vec<FourBar> {
        [true, false]
            .iter()
            .filter_map(|&left| self.at(turn, left))
            .collect()
    }

    /// A mode as its chain has it: its frame's x leads from the rocker's pin on the ground to the crank's.
    fn on_chain(&self) -> At<Chain> {
        let ways = [
            angle(&self.c, &self.o),
            angle(&self.o, &self.a),
            angle(&self.a, &self.b),
            angle(&self.b, &self.c),
            angle(&self.c, &self.o),
        ];
        let mut at = At::<Chain>::zero();
        for (value, way) in at.values.iter_mut().zip(ways.windows(2)) {
            *value = short_way(way[1] - way[0]);
        }
        at
    }
}

/// The curves through modes at a few inputs.
fn curves<S: Closed>(closed: &S, modes: &[At<S>], wished: &[usize]) -> Curves<S> {
    let mut curves = Curves::new(wished);
    curves.take(closed, modes, wished[0]);
    curves.finish(closed);
    curves
}

/// Inputs, outputs and three rates of the rows of all circuits at whole degrees of an input that is zero at `origin`, in order, and the
/// dead centres' inputs.
fn rows<S: Closed>(
    closed: &S,
    curves: &Curves<S>,
    origin: f64,
    output: (usize, f64, f64),
) -> (Vec<[f64; 5]>, Vec<f64>) {
    let (column, sign, zero) = output;
    let (mut found, mut limits) = (Vec::new(), Vec::new());
    for curve in &curves.curves {
        let passes = Passes::new(closed, curve.clone(), 0).unwrap();
        let ends = &passes.limits[..passes.limits.len() - usize::from(passes.turns_back())];
        limits.extend(ends.iter().map(|n| (n.at.values[0] - origin).rem_euclid(TAU)));
        for row in passes.rows::<Vec<_>>(origin, TAU / 360.0) {
            if row.status == RowStatus::Ok {
                let degrees = ((row.at.values[0] - origin).to_degrees())
                    .round()
                    .rem_euclid(360.0);
                let value = (sign * row.at.values[column] - zero).rem_euclid(TAU);
                let [a, b, c] = row.rates.map(|rate| sign * rate[column]);
                found.push([degrees, value, a, b, c]);
            }
        }
    }
    found.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    limits.sort_by(f64::total_cmp);
    (found, limits)
}

/// Whether a configuration is a place of a curve.
fn passes<S: Closed>(closed: &S, curve: &Curve<S>, at: &At<S>) -> bool {
    let mut nodes = curve.nodes.iter();
    nodes.any(|n| curve::passes_through(closed, n, at).is_some())
}

/// The curves of a four-bar as a net, and as a chain.
fn both(bar: &FourBar) -> (PlanarNet<3, 2, 1>, Chain, Curves<PlanarNet<3, 2, 1>>, Curves) {
    let (net, chain) = (bar.net(), bar.chain());
    let modes: Vec<FourBar> = (0..6).flat_map(|k| bar.modes(0.1 + f64::from(k))).collect();
    let on_net: Vec<_> = modes.iter().map(|m| net.with_turns(m.turns(bar))).collect();
    let on_chain: Vec<_> = modes.iter().map(FourBar::on_chain).collect();
    let found = (curves(&net, &on_net, &[0, 2]), curves(&chain, &on_chain, &[0, 3]));
    (net, chain, found.0, found.1)
}

#[test]
fn a_four_bar_as_a_net_has_the_circuits_the_dead_centres_and_the_rates_of_its_chain() {
    // crank and rocker, two rockers, and one that turns over
    for (sides, circuits) in [
        ([0.2, 0.6, 0.5, 0.55], 2),
        ([0.5, 0.2, 0.55, 0.6], 2),
        ([0.4, 0.35, 0.45, 0.75], 1),
    ] {
        let bar = FourBar::new(sides, 1.1);
        let (net, chain, of_net, of_chain) = both(&bar);
        assert_eq!(
            (of_net.curves.len(), of_chain.curves.len()),
            (circuits, circuits),
            "{sides:?}"
        );
        assert!(of_net.curves.iter().all(Curve::is_closed));
        let drawn = angle(&bar.c, &bar.b);
        let (a, limits) = rows(&net, &of_net, -angle(&bar.o, &bar.a), (2, 1.0, -drawn));
        let (b, others) = rows(&chain, &of_chain, -PI, (3, -1.0, 0.0));
        assert!(
            a.len() == b.len() && a.len() > 150,
            "{sides:?} {} {}",
            a.len(),
            b.len()
        );
        for (a, b) in a.iter().zip(&b) {
            let scale = 1.0 + a[2].powi(2).powi(3);
            for k in 0..5 {
                assert!(
                    (a[k] - b[k]).abs() < 1e-9 * scale.max(1.0 + a[k].abs()),
                    "{sides:?} {a:?} {b:?}"
                );
            }
        }
        assert_eq!(limits.len(), others.len(), "{sides:?}");
        assert!(
            limits.iter().zip(&others).all(|(a, b)| (a - b).abs() < 1e-9),
            "{limits:?} {others:?}"
        );
    }
}

#[test]
fn a_parallelogram_as_a_net_has_the_change_points_and_the_smooth_curves_of_its_chain() {
    let (net, chain, of_net, of_chain) = both(&FourBar::new([0.4, 0.7, 0.4, 0.7], 1.1));
    assert_eq!((of_net.curves.len(), of_net.change_points.len()), (2, 2));
    assert_eq!((of_chain.curves.len(), of_chain.change_points.len()), (2, 2));
    for point in &of_net.change_points {
        assert_eq!((point.rays.len(), point.lost, point.finite), (4, 0, 1));
        assert!(of_net.curves.iter().all(|curve| point.is_on(&net, curve)));
    }
    assert!(
        of_chain
            .change_points
            .iter()
            .all(|p| p.rays.len() == 4 && p.is_on(&chain, &of_chain.curves[0]))
    );
}

/// A Watt six-bar: on a four-bar's coupler and rocker stand two links more, pinned to each other.
struct Watt {
    bar: FourBar,
    e: Point,
    f: Point,
    g: Point,
}

impl Watt {
    fn new() -> Self {
        let bar = FourBar::new([0.2, 0.6, 0.5, 0.55], 1.1);
        let (e, f) = ([0.35, 0.65], [0.85, 0.35]);
        Self { bar, e, f, g: circles(&e, 0.52, &f, 0.4, true).unwrap() }
    }

    fn net(&self) -> PlanarNet<5, 4, 2> {
        let FourBar { o, a, b, c } = self.bar;
        PlanarNet::new(
            [0, 1, 0, 2, 3],
            [o, a, c, self.e, self.f],
            [([2, 3], b), ([4, 5], self.g)],
        )
    }

    /// The turns of the five links in a mode of two dyads.
    fn turns(&self, turn: f64, signs: [bool; 2]) -> Option<[f64; 5]> {
        let now = self.bar.at(turn, signs[0])?;
        let [crank, coupler, rocker] = now.turns(&self.bar);
        let carried = |from: &Point, to: &Point, turn: f64, point: &Point| {
            let (s, c) = turn.sin_cos();
            let [x, y] = [point[0] - from[0], point[1] - from[1]];
            [to[0] + c * x - s * y, to[1] + s * x + c * y]
        };
        let e = carried(&self.bar.a, &now.a, coupler, &self.e);
        let f = carried(&self.bar.c, &now.c, rocker, &self.f);
        let g = circles(&e, apart(&self.e, &self.g), &f, apart(&self.f, &self.g), signs[1])?;
        let near = angle(&e, &g) - angle(&self.e, &self.g);
        let far = angle(&f, &g) - angle(&self.f, &self.g);
        Some([crank, coupler, rocker, near, far])
    }
}

const SIGNS: [[bool; 2]; 4] = [[true, true], [true, false], [false, true], [false, false]];

#[test]
fn every_mode_of_a_watt_six_bar_by_dyads_lies_on_one_of_the_circuits_followed_and_its_rows_are_theirs() {
    let watt = Watt::new();
    let net = watt.net();
    let modes_at = |turn: f64| -> Vec<At<PlanarNet<5, 4, 2>>> {
        let turns = SIGNS.iter().filter_map(|&signs| watt.turns(turn, signs));
        turns.map(|t| net.with_turns(t)).collect()
    };
    let seeds: Vec<_> = (0..24)
        .flat_map(|k| modes_at(0.05 + TAU / 24.0 * f64::from(k)))
        .collect();
    let found = curves(&net, &seeds, &[0, 4]);
    assert!(found.curves.len() > 1 && found.curves.iter().all(Curve::is_closed));
    assert_eq!((found.change_points.len(), found.search.unfollowed), (0, 0));
    // followed piece by piece they are the same
    let joined = join::closed_curves(&net, &seeds);
    assert_eq!(joined.len(), found.curves.len());
    let mut modes = 0;
    for k in 0..96 {
        for mode in modes_at(0.01 + TAU / 96.0 * f64::from(k)) {
            modes += 1;
            assert!(net.residual(&net.place(&mode)) < 1e-14);
            for all in [&found.curves, &joined] {
                assert_eq!(all.iter().filter(|curve| passes(&net, curve, &mode)).count(), 1);
            }
        }
    }
    let mut rows = 0;
    for curve in &found.curves {
        let passes = Passes::new(&net, curve.clone(), 0).unwrap();
        for row in passes.rows::<Vec<_>>(0.0, TAU / 96.0) {
            // near a dead centre the dyads do not close beside it
            if row.status != RowStatus::Ok || row.condition > 100.0 {
                continue;
            }
            rows += 1;
            let turn = row.at.values[0];
            let near = |signs: &&[bool; 2]| {
                let at = watt.turns(turn, **signs).map(|t| net.with_turns(t));
                at.is_some_and(|at| net.difference(&at, &row.at).iter().all(|x| x.abs() < 1e-10))
            };
            let signs = *SIGNS.iter().find(near).unwrap();
            let h = 2e-3;
            let value = |k: i32| {
                let at = net.with_turns(watt.turns(turn + h * f64::from(k), signs).unwrap());
                net.difference(&row.at, &at)[4]
            };
            let [a, b, c, d] = [1, 2, 3, 4].map(|k| value(k) - value(-k));
            let velocity = (672.0 * a - 168.0 * b + 32.0 * c - 3.0 * d) / (840.0 * h);
            let [a, b, c, d] = [1, 2, 3, 4].map(|k| value(k) + value(-k));
            let bent = (8064.0 * a - 1008.0 * b + 128.0 * c - 9.0 * d) / (5040.0 * h * h);
            assert!((velocity - row.rates[0][4]).abs() < 1e-9, "{turn}");
            assert!(
                (bent - row.rates[1][4]).abs() < 1e-5 * (1.0 + bent.abs()),
                "{turn} {bent} {:?}",
                row.rates
            );
        }
    }
    assert!(modes > 200 && rows > 150, "{modes} {rows}");
}

#[test]
fn a_curve_of_a_net_walked_alone_is_that_walked_with_others() {
    let net = Watt::new().net();
    let drawn = At::zero();
    let direction: [f64; 5] = free_direction::<PlanarNet<5, 4, 2>>(&net.place(&drawn).screws, 1e-6).unwrap();
    let back = direction.map(|x| -x);
    let alone = follow::follow(&net, &[(drawn, direction)], &[]).swap_remove(0);
    for curve in follow::follow(&net, &[(drawn, direction), (drawn, back)], &[]) {
        assert!(curve.is_closed() && alone.nodes.len() > 30);
        assert!(alone.nodes.iter().all(|n| passes(&net, &curve, &n.at)));
    }
}
