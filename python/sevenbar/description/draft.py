"""A description that is being shaped: its dimensions by name, what changes it, and its way back to a file."""

from __future__ import annotations

import copy
import tomllib
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Literal

from sevenbar.description.files import loads
from sevenbar.description.forms import from_description
from sevenbar.errors import MissingExtraError, RequestError, shown, suggestion
from sevenbar.kinematics.geometry import Joint
from sevenbar.kinematics.linkage import Linkage
from sevenbar.text.units import ANGLES, TURNING_SPEEDS, amount, length_sizes

#: A place in a description: keys of tables, and counts from 0 in lists.
Place = tuple[str | int, ...]


@dataclass(frozen=True)
class Dimension:
    """A number of the description that can be changed.

    `name` is its own among all: "L1"; "length_2"; "crank.axis_x"; "P.u". `value` and `unit` are the file's;
    `group` is what it belongs to; `follows` where the file leaves it out and it follows from the others.
    """

    name: str
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

    @property
    def column(self) -> str:
        """Its name in tables, with the unit: `L1_mm`, `twist_2_deg`."""
        return f"{self.name}_{self.unit.replace('/', '_')}" if self.unit else self.name

    @property
    def kind(self) -> Literal["length", "angle", "pitch", "number", "speed"]:
        """What its value is."""
        if "/" in self.unit or self.unit == "rpm":
            return "pitch" if self.unit.endswith("turn") else "speed"
        if self.unit in ANGLES:
            return "angle"
        return "length" if self.unit else "number"

    @property
    def scale(self) -> float:
        """The size of its unit beside the one that is carried: radian, length unit."""
        return ANGLES.get(self.unit, 1.0)

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
    """A description as it stands now: the text it came from, and the tables and numbers it has become.

    >>> import sevenbar as sb
    >>> draft = Draft.of_linkage(sb.load("rssr"))
    >>> draft.with_values({"L1": 260.0}).linkage.dimensions["L1"]
    260.0
    """

    text: str
    raw: Mapping[str, Any]
    source: str

    @staticmethod
    def of(text: str, source: str) -> Draft:
        """The draft of a TOML text; `source` is its name in messages. Raises `DescriptionError`."""
        loads(text, source)  # with all that is wrong in it
        return Draft(text, tomllib.loads(text), source)

    @staticmethod
    def of_linkage(linkage: Linkage) -> Draft:
        """The draft of a linkage's own description, which has no text with comments."""
        if not linkage.description:
            raise RequestError(
                f"linkage: '{linkage.name}' was made without a description; "
                "make it by load, rssr, from_dh or from_axes"
            )
        return Draft("", linkage.description, linkage.name)

    def as_opened(self) -> Draft:
        """The draft as its text has it."""
        return replace(self, raw=tomllib.loads(self.text))

    @cached_property
    def linkage(self) -> Linkage:
        """The linkage described; raises `DescriptionError`."""
        return from_description(self.raw)

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

    def dimension(self, name: str) -> Dimension:
        """The dimension of a name, or of a place as in a file (`link[2].twist`).

        Raises `RequestError` where there is none.
        """
        for dimension in self.dimensions:
            if name in (dimension.name, dimension.key):
                return dimension
        known = [dimension.name for dimension in self.dimensions]
        raise RequestError(
            f"dimension: {shown(name)} is not a dimension of {shown(self.source)}; "
            f"{suggestion(name, known)}give one of {', '.join(known)}"
        )

    def with_values(self, values: Mapping[str, float]) -> Draft:
        """The draft with other values of dimensions, by name, each in the file's unit."""
        draft = self
        for name, value in values.items():
            dimension = self.dimension(name)
            draft = draft.with_value(dimension.place, self.written(dimension, float(value)))
        return draft

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
        for key in ("M", "N", "L1", "L2", "L3", "D") if linkage.form == "rssr" else ():
            given = self.raw["rssr"].get(key)
            value = linkage.dimensions[key] if given is None else float(given)
            # D left out is 0; L2 left out follows from the others
            follows = given is None and key == "L2"
            place = ("rssr", key)
            positive = key[0] == "L"
            found.append(Dimension(key, place, key, "dimensions", length, value, positive, follows))
        units = {"twist": angle, "angle": angle, "pitch": f"{length}/turn"}
        joints = linkage.joints
        for i, row in enumerate(self.raw.get("link", ())):
            group = f"link {i + 1}, after {joints[i].name} ({joints[i].kind})"
            for key in joints[i].row.row_keys:
                unit = units.get(key, length)
                value = float(row.get(key, 0.0))
                found.append(Dimension(f"{key}_{i + 1}", ("link", i, key), key, group, unit, value))
        for i, table in enumerate(self.raw.get("joint", ())):
            found += _of_drawn(i, table, joints[i], length)
        letters = "uvw" if linkage.form == "rows" else "xyz"
        for i, table in enumerate(self.raw.get("point", ())):
            name = table["name"]
            found += _vector(("point", i, "at"), table["at"], letters, (name, f"point {name}"), length)
        column = linkage.columns.index(linkage.drive.joint)
        speed = "rad/s" if linkage.column_kinds[column] == "turn" else f"{length}/s"
        found.append(Dimension("speed", ("drive", "speed"), "speed", "drive", speed, linkage.drive.speed))
        # a point may have the name of a joint
        taken = Counter(dimension.name for dimension in found)
        return tuple(replace(d, name=d.key) if taken[d.name] > 1 else d for d in found)

    def written(self, dimension: Dimension, value: float) -> object:
        """What stands in the file for a value of a dimension: a speed with its unit, else the number."""
        number = _plain(value)
        return f"{number!r} {dimension.unit}" if dimension.place == ("drive", "speed") else number

    def toml(self) -> str:
        """The draft as TOML: the text it came from with its comments, and the changed values in place."""
        try:
            import tomlkit
        except ImportError:
            raise MissingExtraError(
                "writing a linkage file needs tomlkit; install it with: pip install 'sevenbar[design]'"
            ) from None
        if not self.text:
            return tomlkit.dumps(self.raw)
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


def _of_drawn(index: int, table: Mapping[str, Any], joint: Joint, length: str) -> list[Dimension]:
    """The numbers of a joint as drawn."""
    place = ("joint", index)
    whose = (joint.name, f"{joint.name} ({joint.kind})")
    found = _vector((*place, "at"), table["at"], "xyz", whose, length)
    if "axis" in table:
        found += _vector((*place, "axis"), table["axis"], ("axis x", "axis y", "axis z"), whose, "")
    for which, axis in enumerate(table.get("axes", ())):
        letters = [f"axis {which + 1} {letter}" for letter in "xyz"]
        found += _vector((*place, "axes", which), axis, letters, whose, "")
    if "pitch" in table:
        name, group = whose
        unit, pitch = f"{length}/turn", float(table["pitch"])
        found.append(Dimension(f"{name}.pitch", (*place, "pitch"), "pitch", group, unit, pitch))
    return found


def _vector(
    place: Place, values: Sequence[float], labels: Sequence[str], whose: tuple[str, str], unit: str
) -> list[Dimension]:
    """The numbers of a vector; `whose`: the name of its owner, and what the owner is called among others."""
    name, group = whose
    return [
        Dimension(f"{name}.{label.replace(' ', '_')}", (*place, axis), label, group, unit, float(value))
        for axis, (label, value) in enumerate(zip(labels, values, strict=True))
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
