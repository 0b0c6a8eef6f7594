"""Crank-rockers with a wanted swing and time ratio, checked by the ordinary analysis."""

import math

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.design.closure import NAMES, outputs, transmissions
from sevenbar.design.limits import Limits
from sevenbar.design.survey import SurveyTask, SwingWish
from sevenbar.design.survey.polish import Polish
from sevenbar.design.synthesis.function import swing
from sevenbar.design.synthesis.function.swing import swing_generation
from sevenbar.errors import RequestError

CRANK = np.array([700.0, 700.0, 250.0, 1000.0, 550.0, -150.0]) / 550.0


def linkage(row):
    return sb.rssr(**dict(zip(NAMES, row, strict=True)))


def polish_of(row, circuit):
    """The polishing of a design for the swing and the time ratio that it has, its unknowns, and its branch."""
    want = SwingWish(circuit.swing, circuit.time_ratio)
    bounds = dict.fromkeys(("M", "N", "D"), (-5.0, 5.0)) | dict.fromkeys(("L1", "L2"), (0.1, 5.0))
    task = SurveyTask(want, bounds | {"angle": (math.pi / 2, math.pi / 2)}, transmission_lowest=0.0)
    polish = Polish(task, np.array([*row, math.pi / 2, circuit.angle.lowest_at]), circuit.index)
    return polish, polish.packed()


@pytest.mark.parametrize("branch", [0, 1])
def test_what_polishing_wants_is_met_at_the_dead_centres_of_the_ordinary_analysis(branch):
    polish, z = polish_of(CRANK, linkage(CRANK).motion().circuits[branch])
    off, _ = polish.met(z)
    np.testing.assert_allclose(off, 0.0, atol=1e-10)


@pytest.mark.parametrize("branch", [0, 1])
def test_the_slopes_of_what_is_wanted_are_their_differences(branch):
    polish, z = polish_of(CRANK, linkage(CRANK).motion().circuits[branch])
    # away from the ends, where nothing vanishes
    z = z + 0.01

    steps = 1e-5 * np.eye(len(z))
    differences = [(polish.met(z + step)[0] - polish.met(z - step)[0]) / 2e-5 for step in steps]
    np.testing.assert_allclose(polish.met(z)[1].T, differences, atol=1e-8)


@pytest.mark.parametrize("branch", [0, 1])
def test_newtons_steps_bring_a_design_back_to_its_swing(branch):
    polish, z = polish_of(CRANK, linkage(CRANK).motion().circuits[branch])
    row = polish.unpacked(polish.exact(z + 0.01))
    circuits = linkage(row[:6]).motion().circuits
    got = [(c.swing, c.time_ratio) for c in circuits]
    want = polish.task.want
    assert min(math.dist(each, (want.angle, want.time_ratio)) for each in got) < 1e-9
    # where they lead nowhere all stays as it is
    np.testing.assert_array_equal(polish.exact(z + 5.0), z + 5.0)


def test_a_swing_beyond_half_a_turn_is_no_swing_the_other_way_round():
    """The output's difference counts along the way to the high end, not by the short way round."""
    found = swing_generation(math.radians(200), 1.0, limits=Limits(), count=1)
    assert found.candidates
    for candidate in found.candidates:
        assert math.degrees(
            candidate.draft.linkage.motion().circuits[candidate.circuit].swing
        ) == pytest.approx(200.0)
    assert "swing 160 deg" not in "".join(refusal.detail for refusal in found.refusals)


def test_a_linkage_with_M_zero_is_as_quick_one_way_as_back():
    """With M = 0 the closure holds sin alpha only, so the output is the same at alpha and at pi - alpha."""
    row = np.array([0.0, 1.4, 0.45, 1.9, 1.0, 0.6])
    for circuit in linkage(row).motion().circuits:
        assert circuit.time_ratio == pytest.approx(1.0, abs=1e-12)
        ends = [circuit.angle.lowest_at, circuit.angle.highest_at]
        np.testing.assert_allclose(np.abs(np.sin(ends)), 1.0, atol=1e-12)


