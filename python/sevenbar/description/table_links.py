"""The cells of a table that name links: between which links a joint is, and which link stands still."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from sevenbar.description.edges import names_in
from sevenbar.description.table_cells import TableCells
from sevenbar.description.written import GROUND_WORDS, names_ground
from sevenbar.errors import shown
from sevenbar.text.grid import CellTable

#: Columns of the two links of a joint.
BETWEEN = ("between a", "between b")

#: Kinds of a row that is a link with a ball at each end.
ROD_WORDS = ("rod", "ball rod")


class LinkCells(TableCells):
    """The cells of one table; `ground` is the link that the caller says stands still."""

    def __init__(self, grid: CellTable, source: str, ground: str = "") -> None:
        super().__init__(grid, source)
        self.chosen_ground = ground
        #: Whether points name their link, though this sheet has no joints.
        self.by_name = False

    @property
    def names_links(self) -> bool:
        """Whether the table has links by name."""
        return "between" in self.columns or all(key in self.columns for key in BETWEEN)

    def links_of(self, row: int) -> list[str]:
        """The links that a row names."""
        if "between" not in self.columns:
            return [name for key in BETWEEN if (name := self.text(row, key))]
        text = self.text(row, "between")
        if text[:1] in ("[", "("):
            # a list in a cell of a data frame
            return [name.strip("'\"") for name in names_in(text.strip("[]()"))]
        return names_in(text)

    def joined(self, row: int, path: str, most: int | None = None) -> list[str]:
        """The links that a joint joins, two or up to `most`, at a path of the description."""
        names = self.links_of(row)
        key = next(key for key in ("between", *BETWEEN) if key in self.columns)
        self.note_place(path, row, key)
        if len(names) < 2 or (most is not None and len(names) > most):
            count = f"{len(names)} link{'s' * (len(names) != 1)}"
            what = f"{shown(self.text(row, key))} names {count}" if names else "names no link"
            give = "two" if most is not None else "two or more"
            self.wrong(f"{what}; give {give}, as in 'frame; crank'", row, self.columns[key])
        return names

    def ground_of(self, tables: Sequence[Mapping[str, Any]]) -> str:
        """The link that stands still: as the caller or a column has it, or one that is called so."""
        if self.chosen_ground:
            self.places["ground"] = "ground"
            return self.chosen_ground
        if "ground" in self.columns:
            rows = [row for row in self.filled if self.text(row, "ground")]
            for row in rows[:1]:
                self.note_place("ground", row, "ground")
            for row in rows[1:]:
                if self.text(row, "ground") != self.text(rows[0], "ground"):
                    self.wrong("is a second ground; give one", row, self.columns["ground"])
            if rows:
                return self.text(rows[0], "ground")
        named = dict.fromkeys(
            link for table in tables for link in table.get("links", table.get("between", ()))
        )
        called = [link for link in named if names_ground(link)]
        if len(called) == 1 or self.problems:
            # links of a wrong cell are not known
            return next(iter([*called, *named]), "")
        *most, last = (word for word in GROUND_WORDS if len(word) > 1)
        words = f"{', '.join(most)} or {last}"
        what = f"{' and '.join(called)} are links" if called else f"no link is called {words}"
        links = ", ".join(named)
        here = " or as ground=.." if self.grid.word == "data row" else ""
        self.wrong(f"{what}; name the link that stands still in a column 'ground'{here}, one of {links}")
        return ""
