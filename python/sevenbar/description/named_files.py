"""The files that a file may name: those below its own folder, whoever wrote it."""

from __future__ import annotations

from pathlib import Path, PureWindowsPath

from sevenbar.errors import RequestError, shown


def file_below(folder: Path, name: str, example: str) -> Path:
    """The file that a file in `folder` names; one for the message is an `example`.

    Raises `RequestError` for a path from a root or a drive, and for one that leads out of the folder, by `..`
    or by a link; whether there is such a file is not in the message.
    """
    # read as Windows reads it, wherever this runs; and before a path of another machine is touched
    given = PureWindowsPath(name)
    if not given.drive and not given.root and not Path(name).is_absolute():
        path = folder / name
        try:
            if path.resolve().is_relative_to(folder.resolve()):
                return path
        except (OSError, RuntimeError, ValueError):  # a link to itself; a name that no file can have
            pass
    raise RequestError(
        f"{shown(name)} is not below the folder of this file, which reads no other files; "
        f"put it there and give its path from there, as in {shown(example)}"
    )
