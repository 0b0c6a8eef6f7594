"""The rows of a joint that closes a loop: places that meet, angles that stay.

    along    (x_a - x_b) . v_b = 0        a place does not go along v
    angle    u_a . v_b = cos(u, v)        two directions keep their angle
    length   |x_a - x_b|^2 = L^2          a rod                                                          (1)

From the steps of a joint's kind follow its rows: what does not turn keeps angles, what does not slide meets.

Source: docs/theory_nets.md, (4).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.kinematics.loop.geometry import BallRod, Joint
from sevenbar.kinematics.loop.joints import X, Y, Z

#: Three numbers.
Triple = tuple[float, float, float]


class ChordRow(NamedTuple):
    """A row: its kind, on which of the joint's links it is first and second, and its vectors."""

    kind: str
    sides: tuple[int, int]
    vectors: tuple[Triple, Triple]
    number: float = 0.0


def joint_rows(joint: Joint, before: Floats, after: Floats) -> list[ChordRow]:
    """The rows of a joint by its frames (4, 4) on the link before it and on that after it, as drawn."""
    steps = joint.row.steps
    turns = [step.axis for step in steps if step.freedom == "turn"]
    result: list[ChordRow] = []
    if joint.row.has_cross:
        u, v = before[:3, 2], after[:3, 2]
        result.append(ChordRow("angle", (0, 1), (three(u), three(v)), math.cos(joint.angle)))
    elif not turns:
        result += [_square(before, after, i, (i + 1) % 3) for i in (X, Y, Z)]
    elif len(turns) == 1:
        (axis,) = turns
        result += [_square(before, after, axis, (axis + k) % 3) for k in (1, 2)]
    place = three(after[:3, 3])
    # slides before a turn are on the link before, those after it on the link after
    sliding = [step.axis for step in steps if step.freedom == "slide"]
    ridden = bool(sliding) and steps[0].freedom == "slide" and bool(turns)
    frame, sides = (before, (1, 0)) if ridden else (after, (0, 1))
    result += [
        ChordRow("along", sides, (place, three(frame[:3, axis]))) for axis in (X, Y, Z) if axis not in sliding
    ]
    return result


def rod_row(rod: BallRod) -> ChordRow:
    """The row of a rod."""
    first, second = rod.at
    return ChordRow("length", (0, 1), (first, second), math.dist(first, second))


def _square(before: Floats, after: Floats, i: int, j: int) -> ChordRow:
    """Two axes that stay at right angles."""
    return ChordRow("angle", (0, 1), (three(before[:3, i]), three(after[:3, j])))


def three(vector: Floats) -> Triple:
    """A vector (3,) as the core takes it."""
    x, y, z = np.asarray(vector, dtype=float).tolist()
    return x, y, z
