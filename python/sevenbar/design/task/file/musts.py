"""Musts of a task file as values of a task."""

from __future__ import annotations

from collections.abc import Sequence

from sevenbar.design.task.file.schema import (
    ApartMust,
    BoxMust,
    ConeMust,
    FigureMustForm,
    MostMust,
    MustForm,
    RangeMust,
)
from sevenbar.design.task.file.units import amount, figure_value, reading, reading_span
from sevenbar.design.task.task import (
    Apart,
    DwellWant,
    FigureMust,
    FigureWant,
    FunctionWant,
    InBox,
    InCone,
    InRange,
    Most,
    Must,
    Want,
    residual_unit,
)
from sevenbar.kinematics.linkage import Linkage


def must_of(form: MustForm, linkage: Linkage, wants: Sequence[Want]) -> Must:
    """The must of a table; raises `RequestError` with the key at fault."""
    match form:
        case RangeMust():
            column = linkage.column(form.joint, "joint")
            return InRange(linkage.columns[column], *reading_span("range", form.range, linkage, column))
        case ConeMust():
            return InCone(form.joint, form.angle, form.seat, form.stud)
        case BoxMust():
            return InBox(form.low, form.high, _everything(linkage) if form.names is None else form.names)
        case ApartMust():
            return Apart(form.links, form.least)
        case FigureMustForm():
            ends = [
                None if end is None else figure_value(key, end, linkage, form.name)
                for key, end in (("least", form.least), ("most", form.most))
            ]
            return FigureMust(form.name, *ends)
        case MostMust():
            return Most(form.want - 1, _most(form, linkage, wants))


def _everything(linkage: Linkage) -> tuple[str, ...]:
    """All points and joints that are not of the ground alone."""
    points = [point.name for point in linkage.points if point.link < len(linkage.joints)]
    return tuple(dict.fromkeys([*points, *(joint.name for joint in linkage.joints)]))


def _most(form: MostMust, linkage: Linkage, wants: Sequence[Want]) -> float:
    """The most of a want's residuals, relative to what they are relative to."""
    if form.want > len(wants):
        # the task is checked for it
        return 1.0
    want = wants[form.want - 1]
    unit = residual_unit(want, linkage)
    match want:
        case FunctionWant() | DwellWant():
            return reading("most", form.most, linkage, linkage.columns.index(linkage.drive.output)) / unit
        case FigureWant():
            # the task is checked for it
            return 1.0
        case _:
            return amount("most", form.most, linkage.length_unit) / unit
