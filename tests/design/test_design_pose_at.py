"""A pose at an input, to within a box: as its own geometry has it, in units, with a slide as the input, in messages."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from jsonschema import Draft202012Validator

from command_runs import sevenbar
from sevenbar.description.draft import Draft
from sevenbar.description.schema import TomlSchema
from sevenbar.design.task import DesignTask, FreeNumber, PoseAtWant, designed, read_task
from sevenbar.design.task.along import DesignAlong
from sevenbar.design.task.contradictions import contradictions
from sevenbar.design.task.figures import want_figure
from sevenbar.design.task.file.schema import TaskForm
from sevenbar.design.task.problem import TaskModel, TaskProblem
from sevenbar.design.task.starts import seeds
from sevenbar.errors import DescriptionError, RequestError
from sevenbar.text.words import language

FOUR_BAR = [("crank", (0.0, 0.0)), ("A", (15.0, 26.0)), ("B", (90.0, 60.0)), ("rocker", (100.0, 0.0))]
RADIUS, ROD = 30.0, 80.0
#: Of a slider-crank drawn with its crank at 60 deg.
PIN = (RADIUS * math.cos(math.pi / 3), RADIUS * math.sin(math.pi / 3))
WRIST = (PIN[0] + math.sqrt(ROD**2 - PIN[1] ** 2), 0.0)


def drawn(joints, slide="", drive=""):
    """A linkage in the xy plane as a file."""
    text = f'format = 1\nlength_unit = "mm"\n{drive}'
    for name, (x, y) in joints:
        kind, axis = ("P", [1, 0, 0]) if name == slide else ("R", [0, 0, 1])
        text += f'[[joint]]\nname = "{name}"\nkind = "{kind}"\nat = [{x!r}, {y!r}, 0]\naxis = {axis}\n'
    return text


SLIDER_CRANK = drawn(
    [("crank", (0.0, 0.0)), ("A", PIN), ("B", WRIST), ("slider", WRIST)],
    "slider",
    '[drive]\njoint = "slider"\noutput = "crank"\n',
)


def places(draft):
    """Where the joints of a drawing are, in its plane."""
    return [np.array(joint["at"][:2], dtype=float) for joint in draft.raw["joint"]]


def crossings(first, r, second, s):
    """The two points at distances r and s from two others."""
    way = second - first
    far = np.linalg.norm(way)
    along = (far**2 + r**2 - s**2) / (2 * far)
    up = math.sqrt(r**2 - along**2) * np.array([-way[1], way[0]]) / far
    return [first + along / far * way + sign * up for sign in (1, -1)]


def pose(turn, before, after):
    """The pose (4, 4) of a body in the plane turned by an angle, by which a point of it goes from a place to another."""
    found = np.eye(4)
    found[:2, :2] = [[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]]
    found[:2, 3] = after - found[:2, :2] @ before
    return found


def coupler_poses(draft, angle):
    """The two poses of the coupler of a drawn four-bar, its crank turned by an angle from the drawing."""
    ground, a, b, other = places(draft)
    now = pose(angle, ground, ground)[:2, :2] @ (a - ground) + ground
    found = []
    for end in crossings(now, np.linalg.norm(b - a), other, np.linalg.norm(b - other)):
        turn = math.atan2(*(end - now)[::-1]) - math.atan2(*(b - a)[::-1])
        found.append(pose(turn, a, now))
    return found


def off(found, wanted):
    """How far a pose is off along the axes of another, and turned."""
    turned = wanted[:3, :3].T @ found[:3, :3]
    return wanted[:3, :3].T @ (found[:3, 3] - wanted[:3, 3]), abs(math.atan2(turned[1, 0], turned[0, 0]))


def four_bar(**moved):
    return Draft.of(drawn([(name, moved.get(name, place)) for name, place in FOUR_BAR]), "four-bar")


ANGLE = math.radians(40.0)
KNOWN = four_bar()
WANTED = coupler_poses(KNOWN, ANGLE)[0]
START = four_bar(A=(17.0, 24.0), B=(86.0, 64.0))
FREE = tuple(
    FreeNumber(f"{name}.{axis}", value - 15, value + 15)
    for name, place in FOUR_BAR[1:3]
    for axis, value in zip("xy", place, strict=True)
)


def nearest(design, wanted):
    """What a design is off by its own geometry, of its two assemblies the nearer."""
    return min(
        (off(one, wanted) for one in coupler_poses(design.draft, ANGLE)), key=lambda o: np.abs(o[0]).max()
    )


@pytest.mark.parametrize("turn", [math.radians(0.5), None])
def test_the_coupler_takes_the_pose_by_its_own_geometry(turn):
    want = PoseAtWant(2, ANGLE, WANTED, (1.0, 1.0, 1.0), turn)
    task = DesignTask(START, FREE, (want,))
    assert list(contradictions(task)) == []
    (design,) = designed(task, count=1, starts=1).designs
    place, turned = nearest(design, WANTED)
    assert np.abs(place).max() < 1e-8
    facts = {fact.name: fact.value for fact in DesignAlong(task, design).facts(0)}
    assert facts["off"] == pytest.approx(np.linalg.norm(place), abs=1e-9)
    if turn is None:
        assert "turned" not in facts
    else:
        assert turned < 1e-9
        assert facts["turned"] == pytest.approx(math.degrees(turned), abs=1e-7)


def test_the_box_and_the_turn_hold_against_a_better_want():
    tilted = np.array([[0.8, -0.6, 0], [0.6, 0.8, 0], [0, 0, 1.0]])
    other = WANTED.copy()
    other[:3, 3] += tilted @ [3.0, 0.2, 0.0]
    # the axes of the box are those of the pose
    first = WANTED.copy()
    wants = (
        PoseAtWant(2, ANGLE, first, (1.0, 0.5, 1.0), math.radians(0.5), weight=0.01),
        PoseAtWant(2, ANGLE, other, (9.0, 9.0, 9.0), math.radians(20.0)),
    )
    task = DesignTask(START, FREE, wants)
    (design,) = designed(task, count=1, starts=1).designs
    place, turned = nearest(design, first)
    assert (np.abs(place[:2]) <= np.array([1.0, 0.5]) * (1 + 1e-6)).all()
    assert turned <= math.radians(0.5) * (1 + 1e-6)
    used = np.abs([*place[:2], math.degrees(turned)]) / [1.0, 0.5, 0.5]
    assert used.max() == pytest.approx(1.0, abs=1e-5)


def test_a_pose_out_of_reach_is_refused_with_what_it_is_off():
    away = WANTED.copy()
    away[:3, 3] += [500.0, 0.0, 0.0]
    task = DesignTask(START, FREE, (PoseAtWant(2, ANGLE, away, (1.0, 1.0, 1.0), 0.01),))
    with pytest.raises(
        RequestError, match=r"the pose is off by .* mm and .* deg along its axes, at most 1, 1, 1 mm"
    ):
        designed(task, count=1, starts=1).required(1)


def test_slopes_of_its_slacks_are_those_of_differences():
    moved = WANTED @ pose(0.3, np.zeros(2), np.array([4.0, -2.0]))
    task = DesignTask(START, FREE, (PoseAtWant(2, ANGLE, moved, (1.0, 2.0, 3.0), 0.1),))
    model = TaskModel(task)
    problem = TaskProblem(model, seeds(model, 0, 0, lambda: None)[0])
    z = problem.start
    here = problem.at(z)
    problem.take(z)
    assert len(here.slack) == 7
    for k in range(len(z)):
        step = np.zeros(len(z))
        step[k] = 1e-5
        up, down = problem.at(z + step), problem.at(z - step)
        assert here.residuals_by[:, k] == pytest.approx(
            (up.residuals - down.residuals) / 2e-5, rel=1e-6, abs=1e-6
        )
        assert here.slack_by[:, k] == pytest.approx((up.slack - down.slack) / 2e-5, rel=1e-6, abs=1e-6)


def written(folder: Path, body: str) -> Path:
    (folder / "four_bar.toml").write_text(drawn(FOUR_BAR))
    (folder / "slider.toml").write_text(SLIDER_CRANK)
    path = folder / "task.toml"
    path.write_text(body)
    return path


BODY = """linkage = "four_bar.toml"
[free]
"A.x" = "5:25"
[[want]]
kind = "pose"
link = 2
input = "0.5rad"
pose = { at = ["1cm", 2, 3], angle = 30 }
within = ["1mm", 2, 0.5]
turn = "0.01rad"
"""


def test_values_have_units(tmp_path):
    (want,) = read_task(written(tmp_path, BODY)).wants
    assert want.input == pytest.approx(0.5)
    assert want.within == (1.0, 2.0, 0.5)
    assert want.turn == pytest.approx(0.01)
    c, s = math.cos(math.pi / 6), math.sin(math.pi / 6)
    np.testing.assert_allclose(
        want.pose, [[c, -s, 0, 10], [s, c, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]], atol=1e-15
    )
    for within, side in (("2", 2.0), ('"1cm"', 10.0)):
        (want,) = read_task(written(tmp_path, BODY.replace('["1mm", 2, 0.5]', within))).wants
        assert want.within == (side,) * 3


WRONG = {
    "no box": ('["1mm", 2, 0.5]', "[1, 0, 1]", "want[1].within: [1, 0, 1] is no box; give how far the place may be off, > 0"),
    "two sides": ('["1mm", 2, 0.5]', "[1, 1]", "want[1].within: [1, 1] is not a point or direction; give three numbers"),
    "no turn": ('"0.01rad"', "0", "want[1].turn: 0 deg is no such angle; give one > 0, up to 180 deg"),
    "over half a turn": ('"0.01rad"', "200", "want[1].turn: 200 deg is no such angle"),
    "a length as input": ('"0.5rad"', '"3mm"', "want[1].input: '3mm' is no value of crank, which turns"),
    "the ground": ("link = 2", "link = 4", "want[1].link: 4 is no moving link"),
    "no pose": ("pose =", "poses =", "want[1].pose: is missing"),
    "no place": ('at = ["1cm", 2, 3], ', "", "want[1].pose.at: is missing"),
    "a matrix and an angle": ("angle = 30", "angle = 30, matrix = [[1,0,0],[0,1,0],[0,0,1]]", "want[1].pose: a matrix, and axis or angle"),
    "placed anywhere": ("[free]", 'placement = "free"\n[free]', "want[1]: a pose at an input stands in space, and with placement 'free'"),
    "outside a range": ('turn = "0.01rad"\n', 'turn = 1\n[[must]]\nkind = "range"\njoint = "crank"\nrange = "40:90"\n', "must[1].range: want 1 needs crank outside it"),
    "elsewhere": ("", BODY[BODY.index("[[want]]") :].replace("1cm", "9cm").replace("0.5rad", "28.64788975654116deg"), "want[2].pose: want 1 wants link 2 elsewhere at this input"),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG)
def test_each_mistake_has_its_place_and_what_to_do(tmp_path, case):
    before, after, expected = WRONG[case]
    body = BODY.replace(before, after) if before else BODY + after
    with pytest.raises(DescriptionError) as caught:
        read_task(written(tmp_path, body))
    assert any(
        line.partition("task.toml: ")[2].startswith(expected) for line in str(caught.value).splitlines()
    ), caught


def test_the_schema_takes_what_the_program_takes():
    takes = Draft202012Validator(TaskForm.model_json_schema(schema_generator=TomlSchema)).is_valid
    want = {"kind": "pose", "link": 2, "input": 20, "pose": {"at": [0, 0, 0]}, "within": 2}
    task = {"linkage": "rssr", "free": {"L1": "1:2"}, "want": [want]}
    assert takes(task)
    for good in ({"within": [1, 2, 3]}, {"within": "2mm"}, {"turn": 3}, {"weight": 2}):
        assert takes({**task, "want": [want | good]})
    for bad in ({"within": 0}, {"link": "2"}, {"angle": 3}, {"input": [0, 1]}):
        assert not takes({**task, "want": [want | bad]})


def test_a_slide_may_be_the_input(tmp_path):
    # the block 10 mm further along its axis than drawn
    body = """linkage = "slider.toml"
