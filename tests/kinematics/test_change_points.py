"""Where branches meet: every way out of a change point is followed, each arc once, and smooth ones are one circuit."""

import itertools
import math
from collections.abc import Sequence
from math import pi, radians
from typing import Any

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.reporting.how_found import how_found

SAMPLES = 96


def planar_rows(*lengths: float) -> sb.Linkage:
    """A planar four-bar by its lengths; the last is the ground."""
    return planar_joints(*lengths)


def planar_joints(*lengths: float) -> sb.Linkage:
    """The same of any number of turning joints."""
    count = len(lengths)
    return sb.from_dh("R" * count, length=list(lengths), twist=[0] * count, offset=[0] * count)


def planar_drawn(*places: tuple[float, float]) -> sb.Linkage:
    return sb.from_axes([{"kind": "R", "at": [x, y, 0.0], "axis": [0, 0, 1]} for x, y in places])


def spherical(*twists: float) -> sb.Linkage:
    """A spherical four-bar by its sides [deg]."""
    return sb.from_dh("RRRR", length=[0] * 4, twist=[radians(t) for t in twists], offset=[0] * 4)


def apart(q: np.ndarray[Any, Any], rows: np.ndarray[Any, Any]) -> Any:
    """How far poses (m, columns) are from the nearest of rows (n, columns), in the column that differs most."""
    return np.abs((rows[:, None] - q[None] + pi) % (2 * pi) - pi).max(axis=2).min(axis=0)


def every_mode_is_on_a_circuit(linkage: sb.Linkage, motion: sb.Motion) -> None:
    rows = np.concatenate([c.q[np.isfinite(c.q).all(axis=1)] for c in motion])
    modes = [linkage.assembly_modes(2 * pi * k / SAMPLES).q for k in range(3, SAMPLES, 4)]
    found = np.concatenate(modes)
    assert len(found)
    assert apart(found, rows).max() < 1e-4


