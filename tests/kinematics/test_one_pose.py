"""A question about one pose: rates, points, torque and reactions there, by every way of asking."""

import json
import math
import re

import numpy as np
import pytest

import sevenbar as sb
from command_runs import mistake, sevenbar
from places import DOCS
from sevenbar.errors import RequestError
from sevenbar.kinematics.circuits.poses_at import SAME_POSE, PosesAt

#: A toggle: a slide drives, and both rods lie in one line at 0.
TOGGLE = """
format = 1
length_unit = "mm"
drive = {{ joint = "ram", output = "knee", speed = "100 mm/s" }}
joint = [
  {{ name = "ram", kind = "P", at = [200, 0, 0], axis = [1, 0, 0] }},
  {{ name = "a", kind = "R", at = [{x}, 0, 0], axis = [0, 0, 1] }},
  {{ name = "b", kind = "R", at = [100, 30, 0], axis = [0, 0, 1] }},
  {{ name = "knee", kind = "R", at = [0, 0, 0], axis = [0, 0, 1] }},
]
load = [{{ link = 2, at = [100, 30, 0], force = [0, -100, 0] }}]
"""


def gallery(*without):
    from sevenbar.description.gallery import loops

    return [name for name in loops() if name not in without]


def value_of(linkage, column=None):
    name = linkage.drive.joint if column is None else column
    return 0.3 if linkage.turns(name) else 3.0


@pytest.mark.parametrize("name", gallery("screw_drill"))
def test_every_mode_of_the_gallery_has_its_rates_which_are_slopes_of_its_motion(name):
    linkage = sb.load(name)
    value, step = value_of(linkage), 1e-5
    here, ahead, behind = (PosesAt.of(linkage, value + d, speed=1.0) for d in (0.0, step, -step))
    modes = linkage.assembly_modes(value)
    assert len(modes)
    for q in modes.q:
        pose = here.nearest(q, within=SAME_POSE)
        assert pose is not None
        assert pose.status == "ok"
        after, before = (beside.nearest(q, within=1e-2) for beside in (ahead, behind))
        way = after.q - before.q
        way[linkage.turning] = np.remainder(way[linkage.turning] + math.pi, math.tau) - math.pi
        known = np.isfinite(way)
        assert np.allclose(way[known] / (2 * step), pose.dq[known], rtol=1e-6, atol=1e-5 * linkage.size)


@pytest.mark.parametrize(
    ("name", "input"), [("planar_4r", "theta_4"), ("rssp", "slider"), ("rssr", "rocker")]
)
def test_another_joint_drives_a_pose_too(name, input):
    linkage = sb.load(name)
    q = linkage.motion(input=input)[0].q[5]
    pose = linkage.at(q, input=input, speed=2.0)
    own = linkage.at(q)
    column = linkage.columns.index(input)
    assert pose.dq[column] == pytest.approx(2.0)
    assert np.allclose(pose.dq / pose.dq[column], own.dq / own.dq[column], rtol=1e-8, atol=1e-8)


def test_a_slider_crank_at_45_degrees_is_that_of_the_formulas():
    r, rod, omega = 125.0, 500.0, 600 * math.tau / 60
    circuit = next(c for c in sb.slider_crank(r, rod, speed="600 rpm").motion() if c["slider"][0] == 0)
    pose = circuit.at("45 deg")
    theta = math.pi / 4
    phi = math.asin(r / rod * math.sin(theta))
    dphi = r * omega * math.cos(theta) / (rod * math.cos(phi))
    speed = -r * omega * math.sin(theta) - rod * dphi * math.sin(phi)
    assert pose["slider"] == pytest.approx(r * math.cos(theta) + rod * math.cos(phi) - r - rod)
    assert pose.dq[3] == pytest.approx(speed)
    assert pose.links[2].velocity[0, 2] == pytest.approx(-dphi)
    assert pose.links[1].velocity[0].tolist() == pytest.approx([0, 0, omega])


def test_a_pose_has_the_row_of_its_circuit_there():
    circuit = sb.load("engine").motion()[0]
    pose, row = circuit.at("45 deg"), 45
    assert np.allclose(pose.dq, circuit.dq[row])
    assert np.allclose(pose.ddq, circuit.ddq[row])
    assert pose.torque == pytest.approx(circuit.forces().torque[row])
    assert np.allclose(
        pose.reactions["crank"].force[0], circuit.forces().reactions["crank"].force[row], equal_nan=True
    )
    assert pose.transmission_angle == pytest.approx(circuit.transmission_angle[row])
    assert pose.forces(at_rest=True).torque[0] == pytest.approx(circuit.forces(at_rest=True).torque[row])


