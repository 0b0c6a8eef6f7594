"""How the circuits of a linkage were found and counted, or by how little it misses a motion."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from sevenbar.arrays import Floats


@dataclass(frozen=True)
class OpenRange:
    """A range of a joint [rad, or length] in which its branch points are not all accounted for."""

    start: float
    end: float
    #: Dead centres counted there and not known; `None` where solutions run to infinity, or were lost.
    missing: int | None


@dataclass(frozen=True)
class Count:
    """The account of a joint's branch points: all of them, and the modes at one value, mean all circuits.

    The joint is the input, or of a single loop the first that turns where the input slides. A slide of a net
    is counted between the values beyond which a cycle through it does not close.
    """

    joint: str
    #: Real branch points, where this joint turns back on a circuit, or farther out than these are followed;
    #: of a net one for all ways of the links that are solved after those that are stretched there.
    dead_centres: int
    #: Complex ones near the real values, located and counted off.
    complex_branch_points: int
    #: Joints, of those watched, that become infinite near the real values; kept out of the count.
    poles: int
    #: Circles of complex values tried for it, up to the last along which no mode was lost; another where one
    #: was, or a range did not balance.
    circles: int
    #: Ranges that do not balance; none where circuits are `counted`.
    open: tuple[OpenRange, ...]


@dataclass(frozen=True, eq=False)
class Search:
    """What a search for the circuits found; of the closed form no more than that.

    All modes were found at so many `values` of each of the `columns`; from `unfollowed` of them no motion
    could be followed. `rank` is that of the joints' screws in these poses and `freedoms` those of the
    motions out of them, `None` where there are none.
    """

    completeness: Literal["closed-form", "counted", "algebraic", "monodromy", "searched"]
    columns: tuple[str, ...] = ()
    values: int = 0
    unfollowed: int = 0
    #: The bound of work at which the search stopped short: curves that were followed over the most steps
    #: without an end, places searched for ways out as change points are, or memory for curves between these.
    bound: Literal["long-curves", "change-points", "memory"] | None = None
    rank: int | None = None
    freedoms: int | None = None
    #: Poses that redundant constraints alone keep open: by how much [rad, or relative to the size], rising.
    open_by: Floats = field(default_factory=lambda: np.empty(0))
    #: How the circuits were counted; `None` where they were not.
    count: Count | None = None
    #: Why not: modes were "searched", or no count covers the parts of a net; a solution was "lost"; or
    #: with the input "still" others move.
    uncounted: Literal["searched", "lost", "still"] | None = None


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
