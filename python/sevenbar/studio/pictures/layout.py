"""How a linkage's places hang together: links, joints and their axes."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

from sevenbar.drawing.skeleton import Skeleton
from sevenbar.kinematics.loop.joints import JointKind

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


@dataclass(frozen=True)
class Layout:
    """Places along each link, the ground's last, and of each joint; `count` is how many the frame has."""

    links: tuple[tuple[int, ...], ...]
    joints: tuple[JointPlaces, ...]
    count: int

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


def layout(frame: Skeleton) -> Layout:
    """The layout of the linkage of a frame."""
    joints = []
    for i, joint in enumerate(frame.linkage.joints):
        marks = [(word, (places[0], places[-1])) for j, word, places in frame.marks if j == i]
        axes = tuple(pair for word, pair in marks if word == "axis")
        spin = next((pair for word, pair in marks if word == "cylinder"), NOWHERE)
        near, far = frame.links[i - 1][-1], frame.links[i][0]
        joints.append(JointPlaces(joint.row, joint.pitch, near, far, axes, spin))
    return Layout(frame.links, tuple(joints), frame.places.shape[1])
