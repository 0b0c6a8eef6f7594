"""Models for other programs: URDF as MuJoCo and yourdfpy read it, the ADAMS command file by a reader of its own."""

import json
import math
import re
from functools import cache
from xml.etree import ElementTree

import mujoco
import numpy as np
import pytest
import yourdfpy

import adams_reader
import sevenbar as sb
from gallery_sample import sampled
from places import DOCS
from sevenbar.errors import OutputError, RequestError
from sevenbar.export import FORMATS, export
from sevenbar.text.units import LENGTHS

GALLERY = sampled()


def link_frames(linkage, circuit, row):
    """The frames of the moving links, from points and turns as the motion gives them [length]."""
    frames = []
    for link in range(1, len(linkage.joints)):
        own = tuple(np.linalg.inv(linkage.point_frames[link - 1])[:3, 3])
        frame = np.eye(4)
        frame[:3, :3] = circuit.link_motion(link).rotation[row]
        frame[:3, 3] = circuit.point(link, own).position[row]
        frames.append(frame)
    return frames


@pytest.fixture(scope="module")
def posed(tmp_path_factory):
    """The file of a gallery linkage in a pose of row 5 of its first circuit: the motion, the circuit, the row, the folder."""

    @cache
    def made(name, to):
        motion = sb.load(name).motion(24)
        folder = tmp_path_factory.mktemp(f"{name}_{to}")
        export(motion, to, folder / f"a.{to}", at=float(motion.circuits[0].input[5]))
        return motion, motion.circuits[0], 5, folder

    return made


def joint_values(linkage, circuit, row, scale):
    factors = np.where(linkage.turning, 1.0, scale)
    return dict(zip(linkage.columns, circuit.q[row] * factors, strict=True))


def closing(joint, values):
    """The transform of a joint of one freedom, C or U."""
    turn, slide = np.eye(4), np.eye(4)
    c, s = math.cos(values[0]), math.sin(values[0])
    turn[:2, :2] = [[c, -s], [s, c]]
    match joint["kind"]:
        case "R":
            return turn
        case "P":
            slide[2, 3] = values[0]
            return slide
        case "H":
            slide[2, 3] = joint["pitch"] * values[0] / math.tau
        case "C":
            slide[2, 3] = values[1]
    return turn @ slide


@pytest.mark.parametrize("name", GALLERY)
def test_yourdfpy_puts_the_links_of_the_tree_where_the_motion_has_them(name, posed):
    motion, circuit, row, folder = posed(name, "urdf")
    linkage = motion.linkage
    scale = LENGTHS[linkage.length_unit]
    robot = yourdfpy.URDF.load(str(folder / "a.urdf"), load_meshes=False)
    assert robot.base_link == "ground"
    values = joint_values(linkage, circuit, row, scale)
    robot.update_cfg({joint: values[joint] for joint in robot.actuated_joint_names})
    size = scale * circuit.size
    frames = link_frames(linkage, circuit, row)
    for link, frame in enumerate(frames, 1):
        found = robot.get_transform(f"link_{link}", "ground")
        np.testing.assert_allclose(found[:3, 3], scale * frame[:3, 3], rtol=0, atol=1e-9 * size)
        np.testing.assert_allclose(found[:3, :3], frame[:3, :3], rtol=0, atol=1e-9)
    side = json.loads((folder / "a.loop.json").read_text())
    joint = side["loop_joint"]
    assert joint["kind"] == linkage.joints[-1].kind
    assert side["pose"]["q"] == pytest.approx(values, rel=1e-9, abs=1e-9)
    # with the joint of the side file the loop closes
    last = robot.get_transform(joint["parent"]["link"], joint["child"]["link"])
    own = [side["pose"]["q"][column] for column in joint["columns"]]
    gap = last @ np.array(joint["parent"]["frame"]) @ closing(joint, own) - np.array(joint["child"]["frame"])
    assert np.abs(gap[:3, 3]).max() < 1e-9 * size
    assert np.abs(gap[:3, :3]).max() < 1e-9


