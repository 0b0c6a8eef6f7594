"""A run as a whole: its cases, the journal by which it goes on after a stop, its summary as JSON."""

from __future__ import annotations

import contextlib
import json
import time
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from evidence import ROOT
from evidence.circumstances import circumstances, commit
from evidence.fuzz.tally import Tally
from evidence.fuzz.watch import Watch
from evidence.fuzz.ways import WAYS, Job

#: Which share of the linkages goes which way: the dear ones are few.
LINKAGES = {
    "rssr batch": 0.88,
    "loop batch": 0.06,
    "rssr": 0.03,
    "loop": 0.0195,
    "edge": 0.01,
    "screw": 0.0005,
}

#: The same of the files.
FILES = {"file": 0.99, "table": 0.01}

FINDINGS = ROOT / "evidence" / "fuzz" / "findings"
JOURNALS = ROOT / "build" / "fuzz"
SUMMARY = ROOT / "docs" / "hard-use.json"


@dataclass
class Run:
    """A run of so many linkages and files from a seed."""

    linkages: int
    files: int
    seed: int
    threads: int
    tallies: dict[str, Tally] = field(default_factory=dict)
    #: Most memory of a worker [bytes], the way of the job that took it, and how many were done then.
    peak_memory: int = 0
    peak_way: str = ""
    peak_after: int = 0
    seconds: float = 0.0
    #: The commits of the sources that did each way, as a run may go on with others.
    commits: dict[str, set[str]] = field(default_factory=dict)
    _jobs_done: int = 0

    def counts(self) -> dict[str, int]:
        """How many cases go each way."""
        shares = [(self.linkages, LINKAGES), (self.files, FILES)]
        found = {way: round(total * share) for total, of in shares for way, share in of.items()}
        # what rounding leaves goes the commonest way
        for total, of in shares:
            most = next(iter(of))
            found[most] += total - sum(found[way] for way in of)
        return found

    def jobs(self) -> Iterator[Job]:
        """All jobs, the ways in turn, so that a run cut short has met them all."""
        queues = [self._jobs_of(way, count) for way, count in self.counts().items()]
        totals = [max(1, -(-count // WAYS[way].size)) for way, count in self.counts().items()]
        order = sorted((k / total, place) for place, total in enumerate(totals) for k in range(total))
        for _, place in order:
            if (job := next(queues[place], None)) is not None:
                yield job

    def _jobs_of(self, way: str, count: int) -> Iterator[Job]:
        size = WAYS[way].size
        for first in range(0, count, size):
            yield Job(way, self.seed, first, min(first + size, count))

    @property
    def journal(self) -> Path:
        """The lines of what is done: a run with the same numbers goes on from there."""
        return JOURNALS / f"{self.linkages}-{self.files}-{self.seed}.jsonl"

    def take(self, job: Job, row: dict[str, Any]) -> None:
        """Adds what a job came to, a line of the journal."""
        self.tallies.setdefault(job.way, Tally()).merge(row["tally"])
        self.commits.setdefault(job.way, set()).add(row["commit"])
        peak = row["peak"]
        self._jobs_done += 1
        if peak > self.peak_memory:
            self.peak_memory, self.peak_way, self.peak_after = peak, job.way, self._jobs_done
        self.seconds += row["seconds"]

    def forget(self, ways: Collection[str]) -> None:
        """Takes these ways out of the journal, to do them anew."""
        if ways:
            self._keep([row for row in self._rows() if row["job"][0] not in ways])

    def _rows(self) -> list[dict[str, Any]]:
        """What the journal has, without the line at which the run before was stopped."""
        if not self.journal.exists():
            return []
        rows = []
        for line in self.journal.read_text(encoding="utf-8").splitlines():
            with contextlib.suppress(ValueError):
                rows.append(json.loads(line))
        return rows

    def _keep(self, rows: list[dict[str, Any]]) -> None:
        self.journal.parent.mkdir(parents=True, exist_ok=True)
        rest = self.journal.with_suffix(".rest")
        rest.write_text("".join(json.dumps(row) + "\n" for row in rows), encoding="utf-8")
        rest.replace(self.journal)

    def go(self, tell: Any) -> None:
        """Does all that the journal has not; `tell` is called with findings, and now and then with words."""
        source = commit()
        done: dict[str, list[tuple[int, int]]] = {way: [] for way in WAYS}
        rows = self._rows()
        self._keep(rows)
        for row in rows:
            job = Job(*row["job"])
            done[job.way].append((job.first, job.last))
            self.take(job, row)
        covered = {way: {index for a, b in parts for index in (a,) if b > a} for way, parts in done.items()}
        left = [job for job in self.jobs() if job.first not in covered[job.way]]
        if self._jobs_done:
            tell(f"{self._jobs_done} jobs are done already by {self.journal.relative_to(ROOT)}")
        last = time.monotonic()
        with self.journal.open("a", encoding="utf-8") as journal:

            def noted(job: Job, tally: Tally, peak: int) -> None:
                nonlocal last
                now = time.monotonic()
                seconds, last = now - last, now
                row = {
                    "job": list(job),
                    "commit": source,
                    "tally": tally.plain(),
                    "peak": peak,
                    "seconds": seconds,
                }
                self.take(job, row)
                journal.write(json.dumps(row) + "\n")
                journal.flush()
                for finding in tally.findings:
                    tell(f"found: {finding.way} {finding.index}: {finding.what[:150]}")
                    keep(vars(finding), self.seed)
                tell(None)

            Watch(noted, self.threads).over(left)

    def plain(self) -> dict[str, Any]:
        """The summary as JSON holds it."""
        return {
            **circumstances("pydantic"),
            "linkages": self.linkages,
            "files": self.files,
            "seed": self.seed,
            "threads": self.threads,
            "minutes": self.seconds / 60,
            "memory": {
                "peak": self.peak_memory,
                "way": self.peak_way,
                "after": self.peak_after / max(1, self._jobs_done),
            },
            "limits": {way: WAYS[way].limit for way in self.counts()},
            "commits": {way: sorted(self.commits[way]) for way in self.counts() if way in self.commits},
            "ways": {
                way: self.tallies[way].plain() | {"findings": []}
                for way in self.counts()
                if way in self.tallies
            },
        }


def keep(finding: dict[str, Any], seed: int) -> Path:
    """Writes a finding to a file of its own, which `python -m evidence.fuzz replay` takes."""
    FINDINGS.mkdir(parents=True, exist_ok=True)
    path = FINDINGS / f"{finding['way'].replace(' ', '-')}-{seed}-{finding['index']}.json"
    path.write_text(json.dumps(finding | {"seed": seed}, indent=1) + "\n", encoding="utf-8")
    return path
