"""Denavit-Hartenberg rows of a drawing, by common normals, which Sevenbar itself never computes."""

from __future__ import annotations

import math

import numpy as np

import sevenbar as sb
from evidence.rewritten.drawing import Drawing
from sevenbar.arrays import Floats
from sevenbar.kinematics.linkage import Linkage

#: The sine of the angle of two axes below which they are parallel.
PARALLEL = 1e-12

#: A length below this share of the size is rounding of 0.
MEET = 1e-12


def as_rows(one: Drawing) -> tuple[Linkage, list[float]] | None:
    """The loop as rows, and each joint's variable where it is drawn; `None` for joints that rows lack."""
    joints = one.joints
    if any(joint.kind not in "RPH" for joint in joints):
        return None
    count = len(joints)
    places = np.array([joint.at for joint in joints])
    axes = np.array([joint.axes / np.linalg.norm(joint.axes) for joint in joints])  # type: ignore[operator]
    normals, ends, starts = np.empty((count, 3)), np.empty((count, 3)), np.empty((count, 3))
    for i in range(count):
        then = (i + 1) % count
        normals[i], ends[i], starts[then] = _normal(places[i], axes[i], places[then], axes[then], one.size)
    rows: dict[str, list[float | None]] = {key: [] for key in ("length", "twist", "offset", "angle", "pitch")}
    zeros = []
    for i, joint in enumerate(joints):
        then, before = (i + 1) % count, normals[i - 1]
        z, x = axes[i], normals[i]
        angle = math.atan2(float(np.cross(before, x) @ z), float(before @ x))
        offset, length = (
            float(value) if abs(value) > MEET * one.size else 0.0
            for value in ((ends[i] - starts[i]) @ z, (starts[then] - ends[i]) @ x)
        )
        rows["length"].append(length)
        rows["twist"].append(math.atan2(float(np.cross(z, axes[then]) @ x), float(z @ axes[then])))
        slides = joint.kind == "P"
        rows["offset"].append(None if slides else offset)
        rows["angle"].append(angle if slides else None)
        rows["pitch"].append(joint.pitch)
        zeros.append(offset if slides else angle)
        if joint.kind == "H":
            # the offset of a screw is its value at theta = 0
            assert joint.pitch is not None
            rows["offset"][-1] = offset - joint.pitch * angle / math.tau
    kinds = "".join(joint.kind for joint in joints)
    return sb.from_dh(kinds, **rows, name=one.name), zeros  # type: ignore[arg-type]


def _normal(p: Floats, a: Floats, q: Floats, b: Floats, size: float) -> tuple[Floats, Floats, Floats]:
    """The direction of the common normal of two axes, and its ends on them."""
    across = np.cross(a, b)
    sine = float(np.linalg.norm(across))
    apart = q - p
    if sine < PARALLEL:
        direct = apart - (apart @ a) * a
        length = float(np.linalg.norm(direct))
        if length > MEET * size:
            return direct / length, p, p + direct
        x = np.cross(a, np.eye(3)[np.abs(a).argmin()])
        return x / np.linalg.norm(x), p, p
    x = across / sine
    # p + s a + t x = q + u b
    s, _, u = np.linalg.solve(np.column_stack([a, x, -b]), apart)
    start, end = p + s * a, q + u * b
    return x, start, end
