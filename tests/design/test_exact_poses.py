"""Four-bars through poses of a plane and orientations: their number, known linkages again, special tasks."""

import contextlib
import io
import math
import re

import numpy as np
import pytest

import sevenbar as sb
from exact_tasks import coupler_poses, lines_of, random_planar, random_turns, worst_miss
from places import DOCS
from sevenbar.design.exact import planar_poses, spherical_orientations
from sevenbar.errors import RequestError
from sevenbar.kinematics.loop.rigid import about, inverse, pose, zyx_turns

FIVE = [(0, 0, 0), (10, 0, 0.3), (20, 0, 0.7), (25, 0, 1.2), (40, 0, 1.4)]


def displaced(poses):
    """Displacements from the first of rows x, y, angle."""
    places = [(x, y, 0.0) for x, y, _ in poses]
    there = pose(about(2, np.array([a for *_, a in poses])), places)
    return there @ inverse(there[0])


@pytest.mark.parametrize("seed", range(8))
def test_five_planar_poses_have_four_dyads_and_every_pair_takes_the_poses(seed):
    poses = random_planar(5, seed)
    found = planar_poses(poses)
    assert (found.theory, found.found, found.complete) == (4, 4, True)
    assert found.real in (0, 2, 4)
    assert len(found.answers) == found.real * (found.real - 1)
    assert len(found.assemblable) == len(found.answers)
    for answer in found.answers:
        assert answer.error < 1e-13
        assert worst_miss(answer, displaced(poses)) < 1e-7


def test_a_hundred_random_planar_tasks_are_complete():
    counts = [planar_poses(random_planar(5, seed)) for seed in range(100)]
    assert all(found.complete and found.real in (0, 2, 4) for found in counts)
    assert max(a.error for found in counts for a in found.answers) < 1e-9
    # all kinds come
    assert {found.real for found in counts} == {0, 2, 4}


def test_a_known_four_bar_is_found_again_without_defects():
    rng, done = np.random.default_rng(5), 0
    while done < 20:
        crank, coupler, rocker, ground = rng.uniform(20, 60), *rng.uniform(70, 120, 2), rng.uniform(80, 130)
        linkage = sb.four_bar(crank, coupler, rocker, ground)
        circuit = linkage.motion(90).circuits[0]
        if not circuit.goes_round:
            continue
        done += 1
        rows = np.sort(rng.choice(60, 5, replace=False))
        frames = coupler_poses(circuit, rows)
        angle = zyx_turns(frames[:, :3, :3])[:, 0]
        found = planar_poses(np.column_stack([frames[:, :2, 3], angle]))
        assert found.complete
        # driven by the crank about the origin, its other pivot on the ground at x = ground
        pivots = [lines_of(answer)[0] for answer in found.answers]
        off = [max(np.abs(p[0]).max(), np.abs(p[3] - [ground, 0, 0]).max()) for p in pivots]
        best = int(np.argmin(off))
        assert off[best] < 1e-6 * ground
        assert found.answers[best].fault is None


def test_places_on_a_line_have_a_slider_for_a_crank():
    found = planar_poses(FIVE)
    assert (found.complete, found.sliders) == (True, 1)
    sliding = [a for a in found.answers if a.linkage.kind in ("PRRR", "RRRP")]
    assert len(sliding) == 2 * (found.real - 1)
    for answer in sliding:
        assert worst_miss(answer, displaced(FIVE)) < 1e-7


def test_the_rod_of_a_slider_crank_has_its_slider_again():
    circuit = sb.slider_crank(40, 140, 20).motion(90).circuits[0]
    frames = coupler_poses(circuit, np.array([0, 7, 15, 22, 33]))
    found = planar_poses(np.column_stack([frames[:, :2, 3], zyx_turns(frames[:, :3, :3])[:, 0]]))
    assert found.complete
    assert found.sliders == 1
    (slider,) = (dyad for dyad in found.dyads if dyad.kind == "PR")
    assert np.abs(slider.ground.axis) == pytest.approx([1, 0, 0], abs=1e-9)
    assert slider.ground.at[1] == pytest.approx(20, abs=1e-7)
    # the crank about the origin is another
    cranks = [np.abs(dyad.ground.at).max() for dyad in found.dyads if dyad.kind == "RR"]
    assert min(cranks) < 1e-7


