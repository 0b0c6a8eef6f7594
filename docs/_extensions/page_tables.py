"""Tables in Markdown, and code in their cells."""

from collections.abc import Iterable, Sequence

from sevenbar.text import markdown


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table with the line that ends it."""
    return markdown.table(head, rows) + "\n"


def code(text: str) -> str:
    """A text as code."""
    return f"`{text}`"
