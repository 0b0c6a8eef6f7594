//! Rows in closed form against Newton's method and the series of the whole net.

use super::branch_ranges::{Counted, Inputs};
use super::dyad_branch_points::BranchPoints;
use super::dyad_rows::DyadRows;
use super::dyads::{Dyad, Pair};
use super::modes::{Part, Stage};
use super::net::Net;
use super::rows::{On, Row};
use super::sized::WholeNet;
use super::steps::{Move, Step};
use crate::loops::circuits::known_curves::Curves;
use crate::loops::equation::closed::{Closed, Explicits};
use crate::loops::motions::passes::Passes;
use crate::loops::motions::row::Row as OfCircuit;
use crate::outcome::RowStatus;
use crate::rigid::Vec3;
use crate::vectors::QUAD;
use std::f64::consts::FRAC_PI_2;

const Z: Vec3 = [0.0, 0.0, 1.0];

/// The joints of a dyad, and the steps at which it hangs.
type Hung = ([Pair; 3], [On; 2]);

fn at(x: f64, y: f64) -> Vec3 {
    [x, y, 0.0]
}

fn step(parent: On, pair: Pair, side: f64) -> Step {
    let (moves, origin, axis) = match pair {
        Pair::Hinge(place) => (Move::Turn, place, Z.map(|x| x * side)),
        Pair::Slide(along) => (Move::Slide, at(0.7, -0.4), along),
    };
    Step { parent, moves, origin, axis, reads: 0.0 }
}

/// The rows of a chord that is a hinge or a slide.
fn closing(pair: Pair, on: [On; 2]) -> Vec<Row> {
    match pair {
        Pair::Hinge(at) => [[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], Z]
            .map(|v| Row::Along { on, at, v })
            .to_vec(),
        Pair::Slide([x, y, _]) => vec![
            Row::Angle { on, u: [1.0, 0.0, 0.0], v: [0.0, 1.0, 0.0], cosine: 0.0 },
            Row::Angle { on, u: [0.0, 1.0, 0.0], v: Z, cosine: 0.0 },
            Row::Along { on, at: at(0.3, 0.5), v: [-y, x, 0.0] },
            Row::Along { on, at: at(0.3, 0.5), v: Z },
        ],
    }
}

/// A crank that reads a value as drawn, and dyads whose outer joints are in the tree.
fn net_of(dyads: &[Hung], crank: Pair, reads: f64) -> (Net, Vec<Part>) {
    let mut steps = vec![Step { reads, ..step(None, crank, 1.0) }];
    let (mut rows, mut parts) = (Vec::new(), Vec::new());
    for &(pairs, known) in dyads {
        let links = [steps.len(), steps.len() + 1];
        steps.push(step(known[0], pairs[0], -1.0));
        steps.push(step(known[1], pairs[2], 1.0));
        rows.extend(closing(pairs[1], links.map(Some)));
        parts.push(Part::Dyad(Stage {
            dyad: Dyad { normal: Z, pairs },
            links,
            known,
        }));
    }
    let net = Net { steps, rows, facing: Vec::new(), balls: Vec::new(), size: 2.5 };
    (net, parts)
}

fn hinge(x: f64, y: f64) -> Pair {
    Pair::Hinge(at(x, y))
}

fn slide(angle: f64) -> Pair {
    Pair::Slide(at(angle.cos(), angle.sin()))
}

