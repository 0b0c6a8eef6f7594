"""A free motion and equilibria of links that spin idly say what moment the rule of the spin needs."""

from __future__ import annotations

import numpy as np
import pytest

import sevenbar as sb
from command_runs import sevenbar

GRAVITY = (0.0, 0.0, -9.81)
#: A coupler whose centre is off the line of its balls.
OFF = {2: sb.Body(1.3, centre=(10, 20, 30), inertia=1e-3 * np.eye(3)), 3: sb.Body(2.0, solid="rod")}


def test_a_coupler_off_the_line_of_its_balls_needs_the_moment_that_forces_find() -> None:
    circuit = sb.load("rssr").motion().circuits[0]
    found = circuit.free_motion("1s", bodies=OFF, gravity=GRAVITY)
    forces = found.motion().circuits[0].forces(bodies=OFF, gravity=GRAVITY)
    assert found.spin == pytest.approx({"coupler": np.nanmax(np.abs(forces.spin["coupler"]))}, rel=1e-9)
    assert found.spin["coupler"] > 0.1
    for place in circuit.equilibria(bodies=OFF, gravity=GRAVITY):
        # at rest the weight alone turns it: its moment about the line of the balls
        assert 0.1 < place.spin["coupler"] < 1.3 * 9.81 * 0.04
    first = str(found).splitlines()[1]
    assert first.split(":")[0].split() == ["idle", "spin", "coupler"]


def test_of_a_rod_the_spin_moves_nothing_and_no_word_is_lost() -> None:
    circuit = sb.load("rssr").motion().circuits[0]
    rods = {2: sb.Body(1.3, solid="rod"), 3: sb.Body(2.0, solid="rod")}
    found = circuit.free_motion("1s", bodies=rods, gravity=GRAVITY)
    assert found.spin == {"coupler": 0.0}
    assert "idle spin" not in str(found)
    assert sb.load("engine").motion(samples=36).circuits[0].free_motion("10 ms").spin == {}


def test_the_command_has_it_in_words_and_numbers() -> None:
    text = sevenbar("free", "rssr_press", "--time", "100ms").stdout
    values = sevenbar("free", "rssr_press", "--time", "100ms", "--json").stdout
    assert '"idle_spin"' in values
    assert ("idle spin" in text) == ('"idle_spin": {}' not in values and '"coupler": 0.0' not in values)
