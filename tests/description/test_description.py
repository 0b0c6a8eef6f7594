"""What a linkage file may hold, and what is said of one that may not: place, value, what is allowed."""

import math

import numpy as np
import pytest

import sevenbar as sb
from places import EXAMPLES
from sevenbar.errors import DescriptionError, RequestError, SevenbarError
from sevenbar.text.units import sliding_speed

DIMENSIONS = (EXAMPLES / "rssr.toml").read_text(encoding="utf-8")
DRAWN = (EXAMPLES / "rssr_axes.toml").read_text(encoding="utf-8")


def complaints(text):
    with pytest.raises(DescriptionError) as caught:
        sb.loads(text, "f.toml")
    return str(caught.value).splitlines()


def changed(text, *changes):
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    return text


def test_the_two_forms_of_the_paper_s_linkage_move_alike():
    dimensions, drawn = sb.loads(DIMENSIONS).motion(), sb.loads(DRAWN).motion()
    for one, other in zip(dimensions.circuits, drawn.circuits, strict=True):
        np.testing.assert_allclose(one.output, other.output, rtol=0, atol=1e-13)
        np.testing.assert_allclose(one.dddq[:, -1], other.dddq[:, -1], rtol=0, atol=1e-9)
    assert drawn.linkage.points[-1].name == "middle"


def test_the_gallery_and_the_examples_hold_the_same_case():
    assert sb.load("rssr").dimensions == sb.load(EXAMPLES / "rssr.toml").dimensions
    assert sb.load("rssr").drive.speed == 10.0


def test_python_and_file_describe_the_same_linkage():
    ours = sb.rssr(M=700, N=700, L1=250, L3=550, D=0, speed="10 rad/s")
    np.testing.assert_array_equal(ours.transforms, sb.load("rssr").transforms)
    assert ours.drive == sb.load("rssr").drive


def test_a_linkage_cannot_be_changed():
    linkage = sb.load("rssr")
    with pytest.raises(AttributeError):
        linkage.name = "other"
    with pytest.raises(ValueError, match="read-only"):
        linkage.links[0, 0, 0] = 2.0


def test_all_errors_of_a_file_are_told_at_once():
    text = changed(DIMENSIONS, ("M = 700", 'M = "wide"'), ("L1 = 250", "L1 = -250"), ('"mm"', '"mmm"'))
    assert complaints(changed(text, ("10 rad/s", "0 rad/s"))) == [
        "f.toml: length_unit: 'mmm' is not a unit known here; did you mean 'mm'? allowed: um, mm, cm, m, in, ft",
        "f.toml: drive.speed: '0 rad/s' moves nothing; give a finite speed other than 0, as in '10 rad/s'",
        "f.toml: rssr.M: 'wide': no 'wide' is known; give a length, as in 250, '25 cm' or '50*sin(30deg)'",
        "f.toml: rssr.L1: -250 is not a length; give a number > 0",
    ]