/// Asserts that all rows over the first column are those of Newton's method, and returns the share of them that had a closed form.
fn compared(net: &Net, parts: &[Part], name: &str) -> f64 {
    let independent = super::freedoms::freedoms(net).independent;
    let general = WholeNet::new(net, &independent);
    let explicit = WholeNet::new(net, &independent).made_of(parts, 0, net.size);
    let mut curves = Curves::new(&[0]);
    curves.take(&general, &[general.at(&net.drawn())], 0);
    curves.finish(&general);
    assert!(!curves.curves.is_empty(), "{name}");
    let (mut met, mut all) = (0.0, 0.0);
    for curve in curves.curves {
        for ends in curve.nodes.windows(2) {
            let value = 0.5 * (ends[0].at.values[0] + ends[1].at.values[0]);
            let on = explicit.stretch(0, [&ends[0].at, &ends[1].at]);
            let mut made = Explicits::none();
            if let Some(on) = on {
                explicit.explicit(&on, &[value; QUAD], &[1.0, 0.0, 0.0], &mut made);
            }
            let over = (ends[0].at.values[0] - ends[1].at.values[0]).abs();
            met += if made.is_sure[0] { over } else { 0.0 };
            all += over;
        }
        let one = Passes::new(&general, curve.clone(), 0).unwrap();
        let other = Passes::new(&explicit, curve, 0).unwrap();
        let [low, high] = [f64::min, f64::max].map(|end| {
            let ends = one.passes.iter().flat_map(|p| [p.start, p.end]);
            ends.reduce(end).unwrap()
        });
        let law: Vec<[f64; 4]> = (0..40)
            .map(|k| [low + (high - low) * (f64::from(k) + 0.4) / 40.0, 0.7, -0.3, 0.9])
            .collect();
        // rows next to dead centres, too
        let near = (0..8).flat_map(|k| {
            let by = (high - low) * 10f64.powi(-k - 1);
            [[low + by, 1.0, 0.2, 0.3], [high - by, 1.0, 0.2, 0.3]]
        });
        let law: Vec<[f64; 4]> = law.into_iter().chain(near).collect();
        let step = (high - low) / 97.0;
        type Both = [Vec<OfCircuit<WholeNet>>; 2];
        let pairs: [Both; 2] = [
            [one.rows(low, step), other.rows(low, step)],
            [
                one.law_rows(&law, general.is_turn(0), 0.0),
                other.law_rows(&law, general.is_turn(0), 0.0),
            ],
        ];
        for [want, got] in pairs {
            assert_eq!(want.len(), got.len(), "{name}");
            for (want, got) in want.iter().zip(&got) {
                assert_eq!((want.status, want.pass), (got.status, got.pass), "{name}");
                if want.status == RowStatus::NoSolution {
                    continue;
                }
                let off = general.difference(&want.at, &got.at);
                // what rounding does where the net is nearly singular
                let unsure = 1e-15 * want.condition;
                let most = off.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
                assert!(
                    most.is_nan() || most <= 1e-12 + unsure,
                    "{name} {most:e} {}",
                    want.condition
                );
                for c in 0..general.used() {
                    // turns are counted as they are along the curve
                    assert!((want.at.values[c] - got.at.values[c]).abs() < 1.0, "{name}");
                }
                if want.status != RowStatus::Ok {
                    continue;
                }
                assert!(got.residual < 1e-12, "{name} {}", got.residual);
                let condition = (want.condition - got.condition).abs() / want.condition;
                assert!(condition < 1e-9 + want.condition * unsure, "{name} {condition:e}");
                for order in 0..3 {
                    let [w, g] = [want, got].map(|row| row.rates[order]);
                    let size = w.iter().fold(1.0, |most: f64, x| most.max(x.abs()));
                    for c in 0..general.used() {
                        let apart = (w[c] - g[c]).abs() / size;
                        // where Newton's method stops a little short, rates are those of the place next to it
                        let short = 10.0 * (most + unsure) * want.condition;
                        assert!(
                            apart < 1e-9 + short,
                            "{name} {c} {order} {apart:e} {}",
                            want.condition
                        );
                    }
                }
            }
        }
    }
    met / all
}

