"""Linkages of the textbooks as joints drawn in one pose: planar and spherical ones, anywhere in space."""

from __future__ import annotations

from math import acos, cos, hypot, pi, sin, sqrt

import numpy as np

import sevenbar as sb


def circles_meet(first, a, second, b):
    """The upper point at distances a and b of two points of the plane, or None."""
    (x1, y1), (x2, y2) = first, second
    d = hypot(x2 - x1, y2 - y1)
    along = (a * a - b * b + d * d) / (2 * d)
    square = a * a - along * along
    if square < 0:
        return None
    u, v = (x2 - x1) / d, (y2 - y1) / d
    up = sqrt(square)
    return x1 + along * u - up * v, y1 + along * v + up * u


def four_bar_joints(crank, coupler, rocker, ground, at=1.0):
    """A planar 4R at a crank angle where it closes: O2 in the origin, O4 on x."""
    for angle in (at, *np.linspace(0.05, 3.1, 60)):
        a = (crank * cos(angle), crank * sin(angle))
        b = circles_meet(a, coupler, (ground, 0.0), rocker)
        if b is not None:
            places = [(0.0, 0.0), a, b, (ground, 0.0)]
            names = ["crank", "coupler_pin", "rocker_pin", "rocker"]
            return [
                {"name": name, "kind": "R", "at": [*place, 0.0], "axis": [0, 0, 1]}
                for name, place in zip(names, places, strict=True)
            ]
    return None


def slider_crank_joints(crank, rod, offset=0.0, at=1.0, slide="P"):
    """Crank in the origin, the slider on a line along x at the height of the offset."""
    a = (crank * cos(at), crank * sin(at))
    b = (a[0] + sqrt(rod * rod - (offset - a[1]) ** 2), offset)
    return [
        {"name": "crank", "kind": "R", "at": [0, 0, 0], "axis": [0, 0, 1]},
        {"name": "crank_pin", "kind": "R", "at": [*a, 0], "axis": [0, 0, 1]},
        {"name": "wrist", "kind": "R", "at": [*b, 0], "axis": [0, 0, 1]},
        {"name": "slider", "kind": slide, "at": [*b, 0], "axis": [1, 0, 0]},
    ]


def spherical_joints(crank, coupler, rocker, ground, at=1.0, radius=0.0):
    """A spherical 4R by its arcs [rad]: the crank's axis along z, the rocker's in the xz plane."""
    o4 = np.array([sin(ground), 0.0, cos(ground)])
    for angle in (at, *np.linspace(0.05, 3.1, 60)):
        a = np.array([sin(crank) * cos(angle), sin(crank) * sin(angle), cos(crank)])
        between = acos(np.clip(a @ o4, -1, 1))
        top = cos(coupler) - cos(between) * cos(rocker)
        bottom = sin(between) * sin(rocker)
        if bottom and abs(top) < abs(bottom):
            turn = acos(top / bottom)
            u = a - cos(between) * o4
            u = u / np.linalg.norm(u)
            v = np.cross(o4, u)
            b = cos(rocker) * o4 + sin(rocker) * (cos(turn) * u + sin(turn) * v)
            axes = [np.array([0.0, 0.0, 1.0]), a, b, o4]
            names = ["crank", "coupler_pin", "rocker_pin", "rocker"]
            return [
                {"name": n, "kind": "R", "at": (radius * x).tolist(), "axis": x.tolist()}
                for n, x in zip(names, axes, strict=True)
            ]
    return None


def moved(joints, rotation, shift):
    """The same joints elsewhere."""
    found = []
    for joint in joints:
        one = dict(joint)
        one["at"] = (rotation @ np.asarray(joint["at"], dtype=float) + shift).tolist()
        if "axis" in joint:
            one["axis"] = (rotation @ np.asarray(joint["axis"], dtype=float)).tolist()
        if "axes" in joint:
            one["axes"] = [(rotation @ np.asarray(a, dtype=float)).tolist() for a in joint["axes"]]
        found.append(one)
    return found


def rewritten(joints, seed=0):
    """The same linkage written in other ways: what was done, by what it is larger, and its joints."""
    rng = np.random.default_rng(seed)
    yield "as it is", 1.0, joints
    for shift in (0.0, 1.0, 1e3):
        yield f"moved by {shift}", 1.0, moved(joints, rotation(rng), shift * rng.normal(size=3))
    yield "mirrored", 1.0, moved(joints, -rotation(rng), rng.normal(size=3))
    for scale in (1e-6, 1 / 3, 1e3, 1e6):
        larger = [{**joint, "at": [scale * x for x in joint["at"]]} for joint in joints]
        yield f"times {scale}", scale, moved(larger, rotation(rng), scale * rng.normal(size=3))
    yield (
        "axes reversed",
        1.0,
        [
            {**j, "axis": [-x for x in j["axis"]]} if "axis" in j and i % 2 else j
            for i, j in enumerate(joints)
        ],
    )
    along = [
        {**j, "at": (np.array(j["at"]) + 0.7 * (i + 1) * np.array(j["axis"])).tolist()}
        if j["kind"] in "RC"
        else j
        for i, j in enumerate(joints)
    ]
    yield "places moved along axes", 1.0, along
    yield "from the other end", 1.0, joints[::-1]
    for k in range(1, len(joints)):
        yield f"from joint {k + 1} on", 1.0, joints[k:] + joints[:k]


def rotation(rng):
    """A random rotation (3, 3)."""
    matrix, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return matrix if np.linalg.det(matrix) > 0 else -matrix


def tilt(angle):
    """A small turn about a line that is none of the axes."""
    x, y, z = np.array([2.0, -1.0, 2.0]) / 3
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + sin(angle) * cross + 2 * sin(angle / 2) ** 2 * cross @ cross


def linkage(joints, **given):
    return sb.from_axes(joints, **given)


QUARTER = pi / 2
