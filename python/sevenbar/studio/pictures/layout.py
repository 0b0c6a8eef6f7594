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
    `spin` two places along the axis, from and to alike in every pose; `NOWHERE` where there are none.
    """

    kind: JointKind
    pitch: float
    near: int
    far: int
    axes: tuple[Pair, ...]
    spin: Pair


@dataclass(frozen=True)
class Layout:
    """The joints and links of a frame by their places, and `count`, how many places the frame has."""

    frame: Skeleton
    joints: tuple[JointPlaces, ...]
    count: int

    def rigid(self, link: int) -> list[Pair]:
        """Pairs of places that keep their distance and turn with a link, counted from 1."""
        places, graph = self.frame.along(link), self.frame.graph
        result = [(places[0], place) for place in places[1:]] + list(pairwise(places))
        sides = [(self.joints[joint], graph.side(joint, link)) for joint in graph.joints_of(link)]
        # what rides on a joint is after it
        result += [joint.spin for joint, side in sides if side or not joint.kind.rides]
        result += [joint.axes[-side] for joint, side in sides if joint.kind.has_cross]
        return [pair for pair in result if pair != NOWHERE]


def layout(frame: Skeleton) -> Layout:
    """The layout of the linkage of a frame."""
    joints = []
    for i, joint in enumerate(frame.linkage.joints):
        marks = [(word, (places[0], places[-1])) for j, word, places in frame.marks if j == i]
        axes = tuple(pair for word, pair in marks if word == "axis")
        spin = next((pair for word, pair in marks if word == "cylinder"), NOWHERE)
        joints.append(JointPlaces(joint.row, joint.pitch, *frame.feet[i], axes, spin))
    return Layout(frame, tuple(joints), frame.places.shape[1])
