"""Why a loop is rigid: joints that are off the plane or the point of the others, or two on one axis."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import combinations
from typing import Literal

from sevenbar._core import AGREE
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.kinematics.loop.rigid import inverse

#: What the others have in common: a plane in which they move, a point through which their axes go; or two
#: joints turn about one axis, so that the link between them has no length.
Common = Literal["plane", "point", "one-axis"]

#: What of a joint is off.
What = Literal["axis", "slide"]


@dataclass(frozen=True)
class OffJoint:
    """A joint that does not fit the others.

    `by` is how far: of an "axis" the angle [rad] to the normal of the plane, or the distance [length] from
    the point; of a "slide" the angle [rad] to the plane.
    """

    joint: str
    what: What
    by: float


@dataclass(frozen=True)
class Reason:
    """What keeps a loop from moving, or leaves a link of it without length.

    `joints` have in `common` a plane, a point or one axis. `off` are the joints that do not fit, and
    `motion_type` is how the loop would move if they did; `None` where nothing says how they would fit.
    """

    common: Common
    joints: tuple[str, ...]
    off: tuple[OffJoint, ...] = ()
    motion_type: str | None = None


def no_length(loop: Loop) -> Reason | None:
    """The first two joints of a link that turn about one axis and are all that it has, where there are any.

    A link of a net with more joints may have two in one pin.
    """
    for link in loop.graph.links:
        rods = sum(link in rod.between for rod in loop.rods)
        if len(loop.graph.joints_of(link)) + rods > 2:
            continue
        for one, other in combinations(loop.graph.joints_of(link), 2):
            way = inverse(loop.joint_on(one, link)) @ loop.joint_on(other, link)
            same = math.hypot(*way[:2, 2]) <= AGREE and math.hypot(*way[:2, 3]) <= AGREE * loop.size
            first, second = loop.joints[one], loop.joints[other]
            if first.kind == second.kind == "R" and same:
                return Reason("one-axis", (first.name, second.name))
    return None
