//! The numerical work on loops with known answers.

use crate::loops::circuits::curve::{self, Curve};
use crate::loops::circuits::join;
use crate::loops::circuits::{follow, walked_again};
use crate::loops::equation::chain::{Chain, Configuration};
use crate::loops::equation::closed::{Closed, Joint};
use crate::loops::equation::dense::{Columns, singular_values};
use crate::loops::equation::rotations::{rotation, squared_up};
use crate::loops::modes::finder::ModeFinder;
use crate::loops::modes::many_starts::same;
use crate::loops::modes::starts::random_pose;
use crate::loops::motions::passes::Passes;
use crate::random::Random;
use crate::rigid::Pose;

/// The direction in which a closed configuration can move.
fn direction(chain: &Chain, at: &Configuration) -> Columns {
    let (_, vectors) = singular_values(&chain.screws(at));
    std::array::from_fn(|c| vectors[6][c])
}

/// A loop of turning joints by Denavit and Hartenberg's lengths, offsets and twists.
fn loop_of(length: &[f64], offset: &[f64], twist_deg: &[f64]) -> Chain {
    let size: f64 = length.iter().chain(offset).map(|x| x.abs()).sum();
    let links = (0..length.len())
        .map(|i| {
            let (s, c) = twist_deg[i].to_radians().sin_cos();
            Pose {
                rotation: [[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]],
                translation: [length[i] / size, 0.0, offset[i] / size],
            }
        })
        .collect();
    Chain::new(vec![Joint::Turn; length.len()], links)
}

/// The 7R paper's.
fn seven_r() -> Chain {
    loop_of(
        &[45.0, 15.0, 100.0, -115.0, 10.0, 35.0, 35.0],
        &[70.0, 10.0, 10.0, 10.0, 10.0, 10.0, -60.0],
        &[80.0, -95.0, 0.0, 0.0, -75.0, 80.0, 150.0],
    )
}

/// A loop of seven axes anywhere.
fn general_loop(random: &mut Random) -> Chain {
    let mut links: Vec<Pose> = (0..6).map(|_| random_pose(random)).collect();
    let all = links.iter().fold(Pose::STILL, |a, b| a.then(b));
    links.push(all.inverse());
    Chain::new(vec![Joint::Turn; 7], links)
}

#[test]
fn the_loop_of_liu_and_zhu_has_sixteen_modes() {
    let chain = loop_of(
        &[0.4, 0.3, 1.0, 0.0, 1.5, 0.0, 0.7090433494384545],
        &[-0.189116062654422, 0.0, 0.0, 0.2, 0.0, 0.0, 0.1956089470001161],
        &[50.0, 90.0, 1.0, 90.0, 1.0, 90.0, 35.107829405198316],
    );
    let modes = ModeFinder::new(&chain, 0)
        .at(11.557058720012146_f64.to_radians())
        .modes;
    assert_eq!(modes.len(), 16);
}

#[test]
fn the_paper_s_loop_has_eight_solutions_all_of_them_real() {
    let chain = seven_r();
    let finder = ModeFinder::new(&chain, 0);
    assert_eq!(finder.complex_count(), Some(8));
    for k in 0..12 {
        assert_eq!(finder.at(0.5 * f64::from(k)).modes.len(), 8);
    }
}

#[test]
fn general_loops_have_sixteen_solutions_and_an_even_number_of_real_ones() {
    let mut random = Random(77);
    for _ in 0..40 {
        let chain = general_loop(&mut random);
        let finder = ModeFinder::new(&chain, 0);
        assert_eq!(finder.complex_count(), Some(16));
        let modes = finder.at(0.0).modes;
        assert!(modes.len().is_multiple_of(2) && !modes.is_empty());
    }
}

