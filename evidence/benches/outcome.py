"""The result of a case: tables and plots, as they are kept in the JSON and shown on the page."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

from evidence.benches.harness import Timing

#: A cell: a number, a word, or nothing.
Cell = float | str | None


@dataclass(frozen=True)
class Table:
    """A heading, names of columns, rows of as many cells; the last column holds notes and reasons."""

    title: str
    columns: list[str]
    rows: list[list[Cell]]


@dataclass(frozen=True)
class Series:
    """Points of a curve; a `yardstick`: what the machine does with simpler work."""

    label: str
    x: list[float]
    y: list[float]
    yardstick: bool = False


@dataclass(frozen=True)
class Plot:
    """A figure of curves on logarithmic axes; `name` is its file's."""

    name: str
    title: str
    x_label: str
    y_label: str
    series: list[Series]


@dataclass(frozen=True)
class Outcome:
    """Tables and plots of one case, and `failure` where it ended before its end."""

    title: str
    about: str
    tables: list[Table] = field(default_factory=list)
    plots: list[Plot] = field(default_factory=list)
    failure: str = ""

    def to_json(self) -> dict[str, Any]:
        """As JSON takes it: what is not a finite number is null."""
        plain: dict[str, Any] = _finite(asdict(self))
        return plain

    @staticmethod
    def of_json(raw: dict[str, Any]) -> Outcome:
        """From what `to_json` gave."""
        plots = [
            Plot(**(plot | {"series": [Series(**curve) for curve in plot["series"]]}))
            for plot in raw["plots"]
        ]
        return Outcome(**(raw | {"tables": [Table(**table) for table in raw["tables"]], "plots": plots}))


def _finite(value: Any) -> Any:
    match value:
        case float():
            return value if math.isfinite(value) else None
        case dict():
            return {key: _finite(part) for key, part in value.items()}
        case list():
            return [_finite(part) for part in value]
        case _:
            return value


def timed(title: str, unit: str, timings: Sequence[Timing], absent: Sequence[tuple[str, str]] = ()) -> Table:
    """The table of a comparison; `unit` as "ns a pose", and `absent` peers, each with its reason."""
    scale = {"ns": 1e9, "ms": 1e3}[unit.split()[0]]
    rows: list[list[Cell]] = [
        [
            timing.who,
            *(scale * value for value in (timing.median, timing.low, timing.high)),
            timing.ratio,
            timing.ratio_low,
            timing.ratio_high,
            timing.failure or timing.note,
        ]
        for timing in timings
    ]
    rows += [[who, None, None, None, None, None, None, reason] for who, reason in absent]
    return Table(title, ["", unit, "from", "to", "ratio", "from", "to", "note"], rows)