#[test]
fn every_kind_of_dyad_has_the_rows_of_the_general_way() {
    let on = [Some(0), None];
    let cases: [(&str, [Pair; 3], Pair); 12] = [
        (
            "crank-rocker",
            [hinge(0.3, 0.9), hinge(2.4, 1.9), hinge(2.8, 0.0)],
            hinge(0.0, 0.0),
        ),
        (
            "double rocker",
            [hinge(0.2, 1.9), hinge(1.6, 1.4), hinge(1.9, 0.0)],
            hinge(0.0, 0.0),
        ),
        (
            "right angles",
            [hinge(0.0, 1.0), hinge(2.0, 1.0), hinge(2.0, 0.0)],
            hinge(0.0, 0.0),
        ),
        (
            "slider-crank",
            [hinge(0.3, 0.9), hinge(2.2, 0.2), slide(0.1)],
            hinge(0.0, 0.0),
        ),
        (
            "slider on the crank",
            [slide(0.4), hinge(1.5, 0.9), hinge(2.8, 0.3)],
            hinge(0.0, 0.0),
        ),
        (
            "slide between",
            [hinge(0.3, 0.9), slide(-0.4), hinge(2.4, 0.3)],
            hinge(0.0, 0.0),
        ),
        (
            "oscillating slide",
            [hinge(0.9, 0.5), slide(0.3), hinge(0.2, -0.6)],
            hinge(0.0, 0.0),
        ),
        (
            "Scotch yoke",
            [hinge(0.3, 0.9), slide(1.5), slide(0.0)],
            hinge(0.0, 0.0),
        ),
        (
            "Oldham",
            [slide(0.2), slide(1.5), hinge(0.5, 0.2)],
            hinge(0.0, 0.0),
        ),
        (
            "slider drives",
            [hinge(0.3, 0.4), hinge(1.2, 1.4), hinge(2.0, 0.0)],
            slide(0.3),
        ),
        (
            "trammel",
            [hinge(0.3, 0.0), hinge(0.0, 1.4), slide(FRAC_PI_2)],
            slide(0.0),
        ),
        (
            "slider and slide",
            [hinge(0.3, 0.4), slide(0.8), hinge(1.8, 0.3)],
            slide(0.3),
        ),
    ];
    for (name, pairs, crank) in cases {
        let (net, parts) = net_of(&[(pairs, on)], crank, 0.3);
        let share = compared(&net, &parts, name);
        assert!(share > 0.8, "{name} {share}");
    }
}

#[test]
fn dyads_on_dyads_have_the_rows_of_the_general_way() {
    let four_bar = (
        [hinge(0.1, 0.4), hinge(1.1, 0.8), hinge(1.0, 0.0)],
        [Some(0), None],
    );
    let cases: [(&str, Vec<Hung>); 4] = [
        (
            "Watt",
            vec![
                four_bar,
                (
                    [hinge(1.5, 0.6), hinge(2.2, 0.7), hinge(2.0, 0.0)],
                    [Some(2), None],
                ),
            ],
        ),
        (
            "Klann",
            vec![
                (
                    [hinge(0.11, 0.02), hinge(0.26, -0.13), hinge(0.14, -0.24)],
                    [Some(0), None],
                ),
                (
                    [hinge(0.58, -0.14), hinge(0.60, 0.20), hinge(0.37, 0.37)],
                    [Some(1), None],
                ),
            ],
        ),
        (
            "a slider on a coupler, and one more dyad",
            vec![
                four_bar,
                ([hinge(0.6, 1.2), hinge(1.9, 1.4), slide(0.2)], [Some(1), None]),
                (
                    [hinge(1.2, 0.7), hinge(1.8, 0.9), hinge(2.4, 1.3)],
                    [Some(2), Some(4)],
                ),
            ],
        ),
        (
            "parallelogram",
            vec![
                (
                    [hinge(0.06, 0.1), hinge(0.46, 0.1), hinge(0.4, 0.0)],
                    [Some(0), None],
                ),
                (
                    [hinge(0.26, 0.3), hinge(0.6, 0.4), hinge(0.7, 0.0)],
                    [Some(1), None],
                ),
            ],
        ),
    ];
    for (name, dyads) in cases {
        let (net, parts) = net_of(&dyads, hinge(0.0, 0.0), 0.0);
        let share = compared(&net, &parts, name);
        assert!(share > 0.8, "{name} {share}");
    }
}

