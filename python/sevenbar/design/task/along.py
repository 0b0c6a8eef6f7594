"""What a design does along its wants, between stations too: poses, readings, places, slacks of musts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.design.task.check import TaskDesign
from sevenbar.design.task.problem import TaskModel, pose_slacks
from sevenbar.design.task.task import DesignTask, PoseMust
from sevenbar.design.task.wanted import PlacesCurve, ReadingsCurve, Used, WantFact

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
        result = [begin]
        for k in range(1, steps):
            result.append(self.loop.closed(self.values, first + (last - first) * k / steps, result[-1]))
        shares = np.arange(steps) / steps
        x = (first[:, None] + (last - first)[:, None] * shares).ravel()
        q = np.stack(result, axis=1).reshape(len(x), -1)
        if not round:
            x, q = np.append(x, inputs[-1]), np.concatenate([q, poses[-1:]])
        return UsedWay(x, q)

    def _used(self, number: int) -> Used:
        """What the design does along a want, by its place among those with a way."""
        solution, way = self.design.solution, self.ways[number]
        own, stations = solution.seed.own[number], solution.poses_of(number)
        return Used(self.loop, self.values, own, self.design.placing, way.inputs, way.q, stations)

    def facts(self, number: int) -> Sequence[WantFact]:
        """What reports say of it besides its errors."""
        return self.model.wanted[number].facts(self._used(number))

    def curve(self, number: int) -> ReadingsCurve | PlacesCurve:
        """What figures show of it."""
        return self.model.wanted[number].curve(self._used(number))

    def slacks(self) -> list[tuple[int, int, Floats, Floats]]:
        """The least slack of each must about poses along each want: must, want, inputs (n,), slacks (n,).

        Slacks in the `slack_unit` of the must.
        """
        result = []
        for number, way in enumerate(self.ways):
            here = self.loop.here(self.values, way.q)
            for place, slack in pose_slacks(self.loop, self.task.musts):
                _, scale = self._unit(place)
                result.append((place, number, way.inputs, scale * slack(here)[0].min(axis=1)))
        return result

    def _unit(self, place: int) -> tuple[str, float]:
        must = self.task.musts[place]
        assert isinstance(must, PoseMust)
        return must.slack_unit(self.loop)

    def slack_unit(self, place: int) -> str:
        """The unit of the slack of a must about poses: "deg", or the length unit."""
        return self._unit(place)[0]
