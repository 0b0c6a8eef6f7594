"""The whole motion as numbers: every circuit's rows for spreadsheets, pandas, NumPy, MATLAB and the like.

CSV and Parquet hold one flat table, a unit in every column's name. NPZ, MAT and JSON hold arrays as Python
has them, `q (rows, columns)` with its derivatives, beside a note of units and names.
"""

from __future__ import annotations

import itertools
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

import numpy as np

from sevenbar.errors import of_extra
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.reporting.csv_tables import write_parts
from sevenbar.text.progress import Progress, silent
from sevenbar.text.units import LENGTHS

#: Letters of the longest name of a field that MATLAB reads.
LONGEST_FIELD = 63

#: "file": lengths in the linkage's own unit, and angles of flat tables in degrees; "si": metres and radians.
Units = Literal["file", "si"]


def write_csv(motion: Motion, path: Path, units: Units, progress: Progress = silent) -> None:
    """Writes the flat table as CSV; a value that does not exist is an empty cell beside its status."""
    rows = sum(circuit.tally.rows for circuit in motion)
    write_parts(path, motion.column_parts(si=units == "si"), lambda done: progress(done, rows, "rows"))


def write_parquet(motion: Motion, path: Path, units: Units, _progress: Progress = silent) -> None:
    """Writes the flat table as Parquet, with the note as JSON under `sevenbar` in its schema's metadata."""
    with of_extra("export", "parquet needs pyarrow"):
        import pyarrow as arrow
        from pyarrow import parquet
    about = {"sevenbar": json.dumps(note(motion, units, flat=True))}
    writer = None
    for part in motion.column_parts(si=units == "si"):
        columns = {name: np.asarray(values) for name, values in part.items()}
        arrays = [
            arrow.array(values.tolist() if values.dtype.kind == "U" else values)
            for values in columns.values()
        ]
        table = arrow.table(arrays, names=list(columns)).replace_schema_metadata(about)
        if writer is None:
            writer = parquet.ParquetWriter(path, table.schema)
        writer.write_table(table)
        # or they would live until the next ones are made
        del part, columns, arrays, table
    assert writer is not None
    writer.close()


def write_npz(motion: Motion, path: Path, units: Units, _progress: Progress = silent) -> None:
    """Writes the rows of all circuits, one under the other, as NumPy arrays; `note` is JSON text."""
    parts = [circuit_arrays(motion, circuit, units) for circuit in motion.circuits]
    joined = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    arrays: dict[str, Any] = {
        "note": np.array(json.dumps(note(motion, units))),
        "columns": np.array(motion.linkage.columns),
        "circuit": np.repeat([c.index for c in motion.circuits], [len(c.time) for c in motion.circuits]),
    } | joined
    with path.open("wb") as file:
        np.savez_compressed(file, **arrays)


def write_mat(motion: Motion, path: Path, units: Units, _progress: Progress = silent) -> None:
    """Writes a MATLAB 5 file: `note` (JSON text), `columns` (cells), `circuits` (an array of structures).

    A field whose name MATLAB does not take has a shorter one; `fields` of the note says which.
    """
    with of_extra("export", "mat needs scipy"):
        from scipy.io import savemat
    records: list[dict[str, Any]] = []
    for circuit in motion.circuits:
        records.append({"index": circuit.index, "motion_type": circuit.motion_type})
        for name, values in circuit_arrays(motion, circuit, units).items():
            # MATLAB's own way: time runs down
            down = values if values.ndim > 1 else values[:, None]
            records[-1][name] = _cells(values) if values.dtype.kind == "U" else down
    short = _field_names(list(records[0]))
    circuits = np.empty(len(records), dtype=[(short.get(name, name), object) for name in records[0]])
    circuits[:] = [tuple(record.values()) for record in records]
    content = {
        "note": json.dumps(note(motion, units) | ({"fields": short} if short else {})),
        "columns": _cells(np.array(motion.linkage.columns)),
        "circuits": circuits,
    }
    savemat(str(path), content, appendmat=False, do_compression=True, long_field_names=True)


