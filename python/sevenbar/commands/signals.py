"""Signals that end a command: Ctrl+C, SIGTERM and SIGHUP; all leave nothing half written.

The first module of the program that is imported, so it imports hardly anything.
"""

from __future__ import annotations

import os
import signal
import sys
import time

# as typing has it, which is large itself
TYPE_CHECKING = False
if TYPE_CHECKING:
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


def _say_nothing(_: object) -> None:
    """In place of Python's words on an error that nobody can catch."""


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
            # what fails while it is taken down, as a half written sheet does, is no news
            sys.unraisablehook = _say_nothing
            raise KeyboardInterrupt
        # nothing is open yet, or no longer; an import within that of another module could find it half made
        try:  # noqa: SIM105
            sys.stdout.flush()
        except (OSError, ValueError):
            pass
        try:
            os.write(2, f"sevenbar: {NOTHING}\n".encode())
        finally:
            os._exit(stopped())


_heed = _Heed()


def heed_signals() -> None:
    """Has the signals end this program in good order; one that is ignored, as under nohup, stays so."""
    for number in ENDING:
        if signal.getsignal(number) is not signal.SIG_IGN:
            try:
                signal.signal(number, _heed)
            except ValueError:  # a thread other than the main one has no signals
                return


class at_work:  # noqa: N801  used as a function is
    """While a command works a signal raises `KeyboardInterrupt`; else it ends the program at once."""

    def __enter__(self) -> None:
        _heed.working = True

    def __exit__(self, *_: object) -> None:
        _heed.working = False


def has_just_come() -> bool:
    """Whether a signal came within the last second: what fails then may fail for it, as drawing in C does."""
    return time.monotonic() - _heed.at < ECHO


def leave(code: object) -> None:
    """Ends the program at once if its exit code is that of a signal: all that was open is closed by then.

    Python itself would take down every library first, and where the signal came within a text that was run,
    as the making of a class is, end as if Ctrl+C had never been caught.
    """
    if _heed.at > 0 and code == stopped():
        for stream in (sys.stdout, sys.stderr):
            try:
                stream.flush()
            except (OSError, ValueError):
                break
        os._exit(stopped())


def stopped() -> int:
    """How a shell sees a command that a signal ended: 128 and its number, 130 for Ctrl+C."""
    return 128 + _heed.number
