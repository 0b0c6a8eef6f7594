"""What of a task contradicts itself or its linkage, found before the long work begins."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from typing import Any

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.design.idle_link import refuse_idle_link
from sevenbar.design.task import task as kinds
from sevenbar.design.task.loop import TaskLoop
from sevenbar.design.task.must_contradictions import (
    NOT_RISING,
    Flaws,
    figure_flaw,
    not_positive,
    of_must,
    value_flaw,
)
from sevenbar.design.task.musts import places_in
from sevenbar.design.task.task import DesignTask, Want
from sevenbar.design.task.transmitting import transmission_flaw
from sevenbar.design.task.wanted_path import turning_back, wanted_inputs, wanted_places
from sevenbar.errors import NotCoveredError, Problem, RequestError, shown, suggestion
from sevenbar.kinematics.circuits.circuit import Circuit
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.loop.rigid import flaw_of_rotation
from sevenbar.kinematics.measures import is_of_forces
from sevenbar.kinematics.paths.circuit_path import NotFollowedError
from sevenbar.kinematics.ranges.ball_angle import ball_angle
from sevenbar.reporting.shown import Shown

#: The most that residuals are where points are to be met exactly.
EXACT = 1e-6

#: Inputs of a turn at which numbers that open the loop show.
OPENINGS = 12

#: A place whose slopes are all below this part of the size stands still.
STILL = 1e-12

#: How far an input may be beyond a stop by rounding [rad, or share of the size].
ON_STOP = 1e-9

#: Fewest samples of a dwell or a straight way.
FEWEST_SAMPLES = 3


def refuse_contradictions(task: DesignTask) -> None:
    """Raises `RequestError` with every contradiction of a task, a line each."""
    if found := list(contradictions(task)) or list(start_flaws(task)):
        raise RequestError("\n".join(map(str, found)))


def contradictions(task: DesignTask) -> Iterator[Problem]:
    """What is wrong with a task, as people may put it right: "want[1].point", and the message."""
    yield from _free(task)
    if not task.wants:
        yield Problem("want", "none given; say what is wanted, as in [[want]] with kind = 'path'")
    found = [("want", i, _of_want(task, want)) for i, want in enumerate(task.wants, 1)]
    found += [("must", i, of_must(task, must)) for i, must in enumerate(task.musts, 1)]
    for table, number, flaws in found:
        for key, message in flaws:
            yield Problem(f"{table}[{number}]{key and '.' + key}", message)
    about_poses = [i for i, must in enumerate(task.musts) if isinstance(must, kinds.PoseMust)]
    if task.wants and about_poses and not task.sampled:
        yield Problem(
            f"must[{about_poses[0] + 1}]",
            "is about poses, and measures alone are wanted; bound a measure of the whole circuit, as "
            "range:JOINT, ball_angle:JOINT or clearance, by a must with kind = 'figure'",
        )
    places = [want for want in task.wants if isinstance(want, (kinds.PathWant, kinds.PoseWant))]
    if task.placement != "fixed" and task.wants and not places:
        yield Problem(
            "placement", f"{task.placement!r} changes nothing: no path and no poses are wanted; leave it out"
        )
    boxes = [i for i, must in enumerate(task.musts) if isinstance(must, kinds.InBox)]
    if task.placement != "fixed" and boxes:
        yield Problem(
            f"must[{boxes[0] + 1}]",
            f"a box stands in space, and with placement {task.placement!r} the linkage may stand anywhere; "
            "leave one of the two out",
        )
    if flaw := transmission_flaw(task.draft.linkage, task.limits):
        yield Problem("limits.transmission", flaw)


def start_flaws(task: DesignTask) -> Iterator[Problem]:
    """What is wrong with a task's linkage as a start: it moves nowhere, or a free number opens its loop.

    For a task without other contradictions, since its linkage is moved.
    """
    loop = TaskLoop(task.draft.holding(task.follow), task.names)
    circuits = loop.linkage.motion(OPENINGS).circuits
    for i, must in enumerate(task.musts):
        if isinstance(must, kinds.InCone):
            yield from _far_side(f"must[{i + 1}]", must, loop.linkage, circuits)
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
    yield from _outside(task, loop, q)
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


def _outside(task: DesignTask, loop: TaskLoop, q: Floats) -> Iterator[Problem]:
    """Points and joints that nothing moves, outside of the box in which they are to stay."""
    for i, must in enumerate(task.musts):
        if not isinstance(must, kinds.InBox):
            continue
        numbers = places_in(loop, must)
        here = loop.here(loop.start, q)
        for name, number in zip(must.names, numbers, strict=True):
            place = here.points[0, number]
            by = here.points_by[:, number] * [*loop.scales, loop.units[loop.input]]
            out = (place < must.low) | (place > must.high)
            if out.any() and np.abs(by).max() < STILL * loop.size:
                at = ", ".join(f"{x + 0.0:.6g}" for x in place)
                yield Problem(
                    f"must[{i + 1}].names",
                    f"{name} stands still at ({at}), outside the box; leave it out, or give a wider box",
                )


def _far_side(
    place: str, must: kinds.InCone, linkage: Linkage, circuits: Sequence[Circuit]
) -> Iterator[Problem]:
    """That a direction was left out of a cone and its rod is on the far side of the joint all along."""
    bend = ball_angle(linkage, must.joint, must.seat, must.stud)
    bends = [bend.at(circuit.q)[np.isfinite(circuit.q[:, bend.own]).all(axis=1)] for circuit in circuits]
    found = np.concatenate([np.empty(0), *bends])
    if None not in (must.seat, must.stud) or not found.size or not found.min() > math.pi / 2 > must.angle:
        return
    key = "seat" if must.seat is None else "stud"
    least, most = np.degrees([found.min(), found.max()])
    hint = "the direction in which it is mounted"
    with suppress(NotFollowedError):
        cone = circuits[0].ball_cone(must.joint, seat=must.seat, stud=must.stud)
        hint = f"{cone.middle_of} = {[round(x, 4) for x in cone.middle]}, the middle of its bends, or another"
    yield Problem(
        f"{place}.{key}",
        f"left out, it goes along the rod, from which {must.joint} is {least:.4g} to {most:.4g} deg off "
        f"at the start; give {hint}",
    )


def _free(task: DesignTask) -> Iterator[Problem]:
    """What is wrong with the free numbers."""
    if not task.free:
        names = ", ".join(d.name for d in task.draft.dimensions if d.kind != "speed")
        yield Problem("free", f"no number may change; give bounds of some of {names}")
    used = {want.point for want in task.wants if isinstance(want, kinds.PathWant | kinds.StraightWant)}
    used |= {name for must in task.musts if isinstance(must, kinds.InBox) for name in must.names}
    measures = (
        one for one in (*task.wants, *task.musts) if isinstance(one, kinds.FigureWant | kinds.FigureMust)
    )
    of_forces = any(is_of_forces(one.name) for one in measures)
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


def _of_want(task: DesignTask, want: Want) -> Flaws:
    yield from not_positive("weight", want.weight, "weight")
    yield from _FLAWS[type(want)](task, want)


def _stops(task: DesignTask) -> Iterator[Problem]:
    """Stops of the linkage's file that neither the inputs of the wants nor a must of a range hold."""
    linkage = task.draft.linkage
    held = {must.column for must in task.musts if isinstance(must, kinds.InRange)}
    for column, ends in linkage.stops.ranges.items():
        if column in held or not task.wants:
            continue
        show = Shown(linkage.unit_of(column))
        between = f"{show(ends[0])} to {show(ends[1])}"
        known = [_inputs_of(want) if column == linkage.drive.joint else None for want in task.wants]
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


