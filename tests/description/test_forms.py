"""The frames that a description turns into, against an independent product of matrices; every message for a wrong one."""

import json

import numpy as np
import pytest

import sevenbar as sb
from places import ROOT

REFERENCES = ROOT / "tests" / "references"
EXAMPLE = (ROOT / "examples" / "seven_r.toml").read_text(encoding="utf-8")
PAPER = json.loads((REFERENCES / "seven_r_modes.json").read_text(encoding="utf-8"))
SIXTEEN = json.loads((REFERENCES / "seven_r_sixteen_modes.json").read_text(encoding="utf-8"))


# An independent product of the loop


def turn(axis, angle):
    """About x, y or z (0, 1, 2)."""
    c, s = np.cos(angle), np.sin(angle)
    matrix = np.eye(4)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix[i, i], matrix[i, j], matrix[j, i], matrix[j, j] = c, -s, s, c
    return matrix


def slide(axis, distance):
    matrix = np.eye(4)
    matrix[axis, 3] = distance
    return matrix


def joint_motion(joint, q):
    match joint.kind:
        case "R":
            return turn(2, q[0])
        case "P":
            return slide(2, q[0])
        case "H":
            return turn(2, q[0]) @ slide(2, joint.pitch * q[0] / (2 * np.pi))
        case "C":
            return turn(2, q[0]) @ slide(2, q[1])
        case "U":
            return turn(2, q[0]) @ turn(0, joint.angle) @ turn(2, q[1])
        case "S":
            return turn(2, q[0]) @ turn(1, q[1]) @ turn(0, q[2])


def link_frames(linkage, q):
    """The frame just after each joint, in the report frame."""
    frames, here, start = [], linkage.base, 0
    for joint, link in zip(linkage.joints, [*linkage.links, np.eye(4)], strict=True):
        end = start + len(joint.columns)
        here = here @ joint_motion(joint, q[start:end])
        frames.append(here)
        here = here @ link
        start = end
    return frames


def closure(linkage, q):
    """How far the last frame is from where the ground has it."""
    return np.abs(link_frames(linkage, q)[-1] - linkage.ground).max()


def position(linkage, q, link, at):
    # the ground's own frame is the report frame
    frames = [*link_frames(linkage, q)[:-1], np.eye(4)]
    return (frames[link - 1] @ linkage.point_frames[link - 1] @ [*at, 1.0])[:3]


# Denavit-Hartenberg rows


def from_reference(loop):
    return sb.from_dh(
        "RRRRRRR", length=loop["length"], twist=np.radians(loop["twist_deg"]), offset=loop["offset"]
    )


def test_the_paper_s_loop_closes_at_each_of_its_modes():
    linkage = from_reference(PAPER)
    for mode in PAPER["modes"]:
        assert closure(linkage, mode["theta"]) < 1e-12


def test_the_point_of_the_paper_is_where_the_reference_has_it():
    linkage = sb.loads(EXAMPLE)
    (point,) = linkage.points
    for mode in PAPER["modes"]:
        got = position(linkage, mode["theta"], point.link, point.at)
        np.testing.assert_allclose(got, mode["r4"], rtol=0, atol=1e-10)


def test_the_loop_of_sixteen_modes_closes_at_each_of_them():
    linkage = from_reference(SIXTEEN["loop"])
    assert len(SIXTEEN["modes_deg"]) == 16
    for mode in SIXTEEN["modes_deg"]:
        # the source prints eight decimals of a degree
        assert closure(linkage, np.radians(mode)) < 1e-9


def random_rows(rng, kinds):
    count = len(kinds)
    rows = {
        "length": rng.normal(size=count),
        "twist": rng.uniform(-np.pi, np.pi, count),
        "offset": [None if kind == "P" else rng.normal() for kind in kinds],
        "angle": [rng.normal() if kind == "P" else None for kind in kinds],
        "pitch": [rng.normal() if kind == "H" else None for kind in kinds],
    }
    return rows, sb.from_dh(kinds, **rows)


