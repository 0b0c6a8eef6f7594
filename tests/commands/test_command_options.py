"""What every command takes and says: `-h`, `-o`, one of an option, counts, `--yes`, completion, Ctrl+C."""

import contextlib
import io
import os
import re
import subprocess
import sys

import pytest
import typer

from command_runs import mistake, sevenbar
from sevenbar.commands.cli import app
from sevenbar.commands.command import EXAMPLES
from sevenbar.commands.consent import Ahead, confirm
from sevenbar.errors import RequestError
from sevenbar.export import ALIASES, FORMATS, INSTEAD


def commands(group=None, words=()):
    group = group or typer.main.get_command(app)
    context = typer.Context(group)
    for name in group.list_commands(context):
        command = group.get_command(context, name)
        if hasattr(command, "list_commands"):
            yield from commands(command, (*words, name))
        else:
            yield (*words, name), command


@pytest.mark.parametrize("words", [(), *(words for words, _ in commands())], ids=" ".join)
def test_h_is_help(words):
    short, long = sevenbar(*words, "-h"), sevenbar(*words, "--help")
    assert short.returncode == long.returncode == 0
    assert short.stdout == long.stdout
    assert "Usage: sevenbar" in short.stdout


@pytest.mark.parametrize(
    ("words", "command"), list(commands()), ids=lambda part: " ".join(part) if isinstance(part, tuple) else ""
)
def test_every_command_has_examples_that_it_can_read_and_o_for_out(words, command):
    calls = EXAMPLES[words[-1]]
    shown = " ".join(re.sub(r"[│╭╰─╮╯]", " ", sevenbar(*words, "-h").stdout).split())
    for call in calls:
        assert " ".join(call.split()) in shown
        assert call.startswith(f"sevenbar {' '.join(words)}")
    for parameter in command.params:
        assert ("--out" in parameter.opts) == ("-o" in parameter.opts)


def test_o_is_out(tmp_path):
    assert sevenbar("modes", "bennett", "-o", "modes.svg", cwd=tmp_path).returncode == 0
    assert (tmp_path / "modes.svg").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ["analyze", "rssr", "--input", "crank", "--input", "rocker"],
            "--input: given 2 times; one joint drives, so give one of them "
            "(loops with two inputs are not covered)",
        ),
        (
            ["modes", "rssr", "--input=crank", "--at", "3", "--input", "crank"],
            "--input: given 2 times; one joint drives, so give one of them "
            "(loops with two inputs are not covered)",
        ),
        (["export", "rssr", "--to", "csv", "--to", "mat"], "--to: given 2 times; give it once"),
        (["analyze", "rssr", "-o", "a", "--out", "b"], "--out: given 2 times; give it once"),
        (["design", "swing", "--swing", "60", "--swing", "70"], "--swing: given 2 times; give it once"),
        (
            ["analyze", "rssr", "--samples", "many"],
            "--samples: 'many' is not a count; give a whole number, as in 360 or 1e6",
        ),
        (
            ["analyze", "rssr", "--samples", "36.5"],
            "--samples: '36.5' is not a count; give a whole number, as in 360 or 1e6",
        ),
        (
            ["analyze", "rssr", "--samples", "nan"],
            "--samples: 'nan' is not a count; give a whole number, as in 360 or 1e6",
        ),
        (["analyze", "rssr", "--samples", "1e9"], "samples: 1000000000 is not a count; give 4 to 1000000"),
        (
            ["simulate", "rssr", "--steps", "x"],
            "--steps: 'x' is not a count; give a whole number, as in 360 or 1e6",
        ),
    ],
)
def test_each_mistake_ends_with_its_message(tmp_path, arguments, message):
    assert mistake(*arguments, cwd=tmp_path) == message
    assert not list(tmp_path.iterdir())


