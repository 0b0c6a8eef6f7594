"""The thread of a tab: what is done, in which order, when, and what ends it."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from sevenbar.studio.worker import FRAME, Worker

#: The longest [s] that anything here may take, however busy the machine.
PATIENCE = 10.0


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


def test_a_delay_is_kept_and_begins_anew_with_each_word() -> None:
    with started() as watched:
        begun = time.monotonic()
        for i in range(3):
            watched.worker.ask("typed", lambda i=i: watched.done.append((i, time.monotonic())), delay=0.15)
            time.sleep(0.05)
        watched.worker.ask("now", watched.note("now"))
        assert waited(lambda: len(watched.done) == 2)
        assert watched.done[0] == "now"
        last, when = watched.done[1]
        assert last == 2
        assert when - begun >= 0.1 + 0.15


def test_it_ticks_at_thirty_hertz_while_it_plays_and_not_otherwise() -> None:
    with started() as watched:
        watched.worker.ask("x", watched.note("x"))
        time.sleep(0.15)
        assert not watched.ticks

        watched.worker.ask("play", lambda: setattr(watched.worker, "playing", True))
        begun = time.monotonic()
        time.sleep(0.6)
        watched.worker.ask("pause", lambda: setattr(watched.worker, "playing", False))
        assert waited(lambda: not watched.worker.playing)
        played, count = time.monotonic() - begun, len(watched.ticks)
        # the time told is the time that passed: none of the pause before
        assert played - 3 * FRAME - 0.1 <= sum(watched.ticks) <= played
        assert count <= played / FRAME + 1
        assert count >= 8
        time.sleep(0.15)
        assert len(watched.ticks) == count


def test_it_ticks_on_while_a_person_drags() -> None:
    with started() as watched:
        watched.worker.ask("play", lambda: setattr(watched.worker, "playing", True))
        begun = time.monotonic()
        while time.monotonic() - begun < 0.3:
            watched.worker.ask("drag", lambda: None)
            time.sleep(0.003)
        assert len(watched.ticks) >= 5
        assert sum(watched.ticks) <= time.monotonic() - begun


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
        begun = time.monotonic()
        watched.worker.end()
        watched.worker.join(PATIENCE)
        assert time.monotonic() - begun < 1.0
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
