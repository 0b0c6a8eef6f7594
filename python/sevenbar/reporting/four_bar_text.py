"""The links of a four-bar and its class by Grashof's rule, in words."""

from __future__ import annotations

from sevenbar.kinematics.loop.grashof import FourBar
from sevenbar.reporting.shown import degrees
from sevenbar.text.words import retold, say


def links_text(bar: FourBar, unit: str) -> str:
    """The links of a four-bar by their names, arcs in degrees."""
    if bar.kind == "spherical":
        return "  ".join(f"{retold(name)} {degrees(arc)}" for name, arc in bar.links.items())
    lengths = {**bar.links, **({} if bar.offset is None else {"offset": bar.offset})}
    return "  ".join(f"{retold(name)} {length:.6g}" for name, length in lengths.items()) + f"  [{unit}]"


def grashof_text(bar: FourBar, unit: str) -> str:
    """The sum of the links by Grashof's rule, the class, and the joints that turn fully."""
    names = [bar.shortest, *(name for name in bar.links if name not in (bar.shortest, bar.longest))]

    def shown(value: float) -> str:
        return degrees(value) if bar.kind == "spherical" else f"{value:.6g}"

    short, long = shown(bar.links[bar.shortest]), shown(bar.links[bar.longest])
    if bar.offset is not None:
        total = f"s + e - l = {short} + {shown(bar.offset)} - {long}"
        kinds = {
            "Grashof": say("Grashof"),
            "non-Grashof": say("no joint turns fully"),
            "cannot close": say("the offset is longer than both links together, so the loop does not close"),
        }
        kind = kinds.get(bar.grashof) or say(bar.grashof)
        kind = say("in line, {kind}", kind=kind) if bar.offset == 0 else say("offset, {kind}", kind=kind)
    else:
        p, q = (shown(bar.links[name]) for name in names[1:])
        total = f"s + l - (p + q) = {short} + {long} - ({p} + {q})"
        kind = {
            "crank-rocker": say("Grashof crank-rocker"),
            "double-crank": say("Grashof double-crank"),
            "double-rocker": say("Grashof double-rocker"),
            "triple-rocker": say("triple-rocker: no joint turns fully"),
            "cannot close": say(
                "the {link} is longer than the three others together, so the loop does not close",
                link=retold(bar.longest),
            ),
        }.get(bar.grashof) or say(bar.grashof)
    ends = "" if bar.kind == "spherical" else f" {unit}"
    sums = f"{total} = {shown(bar.excess)}{ends}"
    if not bar.turning:
        return say("{sums}; {kind}", sums=sums, kind=kind)
    joints = say(" and ").join(bar.turning)
    return say("{sums}; {kind}: {joints} turn fully", sums=sums, kind=kind, joints=joints)