def test_a_count_may_have_an_exponent_and_flags_may_be_repeated():
    run = sevenbar("analyze", "rssr", "--samples", "1.2e1", "--json", "--json")
    assert (run.returncode, run.stderr) == (0, "")
    assert '"samples": 12,' in run.stdout


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ["analyze", "rssr", "--samples", "1e6", "--out", "big"],
            r"--samples: motion\.csv of 2,000,000 rows, about 1\.[78] GB, some \d+ min; give --yes to go on",
        ),
        (
            ["export", "seven_r", "--samples", "200000", "--to", "csv"],
            r"--samples: seven_r\.csv of 1,600,000 rows, about [\d.]+ (MB|GB), .*; give --yes to go on",
        ),
        (
            ["simulate", "rssr", "--steps", "1e6"],
            r"--steps: 1000000 steps in exudyn, some \d+ min; give --yes to go on",
        ),
    ],
)
def test_much_output_and_long_work_are_refused_where_nobody_answers(tmp_path, arguments, message):
    assert re.fullmatch(message, mistake(*arguments, cwd=tmp_path))
    assert not list(tmp_path.iterdir())


def test_the_size_that_is_announced_is_the_size_that_is_written(tmp_path, monkeypatch):
    from sevenbar.commands import consent

    monkeypatch.setattr(consent, "LONG", 300)
    monkeypatch.setattr(consent, "MUCH", 0.0)
    told = mistake("export", "rscr", "--to", "csv", cwd=tmp_path)
    announced = float(re.search(r"about (\d+) MB", told).group(1))
    assert sevenbar("export", "rscr", "--to", "csv", "--yes", cwd=tmp_path).returncode == 0
    size = (tmp_path / "rscr.csv").stat().st_size / 1e6
    assert announced == pytest.approx(size, abs=0.5 + 0.1 * size)


class Terminal(io.StringIO):
    def isatty(self):
        return True


@contextlib.contextmanager
def answered(monkeypatch, answer):
    monkeypatch.setattr(sys, "stdin", Terminal(answer))
    with contextlib.redirect_stderr(Terminal()) as error:
        yield error


def test_at_a_terminal_it_asks(monkeypatch):
    much = Ahead("--samples", "rows.csv", bytes=3e9)
    with answered(monkeypatch, "y\n") as error:
        confirm(much, yes=False)
    assert "--samples: rows.csv, about 3.0 GB; go on?" in error.getvalue()
    with answered(monkeypatch, "n\n") as error, pytest.raises(typer.Exit) as end:
        confirm(much, yes=False)
    assert end.value.exit_code == 2
    assert "nothing is written" in error.getvalue()


def test_it_asks_only_before_much():
    confirm(Ahead("--samples", "rows.csv", bytes=1e8, seconds=30), yes=False)
    confirm(Ahead("--samples", "rows.csv", bytes=1e12), yes=True)
    with pytest.raises(RequestError, match=r"--steps: a run, about a minute; give --yes"):
        confirm(Ahead("--steps", "a run", seconds=70), yes=False)


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("sevenbar ana", {"analyze"}),
        ("sevenbar design sw", {"swing"}),
        ("sevenbar analyze benn", {"bennett"}),
        ("sevenbar export rssr --to ad", {"adams"}),
        # the shell goes on with its files
        ("sevenbar analyze mine.to", set()),
        ("sevenbar gallery jan", {"jansen"}),
        ("sevenbar studio wat", {"watt"}),
    ],
)
def test_the_shell_completes_commands_options_and_names(line, words):
    told = os.environ | {
        "_SEVENBAR_COMPLETE": "complete_bash",
        "COMP_WORDS": line,
        "COMP_CWORD": str(line.count(" ")),
    }
    command = [sys.executable, "-m", "sevenbar.commands.cli"]
    run = subprocess.run(command, env=told, capture_output=True, text=True, check=False, timeout=600)
    assert set(run.stdout.split()) == words


INTERRUPTED = """
import sevenbar.drawing.plot as plot
def interrupted(*_, **__):
    raise KeyboardInterrupt
plot.configuration = interrupted
"""


