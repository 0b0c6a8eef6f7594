"""What the drawn pose of a net is: like others, a dead centre of its input, a change point, nearly movable.

Every link has a twist (w, v), v that of the origin. A joint lets the links after and before it differ by its
steps alone, and a rod keeps its length:

    T_b - T_a in span J,   J = (z, o x z) of a turn, (0, z) of a slide, (z, o x z + h z) of a screw
    d . (v_a + w_a x x_a - v_b - w_b x x_b) = 0,   d from one end of the rod to the other               (1)

With N freedoms, spins among them, (1) leaves N twists free at a pose like others.

Source: docs/theory_nets.md, (3) and (5).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.kinematics.loop.geometry import Loop

#: Singular values below this share of the greatest are zero, as in the core.
NO_RANK = 1e-8

#: A rigid net nearly moves where the least singular value is below this share of the next one: its joints
#: then miss by some per cent of the motion, as those of rounded or mistyped numbers do.
NEARLY = 0.1

#: A joint that moves by less than this share of the others rests.
STILL = 1e-6


@dataclass(frozen=True)
class Nearly:
    """How a rigid net nearly moves: `where` opens by so much [length] a rad of the input, or a length."""

    where: str
    opens: float


@dataclass(frozen=True)
class DrawnPose:
    """What the drawn pose is; `others` are joints that move at a dead centre of the input."""

    word: Literal["regular", "dead-centre", "change-point", "shaky", "rigid"]
    others: tuple[str, ...] = ()
    nearly: Nearly | None = None


def drawn_pose(linkage: Loop, column: int, freedoms: int) -> DrawnPose:
    """What the drawn pose of a net is for an input; `freedoms` are those of the net, spins among them."""
    rows, names = _constraints(linkage)
    _, values, vectors = np.linalg.svd(rows)
    rank = int((values > NO_RANK * values.max(initial=0.0)).sum())
    free = vectors[rank:].reshape(-1, linkage.graph.ground - 1, 6)
    if freedoms == 0:
        return (
            DrawnPose("shaky")
            if len(free)
            else DrawnPose("rigid", nearly=_nearly(linkage, column, rows, names))
        )
    if len(free) > freedoms:
        return DrawnPose("change-point")
    rates = [np.abs(_rates(linkage, joint, free)).max(axis=0) for joint in linkage.graph.joints]
    driven = linkage.joint_of(column)
    place = column - linkage.places[driven].start
    if rates[driven][place] > STILL * max(rate.max() for rate in rates):
        return DrawnPose("regular")
    others = (
        one.name
        for one, rate in zip(linkage.joints, rates, strict=True)
        if len(rate) == 1 and rate[0] > STILL * max(rate.max() for rate in rates)
    )
    return DrawnPose("dead-centre", tuple(others))


def _nearly(linkage: Loop, column: int, rows: Floats, names: list[str]) -> Nearly | None:
    """How a rigid net nearly moves, where one motion of all links is much freer than the others.

    The joint or rod that opens least where all others hold.
    """
    values = np.linalg.svd(rows, compute_uv=False)
    if len(values) < 2 or values[-1] > NEARLY * values[-2]:
        return None
    driven = linkage.joint_of(column)
    place = column - linkage.places[driven].start
    openings = []
    for name in dict.fromkeys(names):
        opened = np.array([one == name for one in names])
        if name == linkage.joints[driven].name:
            continue
        _, values, vectors = np.linalg.svd(rows[~opened])
        free = vectors[int((values > NO_RANK * values[0]).sum()) :]
        rates = _rates(linkage, driven, free.reshape(len(free), -1, 6))[:, place]
        if np.abs(rates).max(initial=0.0) > STILL:
            # the least opening, all free motions taken together, at one rad of the input
            least = 1.0 / np.linalg.norm(np.linalg.pinv((rows[opened] @ free.T).T) @ rates)
            openings.append(Nearly(name, float(least * linkage.size)))
    return min(openings, key=lambda one: one.opens, default=None)


def _steps(linkage: Loop, joint: int) -> Floats:
    """The screws (k, 6) of a joint's steps where it is drawn, lengths relative to the size."""
    moved = linkage.joints[joint]
    frames = [linkage.drawn_joint_on(joint, link) for link in linkage.graph.between[joint]]
    screws = []
    for step in moved.row.steps:
        if step.driven:
            continue
        frame = frames[1] if step.tilted else frames[0]
        axis, place = frame[:3, step.axis], frame[:3, 3] / linkage.size
        if step.freedom == "slide":
            screws.append([0.0, 0.0, 0.0, *axis])
        else:
            advance = moved.advance / linkage.size if moved.row.is_screw else 0.0
            screws.append([*axis, *(np.cross(place, axis) + advance * axis)])
    return np.array(screws)


def _constraints(linkage: Loop) -> tuple[Floats, list[str]]:
    """The rows of (1) on the twists of all moving links, and whose each is."""
    moving = linkage.graph.ground - 1
    rows, names = [], []
    for joint, between in enumerate(linkage.graph.between):
        # what is no step of the joint, about its own place: forces there, then moments
        place = linkage.drawn_joint_on(joint, between[0])[:3, 3] / linkage.size
        here = _about(place)
        steps = _steps(linkage, joint) @ here.T
        _, values, vectors = np.linalg.svd(steps)
        kept = vectors[int((values > NO_RANK).sum()) :] @ here
        rows += [_on_links(row, between, moving) for row in kept]
        names += [linkage.joints[joint].name] * len(kept)
    for rod in linkage.rods:
        ends = np.array(rod.at) / linkage.size
        line = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
        # both ends have one wrench, for it acts along their line
        rows.append(_on_links(np.concatenate([np.cross(ends[0], line), line]), rod.between, moving))
        names.append(rod.name)
    return np.array(rows), names


def _about(place: Floats) -> Floats:
    """What makes the twist of a place of that of the origin (6, 6)."""
    x, y, z = place
    result = np.eye(6)
    result[3:, :3] = [[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]]
    return result


def _on_links(row: Floats, between: tuple[int, int], moving: int) -> Floats:
    """A row on how two links differ, as one on all."""
    result = np.zeros((moving, 6))
    for link, sign in zip(between, (-1.0, 1.0), strict=True):
        if link <= moving:
            result[link - 1] += sign * row
    return result.ravel()


def _rates(linkage: Loop, joint: int, twists: Floats) -> Floats:
    """How the steps of a joint move (n, k) where all links move by twists (n, links, 6)."""
    grounded = np.concatenate([twists, np.zeros((len(twists), 1, 6))], axis=1)
    before, after = (grounded[:, link - 1] for link in linkage.graph.between[joint])
    rates: Floats = (after - before) @ np.linalg.pinv(_steps(linkage, joint))
    return rates
