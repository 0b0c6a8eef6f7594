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


def _shown(target: str) -> str:
    """The page of a target; notebooks have one through the link docs/examples."""
    notebook = target.startswith("../examples/") and target.endswith(".ipynb")
    return target.removeprefix("../") if notebook else PAGES.get(target, target)


def _mend(_app: Sphinx, docname: str, content: list[str]) -> None:
    if "/" not in docname:
        content[0] = _LINK.sub(lambda link: f"]({_shown(link[1])}{link[2] or ''})", content[0])


def setup(app: Sphinx) -> dict[str, bool]:
    """Sphinx's entry."""
    app.connect("source-read", _mend)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
