"""The command line as a person calls it."""

import subprocess
import sys


def sevenbar(*arguments, cwd=None, before=""):
    """A call of the program; `before` is run in it first."""
    code = f"import sys\n{before}\nfrom sevenbar.cli import main\nmain()"
    start = ["-c", code] if before else ["-m", "sevenbar.cli"]
    command = [sys.executable, *start, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, cwd=cwd, timeout=120, check=False)


def mistake(*arguments, cwd=None, before=""):
    """The one message of a call that must end with exit 2 and print nothing else."""
    run = sevenbar(*arguments, cwd=cwd, before=before)
    assert (run.returncode, run.stdout) == (2, "")
    assert "Traceback" not in run.stderr
    return run.stderr.removeprefix("sevenbar: ").rstrip("\n")