#[test]
fn a_planar_four_bar_that_leans_has_its_modes_while_it_agrees_and_reports_how_far_others_are_open_after() {
    let modes_and_open_by = |lean: f64| {
        let chain = loop_of(
            &[1.0, 2.0, 2.0, 3.5],
            &[0.0; 4],
            &[lean.to_degrees(), 0.0, 0.0, 0.0],
        );
        let finder = ModeFinder::new(&chain, 0);
        // half a turn on: the crank lies along the ground
        let rough = finder.around(4, None).0.swap_remove(2);
        let polished = finder.polished(&rough);
        (polished.modes.len(), polished.open_by)
    };
    for lean in [0.0, 1e-13, 1e-11, 1e-10, -5e-10] {
        assert_eq!(modes_and_open_by(lean), (2, vec![]));
    }
    for lean in [2e-9, 1e-7, -1e-6_f64] {
        let (modes, open_by) = modes_and_open_by(lean);
        assert_eq!((modes, open_by.len()), (0, 2));
        // the axes fail to close by the angle itself, and nothing can make up for it
        assert!(
            open_by
                .iter()
                .all(|m| (0.999 * lean.abs()..2.0 * lean.abs()).contains(m)),
            "{open_by:?}"
        );
    }
}

#[test]
fn each_circuit_of_the_paper_s_loop_closes_after_one_turn() {
    let chain = seven_r();
    for mode in ModeFinder::new(&chain, 0).at(0.3).modes {
        let curve = follow::follow(&chain, &[(mode, direction(&chain, &mode))], &[]).swap_remove(0);
        assert!(curve.is_closed());
        let gained = curve.nodes[curve.nodes.len() - 1].at.values[0] - mode.values[0];
        assert!((gained.abs() - std::f64::consts::TAU).abs() < 1e-12);
    }
}

#[test]
fn rows_side_by_side_are_the_rows_solved_singly() {
    let chain = seven_r();
    for mode in ModeFinder::new(&chain, 0).at(0.3).modes {
        let curve = follow::follow(&chain, &[(mode, direction(&chain, &mode))], &[]).swap_remove(0);
        let passes = Passes::new(&chain, curve, 0).unwrap();
        for row in passes.rows::<Vec<_>>(0.0, 0.01) {
            let single = passes.row(0, row.at.values[0], &[1.0, 0.0, 0.0]).unwrap();
            for order in 0..3 {
                for c in 0..7 {
                    let (a, b) = (row.rates[order][c], single.rates[order][c]);
                    assert!((a - b).abs() < 1e-11 * (1.0 + a.abs()), "{order} {c} {a} {b}");
                }
            }
            // the inverse is that of a place very near
            assert!((row.condition / single.condition - 1.0).abs() < 1e-2);
        }
    }
}

#[test]
fn modes_from_the_circle_of_complex_inputs_are_those_found_singly() {
    let mut random = Random(5);
    let mut chains: Vec<Chain> = (0..12).map(|_| general_loop(&mut random)).collect();
    chains.push(seven_r());
    for chain in &chains {
        for input in [0, 3] {
            let finder = ModeFinder::new(chain, input);
            for (k, rough) in finder.around(24, None).0.iter().enumerate() {
                let singly = finder.at(std::f64::consts::TAU * k as f64 / 24.0).modes;
                let modes = finder.polished(rough).modes;
                assert_eq!(modes.len(), singly.len(), "value {k}");
                assert!(modes.iter().zip(&singly).all(|(a, b)| same(chain, a, b)));
            }
        }
    }
}

/// Seven axes of which some neighbours are parallel or meet, in the frame of the first.
fn special_loop(random: &mut Random, parallel: &[usize], meeting: &[usize]) -> Chain {
    let mut axes: Vec<Pose> = (0..7).map(|_| random_pose(random)).collect();
    for &k in parallel {
        axes[k].rotation = axes[parallel[0]].rotation;
    }
    for &k in meeting {
        axes[k].translation = axes[meeting[0]].translation;
    }
    let link = |k: usize| axes[k].inverse().then(&axes[(k + 1) % 7]);
    Chain::new(vec![Joint::Turn; 7], (0..7).map(link).collect())
}

/// Parallel and meeting axes, an input that is none of them, and how many solutions such a loop has.
const SPECIAL: [(&[usize], &[usize], usize, usize); 9] = [
    (&[], &[], 0, 16),
    (&[2, 3], &[], 0, 16),
    (&[2, 3, 4], &[], 0, 8),
    (&[4, 5, 6], &[], 0, 8),
    (&[], &[2, 3, 4], 0, 8),
    (&[], &[4, 5, 6], 0, 8),
    (&[], &[0, 1, 6], 3, 8),
    (&[1, 2], &[4, 5, 6], 0, 8),
    (&[1, 2, 3], &[4, 5, 6], 0, 0),
];

