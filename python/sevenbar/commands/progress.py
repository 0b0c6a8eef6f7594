"""How long work reports: a line that says what is done, then a bar with the best so far, on the error stream.

    with progress_bar("mapping the RSSR") as progress:
        result = motion_map(.., progress=progress)

calls `progress(done, total)`, or `progress(done, total, "best 0.1 deg")`.

Whoever works reports `progress(0, total)` once the request is checked and before the long part begins: that
shows the line, so the message of a refusal has no line above it. A total that is not known is 0.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import typer

from sevenbar.commands.signals import stopped
from sevenbar.reporting.folder import Stopped

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID


#: Work that takes less [s] is not announced.
SHORT = 5.0

#: Longer times [s] are announced in minutes.
MINUTES_FROM = 90.0


class WorkBar:
    """What was reported of one piece of work: a bar on a terminal, one plain line elsewhere."""

    def __init__(self, title: str, *, rate: bool) -> None:
        self._title, self._rate = title, rate
        self._started = False
        self._bar: Progress | None = None
        self._task: TaskID | None = None

    def __call__(self, done: float, total: int, best: str = "") -> None:
        """Reports `done` of `total` steps (0: not known), and what the best so far is, or what is at work."""
        if not self._started:
            self._start(done, total)
        if self._bar is not None and self._task is not None:
            self._bar.update(self._task, completed=done, total=total or None, best=best)

    def ahead(self, count: int, seconds: float) -> None:
        """Says before long work how many linkages are analysed one by one, and how long that takes about."""
        if seconds < SHORT:
            return
        time = f"{seconds / 60:.0f} min" if seconds > MINUTES_FROM else f"{seconds:.0f} s"
        words = f"about {count:,} linkages are analysed one by one, which takes some {time}"
        if self._bar is None:
            typer.echo(words, err=True)
        else:
            self._bar.console.print(words, highlight=False)

    def end(self, *, erase: bool) -> None:
        """Leaves the bar as it is, or takes it away."""
        if self._bar is not None:
            self._bar.live.transient = erase
            self._bar.stop()

    def _start(self, done: float, total: int) -> None:
        self._started = True
        if not sys.stderr.isatty():
            # of a bar in a log file only its frames would be left
            typer.echo(f"{self._title} ..", err=True)
            return
        self._bar = _bar(rate=self._rate)
        self._bar.start()
        # what a resumed run has done already must not count as speed
        self._task = self._bar.add_task(self._title, total=total or None, completed=int(done), best="")


@contextmanager
def progress_bar(
    title: str, *, rate: bool = False, kept: str | None = "nothing is written"
) -> Iterator[WorkBar]:
    """Shows how far work is; with `rate` how many steps a second.

    Ctrl+C, as any signal that ends a program, ends the command with "stopped; " and what is `kept`; where
    that is `None` the caller knows what is kept, and `KeyboardInterrupt` goes on to it.
    """
    bar = WorkBar(title, rate=rate)
    try:
        yield bar
    except KeyboardInterrupt as stop:
        bar.end(erase=False)
        if kept is None:
            raise
        typer.echo(f"sevenbar: stopped; {stop.kept if isinstance(stop, Stopped) else kept}", err=True)
        raise typer.Exit(stopped()) from None
    except BaseException:
        # no line above the message that follows
        bar.end(erase=True)
        raise
    bar.end(erase=False)


def _bar(*, rate: bool) -> Progress:
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        ProgressColumn,
        Task,
        TextColumn,
        TimeRemainingColumn,
    )
    from rich.text import Text

    class Rate(ProgressColumn):
        """Steps a second."""

        def render(self, task: Task) -> Text:
            speed = task.finished_speed or task.speed
            return Text("" if speed is None else f"{speed:,.0f}/s")

    columns = [TextColumn("{task.description}", markup=False), BarColumn(), MofNCompleteColumn()]
    best = TextColumn("{task.fields[best]}", markup=False)
    rates = [Rate()] if rate else []
    return Progress(*columns, best, *rates, TimeRemainingColumn(), console=Console(stderr=True))