def test_both_modes_of_a_parallelogram_have_their_own_rates_and_none_at_the_change_point():
    linkage = sb.four_bar(2, 1, 2, 1)
    together, crossed = sorted(
        (linkage.at(q) for q in linkage.assembly_modes("30 deg").q), key=lambda pose: pose.dq[3]
    )
    assert together.dq[3] == pytest.approx(1.0)
    assert together["theta_4"] == pytest.approx(math.pi / 6)
    assert crossed.dq[3] > 1.5
    still = linkage.motion()[0].at(0.0)
    assert still.status == "change-point"
    assert np.isnan(still.dq).all()


def test_a_circuit_of_two_turns_has_a_pose_on_each():
    circuit = sb.load("myard_5r").motion()[0]
    first, second = circuit.at(0.3), circuit.at(0.3 + math.tau)
    again = circuit.at(0.3 + 2 * math.tau)
    assert not np.allclose(first.q, second.q)
    assert np.allclose(first.q, again.q)
    # as the rows have it
    assert np.allclose(np.interp(0.3 + math.tau, circuit.input, circuit["theta_2"]) % math.tau,
                       second["theta_2"] % math.tau, atol=1e-3)  # fmt: skip


def test_a_circuit_found_through_its_pose_has_that_pose():
    linkage = sb.load("seven_r")
    for q in linkage.assembly_modes(0.3).q[:3]:
        circuit = linkage.circuit(q)
        assert np.allclose(circuit.at(0.3).q, q)


def test_a_pass_is_asked_for_where_two_have_the_pose():
    circuit = sb.load("rscr").motion()[1]
    with pytest.raises(RequestError, match=r"branch: is missing; circuit 1 is there on 2 of its passes"):
        circuit.at("0.3 rad")
    one, other = (circuit.at(0.3, branch=branch) for branch in (0, 1))
    assert not np.allclose(one.q, other.q)
    assert one["crank"] == other["crank"] == pytest.approx(0.3)
    rocking = sb.four_bar(2, 1.5, 1.5, 2).motion()[0]
    with pytest.raises(RequestError, match=r"at: circuit 0 has no pose there; it goes from theta_1 = -97.18"):
        rocking.at("180 deg")


def test_a_law_leaves_the_pose_the_speed_of_the_file():
    linkage = sb.load("rssr")
    times = np.linspace(0, 1, 20)
    circuit = linkage.motion(law=sb.Law.of(times, q=times, dq=1.0, ddq=0.0))[0]
    pose = circuit.at("20 deg")
    assert pose.speed == 10.0
    assert "the speed of the file" in repr(pose)
    faster = circuit.at("20 deg", speed="20 rad/s", acceleration=5.0)
    assert np.allclose(faster.dq, 2 * pose.dq)
    assert faster.ddq[0] == pytest.approx(5.0)


def test_a_pose_prints_what_a_person_asks():
    text = repr(sb.load("rssr_press").motion()[0].at("45 deg"))
    assert text.startswith("Pose of 'RSSR press' at crank = 45.000°, on circuit 0\n")
    for word in ("60 rpm", "velocity", "link 2 ", "input torque  9.073 N m", "held by convention"):
        assert word in text


def test_what_is_no_pose_of_the_linkage_is_refused():
    linkage = sb.load("planar_4r")
    with pytest.raises(RequestError, match=r"pose: no circuit has it, of 2 poses at this theta_1"):
        linkage.at([0.3, 0.3, 0.3, 0.3])
    with pytest.raises(RequestError, match=r"pose: 3 values where the linkage has 4 columns"):
        linkage.at([0.3, 0.3, 0.3])


def test_joints_are_read_by_their_names():
    circuit = sb.load("planar_4r").motion(36)[0]
    assert np.array_equal(circuit["theta_4"], circuit.q[:, 3])
    with pytest.raises(KeyError, match=r"no column 'theta_9'; there are theta_1, theta_2, theta_3, theta_4"):
        circuit["theta_9"]
    with pytest.raises(KeyError, match=r"no column 0; there are"):
        circuit[0]


def test_frames_carry_their_units():
    pytest.importorskip("pandas")
    motion = sb.load("rssp").motion(12)
    frame = motion[0].to_frame()
    assert len(frame) == 12
    assert list(frame.columns) == list(motion.to_frame().columns)
    units = frame.attrs["units"]
    assert (units["crank_deg"], units["slider_mm_s2"]) == ("deg", "mm/s^2")
    assert units["mechanical_advantage_per_mm"] == "1/mm"
    assert "status" not in units
    assert motion.to_frame().attrs == frame.attrs


