"""Designs that were found, and the ordinary analysis that says whether each does what was claimed of it."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol, Self, TypeVar

import numpy as np

from sevenbar.arrays import Booleans, Floats, Integers, short_way
from sevenbar.description.draft import Draft
from sevenbar.design.closure import row_of, transmission_slopes, transmissions
from sevenbar.design.limits import Limits
from sevenbar.errors import DescriptionError, RequestError
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.motion import Motion
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.loop.law import Law
from sevenbar.text.printing import Printed, brief, lines, text_of
from sevenbar.text.words import language, say

#: Inputs of a turn with which a design is checked: rows stand half a degree apart.
CHECK_SAMPLES = 720

#: How far a claimed pose may lie from the polygon through a circuit's rows [rad, or relative to the size];
#: the polygon's own sagitta is below 1e-3 but next to dead centres.
NEAR = 0.02

#: By how much a pose may lie behind the one before it [rows]: several see one corner of the polygon.
PLACE_SLACK = 0.1

#: Inputs over the used range at which the transmission angle is checked.
RANGE_SAMPLES = 361

#: Times that the samples about the least are taken closer, after which it is exact to 1e-9.
CLOSER = 2

#: Halvings between two of them, down to rounding.
MOST_HALVINGS = 50

#: By how much a limit may be missed through rounding: [rad] and parts of a length.
LIMIT_ROUNDING = 1e-9

#: Two designs are one where no dimension, relative to the longest [or rad], differs by more.
SAME = 0.05


class Drafted(Protocol):
    """What has a description."""

    @property
    def draft(self) -> Draft:
        """Its description."""
        ...


class DesignResult(Drafted, Protocol):
    """What a search gives: it has a description, and may have another."""

    @property
    def candidate(self) -> Candidate:
        """What the ordinary analysis says of it."""
        ...

    def drafted(self, draft: Draft) -> Self:
        """The same with another description."""
        ...


T = TypeVar("T", bound=DesignResult)


@dataclass(frozen=True, eq=False)
class Claim:
    """What is claimed of a design: poses it takes, in this order and on one way; and how far off it is.

    `inputs` and `outputs` (n,) are values of the drive's two joints [rad, or length]. `errors` (m,) are the
    deviations from what was wanted, shown in `error_unit` ("deg": they are in rad; else a length unit).
    `figures` holds numbers of the task's own, by the names they have in tables.
    """

    inputs: Floats
    outputs: Floats
    errors: Floats
    error_unit: str = "deg"
    figures: Mapping[str, float] = field(default_factory=dict)
    #: Whether the input turns fully at work, so that all of the turn counts, not only the way between poses.
    whole_turn: bool = False


@dataclass(frozen=True)
class Refusal:
    """Why a design was refused: the kind of fault, and a sentence with its numbers."""

    fault: str
    detail: str


@dataclass(frozen=True, eq=False, repr=False)
class Candidate(Printed):
    """A design that keeps what is claimed of it, with what was measured of it.

    `transmission_lowest` [rad] over the used range of the input, `None` where the loop has none; `circuit`
    and `branch` the one way that holds all `claim` poses; `position` (n,) their places along it, in rows of
    the circuit.
    """

    draft: Draft
    claim: Claim
    motion_type: str
    transmission_lowest: float | None
    circuit: int
    branch: int
    position: Floats

    @property
    def candidate(self) -> Candidate:
        """Itself: what the ordinary analysis says of the design."""
        return self

    def drafted(self, draft: Draft) -> Candidate:
        """The same with another description."""
        return replace(self, draft=draft)

    @property
    def name(self) -> str:
        """The name of its linkage."""
        return self.draft.linkage.name

    @property
    def error_greatest(self) -> float:
        """The greatest of its errors [rad, or length]."""
        return float(np.abs(self.claim.errors).max())

    @property
    def error_rms(self) -> float:
        """The root mean square of its errors [rad, or length]."""
        return float(np.sqrt((self.claim.errors**2).mean()))

    @property
    def size(self) -> float:
        """Its longest dimension [length]."""
        return max(abs(d.value) for d in self.draft.dimensions if d.kind == "length")

    @property
    def columns(self) -> dict[str, float | str | int | None]:
        """What is reported of it, column by column; each number's name ends in its unit."""
        linkage, unit = self.draft.linkage, self.claim.error_unit
        scale = 180 / math.pi if unit == "deg" else 1.0
        ending = f"_{unit}" if unit else ""
        lowest = self.transmission_lowest
        return {
            f"error_greatest{ending}": self.error_greatest * scale,
            f"error_rms{ending}": self.error_rms * scale,
            "transmission_lowest_deg": None if lowest is None else math.degrees(lowest),
            f"size_{linkage.length_unit}": self.size,
            "motion_type": self.motion_type,
            "circuit": self.circuit,
            "branch": self.branch,
            **self.claim.figures,
            **{d.column: d.value for d in self.draft.dimensions if d.kind != "speed"},
        }


