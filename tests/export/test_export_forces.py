"""Files for other programs hold the masses that a linkage has, and what acts on it as far as they can."""

import math
import re
from xml.etree import ElementTree

import mujoco
import numpy as np
import pytest

import adams_reader
import sevenbar as sb
from command_runs import sevenbar
from loaded import random_body
from sevenbar.export import export
from sevenbar.kinematics.dynamics.link_bodies import resolved

NAMES = ["rssr", "seven_r", "rscr", "rsur"]


def loaded(name):
    """A linkage with masses on all links but the second, weight, loads and springs of every kind."""
    linkage = sb.load(name)
    last, rng = len(linkage.joints), np.random.default_rng(3)
    size = linkage.motion(8).circuits[0].size
    return linkage.loaded(
        bodies={link: random_body(rng, size) for link in range(1, last) if link != 2},
        gravity=(1.0, 2.0, -9.8),
        loads=[
            sb.Load(1, (3.0, 4.0, -5.0), (0.1, 0.2, 0.3), at=(0.1 * size, 0.0, 0.0), axes="link"),
            sb.Load(1, (1.0, -2.0, 5.0), at=(0.1 * size, 0.0, 0.0), between=(5.5, 2.0)),
            sb.Load(1, torque=(0.0, 0.0, 5.0), table=((0.0, 1.0), (0.0, 1.0))),
        ],
        springs=[
            sb.Spring(0.3, 0.4 * size, 0.01, links=(1, last), at=((0.1 * size, 0.0, 0.0), (0.0, 0.0, size))),
            sb.Spring(2.0, 0.1, 0.3, joint=linkage.drive.output),
        ],
    )


def own(linkage, link, metre):
    """Mass, centre [m] and inertia [kg m2] of a link's body in the link's frame."""
    body = resolved(linkage.loading, linkage)[link]
    frame = linkage.point_frames[link - 1]
    centre = frame[:3, :3] @ np.array(body.centre) + frame[:3, 3]
    return body.mass, metre * centre, frame[:3, :3] @ body.tensor @ frame[:3, :3].T


def of_mujoco(model, name):
    body = model.body(name)
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, body.iquat)
    turn = turn.reshape(3, 3)
    return body.mass[0], body.ipos, turn @ np.diag(body.inertia) @ turn.T


@pytest.mark.parametrize("to", ["urdf", "mjcf"])
@pytest.mark.parametrize("name", NAMES)
def test_mujoco_reads_the_masses_of_the_linkage(name, to, tmp_path):
    linkage = loaded(name)
    path = tmp_path / f"a.{'xml' if to == 'mjcf' else to}"
    export(linkage, to, path, samples=24)
    model = mujoco.MjModel.from_xml_path(str(path))
    heaviest = max(body.mass for body in resolved(linkage.loading, linkage).values())
    for link in range(1, len(linkage.joints)):
        mass, centre, inertia = of_mujoco(model, f"link_{link}")
        if link == 2:
            assert 0 < mass < 1e-4 * heaviest
            continue
        expected = own(linkage, link, 1e-3)
        assert mass == pytest.approx(expected[0], rel=1e-12)
        np.testing.assert_allclose(centre, expected[1], atol=1e-12)
        np.testing.assert_allclose(inertia, expected[2], atol=1e-5 * np.abs(expected[2]).max())


def test_mjcf_has_weight_and_springs_and_says_that_loads_are_left_out(tmp_path):
    linkage = loaded("rssr")
    (path,) = export(linkage, "mjcf", tmp_path / "a.xml", samples=24)
    model = mujoco.MjModel.from_xml_path(str(path))
    assert model.opt.gravity == pytest.approx([1.0, 2.0, -9.8])
    tendon, joint = model.tendon("spring_1").id, model.joint("rocker")
    size = linkage.motion(8).circuits[0].size
    assert model.tendon_stiffness[tendon] == pytest.approx(300)
    assert model.tendon_damping[tendon] == pytest.approx(10)
    assert model.tendon_lengthspring[tendon] == pytest.approx([4e-4 * size] * 2)
    assert joint.stiffness[0] == 2
    assert joint.damping[0] == 0.3
    assert joint.qpos_spring[0] == 0.1
    assert "3 loads of the linkage not here: MJCF has none" in path.read_text()


def test_urdf_says_what_it_leaves_out(tmp_path):
    own, plain = tmp_path / "a.urdf", tmp_path / "b.urdf"
    export(loaded("rssr"), "urdf", own, samples=24)
    export(sb.load("rssr"), "urdf", plain, samples=24)
    assert "Left out, for URDF has no place for it: gravity, 3 loads, 2 springs." in own.read_text()
    assert "Left out" not in plain.read_text()


