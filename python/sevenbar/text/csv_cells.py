"""Text cells of CSV files that a spreadsheet would run as formulas: written harmless, read as they were."""

from __future__ import annotations

import re
from functools import lru_cache

#: A number as tables have it; no formula, whatever sign it begins with.
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][-+]?\d+)?")

#: Where a formula would begin: a cell, or what a spreadsheet that parts cells at semicolons takes for one.
#: The wide signs are those of East Asian keyboards, which spreadsheets read alike.
_BEGIN, _RUN = r"(?:^|(?<=;))", r"'*[=+\-@\t\r\n＝＋－＠]"
_RUNS = re.compile(f"{_BEGIN}(?={_RUN})")
_HARMLESS = re.compile(f"{_BEGIN}'(?={_RUN})")


@lru_cache(maxsize=1024)
def harmless(text: str) -> str:
    """A text cell with an apostrophe before what a spreadsheet would run; numbers stay.

    >>> harmless("=1+1_deg"), harmless("-2.5"), harmless("A_x")
    ("'=1+1_deg", '-2.5', 'A_x')
    """
    return text if NUMBER.fullmatch(text) else _RUNS.sub("'", text)


def as_written(cell: str) -> str:
    """The text that was made `harmless`.

    >>> as_written("'=1+1_deg")
    '=1+1_deg'
    """
    return _HARMLESS.sub("", cell) if "'" in cell else cell
