"""The blocks of a net as the core solves them: dyads, other planar blocks, loops, links in space with legs.

Source: docs/theory_nets.md, (7) and (10) to (22).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import cast

from sevenbar.errors import NotCoveredError
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.kinematics.loop.joints import Y, Z
from sevenbar.kinematics.loop.once import once_for
from sevenbar.kinematics.nets.chords import Triple, joint_rows, rod_row, three
from sevenbar.kinematics.nets.one_loop import RawLoop, one_loop
from sevenbar.kinematics.nets.order import LinkBlock, Parts, as_one
from sevenbar.kinematics.nets.tree import NetParts, RawRow, Tree

#: The steps that carry two links, `None` of the ground.
On = tuple[int | None, int | None]

#: A dyad as the core takes it, another planar block, and a link in space: its steps, the rows of each of its
#: joints and rods, its legs.
RawDyad = tuple[Triple, list[tuple[str, Triple]], tuple[int, int], On]
RawBlock = tuple[Triple, list[int], list[tuple[str, Triple, Triple, On]]]
RawLeg = tuple[list[int], Triple, On]
RawBody = tuple[list[int], list[list[RawRow]], list[RawLeg]]

#: On which of its links a pin in a slot has the slot.
SLOTS = {"K": 0, "L": 1}

#: The joint of a leg at its known link: it leaves the ball of the leg on a circle, a line or a sphere.
FEET = ("R", "P", "U")


#: Any of them.
RawPart = RawDyad | RawBlock | RawBody | RawLoop


@once_for(1)
def parts_of(linkage: Loop, tree: Tree) -> NetParts | None:
    """The blocks of a net in the order in which they are solved.

    `None` where one has no solver, or the driven joint has more than one freedom.
    """
    driven, blocks = tree.first[0], tree.order.blocks
    if not blocks or linkage.joints[driven].kind not in ("R", "P"):
        return None
    parts: list[RawPart] = []
    for block in blocks:
        part: RawPart | None
        if block.group == "planar":
            part = _planar(linkage, tree, block)
        else:
            part = one_loop(linkage, tree, block) or LinkInSpace(linkage, tree, block).raw
        if part is None:
            return None
        parts.append(part)
    return tree.core.parts(parts)


def _planar(linkage: Loop, tree: Tree, block: LinkBlock) -> RawDyad | RawBlock | None:
    driven = tree.first[0]
    # pins in slots close cycles; nothing hangs on one
    simple = all(
        linkage.joints[joint].kind in ("R", "P")
        or (linkage.joints[joint].kind in SLOTS and joint not in tree.columns)
        for joint in block.joints
    )
    if not simple:
        return None
    at_ground = linkage.graph.ground in linkage.graph.between[driven]
    # the held joint may weld one more link to a dyad
    return (
        _dyad(linkage, tree, block) if block.solver == "dyad" and at_ground else _block(linkage, tree, block)
    )


def _block(linkage: Loop, tree: Tree, block: LinkBlock) -> RawBlock:
    carrier, between = tree.carrier, linkage.graph.between
    joints: list[tuple[str, Triple, Triple, On]] = []
    for joint in block.joints:
        a, b = between[joint]
        frame, kind = linkage.drawn_joint_on(joint, a), linkage.joints[joint].kind
        if kind in SLOTS:
            # the link with the slot last
            a, b = (a, b) if SLOTS[kind] == 1 else (b, a)
            place = linkage.drawn_joint_on(joint, a)[:3, 3]
            along = linkage.drawn_joint_on(joint, b)[:3, Y]
            joints.append(("K", three(place), three(along), (carrier[a], carrier[b])))
        else:
            joints.append((kind, three(frame[:3, 3]), three(frame[:3, Z]), (carrier[a], carrier[b])))
    for number in block.rods:
        rod = linkage.rods[number]
        a, b = rod.between
        joints.append(("L", *rod.at, (carrier[a], carrier[b])))
    # every moving link has a step
    links = [cast("int", carrier[link]) for link in block.links]
    return _normal(linkage, block), links, joints


def _normal(linkage: Loop, block: LinkBlock) -> Triple:
    """The direction about which the links of a planar block turn."""
    hinge = next((joint for joint in block.joints if linkage.joints[joint].kind == "R"), None)
    if hinge is None and block.solver != "dyad":
        # slides that rods hold have it from another hinge of their part
        whole = next(edges for edges, _ in Parts(linkage).whole if block.joints[0] in edges)
        joints = (edge for edge in whole if edge in linkage.graph.joints)
        hinge = next((joint for joint in joints if linkage.joints[joint].kind == "R"), None)
    if hinge is not None:
        return three(linkage.drawn_joint_on(hinge, linkage.graph.between[hinge][0])[:3, Z])
    raise NotCoveredError(f"net: three slides in a row turn nothing: {_listed(linkage, block)}")


def _dyad(linkage: Loop, tree: Tree, block: LinkBlock) -> RawDyad:
    first, second = block.links
    between = linkage.graph.between
    inner = next(j for j in block.joints if {*between[j]} == {first, second})
    ends = [next(j for j in block.joints if link in between[j] and j != inner) for link in block.links]
    pairs = []
    for joint in (ends[0], inner, ends[1]):
        frame = linkage.drawn_joint_on(joint, between[joint][0])
        turns = linkage.joints[joint].kind == "R"
        pairs.append(("R" if turns else "P", three(frame[:3, 3 if turns else 2])))
    known = [sum(between[joint]) - link for joint, link in zip(ends, block.links, strict=True)]
    # every moving link has a step
    links = cast("tuple[int, int]", (tree.carrier[first], tree.carrier[second]))
    return _normal(linkage, block), pairs, links, (tree.carrier[known[0]], tree.carrier[known[1]])


def _listed(linkage: Loop, block: LinkBlock) -> str:
    return ", ".join(linkage.link_name(link) for link in block.links)


@dataclass(frozen=True)
class LinkInSpace:
    """A block in space as one link that joints, rods and legs hold at known links."""

    linkage: Loop
    tree: Tree
    block: LinkBlock

    @property
    def raw(self) -> RawBody | None:
        """The block as the core takes it; `None` where it is no such link."""
        for body in self.block.links:
            legs = [self._leg(link, body) for link in self.block.links if link != body]
            if all(legs) and (steps := self._steps(body)):
                standing = [leg for leg in legs if leg is not None]
                solved = {self._hinge(body)} | {joint for joints, _ in standing for joint in joints}
                rows = [self._rows(joint) for joint in self.block.joints if joint not in solved]
                rods = [self.linkage.rods[number] for number in self.block.rods]
                rows += [[self.tree.raw_row(rod.between, rod_row(rod))] for rod in rods]
                return steps, rows, [leg for _, leg in standing]
        return None

    def _one(self, link: int) -> int:
        """The link with what the held joint welds to it."""
        return as_one(self.linkage, self.tree.first[0], link)

    def _on(self, joint: int) -> tuple[int, int]:
        a, b = self.linkage.graph.between[joint]
        return self._one(a), self._one(b)

    def _steps(self, body: int) -> list[int]:
        """The steps that carry the link; none where another block's joint does."""
        links = [link for link in self.tree.carrier if self._one(link) == body]
        for joint in self.block.joints:
            steps = sorted(self.tree.columns.get(joint, []))
            if steps and steps[-1] in [self.tree.carrier[link] for link in links] and body in self._on(joint):
                return steps
        apart = (link for link in self.linkage.graph.apart if link in links)
        return next(map(self.tree.steps_apart, apart), [])

    def _hinge(self, body: int) -> int | None:
        """The joint of one freedom that carries the link from a known one, whose rows its step fulfils."""
        for joint in self.block.joints:
            known = sum(self._on(joint)) - body
            if (
                body in self._on(joint)
                and known not in self.block.links
                and self.linkage.joints[joint].kind in ("R", "P")
                and sorted(self.tree.columns.get(joint, [])) == self._steps(body)
            ):
                return joint
        return None

    def _leg(self, link: int, body: int) -> tuple[list[int], RawLeg] | None:
        """A leg of the link `body`: its two joints, and what the core takes; `None` where a link is none."""
        ends = [joint for joint in self.block.joints if link in self._on(joint)]
        rods = [self.linkage.rods[number].between for number in self.block.rods]
        if len(ends) != 2 or any(link in map(self._one, between) for between in rods):
            return None
        foot, ball = sorted(ends, key=lambda joint: self.linkage.joints[joint].row.is_ball)
        steps = sorted(self.tree.columns.get(foot, []))
        from_known = sum(self._on(foot)) - link not in self.block.links
        hangs = sum(self._on(ball)) - link == body and self.linkage.joints[ball].row.is_ball
        kinds = self.linkage.joints[foot].kind in FEET
        before, after = self.linkage.graph.between[ball]
        if self._one(before) != link:
            before, after = after, before
        carried = steps and steps[-1] in [self.tree.carrier[end] for end in self.linkage.graph.between[foot]]
        if not (from_known and hangs and kinds and carried):
            return None
        place = three(self.linkage.drawn_joint_on(ball, before)[:3, 3])
        return ends, (steps, place, (self.tree.carrier[before], self.tree.carrier[after]))

    def _rows(self, joint: int) -> list[RawRow]:
        between = self.linkage.graph.between[joint]
        frames = (self.linkage.drawn_joint_on(joint, link) for link in between)
        rows = joint_rows(self.linkage.joints[joint], *frames)
        return [self.tree.raw_row(between, row) for row in rows]
