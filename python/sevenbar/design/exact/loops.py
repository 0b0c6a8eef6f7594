"""Loops of two dyads: a link between ground and body twice, whose body takes wanted poses.

A dyad is a joint at the ground, a link, and a joint at the body. At displacement D_j of the body its link has
the displacement E_j; the joints' values there are those of E_j and of E_j^-1 D_j about their lines in the
first pose, at which all are zero.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.description.draft import Draft
from sevenbar.design.exact.answers import ExactAnswer, judged
from sevenbar.design.exact.given import Displacements
from sevenbar.design.synthesis.candidates import Claim
from sevenbar.kinematics.rigid import axial, inverse

#: Two lines are one where directions [-] and places, relative to their distance from the others, agree so.
SAME_LINE = 1e-9

#: The joints of a loop, in its order.
JOINT_NAMES = ("input", "input_link", "output_link", "output")


@dataclass(frozen=True, eq=False)
class Line:
    """A joint in the first pose: its letter, a place on its line and the line's direction, of length 1."""

    kind: str
    at: Floats
    axis: Floats

    def values(self, motions: Floats) -> Floats:
        """The joint's columns (n, freedoms) at relative motions (n, 4, 4) of what it connects."""
        turns = motions[:, :3, :3]
        angle = np.arctan2(axial(turns) @ self.axis, (np.trace(turns, axis1=1, axis2=2) - 1) / 2)
        slide = (motions[:, :3, :3] @ self.at + motions[:, :3, 3] - self.at) @ self.axis
        return np.column_stack({"R": [angle], "P": [slide], "C": [angle, slide]}[self.kind])

    def motions(self, values: Floats) -> Floats:
        """The relative motions (n, 4, 4) at columns (n, freedoms)."""
        found = np.tile(np.eye(4), (len(values), 1, 1))
        slide = np.zeros(len(values)) if self.kind == "R" else values[:, -1]
        if self.kind != "P":
            found[:, :3, :3] = turns_about(self.axis, values[:, 0])
        found[:, :3, 3] = self.at - found[:, :3, :3] @ self.at + slide[:, None] * self.axis
        return found

    def written(self, name: str, origin: Floats) -> dict[str, Any]:
        """The joint as a file has it, whose coordinates count from elsewhere."""
        return {"name": name, "kind": self.kind, "at": _plain(self.at + origin), "axis": _plain(self.axis)}


@dataclass(frozen=True, eq=False)
class Dyad:
    """A link between a joint at the ground and one at the body, and its displacements `link` (n, 4, 4)."""

    ground: Line
    body: Line
    link: Floats

    @property
    def kind(self) -> str:
        """The letters of its joints, from the ground: "RR"."""
        return self.ground.kind + self.body.kind


def turns_about(axis: Floats, angles: Floats) -> Floats:
    """The rotations (n, 3, 3) about a direction (3,) of length 1 by angles (n,) [rad] (Rodrigues)."""
    x, y, z = axis
    tilde = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    sines, versed = np.sin(angles)[:, None, None], (1 - np.cos(angles))[:, None, None]
    return np.asarray(np.eye(3) + sines * tilde + versed * (tilde @ tilde))


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
    raw = {
        "format": 1,
        "name": name,
        "length_unit": length_unit,
        "angle_unit": "deg",
        "joint": [joint.written(own, task.origin) for joint, own in zip(joints, JOINT_NAMES, strict=True)],
        "point": [{"name": "body", "link": 2, "at": _plain(task.origin)}],
    }
    figures = {"closure_error": float(off.max()) / size}
    claim = Claim(columns[0][:, 0], columns[3][:, 0], off, length_unit, figures)
    whole, draft = np.column_stack(columns), Draft("", raw, name)
    # with eight freedoms one input leaves another: there are no circuits
    return ExactAnswer(draft, claim, None) if whole.shape[1] == 8 else judged(draft, claim, whole)


def all_loops(
    dyads: Sequence[Dyad], task: Displacements, name: str, length_unit: str
) -> tuple[ExactAnswer, ...]:
    """Every pair of dyads as a linkage, driven by either; without pairs with a joint's line in common."""
    found: list[ExactAnswer] = []
    for i, driver in enumerate(dyads):
        for j, follower in enumerate(dyads):
            if i != j and not _share(driver, follower):
                title = f"{name}, dyads {i + 1} and {j + 1}"
                found.append(loop(driver, follower, task, title, length_unit))
    return tuple(found)


def loops_of_pairs(
    dyads: Sequence[Dyad], task: Displacements, name: str, length_unit: str
) -> tuple[ExactAnswer, ...]:
    """Dyads 1 and 2, 3 and 4 .. of a family as a linkage each, driven by either."""
    found: list[ExactAnswer] = []
    for i in range(0, len(dyads) - 1, 2):
        found += all_loops(dyads[i : i + 2], task, f"{name} {i // 2 + 1}", length_unit)
    return tuple(found)


def _share(one: Dyad, other: Dyad) -> bool:
    """Whether two dyads have a joint's line in common: their links would be one, or turn about one line."""
    places = [one.ground.at, one.body.at, other.ground.at, other.body.at]
    reach = max(float(np.linalg.norm(a - b)) for a in places for b in places)
    for a, b in ((one.ground, other.ground), (one.body, other.body)):
        if a.kind != b.kind or np.linalg.norm(np.cross(a.axis, b.axis)) > SAME_LINE:
            continue
        if a.kind == "P" or np.linalg.norm(np.cross(a.at - b.at, a.axis)) <= SAME_LINE * reach:
            return True
    return False


def _plain(values: Floats) -> list[float]:
    return [float(v) + 0.0 for v in values]
