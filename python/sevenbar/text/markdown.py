"""Words and tables in Markdown."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Sequence

#: A bar that would end its cell, in code as well.
_BAR = re.compile(r"(?<!\\)\|")

#: What means something wherever it is; an entity; an underscore at the edge of a word; a bracket that would
#: make a link; what begins a line of another kind.
_MEANS = re.compile(
    r"[\\`*<]|&(?=#?\w+;)|(?<![^\W_])_|_(?![^\W_])|\](?=[(\[:])|^[#>]|^[-+](?= )|(?<=^1)[.)](?= )",
    re.MULTILINE,
)


def escaped(words: str) -> str:
    r"""Words that Markdown shows as they are; only what it would take for something else is escaped.

    >>> print(escaped("ball_a [mm]  x < y  *b*"))
    ball_a [mm]  x \< y  \*b\*
    """
    return _MEANS.sub(r"\\\g<0>", words).replace("\n", "<br>")


def table(heads: Sequence[str], rows: Iterable[Sequence[str]], *, right: Collection[int] = ()) -> str:
    r"""A table; the columns in places `right` are flush right, bars within a cell are escaped.

    >>> print(table(["x", "y"], [["a|b", "1"]], right=[1]))
    | x | y |
    | --- | ---: |
    | a\|b | 1 |
    """
    rule = ["---:" if place in right else "---" for place in range(len(heads))]
    lines = (" | ".join(_BAR.sub(r"\|", cell) for cell in line) for line in (heads, rule, *rows))
    return "\n".join(f"| {line} |" for line in lines)
