"""A pose in a task file: where a frame of a link is, and how it is turned."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.description.values import Angle, Direction, TableForm, Vector, key
from sevenbar.design.task.values import Matrix
from sevenbar.errors import RequestError
from sevenbar.kinematics.loop.rigid import pose, turns_about, unit


class PoseForm(TableForm):
    """A pose of a link: the place of its frame's origin, and how the frame is turned."""

    at: Annotated[Vector, key("the place of the origin of the link's frame", "length")]
    axis: Annotated[Direction, key("about which the frame is turned")] = (0.0, 0.0, 1.0)
    angle: Annotated[Angle, key("by which it is turned about the axis", "degrees")] = 0.0
    matrix: Annotated[Matrix | None, key("the rotation, row by row; in place of axis and angle")] = None

    def pose(self, place: str) -> Floats:
        """The pose (4, 4); `place` is the key of the table."""
        if self.matrix is None:
            return pose(turns_about(unit(self.axis), np.array([self.angle]))[0], self.at)
        if {"axis", "angle"} & self.model_fields_set:
            raise RequestError(f"{place}: a matrix, and axis or angle; give one of the two")
        from scipy.spatial.transform import Rotation

        # to all digits what was written with some
        return pose(Rotation.from_matrix(np.array(self.matrix)).as_matrix(), self.at)
