"""Every assembly mode of random loops: what a solver reports closes, and what a search finds is reported.

Source: `reference_loops`: the product round the loop, and a search from many random starts that knows nothing
else. A search proves nothing complete, but on random loops one of 300 starts finds what one of 20,000 finds, so
over thousands of loops a method that loses modes is caught. Poses that are singular or nearly so
(`reference_loops.ISOLATED`) are not asked for, nor are loops that move with the input held.
"""

from __future__ import annotations

import json
from collections.abc import Callable

import numpy as np
import pytest

import sevenbar as sb
from evidence.accuracy.reference_loops import (
    ISOLATED,
    Found,
    Loop,
    closed_poses,
    doubles,
    missed,
    nearest,
    searched,
)
from evidence.fuzz.random_loops import (
    OVERCONSTRAINED,
    SPECIAL,
    Case,
    Drawn,
    Rows,
    compound,
    drawn,
    general,
    screws,
    step,
)
from places import REFERENCES
from strategies import wrapped

#: Loops of each family, and starts of the search for each loop.
GENERAL_LOOPS = {"few": 100, "all": 10_000}
SPECIAL_LOOPS = {"few": 12, "all": 1_000}
STARTS = 300
#: Slides are unbounded, and joints of several freedoms make more unknowns: both take more starts.
SPECIAL_STARTS = 500
DEEP_STARTS = 20_000

#: Closure error of a mode: radians, lengths in parts of the longest link.
CLOSURE = 1e-10

#: Poses stiffer than this are modes of one solution each, known to nearly all digits.
FAR_FROM_SINGULAR = 1e-3


@pytest.fixture(
    scope="module",
    params=[
        "few",
        pytest.param("all", marks=pytest.mark.proof),
    ],
)
def amount(request: pytest.FixtureRequest) -> str:
    return request.param


def drawn_by(family: Callable[[np.random.Generator], Case], count: int, *, first: int = 0) -> list[Case]:
    """Cases by seed, so that a failure names the one to draw again."""
    return [family(np.random.default_rng(first + seed)) for seed in range(count)]


def faults(linkage: sb.Linkage, loop: Loop, found: Found, theta: float, *, even: bool) -> list[str]:
    """What is wrong with the modes of one loop."""
    # freedoms that no geometry makes idle move the loop with the input held
    moving = bool(len(found.q)) and loop.idle(found.q[0], 0)[0] > len(linkage.mobility().idle)
    try:
        modes = linkage.assembly_modes(theta)
    except sb.errors.SevenbarError as error:
        # two inputs are asked for by a message; everything else has modes
        return [] if moving else [f"refused: {error}"]
    if moving:
        return []
    wrong = []
    if len(modes):
        closure, reported = loop.errors(modes.q).max(), modes.residual.max() / loop.size
        if not max(closure, reported) <= CLOSURE:
            wrong.append(f"closes to {closure:.1e}, reports {reported:.1e}")
        turns = modes.q[:, loop.periodic]
        if not ((turns > -np.pi - 1e-15) & (turns <= np.pi + 1e-15)).all():
            wrong.append("an angle is not in (-pi, pi]")
        apart = modes.q[:, 0] - theta
        if loop.periodic[0]:
            apart = wrapped(apart)
        if np.abs(apart).max() > 1e-10 * loop.scales[0]:
            wrong.append("the input is not the one asked for")
        if doubles(loop, modes.q):
            wrong.append(f"{doubles(loop, modes.q)} modes are there twice")
    lost = missed(loop, found, modes.q)
    if len(lost):
        wrong.append(f"{len(lost)} of {int(found.isolated.sum())} modes missed, {lost[0].tolist()}")
    if even and len(modes) % 2 and loop.stiffness(modes.q, 0).min() > ISOLATED:
        wrong.append(f"{len(modes)} modes, an odd number")
    return wrong


