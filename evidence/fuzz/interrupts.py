"""Interrupts commands at random moments: `python -m evidence.fuzz.interrupts`.

Each command runs in a folder of its own and gets Ctrl+C, SIGTERM or SIGHUP after a random time. It must end
with 130, 143 or 129, without a traceback, and leave no file half written: what is in the folder afterwards a
whole run leaves, too. Printed are the times from the signal to the end, and the processor's time in them,
which a loaded machine leaves as it is. A moment at which Python itself still starts, before the program can
heed anything, is counted apart.
"""

from __future__ import annotations

import argparse
import os
import random
import resource
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

#: A command is to end so soon [s]; printed, for a loaded machine is slower.
SOON = 0.5

#: Longest time [s] that a command is given to end.
LONGEST = 60.0

#: Signals, and how often each.
SIGNALS = {signal.SIGINT: 6, signal.SIGTERM: 2, signal.SIGHUP: 2}

COMMANDS = (
    "analyze rssr", "analyze rssr --json", "analyze rssr -o out", "analyze seven_r",
    "analyze seven_r -o out",
    "analyze seven_r --samples 100000", "modes seven_r --at 30deg", "modes seven_r -o modes.svg",
    "plot rssr -o figures",
    "plot seven_r -o figures --kind all", "forces rssr_press", "forces rssr_press -o out",
    "axodes rssr --link 2 -o out",
    "export rssr -o motion.csv", "export seven_r -o motion.xlsx",
    "export rssr --to step",
    "sweep rssr --over L1=100:400:300 --over L3=300:800:300 -o sweep",

    "map rssr --over L1=100:400 --over L3=300:800 -o maps",
    "tolerance rssr --tolerance L*=0.5mm -o tolerance",
    "design function --y x^2 --x 0:1 -o parabola",
)  # fmt: skip

#: Files that a stopped command keeps on purpose: parts of a sweep that are whole, and what goes with them.
KEPT = ("sweep.json", "part-")


@dataclass
class Tally:
    """What was seen of one command."""

    seconds: float
    times: list[float] = field(default_factory=list)
    works: list[float] = field(default_factory=list)
    ends: Counter[str] = field(default_factory=Counter)
    wrong: list[str] = field(default_factory=list)


def main() -> int:
    """Runs all commands; 1 where one did not end as it should."""
    parser = argparse.ArgumentParser(prog="python -m evidence.fuzz.interrupts", description=__doc__)
    parser.add_argument("--moments", type=int, default=50, help="interruptions of each command")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    # a shell starts what is in the background deaf to it, and so would be the commands
    signal.signal(signal.SIGINT, signal.default_int_handler)
    found = []
    for number, command in enumerate(COMMANDS):
        tally = interrupted(command, given.moments, random.Random(f"{given.seed} {number}"))
        found.append(tally)
        slow, work = max(tally.times, default=0.0), max(tally.works, default=0.0)
        ends = ", ".join(f"{count} {end}" for end, count in sorted(tally.ends.items()))
        print(
            f"{command:64} {tally.seconds:5.1f} s  slowest end {slow:5.2f} s, work {work:5.2f} s  {ends}",
            flush=True,
        )
        for line in tally.wrong:
            print(f"    wrong: {line}", flush=True)
    times = sorted(time for tally in found for time in tally.times)
    if times:
        late = sum(time > SOON for time in times)
        middle = times[len(times) // 2]
        print(f"{len(times)} ended by a signal: median {middle:.3f} s, longest {times[-1]:.2f} s, ", end="")
        print(f"{late} over {SOON} s")
        works = sorted(work for tally in found for work in tally.works)
        busy = sum(work > SOON for work in works)
        print(
            f"processor time after it: median {works[len(works) // 2]:.3f} s, longest {works[-1]:.2f} s, ",
            end="",
        )
        print(f"{busy} over {SOON} s")
    wrong = sum(len(tally.wrong) for tally in found)
    print(f"{wrong} wrong")
    return int(wrong > 0)


def interrupted(command: str, moments: int, draw: random.Random) -> Tally:
    """One command, whole once and then interrupted at so many moments."""
    with tempfile.TemporaryDirectory() as folder:
        begin = time.monotonic()
        with _begun(command, folder) as run:
            run.communicate(timeout=600)
        tally = Tally(time.monotonic() - begin)
        whole = _files(Path(folder))
        if run.returncode:
            tally.wrong.append(f"exit {run.returncode} without a signal")
            return tally
    kinds = [one for one, weight in SIGNALS.items() for _ in range(weight)]
    for _ in range(moments):
        _one(command, draw.uniform(0.0, tally.seconds), draw.choice(kinds), whole, tally)
    return tally


def _one(command: str, after: float, how: signal.Signals, whole: set[str], tally: Tally) -> None:
    with tempfile.TemporaryDirectory() as folder, _begun(command, folder) as run:
        time.sleep(after)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        at, was_over, spent = time.monotonic(), run.poll() is not None, _spent(run.pid)
        run.send_signal(how)
        try:
            _, errors = run.communicate(timeout=LONGEST)
        except subprocess.TimeoutExpired:
            run.kill()
            run.communicate()
            tally.wrong.append(f"{how.name} after {after:.3f} s: not ended {LONGEST:g} s later")
            return
        took, text = time.monotonic() - at, errors.decode(errors="replace")
        after_all = resource.getrusage(resource.RUSAGE_CHILDREN)
        work = after_all.ru_utime + after_all.ru_stime - before.ru_utime - before.ru_stime - spent
        left = _files(Path(folder))
        place = f"{how.name} after {after:.3f} s: exit {run.returncode}"
        strange = {name for name in left - whole if not Path(name).name.startswith(KEPT)}
        if strange:
            tally.wrong.append(f"{place}: half written: {', '.join(sorted(strange)[:3])}")
        if was_over or run.returncode == 0:
            tally.ends["over"] += 1
        elif run.returncode == 128 + how:
            tally.ends[how.name] += 1
            tally.times.append(took)
            tally.works.append(max(work, 0.0))
            if "Traceback" in text:
                tally.wrong.append(f"{place}: a traceback: {text.strip().splitlines()[-1]}")
        elif run.returncode == -how or (run.returncode == 1 and text.endswith("KeyboardInterrupt\n")):
            tally.ends["starting"] += 1
        else:
            tally.wrong.append(f"{place}: {text.strip()[-200:]}")


def _begun(command: str, folder: str) -> subprocess.Popen[bytes]:
    line = [sys.executable, "-m", "sevenbar", *command.split()]
    here = {**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
    return subprocess.Popen(
        line, cwd=folder, env=here, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )


def _spent(number: int) -> float:
    """Processor time [s] of a process so far; 0 where the system does not say."""
    try:
        words = Path(f"/proc/{number}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return 0.0
    return (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")


def _files(folder: Path) -> set[str]:
    found = (path for path in folder.rglob("*") if path.is_file() or path.name.startswith("."))
    return {str(path.relative_to(folder)) for path in found}


if __name__ == "__main__":
    sys.exit(main())
