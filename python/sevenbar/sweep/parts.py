"""The folder of a sweep: its description and its parts, each there whole or not at all.

`sweep.json` is written first. A part is written aside, brought to the disk and renamed: it is complete where
its name exists, whatever moment the run was killed at, and it carries the mark of its sweep.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from sevenbar.errors import OutputError, shown
from sevenbar.sweep.plan import FORMAT, SweepPlan
from sevenbar.sweep.rows import MARK

#: The description's file.
DESCRIPTION = "sweep.json"

#: Digits of a part's number in its name, so that names sort in the order of the parts.
DIGITS = 6

_PART = re.compile(rf"part-(\d{{{DIGITS},}})\.parquet")

_ASIDE = re.compile(r"\.(part-\d+\.parquet|sweep\.json)\.aside")


def part_name(part: int) -> str:
    """The file of a part."""
    return f"part-{part:0{DIGITS}}.parquet"


def read_description(folder: Path) -> dict[str, Any]:
    """What `sweep.json` of a folder holds; raises `OutputError` where that is no sweep's."""
    path = folder / DESCRIPTION
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise OutputError(f"{path}: cannot be read: {reason}; give the folder of a sweep") from None
    except ValueError:
        found = None
    if not isinstance(found, dict) or found.get("format") != FORMAT or "made_by" not in found:
        raise OutputError(f"{path}: is no description of a sweep of format {FORMAT}; give another folder")
    return found


def parts_there(folder: Path) -> list[int]:
    """The numbers of the parts that a folder holds, rising."""
    found = (_PART.fullmatch(path.name) for path in folder.iterdir())
    return sorted(int(match[1]) for match in found if match)


def is_finished(folder: Path) -> bool:
    """Whether a folder has all the parts of the sweep that it holds, if it holds one."""
    if not (folder / DESCRIPTION).is_file():
        return False
    return bool(len(parts_there(folder)) == read_description(folder)["parts"])


