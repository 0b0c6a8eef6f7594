"""The folder of a sweep: its description and its parts, each there whole or not at all.

`sweep.json` is written first. A part is written aside, brought to the disk and renamed: it is complete where
its name exists, whatever moment the run was killed at. It carries the mark of its sweep, its number and a
checksum.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from sevenbar.errors import OutputError
from sevenbar.sweep.checked import OWN, checksum, flaw
from sevenbar.sweep.held_folder import HeldFolder, other_maker
from sevenbar.sweep.plan import FORMAT, SweepPlan
from sevenbar.text.paths import is_file

#: The description's file.
DESCRIPTION = "sweep.json"

#: Digits of a part's number in its name, so that names sort in the order of the parts.
DIGITS = 6

#: The format whose parts had neither numbers nor checksums.
WITHOUT_CHECKSUMS = 1

_PART = re.compile(rf"part-(\d{{{DIGITS},}})\.parquet")


def part_name(part: int) -> str:
    """The file of a part."""
    return f"part-{part:0{DIGITS}}.parquet"


def read_description(folder: Path) -> dict[str, Any]:
    """What `sweep.json` of a folder holds; raises `OutputError` where that is no sweep's."""
    path = folder / DESCRIPTION
    try:
        result = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise OutputError(f"{path}: cannot be read: {reason}; give the folder of a sweep") from None
    except (ValueError, RecursionError):
        result = None
    if not isinstance(result, dict) or not isinstance(result.get("made_by"), list):
        raise OutputError(f"{path}: is no description of a sweep of format {FORMAT}; give another folder")
    if result.get("format") == WITHOUT_CHECKSUMS:
        raise OutputError(
            f"{path}: is a sweep of format {WITHOUT_CHECKSUMS}, whose parts carry no checksums; "
            "sweep into another folder, or read its parts with pandas or DuckDB"
        )
    if result.get("format") != FORMAT:
        raise OutputError(f"{path}: is no description of a sweep of format {FORMAT}; give another folder")
    if result.get(OWN) != checksum(result):
        raise OutputError(
            f"{path}: is damaged or was changed: its checksum is that of other values; give another folder"
        )
    return result


def read_part(folder: Path, part: int, description: Mapping[str, Any]) -> bytes:
    """A part's file, which is whole and in its place; raises `OutputError` for another."""
    path = folder / part_name(part)
    size = description["part_size"]
    linkages = range(part * size, min((part + 1) * size, description["linkages"]))
    try:
        content = path.read_bytes()
    except OSError as error:
        raise OutputError(f"{path}: cannot be read: {(error.strerror or str(error)).lower()}") from None
    wrong = flaw(content, description["mark"], part, linkages)
    if wrong:
        raise OutputError(f"{path}: {wrong}; move it away and give --resume")
    return content


def parts_there(folder: Path) -> list[int]:
    """The numbers of the parts that a folder holds, rising."""
    result = (_PART.fullmatch(path.name) for path in folder.iterdir())
    return sorted(int(match[1]) for match in result if match)


def is_finished(folder: Path) -> bool:
    """Whether a folder has all the parts of the sweep that it holds, if it holds one."""
    if not is_file(folder / DESCRIPTION):
        return False
    return bool(len(parts_there(folder)) == read_description(folder)["parts"])


class PartsFolder(HeldFolder):
    """A folder that a sweep fills; held against a second run as long as it is open."""

    description, what = DESCRIPTION, "sweep"

    def __init__(
        self, path: Path, plan: SweepPlan, makers: Sequence[Mapping[str, str]], *, resume: bool, mixed: bool
    ):
        """Makes the folder, or takes that of the same sweep up again.

        `makers` are what will make parts. Raises `OutputError` for a folder of something else, for one with
        parts where `resume` is not given, and for parts of another maker where `mixed` is not.
        """
        super().__init__(path, plan)
        self._sweep, self._done = plan, set[int]()
        with self._opened() as described:
            if described:
                self._take_up(makers, resume=resume, mixed=mixed)
            else:
                self._describe(plan.description(list(makers)))

    @property
    def done(self) -> frozenset[int]:
        """The parts that are there."""
        return frozenset(self._done)

    def _is_file(self, name: str) -> bool:
        return super()._is_file(name) or _PART.fullmatch(name) is not None

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
            self._describe(self._sweep.description([*makers, dict(maker)]))

    def _take_up(self, makers: Sequence[Mapping[str, str]], *, resume: bool, mixed: bool) -> None:
        description = read_description(self.path)
        self._refuse_another({key: description.get(key) for key in self._plan.request()})
        done, total = parts_there(self.path), self._plan.parts
        if not resume:
            self._refuse_unfinished(len(done))
        for part in done:
            read_part(self.path, part, description)
        self._done = set(done)
        strangers = [dict(maker) for maker in makers if dict(maker) not in description["made_by"]]
        if len(done) == total or not strangers:
            return
        if done and not mixed:
            raise OutputError(f"{self.path}: {other_maker(description['made_by'][0], strangers[0])}")
        before = description["made_by"] if done else ()
        self._describe(self._sweep.description([*before, *strangers]))
