"""The frames that a description turns into, against an independent product of matrices; every message for a wrong one."""

import json
from pathlib import Path

import numpy as np
import pytest

import sevenbar as sb
from sevenbar.errors import DescriptionError

ROOT = Path(__file__).parent.parent
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
    return sb.from_dh("RRRRRRR", loop["length"], np.radians(loop["twist_deg"]), loop["offset"])


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
    tiny = sb.from_dh("RR", [1, 1], [1e-20, 0], [0, 0])
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
        "RPH", [1, 2, 3], [0, 1, 0], [4, 0, 5], [0, np.pi / 6, 0], [0, 0, 7], names=["a", "b", "c"]
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
    """Right-handed turns and slides of the links after it, a joint at a time; of a ball about z, y, x of the ground."""
    joints = drawing(np.random.default_rng(6), kinds)
    linkage = sb.from_axes(joints)
    column = 0
    for i, joint in enumerate(joints):
        axes = joint.get("axes", [joint["axis"]] if "axis" in joint else np.eye(3)[::-1])
        if joint["kind"] == "C":
            axes = axes * 2
        for k, axis in enumerate(axes):
            q = np.zeros(len(linkage.columns))
            q[column] = 0.3
            axis = np.asarray(axis) / np.linalg.norm(axis)
            moved = link_frames(linkage, q)[i] @ np.linalg.inv(link_frames(linkage, 0 * q)[i])
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
    turned = [motion[:3, :3] if kind == "S" else np.eye(3) for kind in kinds]
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


def toml(joints, drive="", extra=""):
    rows = []
    for joint in joints:
        values = {key: v.tolist() if isinstance(v, np.ndarray) else v for key, v in joint.items()}
        rows += ["[[joint]]", *(f"{key} = {json.dumps(value)}" for key, value in values.items())]
    return "\n".join(["format = 1", "[drive]", drive, *rows, extra])


# Messages


def complaints(text):
    with pytest.raises(DescriptionError) as caught:
        sb.loads(text, "f.toml")
    return [line.removeprefix("f.toml: ") for line in str(caught.value).splitlines()]


def rows(*lines, drive=""):
    return "\n".join(["format = 1", "[drive]", drive, *(f"[[link]]\n{line}" for line in lines)])


@pytest.mark.parametrize(
    ("text", "messages"),
    [
        (rows('joint = "H"', ""), ["link[1].pitch: is missing; a joint of kind H needs it"]),
        (
            rows('joint = "P"\noffset = 3', ""),
            ["link[1].offset: is what moves in a joint of kind P; leave it out"],
        ),
        (
            rows("angle = 3\npitch = 2", ""),
            [
                "link[1].angle: is what moves in a joint of kind R; leave it out",
                "link[1].pitch: does not belong to a joint of kind R; leave it out",
            ],
        ),
        (
            rows("", 'joint = "U"'),
            ["link[2].joint: 'U' takes more than one row; write R and R, or draw the loop as [[joint]]"],
        ),
        (
            rows("", 'joint = "r"'),
            ["link[2].joint: 'r' is not a joint kind; did you mean 'R'? allowed: R, P, H"],
        ),
        (
            rows("", 'lenght = 2\ntwist = "90"'),
            [
                "link[2].twist: '90' is text; give a number without quotes",
                "link[2].lenght: is not known here; did you mean 'length'? "
                "allowed: joint, name, length, twist, offset, angle, pitch",
            ],
        ),
        (rows(""), ["link: a loop of 1 joint is not taken; give 2 to 12"]),
        (rows(*[""] * 13), ["link: a loop of 13 joints is not taken; give 2 to 12"]),
        ("format = 1\nlink = []", ["link: a loop of 0 joints is not taken; give 2 to 12"]),
        ("format = 1\nlink = 3", ["link: 3 does not fit here; write [[link]] before each one"]),
        (
            rows("", "", "", 'joint = "ground"'),
            [
                "link[4].joint: 'ground' is not a joint kind; link 3 is the ground already and needs no entry; leave this one out"
            ],
        ),
        (
            rows("", "", 'joint = "G"\nlength = 35'),
            [
                "link[3].joint: 'G' is not a joint kind; link 3 is the ground already, being the last; give the joint before it: R, P, H"
            ],
        ),
        (
            rows("ground = true", "", "ground = true"),
            [
                "link[1].ground: is not known here; link 3 is the ground already; leave it out",
                "link[3].ground: is not known here; link 3 is the ground already; leave it out",
            ],
        ),
        (
            rows('name = "theta_2"', ""),
            ["link[2].name: 'theta_2' is taken already; give each joint its own name"],
        ),
        (
            rows("", "", drive='joint = "theta_3"'),
            ["drive.joint: no joint 'theta_3'; did you mean 'theta_2'? this linkage has theta_1, theta_2"],
        ),
        (
            rows("", "", drive='joint = "thetta"\noutput = "theta_1"'),
            ["drive.joint: no joint 'thetta'; did you mean 'theta_2'? this linkage has theta_1, theta_2"],
        ),
        (
            rows("", "", "", drive='output = "theta_1"'),
            ["drive.output: joint 'theta_1' is the input; give another: theta_2, theta_3"],
        ),
        (
            rows('joint = "P"', "", drive='speed = "10 rad/s"'),
            [
                "drive.speed: '10 rad/s' is a turning speed, and the input slides; "
                "give a number and a unit, as in '10 mm/s'"
            ],
        ),
        (
            rows('joint = "H"\npitch = 2', 'joint = "P"', drive='speed = "10 mm/s"'),
            [
                "drive.speed: '10 mm/s' is a sliding speed, and the input turns; "
                "give a number and a unit, as in '10 rad/s' or '60 rpm'"
            ],
        ),
        (
            rows("", "") + '\n[[point]]\nname = "P"\nlink = 3\nat = [0, 0, 0]',
            ["point[1].link: 3 is not a link; give 1 to 2, the last is the ground"],
        ),
        (
            rows("", "") + '\n[[point]]\nname = "P"\nlink = 0\nat = [0, 0, 0]',
            ["point[1].link: 0 is not a link; give its number, counted from 1"],
        ),
    ],
)
def test_each_mistake_in_rows_has_its_own_message(text, messages):
    assert complaints(text) == messages


