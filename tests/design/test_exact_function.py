"""RSSRs of any twist through pairs of angles: their number, known ones again, special tasks."""

import math

import mpmath
import numpy as np
import pytest

import sevenbar as sb
from sevenbar.arrays import short_way
from sevenbar.design.candidates import Candidate
from sevenbar.design.closure import row_of
from sevenbar.design.exact import function_pairs
from sevenbar.design.exact.closures import SkewRssr, rssr_of
from sevenbar.design.synthesis.function.precision import through
from sevenbar.errors import RequestError

RIGHT = math.pi / 2


def random_pairs(count, seed):
    rng = np.random.default_rng(seed)
    return np.sort(rng.uniform(0, 2.5, count)), rng.uniform(-1, 1, count)


def known(seed):
    """A random RSSR with skew axes that turns fully, as numbers and as a linkage drawn."""
    rng = np.random.default_rng(seed)
    while True:
        r, p, h, k = rng.uniform(0.3, 1), rng.uniform(0.2, 1.5), *rng.uniform(-1, 1, 2)
        own = SkewRssr(r, 1.0, p, h, k, 1.0, rng.uniform(0.3, 2.8), (0.0, 0.0))
        a, b = own.ball_a(rng.uniform(-3, 3)), own.ball_b(rng.uniform(-3, 3))
        linkage = sb.from_axes(
            [
                {"kind": "R", "at": (0, 0, h), "axis": (0, 0, 1)},
                {"kind": "S", "at": a},
                {"kind": "S", "at": b},
                {"kind": "R", "at": own.foot_b(), "axis": own.axis_b()},
            ]
        )
        circuit = linkage.motion(120).circuits[0]
        if circuit.goes_round and len(circuit.input) == 120:
            return own, math.dist(a, b), circuit


@pytest.mark.parametrize(
    ("count", "given", "theory", "real"),
    [
        (8, {}, 1, {1}),
        (7, {"twist": RIGHT}, 2, {0, 2}),
        (7, {"twist": 1.1}, 2, {0, 2}),
        (6, {"zeros": (0.3, 0.5)}, 1, {0, 1}),
        (5, {"zeros": (0.3, 0.5), "twist": RIGHT}, 1, {0, 1}),
        (5, {"zeros": (0.3, 0.5), "twist": 2.0}, 1, {0, 1}),
    ],
)
def test_random_pairs_have_as_many_linkages_as_theory_counts(count, given, theory, real):
    seen = set()
    for seed in range(20):
        inputs, outputs = random_pairs(count, seed)
        found = function_pairs(inputs, outputs, **given)
        assert found.complete
        assert found.theory == theory
        assert found.real == len(found.answers)
        seen.add(found.real)
        for answer in found.answers:
            assert answer.error < 1e-9
            assert answer.fault in (None, "circuit", "dead centre", "order")
    assert seen == real


def test_a_hundred_tasks_of_eight_pairs_have_one_linkage_each():
    for seed in range(100):
        found = function_pairs(*random_pairs(8, seed))
        assert found.complete
        assert found.real == 1
        assert found.answers[0].error < 1e-9


def test_the_null_vector_in_40_digits_is_the_same_linkage():
    for seed in range(5):
        a, b = random_pairs(8, seed)
        with mpmath.workdps(40):
            rows = [
                [x * y for x in (1, mpmath.cos(p), mpmath.sin(p)) for y in (1, mpmath.cos(q), mpmath.sin(q))]
                for p, q in zip(map(mpmath.mpf, a.tolist()), map(mpmath.mpf, b.tolist()), strict=True)
            ]
            # the last coefficient 1: a random task has no zero there
            left = mpmath.matrix([row[:8] for row in rows])
            null = [*mpmath.lu_solve(left, mpmath.matrix([-row[8] for row in rows])), mpmath.mpf(1)]
            exact = rssr_of(np.array([float(x) for x in null]).reshape(3, 3))
        answer = function_pairs(a, b).answers[0]
        figures = answer.claim.figures
        assert figures["twist_deg"] == pytest.approx(math.degrees(exact.twist), abs=1e-6)
        # drawn in the pose of the first pair, in which its joints are at zero
        first = int(np.argmin(a))
        zeros = [figures["input_zero_deg"], figures["output_zero_deg"]]
        assert zeros == pytest.approx([-math.degrees(a[first]), -math.degrees(b[first])], abs=1e-12)
        balls = np.array([joint["at"] for joint in answer.draft.raw["joint"]])[[1, 2]]
        there = np.array([exact.ball_a(exact.zeros[0] + a[first]), exact.ball_b(exact.zeros[1] + b[first])])
        assert balls / np.linalg.norm(balls) == pytest.approx(there / np.linalg.norm(there), abs=1e-6)


