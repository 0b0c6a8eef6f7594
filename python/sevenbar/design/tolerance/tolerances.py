"""Tolerances as people give them, by name, pattern or class of ISO 2768, and how errors spread in them."""

from __future__ import annotations

import fnmatch
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sevenbar.arrays import Floats
from sevenbar.errors import RequestError, check_word, shown, suggestion
from sevenbar.kinematics.numbers.dimensions import Dimension
from sevenbar.text.ranges import split_named
from sevenbar.text.units import LENGTHS

#: ISO 2768-1, table 1: permissible deviations [mm] of linear dimensions up to each size [mm], from 0.5 mm on.
SIZES = (3.0, 6.0, 30.0, 120.0, 400.0, 1000.0, 2000.0, 4000.0)
LEAST_SIZE = 0.5
CLASSES: dict[str, tuple[float | None, ...]] = {
    "f": (0.05, 0.05, 0.1, 0.15, 0.2, 0.3, 0.5, None),
    "m": (0.1, 0.1, 0.2, 0.3, 0.5, 0.8, 1.2, 2.0),
    "c": (0.2, 0.3, 0.5, 0.8, 1.2, 2.0, 3.0, 4.0),
    "v": (None, 0.5, 1.0, 1.5, 2.5, 4.0, 6.0, 8.0),
}

_EXAMPLES = "'L1=0.5', 'twist_*=0.1deg' or '*=ISO 2768-m'"

_CLASS = re.compile(r"\s*iso\s*2768(?:-1)?\s*[- ]\s*(\w+)\s*", re.IGNORECASE)

#: Half widths of a normal distribution in its standard deviations; beyond it is cut.
CUT = 3.0

#: Standard deviation of each distribution relative to the half width. That of the cut normal one is smaller
#: than a third by what the tails hold.
_TAIL = 2 * CUT * math.exp(-(CUT**2) / 2) / math.sqrt(math.tau) / math.erf(CUT / math.sqrt(2))
DEVIATIONS = {
    "normal": math.sqrt(1 - _TAIL) / CUT,
    "uniform": 1 / math.sqrt(3),
    "triangular": 1 / math.sqrt(6),
}


@dataclass(frozen=True, eq=False)
class Tolerances:
    """Half widths (dimensions,) in the dimensions' units, 0 where a dimension is taken for exact.

    `sources` tell where each comes from, `left_out` why a pattern gave some dimensions none.
    """

    dimensions: tuple[Dimension, ...]
    widths: Floats
    sources: tuple[str, ...]
    left_out: tuple[str, ...]

    def deviations(self, distribution: str) -> Floats:
        """The standard deviations (dimensions,) of errors spread so; `RequestError` for an unknown word."""
        check_word("distribution", distribution, DEVIATIONS)
        return self.widths * DEVIATIONS[distribution]

    def drawn(self, count: int, distribution: str, random: np.random.Generator) -> Floats:
        """Errors (dimensions, count) at random."""
        self.deviations(distribution)
        shape = len(self.widths), count
        if distribution == "uniform":
            parts = random.uniform(-1.0, 1.0, shape)
        elif distribution == "triangular":
            parts = random.triangular(-1.0, 0.0, 1.0, shape)
        else:
            parts = random.standard_normal(shape)
            while (beyond := np.abs(parts) > CUT).any():
                parts[beyond] = random.standard_normal(int(beyond.sum()))
            parts = parts / CUT
        return self.widths[:, None] * parts


