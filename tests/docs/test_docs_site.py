"""What the site's own extensions do with pages; `make docs` builds the site itself, warnings as errors."""

import re
from pathlib import Path

import pytest

from places import DOCS


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
    reached = set()
    for page in ("index", "api/index"):
        text = (DOCS / f"{page}.md").read_text(encoding="utf-8")
        folder = Path(page).parent
        for block in re.findall(r"```\{toctree\}\n(.*?)```", text, flags=re.DOTALL):
            reached |= {(folder / line).as_posix() for line in block.split() if not line.startswith(":")}
    pages = {path.relative_to(DOCS).with_suffix("").as_posix() for path in DOCS.rglob("*.md")}
    assert pages - {"index"} <= reached


def test_links_out_of_the_pages_lead_to_what_the_site_has():
    from beyond_docs import mended

    for docname, link, led in (
        ("rssr", "[a file](../examples/rssr.toml)", "[a file](../examples/rssr.toml)"),
        ("rssr", "[the front](../README.md#two-commands)", "[the front](/index.md#two-commands)"),
        ("rssr", "[a study](../examples/study.ipynb)", "{doc}`a study </examples/study>`"),
        ("zh/index", "[a study](../../examples/study.ipynb)", "{doc}`a study </examples/study>`"),
        ("rssr", "[the tests](../tests)", "the tests"),
        ("rssr", "[a page](theory.md#rates)", "[a page](theory.md#rates)"),
        ("zh/index", "[a page](../rssr.md#rates)", "[a page](../rssr.md#rates)"),
        ("examples/study", "[a page](../docs/rssr.md#rates)", "[a page](/rssr.md#rates)"),
    ):
        assert mended(f"See {link}.", docname, DOCS.parent) == f"See {led}."


def test_the_module_map_has_a_line_for_each_module_of_the_package_and_the_core():
    from module_map import CORE, PACKAGE, module_map

    lines = module_map().splitlines()
    rows = [line for line in lines if line.startswith("| `")]
    folders = [line for line in lines if line.startswith("**`")]
    modules = [path for path in PACKAGE.rglob("*.py") if path.parent != PACKAGE]
    packages = list(PACKAGE.glob("*/__init__.py"))
    rust = [path for path in CORE.rglob("*.rs") if path.stem not in ("mod", "tests")]
    rust_folders = list(CORE.rglob("mod.rs"))
    assert len(rows) == len(modules) - len(packages) + len(rust)
    assert len(folders) == len(packages) + len([*PACKAGE.glob("*.py")]) - 1 + len(rust_folders)
    assert [line for line in rows + folders if not re.search(r"[\w`)\]][.:](?: \|)?$", line)] == []


def test_primes_stand_beside_their_letter_and_powers_above_it():
    from primes import with_full_primes

    prime = '<mo form="postfix" lspace="0" rspace="0">′</mo>'
    for given, mended in (
        ("<msup><mi>b</mi><mo>′</mo></msup>", f"<mrow><mi>b</mi>{prime}</mrow>"),
        (
            "<msup><mi>b</mi><mrow><mo>′</mo><mn>2</mn></mrow></msup>",
            f"<msup><mrow><mi>b</mi>{prime}</mrow><mn>2</mn></msup>",
        ),
        (
            "<msubsup><mi>b</mi><mi>i</mi><mo>′</mo></msubsup>",
            f"<mrow><msub><mi>b</mi><mi>i</mi></msub>{prime}</mrow>",
        ),
        ("<msup><mi>b</mi><mn>2</mn></msup>", "<msup><mi>b</mi><mn>2</mn></msup>"),
        ("<msup><mi>A</mi><mo>+</mo></msup>", "<msup><mi>A</mi><mo>+</mo></msup>"),
    ):
        assert with_full_primes(f"<math>{given}</math>") == f"<math>{mended}</math>"


def test_no_page_has_the_marks_of_a_merge_that_was_left():
    # one had: they passed for a heading and for text
    for page in DOCS.rglob("*.md"):
        assert not re.search(r"^(<{7}|={7}|>{7})( |$)", page.read_text(encoding="utf-8"), re.MULTILINE), page
