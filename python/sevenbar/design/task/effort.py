"""How much a start of a search may take, in counted evaluations: the same on any machine."""

from __future__ import annotations

from dataclasses import dataclass

#: The most that a first look and the search from a start to its end may take: motions that are measured.
LOOK, WHOLE = 36, 600


@dataclass
class Effort:
    """What the present start has taken of the `most` that it may, and how many starts took all of it.

    A task without measures takes nothing: its evaluations are quick, and each search bounds their number.
    """

    most: int = WHOLE
    taken: int = 0
    ended: int = 0

    def begin(self, most: int) -> None:
        """A new start, or a new look at one."""
        self.most, self.taken = most, 0

    def take(self, motions: int) -> None:
        """So many motions are measured."""
        if self.taken < self.most <= self.taken + motions and self.most == WHOLE:
            self.ended += 1
        self.taken += motions

    @property
    def left(self) -> int:
        """What is left of it."""
        return max(self.most - self.taken, 0)
