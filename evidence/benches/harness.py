"""Works timed in turns: the same rounds for all, medians of CPU or wall time, ratios with their spread."""

from __future__ import annotations

import math
import signal
import statistics
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

#: Shortest time [s] of one timing: some thousand times what the clock tells apart.
SHORTEST = 2e-3

#: How many times longer a first call than the shortest timing tells that one call will do.
FIRST = 20

#: Ends of the spread that is reported, relative to the rounds: one in ten lies outside on either side.
LOW, HIGH = 0.1, 0.9

Clock = Callable[[], float]


@dataclass(frozen=True)
class Work:
    """One way to do what a table compares: who does it, the call, how many items one call does, a note.

    `check` is given what the first call returns and raises `AssertionError` where that is wrong.
    """

    who: str
    call: Callable[[], Any]
    items: int = 1
    note: str = ""
    check: Callable[[Any], None] = lambda _: None


@dataclass(frozen=True)
class Timing:
    """Seconds an item, median and spread over the rounds, and the ratio to the first work's in each round.

    `ratio` above 1: slower than the first. A work that failed has `failure`, and NaN for the rest.
    """

    who: str
    median: float = math.nan
    low: float = math.nan
    high: float = math.nan
    ratio: float = math.nan
    ratio_low: float = math.nan
    ratio_high: float = math.nan
    note: str = ""
    failure: str = ""


def compare(
    works: Sequence[Work], *, rounds: int, clock: Clock = time.process_time, shortest: float = SHORTEST
) -> list[Timing]:
    """Each work once a round, each round begun by another one, so that no work always follows the same.

    A call is repeated within a round, so that it lasts `shortest` [s]. A peer whose first call raises, or
    whose answer its check refuses, is told by its failure and left out of the rounds: other work has no
    ratio. A failure of the first work is raised.
    """
    repeats, failures = {}, {}
    for place, work in enumerate(works):
        start = clock()
        try:
            work.check(work.call())
        except Exception as error:
            if place == 0:
                raise
            failures[place] = told(error)
            continue
        repeats[place] = 1
        # a first call is often the slowest: only one that is very long tells enough
        if clock() - start < FIRST * shortest:
            while seconds(work.call, repeats[place], clock) < shortest:
                repeats[place] *= 2
    places = list(repeats)
    spent: dict[int, list[float]] = {place: [] for place in places}
    for number in range(rounds):
        first = number % len(places)
        for place in places[first:] + places[:first]:
            work, count = works[place], repeats[place]
            spent[place].append(seconds(work.call, count, clock) / (count * work.items))
    timings = []
    for place, work in enumerate(works):
        if place in failures:
            timings.append(Timing(work.who, note=work.note, failure=failures[place]))
            continue
        own = spent[place]
        ratios = [a / b if b > 0 else math.nan for a, b in zip(own, spent[0], strict=True)]
        timings.append(Timing(work.who, *spread(own), *spread(ratios), note=work.note))
    return timings


def seconds(call: Callable[[], object], count: int, clock: Clock = time.process_time) -> float:
    """Time [s] of so many calls."""
    start = clock()
    for _ in range(count):
        call()
    return clock() - start


def spread(values: Sequence[float]) -> tuple[float, float, float]:
    """The median, and the values that one in ten lies below and one in ten above."""
    ordered = sorted(values)
    last = len(ordered) - 1
    return statistics.median(ordered), ordered[round(LOW * last)], ordered[round(HIGH * last)]


def told(error: BaseException) -> str:
    """What went wrong, in one line."""
    if isinstance(error, AssertionError):
        return f"disagrees: {' '.join(str(error).split())[:200]}"
    first = (str(error).strip().splitlines() or [""])[0].strip()
    return f"{type(error).__name__}: {first}" if first else type(error).__name__


class OutOfTimeError(Exception):
    """Work that was given a time and took longer."""


@contextmanager
def at_most(limit: float) -> Iterator[None]:
    """Ends Python code that takes more CPU time [s] than that with `OutOfTimeError`; for the main thread."""

    def stop(*_: object) -> None:
        raise OutOfTimeError(f"not done after {limit:.2g} s of CPU time")

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, limit)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)
