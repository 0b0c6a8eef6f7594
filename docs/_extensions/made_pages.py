"""Parts of pages that are made from the program when the site is built: pictures and files.

A page has `<!-- made: gallery -->` where a part goes. A forge shows nothing there, so the page's own words
stand for themselves. Tables are written into the pages instead (`written_parts`).
"""

import re
from collections.abc import Callable
from pathlib import Path

from sphinx.application import Sphinx
from sphinx.errors import ExtensionError

import gallery_entries
import key_tables
import written_parts

#: What makes each part, from the folder of the pages; the rest of the mark is handed on.
PARTS: dict[str, Callable[[Path, str], str]] = {
    "gallery": gallery_entries.all_entries,
    "schema": key_tables.written_schema,
}

_MARK = re.compile(r"<!-- made: (\w+)(?: (\w+))? -->")


def _make(app: Sphinx, docname: str, content: list[str]) -> None:
    def part(mark: re.Match[str]) -> str:
        if mark[1] in written_parts.PARTS:
            return mark[0]
        if mark[1] not in PARTS:
            raise ExtensionError(f"{docname}: no part {mark[1]!r} is made; there are {', '.join(PARTS)}")
        return PARTS[mark[1]](Path(app.srcdir), mark[2] or "")

    content[0], count = _MARK.subn(part, content[0])
    if count:
        # the program may have changed where the page has not
        app.env.note_reread()


def setup(app: Sphinx) -> dict[str, bool]:
    """Sphinx's entry."""
    app.connect("source-read", _make)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