def test_errors_of_form_and_errors_between_keys_are_told_together():
    text = changed(
        DRAWN, ("axis = [0, 0, 1]", ""), ("at = [250, 0, 700]", "at = [250, 0]"), ("link = 2", "link = 7")
    )
    assert complaints(changed(text, ("[drive]", '[drive]\njoint = "cranck"'))) == [
        "f.toml: joint[2].at: [250, 0] is not a point or direction; give three numbers, as in [0, 0, 1]",
        "f.toml: joint[1].axis: is missing; a joint of kind R needs it",
        "f.toml: point[1].link: 7 is not a link; give 1 to 4, the last is the ground",
        "f.toml: drive.joint: no joint 'cranck'; did you mean 'crank'? this linkage has crank, ball_a, ball_b, rocker",
    ]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("N = 700", "N = nan", "rssr.N: nan is not a finite number; give a finite number"),
        ("D = 0", "D = -inf", "rssr.D: -inf is not a finite number; give a finite number"),
        ("M = 700", "M = 1e300", "rssr.M: 1e+300 is out of range; give a number up to 1e+100 in size"),
        ("M = 700", "M = true", "rssr.M: True is not a number; give a number"),
        ("M = 700", "M = [1, 2]", "rssr.M: [1, 2] is not a number; give a number"),
        ("L1 = 250", "L1 = 0", "rssr.L1: 0 is not a length; give a number > 0"),
        ("L3 = 550", "L3 = -550", "rssr.L3: -550 is not a length; give a number > 0"),
        ("D = 0", "D = 0\nL2 = 0", "rssr.L2: 0 is not a length; give a number > 0"),
        (
            "D = 0",
            "D = 0\nL_2 = 9",
            "rssr.L_2: is not known here; did you mean 'L2'? allowed: M, N, L1, L3, D, L2",
        ),
        ("D = 0", "", "rssr.D: is missing; needed here: M, N, L1, L3, D"),
        ("format = 1", "format = 2", "format: 2 is not a format of this version; give format = 1"),
        ("format = 1", "", "format: is missing; give format = 1"),
        (
            '"10 rad/s"',
            '"10 rad/sec"',
            "drive.speed: 'rad/sec' is not a unit known here; did you mean 'rad/s'? "
            "allowed: rad/s, deg/s, rpm, rev/s",
        ),
        (
            '"10 rad/s"',
            '"fast"',
            "drive.speed: 'fast' is not a speed; give a number and a unit, as in '10 rad/s' or '60 rpm'",
        ),
        (
            '"deg"',
            '"degree"',
            "angle_unit: 'degree' is not a unit known here; did you mean 'deg'? allowed: rad, deg",
        ),
        (
            "[rssr]",
            "[rssr]\nM = 700",
            "line 13: 'M = 700' stands twice; leave one of them out",
        ),
    ],
)
def test_each_mistake_in_the_dimensions_has_its_own_message(old, new, message):
    (line,) = complaints(changed(DIMENSIONS, (old, new)))
    assert line.startswith(f"f.toml: {message}")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            'kind = "S"',
            'kind = "s"',
            "joint[2].kind: 's' is not a joint kind; did you mean 'S'? allowed: R, P, H, C, U, S, E, K, L",
        ),
        (
            "axis = [0, 0, 1]",
            "axis = [0, 0, 0]",
            "joint[1].axis: [0, 0, 0] has no direction; give three numbers, not all 0",
        ),
        (
            "at = [250, 0, 700]",
            "at = [0, 0, 900]",
            "joint[2].at: [0.0, 0.0, 900.0] lies on the axis of crank; the link between has no length",
        ),
        (
            "at = [250, 0, 700]",
            "at = [700, 550, 0]",
            "joint[3].at: [700.0, 550.0, 0.0] is the place of joint[2]; the coupler has no length",
        ),
        (
            'name = "ball_b"',
            'name = "ball_a"',
            "joint[3].name: 'ball_a' is taken already; give each joint its own name",
        ),
        (
            'name = "middle"',
            'name = "A"',
            "point[1].name: 'A' is taken already; give each point its own name",
        ),
        (
            "[drive]",
            '[drive]\njoint = "ball_a"',
            "drive.joint: joint 'ball_a' is a ball; give a joint with one freedom: crank, rocker",
        ),
        (
            "[drive]",
            '[drive]\noutput = "crank"',
            "drive.output: joint 'crank' is the input; the output is the other one, rocker",
        ),
        (
            "at = [250, 0, 700]",
            "at = [250, 0, 700]\naxis = [1, 0, 0]",
            "joint[2].axis: does not belong to a joint of kind S",
        ),
    ],
)
def test_each_mistake_in_the_drawing_has_its_own_message(old, new, message):
    (line,) = complaints(changed(DRAWN, (old, new)))
    assert line.startswith(f"f.toml: {message}")


def test_a_text_must_describe_exactly_one_linkage():
    assert complaints("format = 1") == [
        "f.toml: no linkage is described; give one of [rssr], [[joint]], [[pin]] or [[link]]"
    ]
    assert "given together" in complaints(DIMENSIONS + DRAWN[DRAWN.index("[[joint]]") :])[0]
    assert complaints("format = 1\njoint = 3\ndrive = 4") == [
        "f.toml: drive: 4 is not a table; give keys with values",
        "f.toml: joint: 3 does not fit here; write [[joint]] before each one",
    ]


def test_a_drawing_may_hold_any_kind_of_joint():
    linkage = sb.loads(changed(DRAWN, ('kind = "R"', 'kind = "C"')), "f.toml")
    assert linkage.kind == "CSSR"
    assert linkage.columns[:3] == ("crank.1", "crank.2", "ball_a.1")
    assert (linkage.drive.joint, linkage.drive.output) == ("crank.1", "rocker")
    # the paper's points A and B are the RSSR's alone
    assert [point.name for point in linkage.points] == ["middle"]


def test_python_calls_get_the_same_messages():
    with pytest.raises(DescriptionError, match=r"^rssr\.L1: -1 is not a length; give a number > 0$"):
        sb.rssr(M=1, N=1, L1=-1, L3=1, D=0)
    with pytest.raises(DescriptionError, match=r"joint\[1\]\.kind: 'X' is not a joint kind"):
        sb.from_axes([{"kind": "X", "at": (0, 0, 0)}])
    with pytest.raises(RequestError, match=r"samples: 2 is not a count; give 4 to 1000000"):
        sb.load("rssr").motion(2)
    with pytest.raises(RequestError, match=r"input: no joint 'cranck'; did you mean 'crank'\?"):
        sb.load("rssr").motion(input="cranck")
    with pytest.raises(RequestError, match=r"input\[1\]: NaN is not a finite number"):
        sb.load("rssr").output([0.0, np.nan])
    with pytest.raises(RequestError, match="order: 4 is not offered; give 0 to 3"):
        sb.load("rssr").output([0.0], order=4)
    with pytest.raises(RequestError, match="speed: 3 values where the input has 2"):
        sb.load("rssr").output([0.0, 1.0], order=1, speed=[1.0, 2.0, 3.0])
    with pytest.raises(RequestError, match="link: 5 is not a link; give 1 to 4"):
        sb.load("rssr").motion().circuits[0].point(5, (0, 0, 0))
    with pytest.raises(RequestError, match="times must rise"):
        sb.Law.of(t=[0, 0], q=[0, 1], dq=1, ddq=0)


