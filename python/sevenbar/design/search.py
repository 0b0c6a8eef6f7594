"""One search for designs: starts are solved and checked one by one; those that differ, best first."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Generic, TypeVar

from sevenbar.design.candidates import Candidate, DesignResult, Refusal, distinct, renamed, tally
from sevenbar.design.course import SearchCourse
from sevenbar.text.printing import Printed
from sevenbar.text.progress import Progress, silent

S = TypeVar("S")
T = TypeVar("T", bound=DesignResult)


@dataclass(frozen=True, eq=False, repr=False)
class Designs(Printed, Generic[T]):
    """The designs of a search, best first, and why others were refused, the nearest first.

    `unfinished` is the remark about a search that was stopped; empty for one that ended by itself.
    """

    designs: tuple[T, ...]
    refusals: tuple[Refusal, ...] = ()
    unfinished: str = ""

    @property
    def candidates(self) -> tuple[Candidate, ...]:
        """What the ordinary analysis says of each design."""
        return tuple(design.candidate for design in self.designs)

    @property
    def refused(self) -> str:
        """What was refused, the commonest first: "12 by cone, 3 by order"."""
        return tally(self.refusals)


class DesignSearch(SearchCourse, Generic[T]):
    """A search for `count` designs that differ (`distinct`), with the steps that it has done."""

    def __init__(
        self,
        total: int,
        progress: Progress = silent,
        *,
        count: int,
        scale_free: bool = True,
        mirrored: bool = False,
    ) -> None:
        super().__init__(total, progress)
        self.count = count
        self._alike = {"scale_free": scale_free, "mirrored": mirrored}
        #: Designs and refusals as they were solved, each with its figure: less is better, or nearer.
        self.checked: list[tuple[float, T]] = []
        self.refused: list[tuple[float, Refusal]] = []
        self._different: list[T] | None = None

    def over(
        self,
        starts: Iterable[S],
        solve: Callable[[S], tuple[float, T | Refusal] | None],
        words: Callable[[list[T]], str],
        *,
        enough: Callable[[], bool] = lambda: False,
    ) -> None:
        """Solves each start until it is `enough`; `words` say of the designs what the best so far is.

        `solve` gives a design that passed the check, or why it did not, with its figure; `None` for a start
        that leads nowhere.
        """
        for start in starts:
            if enough():
                return
            figure, result = solve(start) or (0.0, None)
            if isinstance(result, Refusal):
                self.refused.append((figure, result))
            elif result is not None:
                self.checked.append((figure, result))
                self._different = None
            self.step(words([design for _, design in self.checked]))

    @property
    def different(self) -> list[T]:
        """The designs that differ, best first."""
        if self._different is None:
            self._different = distinct(_ranked(self.checked), **self._alike)
        return self._different

    @property
    def enough(self) -> bool:
        """Whether as many as are wanted differ."""
        return len(self.different) >= self.count

    def result(self, title: str) -> Designs[T]:
        """The best `count` of the designs that differ, with the names `title, design 1`, .."""
        best = renamed(self.different[: self.count], title)
        return Designs(tuple(best), tuple(_ranked(self.refused)), self.unfinished)


def _ranked(pairs: list[tuple[float, S]]) -> list[S]:
    """What has the least figure first."""
    return [one for _, one in sorted(pairs, key=lambda pair: pair[0])]
