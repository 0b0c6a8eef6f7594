"""What the report says of a motion as a whole: its facts by name, in words for people."""

from __future__ import annotations

import math
from collections.abc import Iterable

from sevenbar.description.angle_doubts import angle_doubt
from sevenbar.kinematics.circuits import Circuit
from sevenbar.kinematics.geometry import Loop
from sevenbar.kinematics.mobility import Mobility
from sevenbar.kinematics.motion import Motion, Solvable
from sevenbar.reporting.four_bar_text import grashof_text, links_text
from sevenbar.reporting.how_found import how_found
from sevenbar.reporting.page import drive_text
from sevenbar.reporting.shown import Shown

#: Limits of the input that are listed.
MOST_LIMITS = 8

#: What each word for completeness means.
COMPLETE = {
    "closed-form": "all modes are found",
    "counted": "all modes and all circuits are found",
    "algebraic": "all modes are found",
    "searched": "the modes that a search from many starts found; there may be others",
}


def side_lengths(linkage: Solvable) -> dict[str, float]:
    """Crank, coupler and rocker of an RSSR."""
    if linkage.kind != "RSSR":
        return {}
    return dict(zip(("crank", "coupler", "rocker"), linkage.lengths, strict=True))


def closure_error(circuits: Iterable[Circuit]) -> float:
    """The greatest closure error [length]; NaN where no row has one."""
    residuals = [circuit.tally.residual for circuit in circuits]
    return max((worst for worst in residuals if not math.isnan(worst)), default=math.nan)


def facts_of(motion: Motion) -> list[tuple[str, str]]:
    """What the report tells of the motion as a whole: names and words."""
    linkage = motion.linkage
    facts = [("loop", joints_text(linkage))]
    if linkage.form == "rows":
        before = f"link {len(linkage.joints) - 1}" if len(linkage.joints) > 2 else "the link before it"
        facts.append(("last joint", f"{linkage.joints[-1].name} counts the ground relative to {before}"))
    if numbers := dimensions_text(linkage):
        facts.append(("dimensions", numbers))
    if bar := motion.four_bar:
        facts.append(("links", links_text(bar, linkage.length_unit)))
        facts.append(("Grashof", grashof_text(bar, linkage.length_unit)))
    if doubt := angle_doubt(linkage.description):
        facts.append(("angles", doubt))
    speed = motion.speed if motion.law is None else None
    unit, written = linkage.unit_of(motion.input), motion.speed_written
    facts.append(("drive", drive_text(motion.input, speed, unit, motion.output, written=written)))
    if motion.law is not None:
        t = motion.law.t
        rows = f"{t.size} row{'s' * (t.size != 1)} from {t[0]:.6g} s to {t[-1]:.6g} s"
        facts.append(("law", f"{rows}; extremes of velocity and acceleration are those of its rows"))
    facts.append(("motion type", motion.motion_type))
    if told := meaning(motion):
        facts.append(("", told))
    if near := nearly_moves(motion):
        facts.append(("nearly moves", near))
    facts.append(("circuits", _circuit_count(motion)))
    if motion.circuits or motion.limits.size:
        facts.append(("input limits", _limits_text(motion)))
    facts.extend(_change_points(motion))
    facts.append(("completeness", f"{motion.completeness}: {COMPLETE[motion.completeness]}"))
    if motion.completeness != "closed-form":
        facts.append(("how found", how_found(motion)))
        facts.append(("mobility", _mobility(motion.mobility)))
    if motion.idle:
        facts.append(("idle freedom", "; ".join(motion.idle) + ", held by convention"))
    facts.append(("redundant", "; ".join(motion.redundant) or "no constraints"))
    if motion.circuits:
        facts.append(("closure error", f"at most {closure_error(motion):.1e} {linkage.length_unit}"))
    return facts


def _limits_text(motion: Motion) -> str:
    """The input's limits; of many no more than their number, since the tables have them by circuit."""
    if motion.limits.size > MOST_LIMITS:
        return f"{motion.limits.size}, by circuit in the table below"
    show = Shown(motion.linkage.unit_of(motion.input))
    return "  ".join(show(x) for x in motion.limits) or _no_limits(motion)


def joints_text(linkage: Loop) -> str:
    """The joints in loop order: kinds and names."""
    return "  ".join(f"{joint.kind} {joint.name}" for joint in linkage.joints)


