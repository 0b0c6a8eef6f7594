"""How the circuits of a motion were found, in words."""

from __future__ import annotations

import math

from sevenbar.arrays import Floats
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.kinematics.circuits.search import OpenRange
from sevenbar.kinematics.solvers.general import AGREE
from sevenbar.text.words import say

#: What the modes at the values looked at are, by the word for their completeness.
_MODES = {
    "counted": "all modes over the complex numbers",
    "algebraic": "all modes over the complex numbers",
    "monodromy": "modes over the complex numbers by triangles, from two seeds until ten brought none",
    "searched": "modes by search from many starts",
}

#: Of a linkage with screws.
_WITH_SCREWS = "modes by search from many starts, screws within one turn to each side"

#: Why circuits were not counted; a search says so itself.
_UNCOUNTED = {
    "lost": "circuits are not counted, since a solution over the complex numbers was lost on the way",
    "still": "circuits are not counted, since there may be motions with the joint at rest",
}

#: The same of a net whose modes are certain.
_BETWEEN = "circuits are not counted: one that lies between two of these values is not seen"

#: At which bound of work a search stopped short.
_BOUNDS = {
    "long-curves": "the search stopped short at two curves that had no end after the most steps",
    "change-points": "the search stopped short after the most places that may be change points",
    "memory": "the search stopped short at the most memory for curves between change points",
}

#: Ranges that do not balance listed in one sentence.
MOST_RANGES = 4

#: A range narrower than this [deg] is given by its middle, as one about a change point.
NARROW_RANGE_DEG = 0.01


def how_found(motion: Motion) -> str:
    """How the circuits were found and what is known of their number, as a sentence."""
    search = motion.search
    if search.completeness == "closed-form":
        return say("all modes in closed form, the ranges of the input by the roots of a quartic")
    if not search.values:
        return say("from the drawn pose only")
    joints = say(" and of ").join(search.columns) or say("a turn of a ball")
    has_screws = search.completeness == "searched" and any(j.kind == "H" for j in motion.linkage.joints)
    modes = say(_WITH_SCREWS if has_screws else _MODES[search.completeness])
    parts = [say("{modes} at {count} values of {joints}", modes=modes, count=search.values, joints=joints)]
    if search.freedoms is None:
        parts.append(say("there are none"))
    elif motion.circuits:
        on_circuits = say("each lies on a circuit")
        if lost := search.unfollowed:
            on_circuits = say(
                "each lies on a circuit, but {count} from which no motion could be followed", count=lost
            )
        parts.append(on_circuits)
        if free := sum(point.freedoms > 1 for point in motion.change_points):
            parts.append(
                say(
                    "motions with more than one freedom, not followed, begin in {count} of the change points",
                    count=free,
                )
            )
    elif search.freedoms > 1:
        parts.append(say("the loop moves out of them with {count} freedoms", count=search.freedoms))
    elif motion.motion_type == "not-followed":
        parts.append(say("motions that lead out of them could not be followed"))
    else:
        parts.append(say("no motion leads out of them"))
    if search.bound is not None:
        parts.append(say(_BOUNDS[search.bound]))
    if counted := _counted(motion):
        parts.append(counted)
    if search.open_by.size:
        parts.append(left_open(search.open_by, motion.agree))
    if motion.agree != AGREE:
        parts.append(
            say("redundant constraints are taken to agree up to {agree:.0e}, by request", agree=motion.agree)
        )
    return say("; ").join(parts)


def _counted(motion: Motion) -> str:
    """What the count of branch points shows; empty where nothing was counted."""
    search = motion.search
    count = search.count
    if count is None and search.uncounted == "searched" and motion.completeness != "searched":
        return say(_BETWEEN)
    if count is None:
        return say(_UNCOUNTED[search.uncounted]) if search.uncounted in _UNCOUNTED else ""
    if not count.open:
        many = say("no dead centre")
        if (number := count.dead_centres) and motion.linkage.net is not None:
            # a dead centre with each way of the links after it is one
            many = say("{count} real", count=number)
        elif number:
            many = say("{count} dead centre{s}", count=number, s="s" * (number > 1))
        if others := count.complex_branch_points:
            many = say("{dead_centres} and {count} complex", dead_centres=many, count=others)
        return say("branch points of {joint} are all accounted for: {points}", joint=count.joint, points=many)
    unit = motion.linkage.unit_of(count.joint)
    ranges_open: dict[str, None] = {}
    for each in count.open:
        what = say("some") if each.missing is None else f"{each.missing}"
        if each.missing is not None and each.missing < 0:
            what = say("{count} too many", count=-each.missing)
        # one that reads as another is of another mode of the same links
        ranges_open[say("{what} {place}", what=what, place=_place(each, unit))] = None
    ranges = say(", ").join(list(ranges_open)[:MOST_RANGES])
    if len(ranges_open) > MOST_RANGES:
        ranges = say("{ranges} and elsewhere", ranges=ranges)
    return say(
        "branch points of {joint} are not all accounted for: {ranges}", joint=count.joint, ranges=ranges
    )


def _place(each: OpenRange, unit: str) -> str:
    """Where a range of a joint lies, whose values have a unit."""
    if unit != "rad":
        return say("between {low:.6g} and {high:.6g} {unit}", low=each.start, high=each.end, unit=unit)
    start, wide = math.degrees(each.start), math.degrees(each.end - each.start)
    if wide < NARROW_RANGE_DEG:
        middle = (start + wide / 2) % 360
        return say("within {half:.1g} deg of {middle:.6g} deg", half=wide / 2, middle=middle)
    low = start % 360
    return say("between {low:.6g} and {high:.6g} deg", low=low, high=low + wide)


def left_open(open_by: Floats, agree: float) -> str:
    """How many poses redundant constraints alone keep open, and by how much; of one or more, rising."""
    count = len(open_by)
    return say(
        "{count} more pose{closes} except for redundant constraints, which miss by {least:.1e} to {most:.1e} "
        "(rad, or relative to the linkage size) and are taken to agree up to {agree:.0e}",
        count=count, closes="s close" if count > 1 else " closes", least=open_by[0], most=open_by[-1],
        agree=agree,
    )  # fmt: skip
