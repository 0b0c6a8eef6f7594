"""The derivatives of a circuit by the numbers of its linkage's description, as values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from sevenbar.arrays import Floats, Words
from sevenbar.text.printing import Printed


@dataclass(frozen=True, eq=False, repr=False)
class Sensitivity(Printed):
    """Derivatives of a circuit by the k numbers of its linkage's description, on its n rows.

    `names` and `units` (k,) are those of the numbers, as in the file. `position` (n, columns, k) [rad, or
    length, by the number's unit], `velocity` and `acceleration` by time at the circuit's own input, which
    stays as it is; of a ball's turns there is the position only. `points` has each named point's derivative
    (n, 3, k), `point_velocities` that of its velocity. NaN in rows without rates (`status` says why), for
    numbers that open the loop if they change alone (`opening`), and for what spins idly.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    columns: tuple[str, ...]
    position: Floats
    velocity: Floats
    acceleration: Floats
    points: Mapping[str, Floats]
    point_velocities: Mapping[str, Floats]
    opening: tuple[str, ...]
    status: Words