RUSR = [
    {"kind": "R", "at": [0, 0, 0], "axis": [0, 0, 1]},
    {"name": "u", "kind": "U", "at": [1, 0, 0], "axes": [[1, 0, 0], [0, 1, 0]]},
    {"name": "ball", "kind": "S", "at": [1, 1, 0]},
    {"kind": "R", "at": [0, 1, 0], "axis": [1, 0, 0]},
]


def with_changes(index, **changes):
    joints = [dict(joint) for joint in RUSR]
    joints[index] |= changes
    return [{key: value for key, value in joint.items() if value is not None} for joint in joints]


@pytest.mark.parametrize(
    ("text", "messages"),
    [
        (
            toml(with_changes(1, axes=[[0, 0, 1], [0, 0, 2]])),
            [
                "joint[2].axes: [[0.0, 0.0, 1.0], [0.0, 0.0, 2.0]] are 0 deg apart; "
                "give two axes that cross, as in [[1, 0, 0], [0, 1, 0]]"
            ],
        ),
        (
            toml(with_changes(1, axes=[[0, 0, 1], [1e-12, 0, -1]])),
            [
                "joint[2].axes: [[0.0, 0.0, 1.0], [1e-12, 0.0, -1.0]] are 180 deg apart; "
                "give two axes that cross, as in [[1, 0, 0], [0, 1, 0]]"
            ],
        ),
        (
            toml(with_changes(1, axes=[[0, 0, 1]])),
            ["joint[2].axes[2]: is missing; give two directions, as in [[1, 0, 0], [0, 1, 0]]"],
        ),
        (
            toml(with_changes(1, axes=None, axis=[0, 0, 1])),
            [
                "joint[2].axes: is missing; a joint of kind U needs it",
                "joint[2].axis: does not belong to a joint of kind U; leave it out",
            ],
        ),
        (
            toml(with_changes(0, kind="H")),
            ["joint[1].pitch: is missing; a joint of kind H needs it"],
        ),
        (
            toml([{**RUSR[2], "name": "first"}, *RUSR[::3], RUSR[2]]),
            [
                "joint[1].at: [1.0, 1.0, 0.0] is the place of joint[4]; "
                "link 4 between two balls has no length, so leave one ball out"
            ],
        ),
        (
            toml(
                [
                    *RUSR,
                    {"name": "ball_b", "kind": "S", "at": [3, 0, 0]},
                    {"name": "ball_c", "kind": "S", "at": [3, 0, 0]},
                ]
            ),
            [
                "joint[6].at: [3.0, 0.0, 0.0] is the place of joint[5]; "
                "link 5 between two balls has no length, so leave one ball out"
            ],
        ),
        (
            toml([*RUSR, {"kind": "ground", "at": [0, 0, 0]}]),
            [
                "joint[5].kind: 'ground' is not a joint kind; link 4 is the ground already and needs no entry; leave this one out"
            ],
        ),
        (
            toml([{"kind": "G"}, *RUSR, {"kind": "Ground"}]),
            [
                f"joint[{i}].kind: '{word}' is not a joint kind; "
                "link 4 is the ground already and needs no entry; leave this one out"
                for i, word in ((1, "G"), (6, "Ground"))
            ],
        ),
        (
            toml(with_changes(2, ground=True), extra="[ground]\nat = 3"),
            [
                "joint[3].ground: is not known here; link 4 is the ground already; leave it out",
                "ground: is not known here; link 4 is the ground already; leave it out",
            ],
        ),
        (
            toml(RUSR, 'joint = "ball.2"\noutput = "ball"'),
            [
                "drive.joint: joint 'ball' is a ball; give a joint with one freedom: theta_1, u.1, u.2, theta_4",
                "drive.output: joint 'ball' is a ball; give a joint with one freedom: theta_1, u.1, u.2, theta_4",
            ],
        ),
        (
            toml(RUSR, 'joint = "u.3"'),
            [
                "drive.joint: no joint 'u.3'; did you mean 'u.2'? this linkage has theta_1, u.1, u.2, ball, theta_4"
            ],
        ),
        (
            toml(RUSR, 'joint = "u"\noutput = "u.1"'),
            ["drive.output: joint 'u.1' is the input; give another: theta_1, u.2, theta_4"],
        ),
        (
            toml(with_changes(3, name="u.1")),
            ["joint[4].name: 'u.1' is taken already; give each joint its own name"],
        ),
        (
            toml([RUSR[0], RUSR[2], {"kind": "S", "at": [5, 0, 0]}]),
            ["joint: a loop R S S has one freedom outside its balls; an input and an output need two"],
        ),
        (
            toml([RUSR[2], {"kind": "S", "at": [5, 0, 0]}]),
            ["joint: a loop S S has no freedom outside its balls; an input and an output need two"],
        ),
        (
            toml(RUSR[:1], extra='[[point]]\nname = "P"\nlink = 2\nat = [0, 0, 0]'),
            [
                "joint: a loop of 1 joint is not taken; give 2 to 12",
                "point[1].link: 2 is not a link; give 1 to 1, the last is the ground",
            ],
        ),
        (
            toml(with_changes(0, axis=[0, 0, 0]), 'speed = "1 mm/s"'),
            [
                "drive.speed: '1 mm/s' is a sliding speed, and the input turns; "
                "give a number and a unit, as in '10 rad/s' or '60 rpm'",
                "joint[1].axis: [0, 0, 0] has no direction; give three numbers, not all 0",
            ],
        ),
    ],
)
def test_each_mistake_in_a_drawing_of_any_kind_has_its_own_message(text, messages):
    assert complaints(text) == messages