/// Two dyads of pins, the second on the first's links, each closed at one of its three pins.
fn closed_at(chords: [usize; 2]) -> (Net, Vec<Part>) {
    let places = [
        [[0.1, 0.4], [1.1, 0.8], [1.0, 0.0]],
        [[1.5, 0.6], [2.2, 0.7], [2.0, 0.0]],
    ];
    let mut steps = vec![step(None, hinge(0.0, 0.0), 1.0)];
    let (mut rows, mut parts) = (Vec::new(), Vec::new());
    let mut known = [Some(0), None];
    for (places, chord) in places.into_iter().zip(chords) {
        let pairs = places.map(|[x, y]| hinge(x, y));
        let base = steps.len();
        // a link that hangs on the other comes after it
        let links = if chord == 0 {
            [base + 1, base]
        } else {
            [base, base + 1]
        };
        let [one, two] = links.map(Some);
        let (first, second, closed) = match chord {
            0 => ((known[1], pairs[2]), (two, pairs[1]), [known[0], one]),
            1 => ((known[0], pairs[0]), (known[1], pairs[2]), [one, two]),
            _ => ((known[0], pairs[0]), (one, pairs[1]), [two, known[1]]),
        };
        steps.push(step(first.0, first.1, -1.0));
        steps.push(step(second.0, second.1, 1.0));
        rows.extend(closing(pairs[chord], closed));
        parts.push(Part::Dyad(Stage {
            dyad: Dyad { normal: Z, pairs },
            links,
            known,
        }));
        known = [two, one];
    }
    (
        Net { steps, rows, facing: Vec::new(), balls: Vec::new(), size: 2.5 },
        parts,
    )
}

#[test]
fn nets_of_pins_may_be_closed_at_any_pin_of_a_dyad() {
    for chords in [[0, 1], [1, 2], [2, 0], [0, 0], [2, 2], [1, 1]] {
        let (net, parts) = closed_at(chords);
        let independent = super::freedoms::freedoms(&net).independent;
        let whole = WholeNet::new(&net, &independent);
        let dyads = DyadRows::of(&whole.net, &parts, 0, net.size, 0.0).unwrap();
        assert!(dyads.pins.is_some(), "{chords:?}");
        let share = compared(&net, &parts, &format!("{chords:?}"));
        assert!(share > 0.6, "{chords:?} {share}");
    }
}

#[test]
fn what_leans_out_of_the_plane_or_is_driven_elsewhere_has_no_closed_form() {
    let pairs = [hinge(0.3, 0.9), hinge(2.4, 1.9), hinge(2.8, 0.0)];
    let (mut net, parts) = net_of(&[(pairs, [Some(0), None])], hinge(0.0, 0.0), 0.0);
    let made = |net: &Net, input| DyadRows::of(net, &parts, input, net.size, 0.0);
    assert!(made(&net, 0).is_some());
    assert!(made(&net, 1).is_none());
    net.steps[2].axis = [1e-6, 0.0, 1.0];
    assert!(made(&net, 0).is_none());
}

