"""What the printed pages of all commands are made of: labelled facts, and tables of numbers."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from io import StringIO

from rich.box import SIMPLE_HEAD
from rich.console import Console, Group, RenderableType
from rich.table import Table
from rich.text import Text

from sevenbar.text.printing import WIDTH
from sevenbar.text.words import say


class Facts:
    """Lines of a label and a text beside it; texts hold names of joints and files, so they are no markup."""

    def __init__(self) -> None:
        self.grid = Table.grid(padding=(0, 2))
        self.grid.add_column(style="dim", no_wrap=True)
        self.grid.add_column()

    def add(self, label: str, text: str, style: str = "") -> None:
        """Adds a line, its label in the language that is spoken; without one it belongs to the line above."""
        self.grid.add_row(say(label) if label else "", Text(text, style=style))

    def add_all(self, facts: Iterable[tuple[str, str]], *, bold: Collection[str] = ()) -> None:
        """Adds a line for each label and text, those with some labels bold."""
        for label, text in facts:
            self.add(label, text, "bold" if label in bold else "")


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


def page(title: str, facts: Facts, *parts: RenderableType) -> Group:
    """A page: its title, its facts, and tables or other parts with a free line above each."""
    free = (own for part in parts for own in (Text(), part))
    return Group(Text(title, style="bold underline"), facts.grid, *free)


def opening(kind: str, page: RenderableType) -> str:
    """What a result of this kind prints of itself: the title of its page, and the facts below it."""
    parts = page.renderables[:2] if isinstance(page, Group) else [page]
    console = Console(file=StringIO(), width=WIDTH, color_system=None)
    with console.capture() as printed:
        for part in parts:
            console.print(part)
    title, *facts = printed.get().splitlines()
    return "\n".join([f"{kind} of '{title.strip()}'", *(f"  {line}".rstrip() for line in facts)])