def test_a_known_linkage_is_found_again_from_eight_of_its_pairs():
    for seed in range(20):
        own, coupler, circuit = known(seed)
        rows = np.sort(np.random.default_rng(seed).choice(100, 8, replace=False))
        found = function_pairs(circuit.input[rows], circuit.output[rows])
        (answer,) = found.answers
        crank, ball_a, ball_b, rocker = (np.array(j["at"]) for j in answer.draft.raw["joint"])
        sides = [np.linalg.norm(ball_a - crank), np.linalg.norm(ball_a - ball_b)]
        sides = np.array(sides) / np.linalg.norm(ball_b - rocker)
        assert sides == pytest.approx([own.r, coupler], rel=1e-5)
        assert answer.claim.figures["twist_deg"] == pytest.approx(math.degrees(own.twist), abs=1e-3)
        # it goes round, so it takes all of them in order
        assert isinstance(answer.verdict, Candidate)


def test_the_output_of_the_linkage_found_is_the_wanted_one():
    a, b = random_pairs(8, 3)
    (answer,) = function_pairs(a, b).answers
    for x, y in zip(answer.claim.inputs, answer.claim.outputs, strict=True):
        modes = answer.linkage.assembly_modes(x)
        assert np.abs(short_way(modes.q[:, -1] - y)).min() < 1e-9
    assert answer.claim.inputs == pytest.approx(a - a[0])
    assert answer.claim.outputs == pytest.approx(b - b[0])


@pytest.mark.parametrize("seed", range(6))
def test_seven_pairs_of_square_axes_agree_with_the_other_closed_form(seed):
    inputs, outputs = random_pairs(7, seed)
    rows, _ = through(inputs, outputs)
    found = function_pairs(inputs, outputs, twist=RIGHT)
    ours = np.array([row_of(answer.linkage.dimensions) for answer in found.answers])
    assert len(ours) == len(rows)
    for row in rows:
        scaled = row * 1000 / np.abs(row).max()
        assert np.abs(ours - scaled).max(axis=1).min() < 1e-5


@pytest.mark.parametrize("given", [{}, {"twist": RIGHT}, {"twist": 1.0}, {"zeros": (0.2, 0.3)}])
@pytest.mark.parametrize("count", [3, 4])
def test_fewer_pairs_have_a_family_whose_members_all_take_them(count, given):
    a = np.linspace(0, 1, count)
    found = function_pairs(a, a**2 / 2, samples=16, **given)
    assert found.theory is None
    assert not found.complete
    assert found.real > 2
    assert max(answer.error for answer in found.answers) < 1e-9
    assert found.defect_free
    again = function_pairs(a, a**2 / 2, samples=16, **given)
    assert [x.error for x in again.answers] == [x.error for x in found.answers]


def test_square_axes_with_zeros_given_have_those_zeros():
    linkage = sb.rssr(M=700, N=700, L1=250, L3=550, D=50)
    circuit = linkage.motion(90).circuits[0]
    (answer,) = function_pairs(circuit.input[:25:5], circuit.output[:25:5], twist=RIGHT, zeros=(0, 0)).answers
    ours, theirs = answer.linkage.dimensions, linkage.dimensions
    for name in ("M", "N", "L1", "L2", "L3", "D"):
        assert ours[name] / ours["L2"] == pytest.approx(theirs[name] / theirs["L2"], rel=1e-7)
    assert answer.fault is None


def test_square_axes_that_meet_leave_one_ratio_free():
    linkage = sb.load("rssr")
    circuit = linkage.motion(90).circuits[0]
    (answer,) = function_pairs(circuit.input[:25:5], circuit.output[:25:5], twist=RIGHT, zeros=(0, 0)).answers
    ours, theirs = answer.linkage.dimensions, linkage.dimensions
    for one, other in (("M", "L3"), ("N", "L1")):
        assert ours[one] / ours[other] == pytest.approx(theirs[one] / theirs[other], rel=1e-8)
    assert answer.fault is None


