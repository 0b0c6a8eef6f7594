"""What is said of mistakes in rows, drawings and calls: each has its own message with place, value and what is allowed."""

import numpy as np
import pytest
from test_forms import toml

import sevenbar as sb
from places import EXAMPLES
from sevenbar.errors import DescriptionError, shown

EXAMPLE = (EXAMPLES / "seven_r.toml").read_text(encoding="utf-8")


def complaints(text):
    """Each line of the refusal of a file, without the file's name."""
    with pytest.raises(DescriptionError) as caught:
        sb.loads(text, "f.toml")
    return [line.removeprefix("f.toml: ") for line in str(caught.value).splitlines()]


def rows(*lines, drive=""):
    """A file of rows, each with these lines of keys."""
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
            rows("", 'lenght = 2\ntwist = "steep"'),
            [
                "link[2].twist: 'steep': no 'steep' is known; give an angle, as in 30, '30deg' or 'pi/6'",
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


#: A loop as drawn with a joint of each number of freedoms.
RUSR = [
    {"kind": "R", "at": [0, 0, 0], "axis": [0, 0, 1]},
    {"name": "u", "kind": "U", "at": [1, 0, 0], "axes": [[1, 0, 0], [0, 1, 0]]},
    {"name": "ball", "kind": "S", "at": [1, 1, 0]},
    {"kind": "R", "at": [0, 1, 0], "axis": [1, 0, 0]},
]


def with_changes(index, **changes):
    """The joints of `RUSR`, one of them with other keys, without those that are `None`."""
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
                "joint[2].axis: does not belong to a joint of kind U; give its axes, as in axes = [[1, 0, 0], [0, 1, 0]]",
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


@pytest.mark.filterwarnings("ignore::sevenbar.errors.AngleUnitWarning")
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


def drawn_far(place="[0, 0, 0]", pitch=3):
    """Joints some units apart, one of them at a place of its own."""
    return f"""format = 1
length_unit = "in"
joint = [
  {{kind = "C", at = [0, 0, 0], axis = [0, 0, 1]}},
  {{kind = "U", at = {place}, axes = [[1, 0, 0], [0, 1, 0]]}},
  {{kind = "H", at = [0, 2, 0], axis = [0, 1, 0], pitch = {pitch}}},
  {{kind = "P", at = [0, 2, 5], axis = [1, 1, 0]}},
  {{kind = "R", at = [1, 2, 3], axis = [1, 1, 2]}},
]
"""


#: The end of a message about lengths too far apart.
LOST = "is lost in rounding beside that; give lengths of which the greatest is at most 1e+11 times the others"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            drawn_far("[9007199254740993, 0, 0]"),
            "joint[2].at: [9007199254740992.0, 0.0, 0.0] is 9.01e+15 in from most of the others, and 5 in "
            + LOST,
        ),
        (drawn_far(pitch=-4e12), "joint[3].pitch: 4e+12 in is too long, and 3.74 in " + LOST),
        (
            rows(*["length = 1\ntwist = 40"] * 4, "length = 2e13", "offset = -3", "twist = 40"),
            "link[5].length: 2e+13 mm is too long, and 3 mm " + LOST,
        ),
    ],
)
def test_a_length_beside_which_the_others_are_lost_is_refused_by_name(text, message):
    assert complaints(text) == [message]


@pytest.mark.parametrize(
    "text",
    [
        drawn_far("[1e10, 0, 0]"),
        # zeros as programs compute them, and a few lengths that are nearly nothing
        drawn_far("[1, 6.1e-17, 0]"),
        rows(*["length = 1.2e-16\noffset = 6.1e-17"] * 6, "length = 1"),
        rows(*["length = 1e12"] * 6, "length = 1"),
        # all of one size, whatever that is
        rows(*["length = 1e-14\noffset = 3e-15"] * 7),
    ],
)
def test_lengths_that_can_be_seen_beside_each_other_are_taken(text):
    assert sb.loads(text, "f.toml")


def test_values_too_large_to_print_are_named_in_plain_words():
    deep = {}
    for _ in range(100_000):
        deep = {"M": deep}
    assert shown(deep) == "a value too large to print"
    assert shown(10**5000) == "a number too large to print"
