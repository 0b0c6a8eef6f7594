"""A linkage as drawn, apart from Sevenbar's own values: joints with kinds, places and axes, in loop order.

Numbers count as they are drawn: c_i is how joint i has moved the link after it against the link before it.
A drawing counts d_i = c_i, but of its last joint d_n = -c_n.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

import sevenbar as sb
from sevenbar.arrays import Floats
from sevenbar.kinematics.linkage import Linkage


@dataclass(frozen=True, eq=False)
class Joint:
    """A joint: its kind, its place (3,), its axis (3,) or both (2, 3) of a U, the pitch of a screw."""

    name: str
    kind: str
    at: Floats
    axes: Floats | None = None
    pitch: float | None = None

    def table(self) -> dict[str, Any]:
        """The joint as `sb.from_axes` takes it."""
        found: dict[str, Any] = {"name": self.name, "kind": self.kind, "at": self.at.tolist()}
        if self.axes is not None:
            key = "axes" if self.kind == "U" else "axis"
            found[key] = self.axes.tolist()
        if self.pitch is not None:
            found["pitch"] = self.pitch
        return found

    def reversed(self) -> Joint:
        """The same joint with its axis the other way: its value changes sign."""
        return self if self.axes is None or self.kind == "U" else replace(self, axes=-self.axes)


@dataclass(frozen=True, eq=False)
class Drawing:
    """The joints of a loop, with the names of those that are input and output."""

    name: str
    joints: tuple[Joint, ...]
    input: str
    output: str

    @property
    def size(self) -> float:
        """The greatest distance of two joints [length]; 1 where all are in one place."""
        at = np.array([joint.at for joint in self.joints])
        return float(np.linalg.norm(at[:, None] - at, axis=2).max()) or 1.0

    def linkage(self) -> Linkage:
        """The linkage as Sevenbar reads it."""
        return sb.from_axes([joint.table() for joint in self.joints], name=self.name)


def drawing(name: str, *joints: tuple[Any, ...]) -> Drawing:
    """A drawing from kind and place of each joint, then perhaps its axis, or both axes, and its pitch."""
    made = []
    for i, (kind, at, *more) in enumerate(joints):
        axes = np.array(more[0], dtype=float) if more else None
        pitch = float(more[1]) if len(more) > 1 else None
        made.append(Joint(f"j{i + 1}", kind, np.array(at, dtype=float), axes, pitch))
    return Drawing(name, tuple(made), "j1", f"j{len(made)}")


def redrawn(linkage: Linkage, row: int) -> Drawing:
    """A linkage without universal joints as drawn at a row of its first circuit."""
    from sevenbar.kinematics.circuits.poses import joint_frames, poses_along

    circuit = linkage.motion(36).circuits[0]
    before, _ = joint_frames(linkage, poses_along(linkage, circuit, np.array([row])))
    made = []
    for joint, frame in zip(linkage.joints, before[0], strict=True):
        axis = (frame[:3, 2].copy(),) if joint.kind != "S" else ()
        made.append((joint.kind, frame[:3, 3].copy(), *axis, *((joint.pitch,) if joint.kind == "H" else ())))
    return drawing(f"{linkage.name}, drawn at row {row}", *made)
