"""What commands ask at one value of the input: poses with their rates and forces, or the nearest limit."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import sevenbar as sb
from sevenbar.arrays import short_way, whole_number
from sevenbar.commands.given import agreed, input_value
from sevenbar.errors import NotCoveredError, RequestError
from sevenbar.kinematics.circuits.poses_at import PosesAt
from sevenbar.kinematics.loop.joint_text import joint_speed
from sevenbar.reporting.shown import value_text

if TYPE_CHECKING:
    from sevenbar.reporting.pose_forces import PoseForces


def rates_at(
    linkage: sb.Linkage, column: int, value: float, speed: str | None, modes: sb.Modes
) -> tuple[PosesAt | None, float | None]:
    """The poses at a value of a column with a speed of it, `None` where it drives no motion.

    Also the nearest limit where there is no mode.
    """
    name = linkage.columns[column]
    rate = None if speed is None else joint_speed(speed, linkage, column)
    try:
        if len(modes):
            return PosesAt.of(linkage, value, input=name, speed=rate), None
        return None, _nearest_limit(linkage, column, value)
    except (RequestError, NotCoveredError):
        # modes are all there is to say where no motion can be followed
        return None, None


def _nearest_limit(linkage: sb.Linkage, column: int, value: float) -> float | None:
    """The limit of a column nearest to a value [rad in (-pi, pi], or length]; `None` without limits."""
    limits = linkage.motion(input=linkage.columns[column]).limits
    if not limits.size:
        return None
    turns = linkage.turns(column)
    far = abs(short_way(limits - value) if turns else limits - value)
    nearest = float(limits[int(far.argmin())])
    return -float(short_way(-nearest)) if turns else nearest


def refuse_at(given: Mapping[str, object]) -> None:
    """Raises `RequestError` for options that are of a whole cycle where forces of one pose are asked."""
    for option, value in given.items():
        if value not in (None, []):
            raise RequestError(f"{option}: is of a whole cycle, --at of one pose; leave one of them out")


def forces_at(
    linkage: sb.Linkage,
    at: str,
    input_joint: str | None,
    speed: str | None,
    circuit: int | None,
    branch: int | None,
    *,
    agree: float | None,
    at_rest: bool,
) -> PoseForces:
    """The forces in each pose at a value of the input, or in those of one circuit, or of one pass."""
    from sevenbar.reporting.pose_forces import PoseForces

    linkage = linkage.agreeing(agreed(agree))
    value = input_value("--at", at, linkage, input_joint)
    column = linkage.input_column(input_joint, "--input")
    rate = None if speed is None else joint_speed(speed, linkage, column)
    result = PosesAt.of(linkage, value, input=input_joint, speed=rate)
    if circuit is not None:
        whole_number("--circuit", circuit, 0, len(result.motion.circuits) - 1, "a circuit of this motion")
    poses = [
        pose for pose in result.poses if circuit in (None, pose.circuit) and branch in (None, pose.branch)
    ]
    if not poses:
        where = value_text(linkage, column, value)
        limit = _nearest_limit(linkage, column, value)
        if result.poses:
            raise RequestError(
                f"--at: no pass of --circuit and --branch has a pose at {where}; "
                "leave --circuit and --branch out to see all"
            )
        hint = "" if limit is None else f"; the nearest limit is {value_text(linkage, column, limit)}"
        raise RequestError(f"--at: the loop does not close at {linkage.columns[column]} = {where}{hint}")
    chosen = [(pose, pose.forces(at_rest=at_rest)) for pose in poses]
    return PoseForces(linkage, [(pose, forces) for pose, forces in chosen if forces is not None])
