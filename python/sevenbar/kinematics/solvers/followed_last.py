"""The circuit that a solver followed last: searches along a circuit need it again at other inputs."""

from __future__ import annotations

from typing import Generic, TypeVar

from sevenbar.arrays import Floats

T = TypeVar("T")


class FollowedLast(Generic[T]):
    """What the core followed last from a pose (columns,), over an input and an output."""

    def __init__(self) -> None:
        self._last: tuple[tuple[bytes, int, int], T] | None = None

    def of(self, pose: Floats, column: int, output: int) -> T | None:
        """What was followed, if it was the last; `None` where another was."""
        known = self._last
        return known[1] if known is not None and known[0] == (pose.tobytes(), column, output) else None

    def keep(self, followed: T, pose: Floats, column: int, output: int) -> None:
        """Keeps what was followed, in the place of what was before."""
        self._last = (pose.tobytes(), column, output), followed
