"""Public functions check what they are given at the border, and what they give cannot be written."""

from __future__ import annotations

import copy
import inspect
import pickle
from collections.abc import Callable
from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest

import sevenbar as sb
from evidence.fuzz import calls
from sevenbar.errors import RequestError, SevenbarError

LONG = "x" * 100_000


def nested() -> list[Any]:
    found: list[Any] = []
    for _ in range(100_000):
        found = [found]
    return found


def loaded() -> sb.Linkage:
    return sb.load("planar_4r").loaded(bodies={2: sb.Body(1.0, (10.0, 0.0, 0.0))}, gravity=(0, -9.81, 0))


WRONG: dict[str, tuple[Callable[[], Any], str]] = {
    "array for a joint": (lambda: sb.load("rssr").motion(input=np.zeros(3)), "input: no joint array([0., 0., 0.]); this"),
    "array for a word": (lambda: sb.Load(2, torque=(0, 0, 1), axes=np.array(["a", "b"])), "axes: array(['a', 'b']"),
    "array for a law": (lambda: sb.load("rssr").motion(law=np.zeros(3)), "law: array([0., 0., 0.]) is not a law; make"),
    "array for a method": (lambda: sb.load("rssr").motion(method=np.zeros(0)), "method: array([], dtype=float64) is not"),
    "array for a switch": (lambda: sb.load("rssr").motion(36).columns(si=np.zeros(3)), "si: array([0., 0., 0.]) is neither"),
    "array for a ball": (lambda: sb.load("rssr").motion(36)[0].ball_cone(np.zeros(3)), "joint: no joint array([0., 0., 0.])"),
    "no text": (lambda: sb.loads(None), "content: None is not a text; give that of a TOML file, or load(path)"),
    "no path": (lambda: sb.load(None), "source: None is not a path; give that of a file"),
    "no joints": (lambda: sb.from_axes(None), "joints: None is not a list; give one with a mapping for each of the joints"),
    "no rows": (lambda: sb.from_dh(None), "joints: None is not a text; give a letter for each joint, as in 'RRRR'"),
    "no linkage": (lambda: sb.load_law("a.csv", None), "linkage: None is not a linkage; give one, as load(..) has it"),
    "deep list of joints": (lambda: sb.from_axes(nested()), "a list or a mapping is nested without end; give numbers"),
    "deep list for a name": (lambda: sb.load("rssr").motion(input=nested()), "input: no joint a value too large to print"),
    "deep list of numbers": (lambda: sb.rssr(1, 2, 3, nested()), "a list or a mapping is nested without end"),
    "long name": (lambda: sb.load("rssr").motion(input=LONG), "input: no joint 'xxx"),
    "long path": (lambda: sb.load(LONG), "source: 'xxx"),
    "long source": (lambda: sb.loads("format = 1", LONG), "source: 'xxx"),
    "function without a torque": (
        lambda: loaded().motion(36)[0].free_motion(1.0, torque=lambda _: None), "torque: at a speed: None is not a number"),
    "long unit": (lambda: sb.slider_crank("1 mm", 2, length_unit=LONG), "length_unit: 'xxx"),
    "huge index": (lambda: sb.load("rssr").unit_of(10**5000), "column: a number too large to print is not the number"),
    "column beyond": (lambda: sb.load("rssr").turns(8), "column: 8 is not the number of a column; give 0 to 7"),
    "column unknown": (lambda: sb.load("rssr").turns("crnk"), "column: no joint 'crnk'; did you mean 'crank'? "),
    "loads that are none": (lambda: loaded().loaded(loads=[3]), "loads[0]: 3 is not a load; give loads in a list, as in"),
    "loads that are no list": (lambda: loaded().loaded(loads=3), "loads: 3 is no list; give loads in a list"),
    "springs that are none": (lambda: loaded().loaded(springs=(None,)), "springs[0]: None is not a spring; give"),
    "bodies that are no mapping": (lambda: loaded().loaded(bodies=[1]), "bodies: [1] is not a mapping of links; give one"),
    "stops that are no mapping": (lambda: loaded().stopped(radii=(1, 2)), "radii: (1, 2) is not a mapping; give one"),
    "start after many turns": (
        lambda: loaded().motion(36)[0].free_motion(1.0, start=1e300), "start: 1e+300 rad is lost in its turns"),
    "energy": (
        lambda: loaded().motion(36)[0].free_motion(1.0, energy=np.array(["a", "b"])), "energy: array(['a', 'b']"),
    "rows of forces": (lambda: loaded().motion(36)[0].forces().on(3), "rows: 3 chooses no rows; give a mask, numbers"),
    "body": (lambda: sb.Body(1.0, (0, 0, 0), solid=np.zeros(2)), "solid: array([0., 0.]) is not offered; give"),
    "law of texts": (lambda: sb.Law("a", 1, 1, 1, 1), "t: 'a' is not a number; give a number"),
    "law of other lengths": (
        lambda: sb.Law([0, 1], [0], [0, 1], [0, 1], [0, 1]), "q: 1 values where t has 2; give as many"),
    "law that is not finite": (lambda: sb.Law([0, np.nan], *[[0, 1]] * 4), "t[1]: nan is not a finite number"),
    "plane": (lambda: sb.MotionPlane("a", (0, 0, 1), (1, 0, 0), (0, 1, 0)), "origin: 'a' is not a number; give"),
    "plane of two numbers": (lambda: sb.MotionPlane((0, 0), (0, 0, 1), (1, 0, 0), (0, 1, 0)), "origin: 2 numbers; give"),
    "sphere": (lambda: sb.MotionSphere((0, 0, 0), -1), "radius: -1 is not a length; give a number > 0"),
    "array for a branch": (lambda: sb.load("rssr").motion(36)[0].at(0.3, branch=np.zeros(3)), "branch: array([0., 0., 0.]) is"),
    "array for a link": (
        lambda: loaded().motion(36)[0].counterweights(np.zeros((3, 3))), "links: link array([0., 0., 0.]) is not a link"),
    "array for points": (lambda: sb.slider_crank(1, 2, points=np.zeros(3)), "points: array([0., 0., 0.]) is not points by"),
    "deep list for a unit": (lambda: sb.bennett(1, 1, 1, length_unit=nested()), "length_unit: a value too large to print"),
    "body of no link": (lambda: sb.Loading(bodies={"a": sb.Body(1, (0, 0, 0))}), "bodies: 'a' is not a link; give 1"),
    "point without a name": (lambda: sb.Point(1, "b", [1]), "name: 1 is not a name; give printable text in quotes"),
    "point of no link": (lambda: sb.Point("P", 0, (1, 2, 3)), "link: 0 is not a link; give 1 or more"),
    "point of one number": (lambda: sb.Point("P", 1, [1]), "at: 1 numbers; give three"),
    "joint of no kind": (lambda: sb.Joint("Q", "a"), "kind: 'Q' is not a joint kind; give R, P, H, C, U, S, E, K or L"),
    "joint of a text": (lambda: sb.Joint("U", "a", angle="90 mm"), "angle: '90 mm' is not a number with a unit"),
    "drive of an array": (lambda: sb.Drive(np.zeros(2), "b"), "joint: array([0., 0.]) is not a name; give"),
    "drive at no speed": (lambda: sb.Drive("a", "b", float("nan")), "speed: nan is not a finite number"),
    "load on no link": (lambda: sb.Load(1.5, torque=(0, 0, 1)), "link: 1.5 is not a link; give 1 or more"),
    "spring of a number": (lambda: sb.Spring(1, links=3), "links: 3 are not two different links"),
    "spring of no joint": (lambda: sb.Spring(1, joint=3), "joint: 3 is not a name; give printable text in quotes"),
    "linkage of shapes": (
        lambda: replace(sb.load("rssr"), frames=np.eye(4)), "frames: an array of shape (4, 4), not (4, 2, 4, 4); make"),
    "linkage without a drive": (lambda: replace(sb.load("rssr"), drive=None), "drive: None is not a drive; make"),
    "linkage of joints": (lambda: replace(sb.load("rssr"), joints=(1, 2)), "joints[0]: 1 is not a joint; make"),
    "linkage": (lambda: sb.Linkage("a", (), None, None, None), "frames: None is not an array; make linkages"),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG)
