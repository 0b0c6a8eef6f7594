"""Where a load acts: over a range of the input, a turn at most, written with units or without."""

import math
from typing import Any

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.errors import DescriptionError, RequestError

FOUR_BAR = """
format = 1
length_unit = "mm"
drive = {{ joint = "a", output = "d" }}
joint = [{{ name = "a", kind = "R", at = [0, 0, 0], axis = [0, 0, 1] }},
  {{ name = "b", kind = "R", at = [40, 0, 0], axis = [0, 0, 1] }},
  {{ name = "c", kind = "R", at = [78.359375, 92.3512, 0], axis = [0, 0, 1] }},
  {{ name = "d", kind = "R", at = [90, 0, 0], axis = [0, 0, 1] }}]
[[load]]
link = 1
torque = [0, 0, 1]
{where}
"""
SLIDE = """
format = 1
length_unit = "mm"
drive = {{ joint = "s", output = "c" }}
joint = [{{ name = "c", kind = "R", at = [0, 0, 0], axis = [0, 0, 1] }},
  {{ name = "p", kind = "R", at = [30, 30, 0], axis = [0, 0, 1] }},
  {{ name = "w", kind = "R", at = [120, 0, 0], axis = [0, 0, 1] }},
  {{ name = "s", kind = "P", at = [120, 0, 0], axis = [1, 0, 0] }}]
[[load]]
link = 3
at = [120, 0, 0]
force = [1, 0, 0]
{where}
"""


def crank(**load: Any) -> tuple[sb.Circuit, dict[str, Any]]:
    linkage = sb.four_bar(crank=40, coupler=100, rocker=80, ground=90)
    push = sb.Load(1, torque=(0, 0, 1), **load)
    return linkage.motion(samples=36).circuits[0], {"loads": [push], "bodies": {1: sb.Body(1, solid="rod")}}


WHOLE = [(0, 360), (-180, 180), (90, 450), (90.1, 450.1), (-720, -360)]


@pytest.mark.parametrize("ends", WHOLE)
def test_a_load_over_a_whole_turn_acts_everywhere(ends: tuple[float, float]) -> None:
    circuit, given = crank(between=tuple(map(math.radians, ends)))
    forces = circuit.forces(**given)
    assert np.abs(forces.torque + 1.0).max() < 1e-12
    sizing = forces.sizing()
    assert sizing is not None
    # no jump where the turn ends
    assert sizing.found == "series"
    assert abs(sizing.mean_torque + 1.0) < 1e-12


@pytest.mark.parametrize("ends", WHOLE)
def test_a_file_s_load_over_a_whole_turn_acts_everywhere(ends: tuple[float, float]) -> None:
    linkage = sb.loads(FOUR_BAR.format(where=f"between = [{ends[0]}, {ends[1]}]"))
    assert np.abs(linkage.motion(samples=36).circuits[0].forces().torque + 1.0).max() < 1e-12


def test_a_table_over_a_whole_turn_acts_everywhere() -> None:
    circuit, given = crank(table=((0.5, 0.5 + math.tau), (1.0, 1.0)))
    assert np.abs(circuit.forces(**given).torque + 1.0).max() < 1e-12


def test_a_load_over_a_whole_turn_drives_a_free_motion_all_the_way_and_leaves_no_equilibrium() -> None:
    circuit, given = crank(between=("0 deg", "360 deg"))
    _, always = crank()
    both = [circuit.free_motion(1.0, start=0.1, samples=11, **one).input for one in (given, always)]
    assert np.abs(both[0] - both[1]).max() < 1e-9 * np.abs(both[1]).max()
    assert both[0][-1] > 10.0
    assert circuit.equilibria(**given) == circuit.equilibria(**always) == ()


