"""Places on the links of a planar loop by two numbers: along the link and to its left."""

from __future__ import annotations

import math

import numpy as np

from sevenbar.arrays import Floats, triple
from sevenbar.errors import RequestError
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
    # a turn about the normal, or a slide, leaves it as it is
    normal = loop.base[:3, :3].T @ plane.normal
    for before in loop.transforms[: link - 1]:
        normal = before[:3, :3].T @ normal
    next_frame = loop.drawn_transforms[link - 1]
    along = next_frame[:3, 3] - (normal @ next_frame[:3, 3]) * normal
    if math.hypot(*along) <= NO_SIZE * loop.size:
        after = loop.joints[link % len(loop.joints)]
        if "P" not in (loop.joints[link - 1].kind, after.kind):
            raise RequestError(f"at: link {link} has no length, and so no direction; give three numbers")
        # the axis of the last joint of a drawing is reversed in its frame
        ahead = -next_frame[:3, 2] if after.backwards else next_frame[:3, 2]
        along = ahead if after.kind == "P" else np.array([0.0, 0.0, 1.0])
    along = unit(along)
    place = at[0] * along + at[1] * cross(normal, along)
    if link == len(loop.joints):
        # the ground's own frame is that of the report
        place = placed(loop.drawn_ground, place)
    x, y, z = placed(inverse(loop.point_frames[link - 1]), place) + 0.0
    return float(x), float(y), float(z)
