"""`sevenbar studio` as it is called: what is wrong is said before anything is served."""

import subprocess
import sys

import pytest

from command_runs import mistake, sevenbar

WITHOUT = """
import importlib.util
real = importlib.util.find_spec
importlib.util.find_spec = lambda name, package=None: None if name == "{}" else real(name, package)
"""


def test_a_file_with_mistakes_is_not_served(tmp_path):
    (tmp_path / "bad.toml").write_text("format = 1\n[rssr]\nM = 700\nN = 700\nL1 = -5\nL3 = 550\nD = 0\n")
    told = mistake("studio", "bad.toml", "--no-open", cwd=tmp_path)
    assert told == "bad.toml: rssr.L1: -5 is not a length; give a number > 0"
    assert mistake("studio", "nosuch", "--no-open", cwd=tmp_path).startswith("nosuch: no such file")


@pytest.mark.parametrize("host", ["999.1.1.1", "nowhere.invalid", "192.0.2.7"])
def test_an_address_that_is_none_of_this_machine_is_told_at_once(tmp_path, host):
    told = mistake("studio", "rssr", "--no-open", "--host", host, cwd=tmp_path)
    assert told.startswith(f"--host, --port: cannot serve at {host}:8077: ")
    assert told.endswith("; give another address")


@pytest.mark.parametrize("missing", ["viser", "tomlkit"])
def test_a_missing_extra_is_named(tmp_path, missing):
    told = mistake("studio", "rssr", "--no-open", cwd=tmp_path, before=WITHOUT.format(missing))
    assert told == f"studio needs {missing}; install it with: pip install 'sevenbar[studio]'"


def test_the_command_line_does_not_load_the_studio_without_need(tmp_path):
    run = sevenbar(
        "gallery",
        cwd=tmp_path,
        before="import sys, atexit\natexit.register(lambda: print('viser' in sys.modules))",
    )
    assert run.stdout.splitlines()[-1] == "False"


def test_it_ends_also_where_the_signal_reaches_another_thread():
    # a wait without end did not notice, and the program went on
    code = """
import signal, sys, threading, time
from sevenbar.studio.server import StudioServer

main = threading.main_thread().ident

def elsewhere():
    # once the program waits
    while sys._current_frames()[main].f_code is not StudioServer.wait.__code__:
        time.sleep(0.05)
    signal.pthread_kill(threading.get_ident(), signal.SIGINT)

signal.signal(signal.SIGINT, signal.default_int_handler)
threading.Thread(target=elsewhere, daemon=True).start()
StudioServer.wait(None)
"""
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=600)
    assert (run.returncode, run.stderr) == (0, "")
