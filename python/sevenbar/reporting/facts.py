"""What the report says of a motion as a whole: its facts by name, in words for people."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from sevenbar.description.angle_doubts import angle_doubt
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.motion import Motion, Solvable
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.reporting.extents import usable_text
from sevenbar.reporting.four_bar_text import grashof_text, links_text
from sevenbar.reporting.how_found import how_found
from sevenbar.reporting.shown import Shown, drive_text
from sevenbar.text.words import retold, say

if TYPE_CHECKING:
    from sevenbar.kinematics.loop.mobility import Mobility

#: Limits of the input that are listed.
MOST_LIMITS = 8

#: What each word for completeness means.
COMPLETE = {
    "closed-form": "all modes are found",
    "counted": "all modes and all circuits are found",
    "algebraic": "all modes are found",
    "monodromy": "all modes are found to which triangles lead, from two seeds until ten brought none",
    "searched": "the modes that a search from many starts found; there may be others",
}

#: The same of modes at an input at which a curve of poses closes.
COMPLETE_WITH_CURVE = {
    "algebraic": "all isolated modes are found; a curve of poses closes here, too",
    "searched": "one pose that a search found; a curve of poses closes here",
}

#: The same of a motion some of whose modes could not be followed.
COMPLETE_BUT_UNFOLLOWED = {
    "counted": "all modes are found, and all circuits but those through modes that could not be followed"
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


def closure_text(circuits: Iterable[Circuit], unit: str = "") -> str:
    """The greatest closure error in words, with its unit where that is known."""
    error = closure_error(circuits)
    known = not math.isnan(error)
    return say("at most {error:.1e} {unit}", error=error, unit=unit) if known else say("no row has one")


def facts_of(motion: Motion) -> list[tuple[str, str]]:
    """What the report says of the motion as a whole: names, in English, and words."""
    linkage = motion.linkage
    if linkage.net is None:
        facts = [("loop", joints_text(linkage))]
    else:
        # a single loop needs nothing of nets
        from sevenbar.reporting.net_facts import net_facts

        facts = net_facts(motion)
    if linkage.form == "rows":
        closing, _ = linkage.graph.joints_of(linkage.graph.ground)
        number, _ = linkage.graph.between[closing]
        before = say("link {number}", number=number) if number > 1 else say("the link before it")
        last = linkage.joints[closing].name
        facts.append(
            ("last joint", say("{joint} counts the ground relative to {link}", joint=last, link=before))
        )
    if numbers := dimensions_text(linkage):
        facts.append(("dimensions", numbers))
    if bar := motion.four_bar:
        facts.append(("links", links_text(bar, linkage.length_unit)))
        facts.append(("Grashof", grashof_text(bar, linkage.length_unit)))
    if doubt := angle_doubt(linkage.description):
        facts.append(("angles", retold(doubt)))
    speed = motion.speed if motion.law is None else None
    unit, written = linkage.unit_of(motion.input), motion.speed_written
    facts.append(("drive", drive_text(motion.input, speed, unit, motion.output, written=written)))
    if motion.law is not None:
        t = motion.law.t
        law = say(
            "{count} row{s} from {start:.6g} s to {end:.6g} s; extremes of velocity and acceleration are "
            "those of its rows",
            count=t.size, s="s" * (t.size != 1), start=t[0], end=t[-1],
        )  # fmt: skip
        facts.append(("law", law))
    facts.append(("motion type", say(motion.motion_type)))
    if sentence := meaning(motion):
        facts.append(("", sentence))
    if motion.reason is not None:
        # most loops have none
        from sevenbar.reporting.reason_text import reason_text

        facts.append(("", reason_text(motion)))
    if near := nearly_moves(motion):
        facts.append(("nearly moves", near))
    facts.append(("circuits", _circuit_count(motion)))
    if motion.circuits or motion.limits.size:
        facts.append(("input limits", _limits_text(motion)))
    facts.extend(_change_points(motion))
    unfollowed = motion.search.unfollowed > 0
    facts.append(("completeness", completeness_text(motion.completeness, unfollowed=unfollowed)))
    if motion.completeness != "closed-form":
        facts.append(("how found", how_found(motion)))
        facts.append(("mobility", _mobility(motion.mobility)))
    if motion.idle:
        facts.append(("idle freedom", idle_text(motion.idle)))
    if motion.motion_type != "cannot-assemble":
        if linkage.net is None:
            lines = [*map(retold, motion.redundant)]
        else:
            from sevenbar.reporting.repeated import repeated_lines

            lines = repeated_lines(linkage, len(motion.redundant))
        facts.append(("redundant", say("; ").join(lines) or say("no constraints")))
    if not linkage.loading.is_empty:
        from sevenbar.reporting.force_words import acting_text

        acting = acting_text(linkage.loading)
        facts.append(("forces", say("{acting}; 'sevenbar forces' reports all joints", acting=acting)))
    if motion.circuits and linkage.stops.stops:
        facts.append(("within the stops", usable_text(motion.circuits)))
    if motion.circuits:
        facts.append(("closure error", closure_text(motion, linkage.length_unit)))
    return facts


def idle_text(idle: Sequence[str]) -> str:
    """The freedoms that move no other link, and that they are held."""
    return say("{freedoms}, held by convention", freedoms=say("; ").join(map(retold, idle)))


def idle_note(linkage: Solvable, links: Iterable[int]) -> str:
    """That points of some links go where an idle freedom is held; empty where none of the links has one."""
    idle = sorted(linkage.idle_links & set(links))
    if not idle:
        return ""
    return say(
        "idle freedom: {held}; points of link{s} {links} go with it",
        held=idle_text(linkage.idle), s="s" * (len(idle) > 1), links=say(", ").join(map(str, idle)),
    )  # fmt: skip


def completeness_text(word: str, *, curve: bool = False, unfollowed: bool = False) -> str:
    """The word for how it is known that nothing is missing, and its meaning.

    Modes may have a `curve` too; of a motion some modes may be `unfollowed`.
    """
    meanings = COMPLETE_WITH_CURVE if curve else COMPLETE
    if unfollowed:
        meanings = meanings | COMPLETE_BUT_UNFOLLOWED
    return say("{word}: {meaning}", word=say(word), meaning=say(meanings[word]))


def _limits_text(motion: Motion) -> str:
    """The input's limits; of many no more than their number, since the tables have them by circuit."""
    if motion.limits.size > MOST_LIMITS:
        return say("{count}, by circuit in the table below", count=motion.limits.size)
    if motion.limits.size:
        return "  ".join(map(Shown(motion.linkage.unit_of(motion.input)), motion.limits))
    turns = all(circuit.input_range is None for circuit in motion)
    return say("none: the input turns fully") if turns else say("none found")


