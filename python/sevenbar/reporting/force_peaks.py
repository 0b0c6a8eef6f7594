"""The peaks of forces that the report of a motion has: torque and bearing forces of each circuit."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.long_circuit import LongCircuit

if TYPE_CHECKING:
    from sevenbar.curves.curve import Peak


@dataclass(frozen=True)
class ForcePeaks:
    """Peak torque [N m, of a slide N] and, by joint, the peak of the force [N] where it is determined."""

    torque: Peak
    unit: str
    forces: dict[str, Peak]

    @property
    def greatest(self) -> tuple[str, Peak] | None:
        """The joint with the greatest force; `None` where no joint's whole force is determined."""
        return max(self.forces.items(), key=lambda one: one[1].value, default=None)


def peaks_of(circuit: Circuit) -> ForcePeaks | None:
    """The peaks of a circuit on which something acts, of the part between stops on which it is used.

    `None` of one that rocks to dead centres of its input, and of too many rows.
    """
    if isinstance(circuit, LongCircuit):
        return None
    forces = circuit.forces().within_stops
    if forces is None or (forces.part is None and not circuit.goes_round):
        return None
    result = forces.sizing()
    if result is None:
        return None
    peaks = {name: bearing.force.peak for name, bearing in result.bearings.items()}
    known = {name: peak for name, peak in peaks.items() if math.isfinite(peak.value)}
    return ForcePeaks(result.peak_torque, forces.unit, known)


def peaks_dict(circuit: Circuit) -> dict[str, Any] | None:
    """The peaks of a circuit on which something acts, as plain values."""
    peaks = peaks_of(circuit)
    if peaks is None:
        return None
    return {
        "peak_torque": vars(peaks.torque),
        "unit": peaks.unit,
        "peak_forces": {name: vars(peak) for name, peak in peaks.forces.items()},
    }
