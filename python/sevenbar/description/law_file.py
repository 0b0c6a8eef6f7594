"""An input law from a table of text: times, values of the input, and its rates where the table has them."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.errors import check_kind, ends_here, given_path, of_extra
from sevenbar.kinematics.linkage import MOST_SAMPLES, Linkage
from sevenbar.kinematics.loop.geometry import Loop
from sevenbar.kinematics.loop.law import Law
from sevenbar.text.table import TextTable, read_table

#: Degree of the spline: its third derivative, the jerk, is still smooth.
DEGREE = 5

#: Where velocity and change of the input differ by more than this part, their units do not belong together:
#: they differ by pi / 180 or 2 pi / 60 then, while a coarse table differs by its curvature only.
UNIT_SLIP = 0.5

#: What a table can hold besides the time, in the order of derivatives.
QUANTITIES = ("value", "velocity", "acceleration", "jerk")


@ends_here
def load_law(
    path: str | os.PathLike[str],
    linkage: Linkage,
    *,
    input: str | None = None,
    joint: str | None = None,
    circuit: int | None = None,
) -> Law:
    r"""The law of a table of text for a joint of a linkage: its drive's, or `input`.

    A header names each column and its unit, as in `time [s], crank [deg], crank [rad/s]` or
    `time_s,crank_deg,crank_rad_s`. The unit says what a column is. Needed are a time and the value of the
    input; velocity, acceleration and jerk are taken where they are given. What is not given is differentiated
    from a spline of degree five through the highest derivative that is (extra `[law]`).

    The table may be the motion of another linkage, whose output drives this one: `joint` is the name that the
    input has there, and `circuit` the one that is taken where the table has several.

    Raises `TableError` for a file that is no such table, `RequestError` for a joint that cannot drive,
    `MissingExtraError` where a spline is needed and SciPy is missing.

        >>> import tempfile
        >>> from pathlib import Path
        >>> import sevenbar as sb
        >>> head = "time [s],crank [deg],crank [deg/s],crank [deg/s^2],crank [deg/s^3]"
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     table = Path(folder) / "law.csv"
        ...     _ = table.write_text(f"{head}\n0,0,0,90,0\n1,45,90,90,0\n")
        ...     law = load_law(table, sb.load("rssr"))
        >>> law.q.round(6).tolist()
        [0.0, 0.785398]
    """
    check_kind("linkage", linkage, Loop, "a linkage; give one, as load(..) has it")
    column = linkage.input_column(input)
    table = _of_circuit(read_table(given_path("path", path), "an input law"), circuit)
    if len(table.rows) > MOST_SAMPLES:
        raise table.wrong(f"has more than {MOST_SAMPLES} rows; give every tenth of them, say")
    places = _places(table, linkage, column, joint)
    written = {quantity: table.numbers(place) for quantity, place in places.items()}
    table.refuse_gaps(
        {places[quantity]: numbers for quantity, numbers in written.items()}, "leave such rows out"
    )
    table.refuse_falling(written["time"], np.arange(len(table.rows)))
    # a time without a unit is in seconds
    units = {quantity: table.unit(place) for quantity, place in places.items()}
    sizes = {q: 1.0 if unit is None else unit.size_in(linkage.length_unit) for q, unit in units.items()}
    numbers = {quantity: written[quantity] * size for quantity, size in sizes.items()}
    t = numbers.pop("time")
    if linkage.turns(column):
        if "velocity" in numbers:
            # by which a jump of a turn is none
            numbers["value"] = np.unwrap(numbers["value"])
        _refuse_jumps(table, numbers, places["value"])
    _refuse_other_rates(table, t, numbers, places)
    return Law.of(t, *_completed(table, t, [numbers[q] for q in QUANTITIES if q in numbers]))


def _of_circuit(table: TextTable, circuit: int | None) -> TextTable:
    """The rows of one circuit of a motion's table; of any other table all rows."""
    place = table.column("circuit")
    if place is None:
        if circuit is not None:
            raise table.wrong(f"has no column of circuits, of which {circuit} is asked; leave that out")
        return table
    numbers = table.numbers(place)
    known = sorted({int(number) for number in numbers[np.isfinite(numbers)]})
    if circuit is None and len(known) == 1:
        return table
    if circuit not in known:
        what = "has rows of" if circuit is None else f"has no circuit {circuit}, but"
        listed = ", ".join(map(str, known))
        raise table.wrong(f"{what} circuits {listed}; say which, as in --law-circuit {known[0]}")
    selected = np.flatnonzero(numbers == circuit)
    rows, lines = tuple(table.rows[row] for row in selected), tuple(table.lines[row] for row in selected)
    return replace(table, rows=rows, lines=lines)


