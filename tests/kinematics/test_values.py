"""What Sevenbar returns are values: they are copied, pickled and sent to other processes, used or not."""

import copy
import math
import multiprocessing
import pickle
from concurrent.futures import ProcessPoolExecutor
from dataclasses import fields, is_dataclass, replace
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest

import sevenbar as sb
from gallery_sample import sampled
from sevenbar.arrays import Floats
from sevenbar.description.draft import Draft
from sevenbar.design.wish import wish_of_function
from sevenbar.errors import RequestError
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.loop.law import Law
from sevenbar.kinematics.measures import MEASURES, Measure, measures_named
from sevenbar.text.expression import function_of

SAMPLES = 24

#: One of each way through the program: closed form, general, with balls, with slides, a screw, overconstrained.
WAYS = ("rssr", "seven_r", "rscr", "rssp", "bennett", "screw_drill")


def pickled(value):
    return pickle.loads(pickle.dumps(value))


AGAIN = (pickled, copy.deepcopy)


def same(a: object, b: object) -> bool:
    """Whether two values hold the same, to the last bit."""
    if isinstance(a, np.ndarray):
        return isinstance(b, np.ndarray) and a.dtype == b.dtype and a.tobytes() == b.tobytes()
    if is_dataclass(a) and not isinstance(a, type):
        names = [f.name for f in fields(a) if f.name != "_point"]
        return type(a) is type(b) and all(same(getattr(a, n), getattr(b, n)) for n in names)
    if isinstance(a, tuple | list):
        return type(a) is type(b) and len(a) == len(b) and all(map(same, a, b))
    if isinstance(a, dict):
        return isinstance(b, dict) and list(a) == list(b) and all(same(a[k], b[k]) for k in a)
    return a == b or (a != a and b != b)


TIMES = np.linspace(0, 1, 9)
LAW = Law.of(TIMES, 0.3 + 2 * TIMES**2, 4 * TIMES, 4)


def used(linkage: sb.Linkage) -> sb.Linkage:
    """The linkage once everything that it keeps has been asked for."""
    linkage.motion(SAMPLES)
    linkage.motion(SAMPLES, method="general")
    linkage.assembly_modes(0.3)
    linkage.mobility()
    return linkage


def answers_alike(motion: sb.Motion, other: sb.Motion) -> bool:
    """Whether two motions hold the same and tell the same of points and links."""
    at = (0.3, -0.2, 0.7)
    links = range(1, len(motion.linkage.joints) + 1)
    return same(motion, other) and all(
        same(circuit.point(link, at), twin.point(link, at))
        and same(circuit.link_motion(link), twin.link_motion(link))
        for circuit, twin in zip(motion, other, strict=True)
        for link in links
    )


@pytest.mark.parametrize("again", AGAIN)
@pytest.mark.parametrize("name", sampled())
def test_a_linkage_is_copied_before_and_after_it_is_used(name, again):
    linkage = sb.load(name)
    twin = again(linkage)
    assert same(linkage, twin)
    late = again(used(linkage))
    assert same(linkage, late)
    # read-only as the first one, and without what it worked out
    assert not late.base.flags.writeable
    assert set(vars(late)) == {f.name for f in fields(late)}
    assert answers_alike(linkage.motion(SAMPLES), late.motion(SAMPLES))


@pytest.mark.parametrize("again", AGAIN)
@pytest.mark.parametrize("name", sampled())
def test_a_copied_motion_tells_the_points_of_every_link(name, again):
    linkage = sb.load(name)
    for motion in (
        linkage.motion(SAMPLES),
        linkage.motion(SAMPLES, method="general"),
        linkage.motion(SAMPLES, law=LAW),
        linkage.motion(SAMPLES, speed=-2.0),
    ):
        assert motion.circuits
        twin = again(motion)
        assert answers_alike(motion, twin)
        # and a copy of a copy
        assert answers_alike(motion, again(twin))


