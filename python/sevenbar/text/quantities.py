"""Amounts of mass and force and of what is made of them, as in `250 g`, `40 N/mm`, `0.5 N m/rad`."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from fractions import Fraction
from typing import Literal, NamedTuple, get_args

from sevenbar.errors import RequestError, shown
from sevenbar.text.amounts import value_of
from sevenbar.text.units import ANGLES, FORCES, LENGTHS, MASSES, TIMES, split_quantity, unknown_unit

#: What an amount measures.
QuantityKind = Literal[
    "mass",
    "inertia",
    "density",
    "acceleration",
    "force",
    "torque",
    "stiffness",
    "damping",
    "turning stiffness",
    "turning damping",
]

QUANTITY_KINDS: tuple[str, ...] = get_args(QuantityKind)


class _Kind(NamedTuple):
    """What it is in words, the unit of a number alone, and another example."""

    what: str
    unit: str
    example: str


_KINDS: Mapping[QuantityKind, _Kind] = {
    "mass": _Kind("a mass", "{mass}", "250 g"),
    "inertia": _Kind("a moment of inertia", "{mass} {length}^2", "2e-3 kg m^2"),
    "density": _Kind("a density", "kg/m^3", "7.85 g/cm^3"),
    "acceleration": _Kind("an acceleration", "m/s^2", "9810 mm/s^2"),
    "force": _Kind("a force", "N", "0.1 kN"),
    "torque": _Kind("a torque", "N m", "300 N mm"),
    "stiffness": _Kind("a stiffness", "N/{length}", "2e4 N/m"),
    "damping": _Kind("a damping", "N s/{length}", "15 N s/m"),
    "turning stiffness": _Kind("a stiffness of a turn", "N m/rad", "20 N mm/deg"),
    "turning damping": _Kind("a damping of a turn", "N m s/rad", "5 N mm s/rad"),
}


class _Unit(NamedTuple):
    """Its size in kg, m, s, rad, and the powers of these."""

    size: Fraction
    powers: tuple[int, int, int, int]

    def times(self, other: _Unit, power: int) -> _Unit:
        powers = zip(self.powers, other.powers, strict=True)
        return _Unit(self.size * other.size**power, tuple(a + power * b for a, b in powers))  # type: ignore[arg-type]


_ONE = _Unit(Fraction(1), (0, 0, 0, 0))
_UNITS = {
    name: _Unit(Fraction(repr(size)), powers)
    for sizes, powers in (
        (MASSES, (1, 0, 0, 0)),
        (FORCES, (1, 1, -2, 0)),
        (LENGTHS, (0, 1, 0, 0)),
        (TIMES, (0, 0, 1, 0)),
        (ANGLES, (0, 0, 0, 1)),
        ({"Nm": 1.0, "Nmm": 1e-3, "kNm": 1e3}, (1, 2, -2, 0)),
    )
    for name, size in sizes.items()
}

#: Signs of print.
_SIGNS = str.maketrans({"\u00b7": " ", "\u00d7": "*", "\u00b0": "deg", "\u00b2": "2", "\u00b3": "3"})

_WORD = rf"(?:{'|'.join(sorted(_UNITS, key=len, reverse=True))})(?:\^?[23])?(?![\w^])"
_NEXT = re.compile(r"\s*([/*]|\s)\s*")
_AMOUNT = re.compile(rf"(.+?)\s*({_WORD}(?:\s*(?:[/*]|\s)\s*{_WORD})*)")


def quantity_of(text: str, kind: QuantityKind, *, mass_unit: str = "kg", length_unit: str = "mm") -> float:
    """The number of an amount in its kind's unit, which a number alone is in; the number may be a formula.

    Each unit that divides has a / of its own: "N m s/rad". Raises `RequestError` where units do not fit.

        >>> quantity_of("250 g", "mass"), quantity_of("2*20 N/m", "stiffness", length_unit="mm")
        (0.25, 0.04)
        >>> quantity_of("3 N m", "torque"), quantity_of("2e-3 kg m^2", "inertia", length_unit="mm")
        (3.0, 2000.0)
    """
    known = _KINDS[kind]
    unit = known.unit.format(mass=mass_unit, length=length_unit)
    remedy = f"give {known.what}, as in 12, '12 {unit}' or '{known.example}'"
    plain = text.strip().translate(_SIGNS).replace("**", "^")
    match = _AMOUNT.fullmatch(plain)
    number, written = (match[1], match[2]) if match else (plain, unit)
    size, own = unit_of(written), unit_of(unit)
    if size.powers != own.powers:
        raise RequestError(f"{shown(text)}: {shown(written)} is not a unit of {_bare(known.what)}; {remedy}")
    try:
        value = value_of(number, "number")
    except RequestError as error:
        parts = split_quantity(plain)
        if parts is not None and parts[1] and match is None:
            message = unknown_unit(parts[1], (*MASSES, *FORCES, *LENGTHS, *TIMES, *ANGLES))
            raise RequestError(f"{shown(text)}: {message}; {remedy}") from None
        raise RequestError(f"{str(error).partition('; ')[0]}; {remedy}") from None
    ratio = size.size / own.size
    return float(Fraction(value) * ratio) if math.isfinite(value) and ratio != 1 else value


def unit_of(text: str) -> _Unit:
    """The size of a unit that is made of others, in kg, m, s, rad, and their powers.

    >>> float(unit_of("N/mm").size), unit_of("kg m^2").powers
    (1000.0, (1, 2, 0, 0))
    """
    result, sign = _ONE, ""
    for i, word in enumerate(_NEXT.split(text.strip())):
        if i % 2:
            sign = word
            continue
        name, power = (word.rstrip("23^"), int(word[-1])) if word[-1] in "23" else (word, 1)
        result = result.times(_UNITS[name], -power if sign == "/" else power)
    return result


def _bare(what: str) -> str:
    return what.partition(" ")[2]
