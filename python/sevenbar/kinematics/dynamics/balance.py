"""Counterweights for a circuit: what a unit of mass on each link shakes, and where its pivot is.

With p the place of the link's origin, R its axes, a and A their second derivatives by time, a unit mass at
the origin and unit first moments along the axes shake with (moment about the report origin, force)

    (-p x a, -a)   and   (-p x A_j - R_j x a, -A_j)                                                     (18)

Source: docs/theory_forces.md, (18).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np

from sevenbar.arrays import Floats, triple
from sevenbar.curves.timed_rows import shares_of
from sevenbar.errors import RequestError, shown
from sevenbar.forces.counterweights import Balance, counterweights
from sevenbar.forces.mounts import Mount
from sevenbar.forces.result import Forces
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.link_motion import rates_of_frame
from sevenbar.kinematics.circuits.motion import Solvable
from sevenbar.kinematics.dynamics.link_bodies import joint_places, refuse_no_link
from sevenbar.text.units import LENGTHS


def balance_of(
    linkage: Solvable, circuit: Circuit, forces: Forces, links: Sequence[int], options: Mapping[str, object]
) -> Balance:
    """Counterweights on links of a circuit for the shaking of its forces; see `Circuit.counterweights`.

    Raises `RequestError` for a link that does not exist, and where a row has no shaking.
    """
    try:
        links = list(links)
    except TypeError:
        raise RequestError(f"links: {shown(links)} is no list of links; give one, as in [2, 4]") from None
    for link in links:
        refuse_no_link("links", link, linkage)
    twice = [link for i, link in enumerate(links) if link in links[:i]]
    if twice:
        raise RequestError(f"links: {twice[0]} is given twice; leave one out")
    mounts = [mount_of(linkage, circuit, link) for link in links]
    rows = np.concatenate(
        [forces.shaking, *(mount.unit.reshape(len(forces.time), -1) for mount in mounts)], axis=1
    )
    lost = circuit.status[~np.isfinite(rows).all(axis=1)]
    if "change-point" in lost:
        raise RequestError(
            "counterweights: the rows at change points, where branches meet, have no shaking of their own; "
            "take a circuit without change points, or drive it by a law whose rows stay off them"
        )
    if lost.size:
        raise RequestError(
            "counterweights: the shaking grows without bound at dead centres of the input; drive the circuit "
            "by a law that stays off them, or take one whose input goes round"
        )
    shares = None if forces.periodic else shares_of(forces.time)
    sizes = {"size": circuit.size, "shares": shares, "length_unit": linkage.length_unit}
    return counterweights(forces.shaking, mounts, **sizes, **options)  # type: ignore[arg-type]


def mount_of(linkage: Solvable, circuit: Circuit, link: int) -> Mount:
    """A link of a circuit as one that may carry a counterweight; radii count from its joint at the ground.

    From the joint before it, if it has none.
    """
    refuse_no_link("links", link, linkage)
    before, after = joint_places(linkage, link)
    first, second = linkage.graph.joints_of(link)
    standing = linkage.graph.standing
    behind = second in standing and first not in standing
    axis, name = None, ""
    if behind or first in standing:
        name = linkage.joints[second if behind else first].name
        directions = circuit.screw_axes(link).moving_direction
        result = directions[np.isfinite(directions).all(axis=1)]
        if len(result) and np.ptp(result * np.sign(result @ result[0])[:, None], axis=0).max() < 1e-9:
            axis = triple("axis", result[0])
    pivot = triple("pivot", after if behind else before)
    return Mount(int(link), unit_shaking(linkage, circuit, link), pivot, axis, name)


def unit_shaking(linkage: Solvable, circuit: Circuit, link: int) -> Floats:
    """What a link shakes with (n, 4, 6) for unit first moments [by kg length] and 1 kg at its origin.

    Source: docs/theory_forces.md, (18).
    """
    metre = LENGTHS[linkage.length_unit]
    frame = rates_of_frame(partial(circuit.written_point, link), circuit.size)
    (place, axes), (acceleration, axes_rate) = frame("position"), frame("acceleration")
    unit = np.empty((len(place), 4, 6))
    unit[:, 3, :3], unit[:, 3, 3:] = -(metre**2) * np.cross(place, acceleration), -metre * acceleration
    for j in range(3):
        along, second = axes[:, :, j], axes_rate[:, :, j]
        unit[:, j, :3] = -(metre**2) * (np.cross(place, second) + np.cross(along, acceleration))
        unit[:, j, 3:] = -metre * second
    return unit
