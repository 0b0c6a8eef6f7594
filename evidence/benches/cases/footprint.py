"""What it costs to have Sevenbar: the time of an import and of `--help`, the size of the installation."""

from __future__ import annotations

import os
import re
import resource
import subprocess
import sys
from importlib import metadata

from evidence.benches.harness import Work, compare
from evidence.benches.outcome import Cell, Outcome, Table, timed
from evidence.benches.setting import Setting

TITLE = "Import time and installed size"
ABOUT = """\
CPU time of a Python process that imports a package and ends, beside one that imports nothing; `sevenbar
--help` is the whole command. Sizes are the sums of the files' sizes that each distribution's own record
tells, in MB of 10^6 bytes: its own, and with all that it requires (optional parts left out), so also
NumPy, which most share."""

MEGABYTE = 1e6


def run(setting: Setting) -> Outcome:
    """Two tables."""
    return Outcome(TITLE, ABOUT, [imports(setting), sizes(setting)])


def imports(setting: Setting) -> Table:
    """Processes that import and end."""
    commands = {
        # its names are imported at their first use
        "import sevenbar": ["-c", "import sevenbar; sevenbar.load"],
        "nothing": ["-c", "pass"],
        "sevenbar --help": ["-m", "sevenbar.commands.cli", "--help"],
        "import numpy": ["-c", "import numpy"],
    }
    absent = []
    for peer in setting.peers.found.values():
        if peer.reason:
            absent.append((f"import {peer.module}", peer.reason))
        else:
            commands[f"import {peer.module}"] = ["-c", f"import {peer.module}"]
    works = [Work(who, lambda words=words: process(words)) for who, words in commands.items()]  # type: ignore[misc]
    timings = compare(works, rounds=setting.choose(7, 1), clock=children)
    return timed("import", "ms", timings, absent)


def process(words: list[str]) -> None:
    """One Python process to its end."""
    # colours and width of the terminal are none of its work
    environment = os.environ | {"TERM": "dumb"}
    subprocess.run([sys.executable, *words], check=True, capture_output=True, env=environment)


def children() -> float:
    """CPU time [s] of all processes that were waited for."""
    spent = resource.getrusage(resource.RUSAGE_CHILDREN)
    return spent.ru_utime + spent.ru_stime


def sizes(setting: Setting) -> Table:
    """Own and whole sizes."""
    rows: list[list[Cell]] = []
    for name in ("sevenbar", *setting.peers.found):
        reason = setting.peers.found[name].reason if name in setting.peers.found else ""
        try:
            whole = required(name)
        except metadata.PackageNotFoundError:
            rows.append([name, None, None, None, reason or "not installed"])
            continue
        own = recorded(name)
        if own is None:
            rows.append(
                [name, None, None, float(len(whole)), "installed in place, without a record of its files"]
            )
            continue
        rest = sum(recorded(other) or 0.0 for other in whole)
        rows.append([name, own / MEGABYTE, rest / MEGABYTE, float(len(whole)), reason])
    return Table("size", ["", "own [MB]", "with all required [MB]", "distributions", "note"], rows)


def recorded(name: str) -> float | None:
    """Bytes of a distribution's files by its record; nothing where it was installed in place."""
    distribution = metadata.distribution(name)
    if '"editable": true' in (distribution.read_text("direct_url.json") or ""):
        return None
    return float(sum(file.size or 0 for file in distribution.files or ()))


def required(name: str, seen: frozenset[str] = frozenset()) -> frozenset[str]:
    """A distribution and all that it requires here, by normal name; raises `PackageNotFoundError`."""
    from packaging.requirements import Requirement

    normal = re.sub(r"[-_.]+", "-", name).lower()
    seen |= {normal}
    for line in metadata.requires(normal) or []:
        requirement = Requirement(line)
        if requirement.marker is not None and not requirement.marker.evaluate({"extra": ""}):
            continue
        other = re.sub(r"[-_.]+", "-", requirement.name).lower()
        if other not in seen:
            try:
                seen |= required(other, seen)
            except metadata.PackageNotFoundError:
                continue
    return seen
