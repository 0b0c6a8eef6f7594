"""How a linkage's places hang together: links, joints and their axes, for the RSSR and all others alike."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.drawing.skeleton import A0, AXIS, B0, LINK_ENDS, Chain, Skeleton
from sevenbar.kinematics.geometry import Loop
from sevenbar.kinematics.joints import JointKind

#: Two places, from and to.
Pair = tuple[int, int]

#: Two places that are one: no direction.
NOWHERE: Pair = (0, 0)


@dataclass(frozen=True)
class JointPlaces:
    """A joint: its kind and pitch, and the places of its feet on the link before and the link after.

    `axes` are the ends of its drawn axes, the first fixed in the link before, the last in the link after;
    `spin` two places along the axis, the same way in every pose, where there are such.
    """

    kind: JointKind
    pitch: float
    near: int
    far: int
    axes: tuple[Pair, ...]
    spin: Pair


@dataclass(frozen=True, eq=False)
class Layout:
    """Places along each link, the ground's last, and of each joint; named places; and places that never move.

    Indices from `count` on count `fixed` (m, 3): places that the frame does not have.
    """

    links: tuple[tuple[int, ...], ...]
    joints: tuple[JointPlaces, ...]
    count: int
    fixed: Floats

    def rigid(self, link: int) -> list[Pair]:
        """Pairs of places that keep their distance and turn with a link."""
        last = len(self.links) - 1
        way = self.links[link]
        found = [(way[0], place) for place in way[1:]] + list(pairwise(way))
        before = self.joints[link if link < last else last]
        after = self.joints[link + 1 if link < last else 0]
        found += [before.spin] + ([] if after.kind.rides else [after.spin])
        found += [before.axes[-1]] if before.kind.has_cross else []
        found += [after.axes[0]] if after.kind.has_cross else []
        return [pair for pair in found if pair != NOWHERE]


def layout(linkage: Loop, frame: Skeleton) -> Layout:
    """The layout of a linkage from its frame: for the RSSR the axes stand as fixed places."""
    if isinstance(frame, Chain):
        return _of_chain(linkage, frame)
    count = frame.places.shape[1]
    middles = frame.pose(0)[[A0, B0]]
    half = AXIS * frame.span * frame.axes
    fixed = np.stack([middles - half, middles + half], axis=1).reshape(-1, 3)
    axes: tuple[Pair, Pair] = (count, count + 1), (count + 2, count + 3)
    ends = [LINK_ENDS[link] for link in (1, 2, 3, 4)]
    joints = []
    for i, joint in enumerate(linkage.joints):
        own = {0: (axes[0],), 3: (axes[1],)}.get(i, ())
        joints.append(
            JointPlaces(joint.row, 0.0, ends[i - 1][1], ends[i][0], own, own[0] if own else NOWHERE)
        )
    return Layout(tuple(ends), tuple(joints), count, fixed)


def _of_chain(linkage: Loop, frame: Chain) -> Layout:
    joints = []
    for i, joint in enumerate(linkage.joints):
        marks = [(word, (places[0], places[-1])) for j, word, places in frame.marks if j == i]
        axes = tuple(pair for word, pair in marks if word == "axis")
        spin = next((pair for word, pair in marks if word == "cylinder"), NOWHERE)
        near, far = frame.links[i - 1][-1], frame.links[i][0]
        joints.append(JointPlaces(joint.row, joint.pitch, near, far, axes, spin))
    return Layout(frame.links, tuple(joints), frame.places.shape[1], np.empty((0, 3)))
