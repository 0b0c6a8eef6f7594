"""The command line as a person calls it."""

import contextlib
import io
import subprocess
import sys
import time
from pathlib import Path

from sevenbar.commands.cli import main


def sevenbar(*arguments, cwd=None, before=""):
    """A call of the program; `before` is run in it first, and it is then a program of its own.

    Others are made within this process, which saves the second that a program needs to begin.
    """
    if before:
        code = f"import sys\n{before}\nfrom sevenbar.commands.cli import main\nmain()"
        command = [sys.executable, "-c", code, *map(str, arguments)]
        return subprocess.run(command, capture_output=True, text=True, cwd=cwd, timeout=600, check=False)
    out, err, argv = io.StringIO(), io.StringIO(), sys.argv
    sys.argv = ["sevenbar", *map(str, arguments)]
    try:
        with (
            contextlib.chdir(cwd or Path.cwd()),
            contextlib.redirect_stdout(out),
            contextlib.redirect_stderr(err),
        ):
            main()
    except SystemExit as end:
        return subprocess.CompletedProcess(sys.argv, end.code, out.getvalue(), err.getvalue())
    finally:
        sys.argv = argv


def mistake(*arguments, cwd=None, before=""):
    """The one message of a call that must end with exit 2 and print nothing else."""
    run = sevenbar(*arguments, cwd=cwd, before=before)
    assert (run.returncode, run.stdout) == (2, "")
    assert "Traceback" not in run.stderr
    return run.stderr.removeprefix("sevenbar: ").rstrip("\n")


def killed(*arguments, once):
    """Begins a call as a program of its own, and kills it `once` something is so."""
    command = [sys.executable, "-m", "sevenbar.commands.cli", *map(str, arguments)]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as run:
        while not once():
            assert run.poll() is None
            time.sleep(0.05)
        run.kill()
