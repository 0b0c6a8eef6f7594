"""Links out of docs/ that have a page on the site: pages are written so that they also work on a forge."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sphinx.application import Sphinx

#: Files at the root and the pages that show them.
PAGES = {"README.md": "/index.md", "CHANGELOG.md": "/changelog.md", "CONTRIBUTING.md": "/contributing.md"}

_LINK = re.compile(r"\[([^\]]+)\]\(((?:\.\./)+)([^)#]+)(#[^)]*)?\)")


def mended(page: str, docname: str, root: Path) -> str:
    """A page with its links led to the site's own pages; `root` is the folder that docs/ is in."""
    if docname.startswith("examples/"):
        # a notebook, which stands beside docs/ and is read through the link docs/examples
        return page.replace("](../docs/", "](/")

    def led(link: re.Match[str]) -> str:
        text, way, target, anchor = link[1], link[2], link[3], link[4] or ""
        if way.count("../") != docname.count("/") + 1:
            return link[0]
        if target.startswith("examples/") and target.endswith(".ipynb"):
            # only a reference by name passes the link docs/examples
            return f"{{doc}}`{text.replace('`', '')} </{target.removesuffix('.ipynb')}>`"
        if (root / target).is_dir():
            # a forge shows folders, a site has none
            return text
        return f"[{text}]({PAGES.get(target, way + target)}{anchor})"

    return _LINK.sub(led, page)


def _mend(app: Sphinx, docname: str, content: list[str]) -> None:
    content[0] = mended(content[0], docname, Path(app.srcdir).parent)


def setup(app: Sphinx) -> dict[str, bool]:
    """Sphinx's entry."""
    app.connect("source-read", _mend)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
