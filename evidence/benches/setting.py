"""What every case is given: the peers that are here, and how much time there is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeVar

from evidence.benches.peers import Peers

T = TypeVar("T")


@dataclass(frozen=True)
class Setting:
    """The peers, and whether a quick look is enough."""

    peers: Peers
    quick: bool = False

    def choose(self, full: T, quick: T) -> T:
        """One amount of work for the page, another for a quick look."""
        return quick if self.quick else full
