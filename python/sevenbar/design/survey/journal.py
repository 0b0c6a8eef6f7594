"""The folder of a survey: its description, and a journal with a line for each part that is done.

A line is written whole and brought to the disk before the next; where a run was killed within one, that line
has no end and is cut off when the survey goes on. So a killed run loses the parts at work and nothing else.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

from sevenbar.design.survey.drawn import Drawn
from sevenbar.design.survey.tally import SurveyTally
from sevenbar.errors import OutputError
from sevenbar.sweep.held_folder import HeldFolder, other_maker

#: The description's file, and the journal's.
DESCRIPTION, JOURNAL = "survey.json", "journal.jsonl"

#: What is before the checksum that ends a line.
CHECK = b',"check":"'


class Journal(HeldFolder):
    """The parts of a survey that are done, in a folder held against a second run while it is open."""

    description, what = DESCRIPTION, "survey"

    def __init__(
        self,
        folder: Path,
        task: Drawn,
        makers: Sequence[Mapping[str, str]],
        *,
        resume: bool,
        mixed: bool,
    ) -> None:
        """Makes the folder, or goes on with that of the same survey.

        `makers` are what will make parts (`maker`). Raises `OutputError` for a folder of something else, for
        one with parts where `resume` is not given, and for parts of another maker where `mixed` is not.
        """
        super().__init__(folder, task)
        self._task = task
        self.tallies: dict[int, SurveyTally] = {}
        self._file: Any = None
        with self._opened() as described:
            if described:
                self._take_up(makers, resume=resume, mixed=mixed)
            else:
                mark = {"parts": task.parts, "mark": task.digest()}
                self._describe({**task.request(), **mark, "made_by": [dict(one) for one in makers]})
            self._file = (folder / JOURNAL).open("ab")

    @property
    def done(self) -> Collection[int]:
        """The parts that are there."""
        return self.tallies.keys()

    def keep(self, part: int, content: bytes, maker: Mapping[str, str]) -> None:
        """Adds a finished part; raises `OutputError` where it cannot be written."""
        line = b'{"part":%d,"made_by":%s,"tally":%s' % (part, json.dumps(dict(maker)).encode(), content)
        line += CHECK + self._checksum(line) + b'"}\n'
        try:
            self._file.write(line)
            self._file.flush()
            os.fsync(self._file.fileno())
        except OSError as error:
            raise self._unwritable(error) from None
        self.tallies[part] = SurveyTally.of_dict(json.loads(content))

    def close(self) -> None:
        """Lets another run have the folder."""
        if self._file is not None:
            self._file.close()
            self._file = None
        super().close()

    def _take_up(self, makers: Sequence[Mapping[str, str]], *, resume: bool, mixed: bool) -> None:
        path = self.path / DESCRIPTION
        try:
            there = json.loads(path.read_text(encoding="utf-8"))
            known = {key: there[key] for key in self._task.request()}
        except (ValueError, KeyError, TypeError, RecursionError):
            raise OutputError(f"{path}: is no description of a survey; give another folder") from None
        self._refuse_another(known)
        lines = self._whole_lines()
        if not resume:
            self._refuse_unfinished(len(lines))
        for number, line in enumerate(lines, 1):
            try:
                bare, _, check = line.rpartition(CHECK)
                if check != self._checksum(bare) + b'"}':
                    raise ValueError
                row = json.loads(line)
                by, part = row["made_by"], int(row["part"])
                tally = SurveyTally.of_dict(row["tally"])
                if not 0 <= part < self._task.parts or tally.count != len(self._task.linkages(part)):
                    raise ValueError
            except (ValueError, KeyError, TypeError, IndexError, RecursionError):
                raise OutputError(
                    f"{self.path / JOURNAL}: line {number} is no part of this survey, or damaged; "
                    "take the line out and give --resume"
                ) from None
            strangers = [dict(one) for one in makers if dict(one) != by]
            if strangers and len(lines) < self._task.parts and not mixed:
                raise OutputError(f"{self.path}: {other_maker(by, strangers[0])}")
            self.tallies[part] = tally

    def _checksum(self, line: bytes) -> bytes:
        """The checksum of a line up to it, which is of this survey alone."""
        return hashlib.sha256(self._task.digest().encode() + line).hexdigest().encode()

    def _whole_lines(self) -> list[bytes]:
        """The lines of the journal; one without an end is cut off."""
        path = self.path / JOURNAL
        if not path.exists():
            return []
        content = path.read_bytes()
        whole = content[: content.rfind(b"\n") + 1]
        if len(whole) < len(content):
            os.truncate(path, len(whole))
        return whole.splitlines()
