"""The redundant constraints of a net in words, those of all cycles of a part in one sentence."""

from __future__ import annotations

from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.kinematics.nets.order import Parts
from sevenbar.text.words import say

#: What a cycle repeats that moves in a plane, or about a point, and how many constraints that is.
BY_GROUP = {
    "planar": ("a force across the plane and two moments in it", 3),
    "spherical": ("three forces", 3),
}


def repeated_lines(linkage: Loop, count: int) -> list[str]:
    """What so many redundant constraints of a net are."""
    lines, named = [], 0
    for links, cycles, group in Parts(linkage).cycles:
        if group not in BY_GROUP or cycles < 1:
            continue
        what, each = BY_GROUP[group]
        named += cycles * each
        parts = {"links": ", ".join(map(linkage.link_name, links)), "what": say(what)}
        if cycles == 1:
            lines.append(say("the cycle of {links}: {what}", **parts))
        else:
            lines.append(say("each of {cycles} cycles of {links}: {what}", cycles=cycles, **parts))
    if named > count or not lines:
        return [say("{count} that repeat others", count=count)] if count else []
    if besides := count - named:
        lines.append(say("{count} more that repeat the others of their cycles", count=besides))
    return lines