def test_squares_that_fold_turn_about_a_hinge():
    circuit = sb.four_bar(50, 50, 50, 50).motion(90).circuits[0]
    frames = coupler_poses(circuit, np.array([0, 7, 15, 22, 33]))
    with pytest.raises(RequestError, match=r"turns about one point, \(0, 0\), and a hinge there"):
        planar_poses(np.column_stack([frames[:, :2, 3], zyx_turns(frames[:, :3, :3])[:, 0]]))


def test_defects_are_told_apart():
    found = planar_poses(FIVE)
    assert set(found.faults) <= {"circuit", "dead centre", "order"}
    assert sum(found.faults.values()) + len(found.defect_free) == len(found.answers)
    assert "free of defects" in repr(found)


def test_coordinates_far_away_and_tiny_ones_change_nothing():
    poses = np.array([(0, 0, 0), (5, 3, 0.3), (9, 8, 0.5), (15, 9, 0.9), (22, 8, 1.4)])
    near = planar_poses(poses)
    far = planar_poses(poses + np.array([1e5, -1e5, 0.0]))
    tiny = planar_poses(poses * [1e-6, 1e-6, 1.0])
    for one, moved, small in zip(near.answers, far.answers, tiny.answers, strict=True):
        assert lines_of(moved)[0] - [1e5, -1e5, 0] == pytest.approx(lines_of(one)[0], rel=1e-6, abs=1e-6)
        assert 1e6 * lines_of(small)[0] == pytest.approx(lines_of(one)[0], rel=1e-9)


def test_three_and_four_poses_have_families():
    for count in (3, 4):
        found = planar_poses(FIVE[:count], samples=8)
        assert (found.theory, found.complete, found.real) == (None, False, 8)
        assert len(found.answers) == 8
        assert max(worst_miss(a, displaced(FIVE[:count])) for a in found.answers) < 1e-7
    again = planar_poses(FIVE[:4], samples=8, seed=1)
    assert lines_of(again.answers[0])[0] != pytest.approx(lines_of(planar_poses(FIVE[:4]).answers[0])[0])


def test_chosen_pivots_of_three_poses_lie_on_the_linkage():
    found = planar_poses(FIVE[:3], moving=[(0, 0), (10, 5)])
    # the first lies on a line through the places: a slider
    assert (found.real, found.sliders, len(found.answers)) == (2, 1, 2)
    at, _ = lines_of(found.answers[0])
    assert at[1, :2].tolist() == pytest.approx([0, 0])
    assert at[2, :2].tolist() == pytest.approx([10, 5])


@pytest.mark.parametrize(
    ("poses", "said"),
    [
        (
            [(0, 0, 0), (1, 0, 0.1), (2, 0, 0.2), (1, 0, 0.1), (3, 1, 0.5)],
            r"poses\[3\]: is the same as poses\[1\]",
        ),
        ([(0, 0, 0), (1, 0, 0), (2, 1, 0), (3, 3, 0), (4, 2, 0)], "all have the same angle"),
        ([(math.cos(a), math.sin(a), a) for a in (0, 0.3, 0.7, 1.0, 1.5)], r"one point, \(.*a hinge there"),
        (
            [(0, 0, 0), (10, 0, math.pi / 2), (10, 10, math.pi), (0, 10, -math.pi / 2), (5, 5, 0)],
            "infinitely many dyads",
        ),
        ([(0, 0, 0), (1, 0, 0.1)], "2 are given; give 3 to 5"),
        (
            [(0, 0, 0), (1, 0, 0.1), (2, 0, math.nan)],
            r"poses\[2, 2\]: nan is not a finite number; give a finite one",
        ),
        ([1, 2, 3], r"an array of shape \(3,\) does not fit"),
        ([["a", 2, 3]], "is not an array of numbers"),
    ],
)
def test_planar_tasks_that_are_none_say_so(poses, said):
    with pytest.raises(RequestError, match=said):
        planar_poses(poses)


@pytest.mark.parametrize("seed", range(6))
def test_five_orientations_have_six_dyads_and_every_pair_takes_them(seed):
    turns = random_turns(5, seed)
    found = spherical_orientations(turns)
    assert (found.theory, found.found) == (6, 6)
    assert found.real in (0, 2, 4, 6)
    assert len(found.answers) == len(found.assemblable) == found.real * (found.real - 1)
    wanted = pose(turns @ turns[0].T)
    assert max([worst_miss(a, wanted) for a in found.answers[:6]], default=0.0) < 1e-7
    assert max([a.error for a in found.answers], default=0.0) < 1e-12


