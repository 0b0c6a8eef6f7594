"""NAME=VALUE, ranges and grids as people write them: one grammar for every option.

A range is LOW:HIGH or LOW..HIGH, a grid LOW:HIGH:COUNT. A unit at the end of a range is that of both ends;
in a list each value has its own.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from decimal import Decimal

from sevenbar.errors import RequestError, shown
from sevenbar.text.amounts import lacks_unit
from sevenbar.text.units import ANGLES, LENGTHS, amount, sizes_of, split_quantity

#: A unit that ends a value: after a number or a bracket.
_UNIT_AT_END = re.compile(rf"(?<=[\d.)\s])({'|'.join((*LENGTHS, *ANGLES))})\s*$")

#: A count of a grid: 51, 1e3.
_COUNT = re.compile(r"[0-9]{1,20}(?:[eE][0-9]{1,2})?")

#: Three numbers: a place, a direction.
Place = tuple[float, float, float]


def split_name(text: str) -> tuple[str, str] | None:
    """Name and value of NAME=VALUE; `None` where one is missing.

    >>> split_name("L1 = 100:400")
    ('L1', '100:400')
    """
    name, _, value = (part.strip() for part in text.partition("="))
    return (name, value) if name and value else None


def split_named(option: str, words: Iterable[str], what: str, hint: str) -> dict[str, str]:
    """The values of words NAME=VALUE by their names.

    Raises `RequestError` for a word that has another form, and so is not `what`, and for a name given twice.
    """
    result: dict[str, str] = {}
    for word in words:
        parts = split_name(word)
        if parts is None:
            raise RequestError(f"{option}: {shown(word)} is not {what}; {hint}")
        name, value = parts
        if name in result:
            raise RequestError(f"{option}: {shown(name)} is given twice; leave one out")
        result[name] = value
    return result


def split_range(text: str) -> tuple[str, str] | None:
    """The two ends of LOW:HIGH or LOW..HIGH; `None` for a text of another form.

    >>> split_range("10:40cm"), split_range("10mm..4cm")
    (('10cm', '40cm'), ('10mm', '4cm'))
    """
    ends = _parts(text.replace("..", ":"))
    return with_common_unit(ends[0], ends[1]) if len(ends) == 2 else None


def split_grid(text: str) -> tuple[str, str, int] | None:
    """The two ends of LOW:HIGH:COUNT, and the count; `None` for a text of another form.

    >>> split_grid("20:30cm:51"), split_grid("0:1:1e3")
    (('20cm', '30cm', 51), ('0', '1', 1000))
    """
    parts = _parts(text)
    if len(parts) != 3 or _COUNT.fullmatch(parts[2]) is None:
        return None
    return *with_common_unit(parts[0], parts[1]), int(Decimal(parts[2]))


def with_common_unit(low: str, high: str) -> tuple[str, str]:
    """The two ends of a range, the unit at the end of the high one added to a low one that has none.

    >>> with_common_unit("0", "90 deg"), with_common_unit("5cm", "1m"), with_common_unit("1", "2")
    (('0deg', '90 deg'), ('5cm', '1m'), ('1', '2'))
    >>> with_common_unit("2*5", "40cm"), with_common_unit("-pi/2", "90 deg")
    (('(2*5)cm', '40cm'), ('-pi/2', '90 deg'))
    """
    at_end = _UNIT_AT_END.search(high.replace("\u00b0", "deg"))
    if at_end is None:
        return low, high
    unit = at_end[1]
    first = split_quantity(low)
    if first is not None and not first[1]:
        return f"{low}{unit}", high
    return (f"({low}){unit}" if lacks_unit(low, "angle" if unit in ANGLES else "length") else low), high


def split_list(text: str) -> list[str]:
    """The values between commas; none where one is empty.

    >>> split_list("400, 45cm"), split_list("1,")
    (['400', '45cm'], [])
    """
    values = [value.strip() for value in text.split(",")]
    return values if all(values) else []


def three_numbers(option: str, text: str, what: str, example: str) -> Place:
    """Three numbers parted by commas."""
    values = [amount(word, sizes_of(""), "") for word in split_list(text)]
    if len(values) != 3 or None in values:
        raise RequestError(f"{option}: {shown(text)} is not {what}; give three numbers, as in '{example}'")
    x, y, z = (value for value in values if value is not None)
    return x, y, z


def _parts(text: str) -> list[str]:
    """The parts between colons; none where one is empty."""
    parts = [part.strip() for part in text.split(":")]
    return parts if all(parts) else []
