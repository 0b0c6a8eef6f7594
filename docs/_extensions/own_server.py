"""No page asks another server: whatever a built page loads lies beside it, or the build fails."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sphinx.application import Sphinx

#: What browsers load by themselves, tag by tag; links that a reader may click are no part of it.
LOADED = {
    "audio": ("src",),
    "embed": ("src",),
    "iframe": ("src",),
    "image": ("href", "xlink:href"),
    "img": ("src", "srcset"),
    "input": ("src",),
    "object": ("data",),
    "script": ("src",),
    "source": ("src", "srcset"),
    "use": ("href", "xlink:href"),
    "video": ("src", "poster"),
}

#: Kinds of `<link>` that are loaded.
LOADED_LINKS = {"icon", "manifest", "modulepreload", "preload", "prefetch", "stylesheet"}

_ELSEWHERE = re.compile(r"\s*(?:https?:)?//")
_IN_STYLE = re.compile(r"""(?:url\(|@import)\s*["']?\s*((?:https?:)?//[^"')\s]+)""")


class _Page(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []
        self._in_style = False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = {name: value or "" for name, value in attrs}
        names = LOADED.get(tag, ())
        if tag == "link" and LOADED_LINKS & set(values.get("rel", "").split()):
            names = ("href",)
        self.found += [values[name] for name in names if _ELSEWHERE.match(values.get(name, ""))]
        self.found += _IN_STYLE.findall(values.get("style", ""))
        self._in_style = tag == "style"

    def handle_endtag(self, tag: str) -> None:
        self._in_style = self._in_style and tag != "style"

    def handle_data(self, data: str) -> None:
        if self._in_style:
            self.found += _IN_STYLE.findall(data)


def asked_elsewhere(page: str) -> list[str]:
    """What an HTML page loads from other servers."""
    parser = _Page()
    parser.feed(page)
    return parser.found


def _check(app: Sphinx, failure: Exception | None) -> None:
    from sphinx.errors import ExtensionError

    if failure is not None:
        return
    folder = Path(app.outdir)
    asked = [
        f"{path.relative_to(folder)}: {address}"
        for path in sorted(folder.rglob("*.html"))
        for address in asked_elsewhere(path.read_text(encoding="utf-8"))
    ]
    asked += [
        f"{path.relative_to(folder)}: {address}"
        for path in sorted(folder.rglob("*.css"))
        for address in _IN_STYLE.findall(path.read_text(encoding="utf-8"))
    ]
    if asked:
        raise ExtensionError("pages ask other servers:\n" + "\n".join(asked))


def setup(app: Sphinx) -> dict[str, bool]:
    """Sphinx's entry."""
    app.connect("build-finished", _check)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
