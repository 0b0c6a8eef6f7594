"""A linkage with stops goes, in the studio, from stop to stop and back; where it is let go it runs through them."""

from __future__ import annotations

import math

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.errors import RequestError
from sevenbar.kinematics.ranges.reach import reaches, stopped_by
from sevenbar.studio.panels.playback import _rows
from sevenbar.studio.state.session import Session

RSSR = "format = 1\n[rssr]\nM = 700\nN = 700\nL1 = 250\nL3 = 550\nD = 0\n"
RANGE = '[[stop]]\njoint = "rocker"\nrange = [-10, 30]\n'
CONE = '[[stop]]\njoint = "ball_b"\ncone = "20 deg"\n'
CRANK = '[[stop]]\njoint = "crank"\nrange = [-40, 50]\n'
NOWHERE = '[[stop]]\njoint = "rocker"\nrange = [80, 90]\n[[stop]]\njoint = "crank"\nrange = [0, 1]\n'
#: A double-rocker: most inputs are met on two passes of its circuit.
ROCKS = "format = 1\n[rssr]\nM = 700\nN = 700\nL1 = 500\nL3 = 550\nD = 100\n"


def output_at(session: Session) -> float:
    view = session.view
    assert view is not None
    return math.degrees(view.joints(session.row)[view.circuit.output_column])


@pytest.mark.parametrize(
    ("text", "column", "low", "high"),
    [(RSSR + RANGE, "rocker", -10, 30), (RSSR + CRANK, "crank", -40, 50), (ROCKS + RANGE, "rocker", -10, 30)],
)
def test_each_end_of_a_stretch_is_a_stop_and_none_of_its_poses_lies_beyond(text, column, low, high):
    session = Session(text, "stops.toml")
    assert session.reaches
    for reach in session.reaches:
        column_at = reach.walk.linkage.columns.index(column)
        rows = [reach.rolled(row) for row in np.linspace(reach.low, reach.high, 60)]
        values = [math.degrees(reach.walk.joints(row)[column_at] + math.pi) % 360 - 180 for row in rows]
        # between two rows the joints are on a straight line
        assert min(values) > low - 2e-2
        assert max(values) < high + 2e-2
        for row, stop in ((reach.low, reach.first_stop), (reach.high, reach.last_stop)):
            if stop:
                assert stop == f"range of {column}"
                value = math.degrees(reach.walk.joints(reach.rolled(row))[column_at] + math.pi) % 360 - 180
                assert min(abs(value - low), abs(value - high)) < 2e-2
                assert reach.stop_at(reach.rolled(row)) == stop


def test_two_stops_at_one_place_end_a_stretch_there_and_not_at_the_row_before():
    crank = 50.3
    rocker = math.degrees(sb.load("rssr").output([math.radians(crank)]).position[0][0])
    stops = f'[[stop]]\njoint = "crank"\nrange = [-40, {crank}]\n'
    stops += f'[[stop]]\njoint = "rocker"\nrange = [-60, {rocker!r}]\n'
    (reach,) = Session(RSSR + stops, "stops.toml").reaches
    assert reach.last_stop == "range of crank, range of rocker"
    assert reach.high == pytest.approx(crank, abs=1e-9)


@pytest.mark.parametrize(
    "text",
    [RSSR + stops for stops in (RANGE, CONE, CRANK, RANGE + CONE.replace("20", "40"))]
    + [ROCKS + stops for stops in (RANGE, CRANK)],
)
def test_a_linkage_that_plays_turns_at_both_stops(text):
    session = Session(text, "stops.toml")
    reach = session.reach
    assert reach is not None
    low, high = reach.times
    step, times = (high - low) / 17.3, []
    for _ in range(60):
        session.advance(step)
        assert session.reach is reach
        times.append(reach.time_at(reach.unrolled(session.row)))
    assert min(times) == pytest.approx(low)
    assert max(times) == pytest.approx(high)


def test_steps_and_the_slider_end_at_the_stop():
    session = Session(RSSR + RANGE, "stops.toml")
    session.step(300)
    assert output_at(session) == pytest.approx(30, abs=1e-2)
    session.step(-1000)
    assert output_at(session) == pytest.approx(30, abs=1e-2)
    session.seek(0)
    session.seek(200)
    assert session.reach is not None
    assert session.reach.stop_at(session.row) == "range of rocker"


def test_an_input_beyond_a_stop_is_refused_with_the_stop_and_reached_once_it_is_let_go():
    session = Session(RSSR + RANGE, "stops.toml")
    with pytest.raises(RequestError, match=r"200\.000° lies beyond a stop of circuit 0 \(range of rocker\)"):
        session.seek_input(math.radians(200))
    session.hold(False)
    session.seek_input(math.radians(200))
    assert session.view is not None
    assert session.reach is None
    assert stopped_by(session.view, session.row) == "range of rocker"
    assert session.view.input_at(session.row) == pytest.approx(math.radians(200))
    session.hold(True)
    assert output_at(session) == pytest.approx(30, abs=1e-2)


def test_a_linkage_that_a_stop_keeps_from_its_first_pose_is_opened_where_it_can_be():
    session = Session(RSSR + CONE, "stops.toml")
    assert session.reach is not None
    assert session.row == session.reach.low
    other = Session(RSSR + RANGE.replace("-10, 30", "120, 170"), "stops.toml")
    assert other.view is not None
    assert other.view.circuit.index == 1
    assert other.reach is not None


def test_where_no_pose_is_within_the_stops_nothing_holds_it():
    session = Session(RSSR + NOWHERE, "stops.toml")
    assert session.view is not None
    assert session.reaches == ()
    assert session.reach is None
    session.advance(1.0)
    assert session.row > 0
    assert "range of rocker" in stopped_by(session.view, session.row)


def test_a_change_of_a_dimension_keeps_the_pose_within_the_stops():
    session = Session(RSSR + RANGE, "stops.toml")
    session.step(300)
    for length in (251.0, 260.0, 280.0, 240.0):
        session.change(("rssr", "L1"), length)
        assert session.reach is not None
        assert -10.01 < output_at(session) < 30.01


def test_without_stops_a_whole_circuit_is_shown():
    session = Session(RSSR, "free.toml")
    assert session.view is not None
    assert session.reaches == reaches(session.view) == ()


def test_the_page_that_plays_goes_from_stop_to_stop_and_back():
    session = Session(RSSR + RANGE, "stops.toml")
    reach = session.reach
    assert reach is not None
    assert session.view is not None
    rows = _rows(session.view, reach)
    assert all(reach.holds(row) for row in rows)
    assert rows[0] == pytest.approx(reach.rolled(reach.low))
    assert rows[len(rows) // 2] == pytest.approx(reach.rolled(reach.high))
