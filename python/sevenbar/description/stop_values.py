"""From the checked tables of a file to the stops of its linkage."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from sevenbar.kinematics.loop.stops import Cone, Stops

if TYPE_CHECKING:
    from sevenbar.description.stop_schema import RodForm, StopForm


def stops_of(stops: Sequence[StopForm], rods: Sequence[RodForm], columns: Mapping[str, str]) -> Stops:
    """The stops of a linkage; `columns` are those that the names of joints mean."""
    return Stops(
        {columns.get(stop.joint, stop.joint): stop.range for stop in stops if stop.range is not None},
        {
            stop.joint: Cone(stop.cone, stop.seat, stop.stud)
            for stop in stops
            if (stop.cone, stop.seat, stop.stud) != (None, None, None)
        },
        {rod.link: rod.radius for rod in rods},
    )
