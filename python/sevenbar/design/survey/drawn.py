"""What every survey is to its run and its journal: linkages in parts, each part judged by itself."""

from __future__ import annotations

import hashlib
import json
from abc import ABC, abstractmethod
from typing import Any, ClassVar

from sevenbar.arrays import whole_number
from sevenbar.design.survey.tally import Kept, SurveyTally

#: The format of a survey's description.
FORMAT = 2

#: Most linkages: indices beyond are no whole numbers in every program's JSON.
MOST = 2**50

#: Greatest seed: the core counts in 64 bits.
MOST_SEED = 2**64 - 1


class Drawn(ABC):
    """Linkages drawn from a sequence by their index, and what is wanted of them."""

    count: int
    seed: int

    #: Linkages of a part.
    part_size: ClassVar[int]
    #: What may be said of a linkage; the first is that it does what is wanted.
    verdicts: ClassVar[tuple[str, ...]]

    @property
    @abstractmethod
    def heading(self) -> str:
        """What it is."""

    @abstractmethod
    def request(self) -> dict[str, Any]:
        """What the survey is, as plain values: two surveys with one request have the same answer."""

    @abstractmethod
    def tally(self, part: int) -> SurveyTally:
        """The tally of a part: the same wherever it is made by the same `maker`."""

    @abstractmethod
    def words_of(self, verdict: str, kept: Kept) -> str:
        """A linkage that came nearest to pass a verdict: its figures and its numbers."""

    @property
    def parts(self) -> int:
        """The number of parts."""
        return -(-self.count // self.part_size)

    def linkages(self, part: int) -> range:
        """The linkages of a part."""
        return range(part * self.part_size, min((part + 1) * self.part_size, self.count))

    def digest(self) -> str:
        """The mark of the survey, which its journal carries."""
        return hashlib.sha256(json.dumps(self.request(), sort_keys=True).encode()).hexdigest()

    def check_counts(self, most: int = MOST) -> None:
        """Makes count and seed plain whole numbers; raises `RequestError` where one is none."""
        count = whole_number("count", self.count, 1, most, "a number of linkages")
        seed = whole_number("seed", self.seed, 0, MOST_SEED, "a seed")
        # a task cannot be changed but while it is made
        object.__setattr__(self, "count", count)
        object.__setattr__(self, "seed", seed)
