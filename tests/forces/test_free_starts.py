"""Where a free motion may start, and how its time is written."""

from __future__ import annotations

import math

import numpy as np
import pytest

import sevenbar as sb
from command_runs import mistake, sevenbar


@pytest.mark.parametrize("name", ["engine", "rssr_press", "seven_r_bodies"])
def test_a_circuit_that_turns_fully_may_be_let_go_at_any_whole_turn(name: str) -> None:
    for circuit in sb.load(name).motion(samples=36).circuits:
        assert circuit.input_range is None
        for start, value in ((0.0, 0.0), ("360 deg", math.tau), (math.tau, math.tau), ("-360deg", -math.tau)):
            found = circuit.free_motion("1 ms", start=start)
            assert abs(found.input[0] - value) < 1e-9


@pytest.mark.parametrize("crank", [0.1, 2.6, 30.0])
@pytest.mark.parametrize("turned", [0.0, 90.0, 33.7])
def test_the_seam_is_a_start_like_any_other_of_linkages_drawn_and_turned(crank: float, turned: float) -> None:
    a = math.radians(turned)
    turn = np.array([[math.cos(a), -math.sin(a), 0], [math.sin(a), math.cos(a), 0], [0, 0, 1]])

    def at(*place: float) -> list[float]:
        return [float(x) for x in crank * turn @ np.array(place)]

    places = (("a", (0, 0, 0)), ("b", (1, 0, 0)), ("c", (3, 2.5, 0)), ("d", (3.2, 0, 0)))
    joints = [
        f'{{ name = "{name}", kind = "R", at = {at(*place)}, axis = [0, 0, 1] }}' for name, place in places
    ]
    body = 'body = [{ link = 2, mass = 1.3, solid = "rod" }]'
    linkage = sb.loads(f'format = 1\ndrive = {{ joint = "a" }}\njoint = [{", ".join(joints)}]\n{body}')
    for circuit in linkage.motion(samples=36).circuits:
        if circuit.input_range is None:
            for start in (0.0, math.tau):
                assert abs(circuit.free_motion(0.01, start=start).input[0] - start) < 1e-9


def test_an_input_at_its_limit_is_one_start_though_rounding_has_it_beyond() -> None:
    (circuit, *_) = sb.load("planar_4r").motion(input="theta_4", output="theta_1").circuits
    low, high = circuit.input_range
    bodies = {1: sb.Body(1.0, solid="rod")}
    for limit in (low, high):
        for value in (limit, np.nextafter(limit, -9.0), np.nextafter(limit, 9.0)):
            found = circuit.free_motion(0.01, start=float(value), bodies=bodies)
            assert abs(found.input[0] - limit) < 1e-9


@pytest.mark.parametrize(("text", "end"), [("500ms", 0.5), ("500 ms", 0.5), ("1min", 60.0), ("10s", 10.0)])
def test_a_time_has_the_units_of_the_help(text: str, end: float) -> None:
    circuit = sb.load("engine").motion(samples=36).circuits[0]
    assert circuit.free_motion(text, samples=2).time[-1] == end


def test_the_command_takes_milliseconds_and_refuses_what_is_no_time() -> None:
    assert "0 to 0.5 s" in sevenbar("free", "engine", "--time", "500ms").stdout
    assert "--time: '500 mm' is not a time" in mistake("free", "engine", "--time", "500 mm")


def test_a_range_of_rest_is_one_equilibrium_from_end_to_end() -> None:
    text = " ".join(sevenbar("free", "engine", "--time", "10ms").stdout.split())
    assert "flat 135 to 240" in text
    assert " stable" not in text
    _, flat = sb.load("engine").motion().circuits[0].equilibria()
    assert np.degrees([flat.input, flat.until]) == pytest.approx([135, 240])


def test_rounding_is_no_speed_and_no_angle_in_words() -> None:
    text = " ".join(sevenbar("free", "engine", "--from", "0deg", "--time", "10ms").stdout.split())
    assert "start crank = 0 deg, 0 deg/s" in text
    assert "e-1" not in text.split("equilibrium crank")[1].replace("e-10", "")