def row_motion(rows, kinds, i, q):
    """`A_i` of the textbook, of any kind of row."""
    theta = rows["angle"][i] if kinds[i] == "P" else q
    offset = q if kinds[i] == "P" else rows["offset"][i]
    if kinds[i] == "H":
        offset += rows["pitch"][i] * q / (2 * np.pi)
    return turn(2, theta) @ slide(2, offset), slide(0, rows["length"][i]) @ turn(0, rows["twist"][i])


@pytest.mark.parametrize("kinds", ["RRRRRRR", "PRHRP", "HHH", "RPRPRPH", "RP", "RH", "HP"])
def test_rows_multiply_to_the_textbook_s_product(kinds):
    rng = np.random.default_rng(3)
    rows, linkage = random_rows(rng, kinds)
    q = rng.normal(size=len(kinds))
    product = np.eye(4)
    for i in range(len(kinds)):
        joint, link = row_motion(rows, kinds, i, q[i])
        product = product @ joint @ link
    base = linkage.base
    ours = np.linalg.inv(base) @ link_frames(linkage, q)[-1] @ np.linalg.inv(linkage.ground) @ base
    np.testing.assert_allclose(ours, product, rtol=0, atol=1e-13)


@pytest.mark.parametrize("kinds", ["RRRRRRR", "PRHRP", "HHH", "RPRPRPH", "RP", "RH", "HP"])
def test_a_point_of_a_row_stands_in_the_frame_of_its_joint_and_link(kinds):
    """u along the joint, v along the link, w = u x v; u counts from before a fixed offset, from behind a slide."""
    rng = np.random.default_rng(4)
    rows, linkage = random_rows(rng, kinds)
    q = rng.normal(size=len(kinds))
    u, v, w = at = rng.normal(size=3)
    here = linkage.base
    for i in range(len(kinds)):
        joint, link = row_motion(rows, kinds, i, q[i])
        after = here @ joint
        along_joint, along_link = after[:3, 2], after[:3, 0]
        fixed = 0.0 if kinds[i] == "P" else rows["offset"][i]
        origin = after[:3, 3] - fixed * along_joint
        want = origin + u * along_joint + v * along_link + w * np.cross(along_joint, along_link)
        if i < len(kinds) - 1:
            np.testing.assert_allclose(position(linkage, q, i + 1, at), want, rtol=0, atol=1e-13)
        here = after @ link
    # the report frame begins where the ground link does, behind the last joint's own offset
    np.testing.assert_allclose(position(linkage, q, len(kinds), at), [u - fixed, v, w], rtol=0, atol=1e-13)


def test_square_twists_are_square_to_the_last_digit():
    linkage = sb.loads("format = 1\n[[link]]\ntwist = 90\n[[link]]\ntwist = 180\n[[link]]\ntwist = -270\n")
    transforms = np.concatenate([linkage.links, [linkage.base]])
    assert set(np.unique(transforms)) <= {-1.0, 0.0, 1.0}
    tiny = sb.from_dh("RR", length=[1, 1], twist=[1e-20, 0], offset=[0, 0])
    assert tiny.links[0, 2, 1] == 1e-20


def test_file_and_call_give_the_same_rows():
    file, call = sb.loads(EXAMPLE), from_reference(PAPER)
    np.testing.assert_array_equal(file.transforms, call.transforms)
    assert file.dimensions == call.dimensions
    assert list(file.dimensions.items())[:4] == [
        ("length_1", 45.0),
        ("twist_1_deg", 80.0),
        ("offset_1", 70.0),
        ("length_2", 15.0),
    ]
    assert file.columns == tuple(f"theta_{i}" for i in range(1, 8))
    assert (file.drive.joint, file.drive.output) == ("theta_1", "theta_7")
    assert file.points == (sb.Point("P", 4, (-100.0, -90.0, -80.0)),)


def test_a_file_in_radians_is_read_as_such():
    radians = EXAMPLE.replace('angle_unit = "deg"', 'angle_unit = "rad"')
    for degrees in (80, -95, -75, 150):
        radians = radians.replace(f"twist = {degrees}\n", f"twist = {float(np.radians(degrees))!r}\n")
    np.testing.assert_array_equal(sb.loads(radians).transforms, sb.loads(EXAMPLE).transforms)


