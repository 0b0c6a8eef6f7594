"""The thread of one tab: does what the page asks for, one thing after the other, and keeps time."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Hashable
from contextlib import suppress
from functools import partial

from sevenbar._core import WorkStop

#: Time [s] from picture to picture while a motion plays.
FRAME = 1 / 30

#: An action, and when [s] it is due.
_Asked = tuple[float, Callable[[], object]]


class Worker(threading.Thread):
    """Does actions in the order they were asked for; of several with one key the last alone.

    While a slider is dragged, values come faster than they can be shown; those that were overtaken are left
    out. `tick(seconds)` is called once a frame while `playing`, and `after` behind each round of actions.
    `fault` is called within the handling of an exception that one of them let through; the work goes on.
    """

    def __init__(
        self, tick: Callable[[float], None], after: Callable[[], None], fault: Callable[[], None]
    ) -> None:
        super().__init__(daemon=True, name="sevenbar-studio-tab")
        self.playing = False
        self._tick, self._after, self._fault = tick, after, fault
        self._asked: dict[Hashable, _Asked] = {}
        self._wake = threading.Condition()
        self._ended = False
        # what the core does in this thread, given up when the tab is gone
        self._giving_up = WorkStop()

    def ask(self, key: Hashable, action: Callable[[], object], *, delay: float = 0.0) -> None:
        """Has an action done, after a delay [s]; it takes the place of one with the same key."""
        with self._wake:
            self._asked.pop(key, None)
            self._asked[key] = (time.monotonic() + delay, action)
            self._wake.notify()

    def awaits(self, key: Hashable) -> bool:
        """Whether an action with this key is still to be done."""
        with self._wake:
            return key in self._asked

    def end(self) -> None:
        """Ends the thread: the action in hand as soon as the core leaves off."""
        self._giving_up.stop()
        with self._wake:
            self._ended = True
            self._wake.notify()

    def run(self) -> None:
        """Until `end`."""
        with self._giving_up, suppress(KeyboardInterrupt):
            self._go_on()

    def _go_on(self) -> None:
        last = time.monotonic()
        while True:
            asked = self._due(last)
            if asked is None:
                return
            now, played = time.monotonic(), self.playing
            for key, one in asked:
                if self._takes(key, one):
                    self._guarded(one[1])
            # the time before a motion plays is none of its own
            if played and self.playing:
                self._guarded(partial(self._tick, now - last))
            last = now
            self._guarded(self._after)

    def _guarded(self, action: Callable[[], object]) -> None:
        if self._ended:
            return
        try:
            action()
        except Exception:
            # the page may be gone, and is where the tab has ended meanwhile
            with suppress(Exception):
                if not self._ended:
                    self._fault()

    def _takes(self, key: Hashable, one: _Asked) -> bool:
        """Takes an action out of what is asked for, unless another has taken its place."""
        with self._wake:
            if self._asked.get(key) is not one:
                return False
            del self._asked[key]
            return True

    def _due(self, last: float) -> list[tuple[Hashable, _Asked]] | None:
        """Waits for actions that are due, or for the next frame; `None` at the end."""
        with self._wake:
            while not self._ended:
                now = time.monotonic()
                due = [(key, one) for key, one in self._asked.items() if one[0] <= now]
                if due:
                    return due
                waits = [when - now for when, _ in self._asked.values()]
                if self.playing:
                    frame = last + FRAME - now
                    if frame <= 0:
                        return []
                    waits.append(frame)
                self._wake.wait(min(waits, default=None))
            return None
