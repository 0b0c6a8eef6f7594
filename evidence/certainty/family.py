"""A family of linkages and what each must do; its cases follow from the seed, its name and their number."""

from __future__ import annotations

import time
import warnings
import zlib
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from evidence.fuzz.checks import Broken
from sevenbar.errors import AngleUnitWarning

#: Draws a linkage and judges it: raises `Broken` where something does not hold, counts what it sees.
Judge = Callable[[np.random.Generator, Counter[str]], None]


@dataclass(frozen=True)
class Family:
    """`count` linkages of a kind; `quick` of them make a small sample."""

    part: str
    name: str
    count: int
    judge: Judge
    quick: int = 2


@dataclass
class Row:
    """What was seen of the cases of a family."""

    linkages: int = 0
    #: Processor time [s].
    seconds: float = 0.0
    seen: Counter[str] = field(default_factory=Counter)
    #: Number of the case and what did not hold.
    differences: list[tuple[int, str]] = field(default_factory=list)

    def merge(self, other: Row) -> None:
        """Adds further cases."""
        self.linkages += other.linkages
        self.seconds += other.seconds
        self.seen.update(other.seen)
        self.differences += other.differences


def judged(family: Family, seed: int, first: int, last: int) -> Row:
    """The cases `first` to `last` (left out); an error or a warning is a difference too."""
    row, start = Row(linkages=last - first), time.process_time()
    for index in range(first, last):
        rng = np.random.default_rng([seed, zlib.crc32(family.name.encode()), index])
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                warnings.simplefilter("ignore", AngleUnitWarning)
                family.judge(rng, row.seen)
        except Broken as broken:
            row.differences.append((index, str(broken)))
        except Exception as error:  # each case is judged whatever became of another
            row.differences.append((index, f"{type(error).__name__}: {error}".splitlines()[0]))
    row.seconds = time.process_time() - start
    return row
