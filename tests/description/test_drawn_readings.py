"""What joints read in the drawing: the same linkage with and without `value` answers shifted by it."""

import copy
import math
from xml.etree import ElementTree

import numpy as np
import pytest
from pyarrow.parquet import read_table

import sevenbar as sb
from command_runs import sevenbar
from sevenbar.description.draft import Draft
from sevenbar.description.forms import from_description
from sevenbar.description.table_writer import linkage_table
from sevenbar.description.toml_text import toml_text
from sevenbar.errors import DescriptionError, RequestError
from sevenbar.export import export
from sevenbar.kinematics.loop.geometry import Joint
from sevenbar.studio.state.session import Session

#: The slide between two moving links, so that a rod ends on it; stops, a load, springs in joints.
INVERTED = {
    "format": 1,
    "name": "inverted slider-crank",
    "joint": [
        {"kind": "R", "at": [0, 0, 0], "axis": [0, 0, 1], "name": "crank"},
        {"kind": "R", "at": [30, 20, 0], "axis": [0, 0, 1], "name": "pin"},
        {"kind": "P", "at": [60, -10, 0], "axis": [1, 0.2, 0], "name": "slide"},
        {"kind": "R", "at": [100, 0, 0], "axis": [0, 0, 1], "name": "rocker"},
    ],
    "drive": {"joint": "crank", "output": "rocker", "speed": "2 rad/s"},
    "forces": {"gravity": [0, -9.81, 0]},
    "body": [{"link": 1, "mass": 1.0, "solid": "rod"}, {"link": 2, "mass": 2.0, "solid": "rod"}],
    "spring": [
        {"joint": "rocker", "stiffness": "0.5 N m/rad", "free": 10},
        {"joint": "slide", "stiffness": "200 N/m", "free": 5},
    ],
    "load": [{"link": 2, "at": [40, 10, 0], "force": [3, 0, 0], "between": [12, 83]}],
    "stop": [{"joint": "rocker", "range": [-25, 15]}, {"joint": "slide", "range": [-100, 60]}],
    "point": [{"name": "Q", "link": 2, "at": [50, 30, 0]}],
}

#: What its joints read: multiples of the step of 5 degrees, so that rows of both are the same poses.
READINGS = {"crank": 40, "pin": -25, "slide": -12.5, "rocker": 65}

#: An RSSR drawn, a pattern with its closed form, and a loop in which nothing turns.
DRAWN_RSSR = [
    {"kind": "R", "at": (0, 0, 700), "axis": (0, 0, 1), "name": "crank"},
    {"kind": "S", "at": (250, 0, 700)},
    {"kind": "S", "at": (700, 550, 0)},
    {"kind": "R", "at": (700, 0, 0), "axis": (1, 0, 0), "name": "rocker"},
]
WEDGE = [
    {"kind": "P", "at": (0, 0, 0), "axis": axis, "name": name}
    for name, axis in (("a", (1, 0, 0)), ("b", (0, 1, 0)), ("c", (1, 1, 0)))
]

#: Differences of the same values by other ways of rounding.
ROUNDED = 1e-9


def reading(raw, readings):
    """A description whose joints read other values as drawn; what is counted in them goes along."""
    own = copy.deepcopy(dict(raw))
    for joint in own["joint"]:
        if joint["name"] in readings:
            joint["value"] = readings[joint["name"]]
    for spring in own.get("spring", ()):
        spring["free"] += readings.get(spring["joint"], 0)
    for stop in own.get("stop", ()):
        stop["range"] = [limit + readings.get(stop["joint"], 0) for limit in stop["range"]]
    for load in own.get("load", ()):
        load["between"] = [limit + readings.get("crank", 0) for limit in load["between"]]
    return own


def same_rows(linkage, a, b):
    """The row of a circuit that is each row of the other, whose joints read what `linkage` has as drawn."""
    off = b.q[:, None] - linkage.drawn_pose - a.q[None]
    off = np.abs(np.where(linkage.turning, off - math.tau * np.round(off / math.tau), off)).max(axis=2)
    assert off.min(axis=1).max() < ROUNDED
    return off.argmin(axis=1)


