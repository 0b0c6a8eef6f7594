"""Linkages at the edges: change points and what lies just beside them, decimals as typed, narrow circuits.

Drawings in tenths make equal lengths, parallels and right angles, and lengths that fit to rounding only.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from evidence.fuzz.random_loops import common_normal, direction

Description = dict[str, Any]
Draw = Callable[[np.random.Generator], Description]

#: Lengths are whole numbers up to this of tenths or hundredths.
LARGEST = 30

#: Decades by which one number is off a change point, and by which an isolated pose is opened.
OFF, OPENED = (-16, -3), (-11, -4)

#: Smallest singular value and second-order form of an isolated pose, so that nothing else is near.
CLEARLY = 0.1

#: Singular values of screws below this are those of axes that fit exactly, to rounding.
NOTHING = 1e-9


def _round(rng: np.random.Generator, count: int) -> np.ndarray:
    """Numbers in tenths or hundredths, as decimals are read."""
    digits = int(rng.integers(1, 3))
    return np.array([round(float(n) / 10**digits, digits) for n in rng.integers(1, LARGEST + 1, count)])


def _shortest_and_longest(rng: np.random.Generator) -> np.ndarray:
    """Four numbers in any order, the shortest and the longest together as long as the others."""
    while True:
        one, two, three = np.sort(_round(rng, 3))
        longest = round(two + three - one, 2)
        if longest >= three:
            return rng.permutation([one, two, three, longest])


def planar_rows(length: np.ndarray) -> Description:
    """A four-bar by its lengths, crank first."""
    return {"format": 1, "link": [{"joint": "R", "length": float(x), "twist": 0.0} for x in length]}


def at_change(rng: np.random.Generator) -> Description:
    """Planar four-bars that fold flat."""
    return planar_rows(_shortest_and_longest(rng))


def beside_change(rng: np.random.Generator) -> Description:
    """The same, one length off by little."""
    length = _shortest_and_longest(rng)
    length[rng.integers(4)] += rng.choice([-1, 1]) * 10 ** rng.uniform(*OFF)
    return planar_rows(length)


def stretched(rng: np.random.Generator) -> Description:
    """Planar four-bars that close in one stretched pose only."""
    length = _round(rng, 3)
    return planar_rows(np.roll([*length, round(float(length.sum()), 2)], rng.integers(4)))


def spherical_at_change(rng: np.random.Generator) -> Description:
    """Spherical four-bars in tens of degrees that fold flat."""
    while True:
        one, two, three = np.sort(10.0 * rng.integers(1, 18, 3))
        longest = two + three - one
        if three <= longest < 180:
            twist = rng.permutation([one, two, three, longest])
            return {"format": 1, "link": [{"joint": "R", "length": 0.0, "twist": float(t)} for t in twist]}


def _turning_at(points: np.ndarray) -> Description:
    joints = [
        {"kind": "R", "at": [float(x), float(y), 0.0], "axis": [0.0, 0.0, 1.0]}
        for x, y in np.round(points, 2)
    ]
    return {"format": 1, "joint": joints}


def parallelogram(rng: np.random.Generator) -> Description:
    """As drawn, in tenths."""
    while True:
        a, b = rng.integers(-LARGEST, LARGEST + 1, (2, 2)) / 10
        if abs(a[0] * b[1] - a[1] * b[0]) > CLEARLY:
            return _turning_at(np.array([[0, 0], a, a + b, b]))


def kite(rng: np.random.Generator) -> Description:
    """As drawn; a rhombus one time in three."""
    along, across, rest = _round(rng, 3)
    if rng.random() < 1 / 3:
        rest = along
    return _turning_at(np.array([[0, 0], [along, across], [along + rest, 0], [along, -across]]))


def _lines_crossed(rng: np.random.Generator, lines: int) -> Description:
    """Axes that all meet one line, or two: as many wrenches bear no joint's power."""
    joints = []
    for _ in range(int(rng.integers(5, 7))):
        at = np.array([rng.uniform(-1, 1), 0.0, 0.0])
        to = np.array([0.3, rng.uniform(-1, 1), 1.0])
        axis = direction(rng) if lines == 1 else to - at
        joints.append({"kind": "R", "at": at.tolist(), "axis": axis.tolist()})
    return {"format": 1, "joint": joints}


def shaky(rng: np.random.Generator) -> Description:
    """Five or six axes with infinitesimal freedoms, and no other in most of them."""
    return _lines_crossed(rng, int(rng.integers(1, 3)))


def _screws(point: np.ndarray, axis: np.ndarray, letter: str) -> list[np.ndarray]:
    slide = [np.r_[np.zeros(3), axis]] if letter in "PC" else []
    if letter == "P":
        return slide
    turns = np.eye(3) if letter == "S" else np.atleast_2d(axis)
    return [np.r_[a, np.cross(point, a)] for a in turns] + slide


