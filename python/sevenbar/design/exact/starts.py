"""Starts of a design task that theory gives: planar four-bars whose coupler takes its poses exactly."""

from __future__ import annotations

import math

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.design.exact.given import planar_given
from sevenbar.design.exact.planar import planar_dyads
from sevenbar.design.task import DesignTask, PoseWant
from sevenbar.design.task.task import linkage_size
from sevenbar.errors import RequestError
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.numbers.dimensions import Dimension

#: Dyads that are drawn, and how many of each side are kept where none lie within the bounds.
DYADS, NEAREST = 512, 16

#: The two coordinates of a plane, by the axis square to it.
PLANES = {0: (1, 2), 1: (2, 0), 2: (0, 1)}

#: A pose leaves its plane, and a dyad its bounds, by more [rad, or relative to the size].
OFF = 1e-9


def exact_starts(task: DesignTask, count: int, seed: int = 0) -> list[Floats]:
    """Up to `count` values (k,) of the free numbers with which the coupler takes the poses wanted of it.

    They are pairs of Burmester's dyads, drawn by a seed, within the bounds as far as there are any: starts
    that `designed(task, given=..)` takes. None for other loops than a drawn planar four-bar, for other wants,
    for more than five poses with the drawn one, and where the linkage may stand anywhere.

    Source: docs/theory_design.md, (31).
    """
    linkage = task.draft.linkage
    numbers = {d.name: d for d in task.draft.dimensions}
    axis = _axis(linkage, numbers)
    wants = [w for w in task.wants if isinstance(w, PoseWant) and w.link == 2]
    if axis is None or not wants or task.placement != "fixed" or count < 1:
        return []
    rows = _planar_rows(wants[0].poses, axis, linkage_size(linkage))
    try:
        dyads = [] if rows is None else planar_dyads(planar_given(rows, 3, 5), DYADS, seed)
    except RequestError:
        return []
    turning = [np.concatenate([d.ground.at[:2], d.body.at[:2]]) for d in dyads if d.kind == "RR"]
    if len(turning) < 2:
        return []
    bounds = {name: (d.value, d.value) for name, d in numbers.items()}
    bounds |= {one.name: (one.low, one.high) for one in task.free}
    ends, names = np.array(turning), ["xyz"[k] for k in PLANES[axis]]
    graph = linkage.graph
    pairs = [(joint, *graph.others_of(graph.moving_link(joint), joint)) for joint in graph.standing]
    sides = []
    for pair in pairs:
        own = [f"{linkage.joints[joint].name}.{name}" for joint in pair for name in names]
        low, high = np.array([bounds[name] for name in own]).T
        off = np.maximum(np.maximum(low - ends, ends - high), 0.0).max(axis=1) / linkage_size(linkage)
        within = np.flatnonzero(off <= OFF)
        sides.append((own, within if within.size else np.argsort(off)[:NEAREST]))
    random = np.random.default_rng([seed, 2])
    result: list[Floats] = []
    for _ in range(4 * count):
        chosen = [(own, int(random.choice(selected))) for own, selected in sides]
        if chosen[0][1] != chosen[1][1] and len(result) < count:
            put = {name: value for own, i in chosen for name, value in zip(own, ends[i], strict=True)}
            values = np.array([put.get(name, numbers[name].value) for name in task.names])
            result.append(np.clip(values, task.low, task.high))
    return result


def _axis(linkage: Linkage, numbers: dict[str, Dimension]) -> int | None:
    """The axis of coordinates along which all joints of a drawn planar four-bar turn; `None` for others."""
    joints = linkage.joints
    if linkage.form != "drawn" or [joint.kind for joint in joints] != list("RRRR"):
        return None
    ways = [[numbers.get(f"{joint.name}.axis_{name}") for name in "xyz"] for joint in joints]
    axes = np.array([[one.value if one else math.nan for one in way] for way in ways])
    if not np.isfinite(axes).all() or any(
        d.unit != linkage.length_unit for d in numbers.values() if d.kind == "length"
    ):
        return None
    axis = int(np.abs(axes[0]).argmax())
    across = np.abs(np.delete(axes, axis, axis=1)).max()
    return axis if across <= OFF * np.abs(axes[:, axis]).min() else None


def _planar_rows(poses: Floats, axis: int, size: float) -> Floats | None:
    """The drawn pose and the poses of the coupler as rows u, v, angle; `None` where they leave the plane."""
    u, v = PLANES[axis]
    rows = [np.zeros(3)]
    for pose in poses:
        tilted = max(abs(pose[axis, axis] - 1.0), abs(pose[u, axis]), abs(pose[v, axis]))
        if tilted > OFF or abs(pose[axis, 3]) > OFF * size:
            return None
        row = np.array([pose[u, 3], pose[v, 3], math.atan2(pose[v, u], pose[u, u])])
        if all(np.abs(row - other).max() > OFF for other in rows):
            rows.append(row)
    return np.array(rows)