@pytest.mark.parametrize("names", [["slide"], ["crank"], ["rocker"], ["pin"], [*READINGS]])
def test_a_linkage_whose_joints_read_otherwise_moves_and_bears_the_same(names):
    plain = from_description(INVERTED)
    other = from_description(reading(INVERTED, {name: READINGS[name] for name in names}))
    a, b = (linkage.motion(72) for linkage in (plain, other))
    shift = other.drawn_pose
    assert np.degrees(shift[0]) == pytest.approx(READINGS["crank"] if "crank" in names else 0)
    assert (a.motion_type, len(a.circuits)) == (b.motion_type, len(b.circuits))
    one, same = a.circuits[0], b.circuits[0]
    rows = same_rows(other, one, same)
    assert np.abs(one.dq[rows] - same.dq).max() < ROUNDED
    point = one.point("Q").position[rows] - same.point("Q").position
    assert np.abs(point).max() < ROUNDED
    # a place by two numbers goes along the link as drawn
    for link in (1, 2, 3, 4):
        assert (
            np.abs(one.point(link, (7, 3)).position[rows] - same.point(link, (7, 3)).position).max() < ROUNDED
        )
    first, second = one.forces(), same.forces()
    assert np.abs(first.torque[rows] - second.torque).max() < ROUNDED
    for joint, moved in zip(first.reactions.values(), second.reactions.values(), strict=True):
        assert np.nanmax(np.abs(joint.force[rows] - moved.force)) < ROUNDED
        assert np.nanmax(np.abs(joint.moment[rows] - moved.moment)) < ROUNDED
        assert np.nanmax(np.abs(joint.at[rows] - moved.at)) < ROUNDED
    spans = sorted((span.share, span.first_stop) for span in one.allowed.spans)
    assert spans == [
        (pytest.approx(share), stop)
        for share, stop in sorted((span.share, span.first_stop) for span in same.allowed.spans)
    ]
    rests = [sorted((place.kind, place.holding) for place in c.equilibria()) for c in (one, same)]
    assert [kind for kind, _ in rests[0]] == [kind for kind, _ in rests[1]]
    known = [[holding for _, holding in rest if np.isfinite(holding)] for rest in rests]
    assert known[0] == pytest.approx(known[1])


def test_the_drawn_pose_is_where_a_linkage_begins():
    other = from_description(reading(INVERTED, READINGS))
    circuit = other.motion().circuits[0]
    fall = circuit.free_motion("0.01 s")
    assert math.degrees(fall.input[0]) == pytest.approx(READINGS["crank"])
    session = Session(toml_text(reading(INVERTED, READINGS)), "b.toml")
    session.as_drawn()
    values = session.view.joints(session.row)
    assert values == pytest.approx(other.drawn_pose, abs=1e-6)


def test_a_drawn_rssr_reads_what_it_is_given():
    plain = sb.from_axes(DRAWN_RSSR)
    other = sb.from_axes(
        [{**joint, **({"value": "30 deg"} if joint["kind"] == "R" else {})} for joint in DRAWN_RSSR]
    )
    a, b = plain.motion(72), other.motion(72)
    assert (a.motion_type, len(a.circuits)) == (b.motion_type, len(b.circuits))
    for one, same in zip(a.circuits, b.circuits, strict=True):
        low, high = one.output_range
        assert same.output_range == pytest.approx((low + math.pi / 6, high + math.pi / 6))
    modes = plain.assembly_modes("10 deg").q[:, [0, 7]], other.assembly_modes("40 deg").q[:, [0, 7]]
    assert np.cos(modes[1][:, 1] - modes[0][:, 1]) == pytest.approx(math.cos(math.pi / 6))


def test_where_nothing_turns_the_drawn_pose_is_still_known():
    # one circuit, of the drawn pose alone
    other = sb.from_axes([{**joint, "value": value} for joint, value in zip(WEDGE, (1, -2, 3), strict=True)])
    (circuit,) = other.motion(12).circuits
    a, b, c = (circuit.q[:, k] for k in range(3))
    # the last one counts the link before it against the ground
    assert a - 1 == pytest.approx((c - 3) / math.sqrt(2))
    assert b + 2 == pytest.approx(a - 1)


def test_readings_survive_files_tables_and_other_dimensions(tmp_path):
    file = tmp_path / "b.toml"
    raw = reading({k: v for k, v in INVERTED.items() if k != "spring"}, READINGS)
    raw["joint"][2]["value"] = "-1.25 cm"
    file.write_text(toml_text(raw))
    pose = from_description(reading(INVERTED, READINGS)).drawn_pose
    read = sb.load(file)
    assert read.drawn_pose == pytest.approx(pose)
    assert copy.copy(read).drawn_pose == pytest.approx(pose)
    draft = Draft.of(file.read_text(), "b.toml")
    assert draft.with_values({"pin.x": 31}).linkage.drawn_pose == pytest.approx(pose)
    assert Draft.of(draft.with_values({"pin.x": 31}).toml(), "c").linkage.drawn_pose == pytest.approx(pose)
    head, rows = linkage_table(read)
    table = tmp_path / "b.csv"
    cells = [["" if cell is None else str(cell) for cell in row] for row in rows]
    table.write_text("\n".join(",".join(row) for row in [head, *cells]))
    assert sb.load(table).drawn_pose == pytest.approx(pose)