def test_rows_of_slides_and_screws_name_what_is_fixed():
    linkage = sb.from_dh(
        "RPH",
        length=[1, 2, 3],
        twist=[0, 1, 0],
        offset=[4, 0, 5],
        angle=[0, np.pi / 6, 0],
        pitch=[0, 0, 7],
        names=["a", "b", "c"],
    )
    assert linkage.columns == ("a", "b", "c")
    assert linkage.joints[2].pitch == 7.0
    keys = set(linkage.dimensions)
    assert {"angle_2_deg", "pitch_3", "offset_3"} <= keys
    assert not {"offset_2", "angle_1_deg", "pitch_1"} & keys
    assert linkage.dimensions["angle_2_deg"] == 30.0


# Drawings


def drawing(rng, kinds):
    joints = []
    for kind in kinds:
        joint = {"kind": kind, "at": rng.normal(size=3)}
        if kind == "U":
            joint["axes"] = rng.normal(size=(2, 3))
        elif kind != "S":
            joint["axis"] = rng.normal(size=3)
        if kind == "H":
            joint["pitch"] = 0.7
        joints.append(joint)
    return joints


LOOPS = ["RSSR", "RCCC", "RUSR", "URPHCUS", "PPHC", "UU", "SCR", "RRRRRRR", "SRSU"]


@pytest.mark.parametrize("kinds", LOOPS)
def test_a_drawn_loop_closes_at_zero_and_carries_its_points(kinds):
    linkage = sb.from_axes(drawing(np.random.default_rng(5), kinds))
    assert linkage.kind == kinds
    zero = np.zeros(len(linkage.columns))
    assert closure(linkage, zero) < 1e-14
    for link in range(1, len(kinds) + 1):
        np.testing.assert_allclose(position(linkage, zero, link, (1, 2, 3)), [1, 2, 3], rtol=0, atol=1e-14)


@pytest.mark.parametrize("kinds", LOOPS)
def test_a_drawn_joint_moves_about_its_axes_as_written(kinds):
    """Right-handed turns and slides of the links after it, a joint at a time; of a ball about z, y, x of the ground.

    The last joint moves the links before it so, seen from the ground: from these the ground goes the other way.
    """
    joints = drawing(np.random.default_rng(6), kinds)
    linkage = sb.from_axes(joints)
    column = 0
    for i, joint in enumerate(joints):
        axes = joint.get("axes", [joint["axis"]] if "axis" in joint else np.eye(3)[::-1])
        if joint["kind"] == "C":
            axes = axes * 2
        last = i == len(joints) - 1
        if last and joint["kind"] == "S":
            # in loop order from the link to the ground, the turn about x comes first
            axes = axes[::-1]
        for k, axis in enumerate(axes):
            q = np.zeros(len(linkage.columns))
            q[column] = 0.3
            axis = np.asarray(axis) / np.linalg.norm(axis)
            moved = link_frames(linkage, q)[i] @ np.linalg.inv(link_frames(linkage, 0 * q)[i])
            moved = np.linalg.inv(moved) if last else moved
            slides = joint["kind"] == "P" or (joint["kind"] == "C" and k == 1)
            cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
            rotation = (
                np.eye(3) if slides else np.eye(3) + np.sin(0.3) * cross + (1 - np.cos(0.3)) * cross @ cross
            )
            along = 0.3 if slides else 0.7 * 0.3 / (2 * np.pi) if joint["kind"] == "H" else 0.0
            np.testing.assert_allclose(moved[:3, :3], rotation, rtol=0, atol=1e-14)
            place = joint["at"]
            np.testing.assert_allclose(
                moved[:3, :3] @ place + moved[:3, 3], place + along * axis, rtol=0, atol=1e-14
            )
            column += 1


