"""What must hold of every motion, whatever the linkage; each breach is a `Broken` with what was seen.

A linkage that cannot be analysed is refused with a `SevenbarError`; all else that is raised is a finding too.
"""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

import sevenbar as sb
from evidence.accuracy.reference_loops import Loop
from sevenbar.kinematics.measures import MEASURES, rows_of
from sevenbar.reporting import report
from sevenbar.reporting.summary import summary

#: Closure error of a row: radians, lengths relative to the size. Promised by the tests of circuits.
CLOSED = 1e-10

#: The same where condition numbers are past `WELL`: Newton's last step is then lost in rounding.
CLOSED_BADLY = 1e-8

#: The same where constraints are redundant: a loop is followed while they agree to 1e-9 in every node.
CLOSED_REDUNDANT = 2e-9

#: The same along a circuit through a change point, where up to four limits meet: fourth roots of roundings.
CLOSED_CHANGING = 1e-3

#: Condition up to which poses are compared, and how near [rad, parts of the size] two of them are one.
WELL, SAME = 1e4, 1e-7

#: How near a mode [rad, parts of the size] is to a row at the same input: a fourth root of rounding at
#: change points.
ON_CIRCUIT = 1e-3

#: Share of their spread by which a row may lie beyond the extremes of a rate.
BEYOND = 1e-6

#: Rates of an output at rest are rounding, relative to the greatest rate of the joints up to this order.
RESTING = 1e-14

#: How far rows may lie outside the range of their circuit, relative to it: limits may be roots of roundings.
WITHIN = 1e-6

#: Rows of a turn: enough to meet every pass, few enough for a million linkages.
SAMPLES = 24

#: Statuses of rows that have a pose, and of those whose rates are there.
POSED, RATED = ("ok", "dead-centre", "change-point"), ("ok",)

#: Words of motion types that come with circuits and without them.
WITHOUT = {"rigid", "not-followed", "two-inputs", "cannot-assemble"}
SINGLE = {"crank", "rocker", "slider", "spindle"}


class Broken(Exception):  # noqa: N818  # told as a fact, not raised as an error of the caller
    """Something that must hold and does not."""


def hold(condition: object, what: str) -> None:
    """Raises `Broken` unless the condition is true."""
    if not condition:
        raise Broken(what)


