"""Loops of two dyads: a link between ground and body twice, whose body takes wanted poses.

A dyad is a joint at the ground, a link, and a joint at the body. At displacement D_j of the body its link has
the displacement E_j; the joints' values there are those of E_j and of E_j^-1 D_j about their lines in the
first pose, at which all are zero.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import permutations

import numpy as np

from sevenbar.description.draft import Draft
from sevenbar.design.candidates import Claim
from sevenbar.design.exact.answers import ExactAnswer, judged
from sevenbar.design.exact.dyads import Dyad, plain, share_a_line
from sevenbar.design.exact.given import Displacements
from sevenbar.kinematics.loop.rigid import inverse

#: The joints of a loop, in its order.
JOINT_NAMES = ("input", "input_link", "output_link", "output")


def loop(driver: Dyad, follower: Dyad, task: Displacements, name: str, length_unit: str) -> ExactAnswer:
    """The linkage of two dyads, driven by the first of them, with its check; its link 2 is the body."""
    body = task.motions
    joints = [driver.ground, driver.body, follower.body, follower.ground]
    still = np.tile(np.eye(4), (len(body), 1, 1))
    # a joint at the ground counts its link against the ground, the others the later link
    steps = [(still, driver.link), (driver.link, body), (body, follower.link), (still, follower.link)]
    relative = [inverse(before) @ after for before, after in steps]
    columns = [joint.values(motion) for joint, motion in zip(joints, relative, strict=True)]
    size = max(
        float(np.abs(body[:, :3, 3]).max()),
        *(float(np.linalg.norm(a.at - b.at)) for a in joints for b in joints),
    )
    off = np.zeros(len(body))
    for joint, motion, values in zip(joints, relative, columns, strict=True):
        missed = joint.motions(values) - motion
        turned = size * np.abs(missed[:, :3, :3]).max(axis=(1, 2))
        # at the joint, not at the origin of coordinates
        moved = np.abs(missed[:, :3] @ np.append(joint.at, 1.0)).max(axis=1)
        off = np.maximum(off, np.maximum(turned, moved))
    written = [joint.written(own, task.origin) for joint, own in zip(joints, JOINT_NAMES, strict=True)]
    point = {"name": "body", "link": 2, "at": plain(task.origin)}
    draft = Draft.made(name, length_unit, joint=written, point=[point])
    figures = {"closure_error": float(off.max()) / size}
    claim = Claim(columns[0][:, 0], columns[3][:, 0], off, length_unit, figures)
    whole = np.column_stack(columns)
    # with eight freedoms one input leaves another: there are no circuits
    if whole.shape[1] == 8:
        return ExactAnswer(draft, claim, None, draft.linkage.motion().motion_type, whole)
    return judged(draft, claim, whole)


def all_loops(
    dyads: Sequence[Dyad], task: Displacements, name: str, length_unit: str
) -> tuple[ExactAnswer, ...]:
    """Every pair of dyads as a linkage, driven by either; without pairs with a joint's line in common."""
    result: list[ExactAnswer] = []
    for i, j in permutations(range(len(dyads)), 2):
        if not share_a_line(dyads[i], dyads[j]):
            title = f"{name}, dyads {i + 1}, {j + 1}"
            result.append(loop(dyads[i], dyads[j], task, title, length_unit))
    return tuple(result)


def loops_of_pairs(
    dyads: Sequence[Dyad], task: Displacements, name: str, length_unit: str
) -> tuple[ExactAnswer, ...]:
    """Dyads 1 and 2, 3 and 4 .. of a family as a linkage each, driven by either."""
    result: list[ExactAnswer] = []
    for i in range(0, len(dyads) - 1, 2):
        result += all_loops(dyads[i : i + 2], task, f"{name} {i // 2 + 1}", length_unit)
    return tuple(result)


def drawn(dyads: Sequence[Dyad], task: Displacements) -> tuple[Dyad, ...]:
    """The dyads of a task in ground coordinates."""
    return tuple(dyad.counted_from(task.origin) for dyad in dyads)
