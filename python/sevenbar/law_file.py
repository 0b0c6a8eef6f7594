"""An input law from a table of text: times, values of the input, and its rates where the table has them."""

from __future__ import annotations

import csv
import math
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sevenbar.errors import DescriptionError, MissingExtraError, Problem, shown
from sevenbar.linkage import MOST_SAMPLES, Linkage
from sevenbar.motion import Floats, Law
from sevenbar.units import ANGLES, LENGTHS

#: Degree of the spline: its third derivative, the jerk, is still smooth.
DEGREE = 5

#: A law with more [characters a line] is something else.
LONGEST_LINE = 10_000

#: Where velocity and change of the input differ by more than this part, their units do not belong together:
#: they differ by pi / 180 or 2 pi / 60 then, while a coarse table differs by its curvature only.
UNIT_SLIP = 0.5

#: What a table can hold, in the order of derivatives.
QUANTITIES = ("value", "velocity", "acceleration", "jerk")

#: Units of time and their size in seconds.
TIMES = {"s": 1.0, "ms": 1e-3, "min": 60.0}


def _rates(sizes: Mapping[str, float]) -> dict[str, dict[str, float]]:
    """The units of a value and of its derivatives by time, from those of the value."""
    return {
        quantity: {f"{unit}{suffix}": size for unit, size in sizes.items()}
        for quantity, suffix in zip(QUANTITIES, ("", "_s", "_s2", "_s3"), strict=True)
    }


#: Units of what turns, as heads have them, and their size in radians and seconds.
TURNS = _rates({**ANGLES, "rev": math.tau})
TURNS["velocity"] |= {"rpm": math.tau / 60, "rev_min": math.tau / 60}

KNOWN_UNITS = {
    *TIMES,
    *(unit for units in (TURNS, _rates(LENGTHS)) for known in units.values() for unit in known),
}

EXAMPLE = "'time [s],angle [deg]'"

_BRACKETED = re.compile(r"(.*?)\s*(?:\[(.*?)\]|\((.*?)\))")


@dataclass(frozen=True)
class _Head:
    """A column: where it stands, its whole head, what it is called there, and its unit (none: empty)."""

    place: int
    text: str
    name: str
    unit: str


def load_law(path: str | os.PathLike[str], linkage: Linkage, *, input: str | None = None) -> Law:
    """The law of a CSV file for a joint of a linkage: its drive's, or `input`.

    The first row is the head of each column: a name and a unit, as in `time [s], crank [deg], crank [rad/s]`
    or `time_s,crank_deg,crank_rad_s`. The unit says what a column is. Needed are a time and the value of the
    input; velocity, acceleration and jerk are taken where they are given. What is not given is differentiated
    from a spline of degree five through the highest derivative that is (extra `[law]`).

    Raises `DescriptionError` for a file that is no such table, `RequestError` for a joint that cannot drive,
    `MissingExtraError` where a spline is needed and SciPy is missing.
    """
    column = linkage.column(linkage.drive.joint if input is None else input, "input")
    place = str(path)
    heads, rows = _table(Path(path))
    chosen = _chosen(heads, linkage, column, place)
    numbers = {quantity: (head, _column(rows, head, place)) for quantity, head in chosen.items()}
    time_head, times = numbers.pop("time")
    _check_times(times * TIMES[time_head.unit or "s"], rows, time_head, place)
    sizes = _sizes(linkage, column)
    derivatives = {
        quantity: array * sizes[quantity][head.unit] for quantity, (head, array) in numbers.items()
    }
    t = times * TIMES[time_head.unit or "s"]
    if linkage.column_kinds[column] == "turn":
        _check_steps(derivatives, rows, chosen["value"], place)
    _check_rates(t, derivatives, chosen, place)
    return Law.of(t, *_completed(t, [derivatives[q] for q in QUANTITIES if q in derivatives], place))


def _table(path: Path) -> tuple[list[_Head], list[tuple[int, list[str]]]]:
    """The heads, and each row with its line number; lines that are empty or begin with # are left out."""
    place = str(path)
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            lines = _lines(file, place)
            number, first = next(lines, (0, ""))
            if number == 0:
                raise _wrong(place, "", f"is empty; give a head, as in {EXAMPLE}, and a row for each time")
            delimiter = max(",;\t", key=first.count)
            heads = [_head(i, text) for i, text in enumerate(_cells(first, delimiter))]
            if all(_is_number(head.text) for head in heads):
                raise _wrong(
                    place, f"line {number}", f"is a row of numbers; begin with a head, as in {EXAMPLE}"
                )
            rows = []
            for number, line in lines:
                cells = _cells(line, delimiter)
                if len(cells) != len(heads):
                    has = f"has {_counted(len(cells), 'value')} where the head has {len(heads)}"
                    raise _wrong(place, f"line {number}", f"{has}; give one for each column")
                rows.append((number, cells))
                if len(rows) > MOST_SAMPLES:
                    raise _wrong(
                        place, "", f"has more than {MOST_SAMPLES} rows; give every tenth of them, say"
                    )
    except FileNotFoundError:
        raise _wrong(place, "", "no such file; give the path of a CSV file") from None
    except IsADirectoryError:
        raise _wrong(place, "", "is a folder; give the path of a CSV file in it") from None
    except UnicodeDecodeError:
        raise _wrong(place, "", "is not text in UTF-8; save it as CSV in UTF-8") from None
    except (OSError, ValueError) as error:
        reason = (getattr(error, "strerror", None) or str(error)).lower()
        raise _wrong(place, "", f"cannot be read: {reason}; give the path of a CSV file") from None
    return heads, rows


