"""Much output and long work: how much it would be, `--yes` to go on, and the motions of many samples."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from io import StringIO

import typer

import sevenbar as sb
from sevenbar.commands.progress import progress_bar
from sevenbar.errors import RequestError
from sevenbar.kinematics.circuits.long_circuit import LONG
from sevenbar.kinematics.linkage import sample_count

#: Output [bytes] and work [s] above which a command asks first.
MUCH, MINUTE = 200e6, 60.0


@dataclass(frozen=True)
class Ahead:
    """What a command would do: the option that makes it much, and how much, as far as can be known before."""

    option: str
    what: str
    bytes: float = 0.0
    seconds: float = 0.0

    @property
    def asks(self) -> bool:
        """Whether it is so much that somebody has to want it."""
        return self.bytes > MUCH or self.seconds > MINUTE

    def __str__(self) -> str:
        parts = [self.what]
        if self.bytes > MUCH:
            parts.append(f"about {size_text(self.bytes)}")
        if self.seconds > MINUTE:
            parts.append(f"some {self.seconds / 60:.0f} min" if self.seconds > 90 else "about a minute")
        return f"{self.option}: {', '.join(parts)}"


def confirm(ahead: Ahead, *, yes: bool) -> None:
    """Goes on where it is not much, or wanted; at a terminal it asks.

    Raises `RequestError` where nobody can answer; a no ends the command with exit 2, too.
    """
    if yes or not ahead.asks:
        return
    if sys.stdin.isatty() and sys.stderr.isatty():
        if typer.confirm(f"{ahead}; go on?", err=True):
            return
        typer.echo("nothing is written", err=True)
        raise typer.Exit(2)
    raise RequestError(f"{ahead}; give --yes to go on")


def size_text(size: float) -> str:
    """A size in the unit that people read.

    >>> size_text(1.7e9), size_text(250e6)
    ('1.7 GB', '250 MB')
    """
    return f"{size / 1e9:.1f} GB" if size >= 1e9 else f"{size / 1e6:.0f} MB"


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
        # only what writes tables needs it
        from sevenbar.reporting.csv_tables import write_csv

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
