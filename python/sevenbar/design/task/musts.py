"""What must hold at the poses that are used, as rooms: numbers not below zero, with exact slopes."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.design.candidates import Fault
from sevenbar.design.task.loop import Here, TaskLoop
from sevenbar.design.task.task import Apart, InBox, InCone, InRange, Must
from sevenbar.kinematics.rods import nearest_shares

#: Rooms (n, r) at n poses, and their slopes (n, r, unknowns).
Rooms = tuple[Floats, Floats]

#: What is at fault where a must about poses is missed.
FAULTS: Mapping[type, Fault] = {InRange: "range", InCone: "cone", InBox: "box", Apart: "distance"}

#: Below this sine an angle has a kink; its slopes there are none.
TIP = 1e-12


def pose_rooms(loop: TaskLoop, musts: Sequence[Must]) -> list[tuple[int, Callable[[Here], Rooms]]]:
    """What each must about poses leaves at them, with its place among the musts.

    Angles [rad], lengths relative to the size.
    """
    found: list[tuple[int, Callable[[Here], Rooms]]] = []
    for place, must in enumerate(musts):
        if isinstance(must, InRange):
            found.append((place, _range(loop, must)))
        elif isinstance(must, InCone):
            found.append((place, _cone(loop, must)))
        elif isinstance(must, InBox):
            found.append((place, _box(loop, must)))
        elif isinstance(must, Apart):
            found.append((place, _apart(loop, must)))
    return found


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
    count = len(loop.linkage.joints)
    place = [joint.name for joint in loop.linkage.joints].index(must.joint)
    zero = (0.0, 0.0, 0.0)
    before, after = place or count, place + 1
    # both rods go from this joint to the other joint of the link
    if must.seat is None:
        seat = (loop.joint(place, ahead=False), loop.joint((place - 1) % count, ahead=True))
    else:
        seat = (loop.place(before, zero), loop.place(before, must.seat))
    if must.stud is None:
        stud = (loop.joint(place, ahead=True), loop.joint((place + 1) % count, ahead=False))
    else:
        stud = (loop.place(after, zero), loop.place(after, must.stud))

    def rooms(here: Here) -> Rooms:
        (u, u_by), (v, v_by) = (_way(here, ends) for ends in (seat, stud))
        cross = np.cross(u, v)
        sine, cosine = np.linalg.norm(cross, axis=1), (u * v).sum(axis=1)
        # d angle = (cos . d|u x v| - |u x v| d(u . v)) for unit vectors
        with np.errstate(divide="ignore", invalid="ignore"):
            axis = np.where(sine[:, None] > TIP, cross / sine[:, None], 0.0)
        by_u, by_v = np.cross(v, axis), np.cross(axis, u)
        by = np.einsum("ni,nik->nk", by_u, u_by) + np.einsum("ni,nik->nk", by_v, v_by)
        # the part of both along the two directions adds nothing to the sine at unit length
        slopes = cosine[:, None] * by - sine[:, None] * (
            np.einsum("ni,nik->nk", v, u_by) + np.einsum("ni,nik->nk", u, v_by)
        )
        return (must.angle - np.arctan2(sine, cosine))[:, None], -slopes[:, None]

    return rooms


def _way(here: Here, ends: tuple[int, int]) -> tuple[Floats, Floats]:
    """The direction (n, 3) from one point to another, of length 1, and its slopes (n, 3, unknowns)."""
    way = here.points[:, ends[1]] - here.points[:, ends[0]]
    by = here.points_by[:, ends[1]] - here.points_by[:, ends[0]]
    size = np.linalg.norm(way, axis=1)[:, None]
    way = way / size
    by = (by - way[:, :, None] * np.einsum("ni,nik->nk", way, by)[:, None]) / size[:, :, None]
    return way, by


def _box(loop: TaskLoop, must: InBox) -> Callable[[Here], Rooms]:
    joints = [joint.name for joint in loop.linkage.joints]
    points = [point.name for point in loop.linkage.points]
    numbers = [
        loop.named(name) if name in points else loop.joint(joints.index(name), ahead=True)
        for name in must.names
    ]
    low, high = np.array(must.low), np.array(must.high)

    def rooms(here: Here) -> Rooms:
        places, by = here.points[:, numbers], here.points_by[:, numbers]
        values = np.concatenate([places - low, high - places], axis=1) / loop.size
        slopes = np.concatenate([by, -by], axis=1) / loop.size
        return values.reshape(len(values), -1), slopes.reshape(len(values), -1, by.shape[-1])

    return rooms


def _apart(loop: TaskLoop, must: Apart) -> Callable[[Here], Rooms]:
    count = len(loop.linkage.joints)
    rods = [(loop.joint(k - 1, ahead=True), loop.joint(k % count, ahead=False)) for k in must.links]

    def rooms(here: Here) -> Rooms:
        (a, b), (c, d) = ((here.points[:, i], here.points[:, j]) for i, j in rods)
        s, t = nearest_shares(a, b, c, d)
        shares = ((rods[0][0], 1 - s), (rods[0][1], s), (rods[1][0], t - 1), (rods[1][1], -t))
        way = sum(share[:, None] * here.points[:, i] for i, share in shares)
        by = sum(share[:, None, None] * here.points_by[:, i] for i, share in shares)
        size = np.linalg.norm(way, axis=1)
        # an extreme over the shares follows the places alone
        slopes = np.einsum("ni,nik->nk", way, by) / np.maximum(size, TIP)[:, None]
        return (size - must.least)[:, None] / loop.size, slopes[:, None] / loop.size

    return rooms
