"""Why answers may differ, as docs/not-covered.md has it: each reason explains some answers, and no others."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from evidence.rewritten.answers import OPEN, Answers, differs, matched
from evidence.rewritten.ways import Way

UNFOLLOWED, COMPLETENESS = "some not followed", "completeness"

#: What is counted of circuits, and said of all together.
COUNTS = frozenset(
    (
        "motion type",
        "circuits",
        "types of circuits",
        "circuits that close",
        "dead centres",
        "limits",
        "change points",
    )
)

#: Numbers of circuits by the first words of their differences.
NUMBERS = ("closes", "extent of the input", "extent of the output", "swing", "time ratio")
OF_CIRCUITS = frozenset(f"circuit, {name}" for name in NUMBERS)
OF_OPEN = frozenset(f"{OPEN} circuit, {name}" for name in NUMBERS)
PEAKS = ("lowest velocity", "highest velocity")
EXTREMES = frozenset(f"circuit, {name}" for name in PEAKS)
EXTREMES_OF_OPEN = frozenset(f"{OPEN} circuit, {name} velocity" for name in ("lowest", "highest"))

#: Rate of the output against the input from which a peak is narrower than a thousandth of what it passes.
NARROW_PEAK = 1e3


@dataclass(frozen=True)
class Reason:
    """A sentence, the first words of the differences that it explains, and when it holds."""

    why: str
    explains: frozenset[str]
    holds: Callable[[Way, Answers, Answers], bool]


def _searched(way: Way, drawn: Answers, written: Answers) -> bool:
    """Whether the one that is searched, or one of two, has nothing that the other has not."""
    searched = [one.words.get(COMPLETENESS) == "searched" for one in (drawn, written)]
    within = (searched[0] and _within(way, drawn, written)) or (searched[1] and _within(way, written, drawn))
    return within or (any(searched) and not drawn.circuits and not written.circuits)


def _within(way: Way, less: Answers, more: Answers) -> bool:
    """Whether each circuit that closes is one of the other's, to its numbers."""
    closing = [one for one in less.circuits if one["closes"]]
    return matched(closing, more.circuits, less.near(more, way))


def _plain_alike(way: Way, one: Answers, other: Answers) -> bool:
    """Whether both have the same circuits away from change points, to their numbers."""
    near = one.near(other, way)
    return len(one.plain) == len(other.plain) and matched(one.plain, other.plain, near)


def _both_unfollowed(way: Way, drawn: Answers, written: Answers) -> bool:
    change = drawn.is_change or written.is_change
    return change and _unfollowed(drawn) and _unfollowed(written) and _plain_alike(way, drawn, written)


def _one_unfollowed(way: Way, drawn: Answers, written: Answers) -> bool:
    """Whether the one that says so has no circuit away from change points that the other has not."""
    if not (drawn.is_change or written.is_change) or _unfollowed(drawn) == _unfollowed(written):
        return False
    less, more = (drawn, written) if _unfollowed(drawn) else (written, drawn)
    return matched(less.plain, more.circuits, less.near(more, way))


def _unfollowed(one: Answers) -> bool:
    return bool(one.words.get(UNFOLLOWED))


def _idle(one: Answers) -> int:
    count = one.words.get("idle", 0)
    return count if isinstance(count, int) else 0


def _sure(drawn: Answers, written: Answers) -> set[object]:
    return {drawn.words.get(COMPLETENESS), written.words.get(COMPLETENESS)}


def _nothing_but(*what: str) -> Callable[[Way, Answers, Answers], bool]:
    return lambda way, drawn, written: differs(way, drawn, written) == set(what)


def _two_inputs(one: Answers) -> bool:
    """Whether it is one whose circuits are not followed, as two inputs move it."""
    return one.words.get("motion type") == "two-inputs" and not one.circuits


def _freedoms(one: Answers) -> int:
    finite = one.words.get("finite")
    return (finite if isinstance(finite, int) else 0) + _idle(one)


