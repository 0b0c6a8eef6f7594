"""Signals that end a command: Ctrl+C, SIGTERM and SIGHUP; all leave nothing half written."""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import FrameType

#: Signals that end a command as Ctrl+C does: a closed terminal sends SIGHUP, batch systems SIGTERM.
ENDING = [
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGBREAK") if hasattr(signal, name)
]

#: Time [s] in which a second signal is the first one's echo: what the first began is not cut short by it.
ECHO = 1.0

#: How a shell sees a command that Ctrl+C ended.
CTRL_C = 128 + signal.SIGINT

#: How a command ends that had begun nothing.
NOTHING = "stopped; nothing is written"


class _Heed:
    """Which signal came last, and when; and whether a command is at work."""

    def __init__(self) -> None:
        self.number = int(signal.SIGINT)
        self.at = -ECHO
        self.working = False

    def __call__(self, number: int, _frame: FrameType | None) -> None:
        now = time.monotonic()
        if now - self.at < ECHO:
            return
        self.number, self.at = number, now
        if self.working:
            raise KeyboardInterrupt
        # nothing is open yet, or no longer
        with suppress(OSError, ValueError):
            sys.stdout.flush()
        with suppress(OSError, ValueError):
            os.write(2, f"sevenbar: {NOTHING}\n".encode())
        os._exit(stopped())


_heed = _Heed()


def heed_signals() -> None:
    """Has the signals end this program in good order; one that is ignored, as under nohup, stays so."""
    if threading.current_thread() is not threading.main_thread():
        return
    for number in ENDING:
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _heed)


@contextmanager
def at_work() -> Iterator[None]:
    """While a command works a signal raises `KeyboardInterrupt`; else it ends the program at once."""
    _heed.working = True
    try:
        yield
    finally:
        _heed.working = False


def has_just_come() -> bool:
    """Whether a signal came within the last second: what fails then may fail for it, as drawing in C does."""
    return time.monotonic() - _heed.at < ECHO


def stopped() -> int:
    """How a shell sees a command that a signal ended: 128 and its number, 130 for Ctrl+C."""
    return 128 + _heed.number