@pytest.mark.parametrize("tasks", [30, pytest.param(100, marks=pytest.mark.proof)])
def test_random_spherical_tasks_are_complete(tasks):
    counts = [spherical_orientations(random_turns(5, seed)) for seed in range(tasks)]
    assert all(found.complete and found.real in (0, 2, 4, 6) for found in counts)
    assert max(a.error for found in counts for a in found.answers) < 1e-9
    assert {2, 4, 6} <= {found.real for found in counts}


def test_a_known_spherical_four_bar_is_found_again_without_defects():
    rng, done = np.random.default_rng(2), 0
    while done < 20:
        arcs = rng.uniform(0.3, 0.6), rng.uniform(1.1, 1.5), rng.uniform(0.9, 1.4), rng.uniform(1.2, 1.5)
        linkage = sb.spherical_four_bar(*arcs)
        circuit = linkage.motion(90).circuits[0]
        if not circuit.goes_round:
            continue
        done += 1
        rows = np.sort(rng.choice(60, 5, replace=False))
        found = spherical_orientations(circuit.link_motion(2).rotation[rows])
        assert found.complete
        off = []
        for answer in found.answers:
            axes = lines_of(answer)[1]
            cosines = np.abs((axes * np.roll(axes, -1, axis=0)).sum(axis=1))
            off.append(np.abs(cosines - np.abs(np.cos(arcs))).max())
        best = int(np.argmin(off))
        assert off[best] < 1e-6
        assert found.answers[best].fault is None


@pytest.mark.parametrize(
    ("turns", "said"),
    [
        ([about(2, x) for x in (0, 0.3, 0.6, 0.9, 1.2)], r"about one direction, \(0, 0, 1\)"),
        ([about(2, x) for x in (0, 0.3, 0.6, 0.3, 1.2)], r"orientations\[3\]: is the same"),
        ([np.eye(3), *(about(i, math.pi) for i in range(3)), about(1, 0.5)], "infinitely many dyads"),
        ([np.diag([1.0, 1, -1])] * 5, "it mirrors"),
        ([np.eye(3) * 2] * 5, "is no rotation"),
        ([np.eye(3)] * 6, "6 are given"),
    ],
)
def test_orientations_that_are_none_say_so(turns, said):
    with pytest.raises(RequestError, match=said):
        spherical_orientations(turns)


def test_right_angles_of_a_cube_have_answers():
    turns = [
        np.eye(3),
        about(2, math.pi / 2),
        about(0, math.pi / 2),
        about(1, math.pi / 2),
        about(2, math.pi),
    ]
    found = spherical_orientations(turns)
    assert (found.complete, found.real) == (True, 2)
    assert max(a.error for a in found.answers) < 1e-13


def test_the_example_of_the_page_prints_what_its_comments_say():
    page = (DOCS / "synthesis.md").read_text(encoding="utf-8")
    blocks = re.findall(r"```python\n(.*?)```", page, flags=re.DOTALL)
    (code,) = (block for block in blocks if "planar_poses" in block)
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(code, {})
    assert printed.getvalue().splitlines() == re.findall(r"print\(.*\)  # (.*)", code)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        # the first pivot is the pole of a quarter turn, and so at one place in two poses
        (
            lambda: planar_poses(
                [(0, 0, 0), (0, 0, math.pi / 2), (3, 1, math.pi)], moving=[(0, 0), (1, 0), (0, 1)]
            ),
            r"moving\[0\]: has one place in two of the three poses",
        ),
        (
            lambda: planar_poses([(0, 0, 0), (1, 0, 1), (3, 1, 2)], moving="ab"),
            "moving: 'ab' is not an array of numbers",
        ),
        (
            lambda: planar_poses([(0, 0, 0), (1, 0, 1), (3, 1, 2)], samples=2.5),
            "samples: 2.5 is not a number of members; give 1 to 1048576",
        ),
        (
            lambda: spherical_orientations([np.eye(3), about(0, 1.0), about(1, 1.0)], radius=0),
            "radius: 0 is not a length; give a number > 0",
        ),
    ],
)
def test_what_makes_no_dyad_is_refused(call, message):
    with pytest.raises(RequestError, match=message):
        call()