#[test]
fn special_loops_have_their_solutions_from_starts_of_their_class_and_from_general_ones_alike() {
    let mut random = Random(21);
    for (parallel, meeting, input, count) in SPECIAL {
        for _ in 0..4 {
            let chain = special_loop(&mut random, parallel, meeting);
            let special = ModeFinder::new(&chain, input);
            assert_eq!(special.complex_count(), Some(count), "{parallel:?} {meeting:?}");
            let general = ModeFinder::from_general_starts(&chain, input);
            let (a, b) = (special.at(0.0).modes, general.at(0.0).modes);
            assert_eq!(a.len(), b.len(), "{parallel:?} {meeting:?}");
            assert!(a.iter().zip(&b).all(|(a, b)| same(&chain, a, b)));
            let once = special.once(0.0).0.modes;
            assert_eq!(once.len(), a.len());
        }
    }
}

#[test]
fn a_loop_beside_a_special_one_has_the_solutions_of_a_general_one() {
    let mut random = Random(22);
    for off in [0.0, 1e-15, 1e-6, 1e-3] {
        let mut chain = special_loop(&mut random, &[2, 3, 4], &[]);
        let lean = Pose::turning(squared_up(&rotation([off, 0.0, 0.0])));
        chain.links[3] = chain.links[3].then(&lean);
        chain.links[6] = chain.links[..6]
            .iter()
            .fold(Pose::STILL, |a, b| a.then(b))
            .inverse();
        let count = ModeFinder::new(&chain, 0).complex_count();
        // those of a millionth are too far off to be followed to
        let expected: &[usize] = if off < 1e-13 { &[8] } else { &[8, 16] };
        assert!(expected.contains(&count.unwrap()), "{off}: {count:?}");
        let general = ModeFinder::from_general_starts(&chain, 0);
        let (a, b) = (ModeFinder::new(&chain, 0).at(0.0).modes, general.at(0.0).modes);
        assert!(a.len() == b.len() && a.iter().zip(&b).all(|(a, b)| same(&chain, a, b)));
    }
}

/// Whether a closed configuration is a place of a curve.
fn passes(chain: &Chain, curve: &Curve, at: &Configuration) -> bool {
    let mut nodes = curve.nodes.iter();
    nodes.any(|n| curve::passes_through(chain, n, at).is_some())
}

#[test]
fn curves_joined_from_pieces_are_those_followed_whole_in_either_direction() {
    let mut random = Random(9);
    let mut chains: Vec<Chain> = (0..8).map(|_| general_loop(&mut random)).collect();
    chains.push(seven_r());
    let mut compared = 0;
    for chain in &chains {
        let finder = ModeFinder::new(chain, 0);
        let modes: Vec<Configuration> = (0..6).flat_map(|k| finder.at(f64::from(k)).modes).collect();
        let joined = join::closed_curves(chain, &modes);
        for mode in &modes {
            let whole = follow::follow(chain, &[(*mode, direction(chain, mode))], &[]).swap_remove(0);
            let through: Vec<&Curve> = joined.iter().filter(|c| passes(chain, c, mode)).collect();
            if !whole.is_closed() {
                assert!(through.is_empty());
                continue;
            }
            assert_eq!(through.len(), 1);
            compared += 1;
            let gained =
                |c: &Curve, k: usize| c.nodes[c.nodes.len() - 1].at.values[k] - c.nodes[0].at.values[k];
            let other = walked_again::reversed(chain, through[0]).unwrap();
            let sign = if (0..7).all(|k| (gained(&whole, k) - gained(through[0], k)).abs() < 1e-9) {
                1.0
            } else {
                -1.0
            };
            for k in 0..7 {
                assert!((gained(&whole, k) - sign * gained(through[0], k)).abs() < 1e-9);
                assert!((gained(&other, k) + gained(through[0], k)).abs() < 1e-9);
            }
            for node in &whole.nodes {
                assert!(passes(chain, through[0], &node.at) && passes(chain, &other, &node.at));
            }
        }
    }
    assert!(compared > 50);
}
