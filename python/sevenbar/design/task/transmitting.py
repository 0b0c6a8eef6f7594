"""The least transmission angle of a task's loop, as a slack at the poses that are used, with exact slopes."""

from __future__ import annotations

import math

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.design.limits import MARGIN, Limits
from sevenbar.design.task.loop import Here, Slacks, TaskLoop
from sevenbar.design.task.rssr_measures import RssrMeasures
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.transmission.angle import coupling_of
from sevenbar.kinematics.transmission.slopes import AxisPoints


class AngleSlack:
    """sin^2 of the transmission angle less that of its limit; must not be negative."""

    def __init__(self, loop: TaskLoop, limits: Limits) -> None:
        made = AxisPoints.of(loop.numbers, loop.input, loop.output)
        assert made is not None, "checked with the task"
        self._made, self._places = made, loop.marked(made.points)
        self._least = math.sin(limits.transmission_lowest + MARGIN) ** 2

    def __call__(self, here: Here) -> Slacks:
        """The slacks (n, 1) at poses, with their slopes."""
        sine, _, by, _ = self._made.angle(here.points[:, self._places], here.points_by[:, self._places])
        return (sine**2 - self._least)[:, None], (2 * sine[:, None] * by)[:, None]


class LeastAngle:
    """The measure transmission_lowest of an RSSR, four-bar or slider-crank whose input turns, in closed form.

    Where the input does not turn it is below zero, and rises towards linkages in which it does.
    """

    def __init__(self, loop: TaskLoop) -> None:
        self._loop = loop
        self._made = AxisPoints.of(loop.numbers, loop.input, loop.output)
        self._rssr = RssrMeasures(loop)
        in_line = self._made is not None and self._made.in_line
        #: Whether the loop has it.
        self.known = self._rssr.known or in_line
        self._places = loop.marked(self._made.points) if in_line and self._made else []

    def at(self, values: Floats, anchor: Floats, *, slopes: bool) -> tuple[Floats, Floats] | None:
        """Its value (1,) [deg] and slopes (1, k), by a pose at the anchor's input; `None` without either."""
        ends = self.ends(values, anchor, slopes=slopes)
        if ends is None:
            return None
        value, by = min(ends, key=lambda end: end[0])
        return np.array([value]), by[None]

    def ends(self, values: Floats, anchor: Floats, *, slopes: bool) -> list[tuple[float, Floats]] | None:
        """The angles [deg] where the input is in line with the ground, of an RSSR the least; slopes (k,)."""
        if self._rssr.known:
            return self._rssr.ends(values)
        if self._made is None or not self.known:
            return None
        loop = self._loop
        q = loop.near(values, anchor)
        if q is None:
            return None
        here = loop.here(values, q, slopes=slopes)
        result = self._made.turning(here.points[:, self._places], here.points_by[:, self._places, :, :-1])
        if result is None or not all(np.isfinite(part).all() for part in result):
            return None
        none = np.zeros(len(values))
        return [(math.degrees(x), np.degrees(by) if slopes else none) for x, by in zip(*result, strict=True)]


def transmission_flaw(linkage: Linkage, limits: Limits) -> str:
    """Why a loop cannot be held to a least transmission angle; empty where it can."""
    if limits.transmission_lowest == 0.0:
        return ""
    drive = linkage.drive
    first, second = (linkage.columns.index(name) for name in (drive.joint, drive.output))
    coupling = coupling_of(linkage, first, second)
    if coupling is None:
        return (
            f"no transmission angle is defined from {drive.joint} to {drive.output}; leave the limit out, "
            "and bound velocity_highest, or peak_torque under a load, in a [[must]] with kind = 'figure'"
        )
    if any(joint.row.is_screw for joint in linkage.joints):
        return "of a loop with a screw it is held by a [[must]] with kind = 'figure', transmission_lowest"
    return ""
