"""How the circuits of a motion were found, in words."""

from __future__ import annotations

import math

from sevenbar.arrays import Floats
from sevenbar.kinematics.general import AGREE
from sevenbar.kinematics.motion import Motion, Search

#: What the modes at the values looked at are, by the word for their completeness.
_MODES = {
    "counted": "all modes over the complex numbers",
    "algebraic": "all modes over the complex numbers",
    "searched": "modes by search from many starts, screws within one turn to each side",
}

#: Why circuits were not counted; a search says so itself.
_UNCOUNTED = {
    "lost": "circuits are not counted, since a solution over the complex numbers was lost on the way",
    "still": "circuits are not counted, since there may be motions with the joint at rest",
}

#: Ranges that do not balance listed in one sentence.
MOST_RANGES = 4

#: A range narrower than this [deg] is given by its middle, as one about a change point.
NARROW_RANGE_DEG = 0.01


def how_found(motion: Motion) -> str:
    """How the circuits were found and what is known of their number, as a sentence."""
    search = motion.search
    if search.completeness == "closed-form":
        return "all modes in closed form, the ranges of the input by the roots of a quartic"
    if not search.values:
        return "from the drawn pose only"
    joints = " and of ".join(search.columns) or "a turn of a ball"
    text = f"{_MODES[search.completeness]} at {search.values} values of {joints}; "
    if search.freedoms is None:
        text += "there are none"
    elif motion.circuits:
        text += "each lies on a circuit"
        if search.unfollowed:
            text += f", but {search.unfollowed} from which no motion could be followed"
        if free := sum(point.freedoms > 1 for point in motion.change_points):
            text += "; motions with more than one freedom, not followed, "
            text += f"begin in {free} of the change points"
    elif search.freedoms > 1:
        text += f"the loop moves out of them with {search.freedoms} freedoms"
    else:
        text += "no motion leads out of them"
    if counted := _counted(search):
        text += f"; {counted}"
    if search.misfits.size:
        text += f"; {left_open(search.misfits, motion.agree)}"
    if motion.agree != AGREE:
        text += f"; redundant constraints are taken to agree up to {motion.agree:.0e}, by request"
    return text


def _counted(search: Search) -> str:
    """What the count of branch points shows; empty where nothing was counted."""
    count = search.count
    if count is None:
        return _UNCOUNTED.get(search.uncounted or "", "")
    if not count.open:
        others = f" and {count.complex_branch_points} complex" if count.complex_branch_points else ""
        many = f"{count.dead_centres or 'no'} dead centre{'s' * (count.dead_centres > 1)}"
        return f"branch points of {count.joint} are all accounted for: {many}{others}"
    parts = []
    for each in count.open[:MOST_RANGES]:
        what = "some" if each.missing is None else f"{each.missing}"
        if each.missing is not None and each.missing < 0:
            what = f"{-each.missing} too many"
        start, wide = math.degrees(each.start), math.degrees(each.end - each.start)
        if wide < NARROW_RANGE_DEG:
            parts.append(f"{what} within {wide / 2:.1g} deg of {(start + wide / 2) % 360:.6g} deg")
        else:
            parts.append(f"{what} between {start % 360:.6g} and {start % 360 + wide:.6g} deg")
    more = " and elsewhere" if len(count.open) > MOST_RANGES else ""
    return f"branch points of {count.joint} are not all accounted for: {', '.join(parts)}{more}"


def left_open(misfits: Floats, agree: float) -> str:
    """How many poses redundant constraints alone keep open, and by how much; of one or more, rising."""
    count = len(misfits)
    return (
        f"{count} more pose{'s close' if count > 1 else ' closes'} except for redundant constraints, which "
        f"miss by {misfits[0]:.1e} to {misfits[-1]:.1e} (rad, or relative to the linkage size) and are taken "
        f"to agree up to {agree:.0e}"
    )
