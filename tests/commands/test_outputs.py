"""What is printed where standard output lacks characters, is full, is closed, or has no width."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from command_runs import sevenbar
from sevenbar.commands.output import plain_text

FULL = Path("/dev/full")


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("137 rad/s², 5 rad/s³", "137 rad/s^2, 5 rad/s^3"),
        ("10⁻¹² mm", "10^-12 mm"),
        ("75.1° ± 2", "75.1 deg +- 2"),
        ("θ₁ − θ₂", "theta1 - theta2"),
        ("┏━┓│╭╯├", "+-+|+++"),
        ("Schäfer, Françoise", "Schafer, Francoise"),
        ("驱动", "??"),
        ("plain", "plain"),
        ("", ""),
    ],
)
def test_what_an_encoding_lacks_reads_well(text, plain):
    assert plain_text(text) == plain


def called(*arguments: str, **how) -> subprocess.CompletedProcess[bytes]:
    environment = {**os.environ, **how.pop("environment", {})}
    command = [sys.executable, "-m", "sevenbar.commands.cli", *arguments]
    return subprocess.run(command, env=environment, stderr=subprocess.PIPE, check=False, timeout=600, **how)


@pytest.mark.parametrize("encoding", ["gbk", "ascii", "shift_jis", "cp932"])
def test_a_report_is_printed_in_any_encoding(encoding):
    run = called("analyze", "rssr", environment={"PYTHONIOENCODING": encoding}, stdout=subprocess.PIPE)
    assert (run.returncode, run.stderr) == (0, b"")
    assert "rocker acceleration max [rad/s^2]" in run.stdout.decode(encoding)


@pytest.mark.skipif(not FULL.exists(), reason="no output that is always full")
@pytest.mark.parametrize(
    "arguments",
    [["analyze", "rssr"], ["analyze", "rssr", "--json"], ["--help"], ["gallery", "rssr"]],
    ids=" ".join,
)
def test_a_full_output_is_one_line(arguments):
    with FULL.open("w") as full:
        run = called(*arguments, stdout=full)
    assert run.returncode == 2
    assert run.stderr.decode() == (
        "sevenbar: standard output: cannot be written: no space left on device; make room, or send it elsewhere\n"
    )


@pytest.mark.skipif(os.name == "nt", reason="no shell")
def test_a_closed_output_is_one_line():
    call = f"{sys.executable} -m sevenbar.commands.cli gallery rssr >&-"
    run = subprocess.run(call, shell=True, capture_output=True, check=False, timeout=600)
    assert run.returncode == 2
    assert run.stderr == (
        b"sevenbar: standard output: is closed; leave it open, or send it to a file or to /dev/null\n"
    )


def test_a_terminal_of_no_width_gets_the_usual_one(monkeypatch):
    usual = sevenbar("analyze", "rssr").stdout
    monkeypatch.setenv("COLUMNS", "0")
    assert sevenbar("analyze", "rssr").stdout == usual != ""


def test_another_backend_of_matplotlib_changes_nothing(tmp_path):
    backend = {"MPLBACKEND": "nonsense"}
    options = ["plot", "rssr", "--kind", "curves", "--out", str(tmp_path / "figures")]
    run = called(*options, environment=backend, stdout=subprocess.DEVNULL)
    assert run.returncode == 0
    assert [path.name for path in (tmp_path / "figures").iterdir()] == ["motion.png"]
