"""Which loops are four-bars or slider-cranks: their links from the fixed transforms."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.kinematics.loop.grashof import (
    FourBar,
    four_bar_of_links,
    least,
    link_roles,
    slider_crank_of_links,
)
from sevenbar.kinematics.loop.rigid import cross, inverse
from sevenbar.kinematics.solvers.general import Expanded, expanded
from sevenbar.kinematics.solvers.plane_and_sphere import SAME, in_plane, sphere_of

_Z = np.array([0.0, 0.0, 1.0])


def four_bar_of(loop: Loop, input: str, output: str) -> FourBar | None:
    """The four-bar or slider-crank that a loop is, driven by a column and read at another; `None` for others.

    A loop is one where four of its joints move in its plane, all turning or one sliding, or where it has four
    axes through one point. With two of them on one axis, so that the link between has no length, it is none.
    Links are called by what they do where input and output are at the ground, else by numbers.

        >>> import sevenbar as sb
        >>> found = four_bar_of(sb.load("planar_4r"), "theta_1", "theta_4")
        >>> found.links
        {'input link': 40.0, 'coupler': 100.0, 'output link': 80.0, 'ground': 90.0}
        >>> found.excess, found.grashof, found.turning
        (-30.0, 'crank-rocker', ('theta_1', 'theta_2'))

    Source: docs/theory_measures.md, (1) to (3).
    """
    parts = expanded(loop)
    columns = [loop.columns[c] for c in parts.columns]
    result = in_plane(loop)
    if result is None:
        if parts.letters != "RRRR" or sphere_of(loop) is None:
            return None
        moves: tuple[int, ...] = (0, 1, 2, 3)
    elif result.held is not None and loop.in_rows:
        # where it is held is not known before the loop is closed
        return None
    else:
        moves = result.moves
    letters = "".join(parts.letters[i] for i in moves).replace("S", "R")
    names = [columns[i] for i in moves]
    if len(moves) != 4 or letters.count("P") > 1 or set(letters) - {"R", "P"}:
        return None
    between = _between(parts.around, moves)
    roles = link_roles(names, input, output)
    if result is None:
        arcs = [math.atan2(math.hypot(*cross(m[:3, 2], _Z)), float(m[2, 2])) for m in between]
        return None if min(arcs) <= SAME else four_bar_of_links("spherical", least(arcs), names, roles)
    normals = _normals(parts, moves, result.plane.normal)
    lengths = [math.hypot(*cross(n, m[:3, 3])) for n, m in zip(normals, between, strict=True)]
    # two joints on one axis are one
    shortest = SAME * loop.size
    if "P" not in letters:
        return None if min(lengths) <= shortest else four_bar_of_links("planar", lengths, names, roles)
    slide = letters.index("P")
    a, b, c = ((slide + k) % 4 for k in (1, 2, 3))
    if min(lengths[a], lengths[b]) <= shortest:
        return None
    # from the pin on the slider to that on the other side of the slide, in the frame of the slide
    to_slide = inverse(between[c])
    apart = between[slide][:3, 3] - to_slide[:3, 3]
    offset = abs(float(apart @ cross(normals[slide], _Z)))
    return slider_crank_of_links(
        lengths[a], lengths[b], offset, [names[k] for k in (a, b, c)], (roles[a], roles[b])
    )


def _normals(parts: Expanded, moves: Sequence[int], normal: Floats) -> list[Floats]:
    """The normal (3,) of the plane in the frame of each joint that moves: z of one that turns.

    Balls and slides may have any frame; all joints at zero, which changes nothing where all move in a plane.
    """
    frames = parts.frames
    return [_Z if parts.letters[i] == "R" else frames[i][:3, :3].T @ normal for i in moves]


def _between(ahead: Sequence[Floats], moves: Sequence[int]) -> list[Floats]:
    """The transforms (4, 4) from each joint that moves to the next one, all joints at zero."""
    result = []
    for k, start in enumerate(moves):
        end = moves[(k + 1) % len(moves)]
        now, i = ahead[start], (start + 1) % len(ahead)
        while i != end:
            now, i = now @ ahead[i], (i + 1) % len(ahead)
        result.append(now)
    return result
