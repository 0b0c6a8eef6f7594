"""Swing, time ratio and least transmission angle of an RSSR in closed form, against the circuits' own."""

import math

import numpy as np
import pytest

from sevenbar.description.draft import Draft
from sevenbar.design.closure import NAMES
from sevenbar.design.limits import Limits
from sevenbar.design.task import DesignTask, FigureMust, FigureWant, FreeNumber, designed
from sevenbar.design.task.loop import TaskLoop
from sevenbar.design.task.measured import Figures
from sevenbar.design.task.rssr_measures import KNOWN, RssrMeasures
from sevenbar.kinematics.measures import gradient

DOUBLE_ROCKER = [300.0, 200.0, 450.0, 500.0, 350.0, 100.0]


def draft_of(row):
    return Draft.made("RSSR", "mm", rssr=dict(zip(NAMES, map(float, row), strict=True)))


def crank_rockers(count):
    """Random crank-rockers, with their motions."""
    rng = np.random.default_rng(3)
    result = []
    while len(result) < count:
        row = rng.uniform([-3, -3, 0.1, 0.8, 0.7, -2], [3, 3, 0.6, 5, 2, 2])
        try:
            motion = draft_of(row).linkage.motion(36)
        except ValueError:
            continue
        if motion.motion_type == "crank-rocker":
            result.append((row, motion))
    return result


@pytest.mark.parametrize(("row", "motion"), crank_rockers(8))
def test_values_and_slopes_are_those_of_the_circuits_own(row, motion):
    loop = TaskLoop(draft_of(row), NAMES[::-1])
    measures = RssrMeasures(loop)
    assert measures.knows(KNOWN)
    for circuit in motion.circuits:
        own = gradient(motion, circuit.index, only=KNOWN)
        value, by = measures.at(loop.start, circuit.q[7], KNOWN)
        assert value == pytest.approx([own[name].value for name in KNOWN], abs=1e-9)
        slopes = [loop.all_slopes(loop.start, own[name].slopes) for name in KNOWN]
        np.testing.assert_allclose(by, slopes, rtol=1e-7, atol=1e-7)
        least = min(angle for angle, _ in measures.ends(loop.start))
        assert least == pytest.approx(own["transmission_lowest"].value, abs=1e-9)


def test_a_search_measures_them_without_a_motion():
    ((row, motion),) = crank_rockers(1)
    figures = Figures(TaskLoop(draft_of(row), NAMES), ("swing", "time_ratio"))
    assert not figures.measured
    value, _ = figures.at(np.array(row), motion.circuits[1].q[0])
    assert figures.motions == 0
    circuit = motion.circuits[1]
    assert value == pytest.approx([math.degrees(circuit.swing), circuit.time_ratio], abs=1e-9)


def test_what_has_no_swing_by_a_full_turn_is_measured_by_the_analysis():
    loop, motion = TaskLoop(draft_of(DOUBLE_ROCKER), NAMES), draft_of(DOUBLE_ROCKER).linkage.motion(72)
    assert motion.motion_type == "double-rocker"
    circuit = motion.circuits[0]
    assert RssrMeasures(loop).at(loop.start, circuit.q[3], ("swing",)) is None
    value, _ = Figures(loop, ("swing",)).at(loop.start, circuit.q[3])
    assert value == pytest.approx([math.degrees(circuit.swing)], abs=1e-9)


def test_beyond_a_full_turn_the_angle_is_below_zero_and_its_slopes_lead_back():
    loop = TaskLoop(draft_of(DOUBLE_ROCKER), NAMES)
    measures = RssrMeasures(loop)
    least, by = min(measures.ends(loop.start), key=lambda end: end[0])
    for k in range(6):
        step = 1e-6 * np.eye(6)[k]
        up, down = (min(angle for angle, _ in measures.ends(loop.start + way * step)) for way in (1, -1))
        assert by[k] == pytest.approx((up - down) / 2e-6, rel=1e-5, abs=1e-6)
    assert least < 0


def test_strokes_that_are_equal_have_a_ratio_with_a_kink_which_the_analysis_has():
    row = np.array([0.0, 1.4, 0.45, 1.9, 1.0, 0.6])
    loop = TaskLoop(draft_of(row), NAMES)
    motion = draft_of(row).linkage.motion(36)
    assert RssrMeasures(loop).at(loop.start, motion.circuits[0].q[0], ("time_ratio",)) is None
    value, _ = Figures(loop, ("time_ratio",)).at(loop.start, motion.circuits[0].q[0])
    assert value == pytest.approx([1.0], abs=1e-9)


def test_the_crank_rocker_of_a_swing_that_transmits_best_is_a_task_of_three_measures():
    """`sevenbar design swing` has 47.809 deg for 60 deg and a time ratio of 1.2, to a ten-thousandth."""
    start = draft_of([310.0, 490.0, 360.0, 980.0, 770.0, 930.0])
    links = ("L1", "L2", "L3")
    free = tuple(FreeNumber(name, 50.0 if name in links else -1000.0, 1000.0) for name in NAMES)
    musts = FigureMust("swing", 60.0, 60.0), FigureMust("time_ratio", 1.2, 1.2)
    task = DesignTask(
        start,
        free,
        (FigureWant("transmission_lowest", "great"),),
        musts,
        goal="minimax",
        limits=Limits(motion_type="crank-rocker"),
    )
    (best,) = designed(task, count=1, starts=0).designs
    assert best.figures["transmission_lowest"] >= 47.8091
    assert best.figures["swing"] == pytest.approx(60.0, abs=1e-6)
    assert best.figures["time_ratio"] == pytest.approx(1.2, abs=1e-8)
    assert best.optimality < 1e-6
