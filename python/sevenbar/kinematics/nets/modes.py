"""All modes of a net of dyads at one value of its input, in closed form.

Source: docs/theory_nets.md, (7).
"""

from __future__ import annotations

from typing import Literal, cast

import numpy as np

from sevenbar.arrays import Floats, Integers
from sevenbar.errors import NotCoveredError
from sevenbar.kinematics.circuits.modes import Modes
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.kinematics.loop.rigid import inverse, pose
from sevenbar.kinematics.nets.chords import Triple, three
from sevenbar.kinematics.nets.order import LinkBlock, order_of
from sevenbar.kinematics.nets.tree import Tree

#: A dyad as the core takes it.
RawDyad = tuple[Triple, list[tuple[str, Triple]], tuple[int, int], tuple[int | None, int | None]]


def net_modes(linkage: Loop, column: int, value: float) -> Modes:
    """Every assembly mode at one value of a column [rad, or length] of a net of dyads.

    Of any other net those that are found from many places.
    """
    order = order_of(linkage, column)
    tree = Tree(linkage, (linkage.column_of(column).joint,), order)
    dyads = dyads_of(linkage, tree)
    if dyads is None:
        return _searched(linkage, tree, column, value)
    scale = 1.0 if linkage.turns(column) else linkage.size
    # the driven joint is the first step
    raw = tree.core.modes(dyads, 0, value / scale)
    frames = [_frames(linkage, tree, poses) for _, poses, _, _ in raw]
    q = np.array([_values(linkage, one) for one in frames]).reshape(-1, len(linkage.columns))
    residual = np.array([error for _, _, error, _ in raw]) * linkage.size
    on_curve = np.array([curved for *_, curved in raw], dtype=bool)
    isolated = np.flatnonzero(~on_curve)
    rank = isolated[_ranked(q[isolated])]
    curve = q[on_curve][0] if on_curve.any() else None
    completeness: Literal["closed-form", "algebraic"] = "closed-form" if curve is None else "algebraic"
    return Modes(q[rank], residual[rank], completeness, linkage.columns, value, on_curve=curve)


def _searched(linkage: Loop, tree: Tree, column: int, value: float) -> Modes:
    q, residual = tree.followed(lambda core: core.searched_modes(column, value))
    rank = _ranked(q)
    return Modes(q[rank], residual[rank] * linkage.size, "searched", linkage.columns, value)


def _ranked(q: Floats) -> Integers:
    """The order of modes (m, columns) by their joint values."""
    order: Integers = np.lexsort(q.round(9).T[::-1])
    return order


def dyads_of(linkage: Loop, tree: Tree) -> list[RawDyad] | None:
    """The dyads that a net is made up of, in the order in which they are solved.

    `None` where there are other blocks, or two moving links turn against each other by the input.
    """
    driven, order = tree.first[0], tree.order
    at_ground = linkage.graph.ground in linkage.graph.between[driven]
    if not (at_ground and order.blocks and all(block.solver == "dyad" for block in order.blocks)):
        return None
    return [_dyad(linkage, tree, block) for block in order.blocks]


def _dyad(linkage: Loop, tree: Tree, block: LinkBlock) -> RawDyad:
    first, second = block.links
    between = linkage.graph.between
    inner = next(j for j in block.joints if {*between[j]} == {first, second})
    ends = [next(j for j in block.joints if link in between[j] and j != inner) for link in block.links]
    normal = None
    pairs = []
    for joint in (ends[0], inner, ends[1]):
        frame = linkage.drawn_joint_on(joint, between[joint][0])
        turns = linkage.joints[joint].kind == "R"
        normal = frame[:3, 2] if turns else normal
        pairs.append(("R" if turns else "P", three(frame[:3, 3 if turns else 2])))
    if normal is None:
        raise NotCoveredError(f"net: three slides in a row turn nothing: {_listed(linkage, block)}")
    known = [sum(between[joint]) - link for joint, link in zip(ends, block.links, strict=True)]
    # every moving link has a step
    links = cast("tuple[int, int]", (tree.carrier[first], tree.carrier[second]))
    return three(normal), pairs, links, (tree.carrier[known[0]], tree.carrier[known[1]])


def _listed(linkage: Loop, block: LinkBlock) -> str:
    return ", ".join(linkage.link_name(link) for link in block.links)


def _frames(linkage: Loop, tree: Tree, poses: list[tuple[list[list[float]], list[float]]]) -> Floats:
    """The frames (links, 4, 4) of all links, by where each step leads."""
    result = np.broadcast_to(np.eye(4), (linkage.graph.ground, 4, 4)).copy()
    for link, step in tree.carrier.items():
        if step is not None:
            result[link - 1] = pose(*poses[step])
    return result


def _values(linkage: Loop, frames: Floats) -> list[float]:
    """The value of each joint, a hinge or a slide, by the frames (links, 4, 4) of all links."""
    result = []
    for joint, (before, after) in enumerate(linkage.graph.between):
        on = [frames[link - 1] @ linkage.joint_on(joint, link) for link in (before, after)]
        moved = inverse(on[0]) @ on[1]
        turns = linkage.joints[joint].kind == "R"
        result.append(float(np.arctan2(moved[1, 0], moved[0, 0]) if turns else moved[2, 3]))
    return result