def joints_text(linkage: Loop) -> str:
    """The joints in loop order: kinds and names."""
    return "  ".join(f"{joint.kind} {joint.name}" for joint in linkage.joints)


def dimensions_text(linkage: Solvable) -> str:
    """The dimensions by name; nothing of Denavit-Hartenberg rows, which want a table."""
    numbers = {} if linkage.in_rows else dict(linkage.dimensions) or side_lengths(linkage)
    listed = "  ".join(f"{key} = {value:.6g}" for key, value in numbers.items())
    return f"{listed}  [{linkage.length_unit}]" if listed else ""


def _change_points(motion: Motion) -> list[tuple[str, str]]:
    """Lines for the poses at which branches meet, and for those that stand alone."""
    show = Shown(motion.linkage.unit_of(motion.input))
    lines = []
    meeting = [point for point in motion.change_points if not point.isolated]
    if meeting:
        # several poses may share an input
        poses = Counter(show(x, whole=True) for x in motion.change_point_inputs)
        where = "  ".join(
            say("{value} ({count} poses)", value=value, count=count) if count > 1 else value
            for value, count in poses.items()
        )
        what = say(
            "input {where}: branches meet there; the least change of a dimension decides how it goes on",
            where=where,
        )
        lines.append(("change point", what))
    free = max((point.freedoms for point in meeting), default=0)
    if free > 1:
        more = say("there it can also move with {count} freedoms, which no circuit shows", count=free)
        lines.append(("", more))
    alone = [show(point.input, whole=True) for point in motion.change_points if point.isolated]
    if alone:
        where = "  ".join(alone)
        lines.append(("isolated pose", say("input {where}: no motion leads out of it", where=where)))
    return lines


def nearly_moves(motion: Motion) -> str:
    """By how little a linkage without a circuit misses a motion; empty where it moves, or misses more."""
    near = motion.near_motion
    if near is None:
        return ""
    return say(
        "as a {motion_type}: redundant constraints miss by up to {share:.1e} of the size "
        "({miss:.2g} {unit}), or as many rad; --agree {agree:.0e} takes them to agree",
        motion_type=say(near.motion_type), share=near.share, miss=near.miss, agree=near.agree,
        unit=motion.linkage.length_unit,
    )  # fmt: skip