@pytest.mark.parametrize(
    ("arguments", "messages"),
    [
        (
            {"joints": "RRRR", "length": [1, 2, 3], "twist": 0.3, "offset": [0] * 4, "names": ["a"]},
            [
                "length: 3 given for 4 joints; give 4",
                "twist: 0.3 is not a list; give 4, one for each joint",
                "names: 1 given for 4 joints; give 4",
            ],
        ),
        (
            {"joints": 7, "length": [], "twist": [], "offset": []},
            ["joints: 7 is not a text; give a letter for each joint, as in 'RRRR'"],
        ),
        (
            {
                "joints": "RPX",
                "length": [1, 1, 1],
                "twist": np.zeros(3),
                "offset": [1, 1, 1],
                "pitch": [None, 3, 0],
            },
            [
                "link[3].joint: 'X' is not a joint kind; allowed: R, P, H",
                "link[2].offset: is what moves in a joint of kind P; leave it out",
                "link[2].pitch: does not belong to a joint of kind P; leave it out",
            ],
        ),
        (
            {"joints": "RR", "length": [1, np.nan], "twist": [0, 0], "offset": [0, 0]},
            ["link[2].length: nan is not a finite number; give a finite number"],
        ),
        (
            {"joints": "PR", "length": [1, 1], "twist": [0, 0], "offset": [0, 0], "speed": "1 rpm"},
            [
                "drive.speed: '1 rpm' is a turning speed, and the input slides; give a number and a unit, as in '10 mm/s'"
            ],
        ),
    ],
)
def test_each_mistake_in_a_call_has_its_own_message(arguments, messages):
    with pytest.raises(DescriptionError) as caught:
        sb.from_dh(**arguments)
    assert str(caught.value).splitlines() == messages


def test_mutated_files_of_every_form_load_or_say_why():
    """Words of a good file moved, dropped and exchanged end in a linkage or a message, never in a crash."""
    random = np.random.default_rng(9)
    texts = [
        EXAMPLE,
        toml(RUSR, 'joint = "u.2"'),
        rows('joint = "P"\nangle = 3', 'joint = "H"\npitch = 1', "twist = 3"),
    ]
    words = [
        '"R"',
        '"S"',
        '"U"',
        '"C"',
        '"P"',
        '"H"',
        '"G"',
        "ground = true",
        "[[link]]",
        "[[joint]]",
        "[drive]",
        '"1 mm/s"',
    ]
    words += [
        "at = [0, 0, 0]",
        "axis = 3",
        "pitch = 0",
        'name = "u"',
        'joint = "u"',
        'output = "theta_1"',
        "0",
        "-1",
        "[]",
    ]
    loaded = 0
    for _ in range(3000):
        parts = texts[random.integers(len(texts))].split("\n")
        for _ in range(random.integers(1, 4)):
            place = random.integers(len(parts))
            key, sign, _ = parts[place].partition(" = ")
            match random.integers(3):
                case 0:
                    del parts[place]
                case 1:
                    parts[place] = f"{key}{sign}{random.choice(words)}"
                case _:
                    parts.insert(place, str(random.choice(words)))
        try:
            sb.loads("\n".join(parts))
            loaded += 1
        except DescriptionError as error:
            assert str(error)
    assert 100 < loaded < 2900
