"""How long work reports on its way: what is done, of how much, and what is at work or the best so far."""

from __future__ import annotations

from typing import Protocol


class Progress(Protocol):
    """Called with what is done, of how much (0: not known), and often some words."""

    def __call__(self, done: float, total: int, words: str = "", /) -> object:
        """Takes a report."""


def silent(done: float, total: int, words: str = "", /) -> None:
    """Reports nothing."""
