"""Equations that are cited exist: in docstrings of Python and Rust, and from page to page; each page numbers its own in order.

A page's equation stands between lines `$$`, the last with its label, as in `$$ (theory-7)`: the page, without `theory_`,
and the number. Sphinx counts labelled equations of a page from 1, so numbers in order are the numbers printed.
"""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from places import ROOT

#: Numbers as they are cited: (3), (3) and (4), (3) to (5) and (9).
NUMBERS = r"\(\d+\)(?:(?:, | and | to )\(\d+\))*"

SOURCES = [
    *sorted((ROOT / "python" / "sevenbar").rglob("*.py")),
    *sorted((ROOT / "crates").rglob("src/**/*.rs")),
]


def without_code(text: str) -> str:
    """A page without its blocks of code."""
    text = re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL)
    return re.sub(r"^    .*$", "", text, flags=re.MULTILINE)


PAGES = {p.stem: without_code(p.read_text(encoding="utf-8")) for p in sorted((ROOT / "docs").glob("*.md"))}


def labels(page: str) -> list[str]:
    """The labels of a page's equations in order."""
    return re.findall(r"^\$\$ \((.*)\)$", PAGES[page], flags=re.MULTILINE)


NUMBERED = [page for page in PAGES if labels(page)]


def cited(numbers: str) -> Iterator[int]:
    """The numbers that a citation means, those between the ends of `(3) to (5)` too."""
    for part in re.split(r", | and ", numbers):
        first, *last = [int(n) for n in re.findall(r"\d+", part)]
        yield from range(first, (last[0] if last else first) + 1)


def citations(path: Path) -> list[tuple[str, str]]:
    """Page and numbers of each citation in a source file, docstrings and comments unfolded to one line."""
    text = re.sub(r"\n\s*(?://[/!]|#)?\s*", " ", path.read_text(encoding="utf-8"))
    return re.findall(rf"docs/(\w+)\.md, ({NUMBERS})", text)


def test_the_pages_of_theory_are_numbered():
    assert NUMBERED == [
        "conventions",
        "errata",
        "rssr",
        "theory",
        "theory_design",
        "theory_forces",
        "theory_free",
        "theory_many",
        "theory_measures",
        "theory_nets",
    ]


@pytest.mark.parametrize("page", NUMBERED)
def test_equations_of_a_page_are_numbered_in_order(page):
    name = page.removeprefix("theory_")
    assert labels(page) == [f"{name}-{number}" for number in range(1, len(labels(page)) + 1)]


@pytest.mark.parametrize("page", NUMBERED)
def test_equations_stand_alone_with_blank_lines_around(page):
    lines = ["", *PAGES[page].splitlines(), ""]
    marks = [n for n, line in enumerate(lines) if line.startswith("$$")]
    assert len(marks) == 2 * len(labels(page))
    for first, last in zip(marks[::2], marks[1::2], strict=True):
        assert lines[first] == "$$"
        assert re.fullmatch(r"\$\$ \([a-z]+-\d+\)", lines[last])
        assert all(lines[first + 1 : last])
        assert lines[first - 1] == lines[last + 1] == "", lines[last]


def test_equations_that_docstrings_cite_exist():
    found = [(path, page, n) for path in SOURCES for page, numbers in citations(path) for n in cited(numbers)]
    assert len({path for path, _, _ in found}) > 30
    for path, page, number in found:
        assert page in NUMBERED, (path, page)
        assert number <= len(labels(page)), (path, page, number)


def test_a_source_that_is_a_page_names_its_equation():
    for path in SOURCES:
        text = path.read_text(encoding="utf-8")
        for line in re.findall(r"Source: .*docs/.*", text):
            places = re.findall(r"docs/\w+\.md", line)
            assert len(re.findall(rf"docs/\w+\.md, {NUMBERS}[.;]", line)) == len(places), (path, line)


@pytest.mark.parametrize("page", NUMBERED)
def test_numbers_that_a_page_speaks_of_are_its_own(page):
    """Numbers behind a link to another page are that page's, those behind "eq." a paper's."""
    text = re.sub(r"^\$\$$.*?^\$\$ \(.*?\)$", "", PAGES[page], flags=re.MULTILINE | re.DOTALL)
    text = re.sub(r"`[^`]*`|\$[^$\n]*\$", "", text)
    behind, before = rf"\]\((\w+)\.md[^)]*\),? ({NUMBERS})", rf"({NUMBERS}) of \[[^\]]*\]\((\w+)\.md"
    inside = rf"\[[^\]]*?({NUMBERS})[^\]]*\]\((\w+)\.md"
    elsewhere = [(other, numbers) for other, numbers in re.findall(behind, text)]
    elsewhere += [(other, numbers) for numbers, other in re.findall(before, text) + re.findall(inside, text)]
    for other, numbers in elsewhere:
        assert max(cited(numbers)) <= len(labels(other)), (other, numbers)
    if page.startswith(("theory", "rssr")):
        own = re.sub(rf"{behind}|{before}|{inside}|[Ee]q\. {NUMBERS}", "", text)
        numbers = [int(n) for n in re.findall(r"(?<![\w)])\((\d{1,2})\)", own)]
        assert numbers
        assert max(numbers) <= len(labels(page))
