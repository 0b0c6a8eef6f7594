"""What a design does along its wants, between stations too: poses, readings, places, rooms of musts."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sevenbar.arrays import Floats, short_way
from sevenbar.design.task.check import TaskDesign
from sevenbar.design.task.musts import pose_rooms, room_scale
from sevenbar.design.task.problem import TaskModel
from sevenbar.design.task.task import DesignTask, Want
from sevenbar.design.task.wants.at_inputs import LineWanted, ReadingsWanted, farthest
from sevenbar.design.task.wants.places import PlacesWanted
from sevenbar.design.task.wants.wanted import Wanted

#: Poses along a want, at least, and the longest step of an input from one to the next [rad].
DENSE, STEP = 240, math.radians(1.0)


@dataclass(frozen=True, eq=False)
class UsedWay:
    """Inputs (n,) along a want in the order they are passed, and the poses (n, columns) there."""

    inputs: Floats
    q: Floats


class DesignAlong:
    """A design of a task and what it does along each want."""

    def __init__(self, task: DesignTask, design: TaskDesign) -> None:
        self.task, self.design = task, design
        self.model = TaskModel(task)
        self.loop = self.model.loop
        self.values = design.solution.seed.values

    @property
    def wants(self) -> list[tuple[int, Want, Wanted]]:
        """The wants with poses along a way, each with its place among all."""
        return [(i, want, one) for (i, want), one in zip(self.task.sampled, self.model.wanted, strict=True)]

    @cached_property
    def ways(self) -> list[UsedWay]:
        """The used way of each want that has one."""
        solution = self.design.solution
        return [
            self._way(inputs, solution.poses_of(i), round=one.stations.round)
            for i, (inputs, one) in enumerate(zip(solution.inputs, self.model.wanted, strict=True))
        ]

    def _way(self, inputs: Floats, poses: Floats, *, round: bool) -> UsedWay:
        """From each station to the next in small steps, all at once."""
        first, last = inputs[:-1], inputs[1:]
        begin = poses[:-1]
        if round:
            gain = math.copysign(self.design.solution.seed.period, inputs[-1] - inputs[0])
            first, last, begin = inputs, np.append(last, inputs[0] + gain), poses
        if not len(first):
            return UsedWay(inputs, poses)
        longest = float(np.abs(last - first).max()) / float(self.loop.units[self.loop.input])
        steps = max(math.ceil(DENSE / len(first)), math.ceil(longest / STEP))
        found = [begin]
        for k in range(1, steps):
            found.append(self.loop.closed(self.values, first + (last - first) * k / steps, found[-1]))
        shares = np.arange(steps) / steps
        x = (first[:, None] + (last - first)[:, None] * shares).ravel()
        q = np.stack(found, axis=1).reshape(len(x), -1)
        if not round:
            x, q = np.append(x, inputs[-1]), np.concatenate([q, poses[-1:]])
        return UsedWay(x, q)

    def zeros(self, place: int) -> tuple[float, float]:
        """The input's and the output's values at the readings 0 of a function or a dwell [rad, or length].

        Angles in (-pi, pi].
        """
        linkage = self.loop.linkage
        zeros = self.readings(place).zeros(self.design.solution.seed.own[place])
        first, second = (
            float(short_way(zero)) if linkage.turns(column) else zero
            for zero, column in zip(zeros, (linkage.drive.joint, linkage.drive.output), strict=True)
        )
        return first, second

    def readings(self, place: int) -> ReadingsWanted:
        """A function or a dwell, by its place among the wants with a way."""
        one = self.model.wanted[place]
        assert isinstance(one, ReadingsWanted)
        return one

    def outputs(self, place: int) -> Floats:
        """The output's readings (n,) along a function or a dwell, near those wanted."""
        read = self.ways[place].q[:, self.loop.output] - self.zeros(place)[1]
        if not bool(self.loop.numbers.turns[self.loop.output]):
            return read
        read = np.unwrap(read)
        return np.asarray(read - math.tau * np.round((read[0] - self.readings(place).readings[0]) / math.tau))

    def places(self, place: int) -> Floats:
        """Where the points of a path or of poses, or the point of a straight line go (n, points, 3)."""
        one = self.model.wanted[place]
        return self._put(one, self.ways[place].q)

    def travel(self, place: int) -> float:
        """How far the point of a straight line goes along it [length]."""
        points = self.places(place)[:, 0]
        first, last = farthest(points)
        return float(np.linalg.norm(points[last] - points[first]))

    def stations(self, place: int) -> Floats:
        """Where these points are at the stations (n, points, 3)."""
        return self._put(self.model.wanted[place], self.design.solution.poses_of(place))

    def _put(self, one: Wanted, q: Floats) -> Floats:
        assert isinstance(one, PlacesWanted | LineWanted)
        found = self.loop.here(self.values, q).points[:, one.numbers]
        flat = found.reshape(-1, 3)
        if isinstance(one, PlacesWanted):
            flat = self.design.placing.put(flat)
        return flat.reshape(found.shape)

    def rooms(self) -> list[tuple[int, int, Floats, Floats]]:
        """The least room of each must about poses along each want: must, want, inputs (n,), rooms (n,).

        Rooms in the `room_unit` of the must.
        """
        found = []
        for number, way in enumerate(self.ways):
            here = self.loop.here(self.values, way.q)
            for place, room in pose_rooms(self.loop, self.task.musts):
                _, scale = room_scale(self.task.musts[place], self.loop)  # type: ignore[arg-type]
                found.append((place, number, way.inputs, scale * room(here)[0].min(axis=1)))
        return found

    def room_unit(self, place: int) -> str:
        """The unit of the room of a must about poses: "deg", or the length unit."""
        return room_scale(self.task.musts[place], self.loop)[0]  # type: ignore[arg-type]
