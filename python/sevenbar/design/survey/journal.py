"""The folder of a survey: its description, and a journal with a line for each part that is done.

A line is written whole and brought to the disk before the next; where a run was killed within one, that line
has no end and is cut off when the survey goes on. So a killed run loses the parts at work and nothing else.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from sevenbar.design.survey.drawn import Drawn
from sevenbar.design.survey.tally import SurveyTally
from sevenbar.errors import OutputError, shown
from sevenbar.sweep.parts import differences, hold_folder, other_maker

#: The description's file, and the journal's.
DESCRIPTION, JOURNAL = "survey.json", "journal.jsonl"


class Journal:
    """The parts of a survey that are done, in a folder held against a second run while it is open."""

    def __init__(
        self,
        folder: Path,
        task: Drawn,
        makers: Sequence[Mapping[str, str]],
        *,
        resume: bool,
        mixed: bool,
    ) -> None:
        """Makes the folder, or takes that of the same survey up again.

        Raises `OutputError` for a folder of something else, for one with parts where `resume` is not given,
        and for parts of another maker where `mixed` is not.
        """
        self.folder, self._task = folder, task
        self.tallies: dict[int, SurveyTally] = {}
        self._lock: int | None = None
        self._file: Any = None
        try:
            folder.mkdir(parents=True, exist_ok=True)
            self._lock = hold_folder(folder)
            names = sorted(path.name for path in folder.iterdir())
            if DESCRIPTION in names:
                self._take_up(makers, resume=resume, mixed=mixed)
            elif names:
                raise OutputError(
                    f"{folder}: holds {shown(names[0])} and no {DESCRIPTION}; "
                    "give an empty folder or a new one"
                )
            else:
                self._describe(makers)
            self._file = (folder / JOURNAL).open("ab")
        except OSError as error:
            self.close()
            raise self._unwritable(error) from None
        except BaseException:
            self.close()
            raise

    def keep(self, part: int, content: bytes, maker: Mapping[str, str]) -> None:
        """Adds a finished part; raises `OutputError` where it cannot be written."""
        line = b'{"part":%d,"made_by":%s,"tally":%s}\n' % (part, json.dumps(dict(maker)).encode(), content)
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
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None

    def _describe(self, makers: Sequence[Mapping[str, str]]) -> None:
        description = {
            **self._task.request(),
            "parts": self._task.parts,
            "mark": self._task.digest(),
            "made_by": [dict(one) for one in makers],
        }
        aside = self.folder / f".{DESCRIPTION}.aside"
        try:
            aside.write_text(json.dumps(description, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
            aside.replace(self.folder / DESCRIPTION)
        except BaseException:
            with suppress(OSError):
                aside.unlink(missing_ok=True)
            raise

    def _take_up(self, makers: Sequence[Mapping[str, str]], *, resume: bool, mixed: bool) -> None:
        path = self.folder / DESCRIPTION
        try:
            there = json.loads(path.read_text(encoding="utf-8"))
            known = {key: there[key] for key in self._task.request()}
        except (ValueError, KeyError, TypeError):
            raise OutputError(f"{path}: is no description of a survey; give another folder") from None
        unlike = differences(known, self._task.request())
        if unlike:
            more = f", and {len(unlike) - 1} more differ" if len(unlike) > 1 else ""
            raise OutputError(
                f"{self.folder}: holds another survey: {unlike[0]}{more}; "
                "give another folder, or the options of that survey"
            )
        lines = self._whole_lines()
        if lines and len(lines) < self._task.parts and not resume:
            raise OutputError(
                f"{self.folder}: {len(lines)} of {self._task.parts} parts are there; "
                "give --resume to go on, or another folder"
            )
        for number, line in enumerate(lines, 1):
            try:
                row = json.loads(line)
                by, part = row["made_by"], int(row["part"])
                tally = SurveyTally.of_dict(row["tally"])
                if part >= self._task.parts or tally.count != len(self._task.linkages(part)):
                    raise ValueError
            except (ValueError, KeyError, TypeError, IndexError):
                raise OutputError(
                    f"{self.folder / JOURNAL}: line {number} is no part of this survey; "
                    "take the line out and give --resume"
                ) from None
            strangers = [dict(one) for one in makers if dict(one) != by]
            if strangers and len(lines) < self._task.parts and not mixed:
                raise OutputError(f"{self.folder}: {other_maker(by, strangers[0])}")
            self.tallies[part] = tally

    def _whole_lines(self) -> list[bytes]:
        """The lines of the journal; one without an end is cut off."""
        path = self.folder / JOURNAL
        if not path.exists():
            return []
        content = path.read_bytes()
        whole = content[: content.rfind(b"\n") + 1]
        if len(whole) < len(content):
            os.truncate(path, len(whole))
        return whole.splitlines()

    def _unwritable(self, error: OSError) -> OutputError:
        reason = (error.strerror or str(error)).lower()
        kept = f"; {len(self.tallies)} of {self._task.parts} parts are kept" if self.tallies else ""
        return OutputError(
            f"{self.folder}: cannot be written: {reason}; "
            f"make room or give a folder that can be written{kept}"
        )