def test_what_a_function_cannot_take_is_refused_at_its_border_in_a_short_message(case: str) -> None:
    call, message = WRONG[case]
    with pytest.raises(SevenbarError) as caught:
        call()
    assert message in str(caught.value)
    assert len(str(caught.value)) < 300


#: How the classes are made that a caller makes; every other public class is a result.
MADE: dict[str, Callable[[], Any]] = {
    "Body": lambda: sb.Body(1.0, (0, 0, 0)),
    "Cone": lambda: sb.Cone("45 deg"),
    "Drive": lambda: sb.Drive("crank", "rocker"),
    "Joint": lambda: sb.Joint("R", "crank"),
    "Law": lambda: sb.Law.of([0, 1], [0, 1], 1, 0),
    "Linkage": lambda: sb.load("rssr"),
    "Load": lambda: sb.Load(2, torque=(0, 0, 1)),
    "Loading": sb.Loading,
    "MotionPlane": lambda: sb.MotionPlane((0, 0, 0), (0, 0, 1), (1, 0, 0), (0, 1, 0)),
    "MotionSphere": lambda: sb.MotionSphere((0, 0, 0), 1),
    "Point": lambda: sb.Point("P", 1, (0, 0, 0)),
    "Spring": lambda: sb.Spring(1.0, joint="crank"),
}

