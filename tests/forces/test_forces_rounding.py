"""What is left of rounding where forces balance is 0, in results, words, text and JSON."""

import json
from pathlib import Path

import numpy as np
import pytest

import sevenbar as sb
from command_runs import sevenbar
from sevenbar.forces.heard import heard, without_rounding

#: A crank whose centre lies on its axis, 2 kg: nothing pulls at the input.
BALANCED = """
format = 1
length_unit = "mm"
joint = [{ name = "a", kind = "R", at = [0, 0, 0], axis = [0, 0, 1] },
  { name = "b", kind = "R", at = [40, 0, 0], axis = [0, 0, 1] },
  { name = "c", kind = "R", at = [78.359375, 92.3512, 0], axis = [0, 0, 1] },
  { name = "d", kind = "R", at = [90, 0, 0], axis = [0, 0, 1] }]
[forces]
gravity = [0, -9.81, 0]
[[body]]
link = 1
mass = 2
centre = [0, 0, 0]
inertia = [1000, 1000, 1000, 0, 0, 0]
"""


def test_a_balanced_crank_takes_nothing() -> None:
    forces = sb.loads(BALANCED).motion(samples=36).circuits[0].forces()
    assert not forces.torque.any()
    assert not forces.power.any()
    assert forces.balance == 0.0
    found = forces.sizing(unevenness=0.1)
    assert found is not None
    for value in (
        found.peak_torque.value,
        found.rms_torque,
        found.mean_torque,
        found.fluctuation,
        found.flywheel,
    ):
        assert value == 0.0
    assert found.braking_power is None
    assert forces.reactions["a"].force_in_report[:, 1] == pytest.approx(19.62)
    assert not forces.reactions["a"].force_in_report[:, 0].any()
    assert not forces.shaking.any()


def test_the_report_and_the_json_of_a_balanced_crank_have_zeros(tmp_path: Path) -> None:
    (tmp_path / "balanced.toml").write_text(BALANCED)
    run = sevenbar("forces", "balanced.toml", "--samples", "36", cwd=tmp_path)
    page = " ".join(run.stdout.split())
    assert "input torque 0 N m power 0 W shaking force" in page
    assert "drives its input" not in page
    assert "fluctuates" not in page
    assert "e-1" not in page.partition("found")[0]
    run = sevenbar("forces", "balanced.toml", "--samples", "36", "--json", cwd=tmp_path)
    drive = json.loads(run.stdout)["sizing"]
    assert drive["peak_torque"]["value"] == drive["mean_torque"] == drive["fluctuation"] == 0
    assert "-0.0" not in json.dumps(drive)


def test_a_constant_load_needs_a_constant_torque_that_fluctuates_by_nothing() -> None:
    circuit = sb.load("rssr").motion(samples=36).circuits[0]
    forces = circuit.forces(loads=[sb.Load(1, torque=(0, 0, 1))])
    found = forces.sizing()
    assert found is not None
    assert abs(found.peak_torque.value) == pytest.approx(1.0)
    assert found.fluctuation == 0.0


def test_nothing_but_rounding_is_taken_for_rounding() -> None:
    assert heard(1e-11, 1.0) == 1e-11
    rows = np.array([[1e-13, 1e-11], [np.nan, 0.0]])
    found = without_rounding(rows, 1.0)
    assert found[0].tolist() == [0.0, 1e-11]
    assert np.isnan(found[1, 0])