def second_order_forms(screws: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Singular values of the screws (6, n), what they leave free (m, n), and the forms (k, m, m) on that.

    A form for each wrench that no joint yields to: the velocity v begins a motion only where all are 0.
    """

    def bracket(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        return np.r_[np.cross(a[:3], b[:3]), np.cross(a[:3], b[3:]) + np.cross(a[3:], b[:3])]

    count = screws.shape[1]
    u, s, vt = np.linalg.svd(screws)
    rank = int((s > NOTHING).sum())
    brackets = np.zeros((6, count, count))
    for i in range(count):
        for j in range(i + 1, count):
            brackets[:, i, j] = brackets[:, j, i] = bracket(screws[:, i], screws[:, j])
    free = vt[rank:]
    return s, free, np.einsum("wk,wij,ai,bj->kab", u[:, rank:], brackets, free, free)


@dataclass(frozen=True, eq=False)
class SingularPose:
    """Joints of seven freedoms in a pose with two infinitesimal freedoms, all in one linear complex about z.

    `free` (2, 7) are these, and a link moved up z by epsilon leaves the velocities v = x @ free for which
    `x @ form @ x` is 4 epsilon or -4 epsilon, to the lowest order.
    """

    letters: str
    axes: list[tuple[np.ndarray, np.ndarray]]
    free: np.ndarray
    form: np.ndarray

    def joints(self) -> list[dict[str, Any]]:
        """As drawn in this pose."""
        return [joint_at(letter, *axis) for letter, axis in zip(self.letters, self.axes, strict=True)]


def joint_at(letter: str, point: np.ndarray, axis: np.ndarray) -> dict[str, Any]:
    """The table of a joint; `axis` (3,), of U two of them, is not read of S."""
    keys = {"S": {}, "U": {"axes": axis.tolist()}}.get(letter, {"axis": axis.tolist()})
    return {"kind": letter, "at": point.tolist(), **keys}


def singular_pose(rng: np.random.Generator, letters: str, *, crossing: bool = False) -> SingularPose:
    """Of R, P, C, U, S joints: the pose is isolated, or two branches are crossing in it."""
    while True:
        # a ball bears forces through its centre only
        pitch = 0.0 if "S" in letters else 0.7 * rng.normal()
        axes = []
        for letter in letters:
            point = rng.uniform(-1, 1, 3)
            if letter == "S":
                point[:2] = 0.0
            normal = np.array([0.0, 0.0, 1.0]) if letter == "P" else np.array([-point[1], point[0], pitch])
            axis = rng.normal(size=(2, 3) if letter == "U" else 3)
            if letter == "C":
                axis = np.cross(normal, [0.0, 0.0, 1.0])
            elif letter != "S":
                axis = np.cross(normal, axis)
            axes.append((point, axis / np.linalg.norm(axis, axis=-1, keepdims=True)))
        screws = [s for axis, letter in zip(axes, letters, strict=True) for s in _screws(*axis, letter)]
        s, free, forms = second_order_forms(np.array(screws).T)
        if s[4] > CLEARLY and len(forms) == 1:
            # the wrench of the complex, one where the link moves by one along z
            form = forms[0] * np.hypot(1.0, pitch)
            low, high = np.linalg.eigvalsh(form)
            if min(abs(low), abs(high)) > CLEARLY and (low * high < 0) == crossing:
                return SingularPose(letters, axes, free, form)


def isolated_pose(rng: np.random.Generator, letters: str) -> list[tuple[np.ndarray, np.ndarray]]:
    """Points and axes of joints of seven freedoms whose pose is isolated."""
    return singular_pose(rng, letters).axes


def narrow(rng: np.random.Generator) -> Description:
    """Rows of a 7R whose lone pose is opened by a length: a circuit as wide as the root of that, or none."""
    axes = isolated_pose(rng, "R" * 7)
    normals = [common_normal(rng, *axes[k], *axes[(k + 1) % 7]) for k in range(7)]
    length = np.array([normal[3] for normal in normals])
    length[rng.integers(7)] += rng.choice([-1, 1]) * 10 ** rng.uniform(*OPENED)
    links = []
    for k, (_, axis) in enumerate(axes):
        offset = (normals[k][0] - normals[k - 1][1]) @ axis
        twist = math.degrees(normals[k][4])
        links.append({"joint": "R", "length": float(length[k]), "twist": twist, "offset": float(offset)})
    return {"format": 1, "link": links}


FAMILIES: dict[str, Draw] = {
    "planar, at a change": at_change,
    "planar, beside a change": beside_change,
    "planar, stretched": stretched,
    "spherical, at a change": spherical_at_change,
    "parallelograms as drawn": parallelogram,
    "kites and rhombi as drawn": kite,
    "shaky": shaky,
    "narrow circuits": narrow,
}
