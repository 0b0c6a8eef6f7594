"""The extremes of the mechanical advantage as measures: values, units, derivatives, sweeps and design tasks."""

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.description.draft import Draft
from sevenbar.design.task import DesignTask, FigureWant, FreeNumber, designed
from sevenbar.errors import RequestError
from sevenbar.kinematics.measures import gradient, measures_named
from sevenbar.sweep import grid, run

NAMES = ("advantage_lowest", "advantage_highest")
#: A drag link: crank, coupler, rocker, ground.
DRAG_LINK = (100.0, 90.0, 110.0, 40.0)


def values(linkage):
    circuit = linkage.motion(72).circuits[0]
    return [measure.value(circuit) for measure in measures_named(NAMES)]


def test_a_universal_joint_has_the_cosine_of_its_bend_and_one_over_it():
    # bent by acos(0.8)
    assert values(sb.load("universal_joint")) == pytest.approx([0.8, 1.25], rel=1e-12)


def test_they_are_the_extremes_of_the_rows_and_none_where_the_output_stands_still():
    circuit = sb.four_bar(*DRAG_LINK).motion(3600).circuits[0]
    rows = circuit.mechanical_advantage
    assert values(sb.four_bar(*DRAG_LINK)) == pytest.approx([rows.min(), rows.max()], rel=1e-5)
    assert values(sb.load("rssr")) == [None, None]


def test_the_unit_is_that_of_a_torque_over_a_force():
    names = [measure.column(linkage, linkage.drive.output) for linkage in (
        sb.load("planar_4r"), sb.slider_crank(crank=30, rod=100), sb.load("rssp"),
    ) for measure in measures_named(NAMES[:1])]  # fmt: skip
    assert names[:2] == ["advantage_lowest", "advantage_lowest_per_mm"]


def test_derivatives_are_those_of_differences():
    slopes = gradient(sb.four_bar(*DRAG_LINK).motion(72), only=NAMES)
    lengths = [0, 3, 6, 9]
    for place, column in enumerate(lengths):
        sides = []
        for step in (1e-4, -1e-4):
            own = list(DRAG_LINK)
            own[place] += step
            sides.append(values(sb.four_bar(*own)))
        differences = (np.array(sides[0]) - sides[1]) / 2e-4
        assert [slopes[name].slopes[column] for name in NAMES] == pytest.approx(differences, rel=1e-6)


def test_of_rows_with_dead_centres_of_the_input_they_have_no_derivatives():
    found = gradient(sb.load("universal_joint").motion(24), only=NAMES)
    assert set(found) == set(NAMES)
    # without names the usual measures alone
    assert not set(NAMES) & set(gradient(sb.four_bar(*DRAG_LINK).motion(24)))


def test_a_sweep_has_them_as_columns():
    table = run(sb.four_bar(*DRAG_LINK), {"length_1": grid(99.0, 101.0, 3)}, NAMES, samples=24).table()
    first = [row for row in table.to_pylist() if row["circuit"] == 0]
    assert first[1]["advantage_highest"] == pytest.approx(values(sb.four_bar(*DRAG_LINK))[1], rel=1e-12)


def test_a_design_task_makes_the_greatest_advantage_small():
    draft = Draft.of_linkage(sb.four_bar(*DRAG_LINK))
    free = (FreeNumber("length_2", 80.0, 100.0), FreeNumber("length_3", 100.0, 120.0))
    task = DesignTask(draft, free, (FigureWant("advantage_highest", "small"),))
    best = designed(task, count=1, starts=1).designs[0]
    assert values(best.draft.linkage)[1] < values(sb.four_bar(*DRAG_LINK))[1] - 0.05


def test_no_value_lies_outside_the_bounds_that_a_measure_states():
    linkage = sb.load("rssr_press")
    circuit = linkage.motion(72).circuits[0]
    for measure in measures_named(
        ["swing", "time_ratio", "transmission_lowest", "peak_torque", "range:rocker"]
    ):
        low, high = measure.bounds
        assert low <= measure.value(circuit) <= high
    with pytest.raises(RequestError, match="advantage_lowest"):
        measures_named(["advantage"])