@pytest.mark.parametrize("name", ["rssr", "seven_r", "rsur", "six_bar", "rccc"])
def test_mujoco_imports_the_tree(name, posed):
    motion, circuit, row, folder = posed(name, "urdf")
    linkage = motion.linkage
    scale = LENGTHS[linkage.length_unit]
    model = mujoco.MjModel.from_xml_path(str(folder / "a.urdf"))
    data = mujoco.MjData(model)
    for joint, value in joint_values(linkage, circuit, row, scale).items():
        if joint not in linkage.joints[-1].columns:
            data.joint(joint).qpos[0] = value
    mujoco.mj_kinematics(model, data)
    for link, frame in enumerate(link_frames(linkage, circuit, row), 1):
        body = data.body(f"link_{link}")
        np.testing.assert_allclose(body.xpos, scale * frame[:3, 3], rtol=0, atol=1e-9 * scale * circuit.size)
        np.testing.assert_allclose(body.xmat.reshape(3, 3), frame[:3, :3], rtol=0, atol=1e-9)


def test_a_rod_weighs_what_steel_does(tmp_path):
    # one link of the planar four-bar: a rod and two hubs; both readers and a hand's sum agree
    export(sb.load("planar_4r"), "urdf", tmp_path / "a.urdf")
    tree = ElementTree.parse(tmp_path / "a.urdf")
    (link,) = [element for element in tree.iter("link") if element.get("name") == "link_1"]
    total = 0.0
    for solid in link.iter("cylinder"):
        total += math.pi * float(solid.get("radius")) ** 2 * float(solid.get("length"))
    for solid in link.iter("sphere"):
        total += 4 / 3 * math.pi * float(solid.get("radius")) ** 3
    assert len(list(link.iter("cylinder"))) >= 3
    assert float(link.find("inertial/mass").get("value")) == pytest.approx(7850 * total, rel=1e-12)
    moments = {key: float(value) for key, value in link.find("inertial/inertia").attrib.items()}
    matrix = [[moments[f"i{min(a, b)}{max(a, b)}"] for b in "xyz"] for a in "xyz"]
    first, second, third = np.linalg.eigvalsh(matrix)
    assert 0 < first <= second <= third <= first + second


def test_urdf_writes_both_files_or_none_and_says_where_the_loop_is(tmp_path):
    files = export(sb.load("rssr"), "urdf", tmp_path / "a.urdf")
    assert {file.name for file in files} == {"a.urdf", "a.loop.json"}
    text = (tmp_path / "a.urdf").read_text()
    assert "'rocker' between link_3 and ground closes it and is in 'a.loop.json'" in text
    (tmp_path / "a.urdf").unlink()
    with pytest.raises(OutputError, match=r"a\.loop\.json: exists already"):
        export(sb.load("rssr"), "urdf", tmp_path / "a.urdf")
    assert not (tmp_path / "a.urdf").exists()


KIND = {
    "R": "revolute", "P": "translational", "C": "cylindrical", "H": "cylindrical", "S": "spherical", "E": "planar"
}  # fmt: skip


@pytest.mark.parametrize("name", GALLERY)
def test_adams_markers_of_each_joint_meet_and_point_the_same_way(name, posed):
    motion, circuit, row, folder = posed(name, "cmd")
    linkage = motion.linkage
    model = adams_reader.read((folder / "a.cmd").read_text())
    size = circuit.size
    assert model.units["length"] == {"mm": "mm", "in": "inch"}[linkage.length_unit]
    parts = {part.rpartition(".")[2]: frame for part, frame in model.parts.items()}
    for link, frame in enumerate(link_frames(linkage, circuit, row), 1):
        np.testing.assert_allclose(parts[f"link_{link}"], frame, rtol=0, atol=1e-9 * size)
    kinds = [kind for kind, *_ in model.joints.values()]
    for letter, kind in KIND.items():
        assert kinds.count(kind) >= linkage.kind.count(letter)
    assert kinds.count("screw") == linkage.kind.count("H")
    bodies = set()
    for kind, i_name, j_name, values in model.joints.values():
        i, j = model.markers[i_name], model.markers[j_name]
        between = np.linalg.inv(j) @ i
        bodies |= {i_name.rpartition(".")[0], j_name.rpartition(".")[0]}
        aside = np.linalg.norm(between[:2, 3]) / size
        along = abs(between[2, 3]) / size
        parallel = np.linalg.norm(between[:3, 2] - [0, 0, 1])
        if kind == "hooke":
            assert max(aside, along) < 1e-9
            assert abs(i[:3, 0] @ j[:3, 1]) < 1e-9
        elif kind == "spherical":
            assert max(aside, along) < 1e-9
        else:
            assert (along if kind == "planar" else aside) < 1e-9
            assert parallel < 1e-9
        if kind == "revolute":
            assert along < 1e-9
        if kind == "translational":
            assert np.abs(between[:3, :3] - np.eye(3)).max() < 1e-9
        if kind == "screw":
            angle = math.atan2(between[1, 0], between[0, 0])
            turns = (between[2, 3] / float(values["pitch"]) - angle / math.tau) % 1.0
            assert min(turns, 1 - turns) < 1e-9
    # every part hangs in a joint, and has its mass
    assert bodies == set(model.parts)
    assert set(model.masses) == {part for part in model.parts if not part.endswith(".ground")}
    assert all(
        float(mass[key]) > 0 for mass in model.masses.values() for key in ("mass", "ixx", "iyy", "izz")
    )


