"""A description that is being shaped: its dimensions by name, what changes it, and its way back to a file."""

from __future__ import annotations

import copy
import math
import tomllib
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from sevenbar.description.files import checked, toml_tables
from sevenbar.description.forms import from_description
from sevenbar.description.links import in_loop_order
from sevenbar.description.load_tables import with_rows
from sevenbar.description.toml_text import is_tables
from sevenbar.errors import RequestError, of_extra, shown, suggestion
from sevenbar.kinematics.linkage import Linkage
from sevenbar.kinematics.loop.geometry import Loop, Place
from sevenbar.kinematics.loop.single import check_single
from sevenbar.kinematics.numbers.dimensions import (
    Dimension,
    description_of,
    dimensions_of,
    lengths_of,
    masses_of,
)

#: A length of a drawing is the one that the report prints, up to rounding [share of it].
AS_PRINTED = 1e-9

#: Characters of a line from which rows of a load's table are written one below the other.
LONGEST_ROWS = 110


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
    #: Names of dimensions that the file leaves out and that are held at the value they have there.
    held: tuple[str, ...] = ()
    #: The closure error up to which redundant constraints of its linkages agree; `None` for the usual one.
    agree: float | None = None

    @staticmethod
    def of(text: str, source: str, *, agree: float | None = None) -> Draft:
        """The draft of a TOML text; `source` is its name in messages. Raises `DescriptionError`."""
        return replace(Draft.of_tables(toml_tables(text, source), source, agree=agree), text=text)

    @staticmethod
    def of_tables(raw: Mapping[str, Any], source: str, *, agree: float | None = None) -> Draft:
        """The draft of a file's tables; files that they name lie in the folder of `source`.

        Raises `DescriptionError`.
        """
        checked(raw, source)  # with all that is wrong in it
        return Draft("", _opened(raw, source), source, agree=agree)

    @staticmethod
    def of_linkage(linkage: Loop) -> Draft:
        """The draft of a linkage's own description, which has no text with comments."""
        return Draft("", description_of(linkage), linkage.name, agree=linkage.agree)

    @staticmethod
    def made(name: str, length_unit: str, **tables: Any) -> Draft:
        """The draft of tables that no file has; its angles are in degrees."""
        head = {"format": 1, "name": name, "length_unit": length_unit, "angle_unit": "deg"}
        return Draft("", {**head, **tables}, name)

    def as_opened(self) -> Draft:
        """The draft as its text has it."""
        return replace(self, raw=_opened(tomllib.loads(self.text), self.source))

    @cached_property
    def linkage(self) -> Linkage:
        """The linkage described; raises `DescriptionError`."""
        return from_description(self.raw).agreeing(self.agree)

    def with_value(self, place: Place, value: object) -> Draft:
        """The draft with a value at a place, whose tables are made where the file has none."""
        return self.with_places({place: value})

    def with_places(self, values: Mapping[Place, object]) -> Draft:
        """The draft with values at places, whose tables are made where the file has none."""
        raw = copy.deepcopy(dict(self.raw))
        for place, value in values.items():
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
        for dimension in (*self.dimensions, *self.lengths, *self.masses):
            if name in (dimension.name, dimension.key) or (dimension.drawn and name == dimension.label):
                return dimension
        known = [dimension.name for dimension in (*self.lengths, *self.dimensions)]
        if why := self._no_length(name):
            raise RequestError(f"dimension: {shown(name)} {why}; give one of {', '.join(known)}")
        raise RequestError(
            f"dimension: {shown(name)} is not a dimension of {shown(self.source)}; "
            f"{suggestion(name, known)}give one of {', '.join(known)}"
        )

    def _no_length(self, name: str) -> str:
        """Why a name that a report has is no dimension; empty for other names."""
        if self.linkage.form != "drawn" or (bar := self.linkage.as_four_bar()) is None:
            return ""
        printed = {*bar.links, *(["offset"] if bar.offset is not None else [])}
        if name.replace("_", " ") not in printed:
            return ""
        if bar.kind == "spherical":
            return "is an arc, which follows from the axes as drawn"
        return "follows from where joints are drawn"

    def with_values(self, values: Mapping[str, float]) -> Draft:
        """The draft with other values of dimensions, by name, each in the file's unit."""
        own = [(self.dimension(name), float(value)) for name, value in values.items()]
        return self.with_places({d.place: self.written(d, value) for d, value in own})

    def holding(self, follow: Collection[str] = ()) -> Draft:
        """The draft whose dimensions stay as they are while others change, except those that `follow`.

        A file that leaves L2 out means the rod that closes its pose, and a rod does not grow with the crank:
        its length is written. Raises `RequestError` for a name in `follow` that the file gives, and
        `NotCoveredError` for a net.

            >>> import sevenbar as sb
            >>> draft = Draft.of_linkage(sb.load("rssr"))
            >>> for chosen in (draft.holding(), draft.holding(["L2"])):
            ...     print(round(chosen.with_values({"L1": 275.0}).linkage.dimensions["L2"], 3))
            997.497
            986.471
        """
        check_single(self.linkage)
        left_out = {dimension.name: dimension for dimension in self.dimensions if dimension.follows}
        for name in follow:
            if name not in left_out:
                raise RequestError(self._no_follower(name, list(left_out)))
        result = self
        for name, dimension in left_out.items():
            if name not in follow:
                result = replace(
                    result.with_value(dimension.place, dimension.value), held=(*result.held, name)
                )
        return result

    def giving(self, names: Collection[str]) -> Draft:
        """The draft in which those of its `lengths` that are named are dimensions, as any other number.

        >>> import sevenbar as sb
        >>> bar = [("R", (0, 0)), ("R", (0, 40)), ("R", (80, 80)), ("R", (90, 0))]
        >>> joints = [{"kind": kind, "at": [*at, 0], "axis": [0, 0, 1]} for kind, at in bar]
        >>> draft = Draft.of_linkage(sb.from_axes(joints)).giving(["input_link"])
        >>> [d.name for d in draft.dimensions if "." not in d.name], [d.name for d in draft.lengths]
        (['input_link', 'speed'], ['coupler', 'output_link'])
        """
        result = {d.place: 0 for d in self.lengths if d.name in names or d.label in names}
        return self.with_places(result) if result else self

    def _no_follower(self, name: str, left_out: Sequence[str]) -> str:
        known = {dimension.name: dimension for dimension in self.dimensions}
        if name not in known:
            why = "is not a dimension"
        else:
            why = f"is given, {known[name].value:g} {known[name].unit}".rstrip() + ", so it stays"
        hint = f"give {' or '.join(left_out)}" if left_out else "the file leaves none out, so do not give it"
        return f"follow: {shown(name)} {why}; {hint}"

    def with_point(self, name: str, link: int, at: Sequence[float]) -> Draft:
        """The draft with one more named point."""
        carrier = link if self.linkage.net is None else self.linkage.link_name(link)
        point = {"name": name, "link": carrier, "at": [plain_number(value) for value in at]}
        points = [*self.raw.get("point", ()), point]
        return replace(self, raw={**self.raw, "point": points})

    def without_point(self, index: int) -> Draft:
        """The draft without the point of this place among its points, counted from 0."""
        selected = [point for i, point in enumerate(self.raw.get("point", ())) if i != index]
        others = {key: value for key, value in self.raw.items() if key != "point"}
        return replace(self, raw=others | ({"point": selected} if selected else {}))

    @cached_property
    def dimensions(self) -> tuple[Dimension, ...]:
        """Every number that can be changed and moves something, in the order of the file."""
        return dimensions_of(description_of(self.linkage), self.linkage)

    @cached_property
    def lengths(self) -> tuple[Dimension, ...]:
        """The lengths that a report gives of a drawing, without those that are dimensions already."""
        linkage = self.linkage
        if linkage.form != "drawn" or linkage.net is not None:
            return ()
        every = lengths_of(description_of(linkage), linkage)
        if linkage.kind != "RSSR":
            bar = linkage.as_four_bar()
            printed = {} if bar is None or bar.kind == "spherical" else bar.links
            # as printed: joints of more freedoms may be drawn aside
            every = tuple(
                d for d in every if math.isclose(printed.get(d.label, math.nan), d.value, rel_tol=AS_PRINTED)
            )
        known = {dimension.place for dimension in self.dimensions}
        return tuple(d for d in every if d.place not in known)

    @cached_property
    def masses(self) -> tuple[Dimension, ...]:
        """The masses of bodies, in the order of the file."""
        return masses_of(description_of(self.linkage))

    def written(self, dimension: Dimension, value: float) -> object:
        """What stands in the file for a value of a dimension: a speed with its unit, else the number."""
        number = plain_number(value - dimension.drawn)
        return f"{number!r} {dimension.unit}" if dimension.place == ("drive", "speed") else number

    def toml(self) -> str:
        """The draft as TOML: the text it came from with its comments, and the changed values in place."""
        with of_extra("design", "writing a linkage file needs tomlkit"):
            import tomlkit
        if not self.text:
            return _with_short_lines(tomlkit.dumps(self.raw))
        # tables out of order are put in order by a change only
        if tomllib.loads(self.text) == self.raw:
            return self.text
        document: Any = tomlkit.parse(self.text)
        _settle(document, self.raw)
        written = _with_short_lines(tomlkit.dumps(document))
        if self.text.count("\r\n") == self.text.count("\n"):
            written = written.replace("\r\n", "\n").replace("\n", "\r\n")
        # what is written must be what is shown
        return written if _says(written, self.raw) else _with_short_lines(tomlkit.dumps(self.raw))


def _opened(raw: Mapping[str, Any], source: str) -> Mapping[str, Any]:
    """The tables of a file, with the rows of a load's table: they may be written to another folder."""
    # most programs that import drafts open none
    from sevenbar.description.formulas import context_of

    raw = in_loop_order(raw, source)
    return with_rows(raw, context_of(raw, source))


def _with_short_lines(text: str) -> str:
    """A TOML text with each row of a load's table on a line of its own where they are many."""
    import tomlkit

    if all(len(line) <= LONGEST_ROWS for line in text.splitlines()):
        return text
    document: Any = tomlkit.parse(text)
    for load in document.get("load", ()):
        if isinstance(load.get("table"), list):
            load["table"].multiline(True)
    return tomlkit.dumps(document)


def plain_number(value: float) -> float | int:
    """A number as people write it, without the point where it is whole."""
    return int(value) if abs(value) < 1e15 and value.is_integer() else value


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
        if key not in table and is_tables(value):
            rows = tomlkit.aot()
            _settle_list(rows, value)
            table.append(key, rows)
        elif key in table and isinstance(value, Mapping):
            _settle(table[key], value)
        elif isinstance(table.get(key), list) and isinstance(value, list):
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
