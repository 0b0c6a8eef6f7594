"""How a linkage that misses a motion by little would move, as a value."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class NearMotion:
    """How a linkage without a circuit moves if its redundant constraints are taken to agree.

    `miss` [length] is the greatest closure error on the way, `share` the same relative to the linkage size
    (or in rad); with the closure error `agree` the motion is the one of `motion_type`.
    """

    motion_type: str
    miss: float
    share: float
    agree: float
