"""The page of errata shows what it says: its lines of Python, run one block after the other, print what stands behind them.

Source: the papers' printed equations, typed into the page, held against the closure |A - B| = L2, differences, and the
vectors of the 7R paper turned by Rodrigues' formula.
"""

import contextlib
import io
import re

from places import DOCS

PAGE = (DOCS / "errata.md").read_text(encoding="utf-8")

BLOCKS = re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL)


def promised(block: str) -> list[str]:
    """What a block is to print: the comments behind its prints, and comments that stand alone."""
    return re.findall(r"(?:^ *print\(.*\)  |^)# (.*)$", block, flags=re.MULTILINE)


def test_every_erratum_prints_what_it_says():
    names: dict[str, object] = {}
    for block in BLOCKS:
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(block, names)
        assert printed.getvalue().splitlines() == promised(block), block


def test_every_erratum_says_where_what_is_right_and_how_we_know():
    errata = re.findall(r"^### (.*?)\n(.*?)(?=^###? |\Z)", PAGE, flags=re.MULTILINE | re.DOTALL)
    listed = re.findall(r"^\| \[\d+\]\(#(.*?)\)", PAGE, flags=re.MULTILINE)
    assert [re.sub(r"[^\w -]", "", title).lower().replace(" ", "-") for title, _ in errata] == listed
    for title, text in errata:
        for part in ("*Printed", "*Right:*", "*How we know:*", "```python\n"):
            assert part in text, (title, part)
        assert promised(text), title