def dimensions_text(linkage: Solvable) -> str:
    """The dimensions by name; nothing of Denavit-Hartenberg rows, which want a table."""
    numbers = {} if linkage.form == "rows" else dict(linkage.dimensions) or side_lengths(linkage)
    told = "  ".join(f"{key} = {value:.6g}" for key, value in numbers.items())
    return f"{told}  [{linkage.length_unit}]" if told else ""


def _change_points(motion: Motion) -> list[tuple[str, str]]:
    """Lines for the poses at which branches meet, and for those that stand alone."""
    show = Shown(motion.linkage.unit_of(motion.input))
    lines = []
    meeting = [point for point in motion.change_points if not point.isolated]
    if meeting:
        where = "  ".join(show(x) for x in motion.change_point_inputs)
        what = "branches meet there; the least change of a dimension decides how it goes on"
        lines.append(("change point", f"input {where}: {what}"))
    free = max((point.freedoms for point in meeting), default=0)
    if free > 1:
        lines.append(("", f"there it can also move with {free} freedoms, which no circuit shows"))
    alone = [show(point.input) for point in motion.change_points if point.isolated]
    if alone:
        lines.append(("isolated pose", f"input {'  '.join(alone)}: no motion leads out of it"))
    return lines


def nearly_moves(motion: Motion) -> str:
    """By how little a linkage without a circuit misses a motion; empty where it moves, or misses more."""
    near = motion.near_motion
    if near is None:
        return ""
    return (
        f"as a {near.motion_type}: redundant constraints miss by up to {near.share:.1e} of the size "
        f"({near.miss:.2g} {motion.linkage.length_unit}), or as many rad; --agree {near.agree:.0e} takes "
        "them to agree"
    )


def meaning(motion: Motion) -> str:
    """A sentence on a motion type that is not a pair of words for input and output."""
    match motion.motion_type:
        case "two-inputs":
            return (
                f"the loop moves with {motion.mobility.finite} freedoms, so one input does not determine it: "
                "lock a joint (leave it out)"
            )
        case "rigid":
            taken = motion.mobility.freedoms
            return f"the loop closes but cannot move: closing it removes all of its {taken} freedoms"
        case "cannot-assemble" if motion.linkage.kind == "RSSR":
            return "no input closes the loop: the coupler is too short or too long"
        case "cannot-assemble":
            return "no values of the joints were found that close the loop"
        case "change-point":
            return "the motion runs through a pose from which it can go on in more than one way"
        case "mixed":
            return "the circuits differ; see below"
    return ""


def _mobility(mobility: Mobility) -> str:
    count = f"Gruebler {mobility.freedoms} - 6 = {mobility.gruebler}"
    parts = [count] if mobility.rank is None else [count, f"rank {mobility.rank}"]
    for number, name in (
        (len(mobility.idle), "idle freedom"),
        (len(mobility.redundant), "redundant constraint"),
    ):
        if number:
            parts.append(f"{number} {name}{'s' * (number > 1)}")
    start = "not known, as no pose was found" if mobility.finite is None else f"{mobility.finite}"
    return f"{start} ({', '.join(parts)})"


def _no_limits(motion: Motion) -> str:
    turns = all(circuit.input_range is None for circuit in motion)
    return "none: the input turns fully" if turns else "none found"


def _circuit_count(motion: Motion) -> str:
    if not motion.circuits:
        return "none: it closes only in isolated poses" if motion.change_points else "none"
    turning = sorted({c.turns for c in motion if c.closed and c.turns})
    ways = {
        f"{{}} after {turns_text(k)} of the input": sum(c.closed and c.turns == k for c in motion)
        for k in turning
    }
    ways["{} to and fro"] = sum(c.closed and c.turns == 0 for c in motion)
    ways["{} not known to close"] = sum(not c.closed for c in motion)
    found = {way: count for way, count in ways.items() if count}
    total = len(motion.circuits)

    def told(way: str, who: str, many: bool) -> str:
        verb = ("go" if many else "goes") if "fro" in way else ("are" if many else "is")
        if "after" in way:
            verb = "close" if many else "closes"
        return f"{who} {way.format(verb)}"

    if len(found) == 1:
        return f"{total}, {told(next(iter(found)), 'each' if total > 1 else 'it', False)}"
    return f"{total}: " + ", ".join(told(way, str(count), count > 1) for way, count in found.items())


def turns_text(count: int) -> str:
    """A number of turns, in words where it is small."""
    return {1: "one turn", 2: "two turns"}.get(count, f"{count} turns")
