"""Whether a loop moves in parallel planes or about one point: its plane, its sphere."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats, ReadOnly, places_array, positive_length, triple
from sevenbar.kinematics.loop.geometry import Joint, Loop
from sevenbar.kinematics.loop.joints import Z
from sevenbar.kinematics.loop.once import once_for
from sevenbar.kinematics.loop.rigid import cross, inverse, unit
from sevenbar.kinematics.solvers.general import AGREE, expanded
from sevenbar.text.printing import Printed

#: How far axes may be from parallel [rad], or from one point and one height [share of the size]: as far as
#: redundant constraints may disagree. A planar or spherical loop moves because three of its constraints
#: repeat the others, so one that is farther off does not move that way.
SAME = AGREE

#: Balls of a planar loop: of two, the link between may spin about their line and move nothing else; with more
#: a chain of links can leave the plane.
MOST_BALLS = 2

_REPORT_AXES = np.eye(3)


@dataclass(frozen=True, eq=False, repr=False)
class MotionPlane(ReadOnly, Printed):
    """The plane of a planar loop, in the report frame.

    `origin` (3,) [length] lies in it, the `normal` is square to it, `x` and `y` are unit vectors (3,) in it,
    `normal = x x y`. Parallel to two axes of the report frame it has their directions and their coordinates,
    x to the right and y up: those of the report frame are (x, y), (x, z) or (y, z). It goes through the frame
    of the first joint.
    """

    origin: Floats
    normal: Floats
    x: Floats
    y: Floats

    def __post_init__(self) -> None:
        for name in ("origin", "normal", "x", "y"):
            object.__setattr__(self, name, _vector(name, getattr(self, name)))

    def coordinates(self, places: npt.ArrayLike) -> Floats:
        """Places (..., 3) [length] of the report frame as x and y in the plane (..., 2).

        >>> import sevenbar as sb
        >>> plane = sb.load("planar_4r").plane
        >>> plane.coordinates([7.0, 3.0, 4.0]).tolist()
        [3.0, 4.0]
        """
        return (places_array("places", places) - self.origin) @ np.stack([self.x, self.y], axis=-1)


@dataclass(frozen=True, eq=False, repr=False)
class MotionSphere(ReadOnly, Printed):
    """The centre (3,) [length] of a spherical loop in the report frame, and a radius [length] to draw it.

    All motion is a turn about the centre, so that the radius is free. It is the distance of the farthest
    joint as drawn; where all are drawn in the centre, that of the farthest point; without one, 1.
    """

    centre: Floats
    radius: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "centre", _vector("centre", self.centre))
        object.__setattr__(self, "radius", positive_length("radius", self.radius))


def _vector(name: str, value: npt.ArrayLike) -> Floats:
    """Three finite numbers as an array of their own that cannot be written."""
    array = np.array(triple(name, value))
    array.setflags(write=False)
    return array


def plane_of(loop: Loop) -> MotionPlane | None:
    """The plane of a loop that can only move in it; `None` for any other.

    All axes about which a joint turns are parallel to the normal, all slides square to it. One turn about
    an axis in the plane (that of a cylindrical joint for a slide) is allowed, since the others cannot undo it
    and hold it still; so is one slide along the normal, but no screw. Of balls there may be one, or two at
    the ends of one link: these keep their heights and the link its slope, and it may spin about their line.

        >>> import sevenbar as sb
        >>> sb.load("planar_4r").plane.normal.tolist(), sb.load("bennett").plane
        ([1.0, 0.0, 0.0], None)
    """
    if loop.net is not None:
        frames = net_frames(loop)
        normal = across(loop.joints, frames)
        rods = [np.subtract(*rod.at) for rod in loop.rods]
        if normal is None or any(abs(rod @ normal) > SAME * loop.size for rod in rods):
            return None
        return _drawn(normal, frames[0][:3, 3])
    result = in_plane(loop)
    return None if result is None else result.plane


def net_frames(net: Loop) -> Floats:
    """The frames (joints, 4, 4) of the joints of a net on the links before them, as drawn."""
    between = enumerate(net.graph.between)
    return np.stack([net.drawn_joint_on(joint, before) for joint, (before, _) in between])


def across(joints: Sequence[Joint], frames: Iterable[Floats]) -> Floats | None:
    """The direction (3,) about which all drawn joints turn, with slides square to it; else `None`."""
    turning, sliding = [], []
    for joint, frame in zip(joints, frames, strict=True):
        row = joint.row
        if row.bends or row.is_screw:
            return None
        for step in row.steps:
            axis = frame[:3, step.axis]
            if step.freedom == "turn":
                turning.append(axis)
            elif step.axis != Z or len(row.steps) == 1:
                # a cylinder turns in the plane and stays at its height
                sliding.append(axis)
    if not turning:
        return None
    normal = turning[0]
    parallel = all(np.linalg.norm(np.cross(normal, axis)) < SAME for axis in turning)
    return normal if parallel and all(abs(normal @ axis) < SAME for axis in sliding) else None


class InPlane(NamedTuple):
    """The plane of a loop; of the joints of `expanded` those that move in it, and the turn that is held."""

    plane: MotionPlane
    moves: tuple[int, ...]
    held: int | None


@once_for(0)
def in_plane(loop: Loop) -> InPlane | None:
    """The plane of a planar loop, and what moves in it; `None` for any other."""
    parts = expanded(loop)
    letters, count = parts.letters, len(parts.letters)
    if "H" in letters:
        return None
    links = parts.around
    turns = [] if "S" in letters else [i for i, letter in enumerate(letters) if letter == "R"]
    for still in (None, *turns):
        first = 0 if still is None else (still + 1) % count
        order = [(first + i) % count for i in range(count)]
        # all joints at zero, which changes nothing as long as axes about which they turn are parallel
        frames, now = {}, np.eye(4) if still is None else links[still]
        for i in order:
            frames[i], now = now, now @ links[i]
        end = now if still is None else frames.pop(still)
        normal = _normal(letters, frames)
        if normal is not None and _in_plane(letters, frames, end, normal, loop, still is None):
            back = frames.get(0, end)
            plane = _drawn(parts.base[:3, :3] @ back[:3, :3].T @ normal, parts.base[:3, 3])
            out = [i for i in frames if letters[i] == "P" and abs(frames[i][:3, 2] @ normal) > SAME]
            moves = tuple(i for i in range(count) if i in frames and i not in out)
            return InPlane(plane, moves, still)
    return None


def _normal(letters: str, frames: Mapping[int, Floats]) -> Floats | None:
    """The axis of the first turn among joints by number; where all slide, what is square to the slides."""
    axes = {i: frame[:3, 2] for i, frame in frames.items() if letters[i] != "S"}
    for i, axis in axes.items():
        if letters[i] == "R":
            return axis
    products = [cross(a, b) for a, b in combinations(axes.values(), 2)]
    longest = max(products, key=lambda product: math.hypot(*product), default=np.zeros(3))
    return unit(longest) if math.hypot(*longest) > SAME else None


def _in_plane(
    letters: str, frames: Mapping[int, Floats], end: Floats, normal: Floats, loop: Loop, whole: bool
) -> bool:
    """Whether joints with their frames (4, 4) at zero keep all links square to a normal.

    `end` is the frame to which they lead: that of the first again where the loop is `whole`, otherwise that
    of the one joint left out, whose turn must be able to close the loop.
    """
    out = 0
    for i, frame in frames.items():
        axis = frame[:3, 2]
        if letters[i] == "R" and math.hypot(*cross(axis, normal)) > SAME:
            return False
        if letters[i] == "P" and abs(axis @ normal) > SAME:
            out += 1
            if math.hypot(*cross(axis, normal)) > SAME:
                return False
    balls = [i for i in frames if letters[i] == "S"]
    if len(balls) == 2 and balls[1] - balls[0] not in (1, len(letters) - 1):
        return False
    back = end[:3, :3].T @ normal
    off = math.hypot(*(back - normal)) if whole else max(abs(back[2]), abs(normal[2]))
    level = out == 1 or bool(abs(end[:3, 3] @ normal) <= SAME * loop.size)
    return len(balls) <= MOST_BALLS and out <= 1 and off <= SAME and level


def _drawn(normal: Floats, place: Floats) -> MotionPlane:
    """The plane through a place, seen so that the report frame's own axes lie as people draw them."""
    # z points up, unless the plane is seen from above
    up = _REPORT_AXES[1 if abs(normal[2]) > math.sqrt(0.5) else 2]
    y = unit(up - (up @ normal) * normal)
    x = unit(cross(y, normal))
    # to the right along the report frame's x, or along its y where it has none
    right = x[0] if abs(x[0]) > SAME else x[1]
    x = math.copysign(1.0, right) * x + 0.0
    normal = cross(x, y)
    return MotionPlane((normal @ place) * normal, normal, x, y)


