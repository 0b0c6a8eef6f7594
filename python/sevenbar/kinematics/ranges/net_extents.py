"""Ranges of the joints of a net along a circuit: each as the output of the circuit through the same pose."""

from __future__ import annotations

import numpy as np

from sevenbar.curves.curve import Peak
from sevenbar.errors import RequestError
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.extents import JointRange
from sevenbar.kinematics.circuits.motion import Solvable
from sevenbar.kinematics.paths.circuit_path import NotFollowedError

#: Inputs of a turn: an output's extremes lie between them, those at the ends of an open circuit on them.
SAMPLES = 90


def net_joint_ranges(linkage: Solvable, circuit: Circuit) -> dict[str, JointRange]:
    """The range of every column but a ball's, by name; see `Circuit.joint_ranges`."""
    # a pose that leads one way, so far from dead centres and change points as there is one
    sound = np.flatnonzero((circuit.status == "ok") & np.isfinite(circuit.condition))
    if not sound.size:
        raise NotFollowedError("circuit: none of its rows has a pose with rates")
    pose = circuit.q[sound[np.argmin(circuit.condition[sound])]]
    driving = circuit.columns[circuit.input_column]
    result = {}
    for column in linkage.each_column:
        if column.number == circuit.input_column:
            ends = circuit.input_range
            low, high = (None, None) if ends is None else (Peak(end, end) for end in ends)
        elif column.is_output:
            try:
                through = linkage.circuit(pose, SAMPLES, input=driving, output=column.name)
            except RequestError as error:
                # a hair off a change point a pose alone may not tell its circuit from the next
                raise NotFollowedError(f"circuit: the range of {column.name} is not known; {error}") from None
            low, high = output_ends(through)
        else:
            continue
        result[column.name] = JointRange(column.name, column.turns, low, high)
    return result


def output_ends(circuit: Circuit) -> tuple[Peak | None, Peak | None]:
    """The lowest and the highest value of a circuit's output; `None` if it turns fully."""
    if circuit.output_range is None:
        return None, None
    rows = np.flatnonzero(np.isfinite(circuit.output))
    values, inputs = list(circuit.output[rows]), list(circuit.input[rows])
    if circuit.angle is not None:
        # before the rows beside them
        values[:0] = [circuit.angle.lowest, circuit.angle.highest]
        inputs[:0] = [circuit.angle.lowest_at, circuit.angle.highest_at]
    first, last = int(np.argmin(values)), int(np.argmax(values))
    return Peak(float(values[first]), float(inputs[first])), Peak(float(values[last]), float(inputs[last]))