def no_circuit_is_found_twice(motion: sb.Motion) -> None:
    # a circuit along which the input moves by rounding only has no rows between its limits
    rich = [circuit for circuit in motion if len(circuit.q) > 6]
    for one, other in itertools.combinations(rich, 2):
        middle = one.q[[len(one.q) // 3, len(one.q) // 2 + 1]]
        assert apart(middle, other.q).max() > 1e-8


def is_whole(linkage: sb.Linkage) -> sb.Motion:
    motion = linkage.motion(SAMPLES)
    assert motion.motion_type == "change-point"
    assert all(circuit.closed for circuit in motion)
    every_mode_is_on_a_circuit(linkage, motion)
    no_circuit_is_found_twice(motion)
    for point in motion.change_points:
        # the pose closes, and lies on the circuits that are said to meet there
        assert np.abs(linkage.assembly_modes(point.input).residual).max(initial=0.0) < 1e-9
        assert point.ways % 2 == 0
        assert point.circuits
    return motion


FOLDING = {
    "s + l = p + q": planar_rows(1, 2.6, 2.4, 0.8),
    "s + l = p + q in decimals": planar_rows(0.9, 1.9, 1.8, 2.8000000000000003),
    "with two equal lengths": planar_rows(0.3, 2.6, 2.6, 4.9),
    "short coupler": planar_rows(1, 2.1, 0.5, 1.6),
    "long crank": planar_rows(0.5, 1.8, 1.4, 0.9),
    "parallelogram": planar_drawn((0, 0), (0.5, 1), (2.5, 1), (2, 0)),
    "parallelogram by its lengths": planar_rows(2, 1, 2, 1),
    "kite": planar_drawn((0, 0), (1, 1), (3, 0), (1, -1)),
    "rhombus": planar_drawn((0, 0), (1, 2), (3, 3), (2, 1)),
    "square": planar_drawn((0, 0), (0, 1), (1, 1), (1, 0)),
    "rhombus by its lengths": planar_rows(1, 1, 1, 1),
    "right angles on the sphere": spherical(90, 90, 90, 90),
    "spherical parallelogram": spherical(40, 60, 40, 60),
    "spherical s + l = p + q": spherical(30, 70, 60, 40),
}


@pytest.mark.parametrize("name", FOLDING)
def test_every_branch_of_a_linkage_that_folds_is_followed(name: str) -> None:
    is_whole(FOLDING[name])


def test_the_parallelogram_and_the_crossed_one_are_two_circuits_that_meet_twice() -> None:
    motion = is_whole(planar_drawn((0, 0), (0.5, 1), (2.5, 1), (2, 0)))
    assert len(motion.circuits) == 2
    assert [circuit.turns for circuit in motion] == [1, 1]
    assert [(point.circuits, point.ways) for point in motion.change_points] == [((0, 1), 4)] * 2
    # folded flat: the crank, drawn upwards to the right, lies along the ground
    fold = np.arctan2(1, 0.5)
    np.testing.assert_allclose(motion.change_point_inputs, [pi - fold, 2 * pi - fold], atol=1e-9)
    # one keeps opposite sides parallel
    gains = [np.ptp(c.output - c.input) for c in motion]
    assert min(gains) < 1e-9 < 1 < max(gains)


def test_a_folding_four_bar_is_one_circuit_of_two_turns_where_the_branches_change_places() -> None:
    motion = is_whole(planar_rows(1, 2.6, 2.4, 0.8))
    (circuit,) = motion.circuits
    assert circuit.turns == 2
    (point,) = motion.change_points
    assert (point.circuits, point.ways, point.freedoms, point.isolated) == ((0,), 4, 1, False)


def test_a_row_at_a_change_point_has_its_pose_and_no_rates() -> None:
    linkage = planar_drawn((0, 0), (0, 1), (1, 1), (1, 0))
    for circuit in linkage.motion(SAMPLES):
        at = circuit.status == "change-point"
        assert at.sum() == 2
        assert (circuit.residual[at] < 1e-12).all()
        assert np.isfinite(circuit.q).all()
        assert np.isnan(circuit.dq[at]).all()
        assert np.isfinite(circuit.dq[~at]).all()


def rates_agree_with_differences(circuit: sb.Circuit) -> None:
    ok = circuit.status == "ok"
    step = 2 * pi / SAMPLES
    inner = ok[:-2] & ok[1:-1] & ok[2:]
    slopes = (circuit.q[2:] - circuit.q[:-2]) / (2 * step)
    assert np.abs(slopes - circuit.dq[1:-1])[inner].max() < 0.1


def test_rates_run_smoothly_over_a_change_point() -> None:
    for circuit in planar_drawn((0, 0), (0.5, 1), (2.5, 1), (2, 0)).motion(SAMPLES, speed=1.0):
        rates_agree_with_differences(circuit)


def random_grashof(rng: np.random.Generator, unit: float) -> list[float]:
    """Four lengths in multiples of a unit, the longest with the shortest as long as the others together."""
    while True:
        short, *middle = sorted(rng.integers(1, 31, 3).tolist())
        lengths = [short, *middle, sum(middle) - short]
        if lengths[-1] >= middle[-1]:
            return [round(float(x) * unit, 6) for x in rng.permutation(lengths)]


@pytest.mark.parametrize("unit", [0.1, 0.01])
def test_four_bars_that_fold_in_decimals_lose_nothing(unit: float) -> None:
    rng = np.random.default_rng(3)
    for _ in range(60):
        is_whole(planar_rows(*random_grashof(rng, unit)))


def test_beside_a_change_nothing_is_lost_or_found_twice() -> None:
    rng = np.random.default_rng(4)
    for _ in range(80):
        lengths = random_grashof(rng, 0.1)
        lengths[int(rng.integers(4))] += float(rng.choice([-1, 1]) * 10 ** rng.uniform(-13, -5))
        linkage = planar_rows(*lengths)
        motion = linkage.motion(SAMPLES)
        assert all(circuit.closed for circuit in motion), lengths
        every_mode_is_on_a_circuit(linkage, motion)
        no_circuit_is_found_twice(motion)


@pytest.mark.parametrize("off", [1e-9, 1e-10, 0.0, 1e-15, -1e-15])
def test_a_linkage_beside_a_change_is_one_circuit_or_two(off: float) -> None:
    motion = planar_rows(1, 2.5 + off, 2, 1.5).motion(SAMPLES)
    assert len(motion.circuits) in (1, 2)
    close = motion.limits.size > 1 and np.diff(motion.limits).min() < 1e-6
    assert (motion.motion_type == "change-point") == (close or abs(off) < 1e-12)


@pytest.mark.parametrize("near", [3e-10, 1e-8, 8e-7, 1.2e-6, 1e-5, 1e-3])
def test_a_hair_off_a_kite_folded_flat_the_two_limits_of_its_crank_meet(near: float) -> None:
    # the crank of a kite turns fully; coupler and rocker nearly of a length stop it before half a turn, by the law
    # of cosines; the poses at both limits are half a turn of the rocker apart, and no branches meet
    crank, coupler = 0.06, 0.1
    missing = 2 * crank * math.sin(near / 4)
    motion = planar_rows(crank, coupler, coupler - missing, crank).motion(SAMPLES)
    limits = [d.input for c in motion for d in c.dead_centres if d.kind == "input"]
    assert len(limits) == 2
    assert 2 * pi - abs(limits[0] - limits[1]) == pytest.approx(near, rel=1e-4)
    assert (motion.motion_type == "change-point") == (near < 1e-6)
    assert not motion.change_points


# lengths, offsets and twists of a 7R of one circuit, whose output dwells at the input 4.162 rad
DWELLING = (
    (0.336903, 0.892345, 0.01729, -0.727025, 0.194737, -0.966389, 0.636084),
    (-0.359367, -0.79633, -0.701415, 0.657269, 0.812853, -0.630906, 0.996164),
    (2.263844, -1.072052, -2.820381, -2.191352, -0.399461, -1.850302, -1.998414),
)


def test_an_output_that_turns_back_by_a_hair_is_no_change_point() -> None:
    length, offset, twist = DWELLING
    linkage = sb.from_dh("R" * 7, length=length, offset=offset, twist=twist)
    (circuit,) = (motion := linkage.motion(SAMPLES)).circuits
    places = [d for d in circuit.dead_centres if d.kind == "output" and 4.16 < d.input < 4.163]
    assert len(places) == 2
    # a greatest and a least value of the output, with nothing to join
    assert 0 < abs(places[0].output - places[1].output) < 1e-8
    assert motion.motion_type == circuit.motion_type == "double-rocker"


#: Loops of round numbers: joints, lengths, twists [deg], offsets. An upper limit of the input is a lower one, by symmetry.
ROUND = [
    ("RPRRRRR", (0, 2, 1, 0, 1.5, 2, 1.5), (60, -90, 180, -90, 0, 90, 60), (0.5, 0, 1, 0, 0.5, 0, 1)),
    ("RRPRRPR", (1.5, 0, 0.5, 1, 2, 0, 1.5), (45, 0, 90, 180, 120, 0, 180), (1, 0, 0, 1, 0, 0, 0)),
]


@pytest.mark.parametrize(("kinds", "length", "twist", "offset"), ROUND)
@pytest.mark.parametrize("off", [-1e-5, 0, 1e-5])
def test_limits_that_are_equal_by_symmetry_join_nothing(
    kinds: str, length: Sequence[float], twist: Sequence[float], offset: Sequence[float], off: float
) -> None:
    changed = (length[0] + off, *length[1:])
    angles = [radians(t) for t in twist]
    motion = sb.from_dh(kinds, length=changed, twist=angles, offset=offset).motion(SAMPLES)
    ranges = sorted(circuit.input_range for circuit in motion)
    # no circuit comes or goes, nor are two joined
    assert len(ranges) == {"RPRRRRR": 2, "RRPRRPR": 3}[kinds]
    assert off or abs(ranges[-1][0] - ranges[-2][1]) < 1e-9
    assert motion.motion_type == "double-rocker"
    assert not motion.change_points


@pytest.mark.parametrize("crank", [1e-3, 1e-6, 1e-7])
def test_a_crank_that_moves_its_rocker_by_a_hair_stays_a_crank(crank: float) -> None:
    linkage = sb.four_bar(ground=1, crank=crank, coupler=1, rocker=1)
    motion = linkage.motion(SAMPLES)
    assert motion.motion_type == "crank-rocker"
    for circuit in motion:
        low, high = circuit.output_range
        # the rocker's swing between both collinear positions of crank and coupler
        swing = math.acos(0.5 - crank - crank**2 / 2) - math.acos(0.5 + crank - crank**2 / 2)
        assert high - low == pytest.approx(swing, rel=1e-6)


RSSRS_NEAR_AN_ISOLATED_POSE = [
    # their circuits next to it are 4e-8, 2e-7 and 5e-7 rad wide; the last has another circuit
    ("rigid", (0.8609910264585372, -0.4532549689304044, 0.7834402749211726, 1.7711600058888775, 0.20291009344708955, -0.02228775898385682)),
    ("rigid", (-0.8940115863075897, 0.881749560010467, 0.05164177388092317, 2.0520324557174674, 0.9066013200303089, 0.229997292198993)),
    ("change-point", (0.5622559130860667, -0.2808659622127949, 0.905811863260557, 0.2368390894639874, 0.5099652902723408, 0.08310999454473444)),
]  # fmt: skip


@pytest.mark.parametrize(("word", "dimensions"), RSSRS_NEAR_AN_ISOLATED_POSE)
def test_from_an_isolated_pose_a_circuit_may_grow(word: str, dimensions: Sequence[float]) -> None:
    linkage = sb.rssr(**dict(zip(("M", "N", "L1", "L2", "L3", "D"), dimensions, strict=True)))
    motion = linkage.motion(SAMPLES, method="general")
    assert motion.motion_type == word
    # turned over by its idle spin the coupler is in the same pose, of which the closed form knows nothing
    (point,) = motion.change_points
    (known,) = linkage.motion(SAMPLES).change_points
    assert point.isolated
    assert point.input == pytest.approx(known.input, abs=1e-6)


@pytest.mark.parametrize("lengths", [(3, 1, 1, 1), (6, 1, 2, 3), (0.7, 0.1, 0.2, 0.4)])
def test_a_loop_that_closes_stretched_only_is_rigid(lengths: Sequence[float]) -> None:
    linkage = planar_rows(*lengths)
    motion = linkage.motion(36)
    assert motion.motion_type == "rigid"
    assert linkage.mobility().finite == 0
    assert [point.isolated for point in motion.change_points] == [True]
    assert "no motion leads out of it" in sb.report.markdown(motion)


def through_two_lines(rng: np.random.Generator) -> sb.Linkage:
    """Six turning joints whose axes all meet two lines: two freedoms to first order, and none."""
    joints = []
    for _ in range(6):
        on_one = np.array([rng.uniform(-1, 1), 0.0, 0.0])
        on_other = np.array([0.3, rng.uniform(-1, 1), 1.0])
        joints.append({"kind": "R", "at": on_one.tolist(), "axis": (on_other - on_one).tolist()})
    return sb.from_axes(joints)


def test_axes_that_meet_two_lines_do_not_move() -> None:
    rng = np.random.default_rng(5)
    for _ in range(4):
        linkage = through_two_lines(rng)
        assert linkage.mobility().finite == 0
        motion = linkage.motion(36)
        assert motion.motion_type == "rigid"


def test_a_linkage_drawn_flat_has_the_rank_of_the_poses_that_it_moves_through() -> None:
    flat = planar_drawn((0, 0), (1, 0), (3, 0), (2, 0))
    assert (flat.mobility().rank, flat.mobility().finite) == (3, 1)
    assert len(flat.mobility().redundant) == 3
    assert flat.motion(SAMPLES).mobility.rank == 3


def test_two_inputs_are_still_told_from_shaky_loops() -> None:
    five = planar_drawn((0, 0), (0, 1), (1, 1.5), (2, 1), (2, 0))
    assert five.mobility().finite == 2
    assert five.motion(24).motion_type == "two-inputs"


@pytest.mark.parametrize("joints", [5, 6, 7])
def test_loops_with_freedoms_to_spare_are_found_from_their_rows_too(joints: int) -> None:
    """Their modes lie on surfaces, to which no path leads."""
    for lengths, twists in (([1.0], [0.0]), ([0.0], [1.0])):
        loop = sb.from_dh("R" * joints, length=lengths * joints, twist=twists * joints, offset=[0] * joints)
        motion = loop.motion(24)
        assert (motion.motion_type, motion.mobility.finite) == ("two-inputs", joints - 3)
        modes = loop.assembly_modes(0.3)
        assert (modes.completeness, len(modes.q)) == ("searched", 1)
        assert modes.residual.max() < 1e-10


@pytest.mark.parametrize("joints", [5, 6, 7])
def test_longer_loops_that_close_stretched_only_are_rigid(joints: int) -> None:
    lengths = [1.2, 0.7, 2.0, 0.4, 1.1, 0.3][: joints - 1]
    rows = planar_joints(*lengths, round(sum(lengths), 6))
    sides = [radians(x) for x in (20, 15, 30, 10, 25, 12)[: joints - 1]]
    ball = sb.from_dh("R" * joints, length=[0] * joints, twist=[*sides, sum(sides)], offset=[0] * joints)
    uneven = [1.6, 2.6, 2.6, 2.6, 0.9, 0.1][7 - joints :]
    winding = planar_joints(*uneven, round(sum(uneven), 6))
    for loop in (rows, ball, winding):
        motion = loop.motion(24)
        assert (motion.motion_type, loop.mobility().finite) == ("rigid", 0)
        assert [point.isolated for point in motion.change_points] == [True]


def test_a_pose_of_seven_joints_that_stands_alone_is_named() -> None:
    """Seven axes of one linear complex: two complex solutions meet at a single real input, between the seeds."""
    rows = [
        (1.080375407722382, 0.7435869716475731, 1.0124178291036499),
        (-0.6955695458976744, 1.140383463359292, -1.7638707579868298),
        (-0.03101176210029995, 3.0146118304354363, 0.5600664228103199),
        (0.47420567793886637, 1.1380662927529341, 0.07483008418893095),
        (0.09103408364672873, 1.290104465072478, 0.584113153174373),
        (0.15999614637781595, 0.10963734314149463, 3.9078937942737957),
        (-0.6045103358067054, 2.212402633534889, -3.2658255553844255),
    ]
    length, twist, offset = zip(*rows, strict=True)
    loop = sb.from_dh("RRRRRRR", length=length, twist=twist, offset=offset)
    motion = loop.motion(SAMPLES)
    assert (motion.motion_type, motion.mobility.finite) == ("rigid", 0)
    (point,) = motion.change_points
    assert point.isolated
    assert motion.mobility.rank == 5
    assert "no motion leads out of it" in sb.report.markdown(motion)


def sarrus(short: float, long: float) -> sb.Linkage:
    """Two legs of equal links each, which fold flat and on top of themselves."""
    joints = []
    for length, along, axis in ((short, [1, 0, 0], [0, 1, 0]), (long, [0, 1, 0], [1, 0, 0])):
        foot, knee = 0.5 * np.array(along), (0.5 + length) * np.array(along)
        places = [foot, knee + np.array([0, 0, 0.3]), foot + np.array([0, 0, 0.6])]
        joints.append([{"kind": "R", "at": place.tolist(), "axis": axis} for place in places])
    return sb.from_axes(joints[0] + joints[1][::-1])


@pytest.mark.parametrize("long", [1.6, 1.3, 2.5])
def test_a_sarrus_linkage_of_equal_links_passes_the_poses_in_which_it_folds(long: float) -> None:
    """Folded, each leg turns by itself: surfaces of poses, into which the circuits run, and out again."""
    motion = is_whole(sarrus(1.2, long))
    assert len(motion.circuits) == 2
    assert [(p.ways, len(p.circuits), p.freedoms) for p in motion.change_points] == [(2, 1, 2)] * 4
    assert "not followed, begin in 4 of the change points" in how_found(motion)
    assert "there it can also move with 2 freedoms" in sb.report.markdown(motion)


@pytest.mark.parametrize(
    "error",
    [
        *(error for error in (0.0, 1e-11, -1e-11)),
        *(1.7e-9, 1e-5),
        *(pytest.param(error, marks=pytest.mark.proof) for error in (-1e-7, 1e-6, -3e-5)),
    ],
)
def test_six_axes_at_right_angles_or_nearly_so(error: float) -> None:
    """Three motions meet in one pose, one of them with the input at rest, or all but.

    The farther the axes lean the more redundant constraints miss each other by along one of them, from nothing where it begins.
    """
    twists = [-pi / 2, pi / 2 - error, 0] * 2
    motion = is_whole(sb.from_dh("R" * 6, length=[0.5, 1, 0.5] * 2, twist=twists, offset=[-1, 0, 0] * 2))
    assert len(motion.circuits) == (2 if error else 3)
    for circuit in motion:
        assert circuit.closed
        # what comes back has turned as often one way as the other
        for kind in ("input", "output"):
            assert sum(limit.kind == kind for limit in circuit.dead_centres) in (0, 2)


def test_what_moves_but_for_rounding_is_told_to_move_by_mobility_too() -> None:
    """The rows of a folded loop with two idle turns, twists a billionth off: of full rank, but closed all along."""
    rows = [(0, 0, 2), (2, 0, 1), (0, 89.9999999, -1), (1, 89.9999999, 0)] * 2
    lengths, twists, offsets = zip(*rows, strict=True)
    loop = sb.from_dh("R" * 8, length=lengths, twist=[radians(twist) for twist in twists], offset=offsets)
    motion = is_whole(loop)
    assert len(motion.circuits) == 2
    assert motion.search.unfollowed == 0
    assert motion.mobility.finite == loop.mobility().finite == 1


@pytest.mark.parametrize("error", [0.0, 1e-9, -1e-9, 1e-8])
def test_a_motion_leads_over_poses_where_redundant_constraints_miss_each_other(error: float) -> None:
    """A folded loop with two idle turns, twists off by so many degrees: two pairs of its joints turn against each other, through
    poses of rank four in which two constraints are redundant and no longer meet."""
    rows = [(-1, -90, 0), (0, 0, 0), (0.5, 90, 0), (-1, error, 1)] * 2
    lengths, twists, offsets = zip(*rows, strict=True)
    loop = sb.from_dh("R" * 8, length=lengths, twist=[radians(twist) for twist in twists], offset=offsets)
    motion = is_whole(loop)
    assert motion.search.unfollowed == 0
    assert [circuit.turns for circuit in motion] == [1, 1, 1]
    passed = [point.input for point in motion.change_points if point.ways == 2]
    np.testing.assert_allclose(np.sort(passed), [-2 * pi / 3, 2 * pi / 3], atol=1e-6)


def test_a_walk_into_a_change_point_from_afar_is_not_told_beside_the_whole_motion() -> None:
    """Two slides run to infinity on both sides of a pose in which three motions meet; at right angles but for 1.7e-9."""
    row = [("R", 1, 90, 0.5, 0), ("R", 2, 90, 1, 0), ("P", 10, 89.9999999, 0, -90)] * 2
    kinds, length, twist, offset, angle = zip(*row, strict=True)
    loop = sb.from_dh(
        "".join(kinds),
        length=length,
        twist=[radians(t) for t in twist],
        offset=offset,
        angle=[radians(a) for a in angle],
    )
    for drive, count in (("theta_1", 1), ("theta_2", 1), ("theta_3", 3)):
        motion = loop.motion(24, input=drive)
        assert len(motion.circuits) == count
        (point,) = motion.change_points
        assert (point.circuits, point.ways) == (tuple(range(count)), 6)
        for circuit in motion:
            low, high = circuit.input_range or (-np.inf, np.inf)
            assert low < point.input < high


def planar_with_balls(*places: tuple[float, float]) -> sb.Linkage:
    """An RSSR whose axes are parallel: a planar four-bar, the balls in its plane."""
    at = [[x, y, 0.0] for x, y in places]
    kinds = [{"kind": "R", "axis": [0, 0, 1]}, {"kind": "S"}, {"kind": "S"}, {"kind": "R", "axis": [0, 0, 1]}]
    return sb.from_axes([kind | {"at": place} for kind, place in zip(kinds, at, strict=True)])


@pytest.mark.parametrize("method", ["auto", "general"])
def test_closed_form_and_general_way_tell_the_same_poses(method: Any) -> None:
    motion = planar_with_balls((0, 0), (0.5, 1), (2.5, 1), (2, 0)).motion(SAMPLES, method=method)
    assert motion.motion_type == "change-point"
    fold = np.arctan2(1, 0.5)
    np.testing.assert_allclose(motion.change_point_inputs, [pi - fold, 2 * pi - fold], atol=1e-7)
    assert [(len(point.circuits), point.ways) for point in motion.change_points] == [(2, 4)] * 2


def test_axes_on_one_regulus_are_shaky() -> None:
    """Six lines of one family of a hyperboloid have three infinitesimal freedoms; near closing is no motion."""
    rng = np.random.default_rng(5)
    for _ in range(8):
        a, b, c = rng.uniform(0.5, 2, 3)
        turn = rng.uniform(0, 2 * np.pi, 6)
        at = np.stack([a * np.cos(turn), b * np.sin(turn), 0 * turn], axis=1)
        along = np.stack([-a * np.sin(turn), b * np.cos(turn), c + 0 * turn], axis=1)
        loop = sb.from_axes(
            [{"kind": "R", "at": p.tolist(), "axis": s.tolist()} for p, s in zip(at, along, strict=True)]
        )
        mobility = loop.mobility()
        assert (mobility.finite, mobility.rank, loop.motion(24).motion_type) == (0, 3, "rigid")


@pytest.mark.parametrize(
    ("linkage", "stroke"),
    [
        # stretched at the angles of the triangles 3 3 4 and 7 5 6; folded they pass the change point
        (planar_rows(1, 2, 3, 4), 2 * (pi - math.acos(2 / 3))),
        (planar_rows(3, 4, 5, 6), 2 * (pi - math.acos(5 / 7))),
        # the crank is as much longer than the rod as the slider is off
        (sb.slider_crank(crank=40, rod=100, offset=60), pi + 2 * math.asin(3 / 7)),
    ],
)
def test_the_time_ratio_of_a_circuit_of_two_turns_is_that_of_its_strokes(linkage, stroke):
    circuit = linkage.motion(72).circuits[0]
    assert circuit.turns == 2
    assert circuit.time_ratio == pytest.approx((4 * pi - stroke) / stroke, rel=1e-12)


@pytest.mark.parametrize(
    ("lengths", "value"), [((1, 1, 1, 1), 0.0), ((40, 100, 40, 100), 0.0), ((40, 100, 40, 100), pi)]
)
def test_a_pose_in_which_two_modes_are_one_is_listed_once(lengths, value):
    assert len(planar_rows(*lengths).assembly_modes(value)) == 1


def test_modes_at_the_limit_of_an_input_are_one_pose_and_beside_it_two():
    linkage = planar_rows(70, 30, 50, 60)
    (limit, *_) = linkage.motion(72).limits
    counts = [len(linkage.assembly_modes(limit + by)) for by in (-1e-3, -1e-15, 0.0, 1e-15, 1e-3)]
    assert sorted(counts[::4]) == [0, 2]
    assert max(counts[1:4]) <= 1


def test_inputs_of_change_points_are_within_a_turn_and_poses_at_one_input_are_counted() -> None:
    """Rounding leaves a change point at 0 a hair short of a full turn."""
    parallelogram = sb.four_bar(1, 2, 1, 2).motion(24)
    np.testing.assert_allclose(parallelogram.change_point_inputs, [0, pi], atol=1e-12)
    assert "input 0.000\N{DEGREE SIGN}  180.000\N{DEGREE SIGN}:" in repr(parallelogram)
    # the rhombus folded at 0 turns about one point, and at 180 degrees is stretched
    assert "input 0.000\N{DEGREE SIGN} (2 poses)  180.000\N{DEGREE SIGN}:" in repr(
        sb.four_bar(1, 1, 1, 1).motion(24)
    )


def test_an_output_that_rests_has_one_place_and_not_a_range() -> None:
    words = repr(sb.four_bar(1, 1, 1, 1).motion(24))
    assert "theta_4 at rest at 180.000\N{DEGREE SIGN}" in words
    # a slider-crank of equal links: the slider rests or goes to 0, up to rounding
    words = repr(sb.slider_crank(40, 40).motion(24))
    assert "slider [mm] at rest at -80" in words
    assert "slider [mm] -160 to 0" in words
