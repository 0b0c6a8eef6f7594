"""The bodies of each link as one, written as its points are; rods and drawn solids worked out."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache, partial
from typing import Any

import numpy as np

from sevenbar.arrays import Floats, triple
from sevenbar.errors import RequestError, shown
from sevenbar.forces.bodies import Body, as_one, flaw_alone, shaped
from sevenbar.forces.loading import Loading
from sevenbar.kinematics.circuits.motion import Solvable
from sevenbar.kinematics.circuits.poses import poses
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.kinematics.loop.rigid import inverse
from sevenbar.text.above import DRAWN_IN
from sevenbar.text.units import LENGTHS

#: A centre within this part of a line's length, and an inertia within this part of itself, are symmetric
#: about the line.
SYMMETRIC = 1e-9


def resolved(loading: Loading, linkage: Solvable, *, circuit: int = 0) -> dict[int, Body]:
    """The body of each link that has one, by the link's number; centres and axes as points are written.

    A rod lies between the places of its link's two joints. What is drawn are the solids of an export of that
    circuit, of steel or scaled to the mass that is given; crosses of universal joints are left out. Raises
    `RequestError` for a link that does not exist, or is the ground.

        >>> import sevenbar as sb
        >>> linkage = sb.load("rssr")
        >>> crank = resolved(sb.Loading(bodies={1: sb.Body(mass=1.2, solid="rod")}), linkage)[1]
        >>> crank.centre, crank.tensor.diagonal().round(12).tolist()
        ((125.0, 0.0, 0.0), [0.0, 0.00625, 0.00625])
    """
    metre = LENGTHS[linkage.length_unit]
    # drawn at the first body that is
    solids = cache(partial(_drawn, linkage, circuit))
    result = {}
    for link, bodies in loading.bodies.items():
        refuse_no_link("bodies", link, linkage)
        if bodies:
            result[link] = as_one([_worked_out(body, link, linkage, solids) for body in bodies], metre)
    return result


def as_moved(linkage: Solvable, bodies: Mapping[int, Body]) -> dict[int, Body]:
    """The bodies as balls without friction move them, where a link spins idly.

    Such balls never begin to turn a body that is symmetric about their line about it, so it moves as if it
    had no inertia about the line.

    Source: docs/theory_forces.md, (6).
    """
    return {link: _without_spin(linkage, link, body) for link, body in bodies.items()}


def _without_spin(linkage: Solvable, link: int, body: Body) -> Body:
    balls = all(linkage.joints[joint].row.is_ball for joint in linkage.graph.joints_of(link))
    if link not in linkage.idle_links or not balls:
        return body
    start, end = joint_places(linkage, link)
    length = float(np.linalg.norm(end - start))
    if not length:
        return body
    z = (end - start) / length
    arm = np.asarray(body.centre) - start
    axial = float(z @ body.tensor @ z)
    across = (float(np.trace(body.tensor)) - axial) / 2
    thin = across * (np.eye(3) - np.outer(z, z))
    apart = float(np.abs(body.tensor - thin - axial * np.outer(z, z)).max())
    off = float(np.linalg.norm(arm - (arm @ z) * z))
    if off > SYMMETRIC * length or apart > SYMMETRIC * max(axial, across):
        return body
    return Body(body.mass, body.centre, thin)


def refuse_no_link(key: str, link: object, linkage: Loop, *, or_ground: bool = False) -> None:
    """`RequestError` for a link that does not exist, or is the ground where that is none."""
    ground = linkage.graph.ground
    last = ground - 1 + or_ground
    whole = isinstance(link, (int, np.integer)) and not isinstance(link, bool)
    if not whole or not 1 <= link <= last:  # type: ignore[operator]
        what = "is the ground, which does not move" if whole and link == ground else "is not a link"
        more = ", the last is the ground" if or_ground else ""
        raise RequestError(f"{key}: link {shown(link)} {what}; give 1 to {last}{more}")


def _worked_out(body: Body, link: int, linkage: Solvable, solids: Callable[[], Mapping[int, Body]]) -> Body:
    """A body by its centre and inertia, whatever it was given by."""
    if body.solid == "rod":
        return _rod(body.mass, link, linkage)
    if body.is_shaped:
        try:
            return shaped(body, LENGTHS[linkage.length_unit], joint_places(linkage, link))
        except RequestError as error:
            raise RequestError(f"bodies[{link}]: {error}") from None
    if body.solid == "drawn":
        steel = solids()[link]
        share = body.mass / steel.mass if body.mass else 1.0
        return Body(share * steel.mass, steel.centre, share * steel.tensor)
    if body.alone is None:
        return replace(body, solid=None)
    if flaw := flaw_in_plane(body, link, linkage):
        raise RequestError(f"bodies[{link}]: inertia: {flaw}")
    normal = across(linkage, link)
    assert normal is not None
    return body.about(normal)


def flaw_in_plane(body: Body, link: int, linkage: Solvable) -> str:
    """Why an inertia about one axis alone does not say enough of a body; empty where it does, or is whole."""
    if body.alone is None:
        return ""
    _, axis = body.alone
    normal = across(linkage, link)
    apart = 0.0 if axis is None or normal is None else float(np.linalg.norm(np.cross(axis, normal)))
    return flaw_alone(body) if normal is None or apart > SYMMETRIC else ""


def across(linkage: Solvable, link: int) -> Floats | None:
    """The direction (3,) across a planar linkage, as points of a link are written; `None` of any other."""
    if linkage.normal is None:
        return None
    # motions in the plane leave it as it is, so joints are taken at zero
    zero = np.zeros((1, len(linkage.columns)))
    frame = poses(linkage, zero)[0, link - 1] @ linkage.point_frames[link - 1]
    return np.asarray(frame[:3, :3].T @ linkage.normal)


def _rod(mass: float, link: int, linkage: Loop) -> Body:
    """A uniform thin rod between the places of the joints of a link: `m l^2 / 12` across it."""
    start, end = joint_places(linkage, link)
    rod = LENGTHS[linkage.length_unit] * (end - start)
    tensor = mass / 12 * (rod @ rod * np.eye(3) - np.outer(rod, rod))
    return Body(mass, triple("centre", (start + end) / 2), tensor)


def joint_places(linkage: Loop, link: int) -> tuple[Floats, Floats]:
    """The places (3,) of the joints before and after a link, the ground last, written as its points are.

    Of a joint that slides it is that of its frame, as drawn.
    """
    back = inverse(linkage.point_frames[link - 1])
    first, second = ((back @ linkage.drawn_joint_on(j, link))[:3, 3] for j in linkage.graph.joints_of(link))
    return first, second


def _drawn(linkage: Loop, circuit: int) -> dict[int, Body]:
    """The solids of each moving link as exports draw them, of steel."""
    export: Any = importlib.import_module(DRAWN_IN["bodies"])
    metre, result = LENGTHS[linkage.length_unit], {}
    for link, (mass, centre, inertia) in enumerate(export.drawn_bodies(linkage, circuit), 1):
        back = inverse(linkage.point_frames[link - 1])
        turn = back[:3, :3]
        place = turn @ centre + back[:3, 3]
        tensor = metre**2 * turn @ inertia @ turn.T
        result[link] = Body(mass, triple("centre", place), (tensor + tensor.T) / 2)
    return result