class PartsFolder:
    """A folder that a sweep fills; held against a second run as long as it is open."""

    def __init__(
        self, path: Path, plan: SweepPlan, makers: Sequence[Mapping[str, str]], *, resume: bool, mixed: bool
    ):
        """Makes the folder, or takes that of the same sweep up again.

        `makers` are what will make parts. Raises `OutputError` for a folder of something else, for one with
        parts where `resume` is not given, and for parts of another maker where `mixed` is not.
        """
        self.path, self._plan = path, plan
        self._lock: int | None = None
        try:
            path.mkdir(parents=True, exist_ok=True)
            names = [file.name for file in path.iterdir()]
            self._lock = hold_folder(path)
            if DESCRIPTION in names:
                self._take_up(makers, resume=resume, mixed=mixed)
            else:
                strange = [name for name in names if not _ASIDE.fullmatch(name)]
                if strange:
                    raise OutputError(
                        f"{path}: holds {shown(min(strange))} and no {DESCRIPTION}; "
                        "give an empty folder or a new one"
                    )
                self._done = set[int]()
                self._describe(list(makers))
            for name in names:
                if _ASIDE.fullmatch(name):
                    (path / name).unlink(missing_ok=True)
        except OSError as error:
            self.close()
            raise self._unwritable(error) from None
        except BaseException:
            self.close()
            raise

    @property
    def done(self) -> frozenset[int]:
        """The parts that are there."""
        return frozenset(self._done)

    def close(self) -> None:
        """Lets another run have the folder."""
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None

    def keep(self, part: int, content: bytes) -> None:
        """Puts a part into its place; raises `OutputError` where it cannot, and leaves nothing half."""
        try:
            self._put(part_name(part), content)
        except OSError as error:
            raise self._unwritable(error) from None
        self._done.add(part)

    def also_made_by(self, maker: Mapping[str, str]) -> None:
        """Adds one more maker to the description."""
        makers = read_description(self.path)["made_by"]
        if dict(maker) not in makers:
            self._describe([*makers, dict(maker)])

    def _describe(self, makers: Sequence[Mapping[str, str]]) -> None:
        description = self._plan.description(makers)
        self._put(DESCRIPTION, (json.dumps(description, indent=1, ensure_ascii=False) + "\n").encode())

    def _put(self, name: str, content: bytes) -> None:
        aside = self.path / f".{name}.aside"
        try:
            with aside.open("wb") as file:
                file.write(content)
                file.flush()
                os.fsync(file.fileno())
            aside.replace(self.path / name)
            if self._lock is not None:
                # the new name itself
                os.fsync(self._lock)
        except BaseException:
            with suppress(OSError):
                aside.unlink(missing_ok=True)
            raise

    def _take_up(self, makers: Sequence[Mapping[str, str]], *, resume: bool, mixed: bool) -> None:
        description = read_description(self.path)
        wanted = self._plan.request()
        there = {key: description.get(key) for key in wanted}
        unlike = differences(there, wanted)
        if unlike:
            more = f", and {len(unlike) - 1} more differ" if len(unlike) > 1 else ""
            raise OutputError(
                f"{self.path}: holds another sweep: {unlike[0]}{more}; "
                "give another folder, or the options of that sweep"
            )
        done, total = parts_there(self.path), self._plan.parts
        if len(done) < total and done and not resume:
            raise OutputError(
                f"{self.path}: {len(done)} of {total} parts are there; "
                "give --resume to go on, or another folder"
            )
        self._check_marks(done)
        self._done = set(done)
        strangers = [dict(maker) for maker in makers if dict(maker) not in description["made_by"]]
        if len(done) == total or not strangers:
            return
        if done and not mixed:
            raise OutputError(f"{self.path}: {other_maker(description['made_by'][0], strangers[0])}")
        self._describe([*(description["made_by"] if done else ()), *strangers])

    def _check_marks(self, done: Sequence[int]) -> None:
        import pyarrow as pa
        import pyarrow.parquet as pq

        mark = self._plan.digest().encode()
        for part in done:
            path = self.path / part_name(part)
            try:
                own = (pq.read_schema(path).metadata or {}).get(MARK) == mark and part < self._plan.parts
            except (pa.ArrowException, ValueError):
                own = False
            if not own:
                raise OutputError(f"{path}: is no part of this sweep; move it away and give --resume")

    def _unwritable(self, error: OSError) -> OutputError:
        reason = (error.strerror or str(error)).lower()
        done = getattr(self, "_done", ())
        kept = ""
        if done:
            kept = f"; {len(done)} of {self._plan.parts} parts are kept, --resume goes on with them"
        return OutputError(
            f"{self.path}: cannot be written: {reason}; make room or give a folder that can be written{kept}"
        )


def hold_folder(path: Path) -> int | None:
    """Holds a folder against a second run, until what is given is closed; `None` where a system has no locks.

    Raises `OutputError` where another run holds it.
    """
    try:
        import fcntl
    except ImportError:  # a system without: two runs at once would only do the work twice
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
    """That two makers may differ in the last bits, naming in what they differ."""
    what = [f"{key} {first.get(key)} and {value}" for key, value in other.items() if first.get(key) != value]
    return (
        f"its parts were made by {what[0] if what else 'another machine'}, whose last bits may differ; "
        "go on where they were made, or give --mixed to have both"
    )


def differences(there: Any, here: Any, place: str = "") -> list[str]:
    """Where two values of JSON differ, in words."""
    if isinstance(there, dict) and isinstance(here, dict):
        keys = [*here, *(key for key in there if key not in here)]
        found = (differences(there.get(key), here.get(key), f"{place}.{key}".lstrip(".")) for key in keys)
        return [one for some in found for one in some]
    if isinstance(there, list) and isinstance(here, list) and len(there) == len(here):
        pairs = enumerate(zip(there, here, strict=True), 1)
        return [one for i, pair in pairs for one in differences(*pair, f"{place}[{i}]")]
    return [] if there == here else [f"{place} is {shown(there)} there and {shown(here)} here"]