def test_modes_print_and_give_the_rates_of_each():
    said = sevenbar("modes", "planar_4r", "--at", "45deg", "--speed", "2 rad/s").stdout
    assert "rates with theta_1 at 2 rad/s" in said
    assert "-0.162889" in said
    plain = sevenbar("modes", "planar_4r").stdout
    assert "rates with" not in plain
    found = json.loads(sevenbar("modes", "rssr", "--at", "45deg", "--json").stdout)
    pose = sb.load("rssr").motion()[0].at("45 deg")
    mode = next(mode for mode in found["modes"] if mode["circuit"] == 0)
    assert mode["velocity"] == pytest.approx(pose.dq.tolist())
    assert mode["rates"] == "ok"
    assert mode["points"]["A"]["velocity"] == pytest.approx(pose.points["A"].velocity[0].tolist())
    assert mode["links"]["1"]["angular_velocity"] == pytest.approx([0, 0, 10])
    assert found["drive"]["speed"] == 10
    assert found["nearest_limit"] is None


#: Drawn four-bar of 2, 1.5, 1.5 and 2, whose crank cannot turn fully.
ROCKING = """
format = 1
drive = { joint = "a", output = "d" }
joint = [
  { name = "a", kind = "R", at = [0, 0, 0], axis = [0, 0, 1] },
  { name = "b", kind = "R", at = [2, 0, 0], axis = [0, 0, 1] },
  { name = "c", kind = "R", at = [2, 1.5, 0], axis = [0, 0, 1] },
  { name = "d", kind = "R", at = [0, 2, 0], axis = [0, 0, 1] },
]
"""


def test_where_no_mode_is_the_nearest_limit_is_named(tmp_path):
    file = tmp_path / "rocking.toml"
    file.write_text(ROCKING, encoding="utf-8")
    # crank and ground 2, coupler 1.5, rocker sqrt(4.25): stretched where they span the sum of the two
    reach = 1.5 + math.sqrt(4.25)
    limit = math.degrees(math.acos((8 - reach**2) / 8)) + 90 - 360
    assert f"the nearest limit of a is {limit:.3f}°" in sevenbar("modes", str(file), "--at=-100").stdout
    found = json.loads(sevenbar("modes", str(file), "--at=-100", "--json").stdout)
    assert found["count"] == 0
    assert math.degrees(found["nearest_limit"]) == pytest.approx(limit)
    load = "[[load]]\nlink = 2\nat = [2, 1.5, 0]\nforce = [0, -1, 0]\n"
    file.write_text(ROCKING + load, encoding="utf-8")
    assert mistake("forces", str(file), "--at=-100") == (
        f"--at: the loop does not close at a = -100.000°; the nearest limit is {limit:.3f}°"
    )


def test_forces_at_a_pose_are_the_row_of_the_file():
    found = json.loads(sevenbar("forces", "engine", "--at", "45deg", "--json").stdout)
    circuit = sb.load("engine").motion()[0]
    forces = circuit.forces()
    first = found["poses"][0]
    assert first["torque"] == pytest.approx(forces.torque[45])
    assert len(found["poses"]) == 2
    crank = forces.reactions["crank"]
    assert np.linalg.norm([x for x in first["joints"]["crank"]["force"] if x is not None]) == pytest.approx(
        np.linalg.norm(crank.force[45, :2])
    )
    rest = json.loads(sevenbar("forces", "engine", "--at", "45deg", "--speed", "0", "--json").stdout)
    assert rest["poses"][0]["torque"] == pytest.approx(circuit.forces(at_rest=True).torque[45])
    assert rest["drive"]["speed"] is None


def test_forces_at_a_pose_of_one_circuit_and_of_none():
    said = sevenbar("forces", "engine", "--at", "45deg", "--circuit", "1").stdout
    assert "circuit 1, pass 0" in said
    assert "circuit 0" not in said
    assert mistake("forces", "engine", "--at", "45deg", "--unevenness", "0.01").startswith(
        "--unevenness: is of a whole cycle, --at of one pose"
    )


def test_a_toggle_that_a_slide_drives_has_its_force_at_0(tmp_path):
    file = tmp_path / "toggle.toml"
    file.write_text(TOGGLE.format(x=200), encoding="utf-8")
    found = json.loads(sevenbar("forces", str(file), "--at", "0", "--speed", "0", "--json").stdout)
    # virtual work: 2 x = 200 + s, so dy = -(x / y) dx, and half of the ram's way is the knee's
    expected = 100 * (100 / 30) / 2
    assert sorted(abs(pose["torque"]) for pose in found["poses"]) == pytest.approx([expected] * 2)


