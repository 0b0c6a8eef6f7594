"""The description that is being shaped: its dimensions, what changes it, and its way back to a file."""

from __future__ import annotations

import copy
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from sevenbar import schema
from sevenbar.errors import RequestError, shown
from sevenbar.files import loads
from sevenbar.forms import from_form
from sevenbar.linkage import Linkage
from sevenbar.units import ANGLES, TURNING_SPEEDS, amount, length_sizes

#: A place in a description: keys of tables, and counts from 0 in lists.
Place = tuple[str | int, ...]

#: Keys of the numbers in a row of Denavit-Hartenberg, by its joint's kind.
ROW_KEYS = {
    "R": ("length", "offset", "twist"),
    "P": ("length", "angle", "twist"),
    "H": ("length", "offset", "twist", "pitch"),
}


@dataclass(frozen=True)
class Dimension:
    """A number of the description that can be changed.

    `value` and `unit` are the file's; `group` is what it belongs to; `follows` where the file leaves it out
    and it follows from the others.
    """

    place: Place
    label: str
    group: str
    unit: str
    value: float
    positive: bool = False
    follows: bool = False

    @property
    def key(self) -> str:
        """Its place as messages tell it: `rssr.L1`, `link[2].twist`, `joint[1].at[3]`."""
        parts = [f"[{part + 1}]" if isinstance(part, int) else f".{part}" for part in self.place]
        return "".join(parts).lstrip(".")

    def read(self, text: str) -> float:
        """The value that a person wrote, in the dimension's unit: "250", "25 cm", "30deg".

        Raises `RequestError` for a text that is no finite number with a unit that fits.
        """
        sizes, what, hint = self._sizes
        value = amount(text, sizes, self.unit)
        if value is None:
            comma = " (a decimal point, not a comma)" if "," in text else ""
            given = shown(text.strip())
            raise RequestError(f"{self.key}: {given} is not a finite {what}; give {hint}{comma}")
        return value

    @property
    def _sizes(self) -> tuple[dict[str, float], str, str]:
        """Sizes of the units that fit, what a value is, and examples."""
        length, _, per = self.unit.partition("/")
        if self.unit == "":
            return {"": 1.0}, "number", "a number, as in 1.5"
        if self.unit in ANGLES:
            sizes = {unit: size / ANGLES[self.unit] for unit, size in ANGLES.items()}
            return sizes | {self.unit: 1.0}, "angle", "30, 30deg or 0.5rad"
        if self.unit in TURNING_SPEEDS:
            return TURNING_SPEEDS, "speed", f"10, 10 {self.unit} or 60 rpm"
        if per:
            sizes = {f"{unit}/{per}": size for unit, size in length_sizes(length).items()}
            return sizes, "speed" if per == "s" else "pitch", f"10 or 10 {self.unit}"
        return length_sizes(length), "length", f"250 or 250{length}"


@dataclass(frozen=True, eq=False)
class Draft:
    """A description as it stands now: the text it came from, and the tables and numbers it has become."""

    text: str
    raw: Mapping[str, Any]
    source: str

    @staticmethod
    def of(text: str, source: str) -> Draft:
        """The draft of a TOML text; `source` is its name in messages. Raises `DescriptionError`."""
        loads(text, source)  # with all that is wrong in it
        return Draft(text, tomllib.loads(text), source)

    def as_opened(self) -> Draft:
        """The draft as its text has it."""
        return replace(self, raw=tomllib.loads(self.text))

    @cached_property
    def linkage(self) -> Linkage:
        """The linkage described; raises `DescriptionError`."""
        return from_form(schema.check(self.raw, source=""))

    def with_value(self, place: Place, value: object) -> Draft:
        """The draft with a value at a place, whose tables are made where the file has none."""
        raw = copy.deepcopy(dict(self.raw))
        table: Any = raw
        for part in place[:-1]:
            if isinstance(part, str) and part not in table:
                table[part] = {}
            table = table[part]
        table[place[-1]] = value
        return replace(self, raw=raw)

    def with_point(self, name: str, link: int, at: Sequence[float]) -> Draft:
        """The draft with one more named point."""
        point = {"name": name, "link": link, "at": [_plain(value) for value in at]}
        points = [*self.raw.get("point", ()), point]
        return replace(self, raw={**self.raw, "point": points})

    def without_point(self, index: int) -> Draft:
        """The draft without the point of this place among its points, counted from 0."""
        kept = [point for i, point in enumerate(self.raw.get("point", ())) if i != index]
        others = {key: value for key, value in self.raw.items() if key != "point"}
        return replace(self, raw=others | ({"point": kept} if kept else {}))

    @cached_property
    def dimensions(self) -> tuple[Dimension, ...]:
        """Every number that can be changed, in the order of the file."""
        linkage = self.linkage
        length, angle = linkage.length_unit, str(self.raw.get("angle_unit", "deg"))
        found: list[Dimension] = []
        for key in ("M", "N", "L1", "L2", "L3", "D") if "rssr" in self.raw else ():
            given = self.raw["rssr"].get(key)
            value = linkage.dimensions[key] if given is None else float(given)
            # D left out is 0; L2 left out follows from the others
            follows = given is None and key == "L2"
            found.append(Dimension(("rssr", key), key, "dimensions", length, value, key[0] == "L", follows))
        units = {"twist": angle, "angle": angle, "pitch": f"{length}/turn"}
        joints = linkage.joints
        for i, row in enumerate(self.raw.get("link", ())):
            group = f"link {i + 1}, after {joints[i].name} ({joints[i].kind})"
            for key in ROW_KEYS[joints[i].kind]:
                unit = units.get(key, length)
                found.append(Dimension(("link", i, key), key, group, unit, float(row.get(key, 0.0))))
        for i, table in enumerate(self.raw.get("joint", ())):
            found += _of_drawn(i, table, f"{joints[i].name} ({joints[i].kind})", length)
        letters = "uvw" if "link" in self.raw else "xyz"
        for i, table in enumerate(self.raw.get("point", ())):
            found += _vector(("point", i, "at"), table["at"], letters, f"point {table['name']}", length)
        column = linkage.columns.index(linkage.drive.joint)
        speed = "rad/s" if linkage.column_kinds[column] == "turn" else f"{length}/s"
        found.append(Dimension(("drive", "speed"), "speed", "drive", speed, linkage.drive.speed))
        return tuple(found)

    def written(self, dimension: Dimension, value: float) -> object:
        """What stands in the file for a value of a dimension: a speed with its unit, else the number."""
        number = _plain(value)
        return f"{number!r} {dimension.unit}" if dimension.place == ("drive", "speed") else number

    def toml(self) -> str:
        """The draft as TOML: the text it came from with its comments, and the changed values in place."""
        import tomlkit

        # tables out of order are put in order by a change only
        if tomllib.loads(self.text) == self.raw:
            return self.text
        document: Any = tomlkit.parse(self.text)
        _settle(document, self.raw)
        written = tomlkit.dumps(document)
        if self.text.count("\r\n") == self.text.count("\n"):
            written = written.replace("\r\n", "\n").replace("\n", "\r\n")
        # what is written must be what is shown
        return written if _says(written, self.raw) else tomlkit.dumps(self.raw)


