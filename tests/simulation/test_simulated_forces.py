"""Torque and reactions as engines give them, compared with Sevenbar's at two step sizes."""

from __future__ import annotations

import numpy as np
import pytest

import sevenbar as sb
from loaded import random_body
from sevenbar.simulation.agreement import Difference
from sevenbar.simulation.figures import FIGURES
from sevenbar.simulation.report import columns
from sevenbar.simulation.run import simulate

pytest.importorskip("exudyn")


def loaded(name: str) -> sb.Linkage:
    """A linkage of the gallery with random bodies, weight, two loads, a spring and a damper in a joint."""
    rng = np.random.default_rng(7)
    linkage = sb.load(name)
    circuit, last = linkage.motion(8).circuits[0], len(linkage.joints)
    size = circuit.size
    # the spring of a joint that goes round has more to give with every turn
    stiffness = 2.0 if circuit.output_range else 0.0
    return linkage.loaded(
        bodies={link: random_body(rng, size) for link in range(1, last)},
        gravity=(1.0, 2.0, -9.8),
        loads=[
            sb.Load(last - 1, (3.0, 4.0, -5.0), (0.1, 0.2, 0.3), at=(0.1 * size, 0.0, 0.0), axes="link"),
            sb.Load(1, (1.0, -2.0, 5.0), at=(0.1 * size, 0.0, 0.0), between=(0.5, 2.0)),
        ],
        springs=[
            sb.Spring(0.3, 0.4 * size, 0.01, links=(1, last), at=((0.1 * size, 0.0, 0.0), (0.0, 0.0, size))),
            sb.Spring(stiffness, 0.1, 0.3, joint=linkage.drive.output),
        ],
    )


def forces_of(name: str, steps: int, engine: str = "exudyn") -> dict[str, Difference]:
    run = simulate(loaded(name), engine, steps=steps)
    return {d.quantity: d for d in run.differences if d.quantity.endswith((" torque", " force", " moment"))}


@pytest.mark.parametrize("name", ["rssr", "seven_r", "rscr", "rsur", "rccc", "rssp", "spherical_4r"])
def test_torque_and_reactions_come_out_of_an_engine_with_the_square_of_its_step(name: str) -> None:
    coarse, fine = forces_of(name, 720), forces_of(name, 1440)
    assert len(fine) > 3
    for quantity, found in fine.items():
        scale = max(d.scale for q, d in fine.items() if q.split()[-1] == quantity.split()[-1])
        if quantity.endswith("moment"):
            scale = max(scale, *(d.scale for q, d in fine.items() if q.endswith("torque")))
        assert found.greatest < 3e-4 * scale, (quantity, found)
        if coarse[quantity].greatest > 1e-8 * scale:
            assert found.greatest < 0.3 * coarse[quantity].greatest, (quantity, coarse[quantity], found)


#: By how much torque and reactions in MuJoCo may be off at 1,440 steps a turn, as a part of the greatest: it
#: holds the loop softly, and velocities are late by half a step.
SOFTNESS = {"rssr": 1e-3, "rscr": 3e-4, "rsur": 3e-3, "seven_r": 6e-3}


@pytest.mark.parametrize("name", SOFTNESS)
def test_mujoco_s_torque_and_reactions_are_sevenbar_s_within_its_softness(name: str) -> None:
    pytest.importorskip("mujoco")
    coarse, fine = forces_of(name, 720, "mujoco"), forces_of(name, 1440, "mujoco")
    joints = sb.load(name).joints
    assert {quantity.rpartition(" ")[0] for quantity in fine} == {joint.name for joint in joints}
    for quantity, found in fine.items():
        scale = max(d.scale for q, d in fine.items() if q.split()[-1] == quantity.split()[-1])
        if quantity.endswith("moment"):
            scale = max(scale, *(d.scale for q, d in fine.items() if q.endswith("torque")))
        assert found.greatest < SOFTNESS[name] * scale, (quantity, found)
        assert found.greatest < 0.6 * coarse[quantity].greatest, (quantity, coarse[quantity], found)


def test_bodies_without_mass_weigh_next_to_nothing_in_mujoco() -> None:
    pytest.importorskip("mujoco")
    body = sb.Body(2.0, (0.0, 0.0, 0.0), 0.02 * np.eye(3))
    linkage = sb.load("seven_r").loaded(bodies={3: body}, gravity=(0.0, 0.0, -9.8))
    run = simulate(linkage, "mujoco", steps=720)
    torque = run.difference("theta_1 torque")
    assert torque.greatest < 5e-4 * torque.scale
    assert any("link_1, link_2, link_4, link_5, link_6 weigh 1e-05 of" in note for note in run.record.notes)


def test_weight_is_no_acceleration_in_mujoco() -> None:
    pytest.importorskip("mujoco")
    run = simulate(loaded("rssr"), "mujoco", steps=720)
    for quantity in ("A acceleration", "B acceleration", "rocker acceleration"):
        found = run.difference(quantity)
        assert found.greatest < 5e-3 * found.scale, found


def test_report_rows_and_figure_have_torque_and_reactions() -> None:
    run = simulate(loaded("planar_4r"), "mujoco", steps=720)
    assert [f"{force.name} {force.what}" for force in run.forces][:2] == ["theta_1 torque", "theta_1 force"]
    # of a planar linkage forces out of the plane and moments in it are left open, and are not compared
    assert {force.axes for force in run.forces} == {("",), ("x", "y")}
    rows = columns(run)
    for axis in "xy":
        ours, theirs = (rows[f"theta_4_force_{axis}_{who}_N"] for who in ("sevenbar", "mujoco"))
        assert np.abs(ours - theirs).max() < 0.05 * np.abs(ours).max()
    ours, theirs = (rows[f"theta_1_torque_{who}_Nm"] for who in ("sevenbar", "mujoco"))
    assert np.abs(ours - theirs).max() == pytest.approx(run.difference("theta_1 torque").greatest)
    printed = " ".join(str(run).split())
    assert "as far as equilibrium determines it" in printed
    assert run.difference("theta_4 force").unit == "N"
    figure = FIGURES["forces"](run)
    assert [axes.get_ylabel() for axes in figure.axes[::2]] == ["input torque [N m]", "force [N]"]
    unloaded = simulate(sb.load("planar_4r"), "mujoco", steps=720)
    assert unloaded.forces == ()
    assert "equilibrium" not in str(unloaded)
    assert not any("torque" in head for head in columns(unloaded))


def test_a_load_acts_at_both_ends_of_its_range_in_mujoco() -> None:
    # 320 to 15 degrees: both are rows
    run = simulate(sb.load("rssr_press"), "mujoco", steps=720)
    torque = run.difference("crank torque")
    assert torque.greatest < 1e-3 * torque.scale