def test_ctrl_c_leaves_whole_files_and_says_which(tmp_path):
    run = sevenbar("analyze", "rssr", "--samples", 12, "-o", "out", cwd=tmp_path, before=INTERRUPTED)
    assert run.returncode == 130
    assert run.stdout.startswith("RSSR of Sun and Zhou")
    kept = ["motion.csv", "motion.png", "report.json"]
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == kept
    assert run.stderr.splitlines()[-1].startswith("sevenbar: stopped; these files are whole and kept: ")
    assert all(f"out/{name}" in run.stderr for name in kept)
    assert (tmp_path / "out" / "motion.csv").read_text().count("\n") == 25


@pytest.mark.parametrize("film", ["move.gif", "out/move.gif"])
def test_ctrl_c_while_a_film_is_drawn_keeps_the_folder_and_says_so(tmp_path, film):
    before = INTERRUPTED.replace("plot", "animate").replace("configuration", "animate")
    arguments = ("analyze", "rssr", "--samples", 12, "-o", "out", "--animate", film)
    run = sevenbar(*arguments, cwd=tmp_path, before=before)
    assert run.returncode == 130
    names = [path.name for path in (tmp_path / "out").iterdir()]
    assert {"motion.csv", "report.json", "configuration.png"} <= set(names)
    last = run.stderr.splitlines()[-1]
    assert last.startswith("sevenbar: stopped; these files are whole and kept: ")
    assert all(f"out/{name}" in last for name in names)
    assert not list(tmp_path.rglob("move*"))


def test_ctrl_c_before_the_first_file_leaves_nothing(tmp_path):
    before = INTERRUPTED.replace("configuration", "curves")
    run = sevenbar(
        "plot", "rssr", "--samples", 12, "--kind", "curves", "-o", "out", cwd=tmp_path, before=before
    )
    assert run.returncode == 130
    assert run.stderr.splitlines()[-1] == "sevenbar: stopped; nothing is written"
    assert not list(tmp_path.iterdir())


def test_ctrl_c_in_a_computation_is_no_fault():
    stop = "import sevenbar as sb\ndef stop(*_, **__):\n    raise KeyboardInterrupt\nsb.load = stop"
    run = sevenbar("analyze", "rssr", before=stop)
    assert (run.returncode, run.stdout) == (130, "")
    assert run.stderr == "sevenbar: stopped; nothing is written\n"


SLOW_FIGURE = """
import sevenbar.drawing.plot as plot, sevenbar.errors, sys
def seen(*_, **__):
    raise sevenbar.errors.RequestError("printed by now: " + str(printed))
printed, write = [], sys.stdout.write
sys.stdout.write = lambda text: (printed.append(len(text)), write(text))[1]
plot.curves = seen
"""


def test_the_report_is_printed_before_the_first_figure_is_drawn(tmp_path):
    run = sevenbar("analyze", "rssr", "-o", "out", cwd=tmp_path, before=SLOW_FIGURE)
    assert run.returncode == 2
    assert "crank-rocker" in run.stdout
    assert "written" not in run.stdout
    assert not list(tmp_path.iterdir())


def test_words_of_other_programs_name_a_format():
    assert ALIASES["adams"] == "cmd"
    assert ALIASES["matlab"] == "mat"
    assert set(ALIASES.values()) <= set(FORMATS)
    assert not set(INSTEAD) & set(ALIASES)


def test_a_model_says_whose_masses_it_holds(tmp_path):
    from sevenbar.forces.solids import DENSITIES

    run = sevenbar("export", "rssr", "--to", "adams", cwd=tmp_path)
    assert run.returncode == 0, run.stderr
    assert (tmp_path / "rssr.cmd").exists()
    assert (
        f"masses are assumed: those of the drawn bodies in steel, {DENSITIES['steel']:g} kg/m^3" in run.stdout
    )
    assert (
        "masses are assumed: 1 kg for every body"
        in sevenbar("export", "rssr", "--to", "mujoco", cwd=tmp_path).stdout
    )
    assert "mass" not in sevenbar("export", "rssr", "--to", "csv", cwd=tmp_path).stdout


def test_a_format_that_is_not_written_is_answered_with_one_that_is(tmp_path):
    told = mistake("export", "rssr", "--to", "dxf", cwd=tmp_path)
    assert told.startswith("to: 'dxf' is not a format; no flat drawings are written; give step for CAD")
