"""Parts of pages that are made from the program when the site is built.

A page has `<!-- made: gallery -->` where a part goes. A forge shows nothing there, so the page's own words
stand for themselves.
"""

import re
from collections.abc import Callable
from pathlib import Path

from sphinx.application import Sphinx
from sphinx.errors import ExtensionError

import command_tables
import gallery_entries
import key_tables
import module_map

#: What makes each part, from the folder of the pages; the rest of the mark is handed on.
PARTS: dict[str, Callable[[Path, str], str]] = {
    "commands": command_tables.all_commands,
    "gallery": gallery_entries.all_entries,
    "keys": key_tables.keys_of,
    "modules": module_map.module_map,
    "schema": key_tables.written_schema,
    "task_keys": key_tables.task_keys_of,
}

_MARK = re.compile(r"<!-- made: (\w+)(?: (\w+))? -->")


def _make(app: Sphinx, docname: str, content: list[str]) -> None:
    def part(mark: re.Match[str]) -> str:
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
