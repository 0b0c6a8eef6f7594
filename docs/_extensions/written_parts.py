"""Tables that are written into the pages from the program, so that a forge shows them, too: `make pages`.

A page has `<!-- made: keys joint -->` where a table begins and `<!-- end -->` where it ends. A test holds
what is between them to what the program says.
"""

import re
import sys
from collections.abc import Callable
from pathlib import Path

import command_tables
import gallery_entries
import key_tables
import module_map

PAGES = Path(__file__).resolve().parents[1]

#: What makes each part, from the folder of the pages; the rest of the mark is passed on.
PARTS: dict[str, Callable[[Path, str], str]] = {
    "commands": command_tables.all_commands,
    "gallery_loops": gallery_entries.table_of_loops,
    "gallery_nets": gallery_entries.table_of_nets,
    "keys": key_tables.keys_of,
    "modules": module_map.module_map,
    "task_keys": key_tables.task_keys_of,
}

_PART = re.compile(rf"(<!-- made: ({'|'.join(PARTS)})(?: (\w+))? -->\n).*?(<!-- end -->)", re.DOTALL)


def written(text: str, pages: Path = PAGES) -> str:
    """A page with its parts as the program has them now."""
    return _PART.sub(lambda m: f"{m[1]}\n{PARTS[m[2]](pages, m[3] or '').strip()}\n\n{m[4]}", text)


def main() -> None:
    """Writes the parts anew into every page that has some, and names the pages that changed."""
    for page in sorted(PAGES.rglob("*.md")):
        old = page.read_text(encoding="utf-8")
        if (new := written(old)) != old:
            page.write_text(new, encoding="utf-8")
            sys.stdout.write(f"written: {page.relative_to(PAGES.parent)}\n")


if __name__ == "__main__":
    main()