def _plain(value: float) -> float | int:
    """A number as people write it, without the point where it is whole."""
    return int(value) if abs(value) < 1e15 and value.is_integer() else value


def _of_drawn(index: int, table: Mapping[str, Any], group: str, length: str) -> list[Dimension]:
    """The numbers of a joint as drawn."""
    place = ("joint", index)
    found = _vector((*place, "at"), table["at"], "xyz", group, length)
    if "axis" in table:
        found += _vector((*place, "axis"), table["axis"], ("axis x", "axis y", "axis z"), group, "")
    for which, axis in enumerate(table.get("axes", ())):
        letters = [f"axis {which + 1} {letter}" for letter in "xyz"]
        found += _vector((*place, "axes", which), axis, letters, group, "")
    if "pitch" in table:
        found.append(Dimension((*place, "pitch"), "pitch", group, f"{length}/turn", float(table["pitch"])))
    return found


def _vector(
    place: Place, values: Sequence[float], letters: Sequence[str], group: str, unit: str
) -> list[Dimension]:
    return [
        Dimension((*place, axis), letter, group, unit, float(value))
        for axis, (letter, value) in enumerate(zip(letters, values, strict=True))
    ]


def _says(text: str, raw: Mapping[str, Any]) -> bool:
    """Whether a TOML text says what `raw` says."""
    try:
        return tomllib.loads(text) == raw
    except tomllib.TOMLDecodeError:
        return False


def _settle(table: Any, wanted: Mapping[str, Any]) -> None:
    """Makes a table of a TOML document say what `wanted` says, touching nothing that says it already."""
    import tomlkit

    for key in [key for key in table if key not in wanted]:
        del table[key]
    for key, value in wanted.items():
        if key not in table and _tables(value):
            rows = tomlkit.aot()
            _settle_list(rows, value)
            table.append(key, rows)
        elif key in table and isinstance(value, Mapping):
            _settle(table[key], value)
        elif key in table and isinstance(value, list):
            _settle_list(table[key], value)
        elif key not in table or table[key] != value:
            table[key] = value


def _settle_list(rows: Any, wanted: Sequence[Any]) -> None:
    """The same for a list, whose entries keep their comments when others go."""
    import tomlkit

    while len(rows) > len(wanted):
        unlike = (i for i, (row, value) in enumerate(zip(rows, wanted, strict=False)) if row != value)
        del rows[next(unlike, len(wanted))]
    for i, value in enumerate(wanted):
        if i >= len(rows):
            new: Any = value
            if isinstance(value, Mapping):
                in_line = isinstance(rows, tomlkit.items.Array)
                new = tomlkit.inline_table() if in_line else tomlkit.table()
                new.update(value)
                if not in_line:
                    new.trivia.indent = "\n"
            rows.append(new)
        elif isinstance(value, Mapping):
            _settle(rows[i], value)
        elif isinstance(value, list):
            _settle_list(rows[i], value)
        elif rows[i] != value:
            rows[i] = value


def _tables(value: object) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(row, Mapping) for row in value)