def meaning(motion: Motion) -> str:
    """A sentence on a type that is not a pair of words for input and output, or met twice over."""
    if motion.circuits and motion.mobility.met_twice > 0:
        return say(
            "a constraint is met twice over along the circuits: the least change of a dimension parts each "
            "in two, or leaves none"
        )
    match motion.motion_type:
        case "two-inputs":
            return say(
                "the loop moves with {count} freedoms, so one input does not determine it: lock a joint "
                "(leave it out), or, where another loop moves it by two of its joints, write both as one "
                "linkage with links by name",
                count=motion.mobility.finite,
            )
        case "not-followed":
            return say(
                "the loop moves with one freedom, but none of its motions could be followed: a constraint is "
                "met twice over along them, which the least change of a dimension undoes"
            )
        case "rigid":
            taken = motion.mobility.freedoms - len(motion.idle)
            if motion.idle:
                return say(
                    "the loop closes but cannot move: closing it removes all of its {count} freedoms "
                    "that are not idle",
                    count=taken,
                )
            return say(
                "the loop closes but cannot move: closing it removes all of its {count} freedoms", count=taken
            )
        case "cannot-assemble" if motion.linkage.kind == "RSSR":
            return say("no input closes the loop: the coupler is too short or too long")
        case "cannot-assemble" if motion.linkage.in_rows and motion.four_bar is None:
            return say(
                "no values of the joints were found that close the loop; the table of an open arm wants one "
                "joint more, at the hand, as the input: draw all joints in a pose of the hand, and 'sevenbar "
                "modes' at 0 lists the arm's postures there"
            )
        case "cannot-assemble":
            return say("no values of the joints were found that close the loop")
        case "change-point" if all(point.isolated for point in motion.change_points):
            return say(
                "two limits of a joint lie within 1e-6 rad, or 1e-6 of the size: a change of a dimension by "
                "a millionth, or far less, joins or parts circuits there"
            )
        case "change-point":
            return say("the motion runs through a pose from which it can go on in more than one way")
        case "mixed":
            return say("the circuits differ; see below")
    return ""


def _mobility(mobility: Mobility) -> str:
    taken = mobility.freedoms - mobility.gruebler
    count = say(
        "Gruebler {all} - {taken} = {left}", all=mobility.freedoms, taken=taken, left=mobility.gruebler
    )
    parts = [count]
    if mobility.rank is not None:
        parts.append(say("rank {rank}", rank=mobility.rank))
    if number := len(mobility.idle):
        parts.append(say("{count} idle freedom{s}", count=number, s="s" * (number > 1)))
    if number := len(mobility.redundant):
        parts.append(say("{count} redundant constraint{s}", count=number, s="s" * (number > 1)))
    start = say("not known, as no pose was found") if mobility.finite is None else f"{mobility.finite}"
    return say("{mobility} ({parts})", mobility=start, parts=say(", ").join(parts))


def _circuit_count(motion: Motion) -> str:
    if not motion.circuits:
        return say("none: it closes only in isolated poses") if motion.change_points else say("none")
    turning = sorted({c.turns for c in motion if c.closed and c.turns})
    # of one circuit, of each, of several
    ways = [
        (
            sum(c.closed and c.turns == k for c in motion),
            say("closes after {turns} of the input", turns=turns_text(k)),
            say("close after {turns} of the input", turns=turns_text(k)),
        )
        for k in turning
    ]
    ways += [
        (sum(c.closed and c.turns == 0 for c in motion), say("goes to and fro"), say("go to and fro")),
        (sum(not c.closed for c in motion), say("is not known to close"), say("are not known to close")),
    ]
    result = [way for way in ways if way[0]]
    total = len(motion.circuits)
    if len(result) == 1:
        ((_, one, _),) = result
        if total > 1:
            return say("{count}, each {way}", count=total, way=one)
        return say("{count}, it {way}", count=total, way=one)
    each = (
        say("{count} {way}", count=count, way=several if count > 1 else one) for count, one, several in result
    )
    return say("{count}: {ways}", count=total, ways=say(", ").join(each))


def turns_text(count: int) -> str:
    """A number of turns, in words where it is small."""
    words = {1: say("one turn"), 2: say("two turns")}
    return words.get(count) or say("{count} turns", count=count)
