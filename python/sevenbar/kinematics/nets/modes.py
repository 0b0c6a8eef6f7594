"""All modes of a net at one value of its input: dyads in closed form, other planar blocks by monodromy.

Source: docs/theory_nets.md, (7) and (10) to (13).
"""

from __future__ import annotations

from typing import cast

import numpy as np

from sevenbar.arrays import Floats, Integers
from sevenbar.errors import NotCoveredError
from sevenbar.kinematics.circuits.modes import Modes
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.kinematics.loop.joints import Y, Z
from sevenbar.kinematics.loop.rigid import inverse, pose
from sevenbar.kinematics.nets.chords import Triple, three
from sevenbar.kinematics.nets.order import LinkBlock, order_of
from sevenbar.kinematics.nets.tree import Tree

#: A dyad as the core takes it, and another planar block.
RawDyad = tuple[Triple, list[tuple[str, Triple]], tuple[int, int], tuple[int | None, int | None]]
RawBlock = tuple[Triple, list[int], list[tuple[str, Triple, Triple, tuple[int | None, int | None]]]]

#: On which of its links a pin in a slot has the slot.
SLOTS = {"K": 0, "L": 1}

#: Where modes meet, poses of a search nearer than this [rad, or relative to the size] are one.
NEAR = 1e-5

#: Most places where modes meet; more are of a curve of poses that all close.
MOST_MEETING = 12


def net_modes(linkage: Loop, column: int, value: float) -> Modes:
    """Every assembly mode at one value of a column [rad, or length] of a net whose blocks are planar.

    Of any other net those that are found from many places, and these besides where some are not certain.
    """
    order = order_of(linkage, column)
    driven = linkage.column_of(column).joint
    tree = Tree(linkage, (driven,), order)
    parts = parts_of(linkage, tree)
    if parts is None:
        return _searched(linkage, tree, column, value)
    scale = 1.0 if linkage.turns(column) else linkage.size
    raw, word = tree.core.modes(parts, tree.columns[driven][0], value / scale)
    frames = [_frames(linkage, tree, poses) for _, poses, _, _ in raw]
    q = np.array([_values(linkage, one) for one in frames]).reshape(-1, len(linkage.columns))
    residual = np.array([error for _, _, error, _ in raw]) * linkage.size
    on_curve = np.array([curved for *_, curved in raw], dtype=bool)
    curve = q[on_curve][0] if on_curve.any() else None
    q, residual = q[~on_curve], residual[~on_curve]
    if word == "searched":
        more = _searched(linkage, tree, column, value)
        curve = more.on_curve if curve is None else curve
        place = _apart(linkage, np.vstack([q, more.q]))
        q, residual = np.vstack([q, more.q])[place], np.append(residual, more.residual)[place]
    elif word == "closed-form" and curve is not None:
        word = "algebraic"
    rank = _ranked(q)
    return Modes(q[rank], residual[rank], word, linkage.columns, value, on_curve=curve)


def _searched(linkage: Loop, tree: Tree, column: int, value: float) -> Modes:
    q, residual, isolated = tree.followed(lambda core: core.searched_modes(column, value))
    singular = _apart(linkage, q[~isolated])
    # a few are where modes meet, many lie on a curve
    is_curve = len(singular) > MOST_MEETING
    others = np.flatnonzero(~isolated)[singular]
    place = np.flatnonzero(isolated) if is_curve else np.append(np.flatnonzero(isolated), others)
    curve = q[others[0]] if is_curve else None
    rank = place[_ranked(q[place])]
    residual = residual[rank] * linkage.size
    return Modes(q[rank], residual, "searched", linkage.columns, value, on_curve=curve)


def _apart(linkage: Loop, q: Floats) -> Integers:
    """Those of modes (m, columns) that are not near one before them."""
    turning, unit = linkage.turning, np.where(linkage.turning, 1.0, linkage.size)
    result: list[int] = []
    for place, one in enumerate(q):
        off = (q[result] - one) / unit
        off = np.where(turning, (off + np.pi) % (2 * np.pi) - np.pi, off)
        if not (np.abs(off) < NEAR).all(axis=1).any():
            result.append(place)
    return np.array(result, dtype=np.int64)


def _ranked(q: Floats) -> Integers:
    """The order of modes (m, columns) by their joint values."""
    order: Integers = np.lexsort(q.round(9).T[::-1])
    return order


def parts_of(linkage: Loop, tree: Tree) -> list[RawDyad | RawBlock] | None:
    """The dyads and other planar blocks that a net is made up of, in the order in which they are solved.

    `None` where there are others, or the driven joint or one of theirs has more than one freedom.
    """
    driven, blocks = tree.first[0], tree.order.blocks
    own = [joint for block in blocks for joint in block.joints]
    # pins in slots close cycles; nothing hangs on one
    simple = all(
        linkage.joints[joint].kind in ("R", "P")
        or (linkage.joints[joint].kind in SLOTS and joint not in tree.columns and joint != driven)
        for joint in (driven, *own)
    )
    if not (blocks and simple and all(block.group == "planar" for block in blocks)):
        return None
    at_ground = linkage.graph.ground in linkage.graph.between[driven]
    return [
        # the held joint may weld one more link to a dyad
        _dyad(linkage, tree, block) if block.solver == "dyad" and at_ground else _block(linkage, tree, block)
        for block in blocks
    ]


def _block(linkage: Loop, tree: Tree, block: LinkBlock) -> RawBlock:
    carrier, between = tree.carrier, linkage.graph.between
    joints: list[tuple[str, Triple, Triple, tuple[int | None, int | None]]] = []
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
    for joint in block.joints:
        if linkage.joints[joint].kind == "R":
            return three(linkage.drawn_joint_on(joint, linkage.graph.between[joint][0])[:3, Z])
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


def _frames(linkage: Loop, tree: Tree, poses: list[tuple[list[list[float]], list[float]]]) -> Floats:
    """The frames (links, 4, 4) of all links, by where each step leads."""
    result = np.broadcast_to(np.eye(4), (linkage.graph.ground, 4, 4)).copy()
    for link, step in tree.carrier.items():
        if step is not None:
            result[link - 1] = pose(*poses[step])
    return result


def _values(linkage: Loop, frames: Floats) -> list[float]:
    """The values of all joints, hinges, slides, pins in slots, by the frames (links, 4, 4) of all links."""
    result = []
    for joint, (before, after) in enumerate(linkage.graph.between):
        on = [frames[link - 1] @ linkage.joint_on(joint, link) for link in (before, after)]
        moved = inverse(on[0]) @ on[1]
        turn = float(np.arctan2(moved[1, 0], moved[0, 0]))
        match linkage.joints[joint].kind:
            case "R":
                result.append(turn)
            case "P":
                result.append(float(moved[2, 3]))
            case "K":
                result += [float(moved[1, 3]), turn]
            case _:
                result += [turn, float(moved[:3, Y] @ moved[:3, 3])]
    return result
