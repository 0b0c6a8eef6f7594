"""Links out of docs/ that have a page on the site: pages are written so that they also work on a forge."""

import re

from sphinx.application import Sphinx

#: What lies beside docs/ and the page that shows it.
PAGES = {
    "../README.md": "index.md",
    "../CHANGELOG.md": "changelog.md",
    "../CONTRIBUTING.md": "contributing.md",
}

_LINK = re.compile(r"\]\((\.\./[^)#]+)(#[^)]*)?\)")

#: Notebooks have their pages through the link docs/examples, which only a reference by name passes.
_NOTEBOOK = re.compile(r"\[([^\]`]+)\]\(\.\./(examples/[^)#]+)\.ipynb\)")


def mended(page: str) -> str:
    """A page with its links led to the site's own pages."""
    page = _NOTEBOOK.sub(r"{doc}`\1 </\2>`", page)
    return _LINK.sub(lambda link: f"]({PAGES.get(link[1], link[1])}{link[2] or ''})", page)


def _mend(_app: Sphinx, docname: str, content: list[str]) -> None:
    if not docname.startswith("examples/"):
        # from a folder of docs/ the way out is one longer
        content[0] = mended(content[0].replace("](../../", "](../") if "/" in docname else content[0])


def setup(app: Sphinx) -> dict[str, bool]:
    """Sphinx's entry."""
    app.connect("source-read", _mend)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
