"""Torque, sizing, shaking, measures and pictures of a linkage with stops are those between them."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import pytest
from test_stops_free import HOOD

import sevenbar as sb
from command_runs import mistake, sevenbar
from sevenbar.errors import RequestError
from sevenbar.kinematics.circuits.timed_walk import TimedWalk
from sevenbar.kinematics.measures import FORCE_MEASURES, JOINT_MEASURES
from sevenbar.kinematics.ranges.reach import used_reach

ROD: dict[str, Any] = {"bodies": {3: sb.Body(2.0, solid="rod")}, "gravity": (0, -9.81, 0)}


def test_the_hood_s_peak_is_at_its_stop_and_dead_centres_beyond_are_no_matter(tmp_path: Any) -> None:
    file = tmp_path / "hood.toml"
    file.write_text(HOOD)
    circuit = sb.load(file).motion().circuits[0]
    found = circuit.forces(at_rest=True)
    own = found.within_stops
    # by virtual work
    assert own.torque[[0, -1]] == pytest.approx([-17.0803934800, -27.8998621747], rel=1e-9)
    assert own.between(np.radians([60.0])).torque[0] == pytest.approx(-26.5467742, rel=1e-8)
    peak = found.sizing().peak_torque
    assert (peak.value, math.degrees(peak.input)) == (
        pytest.approx(-27.8998621747, rel=1e-9),
        pytest.approx(65),
    )
    assert [int(part.branch[0]) for part in found.parts] == [0, 1]
    # the rows of the circuit are all there
    assert len(found.input) == 600
    text = " ".join(sevenbar("forces", file, "--speed", "0").stdout.split())
    assert "within the stops g1 from 0.000° to 65.000° (range of g1)" in text
    assert "peak -27.9 N m @ 65.000°" in text
    assert "without bound" not in text
    out = tmp_path / "out"
    values = json.loads(
        sevenbar("forces", file, "--speed", "0", "--json", "-o", out, "--figures", "").stdout or "0"
    )
    if values:
        assert values["within_stops"]["last_stop"] == "range of g1"
    assert "27.43 @ 65.000°" in " ".join(sevenbar("analyze", file).stdout.split())


def test_the_other_pass_has_its_own_part() -> None:
    found = sb.loads(HOOD).motion().circuits[0].forces(at_rest=True)
    other = found.on(found.branch == 1)
    assert abs(other.sizing().peak_torque.value) == pytest.approx(80.53, abs=0.005)
    assert other.within_stops is found.on(found.branch == 1).parts[0] or len(other.parts) == 1


def test_a_circuit_that_goes_round_is_sized_between_its_stops() -> None:
    linkage = sb.four_bar(crank=40, coupler=100, rocker=80, ground=90)
    name = linkage.columns[0]
    whole = linkage.motion().circuits[0].forces(**ROD)
    held = linkage.stopped(ranges={name: ("-30 deg", "50 deg")}).motion().circuits[0].forces(**ROD)
    xs = np.radians(np.linspace(-30, 50, 4001))
    torques = whole.between(xs).torque
    found = held.sizing()
    assert abs(found.peak_torque.value) == pytest.approx(np.abs(torques).max(), rel=1e-6)
    assert found.mean_torque == pytest.approx(np.trapezoid(torques, xs) / (xs[-1] - xs[0]), rel=1e-6)
    assert found.rms_torque == pytest.approx(
        math.sqrt(np.trapezoid(torques**2, xs) / (xs[-1] - xs[0])), rel=1e-6
    )
    assert found.flywheel is None
    with pytest.raises(RequestError, match="unevenness: stops end the motion"):
        held.sizing(unevenness=0.01)
    # stops that end nothing change nothing
    loose = linkage.stopped(ranges={linkage.columns[-1]: (-3.0, 3.0)}).motion().circuits[0]
    assert loose.allowed.whole
    assert loose.forces(**ROD).sizing().peak_torque == whole.sizing().peak_torque


def test_a_dead_centre_between_the_stops_leaves_no_peak() -> None:
    linkage = sb.loads(HOOD.replace("range = [0, 65]", "range = [-90, 65]"))
    found = linkage.motion().circuits[0].forces(at_rest=True)
    assert found.sizing() is None
    assert "dead-centre" in found.within_stops.status


def test_a_load_that_sets_in_between_the_stops_is_a_corner() -> None:
    linkage = sb.four_bar(crank=40, coupler=100, rocker=80, ground=90)
    name = linkage.columns[0]
    load = sb.Load(link=1, torque=(0, 0, 1.0), between=(math.radians(350), math.radians(20)))
    circuit = linkage.stopped(ranges={name: ("-30 deg", "50 deg")}).motion().circuits[0]
    found = circuit.forces(loads=[load], at_rest=True).sizing()
    assert abs(found.peak_torque.value) == pytest.approx(1.0)
    assert abs(found.mean_torque) == pytest.approx(30 / 80, rel=1e-9)


def test_a_slide_that_drives_from_stop_to_stop_is_sized_in_newton_and_joule() -> None:
    linkage = sb.slider_crank(crank=30, rod=90)
    slide = linkage.columns[-1]
    free = linkage.motion(input=slide, speed="10 mm/s").circuits[0]
    low, high = free.input_range
    ends = (low + 0.3 * (high - low), low + 0.8 * (high - low))
    acting: dict[str, Any] = {"bodies": {2: sb.Body(1.0, solid="rod")}, "gravity": (0, -9.81, 0)}
    circuit = linkage.stopped(ranges={slide: ends}).motion(input=slide, speed="10 mm/s").circuits[0]
    found = circuit.forces(**acting)
    own, sizing = found.within_stops, found.sizing()
    assert sorted(own.input[[0, -1]]) == pytest.approx(ends)
    rise = own.potential[-1] - own.potential[0] + own.kinetic[-1] - own.kinetic[0]
    assert sizing.mean_torque * (own.input[-1] - own.input[0]) / 1e3 == pytest.approx(rise, rel=1e-9)
    assert abs(sizing.peak_power.value) <= abs(sizing.peak_torque.value) * 0.01 * (1 + 1e-12)


def test_cones_end_the_part_as_ranges_do_and_measures_follow() -> None:
    linkage = sb.load("rssr").stopped(cones={"ball_b": "20 deg"})
    circuit = linkage.motion().circuits[0]
    found = circuit.forces(bodies={3: sb.Body(2.0, solid="rod")})
    spans = circuit.allowed.spans
    assert len(found.parts) == len(spans)
    for part, span in zip(found.parts, spans, strict=True):
        assert np.cos(part.part.start) == pytest.approx(math.cos(span.start), abs=1e-7)
        assert part.part.last_stop == "cone of ball_b"
        assert np.isfinite(part.torque).all()


def test_where_no_pose_is_within_the_stops_nothing_is_sized(tmp_path: Any) -> None:
    text = HOOD.replace('{ joint = "g1", range = [0, 65] }', '{ joint = "g1", range = [300, 310] }')
    found = sb.loads(text).motion().circuits[0].forces(at_rest=True)
    assert (found.within_stops, found.parts, found.sizing()) == (None, (), None)
    file = tmp_path / "out.toml"
    file.write_text(text)
    assert "no pose of circuit 0 is within the stops" in mistake("forces", file, "--speed", "0")
    assert "no pose of circuit 0 is within the stops" in mistake("free", file)


def test_a_film_and_a_picture_go_from_stop_to_stop_on_the_stretch_of_the_drawn_pose() -> None:
    motion = sb.loads(HOOD).motion()
    way = TimedWalk(motion, motion.circuits[0])
    reach = used_reach(way)
    ends = sorted(math.degrees(way.input_at(row)) for row in (reach.low, reach.high))
    assert ends == pytest.approx([0, 65], abs=1e-6)
    # the drawn pose is on it, and not on the other pass through the same inputs
    frames = motion.circuits[0].q[way.path.rows[round((reach.low + reach.high) / 2)]]
    assert np.abs(frames).max() < math.radians(90)
    figure = sb.plot.configuration(motion)
    # the crank's pin stays on the arc between the drawn pose and 65 degrees
    (axes,) = figure.axes
    lines = [line.get_xydata() for line in axes.get_lines() if len(line.get_xydata()) > 20]
    assert lines
    assert all(np.nanmax(line[:, 0]) < 120 and np.nanmin(line[:, 1]) > -30 for line in lines)


def test_a_law_that_goes_beyond_a_stop_is_followed_and_the_report_says_so(tmp_path: Any) -> None:
    file, law = tmp_path / "hood.toml", tmp_path / "law.csv"
    file.write_text(HOOD)
    rows = [f"{k / 10},{k * 4}" for k in range(21)]
    law.write_text("time_s,angle_deg\n" + "\n".join(rows) + "\n")
    text = " ".join(sevenbar("forces", file, "--law", law, "--branch", "0").stdout.split())
    # 68, 72, 76 and 80 degrees
    assert "4 of 21 rows of the law are beyond them: range of g1" in text


def test_measures_of_a_circuit_that_rocks_are_those_between_its_stops() -> None:
    circuit = sb.loads(HOOD).motion().circuits[0]
    found = circuit.forces().sizing()
    assert FORCE_MEASURES["peak_torque"].value(circuit) == pytest.approx(abs(found.peak_torque.value))
    assert FORCE_MEASURES["peak_shaking"].value(circuit) > 0
    assert JOINT_MEASURES["peak_force_in_plane"][1](circuit, "g1") == pytest.approx(
        found.bearings["g1"].in_plane.peak.value
    )
    free = sb.loads(HOOD.replace("range = [0, 65]", "range = [-90, 65]")).motion().circuits[0]
    assert FORCE_MEASURES["peak_torque"].value(free) is None
