"""What the documentation shows is what the program does."""

import contextlib
import doctest
import importlib
import io
import re
import shlex
import subprocess
import sys

import pytest

from command_runs import sevenbar
from evidence.benches.engines import STEPS, by_steps
from places import ROOT
from sevenbar.simulation.run import ENGINES

README = (ROOT / "README.md").read_text(encoding="utf-8")


#: Every module with an example in a docstring.
WITH_EXAMPLES = [
    ".".join(path.relative_to(ROOT / "python").with_suffix("").parts)
    for path in sorted((ROOT / "python").rglob("*.py"))
    if ">>> " in path.read_text(encoding="utf-8")
]


@pytest.mark.parametrize("name", WITH_EXAMPLES)
def test_docstring_examples_give_what_they_show(name):
    tested = doctest.testmod(importlib.import_module(name.removesuffix(".__init__")))
    assert tested.attempted > 0
    assert tested.failed == 0


def test_the_modules_with_examples_are_found():
    assert {"sevenbar.kinematics.linkage", "sevenbar.design.points.least", "sevenbar.text.units"} <= set(
        WITH_EXAMPLES
    )


def test_the_examples_of_the_readme_print_what_their_comments_say():
    code = "\n".join(re.findall(r"```python\n(.*?)```", README, flags=re.DOTALL))
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(code, {})
    lines = printed.getvalue().splitlines()
    promised = re.findall(r"print\(.*?\)\s+# (.*)", code)
    assert lines[0] == promised[0] == "crank-rocker"
    for line, promise in zip(lines[1:3], promised[1:3], strict=True):
        assert [float(x) for x in line.split()] == pytest.approx(
            [float(x) for x in promise.split()], rel=1e-12
        )
    for line, promise in zip(lines[-3:], promised[-3:], strict=True):
        assert promise.startswith(line)


def test_the_report_in_the_readme_is_the_report_of_today():
    command = [sys.executable, "-m", "sevenbar.commands.cli", "analyze", "examples/rssr.toml"]
    report = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    numbers_of_rounding = re.compile(r"\d\.\de-1\d")
    lines = [numbers_of_rounding.sub("~", line.rstrip()) for line in report.splitlines()]
    shown = numbers_of_rounding.sub("~", README)
    assert all(f"    {line}\n" in shown for line in lines if line)


@pytest.mark.parametrize(("name", "count"), [("analyze", 5), ("measured", 4), ("tolerance", 2)])
def test_what_a_page_prints_is_what_its_commands_print_today(name, count, tmp_path):
    page = (ROOT / "docs" / f"{name}.md").read_text(encoding="utf-8")
    # a mean of differences that is zero but for rounding, and numbers beside it
    rounding = re.compile(r"[-+]?\d\.?\d*e-1\d")
    shown = re.sub(r" +", " ", rounding.sub("~", page))
    commands = re.findall(r"^    \$ sevenbar (.*)$", page, flags=re.MULTILINE)
    assert len(commands) == count
    for index, command in enumerate(commands):
        words = shlex.split(command.replace("DIR", str(tmp_path / str(index))))
        run = sevenbar(*words, cwd=ROOT)
        assert run.returncode == 0, run.stderr
        for line in run.stdout.partition("\nwritten:")[0].splitlines():
            told = re.sub(r" +", " ", rounding.sub("~", line)).strip()
            assert not told.strip("─") or f" {told}\n" in shown, line


def test_the_example_of_the_page_on_measured_values_prints_what_its_comments_say(monkeypatch):
    monkeypatch.chdir(ROOT)
    (code,) = re.findall(
        r"```python\n(.*?)```", (ROOT / "docs" / "measured.md").read_text(encoding="utf-8"), flags=re.DOTALL
    )
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(code, {})
    rms, names, inside = printed.getvalue().splitlines()
    promised = re.findall(r"print\(.*\)  # (.*)", code)
    assert float(rms) == pytest.approx(float(promised[0]), abs=1e-6)
    assert [names, inside] == promised[1:]