def checked(
    draft: Draft,
    claim: Claim,
    limits: Limits | None = None,
    *,
    poses: Floats | None = None,
    motion: Motion | None = None,
    samples: int = CHECK_SAMPLES,
) -> Candidate | Refusal:
    """The design as the ordinary analysis finds it, or why it does not do what is claimed.

    All poses must lie on one circuit and on one pass of it, so that no dead centre of the input is between
    any two, and follow each other in the order claimed; then come the limits. `poses` (n, columns) hold all
    joints, where circuits may share the values of input and output. `samples` inputs of a full turn are
    compared: more where the input moves little; `motion` is that of the design where it is known. Raises
    nothing for a design that cannot be a linkage: that is a refusal, too.
    """
    limits = Limits() if limits is None else limits
    result = analysed(draft, samples) if motion is None else motion
    if isinstance(result, Refusal):
        return result
    motion = result
    if not motion.circuits:
        return Refusal("assembly", "cannot be assembled at any input")
    ways = located(motion, claim.inputs, claim.outputs, poses)
    lost = np.flatnonzero(ways.circuit < 0)
    if lost.size:
        return Refusal("assembly", f"point {lost[0] + 1} of {len(ways.circuit)} is reached by no circuit")
    if fault := one_way(ways.circuit, ways.branch):
        return fault
    circuit = motion.circuits[ways.circuit[0]]
    if fault := _in_order(circuit, ways.position):
        return fault
    if claim.whole_turn:
        lowest = None if circuit.transmission is None else circuit.transmission.lowest
    else:
        lowest = used_transmission(draft.linkage, circuit, claim.inputs, ways.position)
    place = int(ways.circuit[0]), int(ways.branch[0])
    return within_limits(Candidate(draft, claim, motion.motion_type, lowest, *place, ways.position), limits)


def analysed(draft: Draft, samples: int) -> Motion | Refusal:
    """The motion of a design, or why it is no linkage."""
    try:
        return draft.linkage.motion(samples)
    except (DescriptionError, RequestError) as error:
        return Refusal("assembly", str(error))


@dataclass(frozen=True, eq=False)
class Ways:
    """Where poses lie: circuit and branch of each (n,), -1 where on none; place along its rows (n,)."""

    circuit: Integers
    branch: Integers
    position: Floats
    distance: Floats


def located(motion: Motion, inputs: Floats, outputs: Floats, whole: Floats | None = None) -> Ways:
    """The circuits, branches and places of poses given by the values of input and output (n,).

    With `whole` (n, columns) by those of all joints, but the turns of balls.
    """
    count = len(inputs)
    best = Ways(np.full(count, -1), np.full(count, -1), np.full(count, np.nan), np.full(count, np.inf))
    for circuit in motion.circuits:
        columns = [circuit.input_column, circuit.output_column]
        if whole is not None:
            others = [column.number for column in motion.linkage.each_column if column.is_output]
            columns += [column for column in others if column not in columns]
        turning = motion.linkage.turning[columns]
        rows = circuit.q[:, columns]
        poses = np.column_stack([inputs, outputs]) if whole is None else whole[:, columns]
        steps = joint_differences(np.roll(rows, -1, axis=0) - rows, turning, circuit.size)
        if not circuit.closed:
            steps[-1] = 0.0
        # (n, rows, columns)
        off = joint_differences(poses[:, None, :] - rows[None], turning, circuit.size)
        length = np.maximum((steps**2).sum(axis=1), np.finfo(float).tiny)
        share = np.clip(np.nan_to_num((off * steps).sum(axis=2) / length), 0.0, 1.0)
        distance = np.linalg.norm(off - share[:, :, None] * steps, axis=2)
        distance = np.where(np.isfinite(distance), distance, np.inf)
        nearest = distance.argmin(axis=1)
        every = np.arange(count)
        better = (distance[every, nearest] < best.distance) & (distance[every, nearest] < NEAR)
        best.circuit[better] = circuit.index
        best.branch[better] = circuit.branch[nearest[better]]
        best.position[better] = (nearest + share[every, nearest])[better]
        best.distance[better] = distance[every, nearest][better]
    return best


def joint_differences(difference: Floats, turning: Booleans, size: float) -> Floats:
    """Differences of joint values (.., columns), angles to the nearest turn, slides relative to the size."""
    return np.where(turning, short_way(difference), difference / size)


