"""What a result says, each fact once: in words for people, by keys for programs; and tables of numbers."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from io import StringIO
from typing import Any, TypeVar

from rich.box import SIMPLE_HEAD
from rich.console import Console, Group, RenderableType
from rich.table import Table
from rich.text import Text

from sevenbar.reporting.files import Files, Report, json_file
from sevenbar.text.printing import WIDTH, text_of
from sevenbar.text.words import say

T = TypeVar("T")


@dataclass(frozen=True)
class Fact:
    """A text with its label, both as they are spoken, and by their keys the values behind it.

    One without a label goes on with the fact above; one without a text is for programs alone. Texts hold
    names of joints and files, so they are no markup.
    """

    label: str
    text: str
    style: str = ""
    values: Mapping[str, Any] = field(default_factory=dict)


class Facts(list[Fact]):
    """What a result says above its tables, or a row of one, for people and for programs."""

    def add(self, label: str, text: str, /, style: str = "", **values: Any) -> None:
        """Adds a fact, its label in the language that is spoken."""
        self.append(Fact(say(label) if label else "", text, style, values))

    def add_all(self, facts: Iterable[tuple[str, str]], *, bold: Collection[str] = ()) -> None:
        """Adds a fact for each label and text, those with some labels bold."""
        for label, text in facts:
            self.add(label, text, "bold" if label in bold else "")

    def also(self, **values: Any) -> None:
        """Adds values for programs alone."""
        self.add("", "", **values)

    @property
    def as_dict(self) -> dict[str, Any]:
        """The values of all facts, in their order."""
        return {key: value for fact in self for key, value in fact.values.items()}

    @property
    def grid(self) -> Table:
        """A line for each fact."""
        grid = Table.grid(padding=(0, 2))
        grid.add_column(style="dim", no_wrap=True)
        grid.add_column()
        for fact in self:
            if fact.text:
                grid.add_row(fact.label, Text(fact.text, style=fact.style))
        return grid


@dataclass(frozen=True)
class Page:
    """A title, facts, and tables or other parts with a free line above each."""

    title: str
    facts: Facts
    parts: tuple[RenderableType, ...] = ()

    def __rich__(self) -> Group:
        free = (own for part in self.parts for own in (Text(), part))
        return Group(Text(self.title, style="bold underline"), self.facts.grid, *free)


def page(title: str, facts: Facts, *parts: RenderableType) -> Page:
    """A page of these parts."""
    return Page(title, facts, parts)


def page_report(page: Callable[[T], Page], stem: str, files: Files[T], *, spoken: bool = True) -> Report[T]:
    """How a result is reported that is a page: printed as it is, its values as JSON, also in stem.json."""

    def as_dict(result: T) -> dict[str, Any]:
        return page(result).facts.as_dict

    return Report(page, as_dict, {f"{stem}.json": json_file(as_dict), **files}, spoken=spoken)


def prints_its_page(kind: type[T], name: str, page: Callable[[T], Page]) -> None:
    """Lets results of a kind print the title of their page, after a name of the kind, and its facts."""

    def text(result: T) -> str:
        made = page(result)
        console = Console(file=StringIO(), width=WIDTH, color_system=None)
        with console.capture() as printed:
            console.print(Page(made.title, made.facts))
        title, *facts = printed.get().splitlines()
        return "\n".join([f"{name} of '{title.strip()}'", *(f"  {line}".rstrip() for line in facts)])

    text_of.register(kind)(text)


def number_table(heads: Sequence[str], rows: Iterable[Sequence[str]], *, words: Sequence[int] = ()) -> Table:
    """A table with names in its first column and numbers, flush right, in the others except `words`.

    Heads that the catalogue has are in the language that is spoken.
    """
    table = Table(box=SIMPLE_HEAD, pad_edge=False, show_edge=False)
    for place, head in enumerate(heads):
        right = place > 0 and place not in words
        table.add_column(
            Text(say(head) if head else ""), justify="right" if right else "left", no_wrap=place == 0
        )
    for row in rows:
        table.add_row(*map(Text, row))
    return table


def facts_table(rows: Sequence[Facts], *, words: Sequence[int] = ()) -> Table:
    """A table with a row for each of several things with the same facts, their labels as its heads."""
    cells = [[fact for fact in row if fact.label] for row in rows]
    heads = [fact.label for fact in cells[0]]
    return number_table(heads, ([fact.text for fact in row] for row in cells), words=words)
