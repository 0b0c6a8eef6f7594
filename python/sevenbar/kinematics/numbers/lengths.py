"""Lengths of links of a drawing as dimensions: by how much a link is longer than it is drawn.

A drawing gives places and axes, and lengths follow from them. A link that is `longer` by c reaches farther by
it, in its drawn direction u, while every joint counts from the pose that is drawn:

    G = B^-1 T(c u) A                                                                                     (1)

B is the frame behind the joint before the link, A that before the joint after it; u is square to the axis of
the joint before the link, or of the joint after it where that one is a ball; between two balls it is their
line, whose turn by their coordinates is left out of the derivatives of c u. So places and axes at the ground
stay, as do the other lengths, the zeros of joints, and what links carry, from the joint before each; at zero
the loop closes no longer.

The page is "Longer links" of the linkage files.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.kinematics.loop.joints import KINDS
from sevenbar.kinematics.loop.rigid import cross, perpendicular, unit

#: The links of an RSSR, as its report names them.
RSSR_LINKS = ("crank", "coupler", "rocker")

#: The key by which a joint of a drawing says that the link after it is longer than drawn.
LONGER = "longer"


def link_names(loop: Loop) -> tuple[str, ...]:
    """The names of the moving links: by what they do, where a report calls them so.

    >>> import sevenbar as sb
    >>> link_names(sb.load("planar_4r")), link_names(sb.load("seven_r"))[:2]
    (('input link', 'coupler', 'output link'), ('link 1', 'link 2'))
    """
    if loop.kind == "RSSR":
        return RSSR_LINKS
    from sevenbar.kinematics.loop.grashof import link_roles

    names = [joint.name for joint in loop.joints]
    if len(loop.columns) == len(names) == 4:
        return tuple(link_roles(names, loop.drive.joint, loop.drive.output)[:3])
    return tuple(f"link {i}" for i in loop.graph.moving)


def axis_at(kinds: Sequence[str], link: int) -> tuple[int, int] | None:
    """The joint whose axis a link (counted from 0) is square to, and which axis; `None` between balls."""
    for joint, which in ((link, -1), (link + 1, 0)):
        keys = KINDS[kinds[joint]].drawn_keys
        if "axes" in keys:
            return joint, which
        if "axis" in keys:
            return joint, 0
    return None


def drawn_length(joints: Sequence[Mapping[str, Any]], link: int) -> float:
    """How long a link, counted from 0, is drawn."""
    line = _line(joints, link)
    result = axis_at([joint["kind"] for joint in joints], link)
    if result is None:
        return math.hypot(*line)
    return math.hypot(*cross(unit(_axis(joints, *result)), line))


def reached(joints: Sequence[Mapping[str, Any]], link: int) -> tuple[float, float, float]:
    """The place of the joint after a link, counted from 0, as a link has it that is longer than drawn."""
    drawn = np.array(joints[link + 1]["at"], dtype=np.float64)
    longer = float(joints[link].get(LONGER, 0.0))
    if not longer:
        x, y, z = drawn.tolist()
        return x, y, z
    line, by = _line(joints, link), axis_at([joint["kind"] for joint in joints], link)
    if by is not None:
        axis = unit(_axis(joints, *by))
        line = line - (line @ axis) * axis
    x, y, z = (drawn + longer * unit(line)).tolist()
    return x, y, z


def across(joints: Sequence[Mapping[str, Any]]) -> dict[int, Floats]:
    """A direction (3,) square to each longer link between two balls, by the link, counted from 0."""
    kinds = [joint["kind"] for joint in joints]
    return {
        link: perpendicular(_line(joints, link))
        for link, joint in enumerate(joints[:-1])
        if LONGER in joint and axis_at(kinds, link) is None
    }


def _axis(joints: Sequence[Mapping[str, Any]], joint: int, which: int) -> Sequence[float]:
    """An axis of a joint as drawn."""
    table = joints[joint]
    result: Sequence[float] = table["axes"][which] if "axes" in table else table["axis"]
    return result


def _line(joints: Sequence[Mapping[str, Any]], link: int) -> Floats:
    """From the place of the joint before a link to that after it."""
    first, second = (np.array(joints[k]["at"], dtype=np.float64) for k in (link, link + 1))
    return np.asarray(second - first)