def _surface_with_curves(_: Way, drawn: Answers, written: Answers) -> bool:
    """Whether one moves with a freedom more than the other, whose circuits all pass change points."""
    more, less = sorted((drawn, written), key=_freedoms, reverse=True)
    kinds = less.words.get("types of circuits")
    return (
        _two_inputs(more)
        and _unfollowed(more)
        and _unfollowed(less)
        and bool(less.circuits)
        and set(kinds if isinstance(kinds, list) else []) == {"change-point"}
        and _freedoms(more) == _freedoms(less) + 1
    )


def _peak(way: Way, drawn: Answers, written: Answers) -> bool:
    """Whether nothing differs but extremes of the velocity, one of which is a narrow peak."""
    found = differs(way, drawn, written)
    highest = max(
        (
            abs(one[name] or 0.0)
            for side in (drawn, written)
            for one in side.circuits
            for name in PEAKS
            if name in one
        ),
        default=0.0,
    )
    return found <= EXTREMES and highest > NARROW_PEAK


def _breaks_off(way: Way, drawn: Answers, written: Answers) -> bool:
    """Whether one has a circuit through a change point of which it says that it is not known to close."""

    def breaks(one: Answers) -> bool:
        return "change-point" in str(one.words.get("types of circuits")) and not all(
            circuit["closes"] for circuit in one.circuits
        )

    return (breaks(drawn) or breaks(written)) and _plain_alike(way, drawn, written)


def _stops_for_a_moment(_: Way, drawn: Answers, written: Answers) -> bool:
    """Whether one has one dead centre more; on circuits that close, as all do, they come in pairs."""
    both = drawn, written
    counts = [
        sum(centres) if isinstance(centres := one.words.get("dead centres"), list) else 0 for one in both
    ]
    closed = all(circuit["closes"] for one in both for circuit in one.circuits)
    return closed and abs(counts[0] - counts[1]) == 1 and len(drawn.circuits) == len(written.circuits)


