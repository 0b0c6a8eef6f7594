"""Values of a motion from what the core hands over: columns by name, times of rows."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

import sevenbar._core as _core
from sevenbar.arrays import Booleans, Floats, Integers, Words, within_turn
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.circuits.circuit_values import STATUSES, DeadCentre, Extremes, Tally, Trace
from sevenbar.kinematics.circuits.motion import ChangePoint, Motion, Solvable
from sevenbar.kinematics.circuits.search import Count, OpenRange, Search

if TYPE_CHECKING:
    from sevenbar.kinematics.loop.law import Law

_STATUS_WORDS = np.array(STATUSES)

#: Limits [rad, or relative to the size] nearer than this are one.
SAME_LIMIT = 1e-6

#: Joint values with three derivatives (4, n, columns), and status, pass, residual, condition (n,).
CoreRows = tuple[Floats, Integers, Integers, Floats, Floats]


def change_points_from(raw: _core.RawMotion, column: int, *, turns: bool = True) -> tuple[ChangePoint, ...]:
    """The change points of a motion by their input, which is the `column` and `turns` or slides."""
    points = [
        ChangePoint(values[column], np.array(values), tuple(circuits), ways, freedoms)
        for values, circuits, ways, freedoms in raw.change_points
    ]
    # just below zero by rounding is zero, not a whole turn
    return tuple(sorted(points, key=lambda point: float(within_turn(point.input)) if turns else point.input))


def search_from(raw: _core.RawSearch, columns: Sequence[str]) -> Search:
    """What a search found, with the names of the columns."""
    result, count = raw.found, raw.count
    return Search(
        completeness=raw.completeness,
        columns=tuple(columns[c] for c in raw.columns),
        values=raw.values,
        unfollowed=raw.unfollowed,
        bound=raw.bound,
        rank=None if result is None else result.rank,
        freedoms=None if result is None else result.finite,
        open_by=raw.open_by,
        count=None
        if count is None
        else Count(
            columns[count.column],
            count.dead_centres,
            count.complex_branch_points,
            count.poles,
            count.circles,
            tuple(OpenRange(*each) for each in count.open),
        ),
        uncounted=raw.uncounted,
    )


def tally_from(course: _core.Course, size: float) -> Tally:
    """What there is to say of the rows of a course; `size` is that of which residuals are parts."""
    counts = {word: count for word, count in zip(STATUSES, course.statuses, strict=True) if count}
    worst = math.nan if course.residual is None else course.residual * size
    return Tally(sum(course.statuses), dict(sorted(counts.items())), worst)


def circuit_from(
    raw: _core.RawCircuit,
    *,
    linkage: Solvable,
    index: int,
    columns: tuple[int, int],
    speed: float,
    law: Law | None,
    size: float,
    point: Callable[[Integers, Words, int, Floats], Trace],
    rows: CoreRows | None = None,
) -> Circuit:
    """A circuit as the core has it.

    `columns` are input and output, `size` that of which residuals are parts; `point` traces a point along
    rows in an order and of a status. `rows` are those of a course, where the circuit has one.
    """
    input_column, output_column = columns
    joints, statuses, branch, residual, condition = rows or (
        raw.joints, raw.status, raw.branch, raw.residual, raw.condition,
    )  # fmt: skip
    (q, dq, ddq, dddq), order = joints, np.arange(len(statuses))
    turns_back = any(kind == "input" for kind, *_ in raw.dead_centres)
    if len(order) and raw.mode is None and speed < 0 and law is None and raw.turns and not turns_back:
        order = np.append(order[:1], order[:0:-1])
        q, dq, ddq, dddq = _backwards(q, linkage.turning)[order], dq[order], ddq[order], dddq[order]
        statuses, branch = statuses[order], branch[order]
        residual, condition = residual[order], condition[order]
    status = _status_words(statuses, q)
    inputs = q[:, input_column]
    if law is None:
        velocity, acceleration, jerk = map(_extremes, (raw.velocity, raw.acceleration, raw.jerk))
    else:
        velocity, acceleration, jerk = (
            sampled_extremes(rate[:, output_column], inputs) for rate in (dq, ddq, dddq)
        )
    return Circuit(
        index=index,
        motion_type=raw.motion_type,
        closed=raw.closed,
        turns=raw.turns,
        columns=linkage.columns,
        q=q,
        dq=dq,
        ddq=ddq,
        dddq=dddq,
        time=driven_time(inputs, speed, law),
        status=status,
        branch=branch,
        mode=np.full(len(order), index) if raw.mode is None else raw.mode,
        residual=residual * size,
        condition=condition,
        dead_centres=tuple(DeadCentre(*d) for d in raw.dead_centres),
        input_range=raw.input_range,
        output_range=raw.output_range,
        _velocity=velocity,
        acceleration=acceleration,
        jerk=jerk,
        angle=_extremes(raw.angle),
        swing=raw.swing,
        time_ratio=raw.time_ratio,
        many_strokes=raw.many_strokes,
        input_column=input_column,
        output_column=output_column,
        input_turns=linkage.turns(input_column),
        output_turns=linkage.turns(output_column),
        size=size,
        speed=speed if law is None else math.nan,
        _point=partial(point, order, status),
        _frames=linkage.point_frames,
        _answers=linkage.answers,
        _transmission=_extremes(raw.transmission),
    )


def _status_words(statuses: Integers, q: Floats) -> Words:
    """The words of statuses; one word, if all are the same, is once in memory."""
    # nothing is slower than words row by row; the least of numbers of which one is none is none
    if len(q) and statuses.min() == statuses.max() and not math.isnan(q.min()):
        return np.broadcast_to(_STATUS_WORDS[statuses[0]], statuses.shape)
    status: Words = _STATUS_WORDS[statuses]
    # the pose of a row may be known where a ball's turns are not
    status[(status == "ok") & np.isnan(q).any(axis=1)] = "turns-undefined"
    return status


def _backwards(q: Floats, turns: Booleans) -> Floats:
    """The joint values of a circuit that goes round, walked with rising input, as a falling one has them."""
    # what the joints have turned when the circuit closes, which falls when it is run the other way
    ahead = 2 * q[-1] - q[-2] - q[0]
    back = q - np.where(turns, np.round(ahead / math.tau) * math.tau, 0.0)
    back[0] = q[0]
    return back


def _extremes(ends: tuple[float, float, float, float] | None) -> Extremes | None:
    return None if ends is None else Extremes(*ends)


def driven_time(inputs: Floats, speed: float, law: Law | None) -> Floats:
    """The time [s] of each row: along the input's travel, or the law's once for each pass."""
    if law is not None:
        return np.tile(law.t, len(inputs) // law.t.size)
    if inputs.size == 0:
        return np.array([])
    steps = np.abs(inputs[1:] - inputs[:-1])
    steps[np.isnan(steps)] = 0.0
    time = np.zeros(len(inputs))
    np.cumsum(steps, out=time[1:])
    return time / abs(speed)


def sampled_extremes(values: Floats, inputs: Floats) -> Extremes | None:
    """Extremes as sampled: all that a law given by samples can tell."""
    if np.isnan(values).all():
        return None
    low, high = int(np.nanargmin(values)), int(np.nanargmax(values))
    return Extremes(float(values[low]), float(inputs[low]), float(values[high]), float(inputs[high]))


def trace_from(values: Floats | None, order: Integers, status: Words, at: Floats) -> Trace:
    """A point along rows in an order and of a status: place and three derivatives `values` (4, n, 3).

    `None` for a point of the ground, which stays `at` its place.
    """
    if values is None:
        position = np.broadcast_to(at, (len(status), 3)).copy()
        position[status == "no-solution"] = np.nan
        rest = np.where(np.isnan(position), np.nan, 0.0)
        rest[status == "dead-centre"] = np.nan
        velocity, acceleration, jerk = rest, rest.copy(), rest.copy()
    else:
        position, velocity, acceleration, jerk = (np.asarray(part)[order] for part in values)
    own = np.array(status)
    own[own == "turns-undefined"] = "ok"
    return Trace(position, velocity, acceleration, jerk, own)


def motion_from(
    raw: _core.RawMotion,
    *,
    linkage: Solvable,
    columns: tuple[int, int],
    speed: float,
    samples: int,
    law: Law | None,
    circuits: tuple[Circuit, ...],
    size: float,
    redundant: tuple[str, ...],
    agree: float,
) -> Motion:
    """A motion of a search as the core has it, with its circuits; `columns` are input and output."""
    column, output = columns
    limits = [d.input for c in circuits for d in c.dead_centres if d.kind == "input"]
    assert raw.search is not None
    return Motion(
        linkage=linkage,
        input=linkage.columns[column],
        output=linkage.columns[output],
        speed=math.nan if law is not None else speed,
        samples=samples,
        motion_type=raw.motion_type,
        limits=merged(limits, turns=linkage.turns(column), size=size),
        change_points=change_points_from(raw, column, turns=linkage.turns(column)),
        circuits=circuits,
        search=search_from(raw.search, linkage.columns),
        redundant=redundant,
        law=law,
        agree=agree,
    )


def merged(limits: npt.ArrayLike, *, turns: bool, size: float) -> Floats:
    """Limits of all circuits [rad in [0, 2 pi), or length], rising, equal ones once.

    `size` [length] is that of the loop, by which slides are compared.
    """
    values: Floats = np.asarray(limits, dtype=np.float64)
    same = SAME_LIMIT if turns else SAME_LIMIT * size
    if turns:
        values = within_turn(values)
    values = np.sort(values)
    if values.size == 0:
        return np.array([])
    selected: Floats = values[np.concatenate([[True], np.diff(values) > same])]
    if turns and selected.size > 1 and selected[0] + math.tau - selected[-1] < same:
        selected = selected[:-1]
    return selected
