"""How long each command is silent: seconds from the end of its imports to its first output on a terminal.

    python -m evidence.benches.first_output [COMMAND ..]

A command is run once to see which modules it imports. Then a new process imports these, says so, and runs the
command on a pseudo-terminal, where the first character is waited for. Times are those of this machine as it
is; LIMIT is what a person takes for an answer.
"""

from __future__ import annotations

import os
import pty
import select
import shlex
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from evidence import ROOT

#: What a command may take to its first output beyond its imports [s].
LIMIT = 0.5

#: A command that takes longer is ended [s].
PATIENCE = 300.0

COMMANDS = (
    "gallery",
    "analyze rssr",
    "analyze seven_r --json",
    "analyze rssr --samples 1e6 --json",
    "analyze seven_r --out out",
    "analyze rssr --animate move.gif",
    "modes seven_r --at 30",
    "modes seven_r --out modes.png",
    "plot seven_r --out out",
    "compare rssr EXAMPLES/rssr_table1.csv",
    "calibrate rssr EXAMPLES/rssr_bench.csv --hold D --offset input,output",
    "simulate rssr",
    "simulate rssr --engine mujoco",
    "export rssr --to csv",
    "export rssr --to mat",
    "export rssr --to glb",
    "export rssr --to stl",
    "export rssr --to step",
    "export rssr --to urdf",
    "export rssr --to mjcf",
    "export rssr --to adams",
    "sweep rssr --over L1=100:400:31 --over L3=300:800:51",
    "map rssr --over L1=100:400 --over L3=300:800",
    "tolerance rssr --tolerance L*=0.5mm",
    "design function --y x^2 --x 0:1",
    "design swing --swing 60deg --time-ratio 1.2",
    "design path planar_4r --path EXAMPLES/coupler_curve.csv --link 2 --at 0,-50,20 --starts 2",
    "design point seven_r --link 4 --box=-200:200,-200:200,-200:200",
    "design inertia seven_r --mass P=2.5",
    "studio rssr --no-open --port 0",
)

#: Commands that go on until they are ended.
ENDLESS = ("studio",)

#: Runs the command, and leaves the names of the modules that it needed.
LISTING = """
import sys
from pathlib import Path
from sevenbar.commands.cli import main
sys.argv[:] = ["sevenbar", *sys.argv[2:]]
listed = Path({listed!r})
try:
    main()
finally:
    listed.write_text("\\n".join(sys.modules))
"""

#: Imports modules, says so through a pipe, and runs the command.
RUNNING = """
import importlib, os, sys
from pathlib import Path
from sevenbar.commands.cli import main
for name in Path({listed!r}).read_text().split():
    try:
        importlib.import_module(name)
    except Exception:
        pass
os.write({pipe}, b"!")
sys.argv[:] = ["sevenbar", *sys.argv[2:]]
main()
"""


@dataclass(frozen=True)
class Silence:
    """A command, and seconds: of its imports, from there to its first output, and to its end."""

    command: str
    imports: float
    first: float
    end: float


def silence(command: str) -> Silence:
    """How long a command is silent."""
    words = [word.replace("EXAMPLES", str(ROOT / "examples")) for word in shlex.split(command)]
    with tempfile.TemporaryDirectory() as folder:
        listed = Path(folder) / "modules.txt"
        once, again = Path(folder) / "once", Path(folder) / "again"
        once.mkdir()
        again.mkdir()
        _list_modules(words, listed, once)
        return _timed(command, words, listed, again)


def _call(code: str, words: list[str]) -> list[str]:
    return [sys.executable, "-c", code, "--", *words]


def _list_modules(words: list[str], listed: Path, folder: Path) -> None:
    quiet = subprocess.DEVNULL
    process = subprocess.Popen(
        _call(LISTING.format(listed=str(listed)), words), cwd=folder, stdout=subprocess.PIPE, stderr=quiet
    )
    if words[0] in ENDLESS:
        assert process.stdout is not None
        process.stdout.read(1)
        process.send_signal(signal.SIGINT)
    process.communicate(timeout=PATIENCE)


def _timed(command: str, words: list[str], listed: Path, folder: Path) -> Silence:
    terminal, end = pty.openpty()
    ready, pipe = os.pipe()
    begun = time.perf_counter()
    process = subprocess.Popen(
        _call(RUNNING.format(listed=str(listed), pipe=pipe), words),
        cwd=folder, stdin=end, stdout=end, stderr=end, pass_fds=[pipe], start_new_session=True,
    )  # fmt: skip
    os.close(end)
    os.close(pipe)
    try:
        os.read(ready, 1)
        imported = time.perf_counter()
        first = None
        while True:
            there, _, _ = select.select([terminal], [], [], PATIENCE)
            if not there or not _read(terminal):
                break
            first = first or time.perf_counter()
            if words[0] in ENDLESS:
                break
        last = time.perf_counter()
    finally:
        process.kill()
        process.wait()
        os.close(terminal)
        os.close(ready)
    return Silence(command, imported - begun, (first or last) - imported, last - imported)


def _read(terminal: int) -> bytes:
    try:
        return os.read(terminal, 65536)
    except OSError:
        # how the end of a terminal shows
        return b""


def main(commands: list[str]) -> None:
    """Prints the table."""
    print(f"{'command':84} {'imports s':>9} {'first output s':>14} {'end s':>8}")
    late = 0
    for command in commands or COMMANDS:
        found = silence(command)
        late += found.first > LIMIT
        mark = "  late" if found.first > LIMIT else ""
        end = "" if found.command.split()[0] in ENDLESS else f"{found.end:.2f}"
        print(f"{found.command:84} {found.imports:9.2f} {found.first:14.2f} {end:>8}{mark}", flush=True)
    print(f"\n{late} later than {LIMIT} s")


if __name__ == "__main__":
    main(sys.argv[1:])
