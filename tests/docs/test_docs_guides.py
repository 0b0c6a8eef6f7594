"""The quick start, in both languages, and the pages on planar linkages and papers show what the program does today."""

import contextlib
import io
import re
import tomllib

import pytest

from tutorial_pages import DOCS, QUICK, as_today, boxes, printed, write_file

ENGLISH, CHINESE = QUICK
SIMPLE = re.compile(r"^```(\w+)\n(.*?)^```$", re.DOTALL | re.MULTILINE)


@pytest.mark.parametrize("name", ["quick-start", "planar", "nets", "papers", "zh/quick-start"])
def test_the_examples_of_a_page_print_what_their_comments_say(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    page = (DOCS / f"{name}.md").read_text(encoding="utf-8")
    code = "\n".join(text for kind, text in SIMPLE.findall(page) if kind == "python")
    output = io.StringIO()
    with contextlib.redirect_stdout(output):
        exec(code, {})
    promised = re.findall(r"print\(.*\)  # (.*)", code)
    assert promised
    assert output.getvalue().splitlines() == promised


def test_the_quick_start_shows_what_its_commands_print_today(tmp_path):
    for kind, text in boxes(ENGLISH):
        if kind == "toml":
            write_file(text, tmp_path)
        elif kind == "console":
            as_today(text, tmp_path)
    assert (tmp_path / "fourbar.gif").read_bytes().startswith(b"GIF8")


@pytest.mark.parametrize("name", ["planar", "papers"])
def test_the_commands_of_a_page_run(name, tmp_path):
    for kind, text in boxes(ENGLISH):
        if kind == "toml":
            write_file(text, tmp_path)
    page = (DOCS / f"{name}.md").read_text(encoding="utf-8")
    found = re.findall(r"^    (sevenbar .*)$", page, flags=re.MULTILINE)
    assert len(found) > 1
    for number, command in enumerate(found):
        # each in its own place, as it would be typed by itself
        command = command.replace("figures/", "").replace("--out ", f"--out {number}_")
        written = printed(command, tmp_path)
        assert any(line.startswith("written: ") for line in written), written


def test_both_languages_of_the_quick_start_show_the_same():
    english, chinese = (
        [box for box in SIMPLE.findall(page.read_text(encoding="utf-8")) if box[0] in ("toml", "console")]
        for page in QUICK
    )
    assert len(english) == 4
    assert chinese == english


def test_the_extras_of_the_quick_start_exist():
    extras = tomllib.loads((DOCS.parent / "pyproject.toml").read_text())["project"]["optional-dependencies"]
    for page in QUICK:
        text = page.read_text(encoding="utf-8")
        _, _, table = text.partition("(extras)=" if page is ENGLISH else "## 可选组件")
        named = [
            name
            for row in re.findall(r"^\| (`.*?) \|", table, re.MULTILINE)
            for name in re.findall(r"`(\w+)`", row)
        ]
        assert len(named) == 11
        assert set(named) <= set(extras)


def test_no_page_installs_an_extra_by_the_name_of_a_package_that_is_not_published():
    for page in [
        DOCS.parent / "README.md",
        *QUICK,
        *(DOCS / f"{n}.md" for n in ("index", "planar", "papers", "coming-from")),
    ]:
        assert "'sevenbar[" not in page.read_text(encoding="utf-8"), page.name