def check(cases: list[Case], *, starts: int, even: bool = False) -> None:
    linkages = [case.linkage() for case in cases]
    loops = [Loop.of(linkage) for linkage in linkages]
    every = searched(loops, [case.theta for case in cases], starts=starts)
    wrong = [
        f"seed {seed}, {case.kinds}: {what}"
        for seed, (case, linkage, loop, found) in enumerate(zip(cases, linkages, loops, every, strict=True))
        for what in faults(linkage, loop, found, case.theta, even=even)
    ]
    assert not wrong, "\n".join(wrong)
    # the search itself finds something in most loops
    assert sum(bool(found.isolated.any()) for found in every) > len(cases) / 2


def test_general_loops_close_in_even_numbers_of_modes_and_none_is_missing(amount: str) -> None:
    check(drawn_by(general, GENERAL_LOOPS[amount]), starts=STARTS, even=True)


@pytest.mark.parametrize("loops", [12, pytest.param(40, marks=pytest.mark.proof)])
def test_none_is_missing_in_a_search_of_many_more_starts(loops: int) -> None:
    check(drawn_by(general, loops, first=50_000), starts=DEEP_STARTS, even=True)


@pytest.mark.parametrize("family", SPECIAL.values(), ids=SPECIAL.keys())
def test_no_mode_of_special_geometry_is_missing(
    family: Callable[[np.random.Generator], Case], amount: str
) -> None:
    check(drawn_by(family, SPECIAL_LOOPS[amount]), starts=SPECIAL_STARTS)


