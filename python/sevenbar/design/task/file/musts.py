"""Musts of a task file as values of a task."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sevenbar.design.task.file.schema import (
    ApartMust,
    BoxMust,
    ConeMust,
    FigureMustForm,
    MostMust,
    MustForm,
    RangeMust,
)
from sevenbar.design.task.file.units import figure_value, reading, reading_span
from sevenbar.design.task.file.values import Given
from sevenbar.design.task.task import (
    Apart,
    DwellWant,
    FigureMust,
    FunctionWant,
    InBox,
    InCone,
    InRange,
    Most,
    Must,
    PathWant,
    PoseWant,
    StraightWant,
    Want,
)
from sevenbar.errors import RequestError, shown
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.sensitivity import Numbers
from sevenbar.text.amounts import amount_in
from sevenbar.text.units import examples_of


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
    match wants[form.want - 1]:
        case FunctionWant() | DwellWant():
            column = linkage.columns.index(linkage.drive.output)
            value = reading("most", form.most, linkage, column)
            return value if linkage.turns(column) else value / linkage_size(linkage)
        case PathWant(places=places):
            return _length("most", form.most, linkage) / float(np.ptp(places, axis=0).max())
        case PoseWant(arm=arm):
            return _length("most", form.most, linkage) / arm
        case StraightWant(length=length):
            return _length("most", form.most, linkage) / (length or linkage_size(linkage))
        case _:
            return 1.0


def linkage_size(linkage: Linkage) -> float:
    """The longest dimension of a description [length], to which residuals of lengths are relative."""
    return float(Numbers(linkage).size)


def _length(key: str, value: Given, linkage: Linkage) -> float:
    unit = linkage.length_unit
    found = amount_in(value, unit) if isinstance(value, str) else value
    if found is None:
        raise RequestError(f"{key}: {shown(value)} is not a length; give {examples_of(unit)}")
    return found
