"""Dyads: a link between a joint at the ground and one at the body, and where it goes with the body."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.kinematics.loop.rigid import axial, turns_about

#: Two lines are one where directions [-] and places, relative to their distance from the others, agree so.
SAME_LINE = 1e-9


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
        result = np.tile(np.eye(4), (len(values), 1, 1))
        slide = np.zeros(len(values)) if self.kind == "R" else values[:, -1]
        if self.kind != "P":
            result[:, :3, :3] = turns_about(self.axis, values[:, 0])
        result[:, :3, 3] = self.at - result[:, :3, :3] @ self.at + slide[:, None] * self.axis
        return result

    def written(self, name: str, origin: Floats) -> dict[str, Any]:
        """The joint as a file has it, whose coordinates count from elsewhere."""
        return {"name": name, "kind": self.kind, "at": plain(self.at + origin), "axis": plain(self.axis)}


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

    def counted_from(self, origin: Floats) -> Dyad:
        """The dyad in coordinates in which what was the origin has this place."""
        link = self.link.copy()
        link[:, :3, 3] += origin - link[:, :3, :3] @ origin
        ground, body = (replace(line, at=line.at + origin) for line in (self.ground, self.body))
        return Dyad(ground, body, link)


def share_a_line(one: Dyad, other: Dyad) -> bool:
    """Whether two dyads have a joint's line in common: their links would be one, or turn about one line."""
    places = [one.ground.at, one.body.at, other.ground.at, other.body.at]
    reach = max(float(np.linalg.norm(a - b)) for a in places for b in places)
    for a, b in ((one.ground, other.ground), (one.body, other.body)):
        if a.kind != b.kind or np.linalg.norm(np.cross(a.axis, b.axis)) > SAME_LINE:
            continue
        if a.kind == "P" or np.linalg.norm(np.cross(a.at - b.at, a.axis)) <= SAME_LINE * reach:
            return True
    return False


def plain(values: Floats) -> list[float]:
    """The numbers as a file has them, without -0."""
    return [float(v) + 0.0 for v in values]
