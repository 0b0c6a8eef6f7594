"""Units that people write: lengths, angles, masses, forces, and the speed of a drive."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from sevenbar.errors import RequestError, shown, suggestion

#: Length units and their size in metres.
LENGTHS = {"um": 1e-6, "mm": 1e-3, "cm": 1e-2, "m": 1.0, "in": 0.0254, "ft": 0.3048}

#: Angle units and their size in radians.
ANGLES = {"rad": 1.0, "deg": math.pi / 180}

#: Units of turning speed and their size in rad/s.
TURNING_SPEEDS = {"rad/s": 1.0, "deg/s": math.pi / 180, "rpm": math.tau / 60, "rev/s": math.tau}

#: Other words for them.
OTHER_SPEEDS = {
    **dict.fromkeys(("hz", "1/s", "rps", "u/s", "s^-1", "s-1", "s\u207b\u00b9"), "rev/s"),
    **dict.fromkeys(
        ("u/min", "1/min", "min-1", "min^-1", "min\u207b\u00b9", "tr/min", "rev/min", "upm"), "rpm"
    ),
}

#: Units of time and their size in seconds.
TIMES = {"s": 1.0, "ms": 1e-3, "min": 60.0}

#: Units of mass and their size in kilograms, and those of force in newtons.
MASSES = {"g": 1e-3, "kg": 1.0, "t": 1e3, "oz": 0.028349523125, "lb": 0.45359237}
FORCES = {"mN": 1e-3, "N": 1.0, "kN": 1e3, "lbf": 4.4482216152605}

#: The least and the greatest speed [rad/s, or length/s]; the cubes of others, which jerks have as a factor,
#: come near the ends of what a float holds.
SLOWEST, FASTEST = 1e-50, 1e50

_QUANTITY = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*?)\s*")


def as_written(value: float) -> float:
    """A number as a person wrote it: without the last digit, which the way to radians and back may change.

    >>> math.degrees(math.pi / 6), as_written(math.degrees(math.pi / 6))
    (29.999999999999996, 30.0)
    """
    return float(f"{value:.15g}")


def unknown_unit(given: object, known: Iterable[str]) -> str:
    """The message for a unit that does not exist."""
    known = list(known)
    # nested without end it has no text
    meant = OTHER_SPEEDS.get(given.strip().lower()) if isinstance(given, str) else None
    near = f"did you mean '{meant}'? " if meant in known else suggestion(given, known)
    return f"{shown(given)} is not a unit known here; {near}allowed: {', '.join(known)}"


def turning_speed(value: object) -> float:
    """The speed [rad/s] of `"10 rad/s"`, `"60 rpm"`, `"90 deg/s"`, `"1 rev/s"`, or a number in rad/s.

    Raises `RequestError` for anything else, for zero, and for a number that is not finite.

        >>> turning_speed("60 rpm")
        6.283185307179586
    """
    return _speed(value, TURNING_SPEEDS, "turning", "'10 rad/s' or '60 rpm'")


def sliding_speed(value: object, length_unit: str) -> float:
    """The speed [length_unit/s] of `"10 mm/s"`, `"1 in/s"`, or a number in length units a second.

    Raises `RequestError` for anything else, for zero, and for a number that is not finite.

        >>> sliding_speed("1 in/s", "mm")
        25.4
    """
    sizes = {f"{unit}/s": size for unit, size in length_sizes(length_unit).items()}
    return _speed(value, sizes, "sliding", f"'10 {length_unit}/s'")


def length_sizes(length_unit: str) -> dict[str, float]:
    """Every length unit and its size in another."""
    return {unit: _quotient(size, LENGTHS[length_unit]) for unit, size in LENGTHS.items()}


def amount(text: str, sizes: Mapping[str, float], plain: str) -> float | None:
    """The number that a text gives by the sizes of units: "30", "12 mm"; `None` for what is no finite one.

    A number alone is in the unit `plain`.

        >>> amount("1 in", length_sizes("mm"), "mm")
        25.4
    """
    parts = split_quantity(text)
    if parts is None:
        return None
    number, unit = parts
    value = float(number) * sizes.get(unit or plain, math.nan)
    return value if math.isfinite(value) else None


def sizes_of(unit: str) -> dict[str, float]:
    """The units that measure what "mm", "deg", "mm/turn", "rad/s" or "" does, and their sizes in it.

    >>> sizes_of("mm/turn")["in/turn"], sizes_of("")
    (25.4, {'': 1.0})
    """
    for same in (ANGLES, TURNING_SPEEDS, MASSES, TIMES):
        if unit in same:
            return {other: size / same[unit] for other, size in same.items()} | {unit: 1.0}
    length, slash, per = unit.partition("/")
    if length not in LENGTHS:
        return {unit: 1.0}
    return {f"{other}{slash}{per}": size for other, size in length_sizes(length).items()}


def examples_of(unit: str) -> str:
    """What a value in a unit looks like, for messages: "30, 30deg or 0.5rad"."""
    if unit == "":
        return "a number, as in 1.5"
    if unit in ANGLES:
        return "30, 30deg or 0.5rad"
    if unit in TURNING_SPEEDS:
        return f"10, 10 {unit} or 60 rpm"
    return f"10 or 10 {unit}" if "/" in unit else f"250 or 250{unit}"


def split_quantity(text: str) -> tuple[str, str] | None:
    """The number of a text and its unit, empty where there is none; `None` for what begins with no number.

    >>> split_quantity("12 mm"), split_quantity("90\u00b0"), split_quantity("wide")
    (('12', 'mm'), ('90', 'deg'), None)
    """
    match = _QUANTITY.fullmatch(text.replace("\u00b0", "deg"))
    return None if match is None else (match[1], match[2])


def _quotient(size: float, other: float) -> float:
    """Of two lengths [m], right to the last digit: every unit is a whole number of micrometres."""
    return round(size * 1e6) / round(other * 1e6)


def usable_speed(speed: float) -> bool:
    """Whether a speed [rad/s, or length/s] moves something, and rates at it can be computed."""
    return SLOWEST <= abs(speed) <= FASTEST


def _speed(value: object, sizes: Mapping[str, float], motion: str, example: str) -> float:
    hint = f"give a number and a unit, as in {example}"
    if isinstance(value, str):
        speed = _written_speed(value, sizes, motion, hint)
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
        try:
            speed = float(value)
        except OverflowError:
            speed = math.inf
    else:
        raise RequestError(f"{shown(value)} is not a speed; {hint}")
    if usable_speed(speed):
        return speed
    first = example.split(" or ")[0]
    if speed == 0:
        raise RequestError(f"{shown(value)} moves nothing; give a finite speed other than 0, as in {first}")
    raise RequestError(
        f"{shown(value)} is out of range; give a speed of {SLOWEST:g} to {FASTEST:g} in size, as in {first}"
    )


def _written_speed(value: str, sizes: Mapping[str, float], motion: str, hint: str) -> float:
    parts = split_quantity(value)
    if parts is None:
        raise RequestError(f"{shown(value)} is not a speed; {hint}")
    number, unit = parts
    # zero is zero in any unit
    if unit in sizes or (not unit and float(number) == 0):
        return float(number) * sizes.get(unit, 1.0)
    if not unit:
        raise RequestError(f"{shown(value)} has no unit; {hint}")
    if motion == "turning" and unit in [f"{length}/s" for length in LENGTHS]:
        raise RequestError(f"{shown(value)} is a sliding speed, and the input turns; {hint}")
    if motion == "sliding" and unit in TURNING_SPEEDS:
        raise RequestError(f"{shown(value)} is a turning speed, and the input slides; {hint}")
    raise RequestError(unknown_unit(unit, sizes))


#: Other spellings of the units in text tables.
_SPELLINGS = (
    (r"\s+|·", ""),
    (r"\*\*|\^", ""),
    ("²", "2"),
    ("³", "3"),
    (r"°|degrees?", "deg"),
    (r"radians?", "rad"),
    (r"seconds?|sec(?=[23]?$)", "s"),
    (r"millis\b|msec\b", "ms"),
    (r"minutes?", "min"),
    (r"(?:1|revs?|r)/min|u/min", "rpm"),
    (r"millimet(?:er|re)s?", "mm"),
    (r"met(?:er|re)s?", "m"),
    (r"inch(?:es)?", "in"),
    (r"/s/s", "/s2"),
)

#: Units of a turn in text tables and their size in radians.
TURNS = {**ANGLES, "rev": math.tau}


@dataclass(frozen=True)
class MeasuredUnit:
    """A unit of a column: "time", "turn" or "slide", how often by time (0 to 3), size in s, rad, m."""

    kind: str
    order: int
    size: float

    def size_in(self, length_unit: str) -> float:
        """Its size in s, rad or `length_unit`.

        >>> measured_unit("cm/s").size_in("mm")
        10.0
        """
        return _quotient(self.size, LENGTHS[length_unit]) if self.kind == "slide" else self.size


def measured_unit(text: str) -> MeasuredUnit | None:
    """What a unit means as programs write it: `deg/sec**2`, `rad/s²`, `rpm`, `mm`; `None` where unknown.

    >>> measured_unit("rad/sec**2")
    MeasuredUnit(kind='turn', order=2, size=1.0)
    """
    word = text.strip().lower()
    for pattern, spelling in _SPELLINGS:
        word = re.sub(pattern, spelling, word)
    if word in TIMES:
        return MeasuredUnit("time", 0, TIMES[word])
    if word in TURNING_SPEEDS:
        return MeasuredUnit("turn", 1, TURNING_SPEEDS[word])
    base, _, per = word.partition("/")
    order = {"": 0, "s": 1, "s2": 2, "s3": 3}.get(per)
    if order is None:
        return None
    if base in TURNS:
        return MeasuredUnit("turn", order, TURNS[base])
    return MeasuredUnit("slide", order, LENGTHS[base]) if base in LENGTHS else None


def is_unit(text: str) -> bool:
    """Whether a text is a unit of a table's column."""
    return measured_unit(text) is not None
