"""Straight lines as wants: the length is a bound, and minimax is the greatest distance wherever the linkage lies."""

import math

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

import sevenbar as sb
from sevenbar.description.draft import Draft
from sevenbar.design.task import DesignTask, FreeNumber, StraightWant, designed
from sevenbar.design.task.along import DesignAlong
from sevenbar.errors import RequestError

SPAN = (math.radians(90.0), math.radians(270.0))


def hoeken_like(turned=0.0, tilted=0.0):
    """A four-bar 20, 50, 50, 42 drawn at crank 0, with P 98 along the coupler; turned about z, then about x."""
    c, s = math.cos(turned), math.sin(turned)
    ct, st = math.cos(tilted), math.sin(tilted)
    turn = np.array([[1, 0, 0], [0, ct, -st], [0, st, ct]]) @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    # the coupler's end: 50 from (20, 0) and from (42, 0)
    joint = np.array([31.0, math.sqrt(50.0**2 - 11.0**2), 0.0])
    pin = np.array([20.0, 0.0, 0.0])
    places = [np.zeros(3), pin, joint, np.array([42.0, 0.0, 0.0])]
    joints = [
        {"name": n, "kind": "R", "at": (turn @ p).tolist(), "axis": turn[:, 2].tolist()}
        for n, p in zip("ABCD", places, strict=True)
    ]
    tip = turn @ (pin + 98.0 / 50.0 * (joint - pin))
    return Draft.of_linkage(sb.from_axes(joints, length_unit="mm")).with_point("P", 2, tuple(map(float, tip)))


def half_width(places):
    """Half the least width of places (n, 2) over the direction of a strip."""

    def width(angle):
        return np.ptp(places @ [-math.sin(angle), math.cos(angle)])

    grid = np.linspace(0.0, math.pi, 2001)
    best = grid[np.argmin([width(angle) for angle in grid])]
    step = grid[1]
    found = minimize_scalar(
        width, bounds=(best - step, best + step), method="bounded", options={"xatol": 1e-14}
    )
    return found.fun / 2


def line_alone(draft, axis, goal):
    """The line of the given linkage: the one free number moves P hardly, and square to its plane."""
    value = draft.dimension(f"P.{axis}").value
    free = (FreeNumber(f"P.{axis}", value - 1e-3, value + 1e-3),)
    task = DesignTask(draft, free, (StraightWant("P", SPAN, samples=41),), goal=goal)
    return designed(task, count=1, starts=0).designs[0]


@pytest.mark.parametrize(
    ("turned", "tilted", "square"),
    [(0.0, 0.0, "z"), (0.5, 0.0, "z"), (math.pi / 4, 0.0, "z"), (0.3, math.pi / 2, "y")],
)
def test_the_greatest_distance_is_half_the_least_width_however_the_linkage_is_turned(turned, tilted, square):
    law = sb.Law.of(np.arange(41.0), np.linspace(*SPAN, 41), 1.0, 0.0)
    expected = min(half_width(c.point("P").position[:41, :2]) for c in hoeken_like().linkage.motion(law=law))
    assert expected == pytest.approx(0.71566, abs=1e-5)
    design = line_alone(hoeken_like(turned, tilted), square, "minimax")
    assert design.met[0].greatest == pytest.approx(expected, rel=1e-6)


def test_a_length_that_is_not_reached_is_refused_with_how_far_the_point_goes():
    draft = hoeken_like()
    x = draft.dimension("B.x").value
    want = StraightWant("P", SPAN, 4000.0)
    with pytest.raises(RequestError, match=r"the point goes \d+\.?\d* mm, at least 4000 mm is asked"):
        designed(DesignTask(draft, (FreeNumber("B.x", x - 2, x + 2),), (want,)), count=1, starts=2).required(
            2
        )


def test_a_length_is_a_bound():
    draft = hoeken_like()
    names = ("B.x", "C.x", "C.y", "D.x", "P.x", "P.y")
    free = tuple(FreeNumber(n, draft.dimension(n).value - 25, draft.dimension(n).value + 25) for n in names)
    for length in (110.0, 150.0):
        task = DesignTask(draft, free, (StraightWant("P", SPAN, length),))
        (design,) = designed(task, count=1, starts=2).designs
        assert DesignAlong(task, design).facts(0)[0].value >= length * (1 - 1e-6)