@pytest.mark.parametrize("name", ["analyze", "index"])
def test_the_example_of_a_page_prints_what_its_comments_say(name, monkeypatch):
    monkeypatch.chdir(ROOT)
    page = (ROOT / "docs" / f"{name}.md").read_text(encoding="utf-8")
    (code,) = re.findall(r"```python\n(.*?)```", page, flags=re.DOTALL)
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(code, {})
    promised = re.findall(r"print\(.*\)  # (.*)", code)
    # a line in a loop is printed for each circuit
    assert list(dict.fromkeys(printed.getvalue().splitlines())) == promised


def test_the_example_of_the_page_on_tolerances_prints_what_its_comments_say():
    page = (ROOT / "docs" / "tolerance.md").read_text(encoding="utf-8")
    (code,) = re.findall(r"```python\n(.*?)```", page, flags=re.DOTALL)
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(code, {})
    assert printed.getvalue().splitlines() == re.findall(r"print\(.*\)  # (.*)", code)


def test_the_designs_of_the_page_on_synthesis_are_those_of_today():
    page = (ROOT / "docs" / "synthesis.md").read_text(encoding="utf-8")
    shown = re.findall(r"^    \$ sevenbar (.*)\n\n((?:    (?!\$).*\n|\n)+)", page, flags=re.MULTILINE)
    assert len(shown) == 2
    for command, text in shown:
        run = sevenbar(*shlex.split(command), cwd=ROOT)
        assert run.returncode == 0, run.stderr
        told, today = ([word for word in part.split() if set(word) != {"─"}] for part in (text, run.stdout))
        for there, here in zip(told, today, strict=True):
            if not re.fullmatch(r"-?\d+\.\d+", there):
                assert there == here
            # the last digits are those of an optimiser, and differ from machine to machine
            else:
                assert float(there) == pytest.approx(float(here), rel=1e-2)


def test_the_example_of_the_page_on_engines_is_right(capsys):
    page = (ROOT / "docs" / "simulation.md").read_text(encoding="utf-8")
    (code,) = re.findall(r"```python\n(.*?)```", page, flags=re.DOTALL)
    exec(code, {})
    angle, gap = (float(word) for word in capsys.readouterr().out.split())
    assert 0 < angle < 1e-3
    assert 0 < gap < 1


# that both engines agree in the whole gallery is held by test_engines.py; here, that the page has its numbers
@pytest.mark.parametrize("every", [3, pytest.param(1, marks=pytest.mark.proof)])
def test_the_table_on_the_engines_is_that_of_today(every):
    page = (ROOT / "docs" / "simulation.md").read_text(encoding="utf-8")
    shown = [line for line in page.splitlines() if re.match(r"\| (Exudyn|MuJoCo) ", line)]
    assert len(shown) == 6
    rows = [(engine, steps) for engine in ENGINES for steps in STEPS]
    for there, (engine, steps) in list(zip(shown, rows, strict=True))[::every]:
        here = by_steps(engine, steps)
        for cell, other in zip(there.split("|"), here.split("|"), strict=True):
            number = r" (< )?\d\.?\d*e-?\+?\d+ "
            if not re.fullmatch(number, cell):
                assert cell == other
                continue
            # what is left of rounding varies with the machine, in accelerations by the step squared
            one, two = (max(float(text.strip().removeprefix("< ")), 1e-9) for text in (cell, other))
            assert 1 / 10 < one / two < 10, (there, here)


def test_links_of_the_documentation_lead_somewhere():
    for page in [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]:
        for target in re.findall(r"\]\((?!https:)([^)#]+)\)", page.read_text(encoding="utf-8")):
            assert (page.parent / target).exists(), f"{page.name}: {target}"


def test_the_tables_on_the_seven_r_are_those_of_today():
    page = (ROOT / "docs" / "seven_r.md").read_text(encoding="utf-8")
    (code,) = re.findall(r"```python\n(.*?)```", page, flags=re.DOTALL)
    printed = ""
    for command in (["-c", code], ["-m", "evidence.accuracy.finite_differences"]):
        run = subprocess.run([sys.executable, *command], cwd=ROOT, capture_output=True, text=True, check=True)
        printed += run.stdout
    rows = [line for line in printed.splitlines() if line.startswith("| ")]
    # errors of exact rates are rounding, and differ from machine to machine
    rows = [row for row in rows if not row.startswith("| exact")]
    assert len(rows) == 8 + 4 + 9
    assert [row for row in rows if f"{row}\n" not in page] == []