@pytest.mark.parametrize(("degrees", "wanted"), [(60, 1.2), (90, 1.0)])
def test_swing_and_time_ratio_are_met_by_designs_that_differ(degrees, wanted):
    found = swing_generation(math.radians(degrees), wanted, count=2)
    lowest, rows = [], []
    for candidate in found.candidates:
        motion = candidate.draft.linkage.motion()
        assert motion.motion_type == "crank-rocker"
        circuit = motion.circuits[candidate.circuit]
        assert math.degrees(circuit.swing) == pytest.approx(degrees, abs=1e-9)
        assert circuit.time_ratio == pytest.approx(wanted, abs=1e-9)
        assert candidate.claim.figures["time_ratio"] == circuit.time_ratio
        # the zeros of a quartic, which no sample undercuts
        assert candidate.transmission_lowest == circuit.transmission.lowest
        turn = np.linspace(0.0, math.tau, 100_001)
        row = np.array([candidate.draft.linkage.dimensions[name] for name in NAMES])
        sampled = math.asin(math.sqrt(transmissions(row[None], turn)[0].min()))
        assert -1e-14 < sampled - candidate.transmission_lowest < 1e-8
        lowest.append(circuit.transmission.lowest)
        rows.append(np.abs([candidate.draft.linkage.dimensions[name] for name in NAMES]))
    assert len(lowest) == 2
    # and no mirror images
    assert np.abs(rows[0] - rows[1]).max() > 50.0
    assert lowest[0] > lowest[1] > math.radians(40)


def test_no_random_crank_rocker_of_the_wish_transmits_better():
    """Thousands of random designs near the wish, by the closed form alone."""
    found = swing_generation(math.radians(60), 1.0, count=1)
    best = found.candidates[0].transmission_lowest
    rng = np.random.default_rng(3)
    rows = np.ones((60000, 6))
    rows[:, [0, 1, 5]] = rng.uniform([0, -4, -4], [1, 4, 4], (60000, 3))
    rows[:, [2, 3]] = 6.0 ** rng.uniform(-1, 1, (60000, 2))
    angles = outputs(rows, np.linspace(0, math.tau, 49), 0)
    near = np.flatnonzero(np.abs(np.ptp(angles, axis=1) - math.radians(60)) < 0.02)
    rivals = 0
    for row in rows[near]:
        circuit = linkage(row).motion(36).circuits[0]
        if (
            circuit.time_ratio is None
            or circuit.time_ratio > 1.02
            or abs(circuit.swing - math.radians(60)) > 0.02
        ):
            continue
        rivals += 1
        # within 0.02 rad of the wish, a rival may be better by about as much
        assert circuit.transmission.lowest < best + 0.04
    assert rivals > 5


def test_limits_of_a_swing_are_kept_to():
    limits = Limits(math.radians(40), (100.0, 800.0))
    found = swing_generation(math.radians(60), 1.1, limits=limits, count=1)
    dimensions = found.candidates[0].draft.linkage.dimensions
    assert max(map(abs, dimensions.values())) == pytest.approx(800.0)
    assert min(dimensions[name] for name in ("L1", "L2", "L3")) >= 100.0
    assert found.candidates[0].transmission_lowest >= math.radians(40)


def test_a_swing_that_cannot_be_reached_tells_the_nearest(monkeypatch):
    monkeypatch.setattr(swing, "FITTED_LEAST", 4)
    found = swing_generation(math.radians(340), 1.1, count=1)
    assert found.candidates == ()
    with pytest.raises(RequestError, match=r"nearest: swing \d+\.?\d* deg with time ratio \d"):
        found.required()


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"swing": 0.0}, "swing: 0 deg is no swing"),
        ({"swing": math.tau}, "swing: 360 deg is no swing"),
        ({"time_ratio": 0.8}, "time ratio: 0.8 is not offered"),
        ({"time_ratio": math.nan}, "time ratio: nan is not offered"),
        ({"limits": Limits(motion_type="double-crank")}, "a double-crank has no swing"),
        ({"count": 0}, "designs: 0 is no number"),
    ],
)
def test_a_wrong_swing_is_told_in_a_line(wrong, words):
    with pytest.raises(RequestError, match=r"^[^\n]*$") as told:
        swing_generation(**({"swing": 1.0} | wrong))
    assert words in str(told.value)