def _inputs_of(want: Want) -> tuple[float, float] | None:
    """The least and the greatest input of a want; `None` where the search has to find them."""
    match want:
        case kinds.DwellWant() | kinds.StraightWant():
            return min(want.inputs), max(want.inputs)
        case kinds.FunctionWant(zeros=(float(zero), _)):
            return float(want.input.min()) + zero, float(want.input.max()) + zero
        case kinds.PathWant() | kinds.PoseWant() if want.timing is not None and not want.phase:
            return float(np.min(want.timing)), float(np.max(want.timing))
    return None


def _function(task: DesignTask, want: kinds.FunctionWant) -> Flaws:
    linkage = task.draft.linkage
    x, y = want.input, want.output
    if x.ndim != 1 or x.shape != y.shape or x.size < 2 or not np.isfinite([x, y]).all():
        yield "", f"{x.size} inputs and {y.size} outputs; give two finite pairs or more"
        return
    yield from _going_one_way(x, "", "input")
    if linkage.turns(linkage.drive.joint) and np.ptp(x) > math.tau * (1 + 1e-12):
        yield "", f"the inputs go over {math.degrees(float(np.ptp(x))):g} deg; give a turn at most"
    free = sum(zero is None for zero in want.zeros)
    yield from _too_many(task, want, x.size, free)


def _path(task: DesignTask, want: kinds.PathWant) -> Flaws:
    yield from _point(task.draft.linkage, want.point)
    rows = np.concatenate([want.places, want.places[:1]]) if want.closed else want.places
    try:
        wanted_places(rows)
        wanted_inputs(want.timing, rows, want.closed)
    except RequestError as error:
        key, _, message = str(error).partition(": ")
        yield {"points": "places"}.get(key, key), message
        return
    yield from _phase(want)
    count = len(want.places) * (1 if want.timing is None else 2)
    yield from _too_many(task, want, count, _placing(task) + want.phase)


