"""Loops of screws whose freedoms follow from the subgroups that these span, and whether an input moves them.

Screws of one pitch about parallel axes, and slides across, move as a planar linkage of turns does, each link
rising by what it turns: so three and a slide are a slider-crank, four a four-bar, and two such sets in two
directions leave the straight line of Sarrus.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

import sevenbar as sb
from evidence.fuzz.checks import hold
from sevenbar.errors import RequestError

Joints = list[dict[str, Any]]

#: Draws joints whose places, and mostly pitches, have so many digits.
Draw = Callable[[np.random.Generator, int], Joints]

Z = [0, 0, 1]


def screw(at: Any, axis: Any = Z, pitch: float = 0.4) -> dict[str, Any]:
    """The table of a screw."""
    return {"kind": "H", "at": [float(x) for x in at], "axis": axis, "pitch": float(pitch)}


def slide(at: Any, axis: Any) -> dict[str, Any]:
    """The table of a slide."""
    return {"kind": "P", "at": [float(x) for x in at], "axis": axis}


def slider_crank(random: np.random.Generator, places: int) -> Joints:
    """Three screws of one pitch, and a slide across."""
    pitch = random.uniform(0.1, 1.5)
    points = np.round(random.uniform(-2, 2, (3, 2)), places)
    angle = random.uniform(0, math.tau)
    screws = [screw([*p, 0], pitch=pitch) for p in points]
    return [*screws, slide([*points[2], 0], [math.cos(angle), math.sin(angle), 0])]


def four_bar(random: np.random.Generator, places: int) -> Joints:
    """Four screws of one pitch."""
    pitch = random.uniform(-1.5, -0.1)
    return [screw(p, pitch=pitch) for p in np.round(random.uniform(-2, 2, (4, 3)), places)]


def sarrus(random: np.random.Generator, places: int) -> Joints:
    """Three screws of one pitch, and three in another direction."""
    pitch = round(random.uniform(0.1, 1.5), places)
    points = np.round(random.uniform(-2, 2, (6, 3)), places)
    axes = [Z] * 3 + [[1, 0, 0]] * 3
    return [screw(p, axis, pitch) for p, axis in zip(points, axes, strict=True)]


def jack(random: np.random.Generator, places: int) -> Joints:
    """A nut on a screwed spindle, kept from turning by a slide."""
    pitch = round(random.uniform(0.1, 1.5), places)
    return [
        {"kind": "R", "at": [0, 0, 0], "axis": Z},
        screw([0, 0, 1], pitch=pitch),
        slide(np.round(random.uniform(-2, 2, 3), places), Z),
    ]


def unlike_pitches(random: np.random.Generator, places: int) -> Joints:
    """Four screws of unlike pitches: three conditions of the plane and that of height leave nothing."""
    pitches = random.uniform(0.1, 1, 4)
    points = np.round(random.uniform(-2, 2, (4, 2)), places)
    return [screw([*p, 0], pitch=h) for p, h in zip(points, pitches, strict=True)]


#: The freedoms of each.
FAMILIES: dict[Draw, int] = {slider_crank: 1, four_bar: 1, sarrus: 1, jack: 1, unlike_pitches: 0}


def moves(linkage: sb.Linkage, column: str) -> bool:
    """Whether a motion is found with this input; one that stands still in it is a motion."""
    try:
        return bool(linkage.motion(24, input=column).circuits)
    except RequestError as refused:
        hold("stands still" in str(refused), str(refused))
        return True
