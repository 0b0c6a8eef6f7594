"""Much output and long work are begun only by who wants them: how much it would be, and `--yes` to go on."""

from __future__ import annotations

import sys
from dataclasses import dataclass

import typer

from sevenbar.errors import RequestError

#: Output [bytes] and work [s] above which a command asks first.
MUCH, LONG = 200e6, 60.0


@dataclass(frozen=True)
class Ahead:
    """What a command would do: the option that makes it much, and how much, as far as can be known before."""

    option: str
    what: str
    bytes: float = 0.0
    seconds: float = 0.0

    @property
    def asks(self) -> bool:
        """Whether it is so much that somebody has to want it."""
        return self.bytes > MUCH or self.seconds > LONG

    def __str__(self) -> str:
        parts = [self.what]
        if self.bytes > MUCH:
            parts.append(f"about {size_text(self.bytes)}")
        if self.seconds > LONG:
            parts.append(f"some {self.seconds / 60:.0f} min" if self.seconds > 90 else "about a minute")
        return f"{self.option}: {', '.join(parts)}"


def confirm(ahead: Ahead, *, yes: bool) -> None:
    """Goes on where it is not much, or wanted; at a terminal it asks.

    Raises `RequestError` where nobody can answer; a no ends the command with exit 2, too.
    """
    if yes or not ahead.asks:
        return
    if sys.stdin.isatty() and sys.stderr.isatty():
        if typer.confirm(f"{ahead}; go on?", err=True):
            return
        typer.echo("nothing is written", err=True)
        raise typer.Exit(2)
    raise RequestError(f"{ahead}; give --yes to go on")


def size_text(size: float) -> str:
    """A size in the unit that people read.

    >>> size_text(1.7e9), size_text(250e6)
    ('1.7 GB', '250 MB')
    """
    return f"{size / 1e9:.1f} GB" if size >= 1e9 else f"{size / 1e6:.0f} MB"
