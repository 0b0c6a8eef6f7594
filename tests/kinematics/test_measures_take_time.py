"""Measures of forces take their time at each linkage: maps and sweeps say so before, and report each step."""

from __future__ import annotations

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.commands.progress import SHORT, progress_bar
from sevenbar.design.maps.atlas import LOOP, motion_map
from sevenbar.design.maps.heights import measure_heights, usual_lines
from sevenbar.kinematics.measures import measures_named, rows_of
from sevenbar.sweep import grid
from sevenbar.sweep.plan import PART_OF_FORCES, SweepPlan
from sevenbar.sweep.run import carry_out

OVER = {"L1": (230.0, 260.0), "L3": (540.0, 560.0)}


@pytest.mark.parametrize(
    ("name", "lines"),
    [("swing", None), ("peak_torque", LOOP.lines), ("peak_force:crank", LOOP.lines), ("clearance", None)],
)
def test_a_map_of_forces_has_the_grid_of_loops(name, lines):
    assert usual_lines(measures_named([name])) == lines


def test_a_map_says_before_how_much_is_measured_and_counts_each_linkage():
    reports = []
    found = motion_map(sb.load("rssr_press"), OVER, grid=3, progress=lambda *report: reports.append(report))
    ahead = []

    def begin(count, seconds):
        ahead.append((count, seconds))

    (heights,) = measure_heights(found, ["peak_torque"], levels=[500.0], ahead=begin)
    ((count, seconds),) = ahead
    assert count >= len(heights.values) > 0
    assert seconds > 0
    # a new bar, in which every linkage is a step
    own = [report[:2] for report in reports]
    own = own[own.index((0, count)) :]
    assert [done for done, _ in own[: len(heights.values)]] == list(range(len(heights.values)))
    assert all(done <= total for done, total in own)


def test_peaks_on_a_map_are_those_of_the_analysis():
    found = motion_map(sb.load("rssr_press"), OVER, grid=3)
    (heights,) = measure_heights(found, ["peak_torque"], levels=[500.0])
    for place, value in list(zip(heights.nodes, heights.values, strict=True))[::9]:
        L1, L3 = found.values(place[None])[0]
        linkage = found.draft.with_values({"L1": L1, "L3": L3}).linkage
        peaks = [abs(circuit.forces().sizing().peak_torque.value) for circuit in linkage.motion().circuits]
        assert value == pytest.approx(max(peaks), rel=1e-9)


def test_a_sweep_of_forces_has_short_parts_and_says_before_what_it_takes():
    press = sb.load("rssr_press")
    over = {"L1": grid(240, 250, 40)}
    ahead, reports = [], []
    plan = SweepPlan.of(press, over, ["peak_torque"])
    assert plan.part_size == PART_OF_FORCES
    swept = carry_out(
        plan,
        threads=1,
        progress=lambda *report: reports.append(report[:2]),
        ahead=lambda *given: ahead.append(given),
    )
    assert reports == [(0, 40), (32, 40), (40, 40)]
    ((count, seconds),) = ahead
    assert count == 40
    assert seconds > 0
    table = swept.table()
    own = rows_of(press.motion(90), measures_named(["peak_torque"]))
    first = plan.draft.with_values({"L1": 240.0}).linkage
    expected = [row["peak_torque"] for row in rows_of(first.motion(90), measures_named(["peak_torque"]))]
    found = table.filter(np.equal(table["linkage"].to_numpy(), 0))["peak_torque_N_m"].to_pylist()
    assert len(own) == len(found)
    assert found == pytest.approx(expected, rel=1e-12)


def test_a_sweep_without_forces_says_nothing_before():
    plan = SweepPlan.of(sb.load("rssr"), {"L1": grid(240, 250, 3)}, ["swing"])
    ahead = []
    carry_out(plan, ahead=lambda *given: ahead.append(given))
    assert ahead == []


@pytest.mark.parametrize(
    ("seconds", "words"),
    [
        (SHORT - 1, ""),
        (20.0, "about 1,200 linkages are analysed one by one, which takes some 20 s\n"),
        (600.0, "about 1,200 linkages are analysed one by one, which takes some 10 min\n"),
    ],
)
def test_long_work_is_announced(capsys, seconds, words):
    with progress_bar("mapping") as progress:
        progress(0, 10)
        progress.ahead(1200, seconds)
    assert capsys.readouterr().err == "mapping ..\n" + words