@pytest.mark.parametrize(
    ("ends", "words"),
    [
        ((0, 720), "between: 720 deg is more than a turn"),
        ((-10, 360), "between: 370 deg is more than a turn"),
        ((10, 380), "between: 370 deg is more than a turn"),
        ((360, 0), "between: 360 deg is a turn or more above 0 deg"),
        ((400, 10), "between: 400 deg is a turn or more above 10 deg"),
    ],
)
def test_a_load_over_more_than_a_turn_is_refused(ends: tuple[float, float], words: str) -> None:
    with pytest.raises(DescriptionError, match=r"load\[1\]\." + words):
        sb.loads(FOUR_BAR.format(where=f"between = [{ends[0]}, {ends[1]}]"))
    circuit, given = crank(between=tuple(map(math.radians, ends)))
    for ask in (
        lambda: circuit.forces(**given),
        lambda: circuit.equilibria(**given),
        lambda: circuit.free_motion(1.0, **given),
        lambda: sb.four_bar(crank=40, coupler=100, rocker=80, ground=90).loaded(loads=given["loads"]),
    ):
        with pytest.raises(RequestError, match=r"loads\[0\]\." + words):
            ask()


def test_a_table_over_more_than_a_turn_is_refused() -> None:
    words = r"\.table: its inputs go over 744.845 deg, more than a turn"
    circuit, given = crank(table=((0.0, 6.0, 13.0), (0.0, 1.0, 0.0)))
    with pytest.raises(RequestError, match=r"loads\[0\]" + words):
        circuit.forces(**given)
    with pytest.raises(DescriptionError, match=r"load\[1\].table: its inputs go over 361 deg"):
        sb.loads(FOUR_BAR.format(where="table = [[0, 0], [180, 1], [361, 0]]"))


def test_a_range_of_an_input_that_slides_rises() -> None:
    with pytest.raises(DescriptionError, match=r"load\[1\].between: 30 is above -30, and the input slides"):
        sb.loads(SLIDE.format(where="between = [30, -30]"))
    # more of a slide than 2 pi is no turn
    circuit = sb.loads(SLIDE.format(where="between = [-60, 0]")).motion(samples=36).circuits[0]
    torque = circuit.forces().torque
    known = np.isfinite(torque)
    inside = (circuit.input >= -60.0) & (circuit.input <= 0.0)
    assert np.abs(torque - np.where(inside, -1.0, 0.0))[known].max() < 1e-12
    assert 0 < inside[known].sum() < known.sum()


def test_a_range_through_zero_is_that_of_the_angles_within_it() -> None:
    circuit, given = crank(between=("300 deg", "30 deg"))
    acts = np.degrees(circuit.input) % 360
    wanted = np.where((acts >= 299.999) | (acts <= 30.001), -1.0, 0.0)
    assert np.abs(circuit.forces(**given).torque - wanted).max() < 1e-12


def test_python_takes_the_units_that_files_take() -> None:
    written = sb.Load(
        1, force=("2 kN", 0, "-3 N"), torque=(0, 0, "300 N mm"), at=(1, 2, 3), between=("10 deg", "pi/4")
    )
    plain = sb.Load(
        1, force=(2000, 0, -3), torque=(0, 0, 0.3), at=(1, 2, 3), between=(math.radians(10), math.pi / 4)
    )
    assert written == plain
    table = sb.Load(1, torque=(0, 0, 1), table=(("0 deg", "90 deg"), (0, 1))).table
    assert table == ((0.0, math.pi / 2), (0.0, 1.0))


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"between": ("10", "40")}, "between: '10' is not a number with a unit that fits; give one as in '30 deg'"),
        ({"between": ("10 mm", "40 mm")}, "numbers in the linkage's length unit where the input slides"),
        ({"between": "10 deg"}, "between: '10 deg' is not a number"),
        ({"torque": ("2 N", 0, 0)}, "torque: '2 N': 'N' is not a unit of torque"),
        ({"table": ((0, 1),)}, "table: give two lists, the inputs and the factors there"),
    ],
)  # fmt: skip
def test_a_text_that_does_not_fit_is_refused_in_python(wrong: dict[str, Any], message: str) -> None:
    with pytest.raises(RequestError, match=message):
        sb.Load(1, **({"torque": (0, 0, 1)} | wrong))
