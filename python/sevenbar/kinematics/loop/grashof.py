"""Grashof's rule for planar and spherical four-bars and slider-cranks: which joints turn fully.

With the shortest link s, the longest l and the two others p and q,

    s + l < p + q        both joints of s turn fully, the two others rock                                  (1)
    s + l > p + q        no joint turns fully
    s + l = p + q        a change point: the linkage can fold flat
    l > s + p + q        the four links do not close

in the plane, and for a slider-crank, which is a four-bar with two infinite links that differ by its offset e,
s + e against l; with e > s + l it does not close. On the sphere the links are arcs. An axis may be drawn
either way: reversing it replaces the arcs on both of its sides by their supplements and changes nothing. With
the axes so that the sum of the arcs is least, (1) holds as in the plane.

Source: docs/theory_measures.md, (1) to (3); F. Grashof, "Theoretische Maschinenlehre" 2 (1883); C. H. Chiang,
"Kinematics of spherical mechanisms" (1988); J. M. McCarthy, G. S. Soh, "Geometric design of linkages" (2011).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Literal

from sevenbar.text.printing import Printed

#: Sums of links that differ by less, as a share of their sum, are equal: such a change of a length moves
#: limits by 1e-6 rad, within which a motion is called a change point.
EQUAL_SUMS = 1e-13


#: The classes of Grashof's rule; the last two are those of slider-cranks.
Grashof = Literal[
    "crank-rocker",
    "double-crank",
    "double-rocker",
    "change-point",
    "triple-rocker",
    "cannot close",
    "Grashof",
    "non-Grashof",
]


#: The links of a loop with four joints, where the first and the last are input and output.
ROLES = ("input link", "coupler", "output link", "ground")


@dataclass(frozen=True, eq=False, repr=False)
class FourBar(Printed):
    """The links of a four-bar or a slider-crank, and their sum by Grashof's rule.

    `links` are names and lengths [length; rad of a "spherical" one, its axes turned so that the sum of arcs
    is least]; a "slider-crank" has its two links and the `offset` of the slide. `shortest` and `longest` are
    names of links. `excess` is s + l - (p + q), of a slider-crank s + offset - l: below 0 two joints turn
    fully, and `turning` has their columns. `grashof` is the class.
    """

    kind: Literal["planar", "spherical", "slider-crank"]
    links: dict[str, float]
    offset: float | None
    shortest: str
    longest: str
    excess: float
    grashof: Grashof
    turning: tuple[str, ...]


def four_bar_of_links(
    kind: Literal["planar", "spherical"], lengths: Sequence[float], names: Sequence[str], roles: Sequence[str]
) -> FourBar:
    """A four-bar by the links after each of its joints."""
    places = sorted(range(4), key=lambda k: lengths[k])
    shortest, longest = places[0], places[3]
    s, p, q, l = (lengths[k] for k in places)  # noqa: E741
    excess = math.fsum((s, l, -p, -q))
    turning: tuple[str, ...] = ()
    grashof: Grashof
    if abs(excess) <= EQUAL_SUMS * sum(lengths):
        grashof, excess = "change-point", 0.0
    elif excess > 0:
        too_long = math.fsum((l, -s, -p, -q)) > EQUAL_SUMS * sum(lengths)
        grashof = "cannot close" if too_long else "triple-rocker"
    else:
        opposite = "link 2" if "link 2" in roles else "coupler"
        by_role: dict[str, Grashof] = {"ground": "double-crank", opposite: "double-rocker"}
        grashof = by_role.get(roles[shortest], "crank-rocker")
        turning = tuple(names[k] for k in sorted((shortest, (shortest + 1) % 4)))
    links = _ordered({roles[k]: lengths[k] for k in range(4)})
    return FourBar(kind, links, None, roles[shortest], roles[longest], excess, grashof, turning)


def slider_crank_of_links(
    first: float, second: float, offset: float, names: Sequence[str], roles: Sequence[str]
) -> FourBar:
    """A slider-crank by the lengths of its two links and the offset of the slide.

    `names` are those of its three turning joints, `roles` of the two links between them.
    """
    s, l = sorted((first, second))  # noqa: E741
    if offset <= EQUAL_SUMS * (s + l):
        offset = 0.0
    shortest, longest = roles if first <= second else reversed(roles)
    excess = math.fsum((s, offset, -l))
    grashof: Grashof
    turning: tuple[str, ...] = ()
    if abs(excess) <= EQUAL_SUMS * (s + l + offset):
        grashof, excess = "change-point", 0.0
    elif excess > 0:
        too_far = math.fsum((offset, -s, -l)) > EQUAL_SUMS * (s + l + offset)
        grashof = "cannot close" if too_far else "non-Grashof"
    else:
        grashof = "Grashof"
        turning = tuple(names[:2] if first <= second else names[1:])
    links = _ordered({roles[0]: first, roles[1]: second})
    return FourBar("slider-crank", links, offset, shortest, longest, excess, grashof, turning)


def least(arcs: Sequence[float]) -> list[float]:
    """The arcs [rad] with the axes turned so that their sum is least."""
    ways = []
    for signs in product((False, True), repeat=4):
        flipped = [math.pi - arc if signs[k] != signs[(k + 1) % 4] else arc for k, arc in enumerate(arcs)]
        ways.append((round(sum(flipped), 12), sum(signs), flipped))
    return min(ways)[2]


def link_roles(names: Sequence[str], input: str, output: str) -> list[str]:
    """The names of the links after each of four joints."""
    # the ground is where the list of joints closes
    if (input, output) == (names[0], names[-1]):
        return list(ROLES)
    if (output, input) == (names[0], names[-1]):
        return [*ROLES[2::-1], ROLES[3]]
    return ["link 1", "link 2", "link 3", "ground"]


def _ordered(links: dict[str, float]) -> dict[str, float]:
    order = ["input link", "coupler", "output link", "link 1", "link 2", "link 3", "ground"]
    return {name: links[name] for name in order if name in links}
