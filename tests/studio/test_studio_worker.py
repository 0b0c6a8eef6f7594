"""The thread of a tab: what is done, in which order, when, and what ends it."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import pytest

from sevenbar.studio import worker
from sevenbar.studio.worker import FRAME, Worker

#: The longest [s] that anything here may take: a guard against hanging.
PATIENCE = 600.0


class Clock:
    """A clock [s] in the worker's place of the machine's, which goes on only when it is told to."""

    def __init__(self) -> None:
        self.now = 0.0

    def monotonic(self) -> float:
        return self.now


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    made = Clock()
    monkeypatch.setattr(worker, "time", made)
    return made


class Watched:
    """A worker, and what it did."""

    def __init__(self) -> None:
        self.done: list[Any] = []
        self.ticks: list[float] = []
        self.rounds = 0
        self.faults = 0
        self.worker = Worker(self.ticks.append, self._after, self._fault)

    def _after(self) -> None:
        self.rounds += 1

    def _fault(self) -> None:
        self.faults += 1

    def note(self, what: object) -> Callable[[], None]:
        return lambda: self.done.append(what)


@contextmanager
def started() -> Iterator[Watched]:
    watched = Watched()
    watched.worker.start()
    try:
        yield watched
    finally:
        watched.worker.end()
        watched.worker.join(PATIENCE)
        assert not watched.worker.is_alive()


def waited(until: Callable[[], bool]) -> bool:
    end = time.monotonic() + PATIENCE
    while not until() and time.monotonic() < end:
        time.sleep(0.002)
    return until()


@contextmanager
def busy(watched: Watched) -> Iterator[None]:
    """The worker is held in an action, while more is asked for."""
    begun, go = threading.Event(), threading.Event()
    watched.worker.ask("busy", lambda: (begun.set(), go.wait(PATIENCE)))
    assert begun.wait(PATIENCE)
    yield
    go.set()


def test_actions_are_done_in_the_order_they_were_asked_for() -> None:
    with started() as watched:
        with busy(watched):
            for i in range(50):
                watched.worker.ask(i, watched.note(i))
        assert waited(lambda: len(watched.done) == 50)
        assert watched.done == list(range(50))


def test_of_several_with_one_key_the_last_alone_is_done_and_at_its_own_turn() -> None:
    with started() as watched:
        with busy(watched):
            for i in range(20):
                watched.worker.ask("drag", watched.note(f"drag {i}"))
            watched.worker.ask("undo", watched.note("undo"))
            watched.worker.ask("drag", watched.note("drag again"))
        assert waited(lambda: len(watched.done) == 2)
        time.sleep(0.02)
        assert watched.done == ["undo", "drag again"]


def test_what_is_overtaken_while_another_of_its_round_is_done_is_left_out() -> None:
    with started() as watched:
        with busy(watched):
            begun, go = threading.Event(), threading.Event()
            watched.worker.ask("slow", lambda: (begun.set(), go.wait(PATIENCE)))
            watched.worker.ask("drag", watched.note("old"))
            watched.worker.ask("undo", watched.note("undo"))
        assert begun.wait(PATIENCE)
        assert watched.worker.awaits("drag")
        watched.worker.ask("drag", watched.note("new"))
        go.set()
        assert waited(lambda: len(watched.done) == 2)
        time.sleep(0.02)
        assert watched.done == ["undo", "new"]


def test_awaits_tells_of_what_is_asked_for_and_not_yet_begun() -> None:
    with started() as watched:
        with busy(watched):
            assert not watched.worker.awaits("busy")
            assert not watched.worker.awaits("later")
            watched.worker.ask("later", watched.note("later"))
            assert watched.worker.awaits("later")
        assert waited(lambda: watched.done == ["later"])
        assert not watched.worker.awaits("later")


def after_a_round(watched: Watched) -> None:
    """Once all that is due now is done."""
    done = threading.Event()
    watched.worker.ask(object(), done.set)
    assert done.wait(PATIENCE)
    rounds = watched.rounds
    again = threading.Event()
    watched.worker.ask(object(), again.set)
    assert again.wait(PATIENCE)
    assert waited(lambda: watched.rounds > rounds)


def test_a_delay_is_kept_and_begins_anew_with_each_word(clock: Clock) -> None:
    with started() as watched:
        for i in range(3):
            clock.now = 0.05 * i
            watched.worker.ask("typed", watched.note(i), delay=0.15)
        clock.now = 0.2499
        after_a_round(watched)
        assert watched.done == []
        clock.now = 0.2501
        assert waited(lambda: watched.done == [2])


def test_it_ticks_at_thirty_hertz_while_it_plays_and_not_otherwise(clock: Clock) -> None:
    with started() as watched:
        clock.now = 5.0
        after_a_round(watched)
        assert not watched.ticks

        watched.worker.ask("play", lambda: setattr(watched.worker, "playing", True))
        assert waited(lambda: watched.worker.playing)
        for count in range(1, 9):
            clock.now = 5.0 + 1.001 * FRAME * count
            # one tick for a frame, however long it is waited for
            assert waited(lambda count=count: len(watched.ticks) == count)
        # the time told is the time that passed: none of the pause before
        assert sum(watched.ticks) == pytest.approx(8 * 1.001 * FRAME, rel=1e-9)
        watched.worker.ask("pause", lambda: setattr(watched.worker, "playing", False))
        assert waited(lambda: not watched.worker.playing)
        clock.now = 9.0
        after_a_round(watched)
        assert len(watched.ticks) == 8


def test_it_ticks_on_while_a_person_drags(clock: Clock) -> None:
    with started() as watched:
        watched.worker.ask("play", lambda: setattr(watched.worker, "playing", True))
        assert waited(lambda: watched.worker.playing)
        for i in range(20):
            clock.now += 0.25 * FRAME
            watched.worker.ask("drag", watched.note(i))
            assert waited(lambda i=i: i in watched.done)
        after_a_round(watched)
        assert len(watched.ticks) >= 5
        assert sum(watched.ticks) == pytest.approx(clock.now, rel=1e-9)


def test_what_it_shows_comes_after_each_round() -> None:
    with started() as watched:
        with busy(watched):
            before = watched.rounds
            for i in range(5):
                watched.worker.ask(i, watched.note(i))
        # the round held, and the one of the five
        assert waited(lambda: watched.rounds == before + 2)
        assert len(watched.done) == 5


def test_a_fault_is_told_and_the_work_goes_on() -> None:
    with started() as watched:
        with busy(watched):
            watched.worker.ask("wrong", lambda: 1 / 0)
            watched.worker.ask("right", watched.note("right"))
        assert waited(lambda: watched.done == ["right"])
        assert watched.faults == 1


def test_a_fault_in_telling_a_fault_does_not_stop_it_either() -> None:
    watched = Watched()
    watched.worker = Worker(watched.ticks.append, lambda: 1 / 0, lambda: 1 / 0)
    watched.worker.start()
    watched.worker.ask("wrong", lambda: 1 / 0)
    watched.worker.ask("right", watched.note("right"))
    assert waited(lambda: watched.done == ["right"])
    assert watched.worker.is_alive()
    watched.worker.end()
    watched.worker.join(PATIENCE)
    assert not watched.worker.is_alive()


def test_it_ends_at_once_even_in_a_long_wait() -> None:
    for delay in (None, 3600.0):
        watched = Watched()
        watched.worker.start()
        if delay is not None:
            watched.worker.ask("later", watched.note("later"), delay=delay)
        time.sleep(0.05)
        watched.worker.end()
        # the guard is shorter than the wait
        watched.worker.join(PATIENCE)
        assert not watched.worker.is_alive()
        assert not watched.done


def test_nothing_is_done_or_shown_once_it_has_ended() -> None:
    with started() as watched:
        with busy(watched):
            rounds = watched.rounds
            watched.worker.ask("more", watched.note("more"))
            watched.worker.end()
        watched.worker.join(PATIENCE)
        watched.worker.ask("late", watched.note("late"))
        assert not watched.done
        assert watched.rounds == rounds
