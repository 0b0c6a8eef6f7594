"""The exported model as MuJoCo opens and runs it."""

from typing import get_args

import mujoco
import numpy as np
import pytest

import sevenbar as sb
from gallery_sample import sampled
from sevenbar.errors import RequestError
from sevenbar.export import FORMATS, export
from sevenbar.export.mjcf import Drive


def opened(path):
    """MuJoCo's model and data at the file's start."""
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    mujoco.mj_forward(model, data)
    return model, data


def gap(data):
    """Greatest error of the equalities that close the loop [m, rad]."""
    return np.abs(data.efc_pos[data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY]).max()


@pytest.mark.parametrize("name", sampled())
def test_the_model_starts_closed_in_the_pose_asked_for_and_runs(name, tmp_path):
    motion = sb.load(name).motion(90)
    circuit = motion.circuits[-1]
    row = np.flatnonzero(circuit.status == "ok")[len(circuit.q) // 5]
    (path,) = export(
        motion,
        "mjcf",
        tmp_path / "model.xml",
        circuit=circuit.index,
        at=circuit.input[row],
        branch=int(circuit.branch[row]),
    )
    model, data = opened(path)
    assert gap(data) < 1e-9
    metre = {"mm": 1e-3, "in": 0.0254}[motion.linkage.length_unit]
    for column, kind in ((circuit.input_column, "input"), (circuit.output_column, "output")):
        label = motion.linkage.columns[column]
        scale = 1.0 if motion.linkage.turns(column) else metre
        found = data.qpos[model.joint(label).qposadr[0]] / scale
        apart = found - circuit.q[row, column]
        assert abs((apart + np.pi) % (2 * np.pi) - np.pi) < 1e-6, kind
    before = data.qpos.copy()
    for _ in range(20):
        mujoco.mj_step(model, data)
    assert np.abs(data.qpos - before).max() > 1e-6
    assert gap(data) < 1e-3


@pytest.mark.parametrize(
    "name", ["planar_4r", "seven_r", "bennett", "rscr", "screw_drill", "rsur", "swash_plate"]
)
def test_the_model_is_closed_and_runs_when_it_is_opened(name, tmp_path):
    """Without its key frame: as a viewer opens it."""
    linkage = sb.load(name)
    (path,) = export(linkage, "mjcf", tmp_path / "model.xml", samples=36)
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert gap(data) < 1e-9
    place = model.jnt_qposadr[model.actuator("drive").trnid[0]]
    start = data.qpos[place]
    for _ in range(200):
        mujoco.mj_step(model, data)
    assert data.qpos[place] - start == pytest.approx(0.2 * linkage.drive.speed, rel=0.15)
    assert gap(data) < 1e-3


def test_a_position_holds_and_a_motor_is_free(tmp_path):
    for drive, control, moves in (
        ("position", None, False),
        ("position", 0.3, True),
        ("motor", 0.0, False),
        ("motor", 0.02, True),
    ):
        (path,) = export(
            sb.load("planar_4r"), "mjcf", tmp_path / "model.xml", at=0.5, drive=drive, force=True
        )
        model = mujoco.MjModel.from_xml_path(str(path))
        data = mujoco.MjData(model)
        data.ctrl[0] = 0.5 if control is None else control
        for _ in range(500):
            mujoco.mj_step(model, data)
        crank = float(data.joint("theta_1").qpos[0])
        assert (abs(crank - 0.5) > 1e-2) == moves
        if drive == "position":
            assert crank == pytest.approx(data.ctrl[0], abs=1e-3)


def test_the_drives_that_are_offered_are_those_that_are_written():
    assert FORMATS["mjcf"].drives == get_args(Drive)


def test_only_a_model_with_an_actuator_has_a_drive(tmp_path):
    with pytest.raises(RequestError, match="drive: glb has no actuator; leave it out, or give mjcf"):
        export(sb.load("planar_4r"), "glb", tmp_path / "a.glb", drive="motor")
    with pytest.raises(RequestError, match="'engine'"):
        export(sb.load("planar_4r"), "mjcf", tmp_path / "a.xml", drive="engine")


def test_a_dead_centre_has_no_velocities_to_start_with(tmp_path):
    motion = sb.load("rsur").motion(36, input="cross.2")
    with pytest.raises(RequestError, match="dead centre"):
        export(motion, "mjcf", tmp_path / "model.xml", at=motion.circuits[0].dead_centres[0].input)
    assert not list(tmp_path.iterdir())


def test_a_fast_input_has_steps_in_which_the_loop_stays_closed(tmp_path):
    # at 3000 rpm a millisecond is 18 degrees, and the loop would open by 4 mm of 180
    (path,) = export(sb.load("engine").motion(90), "mjcf", tmp_path / "engine.xml")[:1]
    model, data = opened(path)
    assert model.opt.timestep == pytest.approx(60 / 3000 / 360)
    for _ in range(720):
        mujoco.mj_step(model, data)
    assert gap(data) < 1e-4
    (path,) = export(sb.load("planar_4r").motion(90), "mjcf", tmp_path / "slow.xml")[:1]
    assert opened(path)[0].opt.timestep == 1e-3
