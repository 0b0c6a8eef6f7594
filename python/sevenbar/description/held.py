"""Which dimensions stay as they are while others change, in words and as plain values."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

from sevenbar.description.draft import Draft
from sevenbar.kinematics.numbers.dimensions import Dimension
from sevenbar.text.words import say

#: Dimensions that stay and that a line names; the others are counted.
MOST_NAMED = 8


@dataclass(frozen=True)
class HeldDimensions:
    """The dimensions that stay, the names of those that the file leaves out, and the dimensions that follow.

    >>> import sevenbar as sb
    >>> draft = Draft.of_linkage(sb.load("rssr"))
    >>> held_of(draft.holding(), {"L1", "L3"}).text
    'M, N, D, L2 (997.497 mm in the design)'
    >>> held_of(draft.holding(["L2"]), {"L1", "L3"}).text
    'M, N, D; L2 follows (997.497 mm in the design)'
    """

    stay: tuple[Dimension, ...]
    left_out: tuple[str, ...]
    follow: tuple[Dimension, ...]

    @property
    def text(self) -> str:
        """The dimensions in a line; empty where all change."""
        names = [d.name for d in self.stay if d.name not in self.left_out]
        more = len(names) - MOST_NAMED
        names = [*names[:MOST_NAMED], *([say("{count} more", count=more)] if more > 0 else [])]
        named = [*names, *(_with_value(d.name, d) for d in self.stay if d.name in self.left_out)]
        follow = (say("{dimension} follows", dimension=d.name) for d in self.follow)
        lines = [", ".join(named), *map(_with_value, follow, self.follow)]
        return say("; ").join(line for line in lines if line)

    @property
    def left_to_the_program(self) -> bool:
        """Whether the file leaves a dimension out that is held or follows here."""
        return bool(self.left_out or self.follow)

    @property
    def as_dict(self) -> dict[str, Any]:
        """The values (in the units of the file) of what stays, and the names of what the file leaves out."""
        return {
            "held": {d.name: d.value for d in self.stay},
            "left_out": [*self.left_out, *(d.name for d in self.follow)],
            "follow": [d.name for d in self.follow],
        }


def held_of(draft: Draft, moved: Collection[str]) -> HeldDimensions:
    """What of a draft stays as it is while the dimensions `moved`, by name, change.

    Points and the speed are not among it: they move no joint.
    """
    dimensions = [d for d in draft.dimensions if d.kind != "speed" and d.place[0] != "point"]
    lengths = [d for d in (*draft.lengths, *dimensions) if d.drawn]
    if any(d.name in moved for d in lengths):
        # lengths say where the moving joints are; only joints of the ground have numbers of their own besides
        standing = draft.linkage.graph.standing
        dimensions = [*lengths, *(d for d in dimensions if d.place[1] in standing and not d.drawn)]
    staying = [d for d in dimensions if d.name not in moved]
    return HeldDimensions(
        tuple(d for d in staying if not d.follows),
        tuple(d.name for d in staying if d.name in draft.held),
        tuple(d for d in staying if d.follows),
    )


def _with_value(what: str, dimension: Dimension) -> str:
    value = f"{dimension.value:.6g} {dimension.unit}"
    return say("{what} ({value} in the design)", what=what, value=value)