def _poses(task: DesignTask, want: kinds.PoseWant) -> Flaws:
    linkage = task.draft.linkage
    ground = linkage.graph.ground
    if want.link not in linkage.graph.moving:
        yield "link", f"{want.link} is no moving link; give 1 to {ground - 1}, link {ground} is the ground"
        return
    yield from _idle(linkage, want.link, "a pose of it")
    yield from not_positive("arm", want.arm, "length")
    poses = want.poses
    if not poses.size:
        yield "poses", "none given; give tables of at, axis and angle, as in { at = [0, 0, 0], angle = 30 }"
        return
    if poses.ndim != 3 or poses.shape[1:] != (4, 4) or not len(poses) or not np.isfinite(poses).all():
        yield "poses", f"an array of shape {poses.shape} holds no poses; give finite ones (n, 4, 4)"
        return
    for i, pose in enumerate(poses):
        if flaw := flaw_of_rotation(pose[:3, :3]):
            yield f"poses[{i + 1}]", flaw
    if want.timing is not None:
        if want.timing.size != len(poses):
            yield "timing", f"{want.timing.size} inputs for {len(poses)} poses; give one for each"
        else:
            yield from _going_one_way(want.timing, "timing", "input of pose")
    yield from _phase(want)
    count = len(poses) * (2 if want.timing is None else 3)
    yield from _too_many(task, want, count, _placing(task) + want.phase)


def _phase(want: kinds.PathWant | kinds.PoseWant) -> Flaws:
    if want.phase and want.timing is None:
        yield "phase", "there are no inputs whose start could be free; give timing, too"


def _figure(task: DesignTask, want: kinds.FigureWant) -> Flaws:
    flaw = figure_flaw(task.draft.linkage, want.name)
    if flaw:
        yield "name", flaw
        return
    yield from not_positive("unit", want.unit, "unit")
    if isinstance(want.value, str):
        if want.value not in ("small", "great"):
            what = "is neither a number nor 'small' nor 'great'; give one of them"
            yield "value", f"{shown(want.value)} {what}"
    elif not math.isfinite(want.value):
        yield "value", f"{want.value} is no value; give a finite number"
    else:
        if flaw := value_flaw(task.draft.linkage, want.name, float(want.value)):
            yield "value", flaw
    for i, other in enumerate(task.wants[: task.wants.index(want)]):
        if isinstance(other, kinds.FigureWant) and other.name == want.name and other.value != want.value:
            yield "name", f"want {i + 1} wants {want.name}, too, and another value; leave one out"


def _straight(task: DesignTask, want: kinds.StraightWant) -> Flaws:
    yield from _point(task.draft.linkage, want.point)
    yield from _range(task, want)
    if want.length is not None:
        yield from not_positive("length", want.length, "length")


def _range(task: DesignTask, want: kinds.DwellWant | kinds.StraightWant) -> Flaws:
    linkage, (low, high) = task.draft.linkage, want.inputs
    if want.samples < FEWEST_SAMPLES:
        yield "samples", f"{want.samples} are too few; give {FEWEST_SAMPLES} or more"
    if not (math.isfinite(low) and math.isfinite(high) and low < high):
        yield "range", NOT_RISING
    elif linkage.turns(linkage.drive.joint) and high - low > math.tau * (1 + 1e-12):
        yield "range", f"goes over {math.degrees(high - low):g} deg of the input; give a turn at most"


_FLAWS: Mapping[type, Callable[[DesignTask, Any], Flaws]] = {
    kinds.FunctionWant: _function,
    kinds.PathWant: _path,
    kinds.PoseWant: _poses,
    kinds.FigureWant: _figure,
    kinds.DwellWant: _range,
    kinds.StraightWant: _straight,
}


def _point(linkage: Linkage, name: str) -> Flaws:
    known = {point.name: point.link for point in linkage.points}
    moving = [point for point, link in known.items() if link in linkage.graph.moving]
    if name not in known:
        has = (
            f"this linkage has {', '.join(moving)}" if moving else "the linkage names none, so add one to it"
        )
        yield "point", f"no point {shown(name)}; {suggestion(name, known)}{has}"
    elif known[name] == linkage.graph.ground:
        yield "point", f"'{name}' is on the ground, which stands still; give one of {', '.join(moving)}"
    else:
        for key, message in _idle(linkage, known[name], "a path on it"):
            yield "point" if key == "link" else key, message


def _idle(linkage: Linkage, link: int, what: str) -> Flaws:
    try:
        refuse_idle_link(linkage, link, what)
    except NotCoveredError as error:
        yield "link", str(error).partition(": ")[2]


def _going_one_way(values: Floats, key: str, what: str) -> Flaws:
    if number := turning_back(values):
        yield key, f"the {what} {number} turns back; inputs must rise, or fall, from one to the next"


def _placing(task: DesignTask) -> int:
    return {"fixed": 0, "free": 6, "free with scale": 7}[task.placement]


def _too_many(task: DesignTask, want: Want, conditions: int, own: int) -> Flaws:
    """More that must be met exactly than numbers could meet; `own` are the want's own free numbers."""
    place = [other is want for other in task.wants].index(True)
    mosts = [must for must in task.musts if isinstance(must, kinds.Most)]
    if not any(must.want == place and must.most <= EXACT for must in mosts):
        return
    count = len(task.free) + own
    if conditions > count:
        yield (
            "exact",
            f"{conditions} conditions are to be met exactly, and {count} numbers are free; leave points out, "
            "free more numbers, or leave exact out",
        )