def test_units_of_speed_mean_what_they_say():
    for text, speed in (
        ("60 rpm", 2 * np.pi),
        ("1 rev/s", 2 * np.pi),
        ("-90 deg/s", -np.pi / 2),
        (3, 3.0),
        (".5e1rad/s", 5.0),
    ):
        assert sb.rssr(M=1, N=1, L1=1, L3=1, D=0, speed=text).drive.speed == pytest.approx(speed, rel=1e-15)


def test_a_speed_of_the_wrong_kind_says_which_is_wanted():
    with pytest.raises(DescriptionError) as caught:
        sb.rssr(M=1, N=1, L1=1, L3=1, D=0, speed="10 mm/s")
    assert str(caught.value) == (
        "drive.speed: '10 mm/s' is a sliding speed, and the input turns; "
        "give a number and a unit, as in '10 rad/s' or '60 rpm'"
    )


@pytest.mark.parametrize(
    ("text", "unit", "speed"),
    [
        ("10 mm/s", "mm", 10.0),
        ("1 in/s", "mm", 25.4),
        ("-3 ft/s", "in", -36.0),
        ("1 mm/s", "um", 1000.0),
        (2, "m", 2.0),
    ],
)
def test_a_sliding_speed_is_in_length_units_a_second(text, unit, speed):
    assert sliding_speed(text, unit) == speed


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "60 rpm",
            "'60 rpm' is a turning speed, and the input slides; give a number and a unit, as in '10 mm/s'",
        ),
        ("10", "'10' has no unit; give a number and a unit, as in '10 mm/s'"),
        (
            "10 mm",
            "'mm' is not a unit known here; did you mean 'mm/s'? allowed: um/s, mm/s, cm/s, m/s, in/s, ft/s",
        ),
        (0, "0 moves nothing; give a finite speed other than 0, as in '10 mm/s'"),
        ("0", "'0' moves nothing; give a finite speed other than 0, as in '10 mm/s'"),
        ("-.0e3", "'-.0e3' moves nothing; give a finite speed other than 0, as in '10 mm/s'"),
        ("0 mm/s", "'0 mm/s' moves nothing; give a finite speed other than 0, as in '10 mm/s'"),
        (
            "0 mm",
            "'mm' is not a unit known here; did you mean 'mm/s'? allowed: um/s, mm/s, cm/s, m/s, in/s, ft/s",
        ),
        (math.inf, "inf is out of range; give a speed of 1e-50 to 1e+50 in size, as in '10 mm/s'"),
        (math.nan, "nan is out of range; give a speed of 1e-50 to 1e+50 in size, as in '10 mm/s'"),
        (
            "-1e99 m/s",
            "'-1e99 m/s' is out of range; give a speed of 1e-50 to 1e+50 in size, as in '10 mm/s'",
        ),
        ("1e-60 m/s", "'1e-60 m/s' is out of range; give a speed of 1e-50 to 1e+50 in size, as in '10 mm/s'"),
        (True, "True is not a speed; give a number and a unit, as in '10 mm/s'"),
    ],
)
def test_what_is_no_sliding_speed_is_refused(text, message):
    with pytest.raises(RequestError) as caught:
        sliding_speed(text, "mm")
    assert str(caught.value) == message


def test_lengths_of_any_size_give_the_same_angles():
    angles = np.linspace(0, 6, 7)
    want = sb.rssr(M=0.7, N=0.7, L1=0.25, L3=0.55, D=0).output(angles, order=3).jerk
    for size in (1e-90, 2.0**-40, 2.0**70, 1e90):
        got = (
            sb.rssr(M=0.7 * size, N=0.7 * size, L1=0.25 * size, L3=0.55 * size, D=0)
            .output(angles, order=3)
            .jerk
        )
        np.testing.assert_allclose(got, want, rtol=1e-11)


def test_mutated_files_load_or_say_why():
    """Random edits of a good file never end in anything but a linkage or a message."""
    random = np.random.default_rng(7)
    letters = list('abLM[]{}="\n.0123456789-einf#, \u00e9\x00')
    loaded = 0
    for _ in range(3000):
        text = list(DIMENSIONS if random.random() < 0.5 else DRAWN)
        for _ in range(random.integers(1, 4)):
            place = random.integers(len(text))
            match random.integers(3):
                case 0:
                    text[place] = str(random.choice(letters))
                case 1:
                    del text[place : place + random.integers(1, 20)]
                case _:
                    text.insert(place, str(random.choice(letters)) * random.integers(1, 4))
        try:
            sb.loads("".join(text)).motion(samples=4)
            loaded += 1
        except SevenbarError as error:
            assert str(error)
    assert 300 < loaded < 2700
