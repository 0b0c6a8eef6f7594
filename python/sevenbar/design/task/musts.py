"""What must hold at the poses that are used, as rooms: numbers not below zero, with exact slopes."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.design.candidates import Fault
from sevenbar.design.task.loop import Here, TaskLoop
from sevenbar.design.task.task import Apart, InBox, InCone, InRange, Must, PoseMust
from sevenbar.kinematics.loop.rods import distance_slopes
from sevenbar.kinematics.loop.stops import Three
from sevenbar.kinematics.ranges.ball_angle import has_length, line_angles, rod

#: Rooms (n, r) at n poses, and their slopes (n, r, unknowns).
Rooms = tuple[Floats, Floats]

#: What is at fault where a must about poses is missed.
FAULTS: Mapping[type, Fault] = {InRange: "range", InCone: "cone", InBox: "box", Apart: "distance"}


def pose_rooms(loop: TaskLoop, musts: Sequence[Must]) -> list[tuple[int, Callable[[Here], Rooms]]]:
    """What each must about poses leaves at them, with its place among the musts.

    Angles [rad], lengths relative to the size.
    """
    return [(i, _ROOMS[type(must)](loop, must)) for i, must in enumerate(musts) if type(must) in _ROOMS]


def room_scale(must: PoseMust, loop: TaskLoop) -> tuple[str, float]:
    """The unit in which people read the room of a must about poses, and what 1 of the room is there."""
    turns = isinstance(must, InCone) or (isinstance(must, InRange) and loop.linkage.turns(must.column))
    return ("deg", math.degrees(1.0)) if turns else (loop.linkage.length_unit, float(loop.size))


def _range(loop: TaskLoop, must: InRange) -> Callable[[Here], Rooms]:
    column = loop.linkage.columns.index(must.column)
    unit, turns = float(loop.units[column]), bool(loop.numbers.turns[column])
    middle = (must.low + must.high) / 2

    def rooms(here: Here) -> Rooms:
        value = here.q[:, column]
        if turns:
            # by whole turns to the range
            value = value - math.tau * np.round((value - middle) / math.tau)
        by = here.q_by[:, column]
        return (
            np.stack([value - must.low, must.high - value], axis=1) / unit,
            np.stack([by, -by], axis=1) / unit,
        )

    return rooms


def _cone(loop: TaskLoop, must: InCone) -> Callable[[Here], Rooms]:
    place = [joint.name for joint in loop.linkage.joints].index(must.joint)
    before, after = loop.linkage.graph.between[place]
    ends = [*_line(loop, before, place, must.seat), *_line(loop, after, place, must.stud)]

    def rooms(here: Here) -> Rooms:
        angles, by = line_angles(here.points[:, ends], here.points_by[:, ends])
        return (must.angle - angles)[:, None], -np.nan_to_num(by)[:, None]

    return rooms


def _line(loop: TaskLoop, link: int, place: int, given: Three | None) -> tuple[int, int]:
    """The numbers of two places on a direction of a link, or on its rod, away from one of its joints."""
    linkage = loop.linkage
    if given is None and has_length(linkage, link):
        ends = loop.rod(link)
        return ends if linkage.graph.side(place, link) else ends[::-1]
    way = rod(linkage, link, place) if given is None else np.asarray(given)
    x, y, z = map(float, loop.size / np.linalg.norm(way) * way)
    return loop.place(link, (0.0, 0.0, 0.0)), loop.place(link, (x, y, z))


def places_in(loop: TaskLoop, must: InBox) -> list[int]:
    """The numbers of the points and joints that stay in a box."""
    points = [point.name for point in loop.linkage.points]
    return [loop.named(name) if name in points else loop.joint(name) for name in must.names]


def _box(loop: TaskLoop, must: InBox) -> Callable[[Here], Rooms]:
    numbers = places_in(loop, must)
    low, high = np.array(must.low), np.array(must.high)

    def rooms(here: Here) -> Rooms:
        places, by = here.points[:, numbers], here.points_by[:, numbers]
        values = np.concatenate([places - low, high - places], axis=1) / loop.size
        slopes = np.concatenate([by, -by], axis=1) / loop.size
        rooms = values.reshape(len(values), -1)
        return rooms, slopes.reshape(*rooms.shape, by.shape[-1])

    return rooms


def _apart(loop: TaskLoop, must: Apart) -> Callable[[Here], Rooms]:
    ends = [end for link in must.links for end in loop.rod(link)]

    def rooms(here: Here) -> Rooms:
        apart, by = distance_slopes(here.points[:, ends], here.points_by[:, ends])
        return (apart - must.least)[:, None] / loop.size, by[:, None] / loop.size

    return rooms


_ROOMS: Mapping[type, Callable[[TaskLoop, Any], Callable[[Here], Rooms]]] = {
    InRange: _range,
    InCone: _cone,
    InBox: _box,
    Apart: _apart,
}