@pytest.mark.parametrize("name", GALLERY)
def test_adams_drives_the_input_from_the_pose_and_measures_input_and_output(name, posed):
    motion, circuit, row, folder = posed(name, "cmd")
    linkage = motion.linkage
    model = adams_reader.read((folder / "a.cmd").read_text())
    (drive,) = model.motions
    start, speed = drive["function"].removesuffix("*time").split(" + ")
    assert float(start) == pytest.approx(circuit.input[row], rel=1e-12, abs=1e-12)
    assert float(speed) == motion.speed
    assert model.joints[drive["joint_name"]][0] in ("revolute", "cylindrical", "translational")
    end = float(model.run["end_time"])
    if circuit.input_range is None:
        assert end == pytest.approx(circuit.turns * math.tau / abs(motion.speed), rel=1e-12)
    else:
        low, high = circuit.input_range
        assert low < float(start) + speed_of(motion) * end < high
    # AZ(I, J) and DZ(I, J, J) of the markers in the file are the columns of the motion
    for column, index in ((motion.input, circuit.input_column), (motion.output, circuit.output_column)):
        measured = [m for m in model.measures if m.rpartition(".")[2] == f"{word(column)}_position"]
        function = model.measures[measured[0]]
        markers = [marker.strip() for marker in function[3:-1].split(",")]
        between = np.linalg.inv(model.markers[markers[1]]) @ model.markers[markers[0]]
        if function.startswith("AZ"):
            assert linkage.turns(index)
            angle = math.atan2(between[1, 0], between[0, 0]) - circuit.q[row, index]
            assert abs(math.remainder(angle, math.tau)) < 1e-9
        else:
            assert between[2, 3] == pytest.approx(circuit.q[row, index], abs=1e-9 * circuit.size)


def speed_of(motion):
    return float(motion.speed)


def word(column):
    return "".join(c if c.isalnum() else "_" for c in column)


def test_adams_has_the_paper_s_linkage_in_the_paper_s_places(tmp_path):
    alpha = 0.5
    linkage = sb.load("rssr")
    export(linkage, "cmd", tmp_path / "a.cmd", at=alpha)
    model = adams_reader.read((tmp_path / "a.cmd").read_text())
    beta = linkage.output([alpha]).position[0, 0]
    joints = {name.rpartition(".")[2]: joint for name, joint in model.joints.items()}
    assert [joints[name][0] for name in ("crank", "ball_a", "ball_b", "rocker")] == [
        "revolute", "spherical", "spherical", "revolute"
    ]  # fmt: skip
    places = {
        "crank": (0, 0, 700),
        "ball_a": (250 * math.cos(alpha), 250 * math.sin(alpha), 700),
        "ball_b": (700, 550 * math.cos(beta), 550 * math.sin(beta)),
        "rocker": (700, 0, 0),
    }
    for name, place in places.items():
        for marker in joints[name][1:3]:
            np.testing.assert_allclose(model.markers[marker][:3, 3], place, rtol=0, atol=1e-9)
    assert np.abs(model.markers[joints["crank"][1]][:3, 2]) == pytest.approx([0, 0, 1], abs=1e-12)
    assert np.abs(model.markers[joints["rocker"][1]][:3, 2]) == pytest.approx([1, 0, 0], abs=1e-12)
    assert model.motions[0]["function"] == "0.5 + 10.0*time"
    assert float(model.run["end_time"]) == pytest.approx(math.tau / 10, rel=1e-15)
    for point, ball in (("point_A", "ball_a"), ("point_B", "ball_b")):
        (found,) = [frame[:3, 3] for name, frame in model.markers.items() if name.endswith(point)]
        np.testing.assert_allclose(found, places[ball], rtol=0, atol=1e-9)