def test_pairs_of_a_planar_four_bar_give_parallel_axes():
    circuit = sb.four_bar(40, 100, 80, 90).motion(90).circuits[0]
    (answer,) = function_pairs(circuit.q[:40:5, 0], circuit.q[:40:5, 3]).answers
    assert answer.claim.figures["twist_deg"] == 0.0
    crank, ball_a, ball_b, rocker = (np.array(j["at"]) for j in answer.draft.raw["joint"])
    sides = [ball_a - crank, ball_b - ball_a, rocker - ball_b, crank - rocker]
    lengths = np.array([np.linalg.norm(side) for side in sides])
    assert lengths / lengths[0] * 40 == pytest.approx([40, 100, 80, 90], rel=1e-6)
    assert answer.fault is None


def test_pairs_of_axes_that_meet_have_a_linkage_whose_ratio_was_free():
    linkage = sb.from_axes(
        [
            {"kind": "R", "at": (0, 0, 3), "axis": (0, 0, 1)},
            {"kind": "S", "at": (2, 1, 3)},
            {"kind": "S", "at": (5, 3, 1)},
            {"kind": "R", "at": (4, 4, 0), "axis": (1, 1, 0)},
        ]
    )
    circuit = linkage.motion(90).circuits[0]
    (answer,) = function_pairs(circuit.input[:40:5], circuit.output[:40:5]).answers
    assert answer.claim.figures["twist_deg"] == pytest.approx(90, abs=1e-6)
    assert answer.error < 1e-9


def test_special_functions_have_fewer_linkages_or_a_family():
    a = 0.2 * np.arange(8)
    for outputs in (2 * a, a / 2):
        found = function_pairs(a, outputs)
        assert found.theory is None
        assert found.real == 0
    # an even function has a family, with square axes throughout
    even = function_pairs(a[:7] - 0.6, (a[:7] - 0.6) ** 2, twist=RIGHT, samples=16)
    assert even.theory is None
    assert even.real > 8
    assert max(answer.error for answer in even.answers) < 1e-9


@pytest.mark.parametrize(
    ("inputs", "outputs", "given", "said"),
    [
        ([0, 0, 1], [0, 1, 2], {}, "input 0 deg is given twice"),
        (np.arange(9) * 0.1, np.arange(9) ** 2 * 0.01, {}, "9 pairs are more .* give 8 at most"),
        (np.arange(8) * 0.1, np.arange(8) ** 2 * 0.01, {"twist": 1.0}, "with twist given .* give 7 at most"),
        (
            np.arange(7) * 0.1,
            np.arange(7) ** 2 * 0.01,
            {"zeros": (0, 0)},
            "with zeros given .* give 6 at most",
        ),
        (
            np.arange(5) * 0.1,
            np.arange(5) ** 2 * 0.01,
            {"twist": 0.0},
            "twist: 0 deg makes the axes parallel",
        ),
        (np.arange(5) * 0.1, np.arange(5) ** 2 * 0.01, {"twist": math.pi}, "twist: 180 deg makes"),
        (np.arange(5) * 0.1, np.full(5, 0.3), {}, "outputs: all are the same"),
        (np.arange(5) * 0.1, np.arange(4) * 0.1, {}, "5 inputs and 4 outputs"),
        ([0, 1], [0, 1], {}, "2 pairs leave too much open; give 3 to 8"),
        (np.arange(5) * 0.1, np.arange(5) ** 2 * 0.01, {"longest": -1}, "longest: -1 is not a length"),
        (
            np.arange(5) * 0.1,
            np.arange(5) ** 2 * 0.01,
            {"samples": 0},
            "samples: 0 is not a number of members",
        ),
    ],
)
def test_pairs_that_are_none_say_so(inputs, outputs, given, said):
    with pytest.raises(RequestError, match=said):
        function_pairs(inputs, outputs, **given)


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize("count", [5, 8])
@pytest.mark.parametrize("shift", [0.0, 0.3])
def test_an_output_equal_to_the_input_is_made_by_parallelograms(way, count, shift):
    """Every closure of such pairs has parallel axes, and the real linkages are parallelograms alone."""
    inputs = np.linspace(0.1, 1.2, count)
    found = function_pairs(inputs, way * inputs + shift, samples=8)
    assert found.real == 8
    assert len(found.defect_free) > 4
    for answer in found.answers:
        assert answer.error < 1e-11
        places = [np.array(joint["at"]) for joint in answer.draft.raw["joint"]]
        sides = [math.dist(a, b) for a, b in zip(places, places[1:] + places[:1], strict=True)]
        assert sides[:2] == pytest.approx(sides[2:], rel=1e-9)