def _field_names(names: Sequence[str]) -> dict[str, str]:
    """Names that MATLAB takes for no field, each with one of its own that it takes."""
    used = {name for name in names if name.isascii() and len(name) <= LONGEST_FIELD}
    made: dict[str, str] = {}
    for name in names:
        if name in used:
            continue
        plain = "".join(letter if letter.isascii() else "_" for letter in name)
        # the quantity at its end says what it is
        head, _, quantity = plain.rpartition("_")
        for count in itertools.count():
            end = f"{f'_{count}' if count else ''}_{quantity}"
            made[name] = head[: LONGEST_FIELD - len(end)] + end
            if made[name] not in used:
                used.add(made[name])
                break
    return made


def write_json(motion: Motion, path: Path, units: Units, _progress: Progress = silent) -> None:
    """Writes one JSON object: the note, and `circuits` with their rows; null stands for no value."""
    circuits = []
    for circuit in motion.circuits:
        own = {name: getattr(circuit, name) for name in ("index", "motion_type", "closed", "turns")}
        arrays = circuit_arrays(motion, circuit, units)
        plain = {name: _plain(values) for name, values in arrays.items()}
        circuits.append({**own, "rows": len(circuit.time), **plain})
    whole = note(motion, units) | {"circuits": circuits}
    path.write_text(json.dumps(whole, allow_nan=False) + "\n", encoding="utf-8")


def note(motion: Motion, units: Units, *, flat: bool = False) -> dict[str, Any]:
    """What the numbers mean: the linkage, the drive, the columns and the units.

    In a `flat` table each column's name has its unit, and angles are in degrees with units "file".
    """
    linkage = motion.linkage
    length = "m" if units == "si" else linkage.length_unit
    speed = motion.speed * (1.0 if linkage.turns(motion.input) else _scale(motion, units))
    return {
        "format": 1,
        "linkage": {"name": linkage.name, "kind": linkage.kind},
        "units": {
            "length": length,
            "angle": "deg" if flat and units == "file" else "rad",
            "time": "s",
            "rates": f"rad/s, rad/s^2, rad/s^3 of turns; {length}/s, {length}/s^2, {length}/s^3 of slides",
        },
        "columns": [{"name": column.name, "kind": column.kind} for column in linkage.each_column],
        "input": motion.input,
        "output": motion.output,
        "speed": None if motion.law is not None else speed,
        "motion_type": motion.motion_type,
        "samples": motion.samples,
        # freedoms that move no other link, which a convention holds, and the links that have them
        "idle": list(motion.idle),
        "idle_links": sorted(linkage.idle_links) if motion.idle else [],
    }


def circuit_arrays(motion: Motion, circuit: Circuit, units: Units) -> dict[str, Any]:
    """The rows of a circuit: time, status, pass, input, output, joints and rates, points, closure error."""
    scale = _scale(motion, units)
    factors = np.where(motion.linkage.turning, 1.0, scale)
    arrays: dict[str, Any] = {
        "time": circuit.time,
        "status": circuit.status,
        "branch": circuit.branch,
        "input": circuit.input * factors[circuit.input_column],
        "output": circuit.output * factors[circuit.output_column],
        "q": circuit.q * factors,
        "dq": circuit.dq * factors,
        "ddq": circuit.ddq * factors,
        "dddq": circuit.dddq * factors,
        "residual": circuit.residual * scale,
    }
    for point in motion.linkage.points:
        trace = circuit.point(point.name)
        for quantity in ("position", "velocity", "acceleration"):
            arrays[f"point_{point.name}_{quantity}"] = getattr(trace, quantity) * scale
    return arrays


def _scale(motion: Motion, units: Units) -> float:
    return LENGTHS[motion.linkage.length_unit] if units == "si" else 1.0


def _plain(values: Any) -> Any:
    """An array as lists, None for what is not finite."""
    if values.dtype.kind != "f":
        return values.tolist()
    plain = values.astype(object)
    plain[~np.isfinite(values)] = None
    return plain.tolist()


def _cells(words: Any) -> Any:
    """Words as a column of MATLAB cells."""
    cells = np.empty((len(words), 1), dtype=object)
    cells[:, 0] = [str(word) for word in words]
    return cells
