"""How a search reports on its way: steps done, the best so far; and that it was stopped before its end."""

from __future__ import annotations

from collections.abc import Iterator, Sized
from contextlib import contextmanager

from sevenbar.text.progress import Progress, silent

#: The remark about a search that Ctrl+C ended.
UNFINISHED = "stopped after {done} of {total} steps; these are the best so far"


class SearchCourse:
    """The steps of a search as they are done.

    >>> course = SearchCourse(2, lambda *step: print(step))
    (0, 2, '')
    >>> course.step("best 0.1 deg")
    (1, 2, 'best 0.1 deg')
    >>> with course.until_stopped(["a design"]):
    ...     raise KeyboardInterrupt
    >>> course.unfinished
    'stopped after 1 of 2 steps; these are the best so far'
    """

    #: The remark about a search that was stopped; empty for one that ended by itself.
    unfinished = ""

    def __init__(self, total: int, progress: Progress = silent) -> None:
        self.total, self._progress = total, progress
        self.done, self._best = 0, ""
        self.report()

    def step(self, best: str = "", *, done: int = 1) -> None:
        """Counts steps, and keeps what the best is."""
        self.done = min(self.done + done, self.total)
        self._best = best or self._best
        self.report()

    def longer(self, more: int) -> None:
        """Adds steps that turned out to be needed."""
        self.total += more
        self.report()

    def end(self) -> None:
        """Steps that were not needed are done."""
        self.done = self.total
        self.report()

    def report(self) -> None:
        """Reports where the search is."""
        self._progress(self.done, self.total, self._best)

    @contextmanager
    def until_stopped(self, kept: Sized, fewest: int = 1) -> Iterator[None]:
        """Searches to the end, or until Ctrl+C, which is raised while fewer than `fewest` are kept."""
        try:
            yield
            self.end()
        except KeyboardInterrupt:
            if len(kept) < fewest:
                raise
            self.unfinished = UNFINISHED.format(done=self.done, total=self.total)
