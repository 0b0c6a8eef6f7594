"""Long work says what is done on the error stream: a bar on a terminal, one plain line elsewhere."""

import contextlib
import io

import pytest
import typer

from command_runs import sevenbar
from sevenbar.commands.progress import progress_bar
from sevenbar.errors import RequestError


class Terminal(io.StringIO):
    def isatty(self):
        return True


@contextlib.contextmanager
def on_a_terminal(monkeypatch):
    monkeypatch.setenv("COLUMNS", "100")
    monkeypatch.setenv("TERM", "xterm")
    with contextlib.redirect_stderr(Terminal()) as error:
        yield error


def test_elsewhere_than_on_a_terminal_one_plain_line_says_what_is_done(capsys):
    with progress_bar("mapping the RSSR") as progress:
        for done in range(4):
            progress(done, 3, "best 0.1 deg")
    assert capsys.readouterr() == ("", "mapping the RSSR ..\n")


def test_a_terminal_shows_the_bar_and_the_best_so_far(monkeypatch, capsys):
    with on_a_terminal(monkeypatch) as terminal, progress_bar("mapping [the] RSSR") as progress:
        progress(0, 3)
        assert "mapping [the] RSSR" in terminal.getvalue()
        progress(3, 3, "best 0.125 deg")
    assert "3/3" in terminal.getvalue()
    assert "best 0.125 deg" in terminal.getvalue()
    assert capsys.readouterr().out == ""


def test_work_that_reports_nothing_shows_nothing(monkeypatch):
    with on_a_terminal(monkeypatch) as terminal, progress_bar("mapping"):
        pass
    assert terminal.getvalue() == ""


def ended_by(error, **options):
    with progress_bar("searching", **options) as progress:
        progress(1, 3)
        raise error


def test_a_refusal_takes_the_bar_away(monkeypatch):
    with on_a_terminal(monkeypatch) as terminal, pytest.raises(RequestError):
        ended_by(RequestError("over: no"))
    erase_the_line = "\x1b[2K"
    assert "searching" in terminal.getvalue()
    assert terminal.getvalue().endswith(erase_the_line)


def test_a_total_that_is_not_known_is_none(monkeypatch):
    with on_a_terminal(monkeypatch) as terminal, progress_bar("searching") as progress:
        progress(2, 0)
    assert "2/?" in terminal.getvalue()


def test_ctrl_c_says_what_is_kept(capsys):
    with pytest.raises(typer.Exit) as end:
        ended_by(KeyboardInterrupt(), kept="two parts are kept")
    assert end.value.exit_code == 130
    assert capsys.readouterr().err == "searching ..\nsevenbar: stopped; two parts are kept\n"


STOP = """
import importlib
def interrupted(*_, progress=None, **__):
    progress(0, 10)
    raise KeyboardInterrupt
importlib.import_module("sevenbar.{module}").{name} = interrupted
"""


@pytest.mark.parametrize(
    ("module", "name", "command"),
    [
        ("sweep.run", "carry_out", ["sweep", "rssr", "--over", "L1=200:300:3"]),
        ("design.maps.atlas", "motion_map", ["map", "rssr", "--over", "L1=100:400", "--over", "L3=300:800"]),
    ],
)
def test_ctrl_c_leaves_no_file(module, name, command, tmp_path):
    run = sevenbar(*command, "--out", "found", cwd=tmp_path, before=STOP.format(module=module, name=name))
    assert run.returncode == 130
    assert run.stdout == ""
    assert run.stderr.splitlines()[1].startswith("sevenbar: stopped; ")
    assert not list(tmp_path.iterdir())
