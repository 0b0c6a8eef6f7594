"""Worker processes under watch: what hangs is killed, what dies is replaced, and the case to blame is found.

A worker names the case at hand in shared memory. One that takes longer than its way allows, holds more memory
than it may, or dies, is ended; its job goes back without that case, and a batch is halved until one is left.
"""

from __future__ import annotations

import math
import multiprocessing
import os
import resource
import sys
import time
from collections import deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any

from evidence.fuzz.tally import Finding, Tally
from evidence.fuzz.ways import WAYS, Job, _text, run

#: Memory that a worker may hold [bytes]: an ordinary one has a tenth.
MOST_MEMORY = 2_000_000_000

#: How often workers are checked [s].
GLANCE = 0.25

#: Time [s] in which a worker must have begun its first case: it imports everything first.
START = 60.0

#: A call may wait for processors so many times its limit, which is on the time that it has of them.
PATIENCE = 10

#: What is at hand between two cases.
NOTHING = -2.0


def _work(jobs: Connection, slot: Any) -> None:
    """The life of a worker: jobs come, tallies go."""

    def mark(index: int | None) -> None:
        # the case before the time: a case without its own time is an older one, and has a longer life
        slot[1] = NOTHING if index is None else index
        slot[0] = time.monotonic()

    while (job := jobs.recv()) is not None:
        tally = run(Job(*job), mark)
        mark(None)
        jobs.send((tally.plain(), _peak()))


def _peak() -> int:
    """The most memory that this process ever held [bytes]."""
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak if sys.platform == "darwin" else 1024 * peak


def memory(pid: int) -> int:
    """The memory that a process holds now [bytes]; 0 where the machine does not tell."""
    try:
        pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    except (OSError, ValueError, IndexError):
        return 0
    return pages * resource.getpagesize()


def processor_time(pid: int) -> float:
    """The time [s] that a process has had of processors; NaN where the machine does not tell."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
    except (OSError, ValueError, IndexError):
        return math.nan


@dataclass
class _Worker:
    process: BaseProcess
    jobs: Connection
    slot: Any
    job: Job | None = None
    #: When the case at hand began, and the processor time of the process when that was first seen.
    began: float = 0.0
    used: float = 0.0

    @staticmethod
    def start() -> _Worker:
        context = multiprocessing.get_context("spawn")
        slot = context.Array("d", [time.monotonic(), NOTHING], lock=False)
        ours, theirs = context.Pipe()
        process = context.Process(target=_work, args=(theirs, slot), daemon=True)
        process.start()
        theirs.close()
        return _Worker(process, ours, slot)

    def give(self, job: Job) -> None:
        self.job = job
        self.slot[0], self.slot[1] = time.monotonic() + START, NOTHING
        self.jobs.send(tuple(job))

    def trouble(self) -> str:
        """What is wrong with it: over time, over memory, dead; or nothing."""
        if self.job is None:
            return ""
        if not self.process.is_alive():
            return f"died with {self.process.exitcode}"
        if (held := memory(self.process.pid or 0)) > MOST_MEMORY:
            return f"held {held / 1e9:.1f} GB"
        limit = WAYS[self.job.way].limit
        used = processor_time(self.process.pid or 0)
        if self.slot[0] != self.began:
            self.began, self.used = self.slot[0], used
        waited = time.monotonic() - self.began
        over = waited > limit * (1 if math.isnan(used) else PATIENCE)
        return f"took longer than {limit:g} s" if over or used - self.used > limit else ""

    def end(self) -> None:
        self.process.kill()
        self.process.join()
        self.jobs.close()


@dataclass
class Watch:
    """A run: jobs to do, and what is called with each tally, its job, and the memory of its worker."""

    done: Callable[[Job, Tally, int], None]
    threads: int = 2
    #: Workers that were ended or died.
    lost: int = 0
    _jobs: deque[Job] = field(default_factory=deque)

    def over(self, jobs: Iterable[Job]) -> None:
        """Does all jobs."""
        self._jobs.extend(jobs)
        workers = [_Worker.start() for _ in range(self.threads)]
        try:
            while self._jobs or any(worker.job for worker in workers):
                for worker in workers:
                    if worker.job is None and self._jobs:
                        worker.give(self._jobs.popleft())
                wait([w.jobs for w in workers if w.job], timeout=GLANCE)
                for place, worker in enumerate(workers):
                    if worker.job is not None and not self._heard(worker):
                        workers[place] = _Worker.start()
        finally:
            for worker in workers:
                worker.end()

    def _heard(self, worker: _Worker) -> bool:
        """Takes a worker's tally, if it has one; whether the worker may go on."""
        assert worker.job is not None
        try:
            if worker.jobs.poll():
                plain, peak = worker.jobs.recv()
                job, worker.job = worker.job, None
                tally = Tally()
                tally.merge(plain)
                self.done(job, tally, peak)
                return True
        except (EOFError, OSError):
            worker.process.join()
        trouble = worker.trouble()
        if trouble:
            job, index = worker.job, int(worker.slot[1])
            worker.end()
            self.lost += 1
            self._blame(job, index, trouble)
            return False
        return True

    def _blame(self, job: Job, index: int, trouble: str) -> None:
        """Puts back the rest of a job; the one case that is left is a finding."""
        if job.last - job.first == 1:
            tally = Tally(cases=1)
            tally.add(Finding(job.way, job.first, trouble, "", _content(job)))
            self.done(job, tally, 0)
            return
        if not job.first <= index < job.last:
            index = (job.first + job.last) // 2
            parts = [(job.first, index), (index, job.last)]
        else:
            parts = [(job.first, index), (index, index + 1), (index + 1, job.last)]
        self._jobs.extendleft(job._replace(first=a, last=b) for a, b in reversed(parts) if b > a)


def _content(job: Job) -> str:
    return _text(WAYS[job.way].content(job.seed, job.first))