def test_adams_shapes_are_where_the_parts_are(tmp_path):
    export(sb.load("rssr"), "cmd", tmp_path / "a.cmd")
    model = adams_reader.read((tmp_path / "a.cmd").read_text())
    balls = [frame[:3, 3] for kind, frame, _ in model.shapes if kind == "ellipsoid"]
    a = np.array([250.0, 0.0, 700.0])
    assert min(np.linalg.norm(ball - a) for ball in balls) < 1e-9
    crank = [
        (frame[:3, 3], frame[:3, 3] + float(values["length"]) * frame[:3, 2])
        for kind, frame, values in model.shapes
        if kind == "cylinder" and ".link_1." in values["cylinder_name"]
    ]
    assert any(np.linalg.norm(end - a) < 1e-9 for ends in crank for end in ends)


def test_names_that_adams_does_not_take_are_made_plain(tmp_path):
    text = (
        'format = 1\nname = "Kurbel \u00fc (1/2)"\n'
        '[[joint]]\nname = "5 a"\nkind = "R"\nat = [0, 0, 0]\naxis = [0, 0, 1]\n'
        '[[joint]]\nname = "x-y"\nkind = "R"\nat = [40, 0, 0]\naxis = [0, 0, 1]\n'
        '[[joint]]\nname = "x y"\nkind = "R"\nat = [90, 90, 0]\naxis = [0, 0, 1]\n'
        '[[joint]]\nname = "X_Y"\nkind = "R"\nat = [90, 0, 0]\naxis = [0, 0, 1]\n'
    )
    export(sb.loads(text), "cmd", tmp_path / "a.cmd")
    model = adams_reader.read((tmp_path / "a.cmd").read_text())
    assert [name.rpartition(".")[2] for name in model.joints] == ["joint_5_a", "x_y", "x_y_2", "X_Y_3"]


def test_micrometres_become_millimetres(tmp_path):
    text = 'format = 1\nlength_unit = "um"\n[rssr]\nM = 700\nN = 700\nL1 = 250\nL3 = 550\nD = 0\n'
    export(sb.loads(text), "cmd", tmp_path / "a.cmd")
    model = adams_reader.read((tmp_path / "a.cmd").read_text())
    assert model.units["length"] == "mm"
    (place,) = [frame[:3, 3] for name, frame in model.markers.items() if name.endswith("ball_a_i")]
    np.testing.assert_allclose(place, [0.25, 0, 0.7], rtol=0, atol=1e-12)


def test_a_motion_by_a_law_has_no_constant_speed_to_drive(tmp_path):
    law = sb.Law.of([0.0, 0.1], [0.3, 0.5], 2.0, 0.0)
    with pytest.raises(RequestError, match="cmd: a motion driven by a law has no constant speed"):
        export(sb.load("rssr").motion(law=law), "cmd", tmp_path / "a.cmd")
    assert not list(tmp_path.iterdir())


def test_the_commands_on_the_docs_page_are_those_of_today(tmp_path):
    page = (DOCS / "export.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"```\n(.*?)```", page, flags=re.DOTALL)
    export(sb.load("rssr"), None, tmp_path / "rssr.cmd")
    written = (tmp_path / "rssr.cmd").read_text()
    commands = block.split("!\n")[:-1]
    assert len(commands) == 3
    assert all(f"{command}!\n" in written for command in commands)
    for word, form in FORMATS.items():
        assert f"`{word}`" in page, form
