"""What is written aside until it is whole: names that say whose it is, and what ended processes left."""

from __future__ import annotations

import os
import re
import shutil
from contextlib import suppress
from functools import cache
from pathlib import Path

#: How names of files and folders begin that are not whole; hidden, and after it whose they are.
ASIDE = ".partial-"

_OWNED = re.compile(r"\.partial-([0-9a-f]{8})-(\d+)-(\d+)-.*")


def aside_prefix() -> str:
    """How the name of what this process writes aside begins: machine, process and when that began."""
    own = os.getpid()
    return f"{ASIDE}{_machine()}-{own}-{_started(own)}-"


def clear_left(folder: Path) -> None:
    """Removes what processes of this machine wrote aside in a folder and left, since they were killed.

    What belongs to a process that is still there stays, and so does what another machine that shares the
    folder writes.
    """
    with suppress(OSError):
        for path in [entry for entry in folder.iterdir() if _is_left(entry.name)]:
            with suppress(OSError):
                if path.is_dir() and not path.is_symlink():
                    shutil.rmtree(path, ignore_errors=True)
                else:
                    path.unlink()


def _is_left(name: str) -> bool:
    owner = _OWNED.fullmatch(name)
    return owner is not None and owner[1] == _machine() and _is_gone(int(owner[2]), int(owner[3]))


def _is_gone(process: int, started: int) -> bool:
    """Whether a process has ended; its number may be that of a later one."""
    if os.name == "nt":  # where asking for a process ends it
        return False
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return True
    except (OSError, OverflowError):
        return False
    return _started(process) != started


def _started(process: int) -> int:
    """When a process began, in the system's own count; 0 where the system does not say."""
    try:
        content = Path(f"/proc/{process}/stat").read_bytes()
        # the command's name, in brackets, may have any characters
        return int(content.rpartition(b")")[2].split()[19])
    except (OSError, IndexError, ValueError):
        return 0


@cache
def _machine() -> str:
    """A mark of the machine, or of the container on it, that numbers processes."""
    # slow to import, and only what writes needs them
    import hashlib
    import socket

    space = ""
    with suppress(OSError):
        space = str(Path("/proc/self/ns/pid").readlink())
    return hashlib.sha256(f"{socket.gethostname()} {space}".encode()).hexdigest()[:8]