@pytest.mark.parametrize(
    ("joint", "message"),
    [
        ({"kind": "C", "value": 1}, "value: is of joints R and P; one of kind C reads 0 as drawn"),
        (
            {"kind": "H", "pitch": 3, "value": 1},
            "value: is of joints R and P; one of kind H reads 0 as drawn",
        ),
        ({"kind": "R", "value": "3 mm"}, "value: '3 mm': is a length where an angle belongs"),
        ({"kind": "P", "value": "3 deg"}, "value: '3 deg': is an angle where a length belongs"),
        ({"kind": "P", "value": [1, 2]}, r"value: \[1, 2\] is not a number"),
    ],
)
def test_a_wrong_reading_is_refused(joint, message):
    joints = copy.deepcopy(INVERTED["joint"])
    joints[2] = {**joints[2], **joint}
    with pytest.raises(DescriptionError, match=rf"joint\[3\]\.{message}"):
        sb.from_axes(joints)


def test_rows_have_no_reading(tmp_path):
    file = tmp_path / "rows.toml"
    file.write_text("format = 1\n" + "\n[[link]]\nlength = 4\nvalue = 3\n" + 3 * "\n[[link]]\nlength = 4\n")
    with pytest.raises(
        DescriptionError, match=r"link\[1\]\.value: is of joints as drawn; a row reads its own"
    ):
        sb.load(file)


def test_a_joint_that_moves_nothing_else_has_no_reading():
    joints = [
        {"kind": "R", "at": (x, y, 0), "axis": (0, 0, 1)}
        for x, y in ((0, 0), (30, 0), (30, 0), (130, 80), (100, 0))
    ]
    joints[2]["value"] = 20
    with pytest.raises(RequestError, match="value: joint 'theta_3' reads 0 wherever it is"):
        sb.from_axes(joints).motion()


def test_a_joint_by_hand_takes_its_reading():
    assert Joint("R", "a", value="30 deg").value == pytest.approx(math.pi / 6)
    assert Joint("P", "a", value=-0.2).value == -0.2
    with pytest.raises(RequestError, match="value: is of joints R and P"):
        Joint("S", "a", value=1.0)


def test_the_commands_count_from_the_reading(tmp_path):
    file = tmp_path / "b.toml"
    file.write_text(toml_text(reading(INVERTED, READINGS)))
    shown = sevenbar("modes", file, "--at", "40deg").stdout
    assert all(value in shown for value in ("-12.500", "65.000", "-25.000"))


def test_two_numbers_on_the_ground_of_a_drawing_go_from_its_last_joint_to_its_first():
    for off in (0, 5):
        bar = [(0, 0), (20, 10), (80, 70), (90, 0)]
        joints = [{"kind": "R", "at": (off + x, off + y, 0), "axis": (0, 0, 1)} for x, y in bar]
        place = sb.from_axes(joints).motion(12).circuits[0].point(4, (10, 5)).position[0]
        assert place == pytest.approx([off + 80, off - 5, 0])


def test_sweeps_pictures_and_models_are_those_of_the_same_linkage(tmp_path):
    files = {"plain": INVERTED, "reading": reading(INVERTED, READINGS)}
    swings, pictures, values = [], [], []
    for name, raw in files.items():
        file = tmp_path / f"{name}.toml"
        file.write_text(toml_text(raw))
        run = sevenbar(
            "sweep",
            file,
            "--over",
            "pin.x=28:32:3",
            "--measure",
            "swing",
            "--out",
            tmp_path / f"{name}_sweep",
        )
        assert run.returncode == 0, run.stderr
        table = read_table(tmp_path / f"{name}_sweep" / "part-000000.parquet")
        swings.append(table["swing_deg"].to_numpy())
        run = sevenbar("plot", file, "--kind", "skeleton", "--figures", "png", "--out", tmp_path / name)
        assert run.returncode == 0, run.stderr
        pictures.append((tmp_path / name / "skeleton.png").read_bytes())
        linkage = sb.load(file)
        start = math.radians(READINGS["crank"]) * (name == "reading")
        (path,) = export(linkage.motion(72), "mjcf", tmp_path / f"{name}.xml", at=start)[:1]
        joints = {
            joint.get("name"): float(joint.get("ref")) for joint in ElementTree.parse(path).iter("joint")
        }
        values.append([joints[joint.name] for joint in linkage.joints])
    assert swings[0] == pytest.approx(swings[1])
    assert pictures[0] == pictures[1]
    # metres in MuJoCo
    off = (np.array(values[1]) - values[0] - linkage.drawn_pose * [1, 1, 1e-3, 1]) * [1, 1, 1e3, 1]
    assert np.abs(off - math.tau * np.round(off / math.tau) * linkage.turning).max() < 1e-6
