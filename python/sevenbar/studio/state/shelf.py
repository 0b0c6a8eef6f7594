"""The files that a tab may save to: those of one folder, none of which is replaced unseen."""

from __future__ import annotations

import os
import stat
import tempfile
import threading
from contextlib import suppress
from pathlib import Path

from sevenbar.errors import OutputError, shown

#: Two tabs that save do so one after the other.
_SAVING = threading.Lock()

#: What files of linkages end in, and what Windows' editors begin them with.
ENDING, MARK = ".toml", b"\xef\xbb\xbf"


#: What no name of a file has: separators of folders, and what Windows keeps for itself.
_NO_NAME = frozenset('\\/:*?"<>|')
_DEVICES = frozenset(
    {"CON", "PRN", "AUX", "NUL", *(f"{port}{n}" for port in ("COM", "LPT") for n in range(10))}
)


class ChangedError(OutputError):
    """A file that is not as the studio knows it, and so is not replaced without a question."""


class Shelf:
    """The files of a folder, with what this tab has read from each, or written to it."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._known: dict[Path, bytes] = {}

    def read(self, path: Path) -> bytes:
        """The content of a file, which is then known; raises `OSError`."""
        content = path.read_bytes()
        self._known[path.resolve()] = content
        return content

    def save(self, name: str, text: str, *, replace: bool = False) -> Path:
        """Writes a text to the file of a name, whole or not at all; its path.

        Raises `ChangedError` where there is such a file that this tab has not read or written, or that has
        changed since, unless it is to be replaced; `OutputError` where it cannot be written.
        """
        path = self._path(name)
        with _SAVING:
            there = _content(path)
            known = self._known.get(path)
            if not replace and there != known:
                raise ChangedError(
                    f"{path.name}: {_difference(there, known)}; replace it, or give another name"
                )
            content = _in_style(text, there)
            _replace(path, content)
            self._known[path] = content
        return path

    def _path(self, name: str) -> Path:
        name = name.strip()
        bare = name.partition(".")[0].strip().upper()
        plain = name.isprintable() and not name.startswith(".") and _NO_NAME.isdisjoint(name)
        if not name or not plain or Path(name).name != name or bare in _DEVICES:
            raise OutputError(
                f"file: {shown(name)} is not the name of a file in {self.folder}; "
                "give a name without folders, as in linkage.toml"
            )
        path = (self.folder / (name if name.endswith(ENDING) else name + ENDING)).resolve()
        # one that was opened by its link is this tab's own
        if path not in self._known and path.parent != self.folder.resolve():
            raise OutputError(f"file: {shown(name)} is a link out of {self.folder}; give another name")
        return path


def _content(path: Path) -> bytes | None:
    """What is in a file now; `None` where there is none."""
    try:
        return path.read_bytes()
    except FileNotFoundError:
        return None
    except OSError as error:
        raise _unwritable(path, error) from None


def _difference(there: bytes | None, known: bytes | None) -> str:
    if there is None:
        return "it was here when it was read, and is gone now"
    return "it exists already" if known is None else "it has changed since it was read"


def _in_style(text: str, there: bytes | None) -> bytes:
    """A text as the bytes of a file, with the mark and the ends of lines that the file had."""
    content = text.replace("\r\n", "\n").encode()
    if there is not None and b"\n" in there and there.count(b"\r\n") == there.count(b"\n"):
        content = content.replace(b"\n", b"\r\n")
    return (MARK if there is not None and there.startswith(MARK) else b"") + content


def _replace(path: Path, content: bytes) -> None:
    """Puts a file with this content in the place of another, which keeps its rights."""
    aside = None
    try:
        with suppress(FileNotFoundError):
            if not os.access(path, os.W_OK) and path.exists():
                raise PermissionError(13, "it may not be written")
        handle, aside = tempfile.mkstemp(prefix=".partial-", dir=path.parent)
        with os.fdopen(handle, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        mask = os.umask(0)
        os.umask(mask)
        with suppress(FileNotFoundError):
            mask = ~stat.S_IMODE(path.stat().st_mode)
        Path(aside).chmod(0o666 & ~mask)
        Path(aside).replace(path)
    except OSError as error:
        if aside is not None:
            Path(aside).unlink(missing_ok=True)
        raise _unwritable(path, error) from None


def _unwritable(path: Path, error: OSError) -> OutputError:
    reason = (error.strerror or str(error)).lower()
    return OutputError(f"{path}: cannot be written: {reason}; give another name, or download it")