def _lines(file: Iterator[str], place: str) -> Iterator[tuple[int, str]]:
    for number, line in enumerate(file, 1):
        if len(line) > LONGEST_LINE or "\0" in line:
            raise _wrong(place, f"line {number}", "is no row of a table of text; give a CSV file")
        if line.strip(" \t\r\n,;") and not line.lstrip().startswith("#"):
            yield number, line.rstrip("\r\n")


def _cells(line: str, delimiter: str) -> list[str]:
    return [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter, skipinitialspace=True))]


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _head(place: int, text: str) -> _Head:
    match = _BRACKETED.fullmatch(text)
    if match:
        return _Head(place, text, match[1].strip(), _unit(match[2] or match[3] or ""))
    lowered = _unit(text)
    for unit in sorted(KNOWN_UNITS, key=len, reverse=True):
        if lowered.endswith(f"_{unit}"):
            return _Head(place, text, text[: -len(unit) - 1].strip(), unit)
    return _Head(place, text, text, "")


def _unit(text: str) -> str:
    """A unit as the heads of Sevenbar's own tables have it: rad_s2 for rad/s^2."""
    plain = text.strip().lower().replace("\u00b0", "deg").replace("\u00b2", "2").replace("\u00b3", "3")
    return re.sub(r"\s*/\s*", "_", plain.replace("^", "").replace("**", ""))


def _sizes(linkage: Linkage, column: int) -> dict[str, dict[str, float]]:
    """The units that each quantity of a joint can have, and their size in radians or in its own length."""
    if linkage.column_kinds[column] == "turn":
        return TURNS
    # every length is a whole number of micrometres, so the quotient of two is right to the last digit
    whole = {unit: round(size * 1e6) for unit, size in LENGTHS.items()}
    return _rates({unit: size / whole[linkage.length_unit] for unit, size in whole.items()})


def _chosen(heads: Sequence[_Head], linkage: Linkage, column: int, place: str) -> dict[str, _Head]:
    """The column of each quantity, told by its unit; by its name, too, where several have such a unit."""
    name = linkage.columns[column]
    turns = linkage.column_kinds[column] == "turn"
    units = {"time": TIMES, **_sizes(linkage, column)}
    found = {}
    for quantity, known in units.items():
        fitting = [head for head in heads if head.unit in known]
        if quantity == "time":
            fitting = fitting or [h for h in heads if not h.unit and h.name.lower() in ("t", "time")]
        if len(fitting) > 1:
            what = {"value": "angle" if turns else "position"}.get(quantity, quantity)
            own = (name, linkage.joints[_owner(linkage, column)].name, "input", what, "time", "t")
            named = [head for head in fitting if head.name.lower() in {word.lower() for word in own}]
            if len(named) != 1:
                several = ", ".join(shown(head.text) for head in fitting)
                kept = f"keep the one of the input, or name it '{name}' and its unit"
                raise _wrong(place, "", f"{several} may each be the {what}; {kept}")
            fitting = named
        if fitting:
            found[quantity] = fitting[0]
    _check_heads(heads, found, name, turns, place)
    return found


def _owner(linkage: Linkage, column: int) -> int:
    owners = [place for place, joint in enumerate(linkage.joints) for _ in joint.columns]
    return owners[column]


def _check_heads(
    heads: Sequence[_Head], found: Mapping[str, _Head], name: str, turns: bool, place: str
) -> None:
    given = f"the head has {', '.join(shown(head.text) for head in heads)}"
    value, example = ("an angle", f"{name} [deg]") if turns else ("a position", f"{name} [mm]")
    if "time" not in found:
        raise _wrong(place, "", f"no column of time; {given}; give one, as in 'time [s]'")
    if "value" not in found:
        moves = "turns" if turns else "slides"
        raise _wrong(
            place,
            "",
            f"no column with {value} of {name}, which {moves}; {given}; give one, as in '{example}'",
        )
    order = [quantity in found for quantity in QUANTITIES]
    if order != sorted(order, reverse=True):
        missing = QUANTITIES[order.index(False)]
        higher = next(q for q in QUANTITIES[order.index(False) :] if q in found)
        alone = f"{shown(found[higher].text)} is given without a column of {missing}"
        raise _wrong(place, "", f"{alone}; add that, or leave this out")


