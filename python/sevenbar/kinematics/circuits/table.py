"""The rows of a circuit as the columns of a table, each with its unit in its name."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from sevenbar.arrays import truth
from sevenbar.errors import of_extra
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.loop.columns import joint_columns, point_column
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.text.units import LENGTHS

if TYPE_CHECKING:
    import pandas as pd

#: What the name of a quantity ends in that is counted by its unit.
PER = "_per"


def circuit_columns(circuit: Circuit, linkage: Loop, *, si: bool) -> dict[str, npt.NDArray[Any]]:
    """Every row of a circuit by column: degrees and the linkage's unit of length, or radians and metres."""
    count, si = len(circuit.time), truth("si", si)
    length, angle = ("m", "rad") if si else (linkage.length_unit, "deg")
    scale = LENGTHS[linkage.length_unit] if si else 1.0
    columns: dict[str, npt.NDArray[Any]] = {
        "circuit": np.full(count, circuit.index),
        "branch": circuit.branch,
        "sample": np.arange(count),
        "status": circuit.status,
        "time_s": circuit.time,
    }
    rates = (circuit.q, circuit.dq, circuit.ddq, circuit.dddq)
    columns |= joint_columns(linkage, rates, length=length, angle=angle, scale=scale)
    for point in linkage.points:
        trace = circuit.point(point.name)
        for order, values in enumerate((trace.position, trace.velocity, trace.acceleration)):
            for axis, letter in enumerate("xyz"):
                head = point_column(point.name, letter, order=order, length=length)
                columns[head] = values[:, axis] * scale
    if circuit.transmission_angle is not None:
        transmission = circuit.transmission_angle
        columns[f"transmission_{angle}"] = transmission if si else np.degrees(transmission)
    if not linkage.stops.is_empty:
        for name, bend in circuit.bends.items():
            columns[f"{name}_bend_{angle}"] = bend if si else np.degrees(bend)
    if linkage.stops.stops:
        columns["within_stops"] = circuit.allowed.within.astype(np.int64)
    head, factor = _advantage_column(circuit, length, scale)
    columns[head] = circuit.mechanical_advantage * factor
    columns[f"residual_{length}"] = circuit.residual * scale
    return columns


def advantage_unit(input_turns: bool, output_turns: bool, length: str) -> str:
    """The unit of the mechanical advantage, "" where it has none: torque over force is a length."""
    if input_turns == output_turns:
        return ""
    return length if output_turns else f"per_{length}"


def _advantage_column(circuit: Circuit, length: str, scale: float) -> tuple[str, float]:
    """The column of the mechanical advantage, and its factor."""
    unit = advantage_unit(circuit.input_turns, circuit.output_turns, length)
    factor = {"": 1.0, length: scale}.get(unit, 1.0 / scale)
    return "_".join(filter(None, ("mechanical_advantage", unit))), factor


def frame_of(columns: Mapping[str, npt.NDArray[Any]], linkage: Loop) -> pd.DataFrame:
    """Columns as a pandas table (extra `[frame]`).

    Its `attrs` have the `linkage`'s name and the `units` of the columns that have one.
    """
    with of_extra("frame", "to_frame needs pandas"):
        import pandas as pd
    # `import sevenbar` needs no reader of tables
    from sevenbar.text.table import name_and_unit

    frame = pd.DataFrame(dict(columns))
    units = {}
    for head in columns:
        name, unit = name_and_unit(head)
        if unit:
            units[head] = f"1/{unit}" if name.endswith(PER) else re.sub(r"(/s)(\d)$", r"\1^\2", unit)
    frame.attrs |= {"linkage": linkage.name, "units": units}
    return frame
