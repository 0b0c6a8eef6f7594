"""The transmission angle of nets: of the dyad that drives the output, against the same dyad in a single loop."""

from math import hypot, pi

import numpy as np
import pytest

import sevenbar as sb

#: Watt's six-bar of the gallery: each pin's place as drawn, and its links.
WATT = {
    "crank": ([0, 0], ["frame", "crank"]),
    "pin_2": ([10, 40], ["crank", "coupler"]),
    "pin_3": ([110, 80], ["coupler", "rocker"]),
    "rocker": ([100, 0], ["frame", "rocker"]),
    "pin_5": ([150, 60], ["rocker", "link"]),
    "pin_6": ([220, 70], ["link", "lever"]),
    "lever": ([200, 0], ["frame", "lever"]),
}


def watt(first=7):
    """Watt's six-bar by its `first` pins; four of them are its first loop."""
    pins = [{"name": name, "at": at, "links": links} for name, (at, links) in WATT.items()]
    return sb.from_pins(pins[:first], ground="frame")


def test_of_the_first_dyad_it_is_that_of_the_four_bar_alone():
    alone = watt(4).motion(output="rocker").circuits
    circuits = watt().motion(output="rocker").circuits
    assert [one.motion_type for one in circuits].count("crank-rocker") == 2
    for circuit in circuits[:2]:
        nearest = min(alone, key=lambda one: abs(one.output[0] - circuit.output[0]))
        expected, result = nearest.transmission, circuit.transmission
        assert (result.lowest, result.highest) == pytest.approx(
            (expected.lowest, expected.highest), abs=1e-12
        )
        assert result.lowest_at == pytest.approx(expected.lowest_at, abs=1e-6)
        np.testing.assert_allclose(circuit.transmission_angle, nearest.transmission_angle, atol=1e-11)


def turned(at, about, angle):
    """A drawn place (2,), turned about a pivot by angles (n,)."""
    x, y = np.subtract(at, about)
    return np.array(
        [about[0] + x * np.cos(angle) - y * np.sin(angle), about[1] + x * np.sin(angle) + y * np.cos(angle)]
    )


def at_the_pin(first, pin, last, moving):
    """The acute angle (n,) at the pin of two links, drawn at three places, the first of which is `moving`."""
    one, other = hypot(*np.subtract(first, pin)), hypot(*np.subtract(last, pin))
    diagonal = np.hypot(*(moving - np.array(last, dtype=float)[:, None]))
    angle = np.arccos(np.clip((one**2 + other**2 - diagonal**2) / (2 * one * other), -1, 1))
    return np.minimum(angle, pi - angle)


def test_where_another_dyad_turns_the_input_back_it_is_not_zero():
    circuit = watt().motion(output="rocker").circuits[2]
    whole = watt(4).motion(output="rocker").circuits[0].transmission
    pins = turned((10, 40), (0, 0), np.array(circuit.input_range))
    ends = at_the_pin((10, 40), (110, 80), (100, 0), pins)
    result = circuit.transmission
    assert whole.lowest < result.lowest < result.highest < whole.highest
    assert (result.lowest, result.highest) == pytest.approx((ends.min(), ends.max()), abs=1e-7)
    assert (circuit.transmission_angle > 0.5).all()


def test_it_is_the_angle_at_the_pin_of_link_and_lever():
    for circuit in watt().motion().circuits:
        moving = turned((150, 60), (100, 0), circuit["rocker"])
        expected = at_the_pin((150, 60), (220, 70), (200, 0), moving)
        np.testing.assert_allclose(circuit.transmission_angle, expected, atol=1e-7)


def test_at_the_dead_centre_of_its_own_dyad_it_is_zero():
    circuit = watt().motion().circuits[2]
    assert circuit.transmission.lowest == 0.0
    assert [round(centre.input, 9) for centre in circuit.dead_centres].count(
        round(circuit.transmission.lowest_at, 9)
    )


def test_it_is_the_same_however_the_net_is_written():
    pins = {
        "lever": ([200, 0], ["lever", "frame"]),
        "pin_6": ([220, 70], ["lever", "link"]),
        "pin_5": ([150, 60], ["link", "rocker"]),
        "pin_3": ([110, 80], ["coupler", "rocker"]),
        "pin_2": ([10, 40], ["coupler", "crank"]),
        "rocker": ([100, 0], ["frame", "rocker"]),
        "crank": ([0, 0], ["frame", "crank"]),
    }
    angle = 0.3
    for scale in (1.0, 1e-3, 25.4):
        written = sb.from_pins(
            [
                {"name": name, "at": (scale * turned(at, (0, 0), angle)).tolist(), "links": links}
                for name, (at, links) in pins.items()
            ],
            ground="frame",
        )
        result = written.motion(input="crank", output="lever").circuits
        for expected in watt().motion().circuits:
            lows = [(one.transmission.lowest, one.transmission.highest) for one in result]
            own = expected.transmission
            assert min(abs(low - own.lowest) + abs(high - own.highest) for low, high in lows) < 1e-10


def with_a_slide():
    """A slider-crank with a dyad more on its rod, which drives nothing."""
    joints = {
        "crank": {"kind": "R", "at": [0, 0, 0], "between": ["frame", "crank"]},
        "pin": {"kind": "R", "at": [30, 10, 0], "between": ["crank", "rod"]},
        "wrist": {"kind": "R", "at": [110, -10, 0], "between": ["rod", "piston"]},
        "bore": {"kind": "P", "at": [110, -10, 0], "axis": [1, 0, 0], "between": ["frame", "piston"]},
        "eye": {"kind": "R", "at": [70, 25, 0], "between": ["rod", "bar"]},
        "knee": {"kind": "R", "at": [90, 160, 0], "between": ["bar", "arm"]},
        "arm": {"kind": "R", "at": [130, 40, 0], "between": ["frame", "arm"]},
    }
    rows = [{"name": name, "axis": [0, 0, 1], **joint} for name, joint in joints.items()]
    return sb.from_axes(rows, ground="frame")


def test_of_a_slide_it_is_that_of_the_slider_crank():
    net = with_a_slide()
    alone = sb.from_axes(
        [
            {"kind": "R", "at": [0, 0, 0], "axis": [0, 0, 1]},
            {"kind": "R", "at": [30, 10, 0], "axis": [0, 0, 1]},
            {"kind": "R", "at": [110, -10, 0], "axis": [0, 0, 1]},
            {"kind": "P", "at": [110, -10, 0], "axis": [1, 0, 0]},
        ]
    )
    circuits = net.motion(input="crank", output="bore").circuits
    known = [one.transmission for one in alone.motion().circuits]
    full = [one for one in circuits if one.goes_round]
    assert full
    for circuit in full:
        own = circuit.transmission
        assert min(abs(one.lowest - own.lowest) + abs(one.highest - own.highest) for one in known) < 1e-10


def test_of_an_output_at_the_middle_of_a_dyad_there_is_none():
    assert all(one.transmission is None for one in watt().motion(output="pin_6").circuits)
    assert all(one.transmission_angle is None for one in watt().motion(output="pin_6").circuits)


def test_with_the_input_inside_the_dyad_there_is_none():
    for circuit in watt().motion(input="pin_2", output="rocker").circuits:
        assert circuit.transmission is None
