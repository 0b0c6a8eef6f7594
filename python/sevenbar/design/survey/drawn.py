"""What every survey is to its run and its journal: linkages in parts, each part judged by itself."""

from __future__ import annotations

import hashlib
import json
from abc import ABC, abstractmethod
from typing import Any

from sevenbar.design.survey.tally import Kept, SurveyTally
from sevenbar.errors import RequestError

#: Most linkages: indices beyond are no whole numbers in every program's JSON.
MOST = 2**50


class Drawn(ABC):
    """Linkages drawn from a sequence by their index, and what is wanted of them."""

    count: int
    seed: int

    @property
    @abstractmethod
    def part_size(self) -> int:
        """Linkages of a part."""

    @property
    @abstractmethod
    def verdicts(self) -> tuple[str, ...]:
        """What may be said of a linkage; the first is that it does what is wanted."""

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
        """Raises `RequestError` for a count or a seed that is none."""
        if not 1 <= self.count <= most:
            raise RequestError(f"count: {self.count} is no number of linkages; give 1 to {most}")
        if self.seed < 0:
            raise RequestError(f"seed: {self.seed} is no seed; give a number >= 0")
