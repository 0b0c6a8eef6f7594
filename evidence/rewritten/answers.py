"""What a linkage answers, in the values of the drawing, and where two answers differ."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from scipy.optimize import linear_sum_assignment

from evidence.rewritten.ways import Way
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.kinematics.linkage import Linkage

#: Samples of a turn.
SAMPLES = 36

#: How nearly numbers agree: limits are known to the root of the rounding of what is written.
SAME = 2e-6

#: Numbers that are roots of roundings: at change points.
ROUGH = 2e-3

#: Of a circuit, the numbers that are compared.
Numbers = dict[str, float | None]


@dataclass(frozen=True, eq=False)
class Answers:
    """Words of a motion, by what they are of, and the numbers of each circuit [rad, or length as drawn]."""

    words: dict[str, object]
    limits: list[float]
    circuits: list[Numbers]
    four_bar: Numbers
    is_change: bool
    #: Whether some circuit is followed to a distance only, as a slide runs to infinity.
    runs_off: bool = False


def answers_of(way: Way) -> Answers:
    """All that is compared of one way of writing a linkage."""
    linkage = way.linkage
    motion = linkage.motion(SAMPLES, input=way.input, output=way.output)
    search, mobility = motion.search, motion.mobility
    turns = linkage.turns(way.input)
    words: dict[str, object] = {
        "motion type": motion.motion_type,
        "circuits": len(motion.circuits),
        "types of circuits": sorted(circuit.motion_type for circuit in motion.circuits),
        "circuits that close": sorted(circuit.closed for circuit in motion.circuits),
        "change points": len(motion.change_points),
        "dead centres": sorted(len(circuit.dead_centres) for circuit in motion.circuits),
        # how many of the modes at the values that were searched lie on what is not followed is chance
        "some not followed": search.unfollowed > 0,
        "freedoms": mobility.freedoms,
        "finite": mobility.finite,
        "idle": len(mobility.idle),
        "redundant": len(mobility.redundant),
        # a closed form knows all circuits, as a count does
        "completeness": "counted" if motion.completeness == "closed-form" else motion.completeness,
    }
    if way.same_ground:
        words["planar"], words["spherical"] = linkage.is_planar, linkage.sphere is not None
    four_bar: Numbers = {}
    if way.same_ground and (links := motion.four_bar) is not None:
        words["Grashof"] = links.grashof
        unit = 1.0 if links.kind == "spherical" else way.scale
        lengths = sorted(length / unit for length in links.links.values())
        four_bar = {f"link {k + 1}": length for k, length in enumerate(lengths)}
    limits = [_input(way, value, turns) for value in motion.limits]
    is_change = bool(len(motion.change_points)) or "change" in motion.motion_type
    numbers = [_circuit(way, one) for one in motion.circuits]
    return Answers(words, sorted(limits), numbers, four_bar, is_change, runs_off=_runs_off(linkage, motion))


def _runs_off(linkage: Linkage, motion: Motion) -> bool:
    def turns(circuit: Circuit) -> int:
        return sum(centre.kind == "input" for centre in circuit.dead_centres)

    open_ends = any(not circuit.closed and turns(circuit) < 2 for circuit in motion.circuits)
    # an open circuit with two of them may run off beyond both
    open_ends |= any(
        not circuit.closed and circuit.motion_type != "change-point" for circuit in motion.circuits
    )
    return open_ends and any(kind in "PC" for kind in linkage.kind)


def _input(way: Way, value: float, turns: bool) -> float:
    sign, shift = way.signs[0], way.shifts[0]
    drawn = sign * (value - shift) / (1.0 if turns else way.scale)
    return drawn % math.tau if turns else drawn


def _circuit(way: Way, circuit: Circuit) -> Numbers:
    found: Numbers = {}
    for name, ends, turns in (
        ("input", circuit.input_range, circuit.input_turns),
        ("output", circuit.output_range, circuit.output_turns),
    ):
        found[f"extent of the {name}"] = (
            None if ends is None else (ends[1] - ends[0]) / (1.0 if turns else way.scale)
        )
    unit_in, unit_out = (1.0 if turns else way.scale for turns in (circuit.input_turns, circuit.output_turns))
    found["swing"] = None if circuit.swing is None else circuit.swing / unit_out
    found["time ratio"] = circuit.time_ratio
    if circuit.velocity is not None:
        # a rate against the input, whatever the speed
        rates = [
            way.signs[0] * way.signs[1] * value
            for value in (circuit.velocity.lowest, circuit.velocity.highest)
        ]
        per = abs(circuit.speed) * unit_out / unit_in
        found["lowest velocity"], found["highest velocity"] = sorted(rate / per for rate in rates)
    if way.same_ground and (angle := circuit.transmission) is not None:
        found["lowest transmission angle"], found["highest transmission angle"] = angle.lowest, angle.highest
    return found


def differences(way: Way, drawn: Answers, written: Answers) -> Iterator[str]:
    """What differs from the drawing, in words; nothing where all agrees."""
    for word, value in written.words.items():
        if word in drawn.words and value != drawn.words[word]:
            yield f"{word}: {drawn.words[word]!r} as drawn, {value!r} {way.name}"
    near = (ROUGH if drawn.is_change or written.is_change else SAME) * max(1.0, way.rounding / 10)
    if len(drawn.limits) != len(written.limits):
        yield f"limits: {len(drawn.limits)} as drawn, {len(written.limits)} {way.name}"
    else:
        yield from _apart("limits", drawn.limits, written.limits, near, way)
    yield from _numbers("four-bar", drawn.four_bar, written.four_bar, near, way)
    if drawn.circuits and len(drawn.circuits) == len(written.circuits):
        apart = [[_distance(one, other) for other in written.circuits] for one in drawn.circuits]
        # all pairs at once: of circuits with equal ranges the nearest may be another's
        for i, k in zip(*linear_sum_assignment(apart), strict=True):
            yield from _numbers("circuit", drawn.circuits[i], written.circuits[k], near, way)


def differs(way: Way, drawn: Answers, written: Answers) -> set[str]:
    """What of the answers differs, by its first words."""
    return {line.partition(":")[0] for line in differences(way, drawn, written)}


def reason(way: Way, drawn: Answers, written: Answers) -> str:
    """Why answers may differ, as docs/not-covered.md has it; empty where they may not."""
    if "searched" in (drawn.words.get("completeness"), written.words.get("completeness")):
        return "searched, screws and slides within bounds that count from how it is written"
    unfollowed = "some not followed"
    if drawn.is_change and (drawn.words.get(unfollowed) or written.words.get(unfollowed)):
        if drawn.words[unfollowed] == written.words[unfollowed]:
            return "both say that not all was followed: curves that touch or coincide are joined in part"
        if differs(way, drawn, written) - {unfollowed}:
            return "one says that not all was followed: its curves break off where they touch others"
    words = differs(way, drawn, written)
    sure = {drawn.words.get("completeness"), written.words.get("completeness")}
    if words == {unfollowed} and sure == {"algebraic"}:
        return "of circuits that are not counted, whether modes on curves that coincide are met is chance"
    if words == {"completeness"} and sure == {"algebraic", "counted"} and drawn.is_change:
        return "all else agrees: about change points the count of branch points balances in some ways only"
    if drawn.runs_off and written.runs_off:
        return "slides run to infinity, and are followed to a distance from where they are written"
    if not drawn.circuits and not written.circuits:
        return "of a structure that shakes, rank and redundant constraints are known to the root of rounding"
    if way.rounding > 1 and drawn.is_change:
        return "places far off are rounded as much more, and the root of that counts at change points"
    if not way.same_ground and {drawn.words.get("idle"), written.words.get("idle")} == {0, 1}:
        return "beside the ground the turn of a link is a motion of all others as one body"
    return ""


def _apart(name: str, one: list[float], other: list[float], near: float, way: Way) -> Iterator[str]:
    """Whether sorted numbers agree, angles by whole turns."""
    missed = 0.0
    for value in one:
        missed = max(missed, min(_gap(value, there) for there in other))
    if missed > near:
        yield f"{name}: {missed:.1e} apart {way.name}"


def _gap(one: float, other: float) -> float:
    apart = abs(one - other)
    return min(apart, abs(math.tau - apart)) / max(1.0, abs(one))


def _numbers(name: str, one: Numbers, other: Numbers, near: float, way: Way) -> Iterator[str]:
    for key in one.keys() & other.keys():
        a, b = one[key], other[key]
        if (a is None) != (b is None):
            yield f"{name}, {key}: {a} as drawn, {b} {way.name}"
        elif a is not None and b is not None and not abs(a - b) <= near * max(1.0, abs(a)):
            yield f"{name}, {key}: {a:.9g} as drawn, {b:.9g} {way.name}"


def _distance(one: Numbers, other: Numbers) -> float:
    """How unlike two circuits are: of each number the relative gap, at most 1."""
    found = 0.0
    for key in one.keys() & other.keys():
        a, b = one[key], other[key]
        if a is None or b is None:
            found += a is not b
        else:
            found += min(abs(a - b) / max(1.0, abs(a)), 1.0)
    return found