@pytest.mark.parametrize("again", AGAIN)
@pytest.mark.parametrize("name", WAYS)
def test_what_a_linkage_tells_is_copied(name, again):
    linkage = sb.load(name)
    for value in (
        linkage.assembly_modes(0.3),
        linkage.mobility(),
        linkage.motion(SAMPLES).circuits[0].point(1, (0, 0, 1)),
    ):
        assert same(value, again(value))
    if name == "rssr":
        output = linkage.output([0.1, 0.2], 3)
        assert same(output, again(output))


def _walked(linkage: sb.Linkage) -> sb.Motion:
    return linkage.motion(SAMPLES)


def _path(circuit: Circuit) -> Floats:
    return circuit.point(1, (0.0, 0.0, 1.0)).jerk


@pytest.mark.parametrize("start", ["spawn", "forkserver"])
def test_linkages_and_circuits_go_through_a_pool_of_processes(start):
    linkages = [used(sb.load(name)) for name in WAYS]
    motions = [linkage.motion(SAMPLES) for linkage in linkages]
    circuits = [motion.circuits[0] for motion in motions]
    with ProcessPoolExecutor(2, multiprocessing.get_context(start)) as pool:
        for motion, twin in zip(motions, pool.map(_walked, linkages), strict=True):
            assert answers_alike(motion, twin)
        for circuit, path in zip(circuits, pool.map(_path, circuits), strict=True):
            assert same(_path(circuit), path)


def test_numbers_that_are_no_rows_make_none():
    from sevenbar import _core

    motion = sb.load("seven_r").motion(SAMPLES)
    kind, (numbers, offsets, speed, still) = motion.circuits[0]._point.args[0].__reduce__()
    assert kind is _core.Rows
    assert kind(numbers, offsets, speed, still).__reduce__()[1][0].tobytes() == numbers.tobytes()
    with pytest.raises(_core.CoreError, match="rows need 50 numbers each"):
        kind(numbers[:, 1:].copy(), offsets, speed)
    broken = numbers.copy()
    broken[3, -4] = 9.0
    with pytest.raises(_core.CoreError, match="no rows of a circuit"):
        kind(broken, offsets, speed)


def test_laws_of_the_same_numbers_are_one_law():
    t = np.linspace(0, 1, 5)
    law, twin = Law.of(t, t**2, 2 * t, 2), Law.of(list(t), t**2, 2 * t, np.full(5, 2.0))
    assert law == twin
    assert hash(law) == hash(twin)
    assert {law: 1}[twin] == 1
    assert law == pickled(law) == copy.deepcopy(law)
    assert hash(law) == hash(Law.of(t, t**2, 2 * t, 2, -0.0))
    for other in (
        Law.of(t, t**2, 2 * t, 3),
        Law.of(t[:4], t[:4] ** 2, 2 * t[:4], 2),
        Law.of(t + 1, t**2, 2 * t, 2),
    ):
        assert law != other
    assert law != "a law"


def test_a_law_keeps_its_numbers_when_the_caller_s_change():
    t, q = np.linspace(0, 1, 5), np.linspace(1, 2, 5)
    law = Law.of(t, q, 1, 0)
    t[0], q[0] = -5.0, 7.0
    assert (law.t[0], law.q[0]) == (0.0, 1.0)
    with pytest.raises(ValueError, match="read-only"):
        law.q[0] = 3.0
    assert not pickled(law).q.flags.writeable


@pytest.mark.parametrize("again", AGAIN)
def test_measures_and_drafts_are_copied(again):
    motion = sb.load("rssr").motion(SAMPLES)
    for measure in MEASURES.values():
        assert again(measure) is measure
    (own,) = measures_named([_first_lowest])
    assert again(own) == own
    assert again(own).value(motion) == _first_lowest(motion)
    other = Measure("turns", "circuit", "count", len, "not the one of that name")
    assert again(other) == other
    draft = Draft.of_linkage(sb.load("seven_r"))
    assert draft.linkage
    assert draft.dimensions == again(draft).dimensions


def _first_lowest(motion: sb.Motion) -> float:
    return motion.circuits[0].angle.lowest


