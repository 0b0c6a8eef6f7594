"""The outputs that tolerances tell upon: every joint's motion and every named point's, at any numbers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.kinematics.numbers.gradients import PER_TIME, QUANTITIES
from sevenbar.kinematics.numbers.sensitivity import Numbers, Slopes


@dataclass(frozen=True)
class Output:
    """One output: its name ("rocker", "rocker.velocity", "P.x", "P.velocity_x"), its unit, and whose it is.

    `quantity` is position, velocity or acceleration, `joint` whether it is a joint's; `place` counts the
    columns or the points, `axis` a point's coordinates.
    """

    name: str
    unit: str
    quantity: str
    owner: str
    joint: bool
    place: int
    axis: int = 0

    @property
    def order(self) -> int:
        """The order of the derivative."""
        return QUANTITIES.index(self.quantity)


def outputs_of(numbers: Numbers, input: int) -> tuple[Output, ...]:
    """All outputs of a loop: of a ball's turns and of points not every derivative."""
    linkage = numbers.linkage
    result = []
    for k, name in enumerate(linkage.columns):
        unit = linkage.unit_of(k)
        orders = 0 if k == input else 1 if numbers.is_ball[k] else 3
        for quantity, per in zip(QUANTITIES[:orders], PER_TIME, strict=False):
            own = name if quantity == "position" else f"{name}.{quantity}"
            result.append(Output(own, unit + per, quantity, name, True, k))
    for i, point in enumerate(linkage.points):
        for quantity, per in zip(QUANTITIES[:2], PER_TIME, strict=False):
            for axis, letter in enumerate("xyz"):
                own = letter if quantity == "position" else f"{quantity}_{letter}"
                unit = linkage.length_unit + per
                result.append(Output(f"{point.name}.{own}", unit, quantity, point.name, False, i, axis))
    return tuple(result)


def values_of(outputs: tuple[Output, ...], q: Floats, here: Slopes, speed: float) -> Floats:
    """The outputs (n, outputs) at poses q (n, columns)."""
    rates = np.concatenate([q[:, None], here.rates], axis=1)
    return np.column_stack(
        [
            (rates[:, one.order, one.place] if one.joint else here.points[:, one.place, one.order, one.axis])
            * speed**one.order
            for one in outputs
        ]
    )


def slopes_of(numbers: Numbers, outputs: tuple[Output, ...], q: Floats, here: Slopes, speed: float) -> Floats:
    """The derivatives (n, outputs, numbers) at rows q (n, columns) of the analysis.

    What takes part in an idle motion, of which nothing is known, is NaN.
    """
    joints, idle = numbers.by_columns(q, here)
    slopes = np.stack(
        [
            (
                joints[:, one.order, :, one.place]
                if one.joint
                else here.points_by_number[:, one.place, one.order, :, one.axis]
            )
            * speed**one.order
            for one in outputs
        ],
        axis=1,
    )
    spins = [idle[one.place] if one.joint else here.idle_points[one.place] for one in outputs]
    slopes[:, spins] = np.nan
    return slopes
