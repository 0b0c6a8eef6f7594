"""Programs that serve a page, as a person starts and ends them."""

import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

#: Until the address is printed, and until the program has ended [s]: guards against hanging.
START, END = 600.0, 600.0


def _hear_the_terminal():
    """What a shell starts in the background, or `nohup`, is deaf to signals, and so would be all that tests start."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    signal.signal(signal.SIGHUP, signal.SIG_DFL)


class Served:
    """A program that prints its address `http://HOST:PORT`, or one with a path, and serves until it is ended.

    It runs in `folder / "here"`, which is empty before; what it prints is kept beside that.
    """

    def __init__(self, command, folder):
        self.here = folder / "here"
        self.here.mkdir(parents=True)
        self._out, self._err = folder / "stdout.txt", folder / "stderr.txt"
        with self._out.open("w") as out, self._err.open("w") as err:
            start = {"cwd": self.here, "stdin": subprocess.DEVNULL, "stdout": out, "stderr": err}
            self.process = subprocess.Popen([*map(str, command)], preexec_fn=_hear_the_terminal, **start)
        self.stopped = False
        self.url = self._address()

    def _address(self):
        end = time.monotonic() + START
        while time.monotonic() < end:
            if found := re.search(r"http://[\w.]+:\d+(?:/[\w-]+/)?(?=\s)", self.stdout):
                return found[0]
            if not self.runs:
                break
            time.sleep(0.05)
        self.process.kill()
        self.process.wait()
        return pytest.fail(
            f"no address from {self.process.args}\n{self.stdout}\n{self.stderr}", pytrace=False
        )

    @property
    def stdout(self):
        """What it printed so far."""
        return self._out.read_text()

    @property
    def stderr(self):
        """What it complained of so far."""
        return self._err.read_text()

    def memory(self):
        """The memory it holds now [MB]; Linux."""
        status = Path(f"/proc/{self.process.pid}/status").read_text()
        return int(re.search(r"VmRSS:\s+(\d+) kB", status)[1]) / 1024

    @property
    def runs(self):
        """Whether it still runs."""
        return self.process.poll() is None

    def stop(self, how=signal.SIGINT):
        """End it, as Ctrl+C does or with another signal; its exit code. It must have run, and leave no traceback."""
        ran, self.stopped = self.runs, True
        self.process.send_signal(how)
        try:
            code = self.process.wait(END)
        finally:
            self.process.kill()
            self.process.wait()
        assert ran, f"ended by itself with {code}\n{self.stderr}"
        assert "Traceback" not in self.stderr, self.stderr
        return code


class Studio(Served):
    """`sevenbar studio ARGUMENTS`, on a free port and without opening a browser."""

    def __init__(self, *arguments, folder):
        command = [
            sys.executable,
            "-m",
            "sevenbar.commands.cli",
            "studio",
            *arguments,
            "--port",
            "0",
            "--no-open",
        ]
        super().__init__(command, folder)
