"""What a path leads to, for any path: one that no system takes, as of 5,000 letters, leads to nothing."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

AnyPath = str | os.PathLike[str]


def is_there(path: AnyPath) -> bool:
    """Whether there is anything."""
    with suppress(OSError, ValueError):
        return Path(path).exists()
    return False


def is_file(path: AnyPath) -> bool:
    """Whether it is a file.

    >>> is_file("x" * 5000)
    False
    """
    with suppress(OSError, ValueError):
        return Path(path).is_file()
    return False


def is_folder(path: AnyPath) -> bool:
    """Whether it is a folder."""
    with suppress(OSError, ValueError):
        return Path(path).is_dir()
    return False
