"""When, from what and on what machine results were made, for all pages of evidence."""

from __future__ import annotations

import importlib.metadata
import os
import platform
import subprocess
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from evidence import ROOT

#: What results come from; pages and results of other runs may differ.
SOURCES = ("crates", "python", "evidence")


def circumstances(*packages: str) -> dict[str, Any]:
    """Date, commit (with a note where sources differ from it), machine, versions of these packages, too."""
    from sevenbar.kinematics.solvers.batches import simd_level

    named = ("sevenbar", "numpy", *packages)
    return {
        "date": datetime.now(UTC).date().isoformat(),
        "commit": commit(),
        "machine": {
            "processor": processor(),
            "cores": cores(),
            "system": f"{platform.system()} {platform.machine()}",
            "vector unit": simd_level(),
        },
        "versions": {"Python": platform.python_version()} | {name: version(name) for name in named},
    }


def in_words(made: Mapping[str, Any]) -> str:
    """The same in words, as `2026-11-21, commit 0a1b2c3, on ..; Python 3.11.7, ..`."""
    machine = made["machine"]
    versions = ", ".join(f"{name} {version}" for name, version in made["versions"].items())
    return (
        f"{made['date']}, commit {made['commit']}, on {machine['processor']} ({machine['cores']} cores, "
        f"{machine['system']}, {machine['vector unit']}); {versions}"
    )


def commit() -> str:
    """The commit of the source tree, "unknown" outside of one."""
    try:
        name = _git("rev-parse", "--short=10", "HEAD")
        changed = _git("status", "--porcelain", "--untracked-files=no", "--", *SOURCES)
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
    return f"{name} and changes" if changed else name


def _git(*words: str) -> str:
    run = subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=True)
    return run.stdout.strip()


def processor() -> str:
    """The processor's name, as far as the system gives it."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(names, "") or platform.processor() or platform.machine()


def cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def version(name: str) -> str:
    """Of an installed package; "not installed" where there is none."""
    try:
        return importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return "not installed"
