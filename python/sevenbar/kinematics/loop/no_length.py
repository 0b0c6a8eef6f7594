"""Links without length: two joints of a link that turn about one axis."""

from __future__ import annotations

import math
from itertools import combinations
from typing import TYPE_CHECKING

from sevenbar._core import AGREE
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.kinematics.loop.rigid import inverse

if TYPE_CHECKING:
    from sevenbar.kinematics.loop.reason import Reason


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
                from sevenbar.kinematics.loop.reason import Reason

                return Reason("one-axis", (first.name, second.name))
    return None
