"""The must of a cone: a ball or a U joint bends no further from its seat."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.description.values import Angle, Direction, Text, key
from sevenbar.design.task.flaws import Flaws
from sevenbar.design.task.loop import Here, Slacks, TaskLoop
from sevenbar.design.task.task import DesignTask, MustForm, PoseMust, Want
from sevenbar.errors import RequestError
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.loop.stops import Cone, Three
from sevenbar.kinematics.paths.circuit_path import NotFollowedError
from sevenbar.kinematics.ranges.ball_angle import ball_angle, has_length, line_angles, rod
from sevenbar.kinematics.ranges.circuit_extents import chosen


class ConeMust(MustForm):
    """A ball or a U joint stays within a cone."""

    kind: Annotated[Literal["cone"], key("this must")]
    joint: Annotated[Text, key("a ball or a U joint")]
    angle: Annotated[Angle, key("the greatest angle between seat and stud", "degrees")]
    seat: Annotated[
        Direction | None, key("on the link before the joint, as its points are written; left out, its rod")
    ] = None
    stud: Annotated[
        Direction | None, key("on the link after the joint, as its points are written; left out, its rod")
    ] = None

    def must(self, linkage: Linkage, wants: Sequence[Want]) -> InCone:
        return InCone(self.joint, self.angle, self.seat, self.stud)


@dataclass(frozen=True)
class InCone(PoseMust):
    """The angle of a ball or a U joint from its seat stays below `angle` [rad] at all poses that are used.

    The angle is that between two directions: `seat` (3,), of the link before the joint, and `stud` (3,), of
    the link after it, each as points of that link are written. One that is `None` goes along the rod, from
    the joint to the link's other joint.
    """

    form = ConeMust
    fault = "cone"
    ease = "a wider cone, or another seat"

    joint: str
    angle: float
    seat: Three | None = None
    stud: Three | None = None

    def turns(self, linkage: Linkage) -> bool:
        return True

    def flaws(self, task: DesignTask) -> Flaws:
        try:
            chosen(task.draft.linkage, self.joint, Cone(self.angle, self.seat, self.stud))
        except RequestError as error:
            key, _, message = str(error).partition(": ")
            yield {"cone": "angle"}.get(key, key), message

    def start_flaws(self, loop: TaskLoop, circuits: Sequence[Circuit], q: Floats) -> Flaws:
        bend = ball_angle(loop.linkage, self.joint, self.seat, self.stud)
        bends = [bend.at(circuit.q)[np.isfinite(circuit.q[:, bend.own]).all(axis=1)] for circuit in circuits]
        result = np.concatenate([np.empty(0), *bends])
        if (
            None not in (self.seat, self.stud)
            or not result.size
            or not result.min() > math.pi / 2 > self.angle
        ):
            return
        key = "seat" if self.seat is None else "stud"
        least, most = np.degrees([result.min(), result.max()])
        hint = "the direction in which it is mounted"
        with suppress(NotFollowedError):
            cone = circuits[0].ball_cone(self.joint, seat=self.seat, stud=self.stud)
            middle = [round(x, 4) for x in cone.middle]
            hint = f"{cone.middle_of} = {middle}, the middle of its bends, or another"
        yield (
            key,
            f"left out, it goes along the rod, from which {self.joint} is {least:.4g} to {most:.4g} deg off "
            f"at the start; give {hint}",
        )

    def words(self, linkage: Linkage) -> str:
        return f"{self.joint} within a cone of {math.degrees(self.angle):g} deg"

    def slacks(self, loop: TaskLoop) -> Callable[[Here], Slacks]:
        place = [joint.name for joint in loop.linkage.joints].index(self.joint)
        before, after = loop.linkage.graph.between[place]
        ends = [*_line(loop, before, place, self.seat), *_line(loop, after, place, self.stud)]

        def slacks(here: Here) -> Slacks:
            angles, by = line_angles(here.points[:, ends], here.points_by[:, ends])
            return (self.angle - angles)[:, None], -np.nan_to_num(by)[:, None]

        return slacks


def _line(loop: TaskLoop, link: int, place: int, given: Three | None) -> tuple[int, int]:
    """The numbers of two places on a direction of a link, or on its rod, away from one of its joints."""
    linkage = loop.linkage
    if given is None and has_length(linkage, link):
        ends = loop.rod(link)
        return ends if linkage.graph.side(place, link) else ends[::-1]
    way = rod(linkage, link, place) if given is None else np.asarray(given)
    x, y, z = map(float, loop.size / np.linalg.norm(way) * way)
    return loop.place(link, (0.0, 0.0, 0.0)), loop.place(link, (x, y, z))
