"""The unit meshes that the solids are stretched from, each round the z axis and centred on the origin."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache

import numpy as np

from sevenbar.arrays import Floats, Integers

#: Corners (v, 3) and triangles (f, 3), counter-clockwise seen from outside.
Mesh = tuple[Floats, Integers]

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
            return _lathe(_rod(1.0))
        case "cone":
            return _lathe([[(0, -0.5), (1, -0.5)], [(1, -0.5), (0, 0.5)]])
        case "ball":
            return _lathe([_arc(1.0, -math.pi / 2, math.pi / 2)])
        case "socket":
            mouth = math.pi / 2 - MOUTH
            outer, inner = _arc(1.0, -math.pi / 2, mouth), _arc(1.0 - WALL, mouth, -math.pi / 2)
            return _lathe([outer, [outer[-1], inner[0]], inner])
        case "box":
            return _faceted(_lathe(_rod(math.sqrt(0.5)), sides=4, start=math.pi / 4))
        case "hexagon":
            return _faceted(_lathe(_rod(1.0), sides=6))
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


def _rod(radius: float, rings: int = 2) -> list[list[tuple[float, float]]]:
    """The outline of a rod: bottom, side, top."""
    side = [(radius, float(height)) for height in np.linspace(-0.5, 0.5, rings)]
    return [[(0, -0.5), side[0]], side, [side[-1], (0, 0.5)]]


def _lathe(runs: Sequence[Sequence[tuple[float, float]]], sides: int = ROUND, start: float = 0.0) -> Mesh:
    """What runs of (radius, height) sweep about z, the solid to their left; creased between runs."""
    turn = start + np.linspace(0, math.tau, sides, endpoint=False)
    radius, height = np.concatenate(runs).T[:, :, None]
    corners = np.stack([radius * np.cos(turn), radius * np.sin(turn), height + 0 * turn], axis=-1)
    # the lower ring of each band, not across the creases
    lasts = np.cumsum([len(run) for run in runs]) - 1
    low = sides * np.delete(np.arange(len(radius)), lasts)[:, None]
    here, following = np.arange(sides), np.roll(np.arange(sides), -1)
    a, b, c, d = low + here, low + following, low + sides + following, low + sides + here
    return corners.reshape(-1, 3), np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)


def _faceted(mesh: Mesh) -> Mesh:
    """A mesh with sharp edges: each triangle has corners of its own."""
    corners, faces = mesh
    return corners[faces].reshape(-1, 3), np.arange(faces.size).reshape(-1, 3)


def _thread(hand: float) -> Mesh:
    """A rod with a thread; right-handed for `hand` 1, left-handed for -1."""
    corners, faces = _lathe(_rod(1.0, 8 * TURNS + 1))
    x, y, height = corners.T
    phase = (height * TURNS - hand * np.arctan2(y, x) / math.tau) % 1.0
    radius = 1.0 - DEPTH * np.clip(1.5 - 4.0 * np.abs(phase - 0.5), 0.0, 1.0)
    return np.column_stack([radius * x, radius * y, height]), faces
