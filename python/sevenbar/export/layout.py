"""Where hubs sit along their axes: places a joint may have without any effect on the motion.

They are chosen so that links overlap as little as can be found, in several poses of the circuit. A loop whose
links must cross, as those of many overconstrained ones, keeps overlaps.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.drawing.joint_shapes import Seat, shape_of
from sevenbar.export.parts import Assembly, Ball, Bar, Solid, assemble, hub_height
from sevenbar.export.pose import Pose
from sevenbar.kinematics.loop.rods import rod_distance

#: Sweeps over all joints; most layouts no longer change after two.
SWEEPS = 4
#: What a shift of one hub's height costs, beside the squared overlap in heights of a hub.
SHIFT_COST = 0.03


def arrange(pose: Pose) -> Assembly:
    """The parts of a linkage in a pose, seated with the least overlap found."""
    unit = hub_height(pose)
    shapes = [shape_of(joint.row) for joint in pose.linkage.joints]
    # by turns above and below, as in a plane linkage of two layers
    seats = tuple(Seat(side=1 if i % 2 == 0 else -1) for i in range(len(shapes)))

    @cache
    def cost(seats: tuple[Seat, ...]) -> float:
        moved = sum(abs(s.shift) + abs(s.aside[0]) + abs(s.aside[1]) for s in seats)
        return _overlap(assemble(pose, seats, unit)) + SHIFT_COST * moved

    for _ in range(SWEEPS):
        start = seats
        for i, shape in enumerate(shapes):
            tried = [(*seats[:i], seat, *seats[i + 1 :]) for seat in shape.seats]
            # min keeps the first of equals: what is seated already stays
            seats = min([seats, *tried], key=cost)
        if seats == start:
            break
    return assemble(pose, seats, unit)


def _overlap(assembly: Assembly) -> float:
    """The squared depth of all overlaps of unlike links [heights of a hub, summed over poses]."""
    pose, unit = assembly.pose, assembly.unit
    solids = [(part.body, *_segment(s)) for part in assembly.parts for s in part.add]
    selected = zip(*(solid for solid in solids if solid[0] < len(pose.frames)), strict=True)
    body, starts, ends, radii = map(np.array, selected)
    one, two = np.triu_indices(len(body), 1)
    unlike = body[one] != body[two]
    one, two = one[unlike], two[unlike]
    reach = (radii[one] + radii[two]) / unit
    # all poses at once, (poses, pairs): one after another took most of the time of an export
    frames = np.stack([pose.frames, *pose.others])[:, body, :3]
    a, b = (np.einsum("pkij,kj->pki", frames[..., :3], at) + frames[..., 3] for at in (starts, ends))
    lines = (at[:, pair].reshape(-1, 3) for pair in (one, two) for at in (a, b))
    depth = np.maximum(reach - rod_distance(*lines).reshape(len(frames), -1) / unit, 0.0)
    squares: list[float] = (depth**2).sum(axis=1).tolist()
    return sum(squares) / len(frames)


def _segment(solid: Solid) -> tuple[Floats, Floats, float]:
    """The ends of the line of a solid, and its radius about it."""
    if isinstance(solid, Ball):
        return solid.centre, solid.centre, solid.radius
    return solid.start, solid.end, 0.6 * solid.width if isinstance(solid, Bar) else solid.radius
