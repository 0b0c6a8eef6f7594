"""Places on the links of a planar loop by two numbers: along the link and to its left."""

from __future__ import annotations

import math

import numpy as np

from sevenbar.arrays import Floats, triple
from sevenbar.errors import RequestError
from sevenbar.kinematics.circuits.poses import poses
from sevenbar.kinematics.loop.geometry import NO_SIZE, Loop
from sevenbar.kinematics.loop.rigid import cross, inverse, placed, unit
from sevenbar.kinematics.solvers.plane_and_sphere import plane_of


def written_place(loop: Loop, link: int, at: Floats) -> tuple[float, float, float]:
    """A place of a link in the coordinates in which its points are written, from two numbers or from three.

    Of two, (u, v), u goes along the link from its first joint to the next, and v to its left, seen against
    the plane's normal: of a four-bar as of a slider-crank, of rows as of a drawing. Where both joints are at
    one place u goes along the slide. Raises `RequestError` for a loop or a link without that direction.

        >>> import numpy as np
        >>> import sevenbar as sb
        >>> written_place(sb.slider_crank(125, 500), 2, np.array([225.0, 30.0]))
        (350.0, 30.0, 0.0)
        >>> written_place(sb.four_bar(40, 100, 80, 90), 2, np.array([50.0, 30.0]))
        (0.0, 50.0, 30.0)
    """
    if at.size != 2:
        if at.size == 3 and loop.points_by_two:
            raise RequestError(
                "at: three numbers would be a place of the drawing here, and (0, u, v) of a four-bar; "
                "give two, (u, v), as in points: u along the link from its first joint, v to its left"
            )
        return triple("at", at)
    plane = plane_of(loop)
    if plane is None or {*loop.kind} - {*"RP"}:
        raise RequestError(
            "at: 2 numbers; give three, as two are a place on a link of turning and sliding joints in a plane"
        )
    if loop.in_rows and set(loop.kind) == {"R"}:
        return 0.0, float(at[0]), float(at[1])  # as rows have it, of the ground, too
    here, ahead = (loop.drawn_joint_on(joint, link) for joint in loop.graph.joints_of(link))
    # a turn about the normal, or a slide, leaves it as it is
    zero = poses(loop, np.zeros((1, len(loop.columns))))[0, link - 1] @ here
    normal, next_frame = zero[:3, :3].T @ plane.normal, inverse(here) @ ahead
    along = next_frame[:3, 3] - (normal @ next_frame[:3, 3]) * normal
    if math.hypot(*along) <= NO_SIZE * loop.size:
        before, after = (loop.joints[joint] for joint in loop.graph.joints_of(link))
        if "P" not in (before.kind, after.kind):
            raise RequestError(f"at: link {link} has no length, and so no direction; give three numbers")
        # the axis of the last joint of a drawing is reversed in its frame
        axis = -next_frame[:3, 2] if after.backwards else next_frame[:3, 2]
        along = axis if after.kind == "P" else np.array([0.0, 0.0, 1.0])
    along = unit(along)
    place = at[0] * along + at[1] * cross(normal, along)
    # from the frame of the joint that leads to the link
    x, y, z = placed(inverse(loop.point_frames[link - 1]), placed(here, place)) + 0.0
    return float(x), float(y), float(z)
