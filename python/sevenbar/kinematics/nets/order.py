"""In which order a net is solved: its biconnected parts, and the blocks of links in each.

Source: docs/theory_nets.md, (6).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from typing import Literal

import numpy as np

import sevenbar._core as _core
from sevenbar.arrays import Floats
from sevenbar.kinematics.circuits.poses import drawn_frames
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.kinematics.loop.joints import Z
from sevenbar.kinematics.loop.once import once_for
from sevenbar.kinematics.solvers.general import AGREE
from sevenbar.kinematics.solvers.plane_and_sphere import across, net_frames

#: How links of a part move: in parallel planes, about one point, or any way.
Group = Literal["planar", "spherical", "spatial"]

#: The freedoms of a link in each.
FREEDOMS: dict[Group, int] = {"planar": 3, "spherical": 3, "spatial": 6}

#: The joints of cycles in a plane, and about a point, that are solved before the rest of a part in space.
IN_PLANES = ("R", "P", "K", "L")
ABOUT_POINTS = ("R", "U")

#: How far axes may be from parallel [rad], or from one point [share of the size].
SAME = AGREE


@dataclass(frozen=True)
class LinkBlock:
    """Links that are solved together, once those before them are: links and joints by number, rods by place.

    `solver`: "dyad" has a closed form; "loop" is one loop; "links" are more.
    """

    links: tuple[int, ...]
    joints: tuple[int, ...]
    rods: tuple[int, ...]
    group: Group
    solver: Literal["dyad", "loop", "links"]


@dataclass(frozen=True)
class Order:
    """The blocks of a net in the order in which they are solved, with the input held.

    `free` are links that keep a freedom then, and `held` the joints and rods with rows for which no freedom
    is left, by name: there the count alone gives no order.
    """

    blocks: tuple[LinkBlock, ...] = ()
    free: tuple[str, ...] = ()
    held: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Parts:
    """A net's joints and rods as edges of a graph, joints first."""

    linkage: Loop

    @cached_property
    def between(self) -> list[tuple[int, int]]:
        """The two links of each edge, counted from 0."""
        pairs = [*self.linkage.graph.between, *(rod.between for rod in self.linkage.rods)]
        return [(a - 1, b - 1) for a, b in pairs]

    @property
    def first_rod(self) -> int:
        """The number of the first rod among the edges: how many joints there are."""
        return self.linkage.graph.joints.stop

    @property
    def names(self) -> list[str]:
        """The names of the edges."""
        joints, rods = self.linkage.joints, self.linkage.rods
        return [joint.name for joint in joints] + [rod.name for rod in rods]

    @cached_property
    def spins(self) -> dict[int, int]:
        """The links between two balls, counted from 1, which may spin idly, each by one of its balls."""
        graph = self.linkage.graph
        rodded = {link for rod in self.linkage.rods for link in rod.between}
        result = {}
        for link in set(graph.moving) - rodded:
            ends = graph.joints_of(link)
            if len(ends) == 2 and all(self.linkage.joints[joint].row.is_ball for joint in ends):
                result[min(ends)] = link
        return result

    @cached_property
    def whole(self) -> list[tuple[list[int], Group]]:
        """The edges of each biconnected part, and how its links move."""
        count = self.linkage.graph.ground
        parts = _core.biconnected_parts(count, self.between, count - 1)
        return [(edges, self._group(edges)) for edges in parts]

    @cached_property
    def cycles(self) -> list[tuple[list[int], int, Group]]:
        """The links of each part, counted from 1, how many cycles its joints make, and how its links move."""
        result = []
        for edges, group in self.whole:
            links = sorted({link + 1 for edge in edges for link in self.between[edge]})
            result.append((links, sum(edge < self.first_rod for edge in edges) - len(links) + 1, group))
        return result

    def _group(self, edges: Sequence[int]) -> Group:
        joints = [edge for edge in edges if edge < self.first_rod]
        links = {link for edge in edges for link in self.between[edge]}
        if not joints or links != {link for joint in joints for link in self.between[joint]}:
            return "spatial"
        if self._is_planar(joints):
            return "planar"
        return "spherical" if joints == list(edges) and self.centre(joints) is not None else "spatial"

    @cached_property
    def _frames(self) -> Floats:
        """The frames (joints, 4, 4) of all joints, in a pose in which those of a net are drawn."""
        linkage = self.linkage
        return drawn_frames(linkage)[0] if linkage.net is None else net_frames(linkage)

    def _is_planar(self, joints: Sequence[int]) -> bool:
        """Whether all turn about parallel axes, and slide square to them."""
        own = [self.linkage.joints[joint] for joint in joints]
        return across(own, self._frames[list(joints)]) is not None

    def centre(self, joints: Sequence[int]) -> Floats | None:
        """The one point (3,) in which all axes of joints meet; `None` where some slide, or they do not."""
        places, axes = [], []
        for joint in joints:
            turning, frame = self.linkage.joints[joint], self._frames[joint]
            for step in turning.row.steps:
                # the second axis of a joint U is known as drawn alone
                if step.freedom == "slide" or (step.tilted and self.linkage.net is None):
                    return None
                turned = frame @ turning.before(step) if step.tilted else frame
                places.append(frame[:3, 3])
                axes.append(turned[:3, step.axis])
        # the point nearest to all axes
        across = [np.eye(3) - np.outer(axis, axis) for axis in axes]
        sides = [project @ place for project, place in zip(across, places, strict=True)]
        centre, _, rank, _ = np.linalg.lstsq(np.concatenate(across), np.concatenate(sides), rcond=SAME)
        off = [
            np.linalg.norm(project @ (centre - place)) for project, place in zip(across, places, strict=True)
        ]
        return centre if rank == 3 and max(off) < SAME * self.linkage.size else None

    def cycles_within(self, edges: Sequence[int], driven: int) -> list[tuple[set[int], Group]]:
        """The joints of cycles in a plane or about a point within a part in space.

        Of a four-bar that drives an RSSR, say.
        """
        joints = sorted(edge for edge in {*edges, driven} if edge < self.first_rod)
        in_planes = [edge for edge in joints if self.linkage.joints[edge].kind in IN_PLANES]
        about_points = [edge for edge in joints if self.linkage.joints[edge].kind in ABOUT_POINTS]
        result: list[tuple[set[int], Group]] = []
        for first in in_planes:
            if self.linkage.joints[first].kind == "R" and not any(first in cycle for cycle, _ in result):
                alike = [edge for edge in in_planes if self._is_planar([first, edge])]
                result += [(cycle, "planar") for cycle in self._cycles(alike)]
        for both in combinations(about_points, 2):
            known = any(cycle.issuperset(both) for cycle, _ in result)
            if not known and self.centre(both) is not None:
                alike = [edge for edge in about_points if self.centre([*both, edge]) is not None]
                result += [(cycle, "spherical") for cycle in self._cycles(alike)]
        return result

    def _cycles(self, joints: Sequence[int]) -> list[set[int]]:
        """The joints of each biconnected part that joints alone make."""
        between = [self.between[edge] for edge in joints]
        parts = _core.biconnected_parts(self.linkage.graph.ground, between, between[0][0])
        return [{joints[k] for k in part} for part in parts if len(part) > 2]

    def rows(self, edge: int, group: Group) -> int:
        """How many freedoms of one link against the other an edge takes."""
        if edge >= self.first_rod:
            return 1
        row = self.linkage.joints[edge].row
        if edge in self.spins:
            # the spin of its link about the line of two balls is held
            return FREEDOMS[group] - len(row.freedoms) + 1
        if group == "planar":
            free = sum(
                not (step.freedom == "slide" and step.axis == Z) or len(row.steps) == 1 for step in row.steps
            )
        else:
            free = len(row.freedoms)
        return FREEDOMS[group] - free