#[test]
fn rows_one_by_one_are_those_of_four_at_once() {
    let cases = [
        [hinge(0.3, 0.9), hinge(2.4, 1.9), hinge(2.8, 0.0)],
        [slide(0.4), hinge(1.5, 0.9), hinge(2.8, 0.3)],
        [hinge(0.3, 0.9), slide(-0.4), hinge(2.4, 0.3)],
        [hinge(0.3, 0.9), slide(1.5), slide(0.0)],
    ];
    for pairs in cases {
        let (net, parts) = net_of(&[(pairs, [Some(0), None])], hinge(0.0, 0.0), 0.3);
        let independent = super::freedoms::freedoms(&net).independent;
        let whole = WholeNet::new(&net, &independent).made_of(&parts, 0, net.size);
        let besides = (17 - whole.used()) as f64;
        let dyads = DyadRows::of(&whole.net, &parts, 0, net.size, besides).unwrap();
        let drawn = whole.at(&net.drawn());
        let on = whole.stretch(0, [&drawn, &drawn]).unwrap();
        let values = [0.25, 0.3, 0.35, 0.4];
        let given = [0.7, -0.3, 0.9];
        let mut made = Explicits::none();
        whole.explicit(&on, &values, &given, &mut made);
        for (k, value) in values.into_iter().enumerate() {
            let row = OfCircuit::<WholeNet>::explicit(0, &made, k);
            let one = dyads.row(
                &on.signs,
                [value, given[0], given[1] / 2.0, given[2] / 6.0],
                &on.from,
            );
            assert!(made.is_sure[k] && DyadRows::is_sure(one.sine));
            assert!(one.residual < 1e-14 && (one.condition - row.condition).abs() < 1e-12 * row.condition);
            for c in 0..whole.used() {
                assert!((one.values[c] - row.at.values[c]).abs() < 1e-14);
                for order in 0..3 {
                    assert!((one.rates[order][c] - row.rates[order][c]).abs() < 1e-11);
                }
            }
        }
    }
}

#[test]
fn the_branch_points_of_dyads_are_counted_in_every_range() {
    // a four-bar that is no crank-rocker turns back at two inputs, a rocker of one with a longer ground at none
    let z = [0.0, 0.0, 1.0];
    let four_bar = |ground: f64, coupler: f64, rocker: f64| {
        let pin = |parent, origin| Step { parent, moves: Move::Turn, origin, axis: z, reads: 0.0 };
        // drawn with the crank along the ground
        let far = ground - 1.0;
        let along = (far * far + coupler * coupler - rocker * rocker) / (2.0 * far);
        let c = [1.0 + along, (coupler * coupler - along * along).sqrt(), 0.0];
        let at = [[0.0; 3], [1.0, 0.0, 0.0], c, [ground, 0.0, 0.0]];
        let steps = vec![pin(None, at[0]), pin(Some(0), at[1]), pin(None, at[3])];
        let rows = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
            .map(|v| Row::Along { on: [Some(1), Some(2)], at: c, v })
            .to_vec();
        let net = Net { steps, rows, facing: Vec::new(), balls: Vec::new(), size: 1.0 };
        let pairs = [Pair::Hinge(at[1]), Pair::Hinge(c), Pair::Hinge(at[3])];
        let stage = Stage { dyad: Dyad { normal: z, pairs }, links: [1, 2], known: [Some(0), None] };
        let rows = DyadRows::of(&net, &[Part::Dyad(stage)], 0, 1.0, 0.0).unwrap();
        Counted::of(&BranchPoints::of(&rows), Inputs::Turn)
    };
    // the ground's and the crank's lengths reach 3.5 to 5.5, the dyad's 4.5 to 0.5 apart: stretched at two inputs
    let rocks = four_bar(4.5, 2.0, 2.5);
    assert_eq!((rocks.real, rocks.open.len()), (2, 0));
    let turns = four_bar(4.0, 3.5, 3.0);
    assert_eq!((turns.real, turns.open.len(), turns.ends.len()), (0, 0, 0));
    // nearly stretched at one input alone: two branch points, however near to each other
    for off in [1e-3, 1e-6, 1e-9, 1e-11] {
        let nearly = four_bar(4.0, 2.5, 2.5 - off);
        assert_eq!((nearly.real, nearly.open.len()), (2, 0), "{off}");
        let beyond = four_bar(4.0, 2.5, 2.5 + off);
        assert_eq!((beyond.real, beyond.open.len()), (0, 0), "{off}");
        assert!(beyond.complex >= 2);
    }
    // at a change point they are one, which is left to those who know it
    let touching = four_bar(4.0, 2.5, 2.5);
    assert_eq!(touching.open.len(), 1, "{touching:?}");
    assert!((touching.open[0].from..touching.open[0].to).contains(&std::f64::consts::PI));
}
