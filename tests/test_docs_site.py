"""What the site's own extensions do with pages; `make docs` builds the site itself, warnings as errors."""

from pathlib import Path

import pytest

DOCS = Path(__file__).parent.parent / "docs"


@pytest.fixture(autouse=True)
def _extensions(monkeypatch):
    monkeypatch.syspath_prepend(DOCS / "_extensions")


@pytest.mark.parametrize(
    "page",
    [
        '<script src="https://cdn.example/x.js"></script>',
        "<img src='//pictures.example/x.png'>",
        '<link rel="preload stylesheet" href="http://fonts.example/x.css">',
        "<style>@import 'https://fonts.example/x.css';</style>",
        '<p style="background: url(https://pictures.example/x.png)">',
        '<img srcset="https://pictures.example/x.png 2x">',
    ],
)
def test_a_page_that_asks_another_server_is_found(page):
    from own_server import asked_elsewhere

    assert len(asked_elsewhere(f"<html><body>{page}</body></html>")) == 1


def test_links_that_a_reader_may_click_and_files_beside_the_page_are_no_requests():
    from own_server import asked_elsewhere

    page = (
        '<a href="https://mujoco.org">MuJoCo</a><link rel="next" href="https://example.org">'
        '<script src="_static/x.js"></script><img src="data:image/png;base64,AA=="><style>a {color: red}</style>'
    )
    assert asked_elsewhere(page) == []


def test_every_page_is_reached_from_the_first_one():
    import re

    reached = set()
    for page in ("index", "api/index"):
        text = (DOCS / f"{page}.md").read_text(encoding="utf-8")
        folder = Path(page).parent
        for block in re.findall(r"```\{toctree\}\n(.*?)```", text, flags=re.DOTALL):
            reached |= {(folder / line).as_posix() for line in block.split() if not line.startswith(":")}
    pages = {path.relative_to(DOCS).with_suffix("").as_posix() for path in DOCS.rglob("*.md")}
    assert pages - {"index"} <= reached
