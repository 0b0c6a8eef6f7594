"""A circuit anew at any inputs, in their order, at constant speed."""

from __future__ import annotations

import math

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.motion import Solvable
from sevenbar.kinematics.loop.law import Law

#: Rows that close up to more than this [relative to the size] are those of a loop whose redundant constraints
#: were taken to agree, which the residual shows; the greatest such error that can be asked.
EXACT, MOST_AGREE = 1e-9, 1e-3


def driven(
    linkage: Solvable, circuit: Circuit, inputs: Floats, *, speed: float, agree: float | None = None
) -> Circuit:
    """A circuit of the linkage at inputs (n,) [rad, or length]; one that turns back holds them on each pass.

    `agree` is that of its motion; without it, what its rows' residual shows.
    """
    first, last = (linkage.columns[i] for i in (circuit.input_column, circuit.output_column))
    law = Law.of(np.arange(float(len(inputs))), inputs, speed, 0.0)
    if agree is None:
        error = float(np.nanmax(circuit.residual, initial=0.0)) / circuit.size
        agree = min(2 * error, MOST_AGREE) if math.isfinite(error) and error > EXACT else None
    if not circuit.goes_round or circuit.turns > 1:
        # a pose alone distinguishes neither passes nor turns
        every = linkage.motion(input=first, output=last, law=law, agree=agree)
        return every.circuits[circuit.index]
    pose = circuit.q[np.flatnonzero(np.isfinite(circuit.q).all(axis=1))[0]]
    return linkage.circuit(pose, input=first, output=last, law=law, agree=agree)
