"""The tables of a task file as values of a task: what is wanted, and what must hold."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Literal, TypeVar, cast

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.description.named_files import file_below
from sevenbar.design.curve_table import read_curve, read_poses
from sevenbar.design.task import task as kinds
from sevenbar.design.task.file import schema
from sevenbar.design.task.file.units import amount, figure_value, reading, reading_span
from sevenbar.design.task.file.values import Given
from sevenbar.design.task.task import Must, Want, linkage_size, residual_unit
from sevenbar.design.task.wanted_path import wanted_inputs, wanted_places
from sevenbar.design.wish import chebyshev, read_pairs, wish_of_function
from sevenbar.errors import RequestError, TableError
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.loop.rigid import inverse, pose, turns_about, unit
from sevenbar.text.expression import function_of

T = TypeVar("T")

#: What a figure may be wanted to be, other than a value.
Way = Literal["small", "great"]


def want_of(form: schema.WantForm, linkage: Linkage, folder: Path) -> Want:
    """The want of a table; files lie in `folder`. Raises `RequestError` with the key at fault."""
    match form:
        case schema.FunctionForm():
            return _function(form, linkage, folder)
        case schema.PathForm():
            return _path(form, linkage, folder)
        case schema.PosesForm():
            return _poses(form, linkage, folder)
        case schema.FigureForm():
            return kinds.FigureWant(form.name, _goal(form, linkage), form.unit, form.weight)
        case schema.DwellForm():
            level = _zero("level", form.level, linkage, linkage.drive.output)
            ends = reading_span("range", form.range, linkage, linkage.drive.joint)
            return kinds.DwellWant(ends, level, form.samples, form.weight)
        case schema.StraightForm():
            ends = reading_span("range", form.range, linkage, linkage.drive.joint)
            return kinds.StraightWant(form.point, ends, form.length, form.samples, form.weight)


def _goal(form: schema.FigureForm, linkage: Linkage) -> Way | float:
    if form.value in ("small", "great"):
        return cast(Way, form.value)
    try:
        return figure_value("value", form.value, linkage, form.name)
    except RequestError as error:
        raise RequestError(f"{error}, or 'small' or 'great'") from None


def _function(form: schema.FunctionForm, linkage: Linkage, folder: Path) -> kinds.FunctionWant:
    given = _one_of(form, "y", "pairs", "table")
    if form.y is None:
        for name in ("input", "output", "points"):
            if getattr(form, name) is not None:
                raise RequestError(f"{name}: belongs to y; {given} says it all, so leave it out")
    columns = linkage.drive.joint, linkage.drive.output
    if form.y is not None:
        x, y = _of_formula(form, linkage)
    elif form.pairs is not None:
        x, y = (
            np.array(
                [reading(f"pairs[{i + 1}]", row[side], linkage, column) for i, row in enumerate(form.pairs)]
            )
            for side, column in enumerate(columns)
        )
    else:
        if not all(map(linkage.turns, columns)):
            raise RequestError("table: holds angles, and a joint of the drive slides; give pairs")
        x, y = _read(read_pairs, folder, str(form.table))
    zeros = (
        _zero("input_zero", form.input_zero, linkage, columns[0]),
        _zero("output_zero", form.output_zero, linkage, columns[1]),
    )
    return kinds.FunctionWant(x, y, zeros, form.weight)


def _of_formula(form: schema.FunctionForm, linkage: Linkage) -> tuple[Floats, Floats]:
    """Readings of input and output that y(x) wants, over the ranges of both or as x and y are."""
    y, drive = str(form.y), linkage.drive
    low, high = form.x
    if not low < high:
        raise RequestError(f"x: {low:g}:{high:g} does not rise; give the lower end first")
    wish = wish_of_function(y, form.x, (0.0, 1.0), (0.0, 1.0), title=y)
    share = wish.input if form.points is None else chebyshev(0.0, 1.0, form.points)
    if form.input is None and form.output is None:
        x = low + (high - low) * share
        if linkage.turns(drive.joint) and high - low >= math.tau:
            raise RequestError(
                f"x: goes over {math.degrees(high - low):g} deg, for it counts in radians; "
                "give a part of a turn"
            )
        return x, function_of(y)(x)
    ranges = []
    for name, ends, column in (("input", form.input, drive.joint), ("output", form.output, drive.output)):
        if ends is None:
            raise RequestError(
                f"{name}: is missing; give both ranges of readings, or neither where x and y are the readings"
            )
        first, last = reading_span(name, ends, linkage, column)
        if first == last:
            raise RequestError(f"{name}: both ends are one; give a range, as in '0:90deg'")
        if linkage.turns(column) and abs(last - first) >= math.tau:
            raise RequestError(
                f"{name}: goes over {math.degrees(abs(last - first)):g} deg; give a part of a turn"
            )
        ranges.append((first, last))
    assert wish.function is not None
    (a, b), (c, d) = ranges
    return a + (b - a) * share, c + (d - c) * wish.function(share)


def _path(form: schema.PathForm, linkage: Linkage, folder: Path) -> kinds.PathWant:
    _one_of(form, "places", "table")
    inputs: Floats | None = None
    if form.table is not None:
        drive = linkage.drive.joint
        rows, inputs = _read(
            lambda path: read_curve(path, linkage, drive, point=form.point), folder, form.table
        )
    else:
        rows = np.array(form.places, dtype=float)
    timing = _timing(form.timing, inputs, linkage)
    try:
        rows, closed = wanted_places(rows)
        timing = wanted_inputs(timing, rows, closed)
    except RequestError as error:
        key, _, message = str(error).partition(": ")
        own = "table" if form.table is not None else "places"
        raise RequestError(f"{own if key == 'points' else key}: {message}") from None
    return kinds.PathWant(form.point, rows[:-1] if closed else rows, closed, timing, form.phase, form.weight)


def _poses(form: schema.PosesForm, linkage: Linkage, folder: Path) -> kinds.PoseWant:
    _one_of(form, "poses", "table")
    inputs: Floats | None = None
    if form.table is not None:
        poses, inputs = _read(lambda path: read_poses(path, linkage), folder, form.table)
    else:
        poses = np.array([_pose(f"poses[{i + 1}]", one) for i, one in enumerate(form.poses or ())])
    if form.frame is not None:
        poses = poses @ inverse(_pose("frame", form.frame))
    arm = linkage_size(linkage) if form.arm is None else form.arm
    timing = _timing(form.timing, inputs, linkage)
    return kinds.PoseWant(form.link, poses, arm, timing, form.phase, form.weight)


def _pose(key: str, form: schema.PoseForm) -> Floats:
    """A pose (4, 4)."""
    if form.matrix is None:
        return pose(turns_about(unit(form.axis), np.array([form.angle]))[0], form.at)
    if {"axis", "angle"} & form.model_fields_set:
        raise RequestError(f"{key}: a matrix, and axis or angle; give one of the two")
    from scipy.spatial.transform import Rotation

    # to all digits what was written with some
    return pose(Rotation.from_matrix(np.array(form.matrix)).as_matrix(), form.at)


def _one_of(form: schema.WantForm, *names: str) -> str:
    """The one of some keys that a table has."""
    given = [name for name in names if getattr(form, name) is not None]
    if len(given) != 1:
        how_many = {2: "two", 3: "three"}[len(names)]
        both = "both " if len(names) == 2 else ""
        missing = f"{', '.join(names[:-1])} and {names[-1]} are missing"
        what = f"{' and '.join(given)} are {both}given" if given else missing
        raise RequestError(f"{what}; give one of the {how_many}")
    return given[0]


def _timing(given: object, of_table: Floats | None, linkage: Linkage) -> Floats | None:
    """The inputs [rad, or length] of places or poses, those of the table where `given` says so."""
    if given is None:
        return None
    if given is True:
        if of_table is None:
            raise RequestError(
                f"timing: no table has a column for the input '{linkage.drive.joint}'; "
                "give the inputs, as in [0, 10, 20]"
            )
        return of_table
    column = linkage.drive.joint
    assert isinstance(given, tuple)
    return np.array([reading(f"timing[{i + 1}]", value, linkage, column) for i, value in enumerate(given)])


def _zero(key: str, value: Given, linkage: Linkage, column: str) -> float | None:
    return None if value == "free" else reading(key, value, linkage, column)


def _read(reader: Callable[[Path], T], folder: Path, name: str) -> T:
    """What a reader finds in the table that a file in a folder names; its mistakes are those of the key."""
    try:
        return reader(file_below(folder, name, "wanted.csv"))
    except (TableError, RequestError) as error:
        raise RequestError(f"table: {str(error).removeprefix('table: ')}") from None


def must_of(form: schema.MustForm, linkage: Linkage, wants: Sequence[Want]) -> Must:
    """The must of a table; raises `RequestError` with the key at fault."""
    match form:
        case schema.RangeMust():
            column = linkage.columns[linkage.column(form.joint, "joint")]
            return kinds.InRange(column, *reading_span("range", form.range, linkage, column))
        case schema.ConeMust():
            return kinds.InCone(form.joint, form.angle, form.seat, form.stud)
        case schema.BoxMust():
            # all points and joints that are not of the ground alone
            points = [point.name for point in linkage.points if point.link in linkage.graph.moving]
            every = tuple(dict.fromkeys([*points, *(joint.name for joint in linkage.joints)]))
            return kinds.InBox(form.low, form.high, form.names or every)
        case schema.ApartMust():
            return kinds.Apart(form.links, form.least)
        case schema.FigureMustForm():
            ends = [
                None if end is None else figure_value(key, end, linkage, form.name)
                for key, end in (("least", form.least), ("most", form.most))
            ]
            return kinds.FigureMust(form.name, *ends)
        case schema.MostMust():
            return kinds.Most(form.want - 1, _most(form, linkage, wants))


def _most(form: schema.MostMust, linkage: Linkage, wants: Sequence[Want]) -> float:
    """The most of a want's residuals, relative to what they are relative to."""
    if form.want > len(wants):
        # the task is checked for it
        return 1.0
    want = wants[form.want - 1]
    unit = residual_unit(want, linkage)
    match want:
        case kinds.FunctionWant() | kinds.DwellWant():
            return reading("most", form.most, linkage, linkage.drive.output) / unit
        case kinds.FigureWant():
            # the task is checked for it
            return 1.0
        case _:
            return amount("most", form.most, linkage.length_unit) / unit