#: Classes that results are of; the program alone makes them.
RESULTS = {
    "ChangePoint",
    "Circuit",
    "Count",
    "DeadCentre",
    "Equilibrium",
    "Extremes",
    "FourBar",
    "FreeMotion",
    "InstantCentre",
    "InstantCentres",
    "Modes",
    "Motion",
    "OnePose",
    "OpenRange",
    "Output",
    "PartAxis",
    "ScrewAxes",
    "Search",
    "Trace",
}


def test_every_public_class_is_one_that_callers_make_or_that_of_a_result() -> None:
    classes = {name for name in sb.__all__ if inspect.isclass(getattr(sb, name))}
    assert classes == RESULTS | set(MADE)


@pytest.mark.parametrize("name", MADE)
@pytest.mark.parametrize(
    "garbage",
    [object, lambda: "\ud800", lambda: np.zeros((2, 2)), lambda: b"a", lambda: iter([1])],
    ids=["object", "surrogate", "array", "bytes", "iterator"],
)
def test_a_class_that_callers_make_takes_garbage_for_none_of_its_arguments(
    name: str, garbage: Callable[[], Any]
) -> None:
    made = MADE[name]()
    for one in fields(made):
        # a switch is on for whatever Python calls true; an error that agrees is checked by agreeing()
        if one.name in ("backwards", "agree", "points_by_two"):
            continue
        with pytest.raises(SevenbarError) as caught:
            replace(made, **{one.name: garbage()})
        assert len(str(caught.value)) < 300, one.name


def arrays_of(found: Any) -> list[tuple[str, np.ndarray]]:
    return [(name, value) for name, value in vars(found).items() if isinstance(value, np.ndarray)]


@pytest.mark.parametrize(
    "made",
    [
        lambda: sb.load("rssr"),
        lambda: sb.load("rssr").motion(36),
        lambda: sb.load("rssr").motion(36).circuits[0],
        lambda: sb.load("seven_r").motion(20_000).circuits[0],
        lambda: sb.load("rssr").motion(36).circuits[0].point(2, (1, 2, 3)),
        lambda: sb.load("rssr").motion(36).circuits[0].screw_axes(2),
        lambda: sb.load("rssr").motion(36).circuits[0].link_motion(2),
        lambda: sb.load("rssr").assembly_modes(0.3),
        lambda: sb.load("rssr").output([0.3, 0.4], 2),
        lambda: sb.load("planar_4r").plane,
        lambda: loaded().motion(36).circuits[0].forces(),
        lambda: loaded().motion(36).circuits[0].free_motion(0.1, samples=11),
        lambda: sb.Law.of([0, 1], [0, 1], 1, 0),
    ],
)
def test_arrays_of_results_and_of_their_copies_cannot_be_written(made: Callable[[], Any]) -> None:
    found = made()
    if isinstance(found, sb.Circuit):
        assert len(found.q)  # a long one computes them at the first look
    copies = [found, copy.copy(found)]
    # those hold functions of the core, which are not copied
    if type(found).__name__ not in ("FreeMotion", "Forces"):
        copies += [copy.deepcopy(found), pickle.loads(pickle.dumps(found))]
    for one in copies:
        assert arrays_of(one)
        for name, array in arrays_of(one):
            assert not array.flags.writeable, name
            with pytest.raises(ValueError, match="read-only"):
                array[...] = 0


def test_what_a_caller_gives_stays_writable() -> None:
    motion = loaded().motion(36).circuits[0].free_motion(0.1, samples=11)
    times, origin = np.linspace(0, 0.1, 5), np.zeros(3)
    at = motion.at(times)
    sb.MotionPlane(origin, (0, 0, 1), (1, 0, 0), (0, 1, 0))
    times[0], origin[0] = 0.01, 1.0
    assert at.time[0] == 0


def test_circuits_have_their_own_arrays_read_only_too() -> None:
    circuit = sb.load("planar_4r").motion(36).circuits[0]
    for array in (
        circuit.q,
        circuit.dq,
        circuit.time,
        circuit.status,
        circuit.input,
        circuit.transmission_angle,
    ):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = array[1]


def test_garbage_is_refused_by_every_public_name_and_method_without_an_error_from_inside() -> None:
    found = calls.run(800, seed=11)
    assert found.faults == {}
    assert found.calls == 800
    assert found.ends["refused"] > 150
    assert found.ends["result"] > 150


def test_the_search_for_errors_from_inside_finds_one() -> None:
    def careless(name: Any) -> Any:
        return name.upper()

    found = calls.Found()
    calls._judge(calls._target("careless", careless), {"name": "None"}, found)
    assert found.ends == {"error from inside": 1}
    (flaw,) = found.faults
    assert "test_borders.py" in flaw

    def careful(name: Any) -> Any:
        raise RequestError(f"name: {name} is none")

    calls._judge(calls._target("careful", careful), {"name": "None"}, found)
    assert found.ends["refused"] == 1