def _column(rows: Sequence[tuple[int, list[str]]], head: _Head, place: str) -> Floats:
    values = np.empty(len(rows))
    for i, (number, cells) in enumerate(rows):
        cell = cells[head.place]
        where = f"line {number}: {head.text}"
        try:
            values[i] = float(cell)
        except ValueError:
            if not cell:
                raise _wrong(place, where, "is empty; give a number, or leave the row out") from None
            point = "; write it with a decimal point" if re.fullmatch(r"[-+]?\d+,\d+", cell) else ""
            raise _wrong(place, where, f"{shown(cell)} is not a number{point or '; give a number'}") from None
        if not math.isfinite(values[i]):
            raise _wrong(
                place, where, f"{shown(cell)} is not a finite number; give one, or leave the row out"
            )
    return values


def _check_times(t: Floats, rows: Sequence[tuple[int, list[str]]], head: _Head, place: str) -> None:
    if not rows:
        raise _wrong(place, "", "has a head but no rows; give a row for each time")
    falls = np.flatnonzero(np.diff(t) <= 0)
    if falls.size:
        (_, before), (number, cells) = rows[falls[0]], rows[falls[0] + 1]
        last, now = before[head.place], cells[head.place]
        same = (
            "comes twice" if t[falls[0]] == t[falls[0] + 1] else f"does not come after {last}, the row before"
        )
        raise _wrong(
            place,
            f"line {number}: {head.text}",
            f"{now} {same}; give each time once, from the first to the last",
        )


def _check_steps(
    derivatives: Mapping[str, Floats], rows: Sequence[tuple[int, list[str]]], head: _Head, place: str
) -> None:
    """Refuses an angle that begins anew after a full turn, through which no spline can go."""
    jumps = np.flatnonzero(np.abs(np.diff(derivatives["value"])) > math.pi)
    if jumps.size and "velocity" not in derivatives:
        (_, before), (number, cells) = rows[jumps[0]], rows[jumps[0] + 1]
        jump = f"goes from {before[head.place]} to {cells[head.place]} in one row, more than half a turn"
        remedy = "let the angle count on past a full turn, and give rows that are nearer"
        raise _wrong(place, f"line {number}: {head.text}", f"{jump}; {remedy}")


def _check_rates(
    t: Floats, derivatives: Mapping[str, Floats], heads: Mapping[str, _Head], place: str
) -> None:
    """Refuses a velocity that is not that of the values, nearly always a slip of its unit."""
    moved = np.diff(derivatives["value"])
    if "velocity" not in derivatives or t.size < 2:
        return
    velocity = derivatives["velocity"]
    expected = 0.5 * (velocity[1:] + velocity[:-1]) * np.diff(t)
    scale = max(np.abs(moved).sum(), np.abs(expected).sum())
    if np.abs(moved - expected).sum() > UNIT_SLIP * scale:
        ratio = np.abs(expected).sum() / max(np.abs(moved).sum(), np.finfo(float).tiny)
        message = (
            f"is no velocity of {shown(heads['value'].text)}: it makes for {ratio:.3g} times its changes"
        )
        raise _wrong(place, heads["velocity"].text, f"{message}; check both units")


def _completed(t: Floats, given: Sequence[Floats], place: str) -> list[Floats]:
    """The value and its three derivatives: the highest that is given is differentiated by a spline."""
    missing = len(QUANTITIES) - len(given)
    if missing == 0:
        return list(given)
    through = QUANTITIES[len(given) - 1]
    if t.size <= DEGREE:
        raise _wrong(
            place,
            "",
            f"{_counted(t.size, 'row')} are too few: a spline through each {through} needs {DEGREE + 1}; "
            f"give more rows, or columns of {' and '.join(QUANTITIES[len(given) :])}",
        )
    try:
        from scipy.interpolate import make_interp_spline
    except ImportError:
        raise MissingExtraError(
            f"{place}: a spline through each {through} needs SciPy; install it with: "
            f"pip install 'sevenbar[law]', or give columns of {' and '.join(QUANTITIES[len(given) :])}"
        ) from None
    spline = make_interp_spline(t, given[-1], k=DEGREE)
    return [*given, *(np.asarray(spline(t, nu=order)) for order in range(1, missing + 1))]


def _counted(count: int, word: str) -> str:
    return f"{count} {word}{'s' * (count != 1)}"


def _wrong(place: str, where: str, message: str) -> DescriptionError:
    return DescriptionError([Problem(where, message)], place)