def sphere_of(loop: Loop) -> MotionSphere | None:
    """The centre of a loop whose turning axes all meet in one point; `None` for any other and a planar one.

    >>> import sevenbar as sb
    >>> sb.load("spherical_4r").sphere.centre.tolist(), sb.load("rssr").sphere
    ([0.0, 0.0, 0.0], None)
    """
    parts = expanded(loop)
    if set(parts.letters) - {"R", "S"} or plane_of(loop) is not None:
        return None
    frames = parts.frames
    places = np.stack([frame[:3, 3] for frame in frames])
    axes = np.stack([frame[:3, 2] for frame in frames])
    turning = [i for i, letter in enumerate(parts.letters) if letter == "R"]
    balls = [i for i, letter in enumerate(parts.letters) if letter == "S"]
    near = SAME * loop.size
    centre = meeting_point(places[turning], axes[turning])
    if centre is None:
        return None
    off = np.linalg.norm(np.cross(places[turning] - centre, axes[turning]), axis=1)
    apart = np.linalg.norm(places[balls] - centre, axis=1)
    # round the loop the centre comes back to itself
    round_trip = parts.ground @ inverse(frames[-1]) @ (*centre, 1.0)
    if max(*off, *apart, float(np.linalg.norm(round_trip[:3] - centre))) > near:
        return None
    drawn = np.linalg.norm(places - centre, axis=1).max()
    ends = [frames[last] for last in parts.last]
    at = [
        (ends[point.link - 1] @ loop.point_frames[point.link - 1] @ (*point.at, 1.0))[:3]
        if point.link in loop.graph.moving
        else np.asarray(point.at)
        for point in loop.points
    ]
    if drawn <= near and at:
        drawn = np.linalg.norm(np.stack(at) - centre, axis=1).max()
    return MotionSphere(np.array(centre), float(drawn) if drawn > near else 1.0)


def meeting_point(places: Floats, axes: Floats) -> Floats | None:
    """Where the two most inclined of several lines (n, 3) come nearest; `None` where all are parallel."""
    pairs = list(combinations(range(len(axes)), 2))
    first, second = max(
        pairs, key=lambda pair: math.hypot(*cross(axes[pair[0]], axes[pair[1]])), default=(0, 0)
    )
    a, b = axes[first], axes[second]
    normal = cross(a, b)
    if math.hypot(*normal) <= SAME:
        return None
    # a s + b t + normal u leads from the first line to the second
    along = np.linalg.solve(np.column_stack([a, -b, normal]), places[second] - places[first])
    return np.asarray(places[first] + along[0] * a + along[2] / 2 * normal)