@pytest.mark.parametrize("name", ["rssr", "seven_r"])
@pytest.mark.parametrize(
    ("value", "message"),
    [
        ([0.1, 0.2], "theta: 2 values where one belongs; give one number"),
        ([], "theta: 0 values where one belongs; give one number"),
        (
            "a",
            "theta: 'a' is not a number with a unit that fits; give one as in '30 deg', or a number in radians",
        ),
        (
            "0.3",
            "theta: '0.3' is not a number with a unit that fits; give one as in '30 deg', or a number in radians",
        ),
        (None, "theta: None is not a number; give a number"),
        (True, "theta: True is not a number; give a number"),
        (np.True_, f"theta: {np.True_!r} is not a number; give a number"),
        (1j, "theta: 1j is not a number; give a number"),
        ([None], "theta: [None] is not an array of numbers; give an array of numbers"),
        (
            [[1.0], [2.0, 3.0]],
            "theta: [[1.0], [2.0, 3.0]] is not an array of numbers; give an array of numbers",
        ),
        ([[0.1]], "theta: an array of shape (1, 1) does not fit; give one dimension"),
        (math.nan, "theta: nan is not a finite number"),
        (-math.inf, "theta: -inf is not a finite number"),
        (10**400, "is not a number; give a number"),
    ],
)
def test_modes_are_asked_for_at_one_number(name, value, message):
    with pytest.raises(RequestError) as error:
        sb.load(name).assembly_modes(value)
    assert message in str(error.value)


@pytest.mark.parametrize(
    "value", [1, np.float32(1), np.int8(1), np.array(1.0), [1.0], Decimal(1), Fraction(1)]
)
def test_one_number_of_any_kind_is_a_number(value):
    linkage = sb.load("rssr")
    assert same(linkage.assembly_modes(value), linkage.assembly_modes(1.0))
    assert same(linkage.output(value), linkage.output([1.0]))


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (
            "a",
            "input: 'a' is not a number with a unit that fits; give one as in '30 deg', or a number in radians",
        ),
        (
            ["a", "b"],
            "input[0]: 'a' is not a number with a unit that fits; give one as in '30 deg', or a number in radians",
        ),
        (None, "input: None is not a number; give a number"),
        ([True], "input: [True] is not an array of numbers; give an array of numbers"),
        ([0.0, None], "input: [0.0, None] is not an array of numbers; give an array of numbers"),
        (np.eye(2), "input: an array of shape (2, 2) does not fit; give one dimension"),
    ],
)
def test_outputs_are_asked_for_at_numbers(value, message):
    with pytest.raises(RequestError) as error:
        sb.load("rssr").output(value)
    assert str(error.value) == message


def test_every_place_that_takes_numbers_says_what_is_none():
    linkage = sb.load("rssr")
    circuit = linkage.motion(SAMPLES).circuits[0]
    for call, message in (
        (lambda: circuit.point(1, "abc"), "at: 'abc' is not a number; give a number"),
        (
            lambda: circuit.point(1, (0, 0, None)),
            "at: (0, 0, None) is not an array of numbers; give an array of numbers",
        ),
        (
            lambda: linkage.circuit("pose"),
            "pose: 'pose' is not a number with a unit that fits; give one as in '30 deg', or a number in radians",
        ),
        (
            lambda: Law.of([0, 1], [True, False], 0, 0),
            "q: [True, False] is not an array of numbers; give an array of numbers",
        ),
        (
            lambda: linkage.output([0.1], 1, ["fast"]),
            "speed: ['fast'] is not an array of numbers; give an array of numbers",
        ),
        (
            lambda: linkage.output([0.1], 2, acceleration="x"),
            "acceleration: 'x' is not a number; give a number",
        ),
    ):
        with pytest.raises(RequestError) as error:
            call()
        assert str(error.value) == message


@pytest.mark.parametrize("again", AGAIN)
def test_a_design_s_wish_keeps_its_function_through_a_copy(again):
    wish = wish_of_function(function_of("x^2 + sin(x)"), (0.0, 1.0), (0.0, 1.5), (0.2, 1.0), points=3)
    twin = again(wish)
    readings = np.linspace(0, 1.5, 7)
    assert same(wish.function(readings), twin.function(readings))
    assert same(replace(wish, function=None), replace(twin, function=None))
