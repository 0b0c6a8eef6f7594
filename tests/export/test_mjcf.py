"""The model for MuJoCo as MuJoCo itself reads it."""

import xml.etree.ElementTree as ElementTree

import mujoco
import numpy as np
import pytest

import sevenbar as sb
from sevenbar.description.gallery import loops
from sevenbar.export.mjcf import mjcf
from sevenbar.export.prototype import prototype
from sevenbar.simulation.run import prepared


def loaded(name, row=5, time_step=1e-3):
    """The linkage, a row's number, its circuit, the prototype, and MuJoCo's model and data at the start."""
    linkage = sb.load(name)
    way, _ = prepared(linkage, steps=360)
    number = int(way.rows[row])
    built = prototype(linkage, way.circuit, number, way.motion.speed)
    model = mujoco.MjModel.from_xml_string(mjcf(built, time_step=time_step))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    mujoco.mj_forward(model, data)
    return linkage, number, way.circuit, built, model, data


@pytest.mark.parametrize("name", loops())
def test_the_loop_is_closed_at_the_start_and_its_sides_move_together(name):
    linkage, _, _, _, model, data = loaded(name)
    equality = data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY
    assert equality.any()
    # the errors of all equalities [m and rad], and how fast they grow
    assert np.abs(data.efc_pos[equality]).max() < 1e-12
    assert np.abs(data.efc_vel[equality]).max() < 1e-9 * max(1.0, np.abs(data.qvel).max())
    # a coordinate for each freedom, but a spin that is held and the turns of a ball that is cut; two for a screw
    held = len(linkage.idle) + 3 * ("S" in linkage.kind)
    assert model.nv == len(linkage.columns) - held + linkage.kind.count("H")


@pytest.mark.parametrize("name", loops())
def test_coordinates_are_sevenbar_s_columns_in_metres_and_radians(name):
    linkage, row, circuit, _, model, data = loaded(name)
    metre = {"mm": 1e-3, "in": 0.0254}[linkage.length_unit]
    joints = {model.joint(number).name for number in range(model.njnt)}
    read = 0
    for column, (label, kind) in enumerate(zip(linkage.columns, linkage.column_kinds, strict=True)):
        if next(joint for joint in linkage.joints if label in joint.columns).kind == "S":
            continue
        assert label in joints
        scale = metre if kind == "slide" else 1.0
        address = model.joint(label)
        assert data.qpos[address.qposadr[0]] == pytest.approx(circuit.q[row, column] * scale, abs=1e-12)
        assert data.qvel[address.dofadr[0]] == pytest.approx(circuit.dq[row, column] * scale, abs=1e-9)
        read += 1
    assert read >= 2


@pytest.mark.parametrize("name", ["rssr", "seven_r", "rccc", "screw_drill", "bennett"])
def test_links_stand_and_move_where_sevenbar_has_them(name):
    linkage, row, circuit, built, model, data = loaded(name)
    metre = {"mm": 1e-3, "in": 0.0254}[linkage.length_unit]
    velocity = np.zeros(6)
    for body in built.bodies:
        number = model.body(body.name).id
        assert data.xpos[number] / metre == pytest.approx(body.frame[:3, 3], abs=1e-9 * built.size)
        assert data.xmat[number].reshape(3, 3) == pytest.approx(body.frame[:3, :3], abs=1e-12)
        mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_XBODY, number, velocity, 0)
        assert velocity[3:] / metre == pytest.approx(body.velocity, abs=1e-9 * built.size)
        assert velocity[:3] == pytest.approx(body.spin, abs=1e-9)
    for point in linkage.points:
        trace = circuit.point(point.link, point.at)
        frame = linkage.point_frames[point.link - 1]
        number = model.body(f"link_{point.link}").id
        place = frame[:3, :3] @ np.array(point.at) + frame[:3, 3]
        found = data.xpos[number] + data.xmat[number].reshape(3, 3) @ place * metre
        assert found / metre == pytest.approx(trace.position[row], abs=1e-9 * built.size)


def test_it_runs_on_its_own_for_a_turn_at_the_drive_s_speed():
    _, row, circuit, _, model, data = loaded("rssr", time_step=2e-4)
    while data.time < 2 * np.pi / 10:
        mujoco.mj_step(model, data)
    crank, rocker = (model.joint(name) for name in ("crank", "rocker"))
    assert data.qvel[crank.dofadr[0]] == pytest.approx(10, abs=1e-6)
    expected = sb.load("rssr").output([data.qpos[crank.qposadr[0]]]).position[circuit.mode[row], 0]
    assert data.qpos[rocker.qposadr[0]] == pytest.approx(expected, abs=1e-4)


def test_a_fast_engine_keeps_the_speed_it_is_driven_at():
    linkage = sb.load("engine")
    way, _ = prepared(linkage, steps=360)
    speed = abs(way.motion.speed)
    step = 2 * np.pi / speed / 360
    built = prototype(linkage, way.circuit, int(way.rows[5]), way.motion.speed)
    model = mujoco.MjModel.from_xml_string(mjcf(built, drive="velocity", time_step=step))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    crank = model.jnt_dofadr[model.actuator("drive").trnid[0]]
    speeds = []
    for _ in range(720):
        mujoco.mj_step(model, data)
        speeds.append(abs(data.qvel[crank]))
    # two turns at 3,000 rpm
    assert speed == pytest.approx(314.159, rel=1e-5)
    assert np.abs(np.array(speeds) / speed - 1).max() < 2e-3


def test_bodies_do_not_collide_and_weigh_what_the_text_says():
    _, _, _, built, model, _ = loaded("rssr")
    assert not model.geom_contype.any()
    assert not model.geom_conaffinity.any()
    assert model.body_mass[1:] == pytest.approx(np.ones(len(built.bodies)))
    assert model.opt.gravity == pytest.approx(np.zeros(3))


def test_a_name_with_marks_of_xml_is_written_as_text():
    linkage = sb.rssr(M=700, N=700, L1=250, L3=550, D=0, name='a < b & "c"')
    _, built = prepared(linkage, steps=360)
    text = mjcf(built)
    assert ElementTree.fromstring(text).get("model") == 'a < b & "c"'
    assert mujoco.MjModel.from_xml_string(text).nbody == 4


def test_a_ball_on_the_ground_is_cut_there():
    linkage = sb.from_axes(
        [
            {"kind": "R", "at": (700, 0, 0), "axis": (1, 0, 0)},
            {"kind": "R", "at": (0, 0, 700), "axis": (0, 0, 1)},
            {"kind": "S", "at": (250, 0, 700)},
            {"kind": "S", "at": (700, 550, 0)},
        ]
    )
    _, built = prepared(linkage, steps=360)
    root = ElementTree.fromstring(mjcf(built))
    (loop,) = root.iter("connect")
    sites = {site.get("name") for site in root.find("worldbody").findall("site")}
    assert loop.get("site2") in sites