def as_one(linkage: Loop, driven: int, link: int) -> int:
    """A link, or what it is one with while a joint of one freedom is held: the ground, if that is one."""
    pair = linkage.graph.between[driven]
    return max(pair) if link in pair and len(linkage.joints[driven].columns) == 1 else link


@once_for(0, by=1)
def order_of(linkage: Loop, column: int) -> Order:
    """The order in which a linkage is solved with one column held; of a single loop that is one block."""
    parts = Parts(linkage)
    driven = linkage.joint_of(column)
    count = linkage.graph.ground
    alone = len(linkage.joints[driven].columns) == 1
    merged = [as_one(linkage, driven, link + 1) - 1 for link in range(count)]
    edges = [edge for edge in range(len(parts.between)) if edge != driven or not alone]
    between = [(merged[parts.between[edge][0]], merged[parts.between[edge][1]]) for edge in edges]
    groups = {edge: group for whole, group in parts.whole for edge in whole}
    ground = merged[count - 1]
    known = [False] * count
    known[ground] = True
    blocks: list[LinkBlock] = []
    pair_of = dict(zip(edges, between, strict=True))

    def solved(piece: Sequence[int], group: Group) -> Order:
        """The blocks of some edges, which are known then; or why they have none."""
        pairs = [pair_of[edge] for edge in piece]
        rows = [parts.rows(edge, group) + (edge == driven) for edge in piece]
        word, result = _core.net_blocks(pairs, rows, known, FREEDOMS[group])
        if word == "free":
            return Order(free=tuple(linkage.link_name(link + 1) for link in result[0][0]))
        if word == "held":
            return Order(held=tuple(parts.names[piece[k]] for k in result[0][1]))
        for links, _ in result:
            for link in links:
                known[link] = True
        return Order(
            tuple(
                _block(parts, links, [piece[k] for k in places], [pairs[k] for k in places], group)
                for links, places in result
            )
        )

    for part in _core.biconnected_parts(count, between, ground):
        numbers = [edges[k] for k in part]
        group = groups[numbers[0]]
        if group == "spatial":
            # cycles in a plane or about a point first, those that hang on others after them
            cycles = parts.cycles_within(numbers, driven)
            for cycle, of in cycles * len(cycles):
                remaining = sorted(cycle.intersection(numbers))
                if remaining and (first := solved(remaining, of).blocks):
                    blocks += first
                    numbers = [edge for edge in numbers if edge not in remaining]
        order = solved(numbers, group)
        if order.free or order.held:
            return order
        blocks += order.blocks
    return Order(tuple(blocks))


def _block(
    parts: Parts, links: list[int], edges: list[int], pairs: list[tuple[int, int]], group: Group
) -> LinkBlock:
    count = parts.first_rod
    joints, rods = [edge for edge in edges if edge < count], [edge - count for edge in edges if edge >= count]
    one_loop = len(edges) == len(links) + 1 and all(
        sum(link in pair for pair in pairs) == 2 for link in links
    )
    simple = all(len(parts.linkage.joints[joint].columns) == 1 for joint in joints)
    if group == "planar" and one_loop and len(links) == 2 and not rods and simple:
        solver: Literal["dyad", "loop", "links"] = "dyad"
    else:
        solver = "loop" if one_loop else "links"
    return LinkBlock(tuple(link + 1 for link in links), tuple(joints), tuple(rods), group, solver)
