"""What measures take from ranges, cones, distances and stops of a circuit; `None` where there is none."""

from __future__ import annotations

import math

from sevenbar.errors import RequestError, no_joint, shown
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.paths.circuit_path import NotFollowedError


def joint_extent(circuit: Circuit, joint: str) -> float | None:
    """High less low of a joint [deg, or length]; `None` where it is endless."""
    try:
        ranges = circuit.joint_ranges
    except NotFollowedError:
        return None
    found = ranges.get(joint) or ranges.get(f"{joint}.1")
    if found is None:
        if joint in {name.rpartition(".")[0] or name for name in circuit.columns}:
            raise RequestError(
                f"measure: joint {shown(joint)} is a ball, which has no range; give ball_angle:{joint}"
            )
        raise RequestError(f"measure: {no_joint(joint, list(ranges))}")
    extent = found.extent
    return math.degrees(extent) if extent is not None and found.turns else extent


def greatest_bend(circuit: Circuit, joint: str) -> float | None:
    """The greatest angle of a ball or universal joint from its seat [deg]."""
    try:
        return math.degrees(circuit.ball_cone(joint).greatest.value)
    except NotFollowedError:
        return None
    except RequestError as error:
        raise RequestError(f"measure: {str(error).partition(': ')[2]}") from None


def least_gap(circuit: Circuit) -> float | None:
    """The least distance of links less their radii [length], of those with a radius where there are any."""
    try:
        found = circuit.clearances
    except NotFollowedError:
        return None
    thick = [one for one in found if one.radii] or found
    return min((one.gap for one in thick), default=None)


def usable_share(circuit: Circuit) -> float | None:
    """What part of the circuit is within the stops, by length."""
    try:
        return circuit.allowed.share
    except NotFollowedError:
        return None