def test_ranges_are_in_the_turn_of_modes():
    motion = sb.four_bar(2, 1.5, 2, 3).motion()
    assert math.degrees(motion[0].output_range[0]) == pytest.approx(-266.41667830)
    for text in (sb.report.markdown(motion, ranges=True), repr(motion), repr(motion[0])):
        assert "93.583° to 266.417°" in text
        assert "-266" not in text
    assert "| 0 | theta_4 | 93.583° @" in sb.report.markdown(motion, ranges=True)


@pytest.mark.parametrize(
    ("low", "high", "turn"), [(-266, -94, 360), (94, 266, 0), (-180, 180, 0), (330, 390, -360)]
)
def test_the_middle_of_a_range_lies_in_one_turn(low, high, turn):
    from sevenbar.reporting.shown import turned

    assert math.degrees(turned(math.radians(low), math.radians(high))) == pytest.approx(turn)


def test_a_textbook_crank_rocker_at_60_degrees_has_the_rates_of_its_loop_equation():
    # links 40, 120, 80 on a ground of 100, 10 rad/s; rates by the loop equation r2 + r3 = r1 + r4 and its derivatives
    a, b, c, d, theta, speed = 40.0, 120.0, 80.0, 100.0, math.pi / 3, 10.0
    linkage = sb.four_bar(a, b, c, d, speed="10 rad/s", points={"C": (2, (50, 30))})
    for circuit in linkage.loaded(loads=[sb.Load(3, torque=(0, 0, -5))]).motion():
        pose = circuit.at("60 deg")
        pin, seat = a * np.exp(1j * theta), d + c * np.exp(1j * pose["theta_4"])
        along = (seat - pin) / b
        assert abs(along) == pytest.approx(1, abs=1e-12)
        rods = np.array([1j * (seat - pin), -1j * (seat - d)])
        matrix = np.array([rods.real, rods.imag])
        right = -1j * speed * pin
        spins = np.linalg.solve(matrix, [right.real, right.imag])
        right = speed**2 * pin + spins[0] ** 2 * (seat - pin) - spins[1] ** 2 * (seat - d)
        rates = np.linalg.solve(matrix, [right.real, right.imag])
        arm = (50 + 30j) * along
        point = pose.points["C"]
        velocity = 1j * speed * pin + 1j * spins[0] * arm
        acceleration = -(speed**2) * pin + (1j * rates[0] - spins[0] ** 2) * arm
        for link, spin, rate in zip((2, 3), spins, rates, strict=True):
            assert pose.links[link].velocity[0, 2] == pytest.approx(spin, abs=1e-9)
            assert pose.links[link].acceleration[0, 2] == pytest.approx(rate, abs=1e-9)
        assert point.velocity[0, :2] == pytest.approx([velocity.real, velocity.imag], abs=1e-9)
        assert point.acceleration[0, :2] == pytest.approx([acceleration.real, acceleration.imag], abs=1e-9)
        # what goes in goes out: the torque of the input has the power of the load
        assert pose.torque == pytest.approx(5 * spins[1] / speed, abs=1e-9)
        for rate in rates:
            assert f"acceleration (0, 0, {rate:.6g}) rad/s^2" in " ".join(str(pose).split())


def test_the_modes_of_an_arm_closed_by_its_tool_reach_the_wanted_pose():
    page = (DOCS / "coming-from.md").read_text(encoding="utf-8")
    (code,) = re.findall(r"```python\n(.*?)```", page.partition("## The poses of a robot arm")[2], re.DOTALL)[
        :1
    ]
    shown = {}
    exec(code, shown)
    assert (len(shown["modes"]), shown["modes"].completeness) == (8, "algebraic")
    for q in shown["modes"].q:
        place, rotation = shown["home"].astype(float), np.eye(3)
        for (at, axis), value in zip(shown["arm"][::-1], q[5::-1], strict=True):
            x, y, z = axis
            cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
            turn = np.eye(3) + math.sin(value) * cross + (1 - math.cos(value)) * cross @ cross
            place, rotation = at + turn @ (place - at), turn @ rotation
        assert place == pytest.approx(shown["wanted"], abs=1e-9)
        assert rotation == pytest.approx(shown["turn"].as_matrix(), abs=1e-12)
