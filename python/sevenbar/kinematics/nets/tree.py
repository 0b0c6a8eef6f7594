"""A net as the core takes it: a spanning tree of steps of one freedom, and the rows of all that is off it.

Joints with few freedoms are in the tree, the driven one and the output first; rods never are. A link that
only rods hold has six steps of its own.

Source: docs/theory_nets.md, (1) to (4).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple, TypeVar, cast

import numpy as np

import sevenbar._core as _core
from sevenbar.arrays import Floats
from sevenbar.errors import NotCoveredError
from sevenbar.kinematics.loop.geometry import LinkApart, Loop
from sevenbar.kinematics.loop.joints import ANYWHERE, X, Z
from sevenbar.kinematics.nets.chords import ChordRow, Triple, joint_rows, rod_row, three
from sevenbar.kinematics.nets.order import Order, Parts

T = TypeVar("T")

#: What to do about a net that nothing moves, and about one that one input does not.
IF_RIGID = "leave out a joint or a rod, or give a joint more freedoms"
IF_LOOSE = "join links by more joints or rods"

#: A row as the core takes it: its kind, the steps of its links, its vectors and its number.
RawRow = tuple[str, tuple[int | None, int | None], tuple[Triple, Triple], float]

#: What a net is made of, a circuit as it was followed, its rows as the core has them, and it with its rows.
NetParts = _core.NetParts
NetFollowed = _core.NetFollowed
NetRows = _core.NetRows
CoreCircuit = tuple[_core.RawCircuit, NetRows]


class Freedom(NamedTuple):
    """A freedom of a joint as drawn: its letter (S of a ball's first), a place on its axis, its direction.

    `advance` [length for a radian] is that of H.
    """

    letter: str
    advance: float
    origin: Floats
    axis: Floats


def freedoms_of(linkage: Loop, joint: int, *, outwards: bool) -> list[Freedom]:
    """The freedoms of a joint from the link before it to that after it, or the other way round."""
    row, advance = linkage.joints[joint].row, linkage.joints[joint].advance
    first, second = (linkage.drawn_joint_on(joint, link) for link in linkage.graph.between[joint])
    result: list[Freedom] = []
    for step in row.steps if outwards else row.steps[::-1]:
        if step.driven:
            continue
        frame = second if step.tilted else first
        # the link before against the link after moves the other way round
        axis = frame[:3, step.axis] if outwards else -frame[:3, step.axis]
        letter = "H" if row.is_screw else "S" if row.is_ball and not result else step.letter
        result.append(Freedom(letter, advance if row.is_screw else 0.0, frame[:3, 3], axis))
    return result


@dataclass(eq=False)
class Tree:
    """The steps of a net's tree, each a column; `carrier` is the step of each link, `None` of the ground.

    The joints `first` begin it, the driven one and the output; joints of the blocks of `order` follow in this
    order. `columns` are the steps of each joint in the tree, in the order of its columns.
    """

    linkage: Loop
    first: tuple[int, ...]
    order: Order = field(default_factory=Order)
    letters: str = ""
    advances: list[float] = field(default_factory=list)
    parents: list[int | None] = field(default_factory=list)
    origins: list[Floats] = field(default_factory=list)
    axes: list[Floats] = field(default_factory=list)
    reads: list[float] = field(default_factory=list)
    carrier: dict[int, int | None] = field(default_factory=dict)
    chords: list[int] = field(default_factory=list)
    columns: dict[int, list[int]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        graph = self.linkage.graph
        self.carrier[graph.ground] = None
        block_of = {joint: i for i, block in enumerate(self.order.blocks) for joint in block.joints}

        def rank(joint: int) -> tuple[int, int, int]:
            before = self.first.index(joint) - len(self.first) if joint in self.first else None
            return block_of.get(joint, 0) if before is None else before, self._freedoms(joint), joint

        remaining = sorted(graph.joints, key=rank)
        while remaining:
            reach = (j for j in remaining if len({*graph.between[j]} & self.carrier.keys()) == 1)
            joint = next(reach, None)
            if joint is None:
                break
            remaining.remove(joint)
            self._grow(joint)
        for link in self.linkage.links_apart:
            self._free(link)
        # those of a cycle in a plane before those that hang on it: all rows of the first keep their rank
        self.chords = sorted(remaining, key=lambda joint: (block_of.get(joint, 0), joint))
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
        at = self.carrier[before if outwards else after]
        # only a joint of one value reads another than 0 as drawn
        reads = self.linkage.joints[joint].value
        columns = self.columns[joint] = []
        for freedom in freedoms_of(self.linkage, joint, outwards=outwards):
            at = self._step(freedom.letter, freedom.advance, at, freedom.origin, freedom.axis, reads)
            columns.insert(len(columns) if outwards else 0, at)
        self.carrier[after if outwards else before] = at

    def _free(self, apart: LinkApart) -> None:
        """Gives a link that only rods hold six steps of its own."""
        at = None
        for letter, step in zip("PPPSRR", ANYWHERE.steps, strict=True):
            at = self._step(letter, 0.0, at, apart.at[:3, 3], np.eye(3)[step.axis])
        self.carrier[apart.link] = at

    def steps_apart(self, link: int) -> list[int]:
        """The steps of a link that only rods hold."""
        last = cast("int", self.carrier[link])
        return list(range(last + 1 - len(ANYWHERE.steps), last + 1))

    def _step(
        self,
        letter: str,
        advance: float,
        parent: int | None,
        origin: Floats,
        axis: Floats,
        reads: float = 0.0,
    ) -> int:
        self.letters += letter
        self.advances.append(advance)
        self.parents.append(parent)
        self.origins.append(origin)
        self.axes.append(axis)
        self.reads.append(reads)
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

    def raw_row(self, between: tuple[int, int], row: ChordRow) -> RawRow:
        """A row between two links as the core takes it: the steps that carry them in their place."""
        first, second = (self.carrier[between[side]] for side in row.sides)
        return row.kind, (first, second), row.vectors, row.number

    @property
    def facing(self) -> list[tuple[tuple[int | None, int | None], Triple]]:
        """Directions of two links, joined by a chord, that rows alone would let be opposite."""
        linkage, result = self.linkage, []
        for joint in self.chords:
            between, row = linkage.graph.between[joint], linkage.joints[joint].row
            if not row.bends:
                frame = linkage.drawn_joint_on(joint, between[1])
                axes = (Z,) if "turn" in row.freedoms else (X, Z)
                on = self.carrier[between[0]], self.carrier[between[1]]
                result += [(on, three(frame[:3, axis])) for axis in axes]
        return result

    @cached_property
    def core(self) -> _core.Net:
        """The net of the core."""
        linkage = self.linkage
        joints = [
            (
                joint.kind,
                joint.angle,
                (self.carrier[before], self.carrier[after]),
                self.columns.get(number, []),
            )
            for number, (joint, (before, after)) in enumerate(
                zip(linkage.joints, linkage.graph.between, strict=True)
            )
        ]
        # a link apart is read as if a joint led to it from the ground
        joints += [
            (" ", 0.0, (None, self.carrier[link]), self.steps_apart(link)) for link in linkage.graph.apart
        ]
        places = np.array([apart.at for apart in linkage.links_apart]).reshape(-1, 4, 4)
        rows = [self.raw_row(between, row) for between, row in self.rows]
        return _core.Net(
            self.letters,
            np.array(self.advances),
            self.parents,
            np.array(self.origins).reshape(-1, 3),
            np.array(self.axes).reshape(-1, 3),
            np.array(self.reads),
            rows,
            self.facing,
            linkage.size,
            joints,
            np.concatenate([linkage.frames[:, 0], places]),
            np.concatenate([linkage.frames[:, 1], places]),
        )

    def followed(self, work: Callable[[_core.Net], T]) -> T:
        """The result of work of the core, or why it follows no motion of this net."""
        if spins := Parts(self.linkage).spins:
            name = self.linkage.link_name(min(spins.values()))
            raise NotCoveredError(f"net: '{name}' spins idly between two balls; write it as a rod")
        try:
            return work(self.core)
        except _core.CoreError as error:
            freedoms = len(self.core.freedoms()[2])
            remedy = "" if freedoms == 1 else f"; {IF_LOOSE if freedoms else IF_RIGID}"
            raise NotCoveredError(
                f"net: motion is found of nets that one input moves; here {error}{remedy}"
            ) from None
