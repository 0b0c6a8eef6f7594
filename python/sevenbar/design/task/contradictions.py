"""What of a task contradicts itself or its linkage, found before the long work begins."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.design.task.flaws import Flaws, not_positive
from sevenbar.design.task.loop import TaskLoop
from sevenbar.design.task.task import DesignTask, PoseMust, SampledWant
from sevenbar.design.task.transmitting import transmission_flaw
from sevenbar.errors import Problem, RequestError, shown
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.measures import is_of_forces
from sevenbar.reporting.shown import Shown

#: Inputs of a turn at which numbers that open the loop show.
OPENINGS = 12

#: How far an input may be beyond a stop by rounding [rad, or share of the size].
ON_STOP = 1e-9


def refuse_contradictions(task: DesignTask) -> None:
    """Raises `RequestError` with every contradiction of a task, a line each."""
    if result := list(contradictions(task)) or list(start_flaws(task)):
        raise RequestError("\n".join(map(str, result)))


def contradictions(task: DesignTask) -> Iterator[Problem]:
    """What is wrong with a task, as people may put it right: "want[1].point", and the message."""
    yield from _free(task)
    if not task.wants:
        yield Problem("want", "none given; say what is wanted, as in [[want]] with kind = 'path'")
    for number, want in enumerate(task.wants, 1):
        yield from _problems(f"want[{number}]", not_positive("weight", want.weight, "weight"))
        yield from _problems(f"want[{number}]", want.flaws(task))
    for number, must in enumerate(task.musts, 1):
        yield from _problems(f"must[{number}]", must.flaws(task))
    about_poses = [i for i, must in enumerate(task.musts) if isinstance(must, PoseMust)]
    if task.wants and about_poses and not task.sampled:
        yield Problem(
            f"must[{about_poses[0] + 1}]",
            "is about poses, and measures alone are wanted; bound a measure of the whole circuit, as "
            "range:JOINT, ball_angle:JOINT or clearance, by a must with kind = 'figure'",
        )
    placeable = any(want.placeable for _, want in task.sampled)
    if task.placement != "fixed" and task.wants and not placeable:
        yield Problem(
            "placement", f"{task.placement!r} changes nothing: no path and no poses are wanted; leave it out"
        )
    tables = (("want", task.wants), ("must", task.musts))
    in_space = [
        (f"{table}[{number}]", one.in_space)
        for table, every in tables
        for number, one in enumerate(every, 1)
        if one.in_space
    ]
    if task.placement != "fixed" and in_space:
        place, what = in_space[0]
        yield Problem(
            place,
            f"{what} stands in space, and with placement {task.placement!r} the linkage may stand anywhere; "
            "leave one of the two out",
        )
    if flaw := transmission_flaw(task.draft.linkage, task.limits):
        yield Problem("limits.transmission", flaw)


def _problems(place: str, flaws: Flaws) -> Iterator[Problem]:
    for key, message in flaws:
        yield Problem(f"{place}{key and '.' + key}", message)


def start_flaws(task: DesignTask) -> Iterator[Problem]:
    """What is wrong with a task's linkage as a start: it moves nowhere, or a free number opens its loop.

    For a task without other contradictions, since its linkage is moved.
    """
    loop = TaskLoop(task.draft.holding(task.follow), task.names)
    circuits = loop.linkage.motion(OPENINGS).circuits
    q = closed_poses(loop, circuits)
    if q is None:
        yield Problem(
            "linkage",
            "moves nowhere as it is described, so it cannot be a start; give dimensions with which it moves",
        )
        return
    for number in loop.openings(loop.start, q):
        yield Problem(
            f"free.{task.free[number].name}", "cannot change alone without opening the loop; leave it out"
        )
    for i, must in enumerate(task.musts, 1):
        yield from _problems(f"must[{i}]", must.start_flaws(loop, circuits, q))
    yield from _stops(task)


def closed_poses(loop: TaskLoop, circuits: Sequence[Circuit]) -> Floats | None:
    """Poses (n, columns) of the first circuit that has some; `None` where the loop moves nowhere."""
    for circuit in circuits:
        good = np.flatnonzero((circuit.status == "ok") & np.isfinite(circuit.q).all(axis=1))
        if good.size:
            q = loop.closed(loop.start, circuit.input[good], loop.poses(loop.start, circuit.q[good]))
            q = q[np.isfinite(q).all(axis=1)]
            if len(q):
                return q
    return None


def _free(task: DesignTask) -> Iterator[Problem]:
    """What is wrong with the free numbers."""
    if not task.free:
        names = ", ".join(d.name for d in task.draft.dimensions if d.kind != "speed")
        yield Problem("free", f"no number may change; give bounds of some of {names}")
    every = (*task.wants, *task.musts)
    used = {name for one in every for name in one.points}
    of_forces = any(is_of_forces(name) for one in every for name in one.measures)
    seen: set[str] = set()
    for one in task.free:
        place = f"free.{one.name}"
        try:
            d = task.draft.dimension(one.name)
        except RequestError as error:
            yield Problem(place, str(error).removeprefix("dimension: "))
            continue
        low, high = one.low, one.high
        if d.name in seen:
            yield Problem(place, "is given twice; leave one out")
        seen.add(d.name)
        if d.kind == "speed":
            yield Problem(place, "the speed moves no joint elsewhere; leave it out")
        elif not (math.isfinite(low) and math.isfinite(high) and low < high):
            yield Problem(
                place, f"{low:g}:{high:g} are no bounds; give the least value first, then the greatest"
            )
        elif d.positive and not low > 0:
            what = "length of a link" if d.kind == "length" else d.kind
            yield Problem(place, f"{low:g} is no {what}; give bounds > 0")
        elif not low <= d.value <= high:
            unit = f" {d.unit}" if d.unit else ""
            yield Problem(
                place,
                f"begins at {d.value:g}{unit}, outside {low:g}:{high:g}; "
                "give bounds that hold it, or another start",
            )
        if d.kind == "mass" and not of_forces:
            yield Problem(
                place, "no measure of forces is wanted or must hold, so this changes nothing; leave it out"
            )
        if d.name in task.follow:
            yield Problem(place, "is to follow from the others; leave it out here, or in follow")
        # the point that it belongs to
        owner = task.draft.raw["point"][int(str(d.place[1]))]["name"] if d.place[0] == "point" else None
        if owner is not None and owner not in used:
            yield Problem(
                place, f"point '{owner}' is in no want and no must, so this changes nothing; leave it out"
            )


def _stops(task: DesignTask) -> Iterator[Problem]:
    """Stops of the linkage's file that neither the inputs of the wants nor a must of a range hold."""
    linkage = task.draft.linkage
    held = {column for must in task.musts for column in must.columns}
    for column, ends in linkage.stops.ranges.items():
        if column in held or not task.wants:
            continue
        show = Shown(linkage.unit_of(column))
        between = f"{show(ends[0])} to {show(ends[1])}"
        known = [
            want.input_range() if column == linkage.drive.joint and isinstance(want, SampledWant) else None
            for want in task.wants
        ]
        if None in known:
            yield Problem(
                "must",
                f"none holds the stop of {column}, {between}; give one with kind = 'range', joint = "
                f"{shown(column)} and this range, or a linkage without the stop",
            )
            continue
        for i, inputs in enumerate(known, 1):
            if inputs is not None and not _within(linkage, inputs, ends):
                yield Problem(
                    f"want[{i}]",
                    f"its inputs, {show(inputs[0])} to {show(inputs[1])}, go beyond a stop of {column}, "
                    f"{between}; give inputs between the stops, or move the stop",
                )


def _within(linkage: Linkage, inputs: tuple[float, float], ends: tuple[float, float]) -> bool:
    """Whether inputs are between stops of the input, by whole turns of it or not."""
    turns = linkage.turns(linkage.drive.joint)
    room = ON_STOP * (1.0 if turns else linkage.size)
    low, high = ends[0] - room, ends[1] + room
    first = math.ceil((low - inputs[0]) / math.tau) * math.tau if turns else 0.0
    return inputs[0] + first >= low and inputs[1] + first <= high
