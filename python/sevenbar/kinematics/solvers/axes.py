"""The axes of the joints along a circuit, in the report frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.poses import frames_along, joint_frames
from sevenbar.kinematics.loop.geometry import Loop, moved_by
from sevenbar.kinematics.solvers.general import Expanded, expanded


@dataclass(frozen=True, eq=False)
class Axes:
    """The joints of one freedom, screws and balls of a loop, as `parts` has them, with their axes on n rows.

    `directions` and `places` (parts, n, 3); a ball has no direction that means anything.
    """

    parts: Expanded
    directions: Floats
    places: Floats

    def velocity(self, part: int, at: Floats) -> Floats:
        """How places (n, 3) move with one of the joints, for each radian or length unit of it, (n, 3)."""
        direction: Floats = self.directions[part]
        if self.parts.letters[part] == "P":
            return direction
        turned = np.cross(direction, at - self.places[part])
        return np.asarray(turned + self.parts.advances[part] * direction)


def axes_along(loop: Loop, circuit: Circuit) -> Axes:
    """The axes of the joints on all rows of a circuit; NaN where it has no pose."""
    frames = frames_along(loop, circuit, np.arange(len(circuit.time)))
    before, _ = joint_frames(loop, frames)
    directions, places = [], []
    for i, (joint, own) in enumerate(zip(loop.joints, loop.places, strict=True)):
        now = before[:, i]
        steps = joint.steps(circuit.q[:, own])
        for step, values in steps[:1] if joint.row.is_screw or joint.row.is_ball else steps:
            now = now @ joint.before(step)
            directions.append(now[:, :3, step.axis])
            places.append(now[:, :3, 3])
            now = now @ moved_by(step, values)
    return Axes(expanded(loop), np.stack(directions), np.stack(places))