#: In the order in which they are asked.
REASONS = (
    Reason(
        "searched, screws and slides within bounds that count from how it is written",
        COUNTS | OF_OPEN | {COMPLETENESS, UNFOLLOWED},
        _searched,
    ),
    Reason(
        "both report a surface of poses; whether a mode on it is met besides is chance",
        frozenset((UNFOLLOWED,)),
        lambda _, drawn, written: drawn.surface and written.surface,
    ),
    Reason(
        "all circuits are counted; a surface of poses is met where one of them is drawn, and rows draw none",
        frozenset((UNFOLLOWED,)),
        lambda way, drawn, written: (
            way.name.startswith("as rows")
            and _nothing_but(UNFOLLOWED)(way, drawn, written)
            and _unfollowed(drawn)
            and _sure(drawn, written) == {"counted"}
        ),
    ),
    Reason(
        "both say that not all was followed: curves that touch or coincide are joined in part",
        COUNTS | OF_CIRCUITS | OF_OPEN | {COMPLETENESS},
        _both_unfollowed,
    ),
    Reason(
        "one says that not all was followed: its curves break off where they touch others",
        COUNTS | OF_CIRCUITS | OF_OPEN | {COMPLETENESS, UNFOLLOWED},
        _one_unfollowed,
    ),
    Reason(
        "of circuits that are not counted, whether modes on curves that coincide are met is chance",
        frozenset((UNFOLLOWED,)),
        lambda way, drawn, written: (
            _nothing_but(UNFOLLOWED)(way, drawn, written) and _sure(drawn, written) == {"algebraic"}
        ),
    ),
    Reason(
        "all else agrees: about change points, and far out, branch points balance in some ways only",
        frozenset((COMPLETENESS,)),
        lambda way, drawn, written: (
            _nothing_but(COMPLETENESS)(way, drawn, written)
            and _sure(drawn, written) == {"algebraic", "counted"}
        ),
    ),
    Reason(
        "all circuits agree; modes on a surface of poses are met or not, and leave the count open",
        frozenset((UNFOLLOWED, COMPLETENESS)),
        lambda way, drawn, written: (
            _nothing_but(UNFOLLOWED, COMPLETENESS)(way, drawn, written)
            and bool(drawn.circuits)
            and _sure(drawn, written) == {"algebraic", "counted"}
        ),
    ),
    Reason(
        "two inputs move it in some poses, not covered; curves that touch those are met in some ways",
        frozenset(("finite", "redundant")),
        _surface_with_curves,
    ),
    Reason(
        "two inputs move it in some poses, not covered; in others the input stands still",
        frozenset(("refused",)),
        lambda _, drawn, written: (
            (_two_inputs(drawn) and written.refused == "input")
            or (_two_inputs(written) and drawn.refused == "input")
        ),
    ),
    Reason(
        "all else agrees: a peak of the velocity so narrow is met between rows or missed",
        EXTREMES,
        _peak,
    ),
    Reason(
        "a circuit breaks off at a change point where curves touch, and says that it is not known to close",
        COUNTS | OF_CIRCUITS | OF_OPEN,
        _breaks_off,
    ),
    Reason(
        "two dead centres in one place, at which the input stops for a moment and goes on, are one or none",
        EXTREMES | {"dead centres", "limits"},
        _stops_for_a_moment,
    ),
    Reason(
        "slides run to infinity, and are followed to a distance from where they are written",
        OF_OPEN | EXTREMES_OF_OPEN,
        lambda _, drawn, written: drawn.runs_off and written.runs_off,
    ),
    Reason(
        "slides run to infinity, and a mode out there is beyond that distance in some ways",
        frozenset((UNFOLLOWED,)),
        lambda way, drawn, written: (
            drawn.runs_off
            and written.runs_off
            and differs(way, drawn, written) - OF_OPEN - EXTREMES_OF_OPEN == {UNFOLLOWED}
        ),
    ),
    Reason(
        "of a structure that shakes, rank and redundant constraints are known to the root of rounding",
        frozenset(("redundant", "finite", "change points", COMPLETENESS)),
        lambda _, drawn, written: not drawn.circuits and not written.circuits,
    ),
    Reason(
        "places far off are rounded as much more, and the root of that counts at change points",
        COUNTS,
        lambda way, drawn, written: (
            way.rounding > 1 and drawn.is_change and written.is_change and _plain_alike(way, drawn, written)
        ),
    ),
    Reason(
        "next to the ground the turn of a link is a motion of all others as one body",
        COUNTS | {COMPLETENESS, UNFOLLOWED, "finite", "idle", "refused"},
        lambda way, drawn, written: not way.same_ground and abs(_idle(drawn) - _idle(written)) == 1,
    ),
    Reason(
        "in poses that stand alone an RSSR is at a change point by its closed form, rigid written otherwise",
        frozenset(("motion type",)),
        lambda way, drawn, written: (
            not way.same_ground
            and not drawn.circuits
            and not written.circuits
            and bool(drawn.words.get("change points"))
            and {drawn.words.get("motion type"), written.words.get("motion type")}
            == {"change-point", "rigid"}
        ),
    ),
    Reason(
        "of two joints that move a link idly the last is free, else the first; outputs held are refused",
        frozenset(("refused",)),
        lambda way, drawn, written: (
            not way.same_ground
            and {drawn.refused, written.refused} == {"output", ""}
            and _idle(drawn) == _idle(written) == 1
        ),
    ),
)


def reason(way: Way, drawn: Answers, written: Answers, difference: str) -> str:
    """Why two answers may differ in this; empty where they may not."""
    what = difference.partition(":")[0]
    for one in REASONS:
        if what in one.explains and one.holds(way, drawn, written):
            return one.why
    return ""
