"""The peers: what the extra `peers` names, whether each is installed and imported here, and if not, why."""

from __future__ import annotations

import importlib
import json
import re
import subprocess
import sys
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import metadata
from types import ModuleType

from evidence import ROOT
from evidence.benches.harness import OutOfTimeError, told

#: The module that is used of each distribution, where it has another name.
MODULES = {
    "pin": "pinocchio",
    "ik-geo": "ik_geo",
    "EAIK": "eaik.IK_HP",
    "roboticstoolbox-python": "roboticstoolbox",
}

#: Longest import of a peer [s]; more, and it hangs.
LONGEST_IMPORT = 120.0

#: Longest installation of a peer [s], with what it brings along or has to compile.
LONGEST_INSTALL = 900.0


@dataclass(frozen=True)
class Peer:
    """A distribution: its name, version and `reason` why it is not here (empty: it is)."""

    name: str
    version: str = ""
    reason: str = ""

    @property
    def module(self) -> str:
        """The name that it is imported by."""
        return MODULES.get(self.name, self.name)


class AbsentError(Exception):
    """A peer that is not here, with the reason."""


class Peers:
    """All peers as they were found."""

    def __init__(self, found: Sequence[Peer]) -> None:
        self.found = {peer.name: peer for peer in found}

    def module(self, name: str, part: str = "") -> ModuleType:
        """The module of a peer, or one within it; `AbsentError` with the reason where there is none."""
        peer = self.found[name]
        if peer.reason:
            raise AbsentError(peer.reason)
        return importlib.import_module(f"{peer.module}.{part}" if part else peer.module)


def requirements() -> dict[str, str]:
    """The extra `peers` of pyproject.toml: requirement by the name of its distribution."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    listed = project["optional-dependencies"]["peers"]
    return {re.match(r"[\w.-]+", requirement)[0]: requirement for requirement in listed}  # type: ignore[index]


def installed(names: dict[str, str]) -> dict[str, str]:
    """Installs requirements one by one, against what is here already; reasons of those that fail, by name."""
    reasons = {}
    for name, requirement in names.items():
        print(f"installing {requirement}", file=sys.stderr)
        command = [sys.executable, "-m", "pip", "install", "--quiet", requirement, *_as_they_are()]
        try:
            run = subprocess.run(command, capture_output=True, text=True, timeout=LONGEST_INSTALL)
        except subprocess.TimeoutExpired:
            reasons[name] = f"not installed after {LONGEST_INSTALL:g} s"
            continue
        if run.returncode:
            errors = [line for line in run.stderr.splitlines() if line.startswith("ERROR")] or ["pip failed"]
            reasons[name] = "not installed: " + errors[0].removeprefix("ERROR: ")
    return reasons


def _as_they_are() -> list[str]:
    """What Sevenbar itself needs, held at the version that is here: no peer may change what is measured."""
    try:
        needed = metadata.requires("sevenbar") or []
    except metadata.PackageNotFoundError:
        return []
    names = [re.match(r"[\w.-]+", line)[0] for line in needed if "extra ==" not in line]  # type: ignore[index]
    return [f"{name}=={metadata.version(name)}" for name in names]


def looked_at(name: str, not_installed: str = "") -> Peer:
    """How a peer stands, by an import in another process, which may crash."""
    try:
        version = metadata.version(name)
    except metadata.PackageNotFoundError:
        return Peer(name, reason=not_installed or "not installed; `make bench` installs it")
    return Peer(name, version, import_failure(MODULES.get(name, name)))


def import_failure(module: str, longest: float = LONGEST_IMPORT) -> str:
    """Why a module cannot be imported in a process of its own; empty where it can."""
    try:
        run = subprocess.run(
            [sys.executable, "-c", f"import {module}"],
            capture_output=True,
            text=True,
            timeout=longest,
        )
    except subprocess.TimeoutExpired:
        return f"the import takes more than {longest:g} s"
    if run.returncode < 0:
        return f"the import ends by signal {-run.returncode}"
    if run.returncode:
        return "the import fails: " + (run.stderr.strip().splitlines() or ["no word of why"])[-1]
    return ""


def to_text(peers: Sequence[Peer]) -> str:
    """For another process."""
    return json.dumps([[peer.name, peer.version, peer.reason] for peer in peers])


def of_text(text: str) -> Peers:
    """From another process."""
    return Peers([Peer(*parts) for parts in json.loads(text)])


def reason_of(error: Exception) -> str:
    """What is told of a peer that is not here, or not as expected."""
    return str(error) if isinstance(error, (AbsentError, OutOfTimeError)) else told(error)
