"""Tables of the pages of evidence: as the product writes them, numbers flush right."""

from __future__ import annotations

import re
from collections.abc import Sequence

from sevenbar.text import markdown

#: A cell with a number, perhaps of parts a hundred, or none.
NUMBER = re.compile(r"-?[\d,.]+(e[-+]?\d+)?( %)?|[-–]?")


def table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table of Markdown; columns of numbers are flush right, where the site does not break their lines."""
    places = range(len(heads))
    right = [place for place in places if all(NUMBER.fullmatch(row[place]) for row in rows)]
    return markdown.table(heads, rows, right=right)
