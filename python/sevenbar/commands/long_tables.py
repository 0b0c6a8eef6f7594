"""Motions of many samples: how large their table would be, and a line while they are computed."""

from __future__ import annotations

from collections.abc import Callable
from io import StringIO

import sevenbar as sb
from sevenbar.commands.consent import Ahead
from sevenbar.commands.progress import progress_bar
from sevenbar.kinematics.circuits.long_circuit import LONG
from sevenbar.kinematics.linkage import sample_count
from sevenbar.reporting.folder import write_csv

#: Samples of the motion whose rows are taken for those of the longer one.
TRIAL = 36

#: Numbers that are computed and written in a second, as text and as they are; bytes of one as it is.
WRITTEN, PACKED = 1.0e6, 5.0e6
BYTES = 8


def table_ahead(moved: Callable[[int], sb.Motion], samples: int, what: str, *, text: bool = True) -> Ahead:
    """How large the table of a motion with so many samples would be, by one with few; as text, or numbers."""
    if sample_count("samples", samples) < LONG:
        return Ahead("--samples", what)
    trial = moved(TRIAL)
    columns = trial.columns()
    rows = sum(circuit.tally.rows for circuit in trial)
    if not rows:
        return Ahead("--samples", what)
    times = samples / TRIAL
    numbers = rows * len(columns) * times
    size = BYTES * numbers
    if text:
        lines = StringIO()
        write_csv(lines, list(columns), zip(*(column.tolist() for column in columns.values()), strict=True))
        size = len(lines.getvalue()) * times
    rate = WRITTEN if text else PACKED
    return Ahead("--samples", f"{what} of {round(rows * times, -3):,.0f} rows", size, numbers / rate)


def long_motion(moved: Callable[[int], sb.Motion], samples: int) -> sb.Motion:
    """The motion; a line says so where it takes its time."""
    if sample_count("samples", samples) < LONG:
        return moved(samples)
    # a refusal is alone
    moved(TRIAL)
    with progress_bar(f"computing {samples:,} samples a turn") as progress:
        progress(0, 0)
        return moved(samples)
