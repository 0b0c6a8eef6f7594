"""Why a rigid loop is rigid: which joints are off, by how much, and how it would move if they were not."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.forces.loading import UNLOADED
from sevenbar.kinematics.circuits.motion import Motion, Solvable
from sevenbar.kinematics.circuits.poses import drawn_frames
from sevenbar.kinematics.loop.geometry import loop_frames
from sevenbar.kinematics.loop.reason import OffJoint, Reason, What
from sevenbar.kinematics.loop.rigid import cross, inverse, perpendicular, pose, turns_about, unit
from sevenbar.kinematics.loop.stops import NO_STOPS
from sevenbar.kinematics.solvers.plane_and_sphere import SAME, meeting_point

#: Joints of which more than one is off are meant to fit up to this angle [rad] of axes, and this share of the
#: size of places: a drawing is out by less, and what is off by more is another kind of linkage.
MEANT, MEANT_SHARE = math.radians(10), 0.02

#: So many of the joints fit where one is off by any angle.
FITTING = 3

#: Inputs in a turn at which it is tried how the loop would move.
SAMPLES = 72

#: Joints that turn about an axis square to the plane in which they move.
TURNING = "RE"

#: Motion types of a loop of which one input does not move all.
UNMOVED = ("rigid", "not-followed", "cannot-assemble", "two-inputs")


@dataclass(frozen=True)
class _Drawn:
    """A loop in a pose: the frames (n, 4, 4) before and behind each joint, in the report frame."""

    loop: Solvable
    before: Floats
    behind: Floats

    @property
    def axes(self) -> Floats:
        return np.asarray(self.before[:, :3, 2])

    @property
    def places(self) -> Floats:
        return np.asarray(self.before[:, :3, 3])

    def moved(self, motions: dict[int, Floats]) -> Solvable:
        """The loop with joints moved as bodies by motions (4, 4) of the report frame."""
        before, behind = self.before.copy(), self.behind.copy()
        for i, motion in motions.items():
            before[i], behind[i] = motion @ before[i], motion @ behind[i]
        links = inverse(behind[:-1]) @ before[1:]
        return replace(
            self.loop, frames=loop_frames(before[0], links, behind[-1]),
            points=(), form="drawn", description={}, dimensions={}, loading=UNLOADED, stops=NO_STOPS,
        )  # fmt: skip


def off_joints(motion: Motion) -> Reason | None:
    """Joints, one or some by little, that keep the others of a drawn loop off a plane or a common point.

    `None` where nothing of it is seen.
    """
    loop = motion.linkage
    drawn = _Drawn(loop, *drawn_frames(loop))
    for result in (_off_plane(drawn), _off_point(drawn)):
        if result is None:
            continue
        reason, mended = result
        if mended is None:
            return reason
        eased = mended.motion(SAMPLES, input=motion.input, output=motion.output)
        if eased.motion_type not in UNMOVED:
            return replace(reason, motion_type=eased.motion_type)
    return None


def _off_plane(drawn: _Drawn) -> tuple[Reason, Solvable | None] | None:
    """The joints that are off the plane of the others, and the loop without that, where it is one."""
    kinds = [joint.kind for joint in drawn.loop.joints]
    if set(kinds) - set("RPCSE"):
        return None
    tried = [
        (normal, [_off_normal(kind, axis, normal) for kind, axis in zip(kinds, drawn.axes, strict=True)])
        for normal in _normals(kinds, drawn.axes)
    ]
    if not tried:
        return None
    normal, offs = min(tried, key=lambda way: _how_far_off([by for _, by in way[1]]))
    off = [i for i, (_, by) in enumerate(offs) if by > SAME]
    if not _is_meant([by for kind, (_, by) in zip(kinds, offs, strict=True) if kind != "S"], MEANT):
        return None
    names = [joint.name for joint in drawn.loop.joints]
    reason = Reason(
        "plane",
        tuple(names[i] for i in range(len(names)) if i not in off and kinds[i] != "S"),
        tuple(OffJoint(names[i], offs[i][0], offs[i][1]) for i in off),
    )
    motions = {}
    for i in off:
        axis = drawn.axes[i]
        along = float(axis @ normal)
        target = axis - along * normal if offs[i][0] == "slide" else math.copysign(1.0, along) * normal
        if math.hypot(*target) <= SAME:
            # a slide square to the plane has no direction in it
            return reason, None
        motions[i] = _about_place(_turn(axis, unit(target)), drawn.places[i])
    return reason, drawn.moved(motions)


def _how_far_off(offs: Sequence[float]) -> tuple[int, float]:
    return sum(by > SAME for by in offs), sum(offs)


def _is_meant(offs: Sequence[float], most: float) -> bool:
    """Whether joints that are off by angles [rad], or shares of the size, are taken as meant to fit."""
    off = [by for by in offs if by > SAME]
    return bool(off) and (max(off) <= most or (len(off) == 1 and len(offs) > FITTING))


def _normals(kinds: Sequence[str], axes: Floats) -> Iterator[Floats]:
    """Normals of planes in which joints of these kinds may move."""
    for kind, axis in zip(kinds, axes, strict=True):
        if kind in (*TURNING, "C"):
            yield axis
    slides = [axis for kind, axis in zip(kinds, axes, strict=True) if kind in "PC"]
    for a, b in combinations(slides, 2):
        if math.hypot(*(normal := cross(a, b))) > MEANT:
            yield unit(normal)


def _off_normal(kind: str, axis: Floats, normal: Floats) -> tuple[What, float]:
    """What of a joint is off a plane, and its angle [rad]: a cylinder fits either way."""
    tilted, along = math.hypot(*cross(axis, normal)), abs(float(axis @ normal))
    turn: tuple[What, float] = ("axis", math.atan2(tilted, along))
    slide: tuple[What, float] = ("slide", math.atan2(along, tilted))
    if kind == "S":
        return "axis", 0.0
    if kind == "C":
        return min(turn, slide, key=lambda way: way[1])
    return slide if kind == "P" else turn


def _turn(start: Floats, end: Floats) -> Floats:
    """The least rotation (3, 3) that takes a unit vector to another."""
    normal = cross(start, end)
    sine, cosine = math.hypot(*normal), float(start @ end)
    axis = unit(normal) if sine > 0 else perpendicular(start)
    return np.asarray(turns_about(axis, np.array([math.atan2(sine, cosine)]))[0])


def _about_place(rotation: Floats, place: Floats) -> Floats:
    """The motion (4, 4) that turns about a place (3,)."""
    return pose(rotation, place - rotation @ place)


def _off_point(drawn: _Drawn) -> tuple[Reason, Solvable] | None:
    """The joints whose axes miss the point of the others, and the loop without that."""
    loop, axes, places = drawn.loop, drawn.axes, drawn.places
    if {joint.kind for joint in loop.joints} != {"R"}:
        return None
    size = loop.size
    tried = []
    for pair in combinations(range(len(axes)), 2):
        centre = meeting_point(places[list(pair)], axes[list(pair)])
        if centre is not None:
            tried.append((centre, np.linalg.norm(np.cross(places - centre, axes), axis=1) / size))
    if not tried:
        return None
    centre, offs = min(tried, key=lambda way: _how_far_off(way[1].tolist()))
    off = [i for i, by in enumerate(offs) if by > SAME]
    if not _is_meant(offs.tolist(), MEANT_SHARE):
        return None
    names = [joint.name for joint in loop.joints]
    reason = Reason(
        "point",
        tuple(name for i, name in enumerate(names) if i not in off),
        tuple(OffJoint(names[i], "axis", float(offs[i]) * size) for i in off),
    )
    # square to each axis, as far as it takes
    steps = {i: centre - places[i] - ((centre - places[i]) @ axes[i]) * axes[i] for i in off}
    return reason, drawn.moved({i: pose(np.eye(3), step) for i, step in steps.items()})
