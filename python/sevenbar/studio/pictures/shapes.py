"""The unit meshes that the solids are stretched from, each round the z axis and centred on the origin."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats

#: Corners (v, 3) and triangles (f, 3), counter-clockwise seen from outside.
Mesh = tuple[Floats, npt.NDArray[np.int64]]

#: Facets of a round shape.
ROUND = 32
#: Turns of a thread over its length, and how deep it cuts, as a share of the radius.
TURNS, DEPTH = 6, 0.25
#: A socket holds its ball up to this angle from the open end [rad]; its wall as a share of its radius.
MOUTH, WALL = math.radians(84.0), 0.16


@cache
def mesh(shape: str) -> Mesh:
    """The mesh of a shape: all fill radius 1 about z, and z from -1/2 to 1/2; ball and socket radius 1.

    The shapes are cylinder, ball, socket (open towards +z), box (side 1), hexagon, cone (tip at +z),
    thread and left thread.
    """
    match shape:
        case "cylinder":
            return _lathe([[(0, -0.5), (1, -0.5)], [(1, -0.5), (1, 0.5)], [(1, 0.5), (0, 0.5)]])
        case "cone":
            return _lathe([[(0, -0.5), (1, -0.5)], [(1, -0.5), (0, 0.5)]])
        case "ball":
            return _lathe([_arc(1.0, -math.pi / 2, math.pi / 2)])
        case "socket":
            mouth = math.pi / 2 - MOUTH
            outer, inner = _arc(1.0, -math.pi / 2, mouth), _arc(1.0 - WALL, mouth, -math.pi / 2)
            return _lathe([outer, [outer[-1], inner[0]], inner])
        case "box":
            return _prism([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])
        case "hexagon":
            return _prism([(math.cos(k * math.pi / 3), math.sin(k * math.pi / 3)) for k in range(6)])
        case "thread":
            return _thread(1.0)
        case "left thread":
            return _thread(-1.0)
        case _:
            raise KeyError(shape)


def _arc(radius: float, start: float, end: float) -> list[tuple[float, float]]:
    """Radii and heights along an arc, from one latitude [rad] to another."""
    latitudes = np.linspace(start, end, 17)
    return [(radius * math.cos(a), radius * math.sin(a)) for a in latitudes]


def _lathe(runs: Sequence[Sequence[tuple[float, float]]]) -> Mesh:
    """What runs of (radius, height) sweep about z, the solid to their left; creased between runs."""
    turn = np.linspace(0, math.tau, ROUND, endpoint=False)
    corners, faces, count = [], [], 0
    for run in runs:
        for radius, height in run:
            corners.append(
                np.stack([radius * np.cos(turn), radius * np.sin(turn), 0 * turn + height], axis=1)
            )
        faces.append(count + _quilt(len(run)))
        count += len(run) * ROUND
    return np.concatenate(corners), np.concatenate(faces)


def _quilt(rows: int) -> npt.NDArray[np.int64]:
    """The triangles between rings of corners, one ring above the other."""
    ring = np.arange(ROUND)
    following = (ring + 1) % ROUND
    low = np.arange(rows - 1)[:, None] * ROUND
    a, b, c, d = low + ring, low + following, low + ROUND + following, low + ROUND + ring
    return np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)


def _prism(outline: Sequence[tuple[float, float]]) -> Mesh:
    """The prism over a convex outline, with sharp edges."""
    flat = np.array(outline)
    count = len(flat)
    low = np.column_stack([flat, np.full(count, -0.5)])
    high = np.column_stack([flat, np.full(count, 0.5)])
    after = np.roll(np.arange(count), -1)
    corners = [low[::-1], high, *(np.stack([low[i], low[k], high[k], high[i]]) for i, k in enumerate(after))]
    fan = np.array([(0, i, i + 1) for i in range(1, count - 1)])
    square = np.array([(0, 1, 2), (0, 2, 3)])
    faces = [fan, fan + count, *(square + 2 * count + 4 * i for i in range(count))]
    return np.concatenate(corners), np.concatenate(faces)


def _thread(hand: float) -> Mesh:
    """A rod with a thread; right-handed for `hand` 1, left-handed for -1."""
    turn = np.linspace(0, math.tau, ROUND, endpoint=False)
    height = np.linspace(-0.5, 0.5, 8 * TURNS + 1)[:, None]
    phase = (height * TURNS - hand * turn / math.tau) % 1.0
    radius = 1.0 - DEPTH * np.clip(1.5 - 4.0 * np.abs(phase - 0.5), 0.0, 1.0)
    rings = np.stack([radius * np.cos(turn), radius * np.sin(turn), height + 0 * turn], axis=-1)
    low, high = np.tile([0, 0, -0.5], (ROUND, 1)), np.tile([0, 0, 0.5], (ROUND, 1))
    ends = [low, rings[0], rings[-1], high]
    corners = [rings.reshape(-1, 3), *ends]
    count = rings.shape[0] * ROUND
    faces = [_quilt(len(rings)), count + _quilt(2), count + 2 * ROUND + _quilt(2)]
    return np.concatenate(corners), np.concatenate(faces)
