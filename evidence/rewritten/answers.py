"""What a linkage answers, in the values of the drawing, and where two answers differ."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field

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

#: Of a circuit, the numbers that are compared; whether it closes is 1 or 0.
Numbers = dict[str, float | None]

#: How numbers of circuits are called that do not close.
OPEN = "open"


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
    #: Those of the circuits that close and pass no change point.
    plain: list[Numbers] = field(default_factory=list)
    #: Whether it reports a surface of poses that no circuit shows.
    surface: bool = False
    #: The argument that was refused, where none but an error came.
    refused: str = ""

    def near(self, other: Answers, way: Way) -> float:
        """How nearly numbers of the two agree."""
        return (ROUGH if self.is_change or other.is_change else SAME) * max(1.0, way.rounding / 10)


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
    plain = [
        one
        for one, circuit in zip(numbers, motion.circuits, strict=True)
        if circuit.closed and circuit.motion_type != "change-point"
    ]
    surface = any(point.freedoms > 1 for point in motion.change_points)
    return Answers(
        words, sorted(limits), numbers, four_bar, is_change, _runs_off(linkage, motion), plain, surface
    )


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
    found: Numbers = {"closes": float(circuit.closed)}
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
    refused = [one.words.get("refused", "nothing") for one in (drawn, written)]
    if refused[0] != refused[1]:
        yield f"refused: {refused[0]} as drawn, {refused[1]} {way.name}"
        return
    for word, value in written.words.items():
        if word in drawn.words and value != drawn.words[word]:
            yield f"{word}: {drawn.words[word]!r} as drawn, {value!r} {way.name}"
    near = drawn.near(written, way)
    if len(drawn.limits) != len(written.limits):
        yield f"limits: {len(drawn.limits)} as drawn, {len(written.limits)} {way.name}"
    else:
        yield from _apart("limits", drawn.limits, written.limits, near, way)
    yield from _numbers("four-bar", drawn.four_bar, written.four_bar, near, way.name)
    if drawn.circuits and len(drawn.circuits) == len(written.circuits):
        apart = [[_distance(one, other) for other in written.circuits] for one in drawn.circuits]
        # all pairs at once: of circuits with equal ranges the nearest may be another's
        for i, k in zip(*linear_sum_assignment(apart), strict=True):
            one, other = drawn.circuits[i], written.circuits[k]
            name = "circuit" if one["closes"] or other["closes"] else f"{OPEN} circuit"
            yield from _numbers(name, one, other, near, way.name)


def differs(way: Way, drawn: Answers, written: Answers) -> set[str]:
    """What of the answers differs, by its first words."""
    return {line.partition(":")[0] for line in differences(way, drawn, written)}


def matched(few: list[Numbers], many: list[Numbers], near: float) -> bool:
    """Whether each of some circuits is another of many, to the numbers that both have."""
    if not few or len(few) > len(many):
        return not few
    apart = [[_distance(one, other) for other in many] for one in few]
    pairs = zip(*linear_sum_assignment(apart), strict=True)
    return not any(next(_numbers("", few[i], many[k], near, ""), None) for i, k in pairs)


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


def _numbers(name: str, one: Numbers, other: Numbers, near: float, way: str) -> Iterator[str]:
    for key in one.keys() & other.keys():
        a, b = one[key], other[key]
        if (a is None) != (b is None):
            yield f"{name}, {key}: {a} as drawn, {b} {way}"
        elif a is not None and b is not None and not abs(a - b) <= near * max(1.0, abs(a)):
            yield f"{name}, {key}: {a:.9g} as drawn, {b:.9g} {way}"


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
