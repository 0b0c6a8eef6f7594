"""The links of a four-bar and its class by Grashof's rule, in words."""

from __future__ import annotations

from sevenbar.kinematics.grashof import FourBar
from sevenbar.reporting.shown import degrees


def links_text(bar: FourBar, unit: str) -> str:
    """The links of a four-bar by their names, arcs in degrees."""
    if bar.kind == "spherical":
        return "  ".join(f"{name} {degrees(arc)}" for name, arc in bar.links.items())
    shown = "  ".join(f"{name} {length:.6g}" for name, length in bar.links.items())
    return shown + (f"  offset {bar.offset:.6g}" if bar.offset is not None else "") + f"  [{unit}]"


def grashof_text(bar: FourBar, unit: str) -> str:
    """The sum of the links by Grashof's rule, the class, and the joints that turn fully."""
    names = [bar.shortest, *(name for name in bar.links if name not in (bar.shortest, bar.longest))]

    def shown(value: float) -> str:
        return degrees(value) if bar.kind == "spherical" else f"{value:.6g}"

    short, long = shown(bar.links[bar.shortest]), shown(bar.links[bar.longest])
    if bar.offset is not None:
        total = f"s + e - l = {short} + {shown(bar.offset)} - {long}"
        where = "in line" if bar.offset == 0 else "offset"
        kinds = {"Grashof": "Grashof", "non-Grashof": "no joint turns fully"}
        kind = f"{where}, {kinds.get(bar.grashof, bar.grashof)}"
    else:
        p, q = (shown(bar.links[name]) for name in names[1:])
        total = f"s + l - (p + q) = {short} + {long} - ({p} + {q})"
        kind = {
            "crank-rocker": "Grashof crank-rocker",
            "double-crank": "Grashof double-crank",
            "double-rocker": "Grashof double-rocker",
        }.get(bar.grashof, bar.grashof)
    ends = "" if bar.kind == "spherical" else f" {unit}"
    turning = f": {' and '.join(bar.turning)} turn fully" if bar.turning else ""
    return f"{total} = {shown(bar.excess)}{ends}; {kind}{turning}"