def one_way(circuit: Integers, branch: Integers) -> Refusal | None:
    """Why poses (n,) on these circuits and branches are not on one pass of one circuit."""
    other = np.flatnonzero(circuit != circuit[0])
    if other.size:
        return Refusal(
            "circuit",
            f"point 1 lies on circuit {circuit[0]}, point {other[0] + 1} on circuit {circuit[other[0]]}: it "
            "must be taken apart between them",
        )
    other = np.flatnonzero(branch != branch[0])
    if other.size:
        return Refusal(
            "dead centre",
            f"point 1 lies on branch {branch[0]}, point {other[0] + 1} on branch {branch[other[0]]} of "
            f"circuit {circuit[0]}: a dead centre of the input lies between",
        )
    return None


def _in_order(circuit: Circuit, position: Floats) -> Refusal | None:
    """Why poses at places along a circuit do not follow each other; a closed pass may be entered anywhere."""
    if _rising(circuit, position) or _rising(circuit, -position):
        return None
    order = np.argsort(position, kind="stable") + 1
    passed = ", ".join(str(k) for k in order[:12]) + (" .." if len(order) > 12 else "")
    return Refusal("order", f"passes the points in the order {passed}")


def _rising(circuit: Circuit, position: Floats) -> bool:
    """Whether places go forwards along a circuit, over less than a round of it."""
    steps = np.diff(position)
    if circuit.goes_round:
        steps = _forwards(steps, len(circuit.input))
        if steps.sum() >= len(circuit.input):
            return False
    return bool((steps > -PLACE_SLACK).all())


def _forwards(steps: Floats, around: int) -> Floats:
    """Steps along a round of so many rows, each taken forwards."""
    forwards = steps % around
    return np.where(forwards > around - PLACE_SLACK, forwards - around, forwards)


def used_transmission(linkage: Linkage, circuit: Circuit, inputs: Floats, position: Floats) -> float | None:
    """The least transmission angle [rad] over the used part of a pass.

    Of an RSSR given by its dimensions the least sample within the range is followed to where the angle is
    least. Of another loop the circuit's own least counts where it is used, else the least on many rows.
    """
    if circuit.transmission is None:
        return None
    if linkage.form != "rssr" or circuit.input_column != 0:
        return _used_of_rows(linkage, circuit, inputs, position)
    ends = inputs[0] + np.array([0.0, _travel(circuit, inputs, position)])
    used = np.linspace(ends.min(), ends.max(), RANGE_SAMPLES)
    row = row_of(linkage.dimensions)[None]
    place = int(transmissions(row, used)[0].argmin())
    low, high = used[max(place - 1, 0)], used[min(place + 1, RANGE_SAMPLES - 1)]
    # the end of a range, or a place between two samples where the slope changes its sign
    for _ in range(MOST_HALVINGS):
        middle = (low + high) / 2
        falls = transmission_slopes(row, np.array([middle]))[1][0, 0] < 0
        low, high = (middle, high) if falls else (low, middle)
    least = transmissions(row, np.array([used[place], low, high]))[0].min()
    return math.asin(math.sqrt(min(max(float(least), 0.0), 1.0)))


def _used_of_rows(linkage: Linkage, circuit: Circuit, inputs: Floats, position: Floats) -> float | None:
    """The least angle [rad] over the used part of a pass, on rows of it."""
    extremes = circuit.transmission
    assert extremes is not None
    low, high = np.sort(inputs[0] + np.array([0.0, _travel(circuit, inputs, position)]))
    whole = math.tau * max(circuit.turns, 1)
    past = (extremes.lowest_at - low) % whole if circuit.goes_round else extremes.lowest_at - low
    if 0 <= past <= high - low:
        return extremes.lowest
    column = linkage.columns[circuit.input_column], linkage.columns[circuit.output_column]
    rows = np.arange(len(circuit.q))
    first = int(rows[np.abs(rows - position[0]).argmin()])
    least = math.inf
    for _ in range(CLOSER):
        used = np.linspace(low, high, RANGE_SAMPLES)
        law = Law.of(np.arange(float(RANGE_SAMPLES)), used, 1.0, 0.0)
        try:
            result = linkage.circuit(circuit.q[first], input=column[0], output=column[1], law=law)
        except RequestError:
            return extremes.lowest
        angle = result.transmission_angle
        on = result.branch == circuit.branch[first]
        if angle is None or int(on.sum()) != RANGE_SAMPLES or not np.isfinite(angle[on]).any():
            return extremes.lowest
        place = int(np.nanargmin(angle[on]))
        least = min(least, float(angle[on][place]))
        low, high = used[max(place - 1, 0)], used[min(place + 1, RANGE_SAMPLES - 1)]
    return least


