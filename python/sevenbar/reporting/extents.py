"""Ranges of joints, bends, distances of links and what stops leave of a circuit, in tables and values."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeVar

from sevenbar.errors import NotCoveredError
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.reporting.shown import REST, Shown, degrees, turned
from sevenbar.text.words import say

if TYPE_CHECKING:
    from sevenbar.curves.curve import Peak
    from sevenbar.kinematics.circuits.extents import Allowed

T = TypeVar("T")

#: Circuits whose usable parts are in one line.
MOST_LISTED = 8

Row = tuple[str, ...]


def known(of: Callable[[], T]) -> T | None:
    """What is found along a circuit, `None` where it cannot be followed by its own length, or is of loops."""
    # with what follows it
    from sevenbar.kinematics.paths.circuit_path import NotFollowedError

    try:
        return of()
    except (NotFollowedError, NotCoveredError):
        return None


def extent_rows(motion: Motion) -> tuple[Row, list[Row]]:
    """Heads, and a row for each joint, ball and pair of links of each circuit, with its stop."""
    heads = (
        say("circuit"),
        say("joint"),
        say("least @ {joint}", joint=motion.input),
        say("greatest @ {joint}", joint=motion.input),
        say("between"),
        say("stop"),
    )
    return heads, [row for circuit in motion for row in _of_circuit(motion.linkage, circuit)]


def _of_circuit(linkage: Loop, circuit: Circuit) -> Iterator[Row]:
    place = Shown("rad" if circuit.input_turns else linkage.length_unit)
    number, stops = f"{circuit.index}", linkage.stops

    def length(value: float) -> str:
        return Shown(linkage.length_unit)(0.0 if abs(value) < REST * circuit.size else value)

    def at(peak: Peak, show: Callable[[float], str]) -> str:
        return f"{show(peak.value)} @ {place(peak.input, whole=True)}"

    def ends(low: Peak, high: Peak, show: Callable[[float], str]) -> Row:
        if show(low.value) == show(high.value):
            # throughout, and at no place more than at another
            return show(low.value), show(high.value)
        return at(low, show), at(high, show)

    ranges = known(lambda: circuit.joint_ranges)
    if ranges is None:
        yield (number, say("cannot be followed by its own length"), "-", "-", "-", "-")
        return
    for name, result in ranges.items():
        show = degrees if result.turns else length
        stop = say(" to ").join(map(show, stops.ranges[name])) if name in stops.ranges else "-"
        if result.low is None or result.high is None or result.extent is None:
            yield (number, name, "-", "-", say("without end"), stop)
        else:
            turn = 0.0
            if result.turns and name not in stops.ranges:
                turn = turned(result.low.value, result.high.value)
            low, high = (replace(end, value=end.value + turn) for end in (result.low, result.high))
            yield (number, name, *ends(low, high, show), show(result.extent), stop)
    for name, cone in (known(lambda: circuit.ball_cones) or {}).items():
        stop = "-" if cone.limit is None else degrees(cone.limit)
        middle = say("{angle} from the middle", angle=degrees(cone.spread))
        bend = say("bend of {joint}", joint=name)
        yield (number, bend, *ends(cone.least, cone.greatest, degrees), middle, stop)
    for one in (known(lambda: circuit.clearances) or ()) if stops.radii else ():
        if one.radii:
            first, second = one.links
            pair = say("links {first} and {second}", first=first, second=second)
            left = say("{gap} left", gap=length(one.gap))
            if one.missed:
                left = say("{gap} left, or {missed} less", gap=length(one.gap), missed=length(one.missed))
            yield (number, pair, at(one.distance, length), "-", left, length(one.radii))


def span_rows(motion: Motion) -> tuple[Row, list[Row]]:
    """Heads, and a row for each part of each circuit that its stops allow."""
    heads = (say("circuit"), say("usable part"), say("begins at"), say("ends at"), say("ended by"))
    place = Shown("rad" if motion.linkage.unit_of(motion.input) == "rad" else motion.linkage.length_unit)
    rows: list[Row] = []
    for circuit in motion:
        result = known(lambda circuit=circuit: circuit.allowed)  # type: ignore[misc]
        if result is None or not result.spans:
            rows.append((f"{circuit.index}", say("none") if result else "-", "-", "-", _reasons(result)))
        for span in result.spans if result else ():
            ends = (place(span.start, whole=True), place(span.end, whole=True))
            if result and result.whole:
                ends = ("-", "-")
            by = "; ".join(dict.fromkeys(filter(None, (span.first_stop, span.last_stop)))) or "-"
            rows.append((f"{circuit.index}", _percent(span.share), *ends, by))
    return heads, rows


def _reasons(result: Allowed | None) -> str:
    if result is None:
        return "-"
    return (
        "; ".join(sorted({name for row in set(result.stopped_by) for name in row.split(", ") if name})) or "-"
    )


def _percent(share: float) -> str:
    return f"{100 * share:.1f} %"


def usable_text(circuits: Sequence[Circuit]) -> str:
    """What part of each circuit is within the stops: "circuit 0: 43.9 %, circuit 1: none"."""
    parts = []
    for circuit in circuits[:MOST_LISTED]:
        result = known(lambda circuit=circuit: circuit.allowed)  # type: ignore[misc]
        part = "-" if result is None else say("all") if result.whole else _percent(result.share)
        if result is not None and not result.spans:
            part = say("none")
        parts.append(say("circuit {number}: {part}", number=circuit.index, part=part))
    return say(", ").join(parts) + (" .." if len(circuits) > MOST_LISTED else "")


def extents_dict(circuit: Circuit, linkage: Loop) -> dict[str, Any]:
    """All of it as plain values: radians, lengths in the linkage's unit; null where it cannot be followed.

    Distances are those of links with a radius.
    """
    ranges = known(lambda: circuit.joint_ranges)
    cones = known(lambda: circuit.ball_cones)
    gaps = known(lambda: circuit.clearances) if linkage.stops.radii else ()
    result = known(lambda: circuit.allowed) if linkage.stops.stops else None
    return {
        "joint_ranges": None
        if ranges is None
        else {name: _ends("low", one.low) | _ends("high", one.high) for name, one in ranges.items()},
        "ball_cones": None
        if cones is None
        else {
            name: _ends("least", one.least)
            | _ends("greatest", one.greatest)
            | {key: getattr(one, key) for key in ("seat", "stud", "middle", "middle_of", "spread", "limit")}
            for name, one in cones.items()
        },
        "clearances": None
        if gaps is None
        else [
            {"links": one.links, "gap": one.gap, "radii": one.radii, "missed": one.missed}
            | _ends("distance", one.distance)
            for one in gaps
            if one.radii
        ],
        "allowed": None
        if result is None
        else {"share": result.share, "spans": [vars(span) for span in result.spans]},
    }


def _ends(name: str, peak: Peak | None) -> dict[str, float | None]:
    if peak is None:
        return {name: None, f"{name}_at": None}
    return {name: peak.value, f"{name}_at": peak.input}
