"""The pages on forces: what they show is what the program prints today."""

from __future__ import annotations

import contextlib
import io
import re
import shlex
from pathlib import Path

import pytest

import sevenbar as sb
from command_runs import sevenbar
from places import DOCS

PAGE = (DOCS / "forces.md").read_text(encoding="utf-8")
#: What is left of rounding differs between machines.
ROUNDING = re.compile(r"\d\.?\d*e-1\d")


def shown() -> list[tuple[str, list[str]]]:
    """The commands of the page, each with the lines that are shown below it."""
    found = re.findall(r"^    \$ sevenbar (.*)\n\n((?:    .*\n|\n(?=    ))+)", PAGE, flags=re.MULTILINE)
    return [(command, text.splitlines()) for command, text in found]


EXAMPLES = re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL)


def words(text: str) -> str:
    return " ".join(ROUNDING.sub("~", text).split())


def test_the_page_has_commands() -> None:
    assert len(shown()) == 3


@pytest.mark.parametrize(("command", "lines"), shown())
def test_what_the_page_shows_is_printed_today(command: str, lines: list[str], tmp_path: Path) -> None:
    run = sevenbar(*shlex.split(command), cwd=tmp_path)
    assert run.returncode == 0, run.stderr
    printed = words(run.stdout)
    whole = words("\n".join(lines))
    if ".." in whole.split():
        assert all(words(line) in printed for line in lines if line.strip() != "..")
    else:
        assert printed.partition(" written:")[0] == whole


def test_the_page_has_examples() -> None:
    assert len(EXAMPLES) == 2


@pytest.mark.parametrize("code", EXAMPLES)
def test_an_example_prints_what_its_comments_say(code: str) -> None:
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(code, {})
    assert printed.getvalue().splitlines() == re.findall(r"print\(.*\)  # (.*)", code)


def test_the_numbers_of_the_text_are_those_of_the_press() -> None:
    found = sb.load("rssr_press").motion().circuits[0].forces().sizing(unevenness=0.02)
    crank = found.bearings["crank"]
    numbers = [
        f"{found.peak_torque.value:.4g} N m at its shaft", f"{found.rms_torque:.4g} N m of it",
        f"{found.mean_torque:.4g} N m on average", f"highest with {found.peak_power.value:.4g} W",
        f"inertia of {found.flywheel:.4g} kg m^2", f"take {crank.radial.peak.value:.4g} N square",
        f"{crank.axial.peak.value:.4g} N along it", f"moment of {crank.tilting.peak.value:.4g} N m",
    ]  # fmt: skip
    assert [number for number in numbers if number not in PAGE] == []