@pytest.mark.parametrize("kinds", LOOPS)
def test_the_links_of_a_drawing_do_not_depend_on_the_frame_it_is_drawn_in(kinds):
    """But for the frames of balls, which are the ground's: there the two links at the ball are seen together."""
    rng = np.random.default_rng(7)
    joints = drawing(rng, kinds)
    motion = slide(0, 3.0) @ turn(0, 0.4) @ turn(1, -2.0) @ turn(2, 1.1) @ slide(1, -2.0)
    moved = [
        {
            key: value @ motion[:3, :3].T + (motion[:3, 3] if key == "at" else 0)
            if isinstance(value, np.ndarray)
            else value
            for key, value in joint.items()
        }
        for joint in joints
    ]
    one, other = sb.from_axes(joints), sb.from_axes(moved)
    # a ball's frame keeps the ground's axes where every other frame goes along with the drawing
    balls = [motion[:3, :3] for _ in kinds]
    # of the last joint z and x of that frame change places
    half = np.array([[0, 0, -1], [0, -1, 0], [-1, 0, 0]])
    balls[-1] = half @ balls[-1] @ half
    turned = [ball if kind == "S" else np.eye(3) for kind, ball in zip(kinds, balls, strict=True)]
    for i, link in enumerate(one.links):
        want = link.copy()
        want[:3] = turned[i] @ want[:3]
        want[:3, :3] = want[:3, :3] @ turned[i + 1].T
        np.testing.assert_allclose(other.links[i], want, rtol=0, atol=1e-13)


def test_the_angle_of_a_universal_joint_is_that_between_its_axes():
    joints = [
        {"kind": "U", "at": (0, 0, 0), "axes": [(0, 0, 2), (0, -1, 1)]},
        {"kind": "R", "at": (1, 0, 0), "axis": (0, 0, 1)},
    ]
    joint, _ = sb.from_axes(joints).joints
    assert joint.angle == pytest.approx(np.pi / 4, abs=1e-15)
    joints[0]["axes"] = [(0, 0, 2), (0, 1, -1)]
    assert sb.from_axes(joints).joints[0].angle == pytest.approx(3 * np.pi / 4, abs=1e-15)


# The drive


def toml(joints, drive="", extra=""):
    rows = []
    for joint in joints:
        values = {key: v.tolist() if isinstance(v, np.ndarray) else v for key, v in joint.items()}
        rows += ["[[joint]]", *(f"{key} = {json.dumps(value)}" for key, value in values.items())]
    return "\n".join(["format = 1", "[drive]", drive, *rows, extra])


# Messages


@pytest.mark.parametrize(
    ("kinds", "drive", "input", "output"),
    [
        ("RRRRRRR", "", "theta_1", "theta_7"),
        ("RRRRRRR", 'joint = "theta_7"', "theta_7", "theta_6"),
        ("RCCC", "", "theta_1", "theta_4.1"),
        ("RCCC", 'output = "theta_4.2"', "theta_1", "theta_4.2"),
        ("RCCC", 'joint = "theta_3"', "theta_3.1", "theta_4.1"),
        ("SRUS", "", "theta_2", "theta_3.1"),
        ("SUSS", "", "theta_2.1", "theta_2.2"),
        ("RSSR", 'joint = "theta_4"', "theta_4", "theta_1"),
        ("PRRS", 'joint = "theta_1"\nspeed = "1 cm/s"', "theta_1", "theta_3"),
    ],
)
def test_input_and_output_are_columns(kinds, drive, input, output):
    linkage = sb.loads(toml(drawing(np.random.default_rng(8), kinds), drive))
    assert (linkage.drive.joint, linkage.drive.output) == (input, output)
    assert linkage.drive.speed == (10.0 if "cm/s" in drive else 1.0)


@pytest.mark.parametrize("off", [1e-3, 1e-6, 1e-9, 1e-11])
def test_frames_stay_square_where_the_next_joint_lies_almost_on_the_axis(off):
    axis = np.array([1.0, 2.0, -1.5])
    joints = [
        {"kind": "R", "at": (0, 0, 0), "axis": axis},
        {"kind": "R", "at": 70 * axis + off * np.array([3.0, 1.0, 2.0]), "axis": (1, 0, 1)},
        {"kind": "R", "at": (10, 80, 5), "axis": (0, 1, 1)},
        {"kind": "R", "at": (40, 0, 60), "axis": (1, 1, 0)},
    ]
    linkage = sb.from_axes(joints)
    for frame in (linkage.base, linkage.ground, *linkage.links):
        rotation = frame[:3, :3]
        assert np.abs(rotation.T @ rotation - np.eye(3)).max() < 1e-15 * 4