@pytest.mark.parametrize("name", NAMES)
def test_adams_has_the_masses_of_the_linkage_and_its_weight(name, tmp_path):
    linkage = loaded(name)
    (path,) = export(linkage, "cmd", tmp_path / "a.cmd", samples=24)
    model = adams_reader.read(path.read_text())
    assert model.gravity == pytest.approx([1000.0, 2000.0, -9800.0])
    parts = {part.rpartition(".")[2]: (part, values) for part, values in model.masses.items()}
    for link in range(1, len(linkage.joints)):
        part, values = parts[f"link_{link}"]
        if link == 2:
            assert float(values["mass"]) < 1e-4
            continue
        mass, centre, inertia = own(linkage, link, 1.0)
        frame = np.linalg.inv(model.parts[part]) @ model.markers[values["center_of_mass_marker"]]
        moments = np.diag([float(values[key]) for key in ("ixx", "iyy", "izz")])
        assert float(values["mass"]) == pytest.approx(mass, rel=1e-12)
        np.testing.assert_allclose(frame[:3, 3], centre, atol=1e-9)
        found = 1e-6 * frame[:3, :3] @ moments @ frame[:3, :3].T
        np.testing.assert_allclose(found, inertia, atol=1e-5 * np.abs(inertia).max())


def test_adams_has_loads_and_springs_where_the_linkage_has_them(tmp_path):
    linkage = loaded("rssr")
    circuit = linkage.motion(24).circuits[0]
    (path,) = export(linkage.motion(24), "cmd", tmp_path / "a.cmd", at=float(circuit.input[5]))
    text = path.read_text()
    model = adams_reader.read(text)
    (spring,) = model.springs.values()
    size = circuit.size
    assert [float(spring[k]) for k in ("stiffness", "damping", "displacement_at_preload")] == [
        0.3,
        0.01,
        0.4 * size,
    ]
    point = circuit.point(1, (0.1 * size, 0.0, 0.0)).position[5]
    np.testing.assert_allclose(model.markers[spring["i_marker_name"]][:3, 3], point, atol=1e-9)
    np.testing.assert_allclose(model.markers[spring["j_marker_name"]][:3, 3], [0, 0, size], atol=1e-9)
    forces = {name.rpartition(".")[2]: values for name, values in model.forces.items()}
    assert set(forces) == {"load_1", "load_2", "spring_2"}
    carried = forces["load_1"]
    assert [float(f) for f in carried["functions"]] == pytest.approx([3, 4, -5, 100, 200, 300])
    assert carried["ref_marker_name"] == carried["i_marker_name"]
    np.testing.assert_allclose(model.markers[carried["i_marker_name"]][:3, 3], point, atol=1e-9)
    still = forces["load_2"]
    np.testing.assert_allclose(model.markers[still["ref_marker_name"]], np.eye(4), atol=1e-12)
    # from 5.5 rad over the whole turn up to 2 rad
    share, _, value = still["functions"][1].rpartition("*")
    assert float(value) == -2
    for angle in np.linspace(-7, 7, 57):
        script = share.replace("IF(", "_if(").replace(":", ",").replace("PI", "math.pi")
        script = re.sub(r"\d\.\d+ \+ 10\.0\*time", f"({float(angle)!r})", script)
        acts = eval(
            script,
            {"_if": lambda x, a, b, c: a if x < 0 else b if x == 0 else c, "MOD": math.fmod, "math": math},
        )
        assert acts == ((angle - 5.5) % math.tau <= (2.0 - 5.5) % math.tau), angle
    joint = forces["spring_2"]
    i, j = joint["i_marker_name"], joint["ref_marker_name"]
    assert [part.rpartition(".")[2] for part in (i, j)] == ["rocker_i", "rocker_j"]
    assert joint["functions"][5] == f"-2000.0*(AZ({i}, {j}) - 0.1) - 300.0*WZ({i}, {j}, {j})"
    assert joint["functions"][:5] == ["0.0"] * 5
    assert "! Left out, for it follows a table: 1 load." in text
    assert "masses are those of\n! the linkage; parts that have none weigh 1e-06 of the heaviest" in text
    assert "No gravity" not in text


def test_a_rod_has_a_little_inertia_about_its_line_and_drawn_bodies_are_as_drawn(tmp_path):
    plain = sb.load("rssr")
    linkage = plain.loaded(
        bodies={1: sb.Body(solid="drawn"), 2: sb.Body(1.2, solid="rod"), 3: sb.Body(solid="drawn")}
    )
    trees = []
    for name, source in (("a", plain), ("b", linkage)):
        path = tmp_path / f"{name}.urdf"
        export(source, "urdf", path)
        trees.append({link.get("name"): link for link in ElementTree.parse(path).iter("link")})
    masses = [
        [float(tree[f"link_{k}"].find("inertial/mass").get("value")) for k in (1, 2, 3)] for tree in trees
    ]
    assert masses[1] == pytest.approx([masses[0][0], 1.2, masses[0][2]])
    moments = trees[1]["link_2"].find("inertial/inertia").attrib
    matrix = [[float(moments[f"i{min(a, b)}{max(a, b)}"]) for b in "xyz"] for a in "xyz"]
    least, across, _ = np.linalg.eigvalsh(matrix)
    assert 0 < least < 1e-5 * across


def test_the_command_says_whose_masses_they_are(tmp_path):
    source = tmp_path / "own.toml"
    source.write_text(
        'format = 1\nname = "own"\n[rssr]\nM = 700\nN = 700\nL1 = 250\nL3 = 550\nD = 0\n'
        '[[body]]\nlink = 3\nmass = 2\nsolid = "rod"\n'
    )
    run = sevenbar("export", str(source), "--to", "urdf", cwd=tmp_path)
    assert "masses are the linkage's own; bodies that have none weigh next to nothing" in run.stdout
