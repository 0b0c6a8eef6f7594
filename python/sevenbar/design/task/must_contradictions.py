"""What of a task's musts contradicts itself, its linkage, or its wants."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.design.task import task as kinds
from sevenbar.design.task.task import DesignTask, Must
from sevenbar.errors import RequestError, no_joint, shown, suggestion
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.loop.stops import Cone
from sevenbar.kinematics.measures import (
    EXTENT_MEASURES,
    FORCE_MEASURES,
    JOINT_EXTENTS,
    JOINT_MEASURES,
    MEASURES,
    OF_JOINTS,
    is_of_forces,
    measures_named,
)
from sevenbar.kinematics.ranges.circuit_extents import chosen

#: Messages, each with the key that it is of; "" for a whole table.
Flaws = Iterator[tuple[str, str]]

#: Relative rounding of a value that lies on the end of a range.
ROUNDING = 1e-9

#: Between which values measures lie, in the unit that they are read in.
BOUNDS = {
    "swing": (0.0, 360.0),
    "time_ratio": (1.0, math.inf),
    "transmission_lowest": (0.0, 180.0),
    "peak_torque": (0.0, math.inf),
    "rms_torque": (0.0, math.inf),
}

#: Of a range.
NOT_RISING = "its first end is not below its second one; give the lower end first"

#: Inputs of a turn that show whether a measure has a meaning.
FEW = 12


def of_must(task: DesignTask, must: Must) -> Flaws:
    """What is wrong with a must."""
    yield from _FLAWS[type(must)](task, must)


def not_positive(key: str, value: float, what: str, give: str = "a number") -> Flaws:
    """That a value is none of what must be greater than 0."""
    if not (math.isfinite(value) and value > 0):
        yield key, f"{value:g} is no {what}; give {give} > 0"


def figure_flaw(linkage: Linkage, name: str) -> str:
    """Why a measure cannot be wanted; empty for one that can."""
    try:
        (measure,) = measures_named([name])
    except RequestError:
        numbers = [n for n, m in MEASURES.items() if m.quantity != "word"]
        known = [*numbers, *FORCE_MEASURES, *EXTENT_MEASURES, *(f"{kind}:JOINT" for kind in OF_JOINTS)]
        return f"{shown(name)} is not a measure; {suggestion(name, known)}give one of {', '.join(known)}"
    if measure.quantity == "word":
        return f"'{name}' is a word, not a number; give limits.motion_type"
    kind, _, joint = name.partition(":")
    names = [known.name for known in linkage.joints]
    if kind in JOINT_MEASURES and joint not in names:
        return no_joint(joint, names)
    if is_of_forces(name) and linkage.loading.is_empty:
        return "nothing acts on the linkage: no body, load or spring; write them into its file"
    if (
        name.startswith("transmission")
        and linkage.form != "rssr"
        and all(circuit.transmission is None for circuit in linkage.motion(FEW).circuits)
    ):
        return "this linkage has no transmission angle; leave it out"
    if kind in JOINT_EXTENTS:
        for circuit in linkage.motion(FEW).circuits[:1]:
            try:
                measure.value(circuit)
            except RequestError as error:
                return str(error).removeprefix("measure: ")
    return ""


def value_flaw(linkage: Linkage, name: str, value: float, key: str = "value") -> str:
    """Why a measure never has a value, as wanted, or as the `least` or the `most`; empty where it may."""
    low, high = BOUNDS.get(name, (-math.inf, math.inf))
    if name == "swing" and linkage.kind not in ("RSSR", "RRRR"):
        # the output of a longer loop may rock by more than a turn, and a slide by any length
        high = math.inf
    if value < low and key != "least":
        return f"{value:g} cannot be: {name} is never below {low:g}; give another value"
    if value > high and key != "most":
        return f"{value:g} cannot be: {name} is never above {high:g}; give another value"
    return ""


def _range(task: DesignTask, must: kinds.InRange) -> Flaws:
    linkage = task.draft.linkage
    try:
        column = linkage.column(must.column, "joint")
    except RequestError as error:
        yield "joint", str(error).removeprefix("joint: ")
        return
    if not must.low < must.high:
        yield "range", NOT_RISING
        return
    drive = (linkage.drive.joint, linkage.drive.output)
    name = linkage.columns[column]
    # angles may be a turn further
    turn = math.tau if linkage.turns(column) else 0.0
    for i, want in enumerate(task.wants):
        if not isinstance(want, kinds.FunctionWant) or name not in drive:
            continue
        which = drive.index(name)
        zero = want.zeros[which]
        if zero is not None and _beyond(zero + (want.input, want.output)[which], must.low, must.high, turn):
            yield "range", f"want {i + 1} needs {name} outside it; widen it, or want less"
    before = task.musts[: task.musts.index(must)]
    for i, other in enumerate(before):
        if isinstance(other, kinds.InRange) and other.column == must.column:
            one, own = np.array([other.low]), np.array([must.low])
            if _beyond(one, must.low, must.high, turn) and _beyond(own, other.low, other.high, turn):
                yield "range", f"has nothing in common with that of must {i + 1}; widen one of the two"


def _beyond(values: Floats, low: float, high: float, turn: float) -> bool:
    """Whether any of values (n,) is outside a range, wherever whole turns bring it."""
    if turn:
        values = values + turn * np.ceil((low - values) / turn - ROUNDING)
    slack = ROUNDING * max(abs(low), abs(high), 1.0)
    return bool(((values < low - slack) | (values > high + slack)).any())


def _cone(task: DesignTask, must: kinds.InCone) -> Flaws:
    try:
        chosen(task.draft.linkage, must.joint, Cone(must.angle, must.seat, must.stud))
    except RequestError as error:
        key, _, message = str(error).partition(": ")
        yield {"cone": "angle"}.get(key, key), message


def _box(task: DesignTask, must: kinds.InBox) -> Flaws:
    linkage = task.draft.linkage
    for axis, low, high in zip("xyz", must.low, must.high, strict=True):
        if not low < high:
            yield "low", f"empty along {axis}: {low:g} is not below {high:g}; give the lower corner in low"
    known = [*(p.name for p in linkage.points), *(j.name for j in linkage.joints)]
    if not must.names:
        yield "names", f"none given; give some of {', '.join(known)}"
    for name in must.names:
        if name not in known:
            yield (
                "names",
                f"no point or joint {shown(name)}; {suggestion(name, known)}"
                f"this linkage has {', '.join(known)}",
            )
    for i, want in enumerate(task.wants):
        if isinstance(want, kinds.PathWant) and want.point in must.names and task.placement == "fixed":
            out = ((want.places < must.low) | (want.places > must.high)).any(axis=1)
            if out.any():
                place = int(np.flatnonzero(out)[0]) + 1
                yield "names", f"place {place} of want {i + 1} lies outside the box; widen it, or want less"


def _apart(task: DesignTask, must: kinds.Apart) -> Flaws:
    graph = task.draft.linkage.graph
    first, second = must.links
    outside = [link for link in must.links if link not in graph.links]
    if outside:
        yield "links", f"{outside[0]} is not a link; give 1 to {graph.ground}, the last is the ground"
    elif first == second:
        yield "links", f"{first} is named twice; give two links"
    elif second in graph.neighbours(first):
        yield "links", f"{first} and {second} meet in a joint, so their distance is 0; give links that do not"
    yield from not_positive("least", must.least, "distance", "a length")


def _figure(task: DesignTask, must: kinds.FigureMust) -> Flaws:
    if flaw := figure_flaw(task.draft.linkage, must.name):
        yield "name", flaw
        return
    least, most = _ends(must)
    if must.least is None and must.most is None:
        yield "", "has no end; give least, most, or both"
    elif not least <= most:
        yield "least", f"{least:g} is above the most, {most:g}; give the lower end in least"
    for key, end in (("least", must.least), ("most", must.most)):
        if end is not None and (flaw := value_flaw(task.draft.linkage, must.name, end, key)):
            yield key, flaw
    for i, other in enumerate(task.musts[: task.musts.index(must)]):
        if isinstance(other, kinds.FigureMust) and other.name == must.name:
            low, high = _ends(other)
            if max(least, low) > min(most, high):
                yield "name", f"must {i + 1} wants {must.name} outside these ends; leave one out, or widen it"
    for i, want in enumerate(task.wants):
        if not isinstance(want, kinds.FigureWant) or want.name != must.name or isinstance(want.value, str):
            continue
        if not least <= want.value <= most:
            yield "name", f"want {i + 1} wants it outside these ends; widen them, or want another value"


def _ends(must: kinds.FigureMust) -> tuple[float, float]:
    return (
        -math.inf if must.least is None else must.least,
        math.inf if must.most is None else must.most,
    )


def _most(task: DesignTask, must: kinds.Most) -> Flaws:
    count = len(task.wants)
    if not 0 <= must.want < count:
        yield "want", f"{must.want + 1} is not a want; give its place, 1 to {count}"
    elif isinstance(task.wants[must.want], kinds.FigureWant):
        yield "want", "is a figure; bound it by a must with kind = 'figure', least and most"
    yield from not_positive("most", must.most, "bound")


_FLAWS: Mapping[type, Callable[[DesignTask, Any], Flaws]] = {
    kinds.InRange: _range,
    kinds.InCone: _cone,
    kinds.InBox: _box,
    kinds.Apart: _apart,
    kinds.FigureMust: _figure,
    kinds.Most: _most,
}