@pytest.mark.parametrize("family", OVERCONSTRAINED.values(), ids=OVERCONSTRAINED.keys())
def test_no_mode_of_overconstrained_loops_is_missing(
    family: Callable[[np.random.Generator], Case], amount: str
) -> None:
    check(drawn_by(family, SPECIAL_LOOPS[amount] // 4 + 8), starts=SPECIAL_STARTS)


@pytest.mark.parametrize("family", [general, screws, drawn])
def test_the_result_says_how_complete_it_is(
    family: Callable[[np.random.Generator], Case],
) -> None:
    for case in drawn_by(family, 20):
        # a screw as the input is a given displacement; any other makes equations that are not algebraic
        want = "searched" if "H" in case.kinds[1:] else "algebraic"
        assert case.linkage().assembly_modes(case.theta).completeness == want


def test_two_links_between_balls_spin_together() -> None:
    """Eight freedoms, one of them idle: the hinge between the balls is carried round and does not turn."""
    for seed in range(5):
        linkage = compound(np.random.default_rng(seed), "RSRS").linkage()
        loop = Loop.of(linkage)
        count, _, moved = loop.idle(np.zeros(loop.count), 0)
        assert count == len(linkage.mobility().idle) == 1
        assert moved.tolist() == [False, True, True]
        assert linkage.mobility().finite == 1
        modes = linkage.assembly_modes(0.0)
        assert (len(modes), modes.completeness) == (2, "algebraic")
        assert loop.errors(modes.q).max() < 1e-12


def test_the_sixteen_modes_of_liu_and_zhu_are_all_there() -> None:
    reference = json.loads((REFERENCES / "seven_r_sixteen_modes.json").read_text(encoding="utf-8"))
    loop = reference["loop"]
    linkage = sb.from_dh(
        "RRRRRRR", length=loop["length"], twist=np.radians(loop["twist_deg"]), offset=loop["offset"]
    )
    modes = linkage.assembly_modes(np.radians(loop["theta1_deg"]))
    assert len(modes) == 16
    assert Loop.of(linkage).errors(modes.q).max() < 1e-12
    apart = np.degrees(modes.q)[:, None] - np.array(reference["modes_deg"])
    apart = np.abs((apart + 180) % 360 - 180).max(axis=2)
    assert sorted(apart.argmin(axis=1)) == list(range(16))
    assert apart.min(axis=1).max() < 1e-6


# The joint values of the reported modes are those of the description


def test_the_product_of_the_written_rows_is_the_identity() -> None:
    for case in drawn_by(general, 20) + drawn_by(SPECIAL["two slides"], 20):
        assert isinstance(case, Rows)
        sliding = np.array([kind == "P" for kind in case.kinds])
        for q in case.linkage().assembly_modes(case.theta).q:
            product = np.eye(4)
            angle, offset = np.where(sliding, case.angle, q), np.where(sliding, q, case.offset)
            for numbers in zip(angle, offset, case.length, case.twist, strict=True):
                product = product @ step(*numbers)
            size = 1 + np.abs(offset).max() + np.abs(case.length).max()
            assert np.abs(product - np.eye(4)).max() < 1e-10 * size


def test_the_drawn_pose_is_the_mode_with_all_joints_at_zero() -> None:
    cases = [drawn(np.random.default_rng(seed)) for seed in range(10)]
    cases += [compound(np.random.default_rng(seed)) for seed in range(60)]
    compared = 0
    for case in cases:
        linkage = case.linkage()
        loop = Loop.of(linkage)
        q = np.zeros(loop.count)
        held = loop.stiffness(q, 0)[0]
        count, _, idle_links = loop.idle(q, 0)
        # with a freedom that is not idle by its geometry the joint cannot drive
        if held[len(held) - count - 1] < FAR_FROM_SINGULAR or count != len(linkage.mobility().idle):
            continue
        _axes_stand_where_they_were_drawn(case, linkage, loop)
        modes = linkage.assembly_modes(0.0)
        assert nearest(loop, loop.poses(q)[:, ~idle_links], modes.q, idle_links) < 1e-8
        if count == 0 and "S" not in case.kinds:
            apart = modes.q - 2 * np.pi * np.round(modes.q / (2 * np.pi)) * loop.periodic
            assert np.abs(apart).max(axis=1).min() < 1e-8 * loop.size
        compared += 1
    assert compared > 40


def _axes_stand_where_they_were_drawn(case: Drawn, linkage: sb.Linkage, loop: Loop) -> None:
    walk = loop.walk(np.zeros((1, loop.count)))
    axes = walk.axis[:, :, 0] @ loop.base[:3, :3].T
    places = walk.at[:, :, 0] @ loop.base[:3, :3].T + loop.base[:3, 3]
    end = -1
    for joint, after in zip(case.joints, loop.ends, strict=True):
        start, end = end + 1, after
        wanted = joint.get("axes") or [joint["axis"]] * (end - start + 1) if joint["kind"] != "S" else []
        # the last joint moves the ground about its axes reversed
        direction = -1 if joint is case.joints[-1] else 1
        for column, want in zip(range(start, end + 1), wanted, strict=False):
            assert np.abs(axes[column] - direction * want / np.linalg.norm(want)).max() < 1e-12
        if joint["kind"] != "P":
            for column in range(start, end + 1):
                if loop.turns[column]:
                    assert np.linalg.norm(np.cross(places[column] - joint["at"], axes[column])) < 1e-12 * (
                        1 + loop.size
                    )
    assert linkage.kind == case.kinds


def test_the_known_pose_of_a_loop_with_screws_is_found_and_all_close() -> None:
    for seed, case in enumerate(drawn_by(screws, 25)):
        linkage = Drawn(case.joints).linkage()
        loop = Loop.of(linkage)
        q = np.zeros(loop.count)
        modes = linkage.assembly_modes(0.0)
        assert loop.errors(modes.q).max() < CLOSURE, seed
        if loop.stiffness(q, 0)[0].min() > FAR_FROM_SINGULAR:
            still = np.zeros(len(loop.ends) - 1, bool)
            assert nearest(loop, loop.poses(q), modes.q, still) < 1e-8, seed


# Which joint is the input, and where the loop is cut, change nothing


def test_a_mode_is_one_at_the_value_of_any_of_its_joints() -> None:
    rng = np.random.default_rng(4)
    cases = drawn_by(general, 15) + drawn_by(SPECIAL["one slide"], 15) + drawn_by(SPECIAL["right twists"], 15)
    for case in cases:
        linkage = case.linkage()
        loop = Loop.of(linkage)
        still = np.zeros(len(loop.ends) - 1, bool)
        for q in linkage.assembly_modes(case.theta).q:
            column = int(rng.integers(loop.count))
            if loop.stiffness(q, column)[0].min() > FAR_FROM_SINGULAR:
                other = linkage.assembly_modes(q[column], input=linkage.columns[column])
                assert nearest(loop, loop.poses(q), other.q, still) < 1e-8


def test_modes_with_another_joint_as_input_are_all_there() -> None:
    rng = np.random.default_rng(5)
    for case in drawn_by(general, 20) + drawn_by(SPECIAL["two slides"], 20):
        linkage = case.linkage()
        loop = Loop.of(linkage)
        column = int(rng.integers(1, loop.count))
        (found,) = closed_poses([loop], [case.pose[column]], column, starts=SPECIAL_STARTS)
        modes = linkage.assembly_modes(case.pose[column], input=linkage.columns[column])
        assert found.idle.any() or len(missed(loop, found, modes.q)) == 0


def test_cutting_the_loop_elsewhere_gives_the_same_modes() -> None:
    rng = np.random.default_rng(6)
    for case in drawn_by(general, 20):
        assert isinstance(case, Rows)
        shift = int(rng.integers(1, 7))
        moved = case.begun_at(shift)
        here = case.linkage().assembly_modes(case.theta)
        linkage = moved.linkage()
        there = linkage.assembly_modes(case.theta, input=linkage.columns[7 - shift])
        assert len(here) == len(there)
        apart = np.roll(here.q, -shift, axis=1)[:, None] - there.q
        apart = np.abs(wrapped(apart)).max(axis=2)
        assert apart.min(axis=1).max() < 1e-7


def test_the_unit_of_length_changes_no_angle() -> None:
    for case in drawn_by(general, 20):
        assert isinstance(case, Rows)
        grown = Rows(case.kinds, 1e3 * case.length, case.twist, 1e3 * case.offset, case.angle, case.pose)
        here, there = (c.linkage().assembly_modes(case.theta).q for c in (case, grown))
        assert len(here) == len(there)
        apart = np.abs(wrapped(here[:, None] - there)).max(axis=2)
        assert apart.min(axis=1).max() < 1e-7


def test_modes_in_which_a_ball_stands_in_a_gimbal_throughout_are_found_in_any_frame():
    """Of these axes j4 stands still on every circuit, a quarter turn from the drawn pose on one of them."""
    joints = [
        ("R", (0, 1, 0), (0, 1, 0)),
        ("R", (-1, 2, 2), (0, 1, 0)),
        ("S", (-1, 1, -1), None),
        ("R", (1, -1, -1), (0, 0, 1)),
        ("R", (-2, 1, -2), (0, 1, 0)),
    ]
    quarter = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    modes_in_frames = []
    for turn in (np.eye(3), quarter):
        drawn = [
            {"kind": kind, "at": turn @ at} | ({} if axis is None else {"axis": turn @ axis})
            for kind, at, axis in joints
        ]
        linkage = sb.from_axes(drawn)
        motion = linkage.motion(24)
        assert (motion.completeness, len(motion.circuits)) == ("counted", 3)
        modes_in_frames.append(
            [sorted(linkage.assembly_modes(value).q[:, -1]) for value in (-0.93, 0.31, 2.8)]
        )
    assert [len(modes) for modes in modes_in_frames[0]] == [4, 2, 4]
    for one, other in zip(*modes_in_frames, strict=True):
        np.testing.assert_allclose(one, other, atol=1e-9)