def judged(linkage: sb.Linkage, rng: np.random.Generator, seen: Counter[str]) -> str:
    """The motion type of a linkage whose whole analysis was looked at; `seen` counts what it holds."""
    mobility = linkage.mobility()
    hold(mobility.freedoms - 6 == mobility.gruebler, "Gruebler count")
    motion = linkage.motion(SAMPLES)
    of_motion(motion)
    for circuit in motion:
        of_circuit(motion, circuit)
        seen.update(f"row {word}" for word in circuit.status)
        link = int(rng.integers(1, len(linkage.joints) + 1))
        trace = circuit.point(link, (0.1, -0.2, 0.3))
        of_trace(circuit, trace)
        placed = np.isin(trace.status, POSED)
        _no_numbers_missing(circuit.link_motion(link).rotation, placed, "rotation of a link")
    if motion.circuits:
        independently_closed(linkage, motion)
        if not motion.search.unfollowed:
            circuits_are_distinct(motion)
    seen.update(f"short {words}" for words in reported_short(motion))
    seen["circuits"] += len(motion.circuits)
    seen[f"completeness {motion.completeness}"] += 1
    written_down(motion)
    column = linkage.columns.index(motion.input)
    if linkage.column_kinds[column] == "turn":
        k = 1 + 2 * int(rng.integers(SAMPLES // 2))
        modes_are_on_circuits(motion, linkage.assembly_modes(math.tau * k / SAMPLES))
    if motion.motion_type not in WITHOUT:
        at = float(rng.uniform(-np.pi, np.pi))
        modes = linkage.assembly_modes(at)
        solid = [j for j, o in enumerate(_owners(linkage)) if o != "S"]
        hold(np.isfinite(modes.q[:, solid]).all(), "a mode without a number")
        hold(np.isfinite(modes.q[modes.status == "ok"]).all(), "a mode without a number and its status ok")
        circuits_have_modes(motion, modes, at)
        seen["modes"] += len(modes)
    return motion.motion_type


def reported_short(motion: sb.Motion) -> list[str]:
    """What a result itself reports as not done; what it claims besides is judged."""
    search = motion.search
    found = {
        "modes from which no motion could be followed": search.unfollowed,
        "poses that close but for redundant constraints": search.open_by.size,
        "circuits that are not known to close": sum(not circuit.closed for circuit in motion),
        "modes found by a search": motion.completeness == "searched",
    }
    return [words for words, count in found.items() if count]


def of_motion(motion: sb.Motion) -> None:
    """Limits, change points and types agree with the circuits."""
    limits = motion.limits
    hold(np.isfinite(limits).all(), "a limit that is no number")
    hold((np.diff(limits) > 0).all(), f"limits do not rise: {limits.tolist()}")
    linkage = motion.linkage
    column = linkage.columns.index(motion.input)
    turns = linkage.column_kinds[column] == "turn"
    if turns:
        hold(((limits >= 0) & (limits < math.tau)).all(), f"limits outside a turn: {limits.tolist()}")
    hold([c.index for c in motion] == list(range(len(motion.circuits))), "circuits are not numbered")
    types = {c.motion_type for c in motion}
    kind = motion.motion_type
    if kind in WITHOUT:
        hold(not types, f"{kind} with circuits")
        return
    # an RSSR that closes at a change point only has no circuit
    hold(types or kind == "change-point", f"{kind} without a circuit")
    if kind == "mixed":
        hold(len(types) > 1, "mixed of one type")
    elif kind != "change-point":
        hold(types <= {kind, "change-point"}, f"{kind} of circuits {sorted(types)}")
    if types and "change-point" not in types | {kind}:
        back = any(c.turns_back for c in motion)
        ends = any(d.kind == "input" for c in motion for d in c.dead_centres)
        hold(
            bool(limits.size) == ends,
            f"{limits.size} limits, and circuits with{'' if ends else 'out'} dead centres",
        )
        hold(
            back or not limits.size or any(not c.closed for c in motion),
            "limits of an input that never turns back",
        )


def of_circuit(motion: sb.Motion, circuit: sb.Circuit) -> None:
    """Rows, statuses, ranges, extremes of one circuit."""
    rows = len(circuit.status)
    hold(rows > 0, "a circuit without rows")
    posed = _posed(circuit)
    rated = np.isin(circuit.status, RATED)
    _no_numbers_missing(circuit.q, rated, "joint values")
    # at a dead centre the turns of a ball may have no direction, too
    balls = [owner == "S" for owner in _owners(motion.linkage)]
    _no_numbers_missing(circuit.q[:, ~np.array(balls)], posed, "joint values outside balls")
    for name, values in (("dq", circuit.dq), ("ddq", circuit.ddq), ("dddq", circuit.dddq)):
        _no_numbers_missing(values, rated, name)
    hold(np.isfinite(circuit.time).all() and (np.diff(circuit.time) >= 0).all(), "times that do not rise")
    hold(np.isfinite(circuit.residual[posed]).all(), "a row with a pose and no residual")
    worst = (circuit.residual / circuit.size / _promised(motion, circuit))[posed].max(initial=0.0)
    hold(worst <= 1, f"a closure error {worst:.3g} times what is promised")
    word = circuit.motion_type
    if word != "change-point":
        # a word for the input and one for the output, or double- and one for both
        first, second = word.removeprefix("double-"), word.rpartition("-")[2]
        first = second if word.startswith("double-") else first.partition("-")[0]
        hold({first, second} <= SINGLE, f"motion type {word!r}")
        hold(
            (first == "crank") == (circuit.input_range is None and first != "slider"),
            f"{word} by the input's range",
        )
        hold(
            (second == "crank") == (circuit.output_range is None and second != "slider"),
            f"{word} by the output's range",
        )
    for name in ("input_range", "output_range"):
        ends = getattr(circuit, name)
        hold(ends is None or (np.isfinite(ends).all() and ends[0] <= ends[1]), f"{name} {ends}")
        if ends is not None and circuit.closed and word != "change-point":
            values = getattr(circuit, name.removesuffix("_range"))[posed]
            slack = WITHIN * (circuit.size + 1.0 + max(map(abs, ends)))
            inside = (values >= ends[0] - slack) & (values <= ends[1] + slack)
            hold(inside.all(), f"{int((~inside).sum())} rows outside the {name} {ends}")
    if circuit.input_range is None and circuit.closed and word != "change-point":
        hold(circuit.turns >= 1, "an input that turns fully, no turns")
    for d in circuit.dead_centres:
        hold(math.isfinite(d.input) and math.isfinite(d.output), f"a dead centre nowhere: {d}")
        hold(not math.isnan(d.condition), f"a dead centre without a condition: {d}")
    greatest = 0.0
    for name, column in (("velocity", circuit.dq), ("acceleration", circuit.ddq), ("jerk", circuit.dddq)):
        extremes = getattr(circuit, name)
        if extremes is None:
            continue
        greatest = max(greatest, np.abs(column[rated]).max(initial=0.0))
        hold(all(map(math.isfinite, vars(extremes).values())), f"{name}: {extremes}")
        values = column[rated, circuit.output_column]
        slack = BEYOND * (extremes.highest - extremes.lowest) + BEYOND * np.abs(values).max(initial=0.0)
        slack += RESTING * greatest
        if values.size and name != "jerk":
            hold(
                values.max() <= extremes.highest + slack,
                f"{name} {values.max()} above its extreme {extremes.highest}",
            )
            hold(
                values.min() >= extremes.lowest - slack,
                f"{name} {values.min()} below its extreme {extremes.lowest}",
            )


def of_trace(circuit: sb.Circuit, trace: sb.Trace) -> None:
    """A point has a place where its row has a pose, rates where the row has rates."""
    hold(len(trace.status) == len(circuit.status), "a trace of another length")
    posed = np.isin(trace.status, POSED)
    _no_numbers_missing(trace.position, posed, "position of a point")
    for name in ("velocity", "acceleration", "jerk"):
        _no_numbers_missing(getattr(trace, name), np.isin(trace.status, RATED), f"{name} of a point")


def independently_closed(linkage: sb.Linkage, motion: sb.Motion) -> None:
    """Rows close by a walk along the loop that shares no formula with the core."""
    loop = Loop.of(linkage)
    for circuit in motion:
        good = _posed(circuit) & np.isfinite(circuit.q).all(axis=1)
        if not good.any():
            continue
        # the walk measures gaps relative to another size
        allowed = _promised(motion, circuit)[good] * max(1.0, circuit.size / loop.size)
        worst = float((loop.errors(circuit.q[good]) / allowed).max())
        hold(
            worst <= 1, f"the walk along the loop leaves {worst:.3g} times the closure error that is promised"
        )


def circuits_are_distinct(motion: sb.Motion) -> None:
    """No well-conditioned row lies on two circuits."""
    linkage = motion.linkage
    # a ball's turns may have two names for one pose; the other joints tell all poses apart
    owners = _owners(linkage)
    turns = _columns(linkage, lambda owner, kind: owner not in "SH" and kind == "turn")
    # a whole turn takes a screw to another place
    screws = [i for i, o in enumerate(owners) if o == "H"]
    slides = _columns(linkage, lambda owner, kind: owner != "S" and kind == "slide")
    places = []
    for circuit in motion:
        good = (circuit.status == "ok") & (circuit.condition < WELL)
        q = circuit.q[good]
        parts = [np.cos(q[:, turns]), np.sin(q[:, turns]), q[:, screws], q[:, slides] / circuit.size]
        places.append(np.concatenate(parts, axis=1))
    trees = [cKDTree(place) for place in places]
    for i, one in enumerate(trees):
        for j in range(i):
            if one.n and trees[j].n:
                common = one.sparse_distance_matrix(trees[j], SAME, p=np.inf, output_type="ndarray")
                hold(not common.size, f"circuits {j} and {i} have a pose in common")


def circuits_have_modes(motion: sb.Motion, modes: sb.Modes, at: float) -> None:
    """Each well-conditioned circuit whose input turns fully has its modes at an input."""
    if motion.completeness == "searched" or motion.search.open_by.size:
        return
    turning = [c for c in motion if c.closed and c.input_range is None and np.nanmax(c.condition) < WELL]
    least = sum(circuit.turns for circuit in turning)
    hold(len(modes) >= least, f"{len(modes)} modes at {at} where {least} circuits pass")


def modes_are_on_circuits(motion: sb.Motion, modes: sb.Modes) -> None:
    """Each mode at one of the inputs of the rows is a pose of a row, or stands alone."""
    if motion.motion_type in WITHOUT or reported_short(motion):
        return
    lost = int((off_circuits(motion, modes.q) > ON_CIRCUIT).sum())
    hold(not lost, f"{lost} of {len(modes)} modes lie on no circuit")


def off_circuits(motion: sb.Motion, q: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """How far poses (n, columns) are from circuits and change points [rad, or relative to the size]."""
    turns = _columns(motion.linkage, lambda owner, kind: owner != "S" and kind == "turn")
    slides = _columns(motion.linkage, lambda owner, kind: owner != "S" and kind == "slide")
    size = motion.circuits[0].size if motion.circuits else 1.0

    def place(q: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        return np.concatenate([np.cos(q[:, turns]), np.sin(q[:, turns]), q[:, slides] / size], axis=1)

    # a row whose balls' turns are undefined has its other joints
    poses = [circuit.q[circuit.status != "no-solution"] for circuit in motion]
    poses += [np.atleast_2d(point.q) for point in motion.change_points]
    known = np.concatenate(poses) if poses else q[:0]
    if not len(known):
        return np.full(len(q), np.inf)
    return np.asarray(cKDTree(place(known)).query(place(q), p=np.inf)[0])


def written_down(motion: sb.Motion) -> None:
    """JSON without NaN, a text for people without it, and measures that are numbers or None."""
    text = report.as_json(motion)
    json.loads(text, parse_constant=_refused)
    told = summary(motion)
    words = [word for _, fact in told.facts for word in fact.split()]
    words += [word for sheet in told.sheets for row in sheet.rows for cell in row for word in cell.split()]
    strange = {"nan", "inf", "-inf", "None"} & set(words)
    hold(not strange, f"the report says {', '.join(sorted(strange))}")
    for row in rows_of(motion, tuple(MEASURES.values())):
        for name, value in row.items():
            hold(
                value is None or isinstance(value, str) or math.isfinite(value), f"measure {name} is {value}"
            )


def _refused(word: str) -> Any:
    raise Broken(f"JSON with {word}")


def _owners(linkage: sb.Linkage) -> list[str]:
    """The kind of the joint of each column."""
    return [joint.kind for joint in linkage.joints for _ in joint.columns]


def _columns(linkage: sb.Linkage, fits: Callable[[str, str], bool]) -> list[int]:
    """The columns whose joint and kind fit."""
    pairs = zip(_owners(linkage), linkage.column_kinds, strict=True)
    return [column for column, (owner, kind) in enumerate(pairs) if fits(owner, kind)]


def _promised(motion: sb.Motion, circuit: sb.Circuit) -> npt.NDArray[np.float64]:
    """The closure error (rows,) that each row may keep, radians and parts of the size."""
    if circuit.motion_type == "change-point":
        return np.full(len(circuit.status), CLOSED_CHANGING)
    if motion.redundant:
        return np.full(len(circuit.status), CLOSED_REDUNDANT)
    return np.where(circuit.condition < WELL, CLOSED, CLOSED_BADLY)


def _posed(circuit: sb.Circuit) -> npt.NDArray[np.bool_]:
    return np.isin(circuit.status, POSED)


def _no_numbers_missing(values: npt.NDArray[np.float64], rows: npt.NDArray[np.bool_], what: str) -> None:
    bad = ~np.isfinite(values[rows])
    if bad.any():
        hold(
            False, f"{what}: {int(bad.sum())} numbers missing or infinite in rows whose status promises them"
        )
