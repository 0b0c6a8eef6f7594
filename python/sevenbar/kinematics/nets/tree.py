"""A net as the core takes it: a spanning tree of steps of one freedom, and the rows of all that is off it.

Joints with few freedoms are in the tree, the driven one first; rods never are. A link that only rods hold has
six steps of its own.

Source: docs/theory_nets.md, (1) to (4).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

import sevenbar._core as _core
from sevenbar.arrays import Floats
from sevenbar.errors import NotCoveredError
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.kinematics.nets.chords import ChordRow, joint_rows, rod_row
from sevenbar.kinematics.nets.order import Order


@dataclass
class Tree:
    """The steps of a net's tree, each a column; `carrier` is the step of each link, `None` of the ground.

    `driven` is a joint; joints of the blocks of `order` follow it in this order.
    """

    linkage: Loop
    driven: int
    order: Order = field(default_factory=Order)
    letters: str = ""
    advances: list[float] = field(default_factory=list)
    parents: list[int | None] = field(default_factory=list)
    origins: list[Floats] = field(default_factory=list)
    axes: list[Floats] = field(default_factory=list)
    carrier: dict[int, int | None] = field(default_factory=dict)
    chords: list[int] = field(default_factory=list)

    def __post_init__(self) -> None:
        graph = self.linkage.graph
        self.carrier[graph.ground] = None
        block_of = {joint: i for i, block in enumerate(self.order.blocks) for joint in block.joints}

        def rank(joint: int) -> tuple[int, int, int]:
            first = -1 if joint == self.driven else block_of.get(joint, 0)
            return first, self._freedoms(joint), joint

        remaining = sorted(graph.joints, key=rank)
        while remaining:
            reach = (j for j in remaining if len({*graph.between[j]} & self.carrier.keys()) == 1)
            joint = next(reach, None)
            if joint is None:
                break
            remaining.remove(joint)
            self._grow(joint)
        for link in graph.moving:
            if link not in self.carrier:
                self._free(link)
        self.chords = sorted(remaining)
        for joint in self.chords:
            if self.linkage.joints[joint].row.is_screw:
                name = self.linkage.joints[joint].name
                raise NotCoveredError(f"net: joint '{name}' is a screw that closes a loop of screws")

    def _freedoms(self, joint: int) -> int:
        row = self.linkage.joints[joint].row
        # a ball last, for it is three steps about one place
        return len(row.freedoms) + row.is_ball

    def _grow(self, joint: int) -> None:
        """Puts a joint, and the link that it leads to, into the tree."""
        before, after = self.linkage.graph.between[joint]
        outwards = before in self.carrier
        row, advance = self.linkage.joints[joint].row, self.linkage.joints[joint].advance
        first, second = (self.linkage.drawn_joint_on(joint, link) for link in (before, after))
        at = self.carrier[before if outwards else after]
        steps = row.steps if outwards else row.steps[::-1]
        for step in steps:
            if step.driven:
                continue
            frame = second if step.tilted else first
            # the link before against the link after moves the other way round
            axis = frame[:3, step.axis] if outwards else -frame[:3, step.axis]
            letter = "H" if row.is_screw else step.letter
            at = self._step(letter, advance if row.is_screw else 0.0, at, frame[:3, 3], axis)
        self.carrier[after if outwards else before] = at

    def _free(self, link: int) -> None:
        """Gives a link that only rods hold six steps of its own."""
        ends = [
            end
            for rod in self.linkage.rods
            for carrier, end in zip(rod.between, rod.at, strict=True)
            if carrier == link
        ]
        place, at = np.mean(ends, axis=0), None
        for letter in "PR":
            for axis in np.eye(3):
                at = self._step(letter, 0.0, at, place, axis)
        self.carrier[link] = at

    def _step(self, letter: str, advance: float, parent: int | None, origin: Floats, axis: Floats) -> int:
        self.letters += letter
        self.advances.append(advance)
        self.parents.append(parent)
        self.origins.append(origin)
        self.axes.append(axis)
        return len(self.letters) - 1

    @property
    def rows(self) -> list[tuple[tuple[int, int], ChordRow]]:
        """The rows of chords, each with its two links."""
        linkage = self.linkage
        result: list[tuple[tuple[int, int], ChordRow]] = []
        for joint in self.chords:
            between = linkage.graph.between[joint]
            frames = (linkage.drawn_joint_on(joint, link) for link in between)
            result += [(between, row) for row in joint_rows(linkage.joints[joint], *frames)]
        return result + [(rod.between, rod_row(rod)) for rod in linkage.rods]

    def core(self) -> _core.Net:
        """The net of the core."""
        linkage, rows = self.linkage, []
        for between, row in self.rows:
            first, second = (self.carrier[between[side]] for side in row.sides)
            rows.append((row.kind, (first, second), row.vectors, row.number))
        return _core.Net(
            self.letters,
            np.array(self.advances),
            self.parents,
            np.array(self.origins).reshape(-1, 3),
            np.array(self.axes).reshape(-1, 3),
            rows,
            linkage.size,
        )
