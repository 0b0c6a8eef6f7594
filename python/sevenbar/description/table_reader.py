"""Reads the rows of a table into the description that a TOML file would hold, each number with its place."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from sevenbar.description.table_columns import DIMENSIONS, PLACES, ROWS
from sevenbar.description.table_links import BETWEEN, ROD_WORDS, LinkCells
from sevenbar.description.toml_text import toml_text
from sevenbar.description.written import meant_kind, names_ground
from sevenbar.errors import DescriptionError, Problem, RequestError, shown
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.loop.joints import KINDS
from sevenbar.text.amounts import Kind
from sevenbar.text.grid import CellTable, grid_of_frame
from sevenbar.text.table import number

#: What marks a row as the input or the output.
MARKS = frozenset({"x", "yes", "y", "true", "1", "1.0", "input", "in", "output", "out", "drive", "driven"})
NO_MARKS = frozenset({"", "0", "0.0", "no", "n", "false", "-"})

#: Kinds of a row that is a point carried by a link.
POINT_WORDS = ("point", "tracer", "coupler point", "marker")

EXAMPLES = (
    "'joint, a [mm], alpha [deg], d [mm]' for Denavit-Hartenberg rows, "
    "'name, kind, x [mm], y [mm], z [mm], axis x, axis y, axis z' for joints as drawn, or "
    "'name, x [mm], y [mm], links' for pins"
)

_LENGTHS_OF_ROWS = ("length", "offset", "pitch")
_ANGLES_OF_ROWS = ("twist", "angle")

#: Makes a linkage of a description; the second argument is what messages call it.
Make = Callable[[Mapping[str, Any], str], Linkage]


@dataclass
class TableDescription:
    """What a table describes: `raw` as a TOML file would hold it, `note`, a sentence on how it was read.

    `places` are the places in the table of what a message may name, `problems` what is wrong in its cells.
    """

    raw: dict[str, Any]
    note: str
    places: dict[str, str] = field(default_factory=dict)
    problems: list[Problem] = field(default_factory=list)

    def drive_by(self, joint: str | None, speed: float | str | None) -> None:
        """Takes another input, or another speed, than those of the table where they are not `None`."""
        drive = {"joint": joint, "speed": speed}
        if drive := {key: value for key, value in drive.items() if value is not None}:
            self.raw["drive"] = {**self.raw.get("drive", {}), **drive}

    def linkage(self, make: Make, source: str) -> Linkage:
        """The linkage that `make` makes; `DescriptionError` with each mistake at its place in the table."""
        problems = list(self.problems)
        try:
            linkage = make(self.raw, source)
        except DescriptionError as error:
            result = [Problem(self._place(p.place), self._by_rows(p.message)) for p in error.problems]
            # of a row with a wrong cell the rest is not known
            rows = {p.place.partition(",")[0] for p in problems}
            problems += [p for p in result if re.split(r"[,:]", p.place)[0] not in rows]
        if problems:
            raise DescriptionError(problems, source)
        return linkage

    def _by_rows(self, message: str) -> str:
        """A message that names other tables of the description, by their rows."""
        return re.sub(r"\b(?:pin|joint|rod)\[\d+\]", lambda m: self.places.get(m[0], m[0]), message)

    def toml(self, source: str) -> str:
        """The description as TOML text."""
        return toml_text(self.raw, [f"{self.note[:1].upper()}{self.note[1:]}, from {source}"])

    def _place(self, place: str) -> str:
        if place in self.places:
            return self.places[place]
        if place in ("link", "joint", "pin", "rod", "point", "ground"):
            return ""
        parts = place.split(".")
        whole = (".".join(parts[:n]) for n in range(len(parts), 0, -1))
        above = next((path for path in whole if path in self.places), "")
        if not above:
            return place
        rest = place[len(above) :].lstrip(".[").rstrip("]")
        return ": ".join(filter(None, [self.places[above], rest]))


def described_frame(source: Any, ground: str = "") -> TableDescription:
    """What a data frame describes, or a mapping of names to columns."""
    if not (hasattr(source, "columns") or isinstance(source, Mapping)):
        raise RequestError(
            f"table: {shown(source)} is not a table; give the path of a CSV or Excel file, or a data frame"
        )
    try:
        grid = grid_of_frame(source)
    except (TypeError, ValueError):
        raise RequestError("table: its columns are no lists of one length; give a data frame") from None
    return described(grid, "table", "linkage", ground)


def described(grid: CellTable, source: str, name: str, ground: str = "") -> TableDescription:
    """What a table describes; `source` is what messages call it, `name` the linkage's without a title.

    `ground` is the link that stands still, where the table need not say it.
    """
    result = _Reader(grid, source, ground).description()
    result.raw["name"] = grid.title or name
    return result


def add_points(description: TableDescription, grid: CellTable, source: str) -> None:
    """Adds the points of a sheet of their own."""
    reader = _Reader(grid, source)
    reader.length_unit = str(description.raw["length_unit"])
    reader.by_name = "ground" in description.raw
    reader.places, reader.problems = description.places, [*reader.problems, *description.problems]
    points = [
        reader.point(row, len(description.raw.get("point", [])) + k) for k, row in enumerate(reader.filled)
    ]
    description.problems = reader.problems
    if points:
        description.raw["point"] = [*description.raw.get("point", []), *points]


class _Reader(LinkCells):
    """Makes the description of one table."""

    def description(self) -> TableDescription:
        """The description of the table."""
        for row in self.filled:
            if self.grid.rows[row] == self.grid.names:
                self.wrong("is the header again; leave it out", row)
        if not self.columns and not self.problems:
            self.wrong(f"the columns describe no linkage; name them as in {EXAMPLES}")
        elif not self.filled and not self.problems:
            self.wrong("has a header but no rows; give one for each joint")
        self.finish()
        described = {
            "format": 1,
            "name": "linkage",
            "length_unit": self.length_unit,
            "angle_unit": self.angle_unit,
        }
        if self.dimensions:
            result = self._of_dimensions()
        elif all(key in self.columns for key in PLACES):
            mixed = [key for key in ("twist", "offset") if key in self.columns]
            if mixed:
                both = " and ".join(shown(self.grid.names[self.columns[key]]) for key in mixed)
                self.wrong(f"{both}: of Denavit-Hartenberg rows, x, y, z of joints as drawn; leave one out")
                self.finish()
            # columns of rows say nothing of a joint as drawn, such as the radius r of a part's hole
            for key in ("length", "angle", "joint" if "name" in self.columns else ""):
                self._leave_unread(key)
            if not self.names_links:
                self._check_kinds()
            result = self._of_named() if self.names_links else self._of_joints("joint")
        elif any(key in self.columns for key in ROWS):
            # rows have their own angle, or offset of P
            self._leave_unread("value")
            result = self._of_joints("link")
        else:
            self.wrong(f"the columns describe no linkage; name them as in {EXAMPLES}")
            result = {}, ""
        if not result[0]:
            self.finish()
        raw, what = result
        width = len(self.grid.names)
        past = [self.grid.place(row) for row in self.filled if any(self.grid.rows[row][width:])]
        self.unread += [f"cells past the header in {', '.join(past)}"] if past else []
        unread = f"; not read: {', '.join(self.unread)}" if self.unread else ""
        return TableDescription({**described, **raw}, what + unread, self.places, self.problems)

    def _check_kinds(self) -> None:
        """Raises `DescriptionError` where no row has a kind of joint."""
        if any(self._kind_of(row)[0] for row in self.filled):
            return
        named = ", ".join(map(shown, self.unread))
        text = f"no kind of joint; give one of {', '.join(KINDS)} in a column 'kind'"
        self.wrong(f"{text}, or pins their links in a column 'links'" + f"; not read: {named}" * bool(named))
        self.finish()

    def _leave_unread(self, key: str) -> None:
        """Notes that a column is not read, where there is one."""
        if key in self.columns:
            self.unread.append(self.grid.names[self.columns.pop(key)])

    def _of_dimensions(self) -> tuple[dict[str, Any], str]:
        if len(self.filled) != 1:
            self.wrong(f"{len(self.filled)} rows; an RSSR has one row of dimensions")
        row = self.filled[0]
        numbers = {key: self.amount(row, key, "length") for key in DIMENSIONS if key in self.columns}
        for key in numbers:
            self.note_place(f"rssr.{key}", row, key)
        self.places["rssr"] = self.grid.place(row)
        raw: dict[str, Any] = {}
        # the joints of an RSSR have no rows of their own: the input is named
        named = self.text(row, "input") in ("crank", "rocker")
        drive = {"joint": self.text(row, "input")} if named else {}
        inputs = {key: column for key, column in self.columns.items() if key == "input" and named}
        self.columns = {key: column for key, column in self.columns.items() if key not in inputs}
        drive = {**self._drive({row: "crank"}), **drive}
        if drive:
            raw["drive"] = drive
        raw["rssr"] = {key: value for key, value in numbers.items() if value is not None}
        return raw, f"read as the dimensions of an RSSR, lengths in {self.length_unit}"

    def _of_joints(self, form: str) -> tuple[dict[str, Any], str]:
        """The rows of a table: joints, and points carried by links."""
        rows = [row for row in self.filled if not self._is_left_out(row)]
        points = [row for row in rows if self.text(row, "kind").lower() in POINT_WORDS]
        joints = self._ordered([row for row in rows if row not in points])
        names = self._names(joints)
        read = self._row if form == "link" else self._drawn
        tables = [read(row, i, names[row]) for i, row in enumerate(joints)]
        drive = self._drive({row: names[row] or f"theta_{i}" for i, row in enumerate(joints, 1)})
        raw: dict[str, Any] = {"drive": drive} if drive else {}
        raw[form] = tables
        if points:
            raw["point"] = [self.point(row, k) for k, row in enumerate(points)]
        count = f"{len(tables)} "
        if form == "link":
            if layout := next((word for row in joints if (word := self.text(row, "layout"))), ""):
                raw["layout"] = layout
            what = f"{count}classic Denavit-Hartenberg rows (Rz Tz Tx Rx, the last link is the ground)"
            return raw, f"read as {what}, lengths in {self.length_unit}, angles in {self.angle_unit}"
        left = len(self.filled) - len(rows)
        more = f"; {left} row{'s' * (left > 1)} without a kind left out" if left else ""
        return raw, f"read as {count}joints as drawn, in loop order, lengths in {self.length_unit}{more}"

    def _of_named(self) -> tuple[dict[str, Any], str]:
        """The rows of a table with links by name: pins, or joints and rods; points."""
        rows = [row for row in self.filled if not self._is_left_out(row)]
        words = {row: self.text(row, "kind").lower() for row in rows}
        points = [row for row in rows if words[row] in POINT_WORDS]
        rods = [row for row in rows if words[row] in ROD_WORDS]
        joints = self._ordered([row for row in rows if row not in (*points, *rods)])
        names = self._names([*joints, *rods])
        axes = [key for key in self.columns if key.startswith("axis")]
        turning = all(self._kind_of(row)[0] in ("", "R") for row in joints)
        form = "pin" if turning and not axes and not rods else "joint"
        if form == "pin" and not points:
            self._leave_unread("z")
        read = self._pin if form == "pin" else self._between
        raw: dict[str, Any] = {form: [read(row, i, names[row]) for i, row in enumerate(joints)]}
        if rods:
            raw["rod"] = [self._rod(row, i, names[row]) for i, row in enumerate(rods)]
        if points:
            raw["point"] = [self.point(row, k) for k, row in enumerate(points)]
        word = "pin" if form == "pin" else "theta"
        ends = {row: names[row] or f"{word}_{i}" for i, row in enumerate(joints, 1)}
        drive = self._drive(ends)
        # a pin of several hinges drives by its first
        several = [ends[row] for row in joints if form == "pin" and len(self.links_of(row)) > 2]
        drive |= {key: f"{end}.1" for key, end in drive.items() if key != "speed" and end in several}
        tables = [*raw[form], *raw.get("rod", [])]
        head: dict[str, Any] = {"ground": ground} if (ground := self.ground_of(tables)) else {}
        head |= {"drive": drive} if drive else {}
        count = "pins of a planar linkage" if form == "pin" else "joints between links by name"
        more = f", {len(rods)} rod{'s' * (len(rods) > 1)}" if rods else ""
        what = f"read as {len(raw[form])} {count}{more}, lengths in {self.length_unit}"
        return head | raw, f"{what}; {ground} stands still"

    def _pin(self, row: int, i: int, name: str) -> dict[str, Any]:
        """A pin of a planar linkage."""
        place = f"pin[{i + 1}]"
        self._has_one_place(row)
        table = self._head(row, place, name, "kind", "", "kind")
        table["at"] = self.vector(row, "", "length", "xy")
        self.places[f"{place}.at"] = self.span(row, "")
        return table | {"links": self.joined(row, f"{place}.links")}

    def _between(self, row: int, i: int, name: str) -> dict[str, Any]:
        """A joint as drawn between two links by name."""
        return self._drawn(row, i, name) | {"between": self.joined(row, f"joint[{i + 1}].between", 2)}

    def _rod(self, row: int, i: int, name: str) -> dict[str, Any]:
        """A link with a ball at each end."""
        place = f"rod[{i + 1}]"
        table = self._head(row, place, name, "kind", "", "kind")
        first, second = self.vector(row, "", "length"), [0.0, 0.0, 0.0]
        if self._second_place(row):
            second = self.vector(row, "end ", "length")
        else:
            self.wrong("is a rod without its other end; give it in columns x 2, y 2, z 2", row)
        table["at"] = [first, second]
        self.places[f"{place}.at"] = self.span(row, "end ")
        return table | {"between": self.joined(row, f"{place}.between", 2)}

    def _second_place(self, row: int) -> str:
        """What a row has in the columns of the other end of a rod."""
        return "".join(self.text(row, f"end {letter}") for letter in "xyz")

    def _has_one_place(self, row: int) -> None:
        """Notes a second place at a joint."""
        if self._second_place(row):
            self.wrong("is a joint with two places; leave x 2, y 2, z 2 empty, or give it the kind rod", row)

    def _is_left_out(self, row: int) -> bool:
        """A row without kind and order, where the others have an order: axes of a part that are no joints."""
        if "order" not in self.columns or not any(self.text(other, "order") for other in self.filled):
            return False
        return not self.text(row, "order") and self.text(row, "kind").lower() not in POINT_WORDS

    def _ordered(self, rows: Sequence[int]) -> list[int]:
        if not any(self.text(row, "order") for row in rows):
            return list(rows)
        places: dict[int, float] = {}
        for row in rows:
            value = number(self.text(row, "order"))
            if value is None or not math.isfinite(value) or value in places.values():
                given = shown(self.text(row, "order"))
                self.wrong(
                    f"{given} is no place in the loop; give 1, 2, 3 .., each once", row, self.columns["order"]
                )
            else:
                places[row] = value
        return sorted(places, key=lambda row: places[row])

    def _names(self, rows: Sequence[int]) -> dict[int, str]:
        """The joints' names: of their column, or of `joint` where that holds neither numbers nor kinds."""
        if "name" in self.columns:
            return {row: self.text(row, "name") for row in rows}
        words = [self.text(row, "joint") for row in rows]
        counts = [number(word) for word in words]
        if words and None not in counts and not math.isnan(sum(count or 0.0 for count in counts)):
            first = counts[0] or 0.0
            if counts != [first + i for i in range(len(rows))]:
                self.wrong(
                    "its numbers are not in order; give the rows in loop order", None, self.columns["joint"]
                )
            return dict.fromkeys(rows, "")
        return dict.fromkeys(rows, "") if self._holds_kinds else dict(zip(rows, words, strict=True))

    @cached_property
    def _holds_kinds(self) -> bool:
        """Whether a column `joint` holds kinds: letters, or words for a kind alone."""
        words = [self.text(row, "joint") for row in self.filled]
        return "kind" not in self.columns and all(len(word) <= 1 or _kind(word) for word in words)

    def _kind_of(self, row: int) -> tuple[str, str]:
        """The kind of a row's joint as written, as a letter where it is known, and the column's key."""
        if word := self.text(row, "kind"):
            return _kind(word) or word, "kind"
        word = self.text(row, "joint")
        if self._holds_kinds and word and number(word) is None:
            return _kind(word) or word, "joint"
        return "", "kind"

    def _row(self, row: int, i: int, name: str) -> dict[str, Any]:
        """A Denavit-Hartenberg row."""
        kind, key = self._kind_of(row)
        place = f"link[{i + 1}]"
        table: dict[str, Any] = self._head(row, place, name, "joint", kind, key)
        known = KINDS.get(kind or "R")
        moving = known.moving_key if known and known.row_keys else ""
        for column in (*_LENGTHS_OF_ROWS, *_ANGLES_OF_ROWS):
            if column not in self.columns:
                continue
            self.note_place(f"{place}.{column}", row, column)
            what: Kind = "angle" if column in _ANGLES_OF_ROWS else "pitch" if column == "pitch" else "length"
            # the variable of a row has a word, such as theta_1
            if column == moving and number(self.text(row, column)) is None:
                continue
            value = self.amount(row, column, what)
            idle = known is not None and column not in known.row_keys
            if value is not None and not (idle and value == 0):
                table[column] = value
        return table

    def _drawn(self, row: int, i: int, name: str) -> dict[str, Any]:
        """A joint as drawn."""
        kind, key = self._kind_of(row)
        place = f"joint[{i + 1}]"
        if not kind:
            self.wrong(f"no kind of joint; give one of {', '.join(KINDS)}", row, self.columns.get("kind"))
        table: dict[str, Any] = self._head(row, place, name, "kind", kind, key)
        self._has_one_place(row)
        table["at"] = self.vector(row, "", "length")
        for key, wanted in (("axis", "axis "), ("axis 2", "axis 2 ")):
            if any(self.text(row, f"{wanted}{letter}") for letter in "xyz"):
                table[key] = self.vector(row, wanted, "number")
                self.places[f"{place}.{key}"] = self.span(row, wanted)
        if "axis 2" in table:
            table["axes"] = [table.pop("axis", [0.0, 0.0, 0.0]), table.pop("axis 2")]
            self.places[f"{place}.axes"] = self.span(row, "axis ")
        if "pitch" in self.columns and (pitch := self.amount(row, "pitch", "pitch")) is not None:
            table["pitch"] = pitch
            self.note_place(f"{place}.pitch", row, "pitch")
        if "longer" in self.columns and (longer := self.amount(row, "longer", "length")) is not None:
            table["longer"] = longer
            self.note_place(f"{place}.longer", row, "longer")
        if self.text(row, "value"):
            self.note_place(f"{place}.value", row, "value")
            moves: Kind = "length" if kind == "P" else "angle"
            if (value := self.amount(row, "value", moves)) is not None:
                table["value"] = value
        if kind in KINDS and "axis" in KINDS[kind].drawn_keys and "axis" not in table:
            self.wrong(f"no axis; a joint of kind {kind} needs one, in columns axis x, axis y, axis z", row)
        # a ball has no axis, whatever a list of axes holds
        if kind in KINDS and not KINDS[kind].drawn_keys:
            table.pop("axis", None)
        self.places[f"{place}.at"] = self.span(row, "")
        return table

    def _head(self, row: int, place: str, name: str, kind_key: str, kind: str, key: str) -> dict[str, Any]:
        self.places[place] = self.grid.place(row)
        table: dict[str, Any] = {"name": name} if name else {}
        if named := next((head for head in ("name", "joint") if head in self.columns), ""):
            self.note_place(f"{place}.name", row, named)
        if kind:
            table[kind_key] = kind
            self.note_place(f"{place}.{kind_key}", row, key)
        return table

    def point(self, row: int, k: int) -> dict[str, Any]:
        """A named point carried by a link."""
        place = f"point[{k + 1}]"
        letters = "uvw" if all(letter in self.columns for letter in "uvw") else "xyz"
        self.places[place] = self.grid.place(row)
        for key in ("name", "link"):
            if key in self.columns:
                self.note_place(f"{place}.{key}", row, key)
        name = self.text(row, "name") or self.text(row, "joint") or f"P{k + 1}"
        if self.by_name or self.names_links:
            carrier = self.text(row, "link") or " ".join(self.links_of(row))
            if not carrier:
                self.wrong(
                    "names no link; give the one that carries the point", row, self.columns.get("link")
                )
            if "link" not in self.columns:
                self.note_place(
                    f"{place}.link", row, next(k for k in ("between", *BETWEEN) if k in self.columns)
                )
            return {"name": name, "link": carrier, "at": self.vector(row, "", "length")}
        link = number(self.text(row, "link"))
        whole = link is not None and math.isfinite(link) and link.is_integer()
        if not whole:
            given = shown(self.text(row, "link"))
            self.wrong(
                f"{given} is not a link; give its number, counted from 1", row, self.columns.get("link")
            )
        at = self.vector(row, "", "length", letters)
        return {"name": name, "link": int(link or 1) if whole else 1, "at": at}

    def _is_marked(self, row: int, key: str) -> bool:
        return self.text(row, key).lower() not in NO_MARKS

    def _drive(self, names: Mapping[int, str]) -> dict[str, Any]:
        """Input, output and speed as marked."""
        drive: dict[str, Any] = {}
        for key, target in (("input", "joint"), ("output", "output")):
            if key not in self.columns:
                continue
            for row in self.filled:
                if row not in names and self._is_marked(row, key):
                    what = f"is marked and no joint; mark the {key} in a joint's row"
                    self.wrong(what, row, self.columns[key])
            marked = [row for row in names if self._is_marked(row, key)]
            for row in marked[1:]:
                self.wrong(f"is a second {key}; mark one row", row, self.columns[key])
            if not marked:
                continue
            word = self.text(marked[0], key)
            # a freedom of a joint that has several, as `cross.2`
            owned = re.fullmatch(rf"{re.escape(names[marked[0]])}\.\d", word) is not None
            if key == "input" and word.lower() in ("output", "out"):
                drive["output"] = names[marked[0]]
                continue
            drive[target] = word if owned else names[marked[0]]
            self.note_place(f"drive.{target}", marked[0], key)
            if word.lower() in MARKS or owned:
                continue
            if key == "input" and re.match(r"[-+]?[\d.]", word):
                drive["speed"] = word
                self.places["drive.speed"] = self.places[f"drive.{target}"]
            else:
                self.wrong(f"{shown(word)} marks nothing; write x, or a speed as in '60 rpm'", marked[0],
                            self.columns[key])  # fmt: skip
        spoken = [row for row in names if self.text(row, "speed")]
        for row in spoken[:1]:
            unit = self.unit_of_column(self.columns["speed"])
            drive["speed"] = f"{self.text(row, 'speed')} {unit}".strip()
            self.note_place("drive.speed", row, "speed")
        for row in spoken[1:]:
            self.wrong("is a second speed; give one, in the row of the input", row, self.columns["speed"])
        return drive


def _kind(word: str) -> str:
    """The letter of a kind of joint; the ground's word as it is; empty for other words."""
    if word.upper() in KINDS:
        return word.upper()
    return word if names_ground(word) and len(word) > 1 else meant_kind(word)
