"""A folder that a run fills part by part: described first, held against a second run, taken up again."""

from __future__ import annotations

import json
import os
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from itertools import chain
from pathlib import Path
from typing import Any, ClassVar, Protocol

from sevenbar.errors import OutputError, RequestError, shown

#: The end of the name of a file that is not yet whole; the name begins with a dot.
ASIDE = ".aside"


class Parted(Protocol):
    """Work on many linkages that is done part by part."""

    @property
    def parts(self) -> int:
        """The number of parts."""

    def request(self) -> dict[str, Any]:
        """What it is, as plain values."""

    def linkages(self, part: int) -> range:
        """The linkages of a part."""


class HeldFolder:
    """A folder of parts; held against a second run as long as it is open."""

    #: The name of the description's file, and the word for what the folder holds, for messages.
    description: ClassVar[str]
    what: ClassVar[str]

    def __init__(self, path: Path, plan: Parted) -> None:
        self.path, self._plan = path, plan
        self._lock: int | None = None

    @property
    def done(self) -> Collection[int]:
        """The parts that are there."""
        raise NotImplementedError

    def close(self) -> None:
        """Lets another run have the folder."""
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None

    @contextmanager
    def _opened(self) -> Iterator[bool]:
        """Makes and locks the folder; yields whether it has a description, then clears half-written files.

        Unlocks the folder where what follows fails. Raises `OutputError` for a folder of something else, and
        where it cannot be written.
        """
        try:
            self.path.mkdir(parents=True, exist_ok=True)
            self._lock = hold_folder(self.path)
            names = sorted(file.name for file in self.path.iterdir())
            aside = [name for name in names if self._is_aside(name)]
            strange = [name for name in names if name not in aside]
            if strange and self.description not in names:
                raise OutputError(
                    f"{self.path}: holds {shown(strange[0])} and no {self.description}; "
                    "give an empty folder or a new one"
                )
            yield self.description in names
            for name in aside:
                (self.path / name).unlink(missing_ok=True)
        except OSError as error:
            self.close()
            raise self._unwritable(error) from None
        except BaseException:
            self.close()
            raise

    def _is_file(self, name: str) -> bool:
        """Whether a name is that of a file which `_put` writes."""
        return name == self.description

    def _is_aside(self, name: str) -> bool:
        """Whether a name is that of a half-written file of a run that was killed."""
        return name.startswith(".") and name.endswith(ASIDE) and self._is_file(name[1 : -len(ASIDE)])

    def _describe(self, description: Mapping[str, Any]) -> None:
        self._put(self.description, (json.dumps(description, indent=1, ensure_ascii=False) + "\n").encode())

    def _put(self, name: str, content: bytes) -> None:
        """Writes a file aside, brings it to the disk and renames it."""
        aside = self.path / f".{name}{ASIDE}"
        try:
            with aside.open("wb") as file:
                file.write(content)
                file.flush()
                os.fsync(file.fileno())
            aside.replace(self.path / name)
            if self._lock is not None:
                # brings the new name itself to the disk
                os.fsync(self._lock)
        except BaseException:
            with suppress(OSError):
                aside.unlink(missing_ok=True)
            raise

    def _refuse_another(self, there: Mapping[str, Any]) -> None:
        """`OutputError` for the folder of another request than this one."""
        unlike = differences(dict(there), self._plan.request())
        if unlike:
            more = f", and {len(unlike) - 1} more differ" if len(unlike) > 1 else ""
            raise OutputError(
                f"{self.path}: holds another {self.what}: {unlike[0]}{more}; "
                f"give another folder, or the options of that {self.what}"
            )

    def _refuse_unfinished(self, done: int) -> None:
        """`OutputError` for parts that are there, to which `--resume` would add the others."""
        if 0 < done < self._plan.parts:
            raise OutputError(
                f"{self.path}: {done} of {self._plan.parts} parts are there; "
                "give --resume to go on, or another folder"
            )

    def _unwritable(self, error: OSError) -> OutputError:
        reason = (error.strerror or str(error)).lower()
        there = ""
        if self.done:
            there = f"; {len(self.done)} of {self._plan.parts} parts are kept, --resume goes on with them"
        return OutputError(
            f"{self.path}: cannot be written: {reason}; make room or give a folder that can be written{there}"
        )


def hold_folder(path: Path) -> int | None:
    """Locks a folder until the descriptor returned is closed; `None` where a system has no locks.

    Raises `OutputError` where another run holds it.
    """
    try:
        import fcntl
    except ImportError:
        # a system without locks: two runs at once only do the work twice
        return None
    lock = os.open(path, os.O_RDONLY)
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(lock)
        raise OutputError(
            f"{path}: another run fills this folder; wait for it, end it, or give another folder"
        ) from None
    except OSError:
        # some network file systems have no locks
        pass
    return lock


def other_maker(first: Mapping[str, str], other: Mapping[str, str]) -> str:
    """The words that parts were made by another program or machine, and in what it differs."""
    what = [f"{key} {first.get(key)} and {value}" for key, value in other.items() if first.get(key) != value]
    return (
        f"its parts were made by {what[0] if what else 'another machine'}, whose last bits may differ; "
        "go on where they were made, or give --mixed to have both"
    )


def differences(there: Any, here: Any, place: str = "") -> list[str]:
    """Where two values of JSON differ, in words."""
    if isinstance(there, dict) and isinstance(here, dict):
        keys = [*here, *(key for key in there if key not in here)]
        by_key = (differences(there.get(key), here.get(key), f"{place}.{key}".lstrip(".")) for key in keys)
        return list(chain.from_iterable(by_key))
    if isinstance(there, list) and isinstance(here, list) and len(there) == len(here):
        pairs = enumerate(zip(there, here, strict=True), 1)
        return list(chain.from_iterable(differences(*pair, f"{place}[{i}]") for i, pair in pairs))
    return [] if there == here else [f"{place} is {shown(there)} there and {shown(here)} here"]


def refuse_unlike(makers: Sequence[Mapping[str, str]], *, mixed: bool) -> None:
    """`RequestError` for makers of which one is not as the first, unless parts may be `mixed`."""
    unlike = [one for one in makers if one != makers[0]]
    if unlike and not mixed:
        raise RequestError(f"scheduler: {other_maker(makers[0], unlike[0])}")