[free]
"A.x" = "5:25"
"A.y" = "15:35"
[[want]]
kind = "pose"
link = 2
input = "1cm"
pose = {{ at = [{}, {}, 0], angle = {} }}
within = 0.1
turn = 0.1
"""
    wrist = np.array([WRIST[0] + 10.0, 0.0])

    def of(drawing):
        """The turn and the pose of the rod of a crank and rod drawn to a place of their joint."""
        crank, rod = np.linalg.norm(drawing), np.linalg.norm(WRIST - drawing)
        pin = crossings(np.zeros(2), crank, wrist, rod)[0]
        turn = math.atan2(*(wrist - pin)[::-1]) - math.atan2(*(WRIST - drawing)[::-1])
        return turn, pose(turn, drawing, pin)

    turn, wanted = of(np.array([14.0, 28.0]))
    path = written(tmp_path, body.format(*wanted[:2, 3], math.degrees(turn)))
    run = sevenbar("design", "task", path, "--designs", 1, "--starts", 0, "--json")
    assert run.returncode == 0, run.stderr
    answer = json.loads(run.stdout)
    assert answer["wanted"][0].startswith("link 2 at the input 10 mm: (")
    (design,) = answer["designs"]
    place, turned = off(of(np.array([design["values"][f"A.{axis}"] for axis in "xy"]))[1], wanted)
    assert np.abs(place).max() < 1e-7
    assert turned < 1e-9


@pytest.mark.usefixtures("chinese_font")
def test_what_is_printed_and_drawn_has_the_place_and_the_turn():
    task = DesignTask(START, FREE, (PoseAtWant(2, ANGLE, WANTED, (1.0, 1.0, 1.0), 0.01),))
    (design,) = designed(task, count=1, starts=0).designs
    along = DesignAlong(task, design)
    curve = along.curve(0)
    np.testing.assert_allclose(curve.wanted, [WANTED[:3, 3]], atol=1e-12)
    assert curve.frames is not None
    with language("zh"):
        figure = want_figure(along, 0)
    words = [text.get_text() for text in figure.legends[0].get_texts()] + [
        axes.get_title() for axes in figure.axes
    ]
    assert not any("want" in word or "path" in word or "error" in word for word in words)
    assert len(words) > 3
