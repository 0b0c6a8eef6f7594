"""Measures are the numbers of the ordinary analysis, under names with units."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.description.draft import Draft
from sevenbar.errors import RequestError
from sevenbar.kinematics.measures import (
    DERIVED_MEASURES,
    EXTENT_MEASURES,
    FORCE_MEASURES,
    MEASURES,
    NAMED,
    Measure,
    measures_named,
    rows_of,
)
from sevenbar.sweep.batches import batched
from sevenbar.sweep.ordinary import analysed
from sevenbar.sweep.plan import SweepPlan


def test_the_papers_crank_rocker_is_measured_as_table_1_has_it() -> None:
    motion = sb.load("rssr").motion()
    rows = rows_of(motion, measures_named(["motion_type", "velocity_lowest", "velocity_highest", "swing"]))
    assert [row["circuit"] for row in rows] == [0, 1]
    assert rows[0]["motion_type"] == "crank-rocker"
    assert rows[0]["velocity_lowest"] == pytest.approx(-5.445439, abs=5e-7)
    assert rows[0]["velocity_highest"] == pytest.approx(7.959775, abs=5e-7)
    assert rows[0]["swing"] == pytest.approx(math.degrees(1.189368 + 0.122185), abs=1e-4)


def test_columns_tell_units_by_what_the_output_does() -> None:
    turning, sliding = sb.load("rssr"), sb.load("rssp")
    swing, velocity = MEASURES["swing"], MEASURES["velocity_highest"]
    assert swing.column(turning, turning.drive.output) == "swing_deg"
    assert velocity.column(turning, turning.drive.output) == "velocity_highest_rad_s"
    assert swing.column(sliding, sliding.drive.output) == "swing_mm"
    assert velocity.column(sliding, sliding.drive.output) == "velocity_highest_mm_s"


@pytest.mark.parametrize(("name", "length"), [("rssr", "L1"), ("seven_r", "length_7")])
def test_a_measure_is_its_row_in_batches_too(name, length, monkeypatch) -> None:
    row = Measure(
        *("strokes", "circuit", "ratio", lambda circuit: (circuit.time_ratio or math.nan) ** 2, "its square"),
        batch=lambda many: many.raw.time_ratio**2,
    )
    monkeypatch.setitem(NAMED, "strokes", row)
    linkage = sb.load(name)
    own = Draft.of_linkage(linkage).dimension(length).value
    plan = SweepPlan.of(linkage, {length: [own, 0.99 * own]}, ["strokes", "time_ratio"])
    values = plan.space.values(0, plan.space.count)
    (block,), rest = batched(plan, values, 1)
    assert not len(rest)
    one_by_one = analysed(plan, values, 0, np.arange(plan.space.count)).columns["strokes"]
    assert block.columns["strokes"].tolist() == pytest.approx(one_by_one.tolist(), nan_ok=True)


def test_a_measure_without_a_batch_column_is_of_each_linkage_by_itself() -> None:
    without = [name for name, measure in NAMED.items() if measure.batch is None]
    assert without == [*FORCE_MEASURES, *EXTENT_MEASURES, *DERIVED_MEASURES]
    plan = SweepPlan.of(sb.load("rssr"), {"L1": [200.0, 250.0]}, ["swing", "usable"])
    blocks, rest = batched(plan, plan.space.values(0, 2), 1)
    assert (blocks, rest.tolist()) == ([], [0, 1])


def test_a_linkage_that_cannot_be_assembled_keeps_its_row() -> None:
    motion = sb.rssr(M=700, N=700, L1=1, L3=1, D=0, L2=1).motion()
    (row,) = rows_of(motion, measures_named(["motion_type", "swing"]))
    assert row == {"circuit": None, "motion_type": "cannot-assemble", "swing": None}


def test_a_stroke_without_time_has_no_time_ratio() -> None:
    # a change point, where the circuit goes over to its other branch at both ends of the output
    motion = sb.rssr(M=0, N=300, L1=300, L3=300, L2=600, D=300).motion()
    strokes = [(c.angle.highest_at - c.angle.lowest_at) % math.tau for c in motion if c.angle]
    assert [row["time_ratio"] for row in rows_of(motion, measures_named(["time_ratio"]))] == [None]
    assert strokes == [0.0]


def test_a_function_of_the_motion_is_a_measure() -> None:
    def greatest_residual(motion: sb.Motion) -> float:
        """The greatest closure error."""
        return max(float(c.residual.max()) for c in motion)

    (measure,) = measures_named([greatest_residual])
    (row,) = rows_of(sb.load("seven_r").motion(90), [measure])
    assert measure.title == "The greatest closure error."
    assert 0 < row["greatest_residual"] < 1e-9


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (["swng"], "measure: 'swng' is not a measure; did you mean 'swing'? give some of motion_type"),
        ([], "measure: none given; give some of motion_type"),
        (["swing", "swing"], "measure: 'swing' is given twice; leave one out"),
    ],
)
def test_wrong_measures_are_told(given: list[str], message: str) -> None:
    with pytest.raises(RequestError) as caught:
        measures_named(given)
    assert message in str(caught.value)


def test_rounding_of_a_joint_that_follows_evenly_is_reported_as_zero():
    """Clemens' joint turns its output as its input: velocity 2 pi throughout, acceleration 0."""
    told = sb.report.markdown(sb.load("five_bar").motion(72))
    velocity = next(line for line in told.splitlines() if "output_shaft velocity" in line)
    assert "| 6.28319 |" in velocity
    assert "@" not in velocity
    assert re.search(r"acceleration \[rad/s²\] \| 0 \|", told)
    assert not re.search(
        r"\de-1\d", told.replace(next(x for x in told.splitlines() if "closure error" in x), "")
    )
    # what is small but no rounding stays
    slow = sb.report.markdown(sb.load("rssr").motion(72, speed=1e-9))
    assert "-5.44544e-10" in slow


@pytest.mark.parametrize(
    ("name", "given", "head"),
    [
        ("rssr", {}, "mechanical_advantage"),
        ("rssp", {}, "mechanical_advantage_per_mm"),
        ("rssp", {"input": "slider"}, "mechanical_advantage_mm"),
    ],
)
def test_the_mechanical_advantage_is_a_column_with_its_unit(name, given, head):
    motion = sb.load(name).motion(36, **given)
    columns = motion.columns()
    assert list(columns)[-2] == head
    rows = np.concatenate([circuit.mechanical_advantage for circuit in motion])
    np.testing.assert_array_equal(columns[head], rows)
    # power in is power out
    first, second = (
        "rad_s" if motion.linkage.unit_of(end) == "rad" else "mm_s" for end in (motion.input, motion.output)
    )
    speed, follows = columns[f"{motion.input}_{first}"], columns[f"{motion.output}_{second}"]
    good = np.isfinite(rows) & (rows != 0)
    np.testing.assert_allclose(rows[good] * follows[good], speed[good], rtol=1e-12)
    si = motion.columns(si=True)
    scale = {
        "mechanical_advantage": 1.0,
        "mechanical_advantage_per_mm": 1e3,
        "mechanical_advantage_mm": 1e-3,
    }[head]
    np.testing.assert_allclose(si[head.replace("mm", "m")], rows * scale, rtol=1e-15)
