"""The tally of a survey: why linkages were refused, how measures are spread, the best so far.

Tallies are put together in any order: counts are summed, and of each part of the space of numbers the best
linkage is kept, earlier ones first where two are as good. A part of the space that is among the first hundred
of all linkages is among the first hundred of those where its best is, so that a hundred are enough to keep.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from sevenbar.kinematics.solvers.batches import CODES, VERDICTS, RawTally

#: How many of the best are kept.
BEST = 100

#: Motion types that are counted.
TYPES = CODES[:6]


@dataclass(frozen=True)
class Kept:
    """A linkage of a survey: its index and its place, and what was measured of it.

    `place` is its part of the space, or the verdict whose nearest it is. `figure` ranks it, less is better.
    `error`, `transmission`, `balls` (NaN where not measured) and the input's `start` are angles [rad].
    `sense` is -1 where the output counts against its axis.
    """

    index: int
    place: int
    figure: float
    error: float
    transmission: float
    balls: tuple[float, float]
    start: float
    branch: int
    sense: float

    @property
    def order(self) -> tuple[float, int]:
        """The order among those kept."""
        return (self.figure, self.index)


@dataclass(frozen=True)
class SurveyTally:
    """Counts of linkages by verdict, motion type and limits; spreads of measures; the best and the nearest.

    `spreads` have for each measure the width of a cell [rad] and the counts (36,), the last of all beyond.
    """

    verdicts: Mapping[str, int]
    types: Mapping[str, int]
    limits: Mapping[str, int]
    spreads: Mapping[str, tuple[float, tuple[int, ...]]]
    best: tuple[Kept, ...]
    nearest: Mapping[int, Kept]

    @property
    def count(self) -> int:
        """The linkages that were judged."""
        return sum(self.verdicts.values())

    @property
    def found(self) -> int:
        """Those that do what is wanted."""
        return self.verdicts["found"]

    @property
    def refused(self) -> dict[str, int]:
        """Those refused, by verdict."""
        return {verdict: count for verdict, count in self.verdicts.items() if verdict != "found"}

    @staticmethod
    def of(raw: RawTally) -> SurveyTally:
        """The tally of one part, as the core has it."""
        return SurveyTally(
            dict(zip(VERDICTS, raw.verdicts, strict=True)),
            dict(zip(TYPES, raw.types, strict=True)),
            dict(zip(("0", "2", "4"), raw.limits, strict=True)),
            {name: (step, tuple(counts)) for name, (step, counts) in sorted(raw.spreads.items())},
            _kept(raw.best),
            {selected.place: selected for selected in _kept(raw.nearest)},
        )

    def __add__(self, other: SurveyTally) -> SurveyTally:
        """Both put together."""
        best = _first_of_each(*self.best, *other.best)
        nearest = _first_of_each(*self.nearest.values(), *other.nearest.values())
        return SurveyTally(
            _together(self.verdicts, other.verdicts),
            _together(self.types, other.types),
            _together(self.limits, other.limits),
            {
                name: (step, tuple(np.add(counts, other.spreads[name][1]).tolist()))
                for name, (step, counts) in self.spreads.items()
            },
            tuple(sorted(best.values(), key=lambda kept: kept.order)[:BEST]),
            dict(sorted(nearest.items())),
        )

    def as_dict(self) -> dict[str, Any]:
        """As plain values."""
        return {
            "verdicts": dict(self.verdicts),
            "motion_types": dict(self.types),
            "limits": dict(self.limits),
            "spreads": {
                name: {"step": step, "counts": list(counts)} for name, (step, counts) in self.spreads.items()
            },
            "best": [_row(selected) for selected in self.best],
            "nearest": [_row(selected) for selected in self.nearest.values()],
        }

    def line(self) -> str:
        """As one line of a journal."""
        return json.dumps(self.as_dict(), separators=(",", ":"))

    @staticmethod
    def of_dict(plain: Mapping[str, Any]) -> SurveyTally:
        """The tally of plain values; raises `KeyError`, `TypeError` or `ValueError` where they are none."""
        return SurveyTally(
            plain["verdicts"],
            plain["motion_types"],
            plain["limits"],
            {name: (s["step"], tuple(s["counts"])) for name, s in plain["spreads"].items()},
            tuple(_of_row(row) for row in plain["best"]),
            {selected.place: selected for selected in map(_of_row, plain["nearest"])},
        )


def _kept(entries: tuple[Any, Any, Any]) -> tuple[Kept, ...]:
    rows = zip(*(array.tolist() for array in entries), strict=True)
    return tuple(_of_row([index, place, *row]) for index, place, row in rows)


def _first_of_each(*every: Kept) -> dict[int, Kept]:
    """The first linkage, by its order, of each place."""
    return {kept.place: kept for kept in sorted(every, key=lambda kept: kept.order, reverse=True)}


def _row(kept: Kept) -> list[Any]:
    """A linkage as plain values; what was not measured is null."""
    measured = [None if math.isnan(x) else x for x in (kept.error, kept.transmission, *kept.balls)]
    return [kept.index, kept.place, kept.figure, *measured, kept.start, kept.branch, kept.sense]


def _of_row(row: Sequence[Any]) -> Kept:
    index, place, figure, *measured, start, branch, sense = row
    error, transmission, crank, rocker = (math.nan if x is None else float(x) for x in measured)
    return Kept(index, place, figure, error, transmission, (crank, rocker), start, int(branch), sense)


def _together(a: Mapping[str, int], b: Mapping[str, int]) -> dict[str, int]:
    words = a if a.keys() == b.keys() else sorted(a.keys() | b.keys())
    return {word: a.get(word, 0) + b.get(word, 0) for word in words}
