"""The linkage as it is drawn: places along its links, marks of its joints, and named points, pose by pose."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.errors import RequestError
from sevenbar.kinematics.circuits import Circuit
from sevenbar.kinematics.geometry import Loop, Point
from sevenbar.kinematics.motion import Motion
from sevenbar.kinematics.poses import at_row, frames_along, frames_of, joint_frames, walk

#: Half the length of a joint's drawn axis and of its cylinder, and how far a plate reaches past what slides
#: on it, as shares of the linkage's extent.
AXIS, CYLINDER, PLATE = 0.075, 0.032, 0.04


@dataclass(frozen=True, eq=False)
class Skeleton:
    """The places of a loop in poses, in the report frame [length]: its joints and links, then named points.

    `places` (n, k, 3), `names` of each; `links` holds the places along each link, the ground's last; `marks`
    what is drawn of each joint: its number, a word and the places it joins. `joints` are the places of the
    joints, `points` those of the named points, `stays` the places that tie each point to its link. `extent`
    [length] is what the sizes of the marks are shares of. `reach` is how far joints slide across their axes,
    least and most (2,) by the joint's number.
    """

    linkage: Loop
    places: Floats
    names: tuple[str, ...]
    links: tuple[tuple[int, ...], ...]
    marks: tuple[tuple[int, str, tuple[int, ...]], ...]
    joints: tuple[int, ...]
    points: tuple[int, ...]
    stays: tuple[tuple[int, int, int], ...]
    extent: float
    reach: Mapping[int, tuple[Floats, Floats]]

    def pose(self, row: float) -> Floats:
        """The places (k, 3) at a row, between two rows on the straight line between them."""
        return at_row(self.places, row)

    @property
    def solid(self) -> int:
        """How many places, from the first on, a pose cannot do without."""
        return len(self.names) - len(self.points)

    @property
    def standing(self) -> tuple[int, ...]:
        """The joints that stand still."""
        return (self.joints[0], self.joints[-1])

    @property
    def inner(self) -> tuple[int, ...]:
        """The joints between moving links, whose paths are drawn."""
        return self.joints[1:-1]

    def lines(self, pose: Floats, screen: Floats) -> list[Floats]:
        """The lines (2, 2) of a pose, as seen on the screen, that labels should keep off."""
        seen = pose @ screen.T
        ends = [pair for link in self.links for pair in pairwise(link)]
        ends += [(places[0], places[-1]) for _, _, places in self.marks]
        return [seen[list(pair)] for pair in ends]

    @cached_property
    def span(self) -> float:
        """The largest extent along x, y or z [length]."""
        return _extent(self.places)


def skeleton_of(
    linkage: Loop, frames: Floats, points: Sequence[Point] = (), *, like: Skeleton | None = None
) -> Skeleton:
    """The places of a loop from the frames (n, moving links, 4, 4) of its links in n poses.

    Each joint is drawn where its axis was placed, each link from joint to joint; in Denavit-Hartenberg rows
    along the offset, then along the common normal. `like` is that of the whole motion where the
    frames show only a part of it.
    """
    rows, count = len(frames), len(linkage.joints)
    before, after = joint_frames(linkage, frames)
    origins = np.concatenate([before[..., :3, 3], after[..., :3, 3]])
    spread = _extent(origins)
    in_rows = linkage.form == "rows"
    spherical = not spread > 1e-9
    places: list[Floats] = []

    def add(place: Floats) -> int:
        places.append(np.broadcast_to(place, (rows, 3)))
        return len(places) - 1

    # a loop whose axes meet where all frames lie is shown on a sphere round that place
    radius = 1.0 if spherical else 0.0
    span = like.extent if like else 1.6 if spherical else spread
    feet: list[tuple[int, int]] = []
    marks: list[tuple[int, str, tuple[int, ...]]] = []
    reach: dict[int, tuple[Floats, Floats]] = {}
    links: list[tuple[int, ...]] = []
    for i, joint in enumerate(linkage.joints):
        # the axis as it is written
        written = -1.0 if joint.backwards else 1.0
        first, second = written * before[:, i, :3, 2], written * after[:, i, :3, 2]
        near = before[:, i, :3, 3] + radius * first
        far = after[:, i, :3, 3] + radius * second
        feet.append((add(near), add(far)))

        def along(middle: Floats, axis: Floats, half: float, to: Floats | None = None) -> tuple[int, int]:
            end = middle if to is None else to
            # not by closure errors, which would swap the ends from row to row
            back = ((end - middle) * axis).sum(axis=1, keepdims=True) < -1e-3 * span
            way = np.where(back, -1.0, 1.0) * axis
            return add(middle - half * span * way), add(end + half * span * way)

        shape = joint.row.shape
        if shape == "plate":
            # as wide as it slides
            across = before[:, i, :3, :2]
            slid = np.einsum("nij,ni->nj", across, far - near)
            low, high = np.nanmin(slid, axis=0, initial=0.0), np.nanmax(slid, axis=0, initial=0.0)
            low, high = reach[i] = like.reach[i] if like else (low, high)
            ends = np.stack([low - PLATE * span, high + PLATE * span])
            corners = [(ends[a, 0], ends[b, 1]) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1), (0, 0))]
            marks.append((i, "axis", along(near + across @ ((low + high) / 2), first, AXIS)))
            marks.append((i, "axis", along(far, second, AXIS)))
            marks.append((i, shape, tuple(add(near + across @ np.array(corner)) for corner in corners)))
            marks.append((i, "block", (feet[i][1],)))
            continue
        if shape != "ball":
            marks.append((i, "axis", along(near, first, AXIS, far)))
        if joint.row.has_cross:
            marks.append((i, "axis", along(far, second, AXIS)))
            marks += [(i, shape, along(near, first, CYLINDER)), (i, shape, along(far, second, CYLINDER))]
        elif shape in ("cylinder", "thread"):
            cylinder = along(far, second, CYLINDER)
            marks.append((i, "cylinder", cylinder))
            marks += [(i, shape, cylinder)] if shape == "thread" else []
        else:
            marks.append((i, shape, (feet[i][1],)))
    for i in range(count):
        start, end = feet[i][1], feet[(i + 1) % count][0]
        inner: tuple[int, ...] = ()
        if spherical:
            centre = before[:, 0, :3, 3]
            inner = tuple(add(place) for place in _arc_between(centre, places[start], places[end]))
        elif in_rows:
            inner = _bend(after[:, i], places[start], places[end], add)
        links.append((start, *inner, end))
    solid = len(places)
    named = [""] * solid
    letters = {1: "A", 2: "B"} if linkage.kind == "RSSR" else {}  # those of the paper
    for i, joint in enumerate(linkage.joints):
        named[feet[i][1]] = short(letters.get(i, joint.name), 24)
    for point in points:
        place = linkage.point_frames[point.link - 1] @ (*point.at, 1.0)
        add((after[:, point.link - 1] @ place if point.link < count else place)[..., :3])
        named.append(short(point.name, 24))
    own = tuple(range(solid, len(places)))
    return Skeleton(
        linkage,
        np.stack(places, axis=1),
        tuple(named),
        links=tuple(links),
        marks=tuple(marks),
        joints=tuple(foot for _, foot in feet),
        points=own,
        stays=tuple(
            (links[point.link - 1][0], place, links[point.link - 1][-1])
            for place, point in zip(own, points, strict=True)
        ),
        extent=span,
        reach=reach,
    )


def _extent(places: Floats) -> float:
    """The largest extent of places (n, k, 3) along x, y or z [length]; those that are NaN aside."""
    high, low = (one.reduce(one.reduce(places, axis=0), axis=0) for one in (np.fmax, np.fmin))
    return float((high - low).max())


def _bend(frame: Floats, start: Floats, end: Floats, add: Callable[[Floats], int]) -> tuple[int, ...]:
    """The corner of a link of Denavit-Hartenberg rows, between its offset and its common normal."""
    axis = frame[:, :3, 2]
    corner = start + ((end - start) * axis).sum(axis=1, keepdims=True) * axis
    small = 1e-9 * max(1e-300, float(np.nanmax(np.abs(end - start), initial=0.0)))
    if min(np.nanmax(np.abs(corner - start)), np.nanmax(np.abs(corner - end))) <= small:
        return ()
    return (add(corner),)


def _arc_between(centre: Floats, start: Floats, end: Floats) -> list[Floats]:
    """Places (n, 3) on the great circle from start to end, on a unit sphere."""
    shares = np.linspace(0, 1, 14)[1:-1]
    chords = [start + share * (end - start) - centre for share in shares]
    lengths = [np.linalg.norm(chord, axis=1, keepdims=True) for chord in chords]
    return [centre + chord / np.where(n > 1e-9, n, 1.0) for chord, n in zip(chords, lengths, strict=True)]


def skeleton(motion: Motion, circuit: Circuit) -> Skeleton:
    """The places of the linkage along the walk of a circuit."""
    frames = frames_along(motion.linkage, circuit, walk(circuit).rows)
    if np.isnan(frames).any(axis=(1, 2, 3)).all():
        raise RequestError(
            f"circuit: circuit {circuit.index} has no pose at the inputs of the law; nothing to draw"
        )
    return skeleton_of(motion.linkage, frames, motion.linkage.added_points)


def places_of(q: Floats, frame: Skeleton) -> Floats:
    """The places (n, k, 3) of poses given by joint values (n, columns), in the order of those of `frame`."""
    linkage = frame.linkage
    return skeleton_of(linkage, frames_of(linkage, q), linkage.added_points, like=frame).places


def one_pose(frame: Skeleton, row: int) -> Skeleton:
    """The places of one row alone."""
    return replace(frame, places=frame.places[row : row + 1])


def short(text: str, width: int) -> str:
    """The text, cut to so many letters."""
    return text if len(text) <= width else text[: width - 1] + "…"
