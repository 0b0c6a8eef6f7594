"""How far a ball or universal joint is bent: the angle between a direction of each of its two links.

With u the seat, a direction of the link before, v the stud, one of the link after, and R the rotation of the
joint, both seen from the frame before it,

    cos(angle) = u . R v                                                                                 (12)

Source: docs/theory_measures.md, (12).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import Floats
from sevenbar.curves.least_cone import angles
from sevenbar.errors import RequestError, no_joint, shown
from sevenbar.kinematics.dynamics.link_bodies import joint_places
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.kinematics.loop.rigid import about, inverse, unit
from sevenbar.kinematics.loop.stops import direction

#: Sine of the angle of two lines below which it has a kink: its slopes are known to half the digits there.
KINK = 1e-9

#: A rod shorter than this part of the size has no direction.
NO_LENGTH = 1e-9


@dataclass(frozen=True, eq=False)
class BallAngle:
    """The angle between the seat and the stud of a ball or universal joint, from the values of its columns.

    `seat` (3,) in the frame before the joint, `stud` (3,) in that after it; `own` are the joint's columns
    among all. `turns` are its turns in loop order: the fixed rotation (3, 3) before each, and its axis.
    """

    joint: str
    own: slice
    seat: Floats
    stud: Floats
    turns: tuple[tuple[Floats, int], ...]

    def rotation(self, q: Floats) -> Floats:
        """The rotations (n, 3, 3) of the link after against the link before at poses (n, columns)."""
        now: Floats = np.broadcast_to(np.eye(3), (len(q), 3, 3))
        for k, (fixed, axis) in enumerate(self.turns):
            now = now @ fixed @ about(axis, q[:, self.own.start + k])
        return now

    def studs(self, q: Floats) -> Floats:
        """The stud's directions (n, 3) in the frame before the joint at poses (n, columns)."""
        return np.asarray(self.rotation(q) @ self.stud)

    def at(self, q: Floats) -> Floats:
        """The angle (n,) [rad, 0 to pi] at poses (n, columns)."""
        return angles(self.studs(q), self.seat)


def ball_angle(
    linkage: Loop,
    joint: str,
    seat: npt.ArrayLike | None = None,
    stud: npt.ArrayLike | None = None,
) -> BallAngle:
    """The angle of a joint S or U between a `seat` on the link before it and a `stud` on the link after.

    Directions (3,) are written as points of the link are, of any length but 0; left out, that of the rod to
    the link's other joint. Poses are rows of an analysis. Raises `RequestError` for a joint of another kind,
    and for a rod without length.

        >>> import numpy as np
        >>> import sevenbar as sb
        >>> linkage = sb.load("rssr")
        >>> bend = ball_angle(linkage, "ball_a", seat=(0, 0, -1))  # between the crank's axis and the coupler
        >>> q = linkage.motion(8).circuits[0].q
        >>> bend.at(q).shape
        (8,)

    Source: docs/theory_measures.md, (12).
    """
    place = joint_at(linkage, joint)
    own = linkage.joints[place]
    first, second = linkage.graph.between[place]
    u = rod(linkage, first, place) if seat is None else np.array(direction("seat", seat))
    v = rod(linkage, second, place) if stud is None else np.array(direction("stud", stud))
    turns = tuple((own.before(step)[:3, :3], step.axis) for step in own.row.steps)
    before, after = sides(linkage, place)
    return BallAngle(own.name, linkage.places[place], unit(before @ u), unit(after @ v), turns)


def line_angles(ends: Floats, by: Floats) -> tuple[Floats, Floats]:
    """The angles (n,) between the line from place 0 to 1 and that from 2 to 3, and their slopes (n, k).

    `ends` (n, 4, 3) are the places, `by` (n, 4, 3, k) their slopes. At a kink slopes are NaN.
    """
    lines, by_lines = ends[:, 1::2] - ends[:, ::2], by[:, 1::2] - by[:, ::2]
    sizes = np.linalg.norm(lines, axis=2, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        u, v = np.moveaxis(lines / sizes, 1, 0)
        cross = np.cross(u, v)
        sine = np.linalg.norm(cross, axis=1)
        axis = cross / np.where(sine > KINK, sine, np.nan)[:, None]
        across = np.stack([np.cross(u, axis), np.cross(axis, v)], axis=1) / sizes
    return np.arctan2(sine, (u * v).sum(axis=1)), np.einsum("nli,nlik->nk", across, by_lines)


def joint_at(linkage: Loop, name: str) -> int:
    """The place of a joint S or U of a name; `RequestError` where there is none."""
    bent = [joint.name for joint in linkage.joints if joint.row.bends]
    if not isinstance(name, str):
        raise RequestError(f"joint: {no_joint(name, [joint.name for joint in linkage.joints])}")
    for place, joint in enumerate(linkage.joints):
        if name == joint.name and joint.row.bends:
            return place
        if name in (joint.name, *joint.columns):
            listed = f"give one of {', '.join(bent)}" if bent else "this linkage has none"
            raise RequestError(f"joint: {shown(name)} is not a joint S or U, which a cone is of; {listed}")
    raise RequestError(f"joint: {no_joint(name, [joint.name for joint in linkage.joints])}")


def sides(linkage: Loop, place: int) -> tuple[Floats, Floats]:
    """The rotations (3, 3) of directions as written on the links before and after a joint into its frames."""
    first, second = (
        linkage.joint_on(place, link)[:3, :3].T @ linkage.point_frames[link - 1][:3, :3]
        for link in linkage.graph.between[place]
    )
    return first, second


def has_length(linkage: Loop, link: int) -> bool:
    """Whether the joints before and after a link are at two places."""
    start, end = joint_places(linkage, link)
    return bool(np.linalg.norm(end - start) > NO_LENGTH * linkage.length)


def rod(linkage: Loop, link: int, joint: int) -> Floats:
    """The direction (3,) of a link from a joint of it to its other one, as its points are written.

    Where both are at one place: along the axis of the other joint. `RequestError` where that turns any way.
    """
    start, end = joint_places(linkage, link)
    graph = linkage.graph
    ahead = graph.side(joint, link) == 1
    if has_length(linkage, link):
        return unit(end - start if ahead else start - end)
    (number,) = graph.others_of(link, joint)
    other = linkage.joints[number]
    if other.row.is_ball:
        side = "stud" if ahead else "seat"
        raise RequestError(
            f"{side}: link {link} has no length between {linkage.joints[joint].name} and {other.name}; "
            "give a direction of it"
        )
    back = inverse(linkage.point_frames[link - 1])[:3, :3]
    return np.asarray((back @ linkage.joint_on(number, link)[:3, :3])[:, 2])
