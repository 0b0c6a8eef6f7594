"""The loop as a value: joints, fixed transforms, points, drive, and the names of its columns."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats
from sevenbar.errors import RequestError, no_joint
from sevenbar.kinematics.joints import FREEDOMS, Freedom, column_names
from sevenbar.kinematics.rigid import inverse
from sevenbar.text.printing import Printed


@dataclass(frozen=True)
class Joint:
    """A joint: its kind (R P H C U S) and its name.

    `pitch` [length per turn, right-handed] of H; `angle` [rad] between the two axes of U.
    """

    kind: str
    name: str
    pitch: float = 0.0
    angle: float = 0.0

    @property
    def columns(self) -> tuple[str, ...]:
        """One name for each of its freedoms."""
        return column_names(self.name, FREEDOMS[self.kind])


@dataclass(frozen=True)
class Point:
    """A named point: the link that carries it, counted from 1, and where on it [length]."""

    name: str
    link: int
    at: tuple[float, float, float]


@dataclass(frozen=True)
class Drive:
    """The columns of the input and the output, and the input's speed [rad/s, or length/s]."""

    joint: str
    output: str
    speed: float = 1.0


@dataclass(frozen=True, eq=False, repr=False)
class Loop(Printed):
    """A closed loop `base Z(q1) G1 Z(q2) G2 .. Z(qn) = ground`.

    `base` (4, 4) is the frame of joint 1 and `ground` (4, 4) that of the ground's side of the last joint,
    both in the report frame. `links` (n - 1, 4, 4) are the G's of the moving links, from each joint's frame
    to the next one's. `point_frames` (n, 4, 4) take a point as it is written to its link's own frame.
    `dimensions` are the named numbers of the form it was written in, `description` that form itself: the
    tables and keys of a file, from which a linkage with other numbers is made.

    Source: docs/theory.md, (1).
    """

    name: str
    joints: tuple[Joint, ...]
    base: Floats
    ground: Floats
    links: Floats
    point_frames: Floats
    drive: Drive
    length_unit: str = "mm"
    points: tuple[Point, ...] = ()
    dimensions: Mapping[str, float] = field(default_factory=dict)
    description: Mapping[str, Any] = field(default_factory=dict, repr=False)

    def __post_init__(self) -> None:
        for array in (self.base, self.ground, self.links, self.point_frames):
            array.setflags(write=False)

    def __reduce__(self) -> tuple[type[Loop], tuple[Any, ...]]:
        """Copied and pickled by its fields; what was worked out of them is worked out anew when asked for."""
        return type(self), tuple(getattr(self, field.name) for field in fields(self))

    @property
    def transforms(self) -> Floats:
        """The G's of all links (n, 4, 4), the ground's last: `Z(q1) G1 .. Z(qn) Gn = 1`."""
        return np.concatenate([self.links, [inverse(self.ground) @ self.base]])

    @cached_property
    def kind(self) -> str:
        """The joints' letters in loop order."""
        return "".join(joint.kind for joint in self.joints)

    @cached_property
    def columns(self) -> tuple[str, ...]:
        """The names of the one-freedom joints, in loop order."""
        return tuple(column for joint in self.joints for column in joint.columns)

    @cached_property
    def column_kinds(self) -> tuple[Freedom, ...]:
        """What each column is: an angle [rad] or a length."""
        return tuple(freedom for joint in self.joints for freedom in FREEDOMS[joint.kind])

    def drivable(self, without: int | None = None) -> list[str]:
        """The columns that may drive or be driven: all but those of balls, and but one."""
        owners = [joint for joint in self.joints for _ in joint.columns]
        return [
            name
            for index, (name, owner) in enumerate(zip(self.columns, owners, strict=True))
            if owner.kind != "S" and index != without
        ]

    def column(self, name: str, key: str) -> int:
        """The place of a column named by the caller; a C or U joint's name stands for its first freedom."""
        known = [joint.name for joint in self.joints]
        for joint in self.joints:
            if joint.kind == "S" and name in (joint.name, *joint.columns):
                raise RequestError(
                    f"{key}: joint '{name}' is a ball; "
                    f"give a joint with one freedom: {', '.join(self.drivable())}"
                )
            if name == joint.name:
                return self.columns.index(joint.columns[0])
        if name not in self.columns:
            raise RequestError(f"{key}: {no_joint(name, known)}")
        return self.columns.index(name)

    def other_column(self, column: int) -> int:
        """The output where only the input was named: the drive's, else that of the last other joint."""
        if self.columns[column] != self.drive.output:
            return self.columns.index(self.drive.output)
        last = [
            joint for joint in self.joints if joint.kind != "S" and self.columns[column] not in joint.columns
        ]
        name = last[-1].columns[0] if last else self.drivable(column)[-1]
        return self.columns.index(name)

    def speed_of(self, column: int) -> float:
        """The speed [rad/s, or length/s] at which a column drives where none is given: the drive's, or 1."""
        drives = self.columns.index(self.drive.joint)
        return self.drive.speed if self.column_kinds[drives] == self.column_kinds[column] else 1.0


def following_coupler(
    m: npt.ArrayLike, n: npt.ArrayLike, crank: npt.ArrayLike, rocker: npt.ArrayLike
) -> Floats:
    """L2 [length] of an RSSR that leaves it out, numbers or arrays: `L2^2 = (L1 - M)^2 + L3^2 + N^2`.

    Source: Sun and Zhou, eq. (7).
    """
    return np.hypot(np.hypot(np.subtract(crank, m), rocker), n)
