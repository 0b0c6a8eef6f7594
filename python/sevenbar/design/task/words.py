"""A task in words: what is wanted, what must hold, what may change."""

from __future__ import annotations

import math

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.design.task import task as kinds
from sevenbar.design.task.task import DesignTask, Must, Want
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.loop.columns import shown_in
from sevenbar.kinematics.measures import measures_named

#: Free numbers that a line names; the others are counted.
MOST_NAMED = 12


def task_facts(task: DesignTask) -> list[tuple[str, str]]:
    """What was asked, by labels."""
    linkage = task.draft.linkage
    facts = []
    for i, want in enumerate(task.wants, 1):
        weight = "" if want.weight == 1 else f", weight {want.weight:g}"
        facts.append(("wanted" if i == 1 else "", f"{i}  {want_words(want, linkage)}{weight}"))
    for i, must in enumerate(task.musts, 1):
        facts.append(("must hold" if i == 1 else "", f"{i}  {must_words(must, linkage)}"))
    names = [one.name for one in task.free]
    more = f" and {len(names) - MOST_NAMED} more" if len(names) > MOST_NAMED else ""
    count = f"{len(names)} number{'s' * (len(names) != 1)}"
    facts.append(("free", f"{count}: {', '.join(names[:MOST_NAMED])}{more}"))
    ground = {
        "fixed": "where the description has it",
        "free": "anywhere in space",
        "free with scale": "anywhere in space, in any size",
    }
    facts.append(("ground", ground[task.placement]))
    facts.append(("limits", task.limits.text()))
    facts.append(
        ("goal", "the least " + ("squares" if task.goal == "least squares" else "greatest residual"))
    )
    return facts


def want_words(want: Want, linkage: Linkage) -> str:
    """What is wanted, in a line."""
    drive, unit = linkage.drive, linkage.length_unit
    match want:
        case kinds.FunctionWant():
            return (
                f"{drive.output} over {drive.joint}: {len(want.input)} readings, "
                f"{_ends(want.input[[0, -1]], linkage, drive.joint)} in, "
                f"{_ends(want.output[[0, -1]], linkage, drive.output)} out"
            )
        case kinds.PathWant():
            extent = float(np.ptp(want.places, axis=0).max())
            return (
                f"path of {want.point}: {len(want.places)} places, {'closed' if want.closed else 'open'}, "
                f"{extent:.4g} {unit} across{_timed(want)}"
            )
        case kinds.PoseWant():
            return f"link {want.link} in {len(want.poses)} poses, arm {want.arm:.4g} {unit}{_timed(want)}"
        case kinds.FigureWant():
            if isinstance(want.value, str):
                return f"{want.name} {want.value}"
            return f"{want.name} {want.value:g} {measure_unit(want.name, linkage)}".rstrip()
        case kinds.DwellWant():
            level = "" if want.level is None else f" at {_value(want.level, linkage, drive.output)}"
            return f"{drive.output} still{level} over {_ends(np.array(want.inputs), linkage, drive.joint)}"
        case kinds.StraightWant():
            length = "" if want.length is None else f", {want.length:g} {unit} or longer"
            return (
                f"{want.point} along a straight line over "
                f"{_ends(np.array(want.inputs), linkage, drive.joint)}{length}"
            )


def must_words(must: Must, linkage: Linkage) -> str:
    """What must hold, in a line."""
    unit = linkage.length_unit
    match must:
        case kinds.InRange():
            return f"{must.column} within {_ends(np.array([must.low, must.high]), linkage, must.column)}"
        case kinds.InCone():
            return f"{must.joint} within a cone of {math.degrees(must.angle):g} deg"
        case kinds.InBox():
            sides = ", ".join(f"{low:g}:{high:g}" for low, high in zip(must.low, must.high, strict=True))
            return f"{', '.join(must.names)} in the box {sides} {unit}"
        case kinds.Apart():
            return f"links {must.links[0]} and {must.links[1]} at least {must.least:g} {unit} apart"
        case kinds.FigureMust():
            ends = [(">=", must.least), ("<=", must.most)]
            own = measure_unit(must.name, linkage)
            each = [f"{sign} {end:g} {own}".rstrip() for sign, end in ends if end is not None]
            return f"{must.name} {' and '.join(each)}"
        case kinds.Most():
            return f"each residual of want {must.want + 1} at most {must.most:.3g}"


def _timed(want: kinds.PathWant | kinds.PoseWant) -> str:
    if want.timing is None:
        return ""
    return ", at given inputs" + (" from a free start" if want.phase else "")


def measure_unit(name: str, linkage: Linkage) -> str:
    """The unit in which a measure is read; empty without one."""
    (measure,) = measures_named([name])
    return measure.unit(linkage, linkage.drive.output).replace("_", " ")


def _ends(values: Floats, linkage: Linkage, column: str) -> str:
    first, last = (_value(float(v), linkage, column) for v in values)
    return f"{first.split()[0]} to {last}" if first != last else last


def _value(value: float, linkage: Linkage, column: str) -> str:
    unit, scale = shown_in(linkage, column)
    return f"{value * scale:.6g} {unit}"