def _travel(circuit: Circuit, inputs: Floats, position: Floats) -> float:
    """How far the input turns from the first pose to the last [rad], against its sense where negative."""
    if not circuit.goes_round:
        rough = float(np.diff(np.interp(position[[0, -1]], np.arange(len(circuit.input)), circuit.input))[0])
    else:
        rows = len(circuit.input)
        steps = _forwards(np.diff(position), rows)
        travelled = steps.sum() if steps.sum() < rows else -_forwards(-np.diff(position), rows).sum()
        rough = float(travelled * math.tau * circuit.turns / rows)
    # rows say which turn, the inputs themselves the rest
    last = float(inputs[-1] - inputs[0])
    return last + math.tau * round((rough - last) / math.tau)


def within_limits(result: Candidate, limits: Limits) -> Candidate | Refusal:
    """A design that keeps the limits, or which it misses."""
    lowest = result.transmission_lowest
    if lowest is not None and lowest < limits.transmission_lowest - LIMIT_ROUNDING:
        angle, wanted = math.degrees(lowest), math.degrees(limits.transmission_lowest)
        return Refusal(
            "transmission", f"transmission angle down to {angle:.4g} deg, {wanted:g} deg are required"
        )
    if fault := size_fault(result.draft, limits):
        return fault
    if limits.motion_type is not None and result.motion_type != limits.motion_type:
        return Refusal("motion type", f"is a {result.motion_type}, required is a {limits.motion_type}")
    return result


def size_fault(draft: Draft, limits: Limits) -> Refusal | None:
    """Which length a description has that is shorter or longer than the limits let it be, if any."""
    if limits.size is None:
        return None
    low, high = limits.size
    lengths = [d for d in draft.dimensions if d.kind == "length"]
    shortest = min((d.value for d in lengths if d.positive), default=math.inf)
    longest = max(abs(d.value) for d in lengths)
    if shortest >= low * (1 - LIMIT_ROUNDING) and longest <= high * (1 + LIMIT_ROUNDING):
        return None
    return Refusal(
        "size",
        f"shortest link {shortest:.4g}, longest dimension {longest:.4g}; {low:g} to {high:g} are allowed",
    )


def least_error(kept: Sequence[Candidate]) -> str:
    """The least greatest error of designs in words, for a search on its way; empty where there is none."""
    best = min(kept, key=lambda candidate: candidate.error_greatest, default=None)
    if best is None:
        return ""
    unit = best.claim.error_unit
    value = math.degrees(best.error_greatest) if unit == "deg" else best.error_greatest
    return f"best: error {value:.3g} {unit}"


def transmits_best(kept: Sequence[Candidate]) -> str:
    """The greatest least transmission angle of designs in words; empty where there is none."""
    best = max((candidate.transmission_lowest or 0.0 for candidate in kept), default=None)
    return "" if best is None else f"best: transmission angle {math.degrees(best):.3g} deg"


def tally(refusals: Iterable[Refusal], code: str | None = "en") -> str:
    """What was refused, the commonest first: "12 by transmission, 3 by order".

    In a language by its code, or with `None` in the one that is spoken.
    """
    counts = Counter(refusal.fault for refusal in refusals)
    with language(code):
        return say(", ").join(
            say("{count} by {fault}", count=count, fault=say(fault)) for fault, count in counts.most_common()
        )


def likeness(draft: Draft, *, scale_free: bool, mirrored: bool = False) -> Floats:
    """The dimensions in which designs are compared, lengths relative to the longest, angles [rad].

    `scale_free` where only ratios of the lengths matter; else the longest enters by itself as a logarithm.
    `mirrored` where signs do not matter, as a mirror image does the same.
    """
    dimensions = [d for d in draft.dimensions if d.kind != "speed"]
    values = np.array([d.value * d.scale for d in dimensions])
    lengths = np.array([d.kind in ("length", "pitch") for d in dimensions])
    longest = np.abs(values[lengths]).max(initial=0.0) or 1.0
    values[lengths] /= longest
    if mirrored:
        values = np.abs(values)
    return values if scale_free else np.append(values, math.log(longest))


def distinct(designs: Iterable[T], *, scale_free: bool, mirrored: bool = False) -> list[T]:
    """The designs that differ, the first of those that are alike by `likeness`."""
    selected: list[T] = []
    seen: list[Floats] = []
    for design in designs:
        own = likeness(design.draft, scale_free=scale_free, mirrored=mirrored)
        if all(len(own) != len(other) or np.abs(own - other).max() > SAME for other in seen):
            selected.append(design)
            seen.append(own)
    return selected


def renamed(designs: Iterable[T], title: str, word: str = "design") -> list[T]:
    """The designs with the names `title, design 1`, .. in their order."""
    return [
        one.drafted(one.draft.with_value(("name",), f"{title}, {word} {i}"))
        for i, one in enumerate(designs, 1)
    ]


@text_of.register(Candidate)
def _(candidate: Candidate) -> str:
    known = candidate.columns.items()
    return lines(f"Candidate '{candidate.name}'", [(n, brief(v)) for n, v in known if v is not None])