def _places(table: TextTable, linkage: Linkage, column: int, joint: str | None) -> dict[str, int]:
    """The column of each quantity, known by its unit; by its name, too, where several have such a unit."""
    own = linkage.each_column[column]
    name, owner = own.name, linkage.joints[linkage.joint_of(column)].name
    heads = [table.name_and_unit(place) for place in range(len(table.names))]
    sorts = {
        "time": ("time", 0),
        **{quantity: (own.kind, order) for order, quantity in enumerate(QUANTITIES)},
    }
    result = {}
    for quantity, sort in sorts.items():
        fitting = table.columns_of(sort)
        if quantity == "time" and not fitting:
            fitting = [
                i for i, (head, unit) in enumerate(heads) if not unit and head.lower() in ("t", "time")
            ]
        if len(fitting) > 1:
            what = {"value": "angle" if own.turns else "position"}.get(quantity, quantity)
            words = (name, owner, "input", what) if joint is None else (joint,)
            known = {word.lower() for word in (*words, "time", "t")}
            named = [place for place in fitting if heads[place][0].lower() in known]
            if len(named) != 1:
                several = ", ".join(table.labels[place] for place in fitting)
                motion = table.column("circuit") is not None
                which = f", or say which, as in --law-joint {heads[fitting[0]][0]}" if motion else ""
                raise table.wrong(
                    f"line {table.header_line}: {several} may each be the {what}; "
                    f"keep the one of the input, or name it '{name}' and its unit{which}"
                )
            fitting = named
        if fitting:
            result[quantity] = fitting[0]
    _refuse_what_is_missing(table, result, name, turns=own.turns)
    return result


def _refuse_what_is_missing(table: TextTable, columns: Mapping[str, int], name: str, *, turns: bool) -> None:
    value, moves, unit = ("an angle", "turns", "deg") if turns else ("a position", "slides", "mm")
    if "time" not in columns or "value" not in columns:
        what = f"with {value} of {name}, which {moves}" if "time" in columns else "for the time"
        raise table.wrong(f"no column {what}; {table.header}; name them as in 'time [s],{name} [{unit}]'")
    given = [quantity in columns for quantity in QUANTITIES]
    if given != sorted(given, reverse=True):
        gap = given.index(False)
        higher = next(quantity for quantity in QUANTITIES[gap:] if quantity in columns)
        alone = f"{table.labels[columns[higher]]} is given without a column of {QUANTITIES[gap]}"
        raise table.wrong(f"{alone}; add that, or leave this out")


def _refuse_jumps(table: TextTable, numbers: Mapping[str, Floats], place: int) -> None:
    """Refuses an angle that begins anew after a full turn, through which no spline can go."""
    jumps = np.flatnonzero(np.abs(np.diff(numbers["value"])) > math.pi)
    if jumps.size and "velocity" not in numbers:
        row = int(jumps[0])
        before, after = table.rows[row][place], table.rows[row + 1][place]
        raise table.wrong(
            f"goes from {before} to {after} in one row, more than half a turn; "
            "let the angle count on past a full turn, and give rows that are nearer",
            row=row + 1,
            column=place,
        )


def _refuse_other_rates(
    table: TextTable, t: Floats, numbers: Mapping[str, Floats], places: Mapping[str, int]
) -> None:
    """Refuses a velocity that is not that of the values, nearly always a slip of its unit."""
    if "velocity" not in numbers or t.size < 2:
        return
    moved, velocity = np.diff(numbers["value"]), numbers["velocity"]
    expected = 0.5 * (velocity[1:] + velocity[:-1]) * np.diff(t)
    scale = max(np.abs(moved).sum(), np.abs(expected).sum())
    if np.abs(moved - expected).sum() > UNIT_SLIP * scale:
        makes, changes = np.abs(expected).sum(), np.abs(moved).sum()
        rests = changes <= np.finfo(float).eps * makes
        why = "those values rest" if rests else f"it makes for {makes / changes:.3g} times its changes"
        raise table.wrong(
            f"is no velocity of {table.labels[places['value']]}: {why}; check both units",
            column=places["velocity"],
        )


def _completed(table: TextTable, t: Floats, given: Sequence[Floats]) -> list[Floats]:
    """The value and its three derivatives: the highest that is given is differentiated by a spline."""
    missing = len(QUANTITIES) - len(given)
    if missing == 0:
        return list(given)
    through = f"a spline through each {QUANTITIES[len(given) - 1]}"
    columns = f"columns of {' and '.join(QUANTITIES[len(given) :])}"
    if t.size <= DEGREE:
        rows = "one row is too few" if t.size == 1 else f"{t.size} rows are too few"
        raise table.wrong(f"{rows}: {through} needs {DEGREE + 1}; give more rows, or {columns}")
    with of_extra("law", f"{table.source}: {through} needs SciPy", f", or give {columns}"):
        from scipy.interpolate import make_interp_spline
    spline = make_interp_spline(t, given[-1], k=DEGREE)
    return [*given, *(np.asarray(spline(t, nu=order)) for order in range(1, missing + 1))]