def tolerances(
    dimensions: Sequence[Dimension],
    given: Mapping[str, float | str],
    *,
    length_unit: str,
    opening: Sequence[str] = (),
    following: Sequence[str] = (),
    lengths: Sequence[str] = (),
) -> Tolerances:
    """Tolerances from half widths by name or pattern: `{"L1": 0.5, "twist_*": "0.1deg", "*": "ISO 2768-m"}`.

    Numbers are in the dimension's unit. A name counts before a pattern, and of two patterns the later. The
    classes of ISO 2768 are for lengths from 0.5 to 4000 mm, by their size. `opening` are dimensions that no
    change alone leaves assembled, `following` those that others determine. Raises `RequestError` for a name
    that does not exist, a negative width, a dimension that opens the loop or follows, and where no dimension
    gets a tolerance.
    """
    names = [dimension.name for dimension in dimensions]
    free = [name for name in names if name not in (*opening, *following)]
    if not free:
        raise RequestError(
            f"tolerance: an error of {', '.join(names[:-1])} or {names[-1]} alone would open this "
            "overconstrained loop, so that only play or bending could take it up; it has no tolerances"
        )
    if not given:
        raise RequestError(f"tolerance: none given; give one as in {_EXAMPLES}")
    widths, sources = np.zeros(len(names)), [""] * len(names)
    opened: dict[str, None] = {}
    unclassed: dict[str, list[str]] = {}
    for pattern, value in sorted(given.items(), key=lambda item: _exactly(item[0], dimensions) is not None):
        place = _exactly(pattern, dimensions)
        matched = [k for k, name in enumerate(names) if fnmatch.fnmatchcase(name, pattern)]
        matched = matched if place is None else [place]
        if not matched:
            raise RequestError(
                f"tolerance: no dimension {shown(pattern)}; {suggestion(pattern, [*lengths, *names])}"
                f"this linkage has {', '.join([*lengths, *names])}"
            )
        if place is not None and names[place] in following:
            raise RequestError(
                f"tolerance: {names[place]} follows from the others; leave its tolerance or follow out"
            )
        if place is not None and names[place] in opening:
            raise RequestError(
                f"tolerance: {names[place]}: an error of it alone would open this overconstrained loop, so "
                "that only play or bending could take it up; leave it out"
            )
        for k in matched:
            if names[k] in following:
                continue
            width = _width(pattern, value, dimensions[k], length_unit)
            if names[k] in opening:
                opened[names[k]] = None
            elif width is None:
                unclassed.setdefault(str(value), []).append(names[k])
            else:
                widths[k], sources[k] = width, str(value)
    left_out = []
    if opened:
        left_out.append(
            f"{', '.join(opened)}: an error of one alone would open this overconstrained loop, so that "
            "play or bending must take it up; left out"
        )
    for value, without in unclassed.items():
        exact = [name for name in without if not sources[names.index(name)]]
        if exact:
            left_out.append(
                f"{', '.join(exact)}: no length that {value} has a tolerance for; taken for exact"
            )
    if not widths.any():
        why = f" ({'; '.join(left_out)})" if left_out else ""
        raise RequestError(f"tolerance: no dimension has any{why}; give one as in '{free[0]}=0.5'")
    return Tolerances(tuple(dimensions), widths, tuple(sources), tuple(left_out))


def _exactly(name: str, dimensions: Sequence[Dimension]) -> int | None:
    """The place of the dimension of a name, or of a place in the file; `None` for a pattern."""
    return next((k for k, d in enumerate(dimensions) if name in (d.name, d.key)), None)


def parsed_tolerances(given: Sequence[str]) -> dict[str, float | str]:
    """Tolerances of a command line, `L1=0.5`; raises `RequestError` for one without name or value."""
    result: dict[str, float | str] = {}
    hint = f"give one as in {_EXAMPLES}"
    for word in given:
        for name, value in split_named("--tolerance", [word], "a name and a half width", hint).items():
            # the last of one name counts, after patterns that were given before it
            result.pop(name, None)
            result[name] = value
    return result


def general_tolerance(size: float, letter: str) -> float | None:
    """The permissible deviation [mm] of a length of this size [mm] in class f, m, c or v of ISO 2768-1.

    `None` where the standard has none: below 0.5 mm, above 4000 mm, and two places of the table.

        >>> general_tolerance(250, "m")
        0.5
    """
    if size < LEAST_SIZE:
        return None
    return next((width for most, width in zip(SIZES, CLASSES[letter], strict=True) if size <= most), None)


def in_class(dimension: Dimension, letter: str, length_unit: str) -> float | None:
    """The general tolerance of a dimension in its own unit; `None` for what is no length of the table."""
    if dimension.kind != "length":
        return None
    size = LENGTHS[length_unit] / LENGTHS["mm"]
    width = general_tolerance(abs(dimension.value) * size, letter)
    return None if width is None else width / size


def _width(pattern: str, value: float | str, dimension: Dimension, length_unit: str) -> float | None:
    """The half width that a value gives a dimension; `None` where a class has none for it."""
    place = f"tolerance: {pattern}={value}"
    match = _CLASS.fullmatch(value) if isinstance(value, str) else None
    if match is not None:
        letter = match[1].lower()
        if letter not in CLASSES:
            raise RequestError(
                f"{place}: {shown(match[1])} is no class of ISO 2768-1; give one of {', '.join(CLASSES)}"
            )
        return in_class(dimension, letter, length_unit)
    try:
        width = dimension.read(value) if isinstance(value, str) else float(value)
    except RequestError:
        unit = dimension.unit
        raise RequestError(
            f"{place}: not a half width for {dimension.name}; give one as in '0.1' or '0.1{unit}', "
            "or a class of ISO 2768-1 as in 'ISO 2768-m'"
        ) from None
    if not (math.isfinite(width) and width >= 0):
        raise RequestError(
            f"{place}: a half width of {width:g} is not allowed; give one that is not negative"
        )
    if dimension.positive and width >= dimension.value:
        raise RequestError(
            f"{place}: as great as the length itself, {dimension.value:g} {dimension.unit}; "
            "give a smaller one"
        )
    return width
